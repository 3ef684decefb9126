"""What a validation says of the model's error, told for a scene that names it: is the scene like what was validated?

It is another part than the numerical error and what the inputs make of a figure, and is added to neither.

Source: ASME V&V 20-2009; the stored statements are those of `screwsim validate` (study.validation.discrepancy).
"""

from collections.abc import Iterator, Mapping
from typing import Any

from screwsim.scene import Scene
from screwsim.scene.model_errors import RATIO, SPEED, WORDS, shown_condition, stored

SLACK = 0.01  # of a value: by so much it may lie beyond what was validated


def conditions_of(scene: Scene, performance: Mapping[str, Any]) -> dict[str, Any]:
    """Return what tells whether a point is like others: kind of machine, fluid, speed [rad/s], pressure ratio."""
    found = {"machine.kind": scene.machine.kind, "gas.fluid": scene.gas.name, SPEED: float(scene.operation.speed)}
    ratio = performance.get(RATIO)
    return found if ratio is None else {**found, RATIO: float(ratio)}


def model_error(scene: Scene, performance: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the validation that a scene names says of its figures [SI]; empty where it names none.

    `low` and `high` are the ends between which the error of the model lies at the points held out, of a figure of this
    size; `outside` says in which respects the scene is not like them.
    """
    if not scene.model_error:
        return {}
    told = stored()[scene.model_error]
    figures = {}
    for name, each in told["figures"].items():
        value, held = performance.get(name), each["held_out"]
        if value is None or held is None:
            continue
        size = abs(value) if each["relative"] else 1.0
        figures[name] = {end: size * held[end] for end in ("mean", "low", "high")} | {
            "points": held["points"],
            "not_stated": each["not_stated"],
        }
    outside = list(_outside(told["range"], conditions_of(scene, performance)))
    return {"of": scene.model_error, "citation": told["citation"], "figures": figures, "outside": outside}


def _outside(known: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """Yield in what, and by how much, conditions are not those that were validated."""
    for name, value in here.items():
        ends = known.get(name)
        if ends is None:
            continue
        if isinstance(value, str):
            if value not in ends:
                yield f"{WORDS[name]} {value} ({', '.join(ends)})"
        elif not ends[0] - SLACK * abs(ends[0]) <= value <= ends[1] + SLACK * abs(ends[1]):
            shown, low, high = (shown_condition(name, each) for each in (value, *ends))
            yield f"{WORDS[name]} {shown} ({low if low == high else f'{low} to {high}'})"
