"""Figures without curves, one point per case.

Of a design in which several quantities vary together: the efficiency over each of them. Of a sweep over words only,
such as fluids: one panel per figure.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from screwsim.report.families import FLUID, Layout, efficiency_name, is_joint_sample, layout_of, slices
from screwsim.report.quantities import is_numeric, shown_axis, shown_figure
from screwsim.report.style import COLOURS, DOUBLE, GREY, grid, new_figure, note, plain_ticks
from screwsim.report.sweeps import OTHER_FIGURES, Plan, label_axes
from screwsim.results import Results
from screwsim.results.schema import Axis
from screwsim.results.warning_kinds import cases_with_warnings

_MOST = 5000  # most points drawn in a panel
_FEWEST = 2
_MARGIN = 0.08  # of the span of the values, on either side


def plans(results: Results) -> Iterator[Plan]:
    """Yield the scatter figure of a design; none for a product of axes."""
    name = efficiency_name(results)
    if (
        is_joint_sample(results)
        and not len(results.optimum)
        and name is not None
        and (shown := varied_columns(results))
    ):
        yield "samples", partial(_draw, results, shown, name)


def varied_columns(results: Results) -> list[tuple[Axis, np.ndarray]]:
    """Return each varied numeric quantity with its values [SI] on the axes of the results."""
    axes = (inner for axis in results.axis_list for inner in axis.joined or (axis,))
    return [(axis, results.along(axis.path)) for axis in axes if is_numeric(axis) and np.ptp(axis.values) > 0.0]


def _draw(results: Results, shown: list[tuple[Axis, np.ndarray]], name: str) -> Any:
    how = shown_figure(results, name)
    y = how.of(results.performance[name]).reshape(-1)
    status = results.status.reshape(-1)
    kept = np.flatnonzero(np.isfinite(y) & (status != "failed"))
    drawn = kept[:: 1 + len(kept) // _MOST]
    open_ = drawn[status[drawn] != "ok"]
    closed = drawn[status[drawn] == "ok"]
    rows = (len(shown) + 1) // 2
    figure = new_figure(DOUBLE, 18.0 + 52.0 * rows)
    for axes, (axis, values) in zip(grid(figure, len(shown), sharey=True), shown, strict=True):
        x = shown_axis(axis).of(values.reshape(-1))
        marks = {"linestyle": "", "markersize": 4.0}
        axes.plot(x[closed], y[closed], marker=".", color=COLOURS[1], **marks)
        axes.plot(x[open_], y[open_], marker="x", color=COLOURS[2], markeredgewidth=0.6, **marks)
        label_axes(axes, shown_axis(axis).label, how.label, [x[drawn]])
        axes.margins(x=0.04)
        axes.autoscale(axis="x")
    missing = f"{len(y) - len(kept)} of {len(y)} cases without a result left out" if len(kept) < len(y) else ""
    thinned = f"{len(drawn)} of {len(kept)} points drawn" if len(drawn) < len(kept) else ""
    warned = int(np.count_nonzero(cases_with_warnings(results).reshape(-1)[kept]))
    told = f"{warned} of {len(kept)} cases with warnings" if warned else ""
    note(figure, f"× not closed ({len(open_)})" if len(open_) else "", told, missing, thinned)
    return figure


def word_plans(results: Results) -> Iterator[Plan]:
    """Yield the figures over the longest axis of words (over fluids, if they vary); none where numbers vary."""
    axes = results.axis_list
    lengths = [0 if is_numeric(axis) else len(axis.values) + (axis.path == FLUID) * 10_000 for axis in axes]
    if is_joint_sample(results) or layout_of(results) is not None or max(lengths, default=0) < _FEWEST:
        return
    place = int(np.argmax(lengths))
    layout = Layout(place, None, tuple(number for number in range(len(axes)) if number != place))
    for suffix, constant, chosen in slices(results, layout):
        names = filter(None, (efficiency_name(results), *OTHER_FIGURES))
        shown = [name for name in names if _has_value(results, chosen, name).any()]
        if shown and len(axes[place].values) >= _FEWEST:
            name = axes[place].path.rpartition(".")[2]
            yield f"{name}{suffix}", partial(_draw_words, results, place, chosen, constant, shown)


def _values_of_slice(values: np.ndarray, chosen: dict[int, int]) -> np.ndarray:
    return np.asarray(values)[tuple(chosen.get(number, slice(None)) for number in range(np.ndim(values)))]


def _has_value(results: Results, chosen: dict[int, int], name: str) -> np.ndarray:
    """Return for which words a figure has a value."""
    if name not in results.performance:
        return np.zeros(1, bool)
    return np.isfinite(_values_of_slice(results.performance[name], chosen)) & (
        _values_of_slice(results.status, chosen) != "failed"
    )


def _draw_words(results: Results, place: int, chosen: dict[int, int], constant: str, shown: list[str]) -> Any:
    """Draw each figure in one panel, with the words from top to bottom in their order."""
    words = [str(value) for value in results.axis_list[place].values]
    rows = (len(shown) + 1) // 2
    figure = new_figure(DOUBLE, 10.0 + rows * (16.0 + 5.0 * len(words)))
    closed = _values_of_slice(results.status, chosen) == "ok"
    warned = _values_of_slice(cases_with_warnings(results), chosen) & closed
    for axes, name in zip(grid(figure, len(shown), sharey=True), shown, strict=True):
        how, kept = shown_figure(results, name), _has_value(results, chosen, name)
        values = how.of(_values_of_slice(results.performance[name], chosen))
        _panel(axes, values[kept], np.flatnonzero(kept), closed[kept], warned[kept])
        axes.set_xlabel(how.label)
        axes.set_yticks(range(len(words)), words)
        axes.set_ylim(len(words) - 0.4, -0.6)
        axes.grid(axis="y", color=GREY, linewidth=0.3, linestyle=(0, (1, 3)))
        axes.tick_params(axis="y", which="both", left=False, right=False)
    missing = len(words) - int(np.max([_has_value(results, chosen, name).sum() for name in shown]))
    told = (
        f"× not closed ({np.count_nonzero(~closed & (_values_of_slice(results.status, chosen) != 'failed'))})",
        f"△ with warnings ({np.count_nonzero(warned)})",
    )
    left_out = f"{missing} of {len(words)} cases without a result left out" if missing else ""
    note(figure, constant, *(text for text in told if not text.endswith("(0)")), left_out)
    return figure


def _panel(axes: Any, x: np.ndarray, y: np.ndarray, closed: np.ndarray, warned: np.ndarray) -> None:
    plain = closed & ~warned
    for kept, marker in ((plain, "o"), (warned, "^"), (~closed, "x")):
        axes.plot(x[kept], y[kept], marker, color=COLOURS[1], markersize=4.0, clip_on=False, in_layout=False)
    span = max(float(np.ptp(x)), 0.01 * float(np.max(np.abs(x))), 1e-9)
    axes.set_xlim(x.min() - _MARGIN * span, x.min() + (1.0 + _MARGIN) * span)
    plain_ticks(axes.xaxis)
