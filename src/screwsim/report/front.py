"""Figures of an optimisation: the Pareto front among all evaluations, and each objective over what was varied."""

import itertools
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from screwsim.report.quantities import Display, is_numeric, shown_axis, shown_figure
from screwsim.report.style import COLOURS, DOUBLE, GREY, SINGLE, note, panels, plain_ticks, upright
from screwsim.report.sweeps import Plan, label_axes
from screwsim.results import Results
from screwsim.results.optimum import AIM
from screwsim.results.schema import Axis

_MOST = 5000  # most evaluations drawn in a panel; those of the front are all drawn
_LIGHT = "#b9b9b9"  # evaluations that are not best


def plans(results: Results) -> Iterator[Plan]:
    """Yield the figures of an optimisation; none for other results."""
    names = objective_names(results)
    if len(names) > 1:
        yield "front", partial(_front, results, names)
    if names and _varied(results):
        yield "evaluations", partial(_evaluations, results, names)


def _varied(results: Results) -> list[Axis]:
    """Return the paths that were varied; none where a scene was rated over operating points as it is."""
    return [axis for axis in results.axis_list[0].joined if is_numeric(axis)]


def objective_names(results: Results) -> list[str]:
    """Return the figures that are objectives; none where the file was not written by a search for an optimum."""
    return [name.removeprefix(AIM) for name in results.optimum if name.startswith(AIM)]


def front_of(results: Results) -> np.ndarray:
    """Return the evaluations of the Pareto front, ordered by the first objective."""
    front = np.flatnonzero(results.optimum["front"] == 1)
    return front[np.argsort(results.optimum[AIM + objective_names(results)[0]][front], kind="stable")]


def _columns(results: Results, name: str) -> tuple[Display, np.ndarray]:
    how = shown_figure(results, name)
    return how, how.of(results.optimum[AIM + name])


def _rows(results: Results) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the evaluations to be drawn: within the bounds, outside, and on the front."""
    feasible, front = results.optimum["feasible"] == 1, results.optimum["front"] == 1
    solved = np.all([np.isfinite(results.optimum[AIM + name]) for name in objective_names(results)], axis=0)
    inside, outside = np.flatnonzero(feasible & ~front), np.flatnonzero(solved & ~feasible)
    return inside[:: 1 + len(inside) // _MOST], outside[:: 1 + len(outside) // _MOST], np.flatnonzero(front)


def _remarks(results: Results) -> tuple[str, str]:
    _, outside, front = _rows(results)
    feasible = int(np.count_nonzero(results.optimum["feasible"] == 1))
    best = f"dark: {len(front)} that no other beats" if len(front) > 1 else "dark: the best"
    beyond = ", × outside" if len(outside) else ""
    return best, f"{feasible} of {len(results.optimum['front'])} evaluations within the bounds{beyond}"


def _front(results: Results, names: list[str]) -> Any:
    """Draw each pair of objectives: all evaluations, and the front, as a line if there are two objectives."""
    pairs = list(itertools.combinations(names, 2))
    inside, outside, front = _rows(results)
    columns = min(len(pairs), 2)
    figure, places = panels(len(pairs), 0.0, 72.0, columns, SINGLE if columns == 1 else DOUBLE)
    for axes, (first, second) in zip(places, pairs, strict=True):
        (across, x), (up, y) = _columns(results, first), _columns(results, second)
        _draw_others(axes, x, y, inside, outside)
        order = front[np.argsort(x[front])]
        line = {"linestyle": "-" if len(names) == 2 else "", "linewidth": 0.8}
        axes.plot(x[order], y[order], marker=".", color=COLOURS[1], markersize=4.0, **line)
        axes.set(xlabel=across.label, ylabel=upright(up.label))
        plain_ticks(axes.xaxis, axes.yaxis)
        axes.margins(0.05)
    note(figure, *_remarks(results))
    return figure


def _draw_others(axes: Any, x: np.ndarray, y: np.ndarray, inside: np.ndarray, outside: np.ndarray) -> None:
    axes.plot(x[inside], y[inside], ".", color=_LIGHT, markersize=3.0)
    axes.plot(x[outside], y[outside], "x", color=_LIGHT, markersize=3.0, markeredgewidth=0.4)


def _evaluations(results: Results, names: list[str]) -> Any:
    """Draw each objective over each path that was varied."""
    varied = _varied(results)
    inside, outside, front = _rows(results)
    pairs = [(name, axis) for name in names for axis in varied]
    columns = min(len(varied), 3) if len(pairs) > 1 else 1
    figure, places = panels(len(pairs), 8.0, 50.0, columns, DOUBLE if columns > 1 else SINGLE)
    for axes, (name, axis) in zip(places, pairs, strict=True):
        how, y = _columns(results, name)
        across = shown_axis(axis)
        x = across.of(axis.values)
        _draw_others(axes, x, y, inside, outside)
        axes.plot(x[front], y[front], ".", color=COLOURS[1], markersize=5.0)
        label_axes(axes, across.label, how.label, [x], room=0.04)
        if len(front) == 1:
            axes.axvline(x[front[0]], color=GREY, linewidth=0.4)
    note(figure, *_remarks(results))
    return figure
