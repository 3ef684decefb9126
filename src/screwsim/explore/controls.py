"""Controls of a page: a field for each number and choice of a scene, in customary units."""

import math
from collections.abc import Mapping
from dataclasses import MISSING
from typing import Any, NamedTuple

from screwsim.explore.changes import (
    Changes,
    SceneArguments,
    changeable_fields,
    overrides_of,
    possible_effects,
    scene_of,
)
from screwsim.inputs.declare import FoundWithCycle
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.machine import protocol
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.scene import Scene, value_at
from screwsim.scene.fields import Leaf
from screwsim.scene.operation import SPEED
from screwsim.scene.types import Tolerance
from screwsim.scene.units import Refused, customary_unit, parse_quantity
from screwsim.scene.values import limits_text

SLIDER_FACTOR = 4.0  # a slider extends from the value over this factor to the value times it
SLIDER_KELVIN = 30.0  # [K] on both sides of a temperature
SLIDER_ANGLE = math.radians(40.0)  # on both sides of an angle
_SMALL = (("m", 1e-3, "um"), ("m^2", 1e-4, "mm^2"))  # below this size a smaller unit is used
GROUPS = {
    "operation": "Operation",
    "oil_supply": "Oil supply",
    "machine": "Machine",
    "gas": "Gas",
    "oil": "Oil",
    "numerics": "Numerics",
}
OMITTED_PATHS = {"output.keep", "output.derivatives", "title"}


class SliderRange(NamedTuple):
    """Range of a slider [SI], and whether its steps are equal ratios."""

    low: float
    high: float
    log: bool


class ShownUnit(NamedTuple):
    """A unit as written in a scene: its size and its zero [SI]."""

    name: str
    size: float
    zero: float = 0.0

    def of(self, value: float) -> float:
        """Return a value [SI] in this unit, without the last digits, which come from rounding."""
        return float(f"{(value - self.zero) / self.size:.12g}")


def document(base: SceneArguments) -> dict[str, Any]:
    """Return the data from which the page builds its fields: groups of controls, and effects with theirs."""
    scene = base.scene
    every = possible_effects(scene)
    leaves = {path: leaf for path, leaf in changeable_fields(scene, every).items() if path not in OMITTED_PATHS}
    controls = {}
    for path, leaf in leaves.items():
        controls[path] = control(path, leaf, value_at(scene, path), _is_needed(scene, path, leaf))
    for path in scene.uncertain.keys() & controls.keys():
        controls[path]["tolerance"] = _tolerance(leaves[path], value_at(scene, path), scene.uncertain[path])
    below = {name: [each for path, each in controls.items() if _is_below(path, name)] for name in GROUPS}
    groups = [{"name": name, "words": words, "controls": below[name]} for name, words in GROUPS.items()]
    effects = [
        {
            "name": name,
            "words": name.replace("_", " "),
            "about": effect.title,
            "on": name in scene.effects,
            "controls": [each for path, each in controls.items() if _is_below(path, f"effects.{name}")],
        }
        for name, effect in every.items()
    ]
    return {"groups": [group for group in groups if group["controls"]], "effects": effects, "presets": presets(base)}


def _tolerance(leaf: Leaf, value: float, tolerance: Tolerance) -> str:
    """Return a tolerance in the shown unit of its value: '± 5', '×/÷ 2'."""
    if tolerance.factor:
        return f"×/÷ {tolerance.size:.4g}"
    return f"± {tolerance.size / shown_unit(leaf, value).size:.4g}"


def _is_below(path: str, name: str) -> bool:
    return path.startswith(f"{name}.")


def _is_needed(scene: Scene, path: str, leaf: Leaf) -> bool:
    """Tell whether a value is required: in a section that the scene does not have, none is."""
    parent = path.rpartition(".")[0]
    of_effect = path.startswith("effects.") and parent.count(".") == 1
    return leaf.default is MISSING and (of_effect or value_at(scene, parent) is not None)


def control(path: str, leaf: Leaf, value: Any, needed: bool = False) -> dict[str, Any]:
    """Return the page's data on one field; numbers are in the shown unit.

    `value` is None if it is left open, or found with the cycle (auto).
    """
    value = None if isinstance(value, FoundWithCycle) else value
    keys = path.split(".")
    inner = keys[2:] if keys[0] == "effects" else keys[1:]
    about: dict[str, Any] = {
        "path": path,
        "words": " ".join(inner).replace("_", " "),
        "about": leaf.doc,
        "kind": "choice" if leaf.kind == "choice" else "count" if leaf.kind == "count" else "number",
        "needed": needed,
    }
    if leaf.kind == "choice":
        return about | {"options": list(leaf.limits["options"]), "value": value, "open": leaf.default is None}
    unit = shown_unit(leaf, value)
    start = _example(leaf) if value is None else float(value)
    span = slider_range(leaf, start)
    limits = limits_text(leaf)
    return about | {
        "about": f"{leaf.doc} ({limits})" if limits else leaf.doc,
        "unit": unit.name,
        "value": None if value is None else unit.of(float(value)),
        "low": unit.of(span.low),
        "high": unit.of(span.high),
        "log": span.log,
        "size": unit.size,
    }


