"""Contour maps over two axes of a sweep: efficiency with the optimum of each row, cooling capacity, COP."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from screwsim.inputs.suggestions import counted
from screwsim.report import families
from screwsim.report.families import Family, curves_of, is_log, left_out, slices
from screwsim.report.quantities import is_numeric, short, shown_axis, shown_figure
from screwsim.report.style import SINGLE, log_scale, note, plain_ticks, subplots
from screwsim.report.sweeps import Plan
from screwsim.results import Results
from screwsim.results.schema import Axis

OPTIMUM_FIGURES = "efficiency"
_FEWEST = 3  # least number of values on each axis of a map
_LEVELS = 18
_COOLING = ("cooling_capacity", "cop")
_FINE = 61  # points per axis for drawing contours: few points would give corners
_BEYOND = 0.02  # of the values' span: a smooth surface that exceeds them by more invents a maximum,
_APART = 0.08  # one that differs more from the shape-preserving one invents a valley
_POINTS_SHOWN = 150  # most computed points that are marked
_OPTIMA_SHOWN = 14  # approximate number of optima with a circle; the line is through all


def plans(results: Results) -> Iterator[Plan]:
    """Yield maps for each slice of a sweep over two numeric axes with three values or more each."""
    whole = families.family_of(results, by_fluid=False)
    if whole is None or whole.by is None or families.outcome_family(results) is not None:
        return
    if not all(is_numeric(axis) and len(axis.values) >= _FEWEST for axis in _axes(whole)):
        return
    for family in slices(whole):
        for name, word in (("map", families.efficiency_name(results)), *((f"map_{each}", each) for each in _COOLING)):
            if word is not None and len(curves_of(family, word)) >= _FEWEST:
                yield f"{name}{family.suffix}", partial(_draw, family, word)


def _draw(family: Family, name: str) -> Any:
    """Draw filled contours with a scale; the map is white where a case has no result."""
    figure, axes = subplots(SINGLE, 76.0)
    found = draw_contours(axes, family, name)
    curves = curves_of(family, name)
    optima = "○ optimum of a row, by a parabola through three points" if found else ""
    counts = zip(families.doubtful(curves), ("not closed", "with warnings"), strict=True)
    told = [f"{counted(count, 'case')} {words}" for count, words in counts if count]
    note(figure, family.constant, optima, *told, left_out(family, curves), _error_words(family.results, name))
    return figure


def _error_words(results: Results, name: str) -> str:
    """Return the largest effect of numerical errors on the drawn figure; empty where none were estimated."""
    if name not in results.error or not np.isfinite(errors := results.absolute_error(name)).any():
        return ""
    shown = shown_figure(results, name)
    unit = "points" if shown.unit == "%" else shown.unit
    return f"numerical error at most {short(float(f'{np.nanmax(errors) * shown.factor:.1g}'))} {unit}".rstrip()


def draw_contours(axes: Any, family: Family, name: str) -> int:
    """Draw filled contours into axes, with their scale beside them; return how many optima are marked."""
    x, y, z = _surface(family, name)
    points = np.array([(x[j], y[i]) for i, j in np.argwhere(~np.ma.getmaskarray(z))])
    x, y, z = _refined(x, y, z)
    levels = _levels(z)
    filled = axes.contourf(x, y, z, levels=levels, cmap="viridis", extend="neither")
    axes.contour(x, y, z, levels=levels, colors="black", linewidths=0.3)
    axes.tick_params(which="both", pad=5.0)  # separates the labels of both axes in the corner
    bar = axes.figure.colorbar(filled, ax=axes, ticks=levels[:: 1 + len(levels) // 10], pad=0.03, aspect=28)
    bar.ax.tick_params(which="both", length=2.0)
    bar.ax.minorticks_off()
    bar.set_label(shown_figure(family.results, name).label)
    if len(points) <= _POINTS_SHOWN:
        axes.plot(*points.T, ".", color="black", markersize=1.6, clip_on=False, in_layout=False)
    found = _optima(axes, family, name) if OPTIMUM_FIGURES in name and family.chosen else 0
    for axis, swept in zip((axes.xaxis, axes.yaxis), _axes(family), strict=True):
        axis.set_label_text(shown_axis(swept).label)
        values = shown_axis(swept).of(swept.values)
        if is_log(values):
            log_scale(axes, float(np.max(values) / np.min(values)), axis.axis_name)
        else:
            plain_ticks(axis)
    return found


def _refined(x: np.ndarray, y: np.ndarray, z: Any) -> tuple[np.ndarray, np.ndarray, Any]:
    """Return the surface on a finer grid, by a smooth bicubic spline, so that a ridge stays one between points.

    If that exceeds the range of the values, or is far from shape-preserving cubics along one axis and then the other
    (Fritsch & Carlson 1980), as with few distant speeds, those cubics replace it: no maximum and no valley is drawn
    that was not computed. A surface with gaps, or with many values, is left as it is.
    """
    from scipy.interpolate import RectBivariateSpline, pchip_interpolate

    if np.ma.getmaskarray(z).any() or max(len(x), len(y)) > _FINE:
        return x, y, z
    logs, z = (is_log(x), is_log(y)), np.asarray(z)
    u, v = (np.log(values) if log else values for values, log in zip((x, y), logs, strict=True))
    fine_u, fine_v = (np.unique(np.concatenate([np.linspace(w[0], w[-1], _FINE), w])) for w in (u, v))
    surface = RectBivariateSpline(v, u, z, kx=min(3, len(v) - 1), ky=min(3, len(u) - 1))(fine_v, fine_u)
    shaped = pchip_interpolate(u, pchip_interpolate(v, z, fine_v, axis=0), fine_u, axis=1)
    span = z.max() - z.min()
    beyond, apart = max(surface.max() - z.max(), z.min() - surface.min()), np.abs(surface - shaped).max()
    if beyond > _BEYOND * span or apart > _APART * span:
        surface = shaped
    fine_x, fine_y = (np.exp(w) if log else w for w, log in zip((fine_u, fine_v), logs, strict=True))
    return fine_x, fine_y, surface


def _surface(family: Family, name: str) -> tuple[Any, Any, Any]:
    """Return the sorted values of both axes and the figure (y, x), masked where a case failed."""
    results = family.results
    x, y = (shown_axis(axis).of(axis.values) for axis in _axes(family))
    values = shown_figure(results, name).of(results.performance[name])
    values = np.where(np.asarray(results.status) == "failed", np.nan, values)
    columns, rows = np.argsort(x), np.argsort(y)
    return x[columns], y[rows], np.ma.masked_invalid(family.rows(values)[rows][:, columns])


def _axes(family: Family) -> tuple[Axis, Axis]:
    assert family.by_axis is not None
    return family.x_axis, family.by_axis


def _levels(z: Any) -> np.ndarray:
    """Return contour levels at round numbers that span the values."""
    from matplotlib.ticker import MaxNLocator

    low, high = float(z.min()), float(z.max())
    if not high > low:
        low, high = low - 0.5, high + 0.5
    return np.asarray(MaxNLocator(_LEVELS, steps=[1, 2, 5, 10]).tick_values(low, high))


def _optima(axes: Any, family: Family, name: str) -> int:
    """Draw a circle at the optimum of each row and a line through them; return their number."""
    x, y, z = _surface(family, name)
    points = []
    for height, row in zip(y, z, strict=True):
        there = ~np.ma.getmaskarray(row)
        best = families.optimum(x[there], row[there].data) if np.count_nonzero(there) >= _FEWEST else None
        if best is not None:
            points.append((best[0], height))
    if points:
        style = {"linewidth": 0.8, "markeredgecolor": "black", "markevery": 1 + len(points) // _OPTIMA_SHOWN}
        axes.plot(*np.transpose(points), "o-", color="white", clip_on=False, **style)
    return len(points)
