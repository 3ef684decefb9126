"""The measured points of a fit beside the computed ones: the lines of a table, and pictures."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from screwsim.figures import declared
from screwsim.figures.engineering import difference_unit, reading_unit, shown_name
from screwsim.figures.indicated import angle_of, pressure_at
from screwsim.outputs.customary import digits
from screwsim.outputs.display import grouped
from screwsim.printing.tables import plain_table
from screwsim.report.calibration import PREDICTED, FittedPressures, pressures_figure, residuals_figure
from screwsim.study.calibration.solve import Calibration, ComparedMeasurement

RESIDUALS, PRESSURES = "residuals", "pressures"  # names of the pictures
MOST_ANGLES = 6  # pressures of a point that have a line each; more have one together
MOST_PANELS = 12  # points whose pressures are drawn

Compared = Sequence[ComparedMeasurement]


def lines_of_points(compared: Compared) -> list[str]:
    """Return the table of measured and computed figures; many pressures of a point have one line."""
    rows, together = [], False
    for of in _by_point(compared):
        pressures = _pressures(of)
        many = len(pressures) > MOST_ANGLES
        rows += [_row(each) for each in of if not (many and each in pressures)]
        rows += [_row_of_many(pressures)] if many else []
        together |= many
    lines = plain_table(["point", "figure", "measured", "± (k=1)", "fitted", "", "residual /±"], rows, 2)
    if together:
        lines.append("of pressures: root mean squares of fitted minus measured, and of the residuals")
    if not all(each.point.fitted for each in compared):
        lines.append("* not fitted, only predicted")
    return lines


def pictures(found: Calibration) -> dict[str, Callable[[], Any]]:
    """Return what draws the residuals of the figures, and measured pressures beside the fitted ones."""
    figures = [each for each in found.compared if angle_of(each.figure) is None]
    names = [point.name for point in found.fit.points if any(each.point is point for each in figures)]
    plans: dict[str, Callable[[], Any]] = {}
    if figures:
        plans[RESIDUALS] = partial(residuals_figure, _panels(figures, names), names)
    drawn = [each for each in map(_drawn, _by_point(found.compared)) if each is not None]
    if drawn:
        plans[PRESSURES] = partial(pressures_figure, drawn[:MOST_PANELS], len(drawn) - len(drawn[:MOST_PANELS]))
    return plans


def _by_point(compared: Compared) -> list[Compared]:
    return list(grouped((each.point.name, each) for each in compared).values())


def _pressures(of: Compared) -> list[ComparedMeasurement]:
    """Return the pressures at angles of a point, by angle."""
    found = [(angle, each) for each in of if (angle := angle_of(each.figure)) is not None]
    return [each for _, each in sorted(found, key=lambda pair: pair[0])]


def _row(each: ComparedMeasurement) -> list[str]:
    factor, unit, zero = reading_unit(declared(each.figure), each.measured.value)
    ours = "none" if each.ours is None else digits(factor * each.ours - zero)
    residual = "" if each.residual is None else f"{each.residual:+.2f}"
    measured = digits(factor * each.measured.value - zero)
    own = f"{factor * each.measured.uncertainty:.2g}"
    return [_name(each), shown_name(each.figure), measured, own, ours, unit, residual]


def _row_of_many(pressures: Compared) -> list[str]:
    """Return the line of many pressures of a point: root mean squares, those without a solution left out."""
    factor, unit, _ = reading_unit(declared(pressure_at(0.0)), max(each.measured.value for each in pressures))
    first, last = (angle_of(pressures[end].figure) for end in (0, -1))
    words = f"{len(pressures)} pressures, {first:g} … {last:g} deg"
    own = f"{factor * float(np.median([each.measured.uncertainty for each in pressures])):.2g}"
    off = np.array([each.ours - each.measured.value for each in pressures if each.ours is not None])
    if not off.size:
        return [_name(pressures[0]), words, "", own, "none", unit, ""]
    over = np.array([each.residual for each in pressures if each.residual is not None])
    rms = [float(np.sqrt(np.mean(each**2))) for each in (factor * off, over)]
    return [_name(pressures[0]), words, "", own, f"{rms[0]:.2g}", unit, f"{rms[1]:.2f}"]


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


def _drawn(of: Compared) -> FittedPressures | None:
    """Return the pressures of a point for a picture; None where it has none with a solution."""
    solved = [(each, each.ours) for each in _pressures(of) if each.ours is not None]
    if not solved:
        return None
    angles, measured, width, ours = (
        np.array([angle_of(each.figure) for each, _ in solved], float),
        np.array([each.measured.value for each, _ in solved]),
        np.array([each.measured.uncertainty for each, _ in solved]),
        np.array([value for _, value in solved]),
    )
    return FittedPressures(_name(solved[0][0]), angles, measured, width, ours)
