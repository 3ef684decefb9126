"""Model error by validation: E = S − D for each figure, and its uncertainty.

Points to which a parameter was fitted are kept apart: the interval of a figure comes from the others alone. It is not
combined with the numerical error or the uncertainty of the inputs.

Source: ASME V&V 20-2009, section 1.5: the error of the model lies in E - u_val ... E + u_val, u_val^2 = u_num^2 +
u_input^2 + u_D^2, here with the coverage factor 2.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from screwsim.figures import declared
from screwsim.figures.errors import error_in_unit
from screwsim.outputs import EFFICIENCY, Result
from screwsim.outputs.display import grouped
from screwsim.scene import Scene
from screwsim.scene.types import COVERAGE
from screwsim.study.uncertainty.model_error import conditions_of
from screwsim.study.uncertainty.point import with_uncertainty
from screwsim.study.validation.record import ValidationPoint

UNCERTAINTY_PARTS = {"numerical": "u_num", "inputs": "u_input", "stated": "u_D"}


def is_relative(figure: str) -> bool:
    """Return whether the error of a figure is relative to its size: true except for efficiencies and temperatures."""
    about = declared(figure)
    return about.scale != EFFICIENCY and about.units != "K"


def compared(
    machine: str,
    name: str,
    scene: Scene,
    result: Result,
    theirs: Mapping[str, float],
    *,
    stated: Mapping[str, float] | None = None,
    fitted: bool = False,
) -> list[ValidationPoint]:
    """Return the comparison of a solved point with figures of a source [SI] and their standard uncertainties."""
    by_inputs = with_uncertainty(scene, result).uncertainty.get("figures", {}) if scene.uncertain else {}
    at = conditions_of(scene, result.performance)
    return [
        ValidationPoint(
            machine,
            name,
            figure,
            float(result.performance[figure]),
            float(value),
            error_in_unit(figure, result.performance, result.error),  # taken as its standard uncertainty
            by_inputs[figure]["standard"] if figure in by_inputs else None,
            (stated or {}).get(figure),
            fitted,
            at,
        )
        for figure, value in theirs.items()
    ]


def interval(point: ValidationPoint) -> tuple[float, float, float]:
    """Return E of a point, and the ends of the interval of the model error; relative to the source's value, or [SI]."""
    over = abs(point.theirs) if is_relative(point.figure) else 1.0
    found = (point.ours - point.theirs) / over
    parts = [getattr(point, name) or 0.0 for name in UNCERTAINTY_PARTS]
    u_val = math.sqrt(sum(part * part for part in parts)) / over
    return found, found - COVERAGE * u_val, found + COVERAGE * u_val


def model_errors(points: Sequence[ValidationPoint], source: str, citation: str) -> dict[str, Any]:
    """Return the model error of each machine of a source by its points, in JSON types only."""
    return {
        name: {
            "source": source,
            "citation": citation,
            "range": _condition_range([point for point in own if not point.fitted]),
            "figures": dict(_figures(own)),
        }
        for name, own in grouped((point.machine, point) for point in points).items()
    }


def _figures(points: Sequence[ValidationPoint]) -> Iterator[tuple[str, dict[str, Any]]]:
    for figure, own in grouped((point.figure, point) for point in points).items():
        mine = [[point for point in own if point.fitted is fit] for fit in (False, True)]
        parts = UNCERTAINTY_PARTS.items()
        unknown = [word for part, word in parts if any(getattr(point, part) is None for point in mine[0])]
        held, fitted = map(_statistics, mine)
        yield figure, {"relative": is_relative(figure), "held_out": held, "fitted": fitted, "not_stated": unknown}


def _statistics(points: Sequence[ValidationPoint]) -> dict[str, Any] | None:
    """Return number of points, mean of E, and the interval that covers those of all points; None without any."""
    found = [interval(point) for point in points]
    if not found:
        return None
    mean = sum(each[0] for each in found) / len(found)
    low, high = min(each[1] for each in found), max(each[2] for each in found)
    return {"points": len(found), "mean": mean, "low": low, "high": high}


def _condition_range(points: Sequence[ValidationPoint]) -> dict[str, Any]:
    """Return the ends of each condition, or its words, over some points."""
    found: dict[str, Any] = {}
    for name, values in grouped(each for point in points for each in point.at.items()).items():
        words = isinstance(values[0], str)
        found[name] = list(dict.fromkeys(values)) if words else [min(values), max(values)]
    return found
