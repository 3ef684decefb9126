"""Model error of figures: what the validation that a scene names says of points like it (ASME V&V 20-2009)."""

from collections.abc import Iterator, Mapping
from typing import Any

from screwsim.scene import Scene
from screwsim.scene.model_errors import (
    CONDITION_WORDS,
    RATIO,
    SIZE,
    SPEED,
    TEMPERATURES,
    shown_condition,
    stored_model_errors,
)

RANGE_MARGIN = 0.01  # of a value: margin by which it may lie outside the validated range ...
TEMPERATURE_MARGIN = 0.5  # [K] ... and of a temperature


def conditions_of(scene: Scene, performance: Mapping[str, Any]) -> dict[str, Any]:
    """Return the conditions by which points are compared: kind of machine, fluid, speed [rad/s]; of the figures some.

    These are the displacement [m³], the pressure ratio and both saturation temperatures [K], as far as there are any.
    """
    found = {"machine.kind": scene.machine.kind, "gas.fluid": scene.gas.name, SPEED: float(scene.operation.speed)}
    figures = {name: performance.get(name) for name in (SIZE, RATIO, *TEMPERATURES)}
    return found | {name: float(value) for name, value in figures.items() if value is not None}


def model_error(scene: Scene, performance: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the validation that a scene names says of its figures [SI]; empty where it names none.

    `low` and `high` are the ends between which the model error lies at the held-out points, scaled to the figure's
    size; `outside` lists the respects in which the scene lies outside the validated conditions.
    """
    if not scene.model_error:
        return {}
    told = stored_model_errors()[scene.model_error]
    figures = {}
    for name, each in told["figures"].items():
        value, held = performance.get(name), each["held_out"]
        if value is None or held is None:
            continue
        size = abs(value) if each["relative"] else 1.0
        ends = {end: size * held[end] for end in ("mean", "low", "high")}
        figures[name] = ends | {"points": held["points"], "not_stated": each["not_stated"]}
    outside = list(_outside(told["range"], conditions_of(scene, performance)))
    return {"of": scene.model_error, "citation": told["citation"], "figures": figures, "outside": outside}


def outside_warning(model: Mapping[str, Any]) -> str:
    """Return the warning on a model error (of `model_error`) that was not found under a scene's conditions."""
    where = f"outside the validated range of {model['of']}"
    return f"{where}, so the model's error may differ: {'; '.join(model['outside'])}"


def _outside(known: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """Yield the conditions that differ from the validated ones, and by how much."""
    for name, value in here.items():
        ends = known.get(name)
        if ends is None:
            continue
        if isinstance(value, str):
            if value not in ends:
                yield f"{CONDITION_WORDS[name]} {value} ({', '.join(ends)})"
        elif not ends[0] - _margin(name, ends[0]) <= value <= ends[1] + _margin(name, ends[1]):
            shown, low, high = (shown_condition(name, each) for each in (value, *ends))
            yield f"{CONDITION_WORDS[name]} {shown} ({low if low == high else f'{low} to {high}'})"


def _margin(name: str, end: float) -> float:
    return TEMPERATURE_MARGIN if name in TEMPERATURES else RANGE_MARGIN * abs(end)
