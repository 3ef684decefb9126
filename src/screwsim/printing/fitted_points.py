"""The measured points of a fit beside the computed ones: the lines of a table, and pictures."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from screwsim.figures import declared
from screwsim.figures.curves import Reading, reading_of
from screwsim.figures.engineering import difference_unit, reading_unit, shown_name
from screwsim.inputs.suggestions import counted
from screwsim.outputs.customary import digits
from screwsim.outputs.display import grouped
from screwsim.printing.tables import plain_table
from screwsim.report.calibration import PREDICTED, FittedCurve, curves_figure, residuals_figure
from screwsim.report.quantities import shown_curve
from screwsim.study.calibration.solve import Calibration, ComparedMeasurement

RESIDUALS = "residuals"  # name of the picture; those of curves have the names of these
MOST_ANGLES = 6  # values of a point's curve that have a line each; more have one together
MOST_PANELS = 12  # points whose values of a curve are drawn

Compared = Sequence[ComparedMeasurement]


def lines_of_points(compared: Compared) -> list[str]:
    """Return the table of measured and computed figures; many values of a curve of a point have one line."""
    rows, together = [], {}
    for of in _by_point(compared):
        many = {curve: values for curve, values in _curves(of).items() if len(values) > MOST_ANGLES}
        rows += [_row(each) for each in of if not any(each in values for values in many.values())]
        rows += [_row_of_many(curve, values) for curve, values in many.items()]
        together |= many
    lines = plain_table(["point", "figure", "measured", "± (k=1)", "fitted", "", "residual /±"], rows, 2)
    if together:
        names = " and ".join(map(_plural, together))
        lines.append(f"of {names}: root mean squares of fitted minus measured, and of the residuals")
    if not all(each.point.fitted for each in compared):
        lines.append("* not fitted, only predicted")
    return lines


def pictures(found: Calibration) -> dict[str, Callable[[], Any]]:
    """Return what draws the residuals of the figures, and measured curves beside the fitted ones, each by its name."""
    figures = [each for each in found.compared if reading_of(each.figure) is None]
    names = [point.name for point in found.fit.points if any(each.point is point for each in figures)]
    plans: dict[str, Callable[[], Any]] = {}
    if figures:
        plans[RESIDUALS] = partial(residuals_figure, _panels(figures, names), names)
    every = [(curve, values) for of in _by_point(found.compared) for curve, values in _curves(of).items()]
    for curve, points in grouped(every).items():
        drawn = [each for each in map(_drawn, points) if each is not None]
        if drawn:
            shown = shown_curve(curve, max(float(np.max(np.abs(each.measured))) for each in drawn))
            plan = partial(curves_figure, shown, drawn[:MOST_PANELS], max(0, len(drawn) - MOST_PANELS))
            plans[_plural(curve).replace(" ", "_")] = plan
    return plans


def _by_point(compared: Compared) -> list[Compared]:
    return list(grouped((each.point.name, each) for each in compared).values())


def _curves(of: Compared) -> dict[str, list[ComparedMeasurement]]:
    """Return {curve: its values at angles} of a point, by angle."""
    found = grouped((reading.curve, each) for each in of if (reading := reading_of(each.figure)) is not None)
    return {curve: sorted(values, key=_angle) for curve, values in found.items()}


def _angle(each: ComparedMeasurement) -> float:
    """Return the angle [degree] at which a value of a curve was measured."""
    reading = reading_of(each.figure)
    assert reading is not None
    return reading.angle


def _plural(curve: str) -> str:
    """Return the word for values of a curve."""
    return counted(2, shown_name(curve)).partition(" ")[2]


def _row(each: ComparedMeasurement) -> list[str]:
    factor, unit, zero = reading_unit(declared(each.figure), each.measured.value)
    ours = "none" if each.ours is None else digits(factor * each.ours - zero)
    residual = "" if each.residual is None else f"{each.residual:+.2f}"
    measured = digits(factor * each.measured.value - zero)
    own = f"{factor * each.measured.uncertainty:.2g}"
    return [_name(each), shown_name(each.figure), measured, own, ours, unit, residual]


def _row_of_many(curve: str, values: Compared) -> list[str]:
    """Return the line of many values of a point's curve: root mean squares, those without a solution left out."""
    about = declared(Reading(curve, 0.0).figure)
    factor, unit = difference_unit(about, max(each.measured.value for each in values))
    words = f"{len(values)} {_plural(curve)}, {_angle(values[0]):g} … {_angle(values[-1]):g} deg"
    own = f"{factor * float(np.median([each.measured.uncertainty for each in values])):.2g}"
    off = np.array([each.ours - each.measured.value for each in values if each.ours is not None])
    if not off.size:
        return [_name(values[0]), words, "", own, "none", unit, ""]
    over = np.array([each.residual for each in values if each.residual is not None])
    rms = [float(np.sqrt(np.mean(each**2))) for each in (factor * off, over)]
    return [_name(values[0]), words, "", own, f"{rms[0]:.2g}", unit, f"{rms[1]:.2f}"]


def _name(each: ComparedMeasurement) -> str:
    return each.point.name + ("" if each.point.fitted else PREDICTED)


def _panels(compared: Compared, names: Sequence[str]) -> dict[str, list[tuple[int, bool, float, float]]]:
    """Return {label of a figure: [(number of the point, fitted, residual, uncertainty)]} in the unit of the label."""
    panels: dict[str, list[tuple[int, bool, float, float]]] = {}
    for figure, of in grouped((each.figure, each) for each in compared).items():
        factor, unit = difference_unit(declared(figure), max(abs(each.measured.value) for each in of))
        label = f"{shown_name(figure)} ({unit})" if unit else shown_name(figure)
        panels[label] = []
        for each in of:
            number, (value, uncertainty) = names.index(each.point.name), each.measured
            if each.ours is not None:
                panels[label].append((number, each.point.fitted, factor * (each.ours - value), factor * uncertainty))
    return panels


def _drawn(values: Compared) -> FittedCurve | None:
    """Return the values of a point's curve for a picture; None where none has a solution."""
    solved = [(each, each.ours) for each in values if each.ours is not None]
    if not solved:
        return None
    angles, measured, width, ours = (
        np.array([_angle(each) for each, _ in solved]),
        np.array([each.measured.value for each, _ in solved]),
        np.array([each.measured.uncertainty for each, _ in solved]),
        np.array([value for _, value in solved]),
    )
    return FittedCurve(_name(solved[0][0]), angles, measured, width, ours)
