"""Figures of sweeps without curves, a point for each case: over words, such as fluids, or over joint quantities."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from screwsim.report import families
from screwsim.report.families import FEWEST, Family, efficiency_name, missing_words, slices
from screwsim.report.quantities import is_numeric, shown_axis, shown_figure
from screwsim.report.style import COLOURS, GREY, note, panels, plain_ticks
from screwsim.report.sweeps import OTHER_FIGURES, Plan, case_remarks, label_axes, mark_cases
from screwsim.results import Results
from screwsim.results.schema import Axis, quantities_along
from screwsim.results.warning_kinds import cases_with_warnings

_MARGIN = 0.08  # of the span of the values, on either side
_MOST = 5000  # most points drawn in a panel
_MARKERS = (".", "s", "D", "v")  # of words beyond the number of colours


def plans(results: Results) -> Iterator[Plan]:
    """Yield the figures over words, or the scatter figure of a design in which several quantities vary together."""
    if not families.is_joint_sample(results):
        yield from _plans_over_words(results)
        return
    varied = (axis for axis in quantities_along(results.axis_list) if is_numeric(axis) and np.ptp(axis.values) > 0.0)
    name, shown = efficiency_name(results), [(axis, results.along(axis.path)) for axis in varied]
    if not len(results.optimum) and name and shown:
        yield "samples", partial(_over_each, results, shown, name)


def _plans_over_words(results: Results) -> Iterator[Plan]:
    """Yield the figures over the longest axis of words (over fluids, if they vary); none where numbers vary."""
    axes = results.axis_list
    lengths = [0 if is_numeric(axis) else len(axis.values) + (axis.path == families.FLUID) * 10_000 for axis in axes]
    if families.family_of(results) is not None or max(lengths, default=0) < FEWEST:
        return
    place = int(np.argmax(lengths))
    for family in slices(Family(results, place, None)):
        names = filter(None, (efficiency_name(results), *OTHER_FIGURES))
        shown = [name for name in names if _has_value(family, name).any()]
        if shown and len(axes[place].values) >= FEWEST:
            name = axes[place].path.rpartition(".")[2]
            yield f"{name}{family.suffix}", partial(_over_words, family, shown)


def _has_value(family: Family, name: str) -> np.ndarray:
    """Return for which words a figure has a value."""
    results = family.results
    if name not in results.performance:
        return np.zeros(1, bool)
    return np.isfinite(family.part(results.performance[name])) & (family.part(results.status) != "failed")


def _over_words(family: Family, shown: list[str]) -> Any:
    """Draw each figure in one panel, with the words from top to bottom in their order."""
    results, status = family.results, family.part(family.results.status)
    words = [str(value) for value in family.x_axis.values]
    figure, places = panels(len(shown), 10.0, 16.0 + 5.0 * len(words), sharey=True)
    closed = status == "ok"
    warned = family.part(cases_with_warnings(results)) & closed
    for axes, name in zip(places, shown, strict=True):
        how, kept = shown_figure(results, name), _has_value(family, name)
        values = how.of(family.part(results.performance[name]))
        x = values[kept]
        mark_cases(axes, x, np.flatnonzero(kept), closed[kept], warned[kept], "o", color=COLOURS[1], markersize=4.0)
        span = max(float(np.ptp(x)), 0.01 * float(np.max(np.abs(x))), 1e-9)
        axes.set_xlim(x.min() - _MARGIN * span, x.min() + (1.0 + _MARGIN) * span)
        plain_ticks(axes.xaxis)
        axes.set_xlabel(how.label)
        axes.set_yticks(range(len(words)), words)
        axes.set_ylim(len(words) - 0.4, -0.6)
        axes.grid(axis="y", color=GREY, linewidth=0.3, linestyle=(0, (1, 3)))
        axes.tick_params(axis="y", which="both", left=False, right=False)
    found = int(np.max([_has_value(family, name).sum() for name in shown]))
    open_ = ~closed & (status != "failed")
    told = case_remarks(int(np.count_nonzero(open_)), int(np.count_nonzero(warned)))
    note(figure, family.constant, *told, missing_words(len(words), found))
    return figure


def _over_each(results: Results, shown: list[tuple[Axis, np.ndarray]], name: str) -> Any:
    how = shown_figure(results, name)
    y = how.of(results.performance[name]).reshape(-1)
    status = results.status.reshape(-1)
    kept = np.flatnonzero(np.isfinite(y) & (status != "failed"))
    drawn = kept[:: 1 + len(kept) // _MOST]
    open_ = drawn[status[drawn] != "ok"]
    closed = drawn[status[drawn] == "ok"]
    words = _words(results)
    figure, places = panels(len(shown), 18.0, 52.0, sharey=True)
    for axes, (axis, values) in zip(places, shown, strict=True):
        x = shown_axis(axis).of(values.reshape(-1))
        marks = {"linestyle": "", "markersize": 4.0}
        for number, word in enumerate(dict.fromkeys(words)):
            own = closed[words[closed] == word]
            colour, marker = COLOURS[(number + 1) % len(COLOURS)], _MARKERS[number // len(COLOURS) % len(_MARKERS)]
            axes.plot(x[own], y[own], marker=marker, color=colour, label=word, **marks)
        axes.plot(x[open_], y[open_], marker="x", color=COLOURS[2], markeredgewidth=0.6, **marks)
        label_axes(axes, shown_axis(axis).label, how.label, [x[drawn]], room=0.04)
    if words[0]:
        figure.legend(*places[0].get_legend_handles_labels(), loc="outside upper right", ncols=3)
    thinned = f"{len(drawn)} of {len(kept)} points drawn" if len(drawn) < len(kept) else ""
    warned = int(np.count_nonzero(cases_with_warnings(results).reshape(-1)[kept]))
    told = f"{warned} of {len(kept)} cases with warnings" if warned else ""
    parts = case_remarks(len(open_), 0)[0], told, missing_words(len(y), len(kept)), thinned
    note(figure, *parts, share=0.5 if words[0] else 1.0)
    return figure


def _words(results: Results) -> np.ndarray:
    """Return the word of each case on the first axis of words, such as fluids; empty without one."""
    words = (axis for axis in quantities_along(results.axis_list) if not is_numeric(axis))
    path = next((axis.path for axis in words if len(set(axis.values.tolist())) > 1), None)
    every = np.full(results.shape, "") if path is None else results.along(path)
    return np.array([str(word) for word in every.reshape(-1)])