def shown_unit(leaf: Leaf, value: Any) -> ShownUnit:
    """Return the unit in which a number is shown: the customary one, a smaller one for small numbers, or °C."""
    kind = leaf.dimension
    if kind is None:
        return ShownUnit("", 1.0)
    if kind.name == "temperature":
        return ShownUnit("degC", 1.0, ZERO_CELSIUS)
    unit = customary_unit(kind)
    for si, below, smaller in _SMALL:
        if kind.si == si and value is not None and abs(value) < below:
            unit = smaller
    return ShownUnit(unit, parse_quantity(kind, f"1 {unit}"))


def _example(leaf: Leaf) -> float:
    """Return the centre of the slider of a value left open: within its usual range, else its example."""
    limits = leaf.limits
    lows = [leaf.hardly[0], limits.get("gt"), limits.get("ge")]
    highs = [leaf.hardly[1], limits.get("lt"), limits.get("le")]
    low, high = (next((end for end in ends if end is not None), None) for ends in (lows, highs))
    if low is not None and high is not None:
        return math.sqrt(low * high) if low > 0.0 else 0.5 * (low + high)
    example = parse_quantity(leaf.dimension, leaf.dimension.example) if leaf.dimension is not None else 1.0
    return max(example, 2.0 * low) if low is not None and low > 0.0 else example


def slider_range(leaf: Leaf, value: float) -> SliderRange:
    """Return the range of a slider around a value, limited to usual and to possible values."""
    low, high, log = _around(leaf, value)
    usual_low, usual_high = leaf.hardly
    if usual_low is not None and value >= usual_low:
        low = max(low, usual_low)
    if usual_high is not None and value <= usual_high:
        high = min(high, usual_high)
    limits: Mapping[str, Any] = leaf.limits
    width = high - low
    for name, margin in (("ge", 0.0), ("gt", 1e-3)):
        if name in limits:
            low = max(low, limits[name] + margin * width)
    for name, margin in (("le", 0.0), ("lt", 1e-3)):
        if name in limits:
            high = min(high, limits[name] - margin * width)
    low, high = min(low, value), max(high, value)
    return SliderRange(low, high, log and low > 0.0)


def _around(leaf: Leaf, value: float) -> tuple[float, float, bool]:
    """Return (low, high, equal ratios) around a value, regardless of its limits."""
    highest = leaf.limits.get("le", leaf.limits.get("lt"))
    if leaf.kind in ("number", "count") and highest is not None and highest <= 1.0:
        return 0.0, float(highest), False
    if leaf.kind == "count":
        return max(0.0, value - 6.0), value + 6.0, False
    if leaf.kind == "temperature":
        return value - SLIDER_KELVIN, value + SLIDER_KELVIN, False
    if leaf.kind == "temperature_difference":
        return 0.0, max(2.0 * value, 20.0), False
    if leaf.kind == "angle":
        return value - SLIDER_ANGLE, value + SLIDER_ANGLE, False
    if value > 0.0:
        return value / SLIDER_FACTOR, value * SLIDER_FACTOR, True
    size = abs(value) or leaf.hardly[1] or _example(leaf)
    return (-size, size, False) if value < 0.0 else (0.0, size, False)


def presets(base: SceneArguments) -> list[dict[str, Any]]:
    """Return useful sets of changes, if the scene has the changed values and allows the changes."""
    scene = base.scene
    gaps = [name for name, active in scene.effects.items() if active.effect.needs.intersection(protocol.GAPS)]
    clearances = [f"effects.{name}.gap" for name in gaps if hasattr(scene.effects[name].parameters, "gap")]
    found = [
        _scaled(scene, "half the speed", [SPEED], 0.5),
        _scaled(scene, "twice the speed", [SPEED], 2.0),
        _scaled(scene, "gaps half as wide", clearances, 0.5),
        _scaled(scene, "gaps twice as wide", clearances, 2.0),
        {"words": "no gaps", "set": {}, "effects": dict.fromkeys(gaps, False)},
    ]
    return [preset for preset in found if (preset["set"] or preset["effects"]) and _preset_fits(base, preset)]


def _preset_fits(base: SceneArguments, preset: Mapping[str, Any]) -> bool:
    try:
        scene_of(base, overrides_of(base, Changes(preset["set"], preset["effects"])))
    except (SceneError, UsageError, Refused):
        return False
    return True


def _scaled(scene: Scene, words: str, paths: list[str], factor: float) -> dict[str, Any]:
    """Return a set of changes that multiplies quantities of the scene by a factor."""
    leaves, values = changeable_fields(scene, possible_effects(scene)), {}
    for path in paths:
        value = float(value_at(scene, path))
        unit = shown_unit(leaves[path], value)
        values[path] = f"{unit.of(factor * value)!r} {unit.name}"
    return {"words": words, "set": values, "effects": {}}
