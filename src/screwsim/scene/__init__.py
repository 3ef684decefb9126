"""From a YAML file to a typed scene in SI units, with every fault at its line; and the grid of a sweep."""

from screwsim.scene.checks import check_files, cross_check, value_at
from screwsim.scene.grid import axes, axis_label, case, case_count, case_values, leaf_of, read_value, with_values
from screwsim.scene.load import load, loads
from screwsim.scene.schema import schema
from screwsim.scene.types import Scene
from screwsim.scene.write import scene_text

__all__ = [
    "Scene",
    "axes",
    "axis_label",
    "case",
    "case_count",
    "case_values",
    "check_files",
    "cross_check",
    "leaf_of",
    "load",
    "loads",
    "read_value",
    "scene_text",
    "schema",
    "value_at",
    "with_values",
]
