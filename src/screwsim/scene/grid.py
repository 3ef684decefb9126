"""The grid of a sweep: its axes, and each case made on demand; the last axis runs fastest."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from screwsim.effects import catalogue
from screwsim.faults import UsageError
from screwsim.scene.checks import value_at
from screwsim.scene.fields import Leaf, sweep_leaf
from screwsim.scene.types import Scene
from screwsim.scene.units import Refused
from screwsim.scene.values import convert


def axes(scene: Scene) -> dict[str, tuple[Any, ...]]:
    """Return {dotted path: values in SI}, in the order of the file."""
    return dict(scene.sweep)


def case_count(scene: Scene) -> int:
    """Return the number of cases: the product of the axes, 1 without a sweep."""
    return math.prod(len(values) for values in scene.sweep.values())


def case_values(scene: Scene, index: int) -> dict[str, Any]:
    """Return {dotted path: value in SI} of one case."""
    if not 0 <= index < case_count(scene):
        raise IndexError(f"case {index} of {case_count(scene)}")
    chosen = {}
    for path in reversed(list(scene.sweep)):
        values = scene.sweep[path]
        index, place = divmod(index, len(values))
        chosen[path] = values[place]
    return {path: chosen[path] for path in scene.sweep}


def case(scene: Scene, index: int) -> Scene:
    """Return one case of the grid, as a scene without a sweep and without text (`scene_text` makes it)."""
    return replace(with_values(scene, case_values(scene, index)), sweep={}, text="")


def with_values(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """Return the scene with other values [SI] at dotted paths; neither checked nor written as text.

    The sections on the way must be there. `cross_check` tells whether the values fit together.
    """
    for path, value in values.items():
        scene = _with_value(scene, path, value)
    return replace(scene, text="")


def _with_value(scene: Scene, path: str, value: Any) -> Scene:
    if not path.startswith("effects."):
        return _replaced(scene, path.split("."), value)
    name, _, parameter = path.removeprefix("effects.").rpartition(".")
    active = scene.effects[name]
    changed = replace(active, parameters=replace(active.parameters, **{parameter: value}))
    return replace(scene, effects={**scene.effects, name: changed})


def _replaced(part: Any, names: list[str], value: Any) -> Any:
    name, *rest = names
    return replace(part, **{name: _replaced(getattr(part, name), rest, value) if rest else value})


def leaf_of(scene: Scene, path: str) -> Leaf:
    """Return the description of an input of this scene that may be varied; raise `UsageError` with the nearest path."""
    try:
        leaf = sweep_leaf(path, {name: type(active.parameters) for name, active in scene.effects.items()}, catalogue())
    except Refused as refusal:
        raise UsageError(f"{path}: {refusal}") from None
    parent = path.rpartition(".")[0]
    if not parent.startswith("effects.") and value_at(scene, parent) is None:
        raise UsageError(f"{path}: the section {parent} is not in this scene (write it first)")
    return leaf


def read_value(scene: Scene, path: str, raw: Any) -> Any:
    """Return a value as written in YAML ('1000 rpm', 3) in SI, checked like the field; raise `UsageError`."""
    try:
        return convert(leaf_of(scene, path), raw, scene.folder)
    except Refused as refusal:
        raise UsageError(f"{path}: {refusal}") from None


def axis_label(path: str, scene: Scene) -> tuple[str, str]:
    """Return (name, SI unit) of an axis in a file of results: '1' for numbers, '' for words (choices)."""
    leaf = leaf_of(scene, path)
    unit = leaf.dimension.si if leaf.dimension else "" if leaf.kind == "choice" else "1"
    return path.replace(".", "_"), unit
