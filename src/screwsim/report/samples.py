"""Figure of a design in which several quantities vary together: efficiency over each of them, one point per case."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from screwsim.report.families import efficiency_name, is_joint_sample
from screwsim.report.quantities import is_numeric, shown_axis, shown_figure
from screwsim.report.style import COLOURS, DOUBLE, grid, new_figure, note
from screwsim.report.sweeps import Plan, label_axes
from screwsim.results import Results
from screwsim.results.schema import Axis
from screwsim.results.warning_kinds import cases_with_warnings

_MOST = 5000  # most points drawn in a panel


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
