"""Figures of a sweep: efficiency over one axis with one curve per value of another, and likewise other figures.

Where the oil ratio is an outcome of the speed, as of a displacement supply: efficiency over it (the paper's Fig. 2).
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from screwsim.report import families
from screwsim.report.annotate import label_along, label_ends
from screwsim.report.families import Curve, Family, curves_of, is_log, left_out, slices
from screwsim.report.quantities import RATIO, SPEED, shown_axis, shown_figure
from screwsim.report.style import (
    DOUBLE,
    SINGLE,
    line_style,
    log_scale,
    new_figure,
    note,
    panels,
    plain_ticks,
    subplots,
    upright,
)
from screwsim.results import Results

Plan = tuple[str, Callable[[], Any]]  # name of a figure, and the function that draws it
OTHER_FIGURES = (
    "package_specific_power",
    "free_air_delivered",
    "volumetric_efficiency",
    "shaft_power",
    "gas_mass_flow",
    "discharge_temperature",
    "intermediate_pressure",
    "cooling_capacity",
    "cop",
)
CURVE = "curve"  # gid of the line of a curve
_LEAST_SPAN = 0.01  # of an axis over its values, so that numerical noise is not magnified
_BAND = 0.16  # opacity of a band
_MOST_CURVES, _CURVES_SHOWN = 16, 9  # more curves than the first number are unreadable: the second is drawn
_POINTS_SHOWN = 60  # most computed points in a panel that are marked


def plans(results: Results) -> Iterator[Plan]:
    """Yield the figures over the axes of a sweep, or over the oil ratio that is an outcome; none without numbers."""
    whole, outcome = families.family_of(results), families.outcome_family(results)
    name = families.efficiency_name(results)
    if outcome is not None and name is not None:
        for family in slices(outcome):
            if curves_of(family, name, "oil_ratio"):
                yield f"efficiency_ratio{family.suffix}", partial(_over_ratio, family, name)
    if whole is None or outcome is not None:
        return
    for family in slices(whole):
        if name and curves_of(family, name):
            yield f"efficiency{family.suffix}", partial(_efficiency, family, name)
        if any(curves_of(family, other) for other in OTHER_FIGURES):
            yield f"performance{family.suffix}", partial(_performance, family)


def _efficiency(family: Family, name: str) -> Any:
    """Draw an efficiency over x, with the optimum of each curve marked if x is chosen (the paper's Fig. 1)."""
    results = family.results
    curves, kept = thinned(every := curves_of(family, name))
    figure, axes = subplots(SINGLE, 70.0)
    found = draw_curves(axes, curves, optima=family.chosen)
    label_axes(axes, shown_axis(family.x_axis).label, shown_figure(results, name).label, [c.x for c in curves])
    heading, words = families.curves_heading(family)
    told = (*remarks(curves, found), families.band_words(results, curves))
    note(figure, family.constant, words, kept, *told, left_out(family, every))
    if family.by is not None:
        label_curves([(axes, curves)], heading)
    return figure


def _performance(family: Family) -> Any:
    """Draw the other figures over x, one panel each."""
    results, x_label = family.results, shown_axis(family.x_axis).label
    every = {name: curves for name in OTHER_FIGURES if (curves := curves_of(family, name))}
    shown = {name: thinned(curves)[0] for name, curves in every.items()}
    figure, places = panels(len(shown), 18.0, 52.0)
    for axes, (name, curves) in zip(places, shown.items(), strict=True):
        draw_curves(axes, curves, optima=False)
        label_axes(axes, x_label, shown_figure(results, name).label, [c.x for c in curves])
    widest = max(every.values(), key=len)
    heading, words = families.curves_heading(family)
    drawn, kept = thinned(widest)
    told = (kept, *remarks(drawn, 0), families.band_words(results, drawn))
    note(figure, family.constant, words, *told, left_out(family, widest))
    if family.by is not None:
        label_curves(zip(places, shown.values(), strict=True), heading)
    return figure


def _over_ratio(family: Family, name: str) -> Any:
    """Draw the efficiency over d, with the speed along the curve, and both over the speed."""
    results = family.results
    figure = new_figure(DOUBLE, 82.0)
    places = figure.add_gridspec(2, 2, width_ratios=(1.15, 1.0))
    main, upper, lower = (figure.add_subplot(place) for place in (places[:, 0], places[0, 1], places[1, 1]))
    over_ratio = curves_of(family, name, "oil_ratio")
    found = draw_curves(main, over_ratio, optima=True)
    label_axes(main, RATIO.label, shown_figure(results, name).label, [curve.x for curve in over_ratio], 0.06)
    over_speed = [(upper, curves_of(family, name)), (lower, curves_of(family, "oil_ratio"))]
    for (axes, curves), figure_name in zip(over_speed, (name, "oil_ratio"), strict=True):
        draw_curves(axes, curves, optima=False)
        label_axes(axes, SPEED.label, shown_figure(results, figure_name).quantity, [curve.x for curve in curves])
    upper.set_xlabel("")
    upper.tick_params(labelbottom=False)
    heading, words = families.curves_heading(family)
    told = (*remarks(over_ratio, found), families.band_words(results, over_ratio))
    note(figure, family.constant, words, *told, left_out(family, over_ratio))
    if family.by is None:
        label_along(main, over_ratio[0].x, over_ratio[0].y, [f"{speed:.0f} rpm" for speed in over_ratio[0].at])
    else:
        label_curves(over_speed, heading)
    return figure


def thinned(curves: list[Curve]) -> tuple[list[Curve], str]:
    """Return a readable number of curves, evenly chosen including both ends, and a remark on it; '' if all are kept."""
    if len(curves) <= _MOST_CURVES:
        return curves, ""
    chosen = np.unique(np.linspace(0, len(curves) - 1, _CURVES_SHOWN).round().astype(int))
    return [curves[i] for i in chosen], f"{len(chosen)} of {len(curves)} curves"


def draw_curves(axes: Any, curves: list[Curve], optima: bool, looks: Sequence[Mapping[str, Any]] | None = None) -> int:
    """Draw curves, with crosses where a case did not close, triangles for warnings, circles at optima; count these.

    `looks` are properties of the lines, by default colours and dashes in their order; their gid is `CURVE`. A band
    around a curve shows the tolerances of its inputs, if any. The parabola of an optimum is drawn thin, since it may
    leave the straight lines between distant points.
    """
    found = 0
    marker = "." if sum(len(curve.x) for curve in curves) <= _POINTS_SHOWN else "None"
    for i, curve in enumerate(curves):
        style = line_style(i, len(curves)) if looks is None else looks[i]
        axes.plot(curve.x, curve.y, gid=CURVE, **style)
        if curve.banded:
            axes.fill_between(curve.x, curve.low, curve.high, color=style["color"], alpha=_BAND, linewidth=0.0)
        look = {"color": style["color"], "markersize": 3.0, "markeredgewidth": 0.6}
        mark_cases(axes, curve.x, curve.y, curve.closed, curve.warned, marker, **look)
        best = families.optimum(curve.x, curve.y) if optima else None
        fitted = families.optimum_arc(curve.x, curve.y) if best is not None else None
        if best is not None and fitted is not None:
            axes.plot(*fitted, color=style["color"], linewidth=0.5, linestyle="-")
            axes.plot(*best, "o", color=style["color"], markerfacecolor="white", markeredgewidth=0.9, zorder=3)
            found += 1
    return found


def mark_cases(
    axes: Any, x: np.ndarray, y: np.ndarray, closed: np.ndarray, warned: np.ndarray, marker: str, **look: Any
) -> None:
    """Draw a marker for each case, a triangle for warnings, a cross where it did not close.

    The frame does not clip them, and the layout makes no room for them.
    """
    for kept, shape in ((closed & ~warned, marker), (warned, "^"), (~closed, "x")):
        axes.plot(x[kept], y[kept], marker=shape, linestyle="", clip_on=False, in_layout=False, **look)


def label_curves(panels: Iterable[tuple[Any, list[Curve]]], heading: str) -> None:
    """Label the curves of all axes of a figure at their ends."""
    ends = [(axes, [(c.x[-1], c.y[-1]) for c in curves], [c.text for c in curves]) for axes, curves in panels]
    label_ends(ends, heading)


def label_axes(axes: Any, x_label: str, y_label: str, x: list[np.ndarray], room: float = 0.0) -> None:
    """Label both axes; x spans its values, with room on either side, and is logarithmic if they suit that."""
    axes.set(xlabel=x_label, ylabel=upright(y_label))
    values = np.concatenate(x)
    if is_log(values):
        log_scale(axes, float(np.max(values) / np.min(values)))
    axes.set_xlim(float(np.min(values)), float(np.max(values)))
    if room:
        axes.margins(x=room)
        axes.autoscale(axis="x")
    low, high = axes.dataLim.intervaly
    span = max(1.14 * (high - low), _LEAST_SPAN * max(abs(low), abs(high)))
    axes.set_ylim(0.5 * (low + high) - 0.5 * span, 0.5 * (low + high) + 0.5 * span)
    plain_ticks(axes.yaxis)
    if not is_log(values):
        plain_ticks(axes.xaxis)


def remarks(curves: list[Curve], optima: int) -> tuple[str, str, str]:
    """Return the meaning of circles, crosses and triangles, where there are any."""
    told = "○ optimum, top of a parabola (thin) through three points" if optima else ""
    return told, *case_remarks(*families.doubtful(curves))


def case_remarks(not_closed: int, warned: int) -> tuple[str, str]:
    """Return the meaning of crosses and triangles, where there are any."""
    return f"× not closed ({not_closed})" if not_closed else "", f"△ with warnings ({warned})" if warned else ""
