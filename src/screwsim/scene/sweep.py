"""The sweep of a scene: each axis as a tuple of values in SI units, checked like the field that it varies."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Mapping
from typing import Any

from screwsim.effects import catalogue
from screwsim.scene.fields import Leaf, sweep_leaf, unknown
from screwsim.scene.sections import read_leaf
from screwsim.scene.types import ActiveEffect
from screwsim.scene.units import Refused, customary_unit, to_customary
from screwsim.scene.values import convert, shown, text_of
from screwsim.scene.yaml_tree import Node, Problem, join, locate

LONGEST_AXIS = 100_000  # values; more is a slip of the pen


def read_sweep(
    node: Node | None, root: Node, active: Mapping[str, ActiveEffect], problems: list[Problem]
) -> dict[str, tuple[Any, ...]]:
    """Return {path: values in SI} in the order of the file."""
    if node is None or node.value is None:
        return {}
    if not isinstance(node.value, dict):
        what = f"{shown(node.value)} is not a mapping (write e.g. operation.speed: [1000 rpm, 2000 rpm])"
        problems.append(Problem(node.place, "sweep", what))
        return {}
    parameters = {name: effect.effect.parameters for name, effect in active.items()}
    axes = {}
    for path, child in node.value.items():
        try:
            leaf = sweep_leaf(path, parameters, catalogue())
            _refuse_absent_section(path, root)
        except Refused as refusal:
            problems.append(Problem(child.heading, f"sweep.{path}", str(refusal)))
            continue
        axes[path] = _axis(leaf, child, f"sweep.{path}", problems)
    return axes


def _refuse_absent_section(path: str, root: Node) -> None:
    name = path.partition(".")[0]
    parent = path.rpartition(".")[0]
    if name in ("effects", "numerics", "output", "operation"):
        return  # checked by their names, or there by default
    node, found = locate(root, parent)
    if not found or node.value is None:
        raise Refused(f"the section {parent} is not in this scene (write it first)")


def _axis(leaf: Leaf, node: Node, path: str, problems: list[Problem]) -> tuple[Any, ...]:
    if isinstance(node.value, dict):
        values = _range(leaf, node, path, problems)
    elif isinstance(node.value, list):
        values = [read_leaf(leaf, item, path, problems) for item in node.value]
    else:
        what = f"{shown(node.value)} is neither a list nor {{from, to, count}} (write e.g. [{_example(leaf)}])"
        problems.append(Problem(node.place, path, what))
        return ()
    good = [value for value in values if value is not None]
    twice = next((value for value, times in Counter(good).items() if times > 1), None)
    if not values and isinstance(node.value, list):
        problems.append(Problem(node.place, path, f"has no values (write e.g. [{_example(leaf)}])"))
    elif twice is not None:
        problems.append(Problem(node.place, path, f"has {text_of(leaf, twice)} twice (remove one)"))
    return tuple(good)


def _example(leaf: Leaf) -> str:
    return leaf.dimension.example if leaf.dimension else leaf.limits["options"][0] if leaf.kind == "choice" else "1, 2"


_COUNT = Leaf("count", "number of values", dataclasses.MISSING, {"ge": 1, "le": LONGEST_AXIS})
_SPACING = Leaf("choice", "spacing of the values", "linear", {"options": ("linear", "log")})


def _range(leaf: Leaf, node: Node, path: str, problems: list[Problem]) -> list[Any]:
    """Return the values of {from, to, count, spacing}, or nothing after faults were added."""
    before = len(problems)
    if leaf.kind == "choice":
        problems.append(Problem(node.place, path, "is a choice: write a list of its words"))
        return []
    fields = {"from": leaf, "to": leaf, "count": _COUNT, "spacing": _SPACING}
    for name, child in node.value.items():
        if name not in fields:
            problems.append(Problem(child.heading, join(path, name), unknown(name, fields)))
    given: dict[str, Any] = {"spacing": "linear"}
    for name, field in fields.items():
        child = node.value.get(name)
        if child is not None:
            given[name] = read_leaf(field, child, join(path, name), problems)
        elif name != "spacing":
            problems.append(Problem(node.heading, join(path, name), "is missing (write {from: …, to: …, count: …})"))
    if len(problems) > before:
        return []
    try:
        return spread(leaf, given["from"], given["to"], given["count"], given["spacing"])
    except Refused as refusal:
        problems.append(Problem(node.place, path, str(refusal)))
        return []


def spread(leaf: Leaf, first: float, last: float, count: int, spacing: str) -> list[Any]:
    """Return `count` values from first to last [SI], evenly spaced in the customary unit or its logarithm."""
    if spacing == "log" and not (first > 0.0 and last > 0.0):
        raise Refused("log spacing needs ends above zero (choose others, or spacing: linear)")
    if count == 1:
        return [first]
    kind = leaf.dimension
    ends = [to_customary(kind, end) if kind else end for end in (first, last)]
    if spacing == "log":
        ends = [math.log(end) for end in ends]
    inner = [ends[0] + (ends[1] - ends[0]) * index / (count - 1) for index in range(1, count - 1)]
    if spacing == "log":
        inner = [math.exp(number) for number in inner]
    return [first, *(_rounded(leaf, number) for number in inner), last]


def _rounded(leaf: Leaf, number: float) -> Any:
    """Return a number of the customary unit in SI, rounded to 14 digits so that the axis reads well."""
    text = f"{number:.14g}"
    if leaf.kind == "count":
        if "." in text:
            raise Refused("does not give whole numbers (change count, or write a list)")
        return int(float(text))
    kind = leaf.dimension
    return convert(leaf, f"{text} {customary_unit(kind)}" if kind else float(text))
