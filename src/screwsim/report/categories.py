"""Figure of a sweep over words only, such as fluids: one point per word, in one panel per figure."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from screwsim.report.families import FLUID, Layout, efficiency_name, is_joint_sample, layout_of, slices
from screwsim.report.quantities import is_numeric, shown_figure
from screwsim.report.style import COLOURS, DOUBLE, GREY, grid, new_figure, note, plain_ticks
from screwsim.report.sweeps import OTHER_FIGURES, Plan
from screwsim.results import Results
from screwsim.results.warning_kinds import cases_with_warnings

_FEWEST = 2
_MARGIN = 0.08  # of the span of the values, on either side


def plans(results: Results) -> Iterator[Plan]:
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
            yield f"{name}{suffix}", partial(_draw, results, place, chosen, constant, shown)


def _values_of_slice(values: np.ndarray, chosen: dict[int, int]) -> np.ndarray:
    return np.asarray(values)[tuple(chosen.get(number, slice(None)) for number in range(np.ndim(values)))]


def _has_value(results: Results, chosen: dict[int, int], name: str) -> np.ndarray:
    """Return for which words a figure has a value."""
    if name not in results.performance:
        return np.zeros(1, bool)
    return np.isfinite(_values_of_slice(results.performance[name], chosen)) & (
        _values_of_slice(results.status, chosen) != "failed"
    )


def _draw(results: Results, place: int, chosen: dict[int, int], constant: str, shown: list[str]) -> Any:
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
