"""Scenes: from a YAML file to a typed scene in SI units, with each fault at its line; and the grid of a sweep."""

from screwsim.scene.checks import cross_check
from screwsim.scene.fields import value_at
from screwsim.scene.grid import (
    case,
    case_count,
    case_values,
    dimensions,
    leaf_of,
    read_value,
    with_sweep_over,
    with_values,
    without_sweep,
)
from screwsim.scene.lines import lines, refrigerating_effect, suction_enthalpy
from screwsim.scene.load import SceneLike, load, loads, scene_of
from screwsim.scene.schema import schema
from screwsim.scene.types import Scene
from screwsim.scene.write import scene_text
