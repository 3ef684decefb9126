"""Figure of a displacement supply, in which the oil ratio is an outcome of the speed (the paper's Fig. 2)."""

from collections.abc import Iterator
from functools import partial
from typing import Any

from screwsim.report import families
from screwsim.report.annotate import label_along
from screwsim.report.families import Layout, curves_of_slice, left_out, slices
from screwsim.report.quantities import RATIO, SPEED, shown_figure
from screwsim.report.style import DOUBLE, new_figure, note
from screwsim.report.sweeps import Plan, draw_curves, label_axes, label_curves, remarks
from screwsim.results import Results


def plans(results: Results) -> Iterator[Plan]:
    """Yield the figures of a sweep over the speed in which the oil ratio is an outcome."""
    layout, name = families.outcome_layout(results), families.efficiency_name(results)
    if layout is None or name is None:
        return
    for suffix, constant, chosen in slices(results, layout):
        if curves_of_slice(results, layout, chosen, "oil_ratio", name):
            yield f"efficiency_ratio{suffix}", partial(_draw, results, layout, chosen, constant, name)


def _draw(results: Results, layout: Layout, chosen: dict[int, int], constant: str, name: str) -> Any:
    """Draw the efficiency over d, with the speed along the curve, and both over the speed."""
    figure = new_figure(DOUBLE, 82.0)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.15, 1.0))
    main, upper, lower = (figure.add_subplot(place) for place in (grid[:, 0], grid[0, 1], grid[1, 1]))
    over_ratio = curves_of_slice(results, layout, chosen, "oil_ratio", name)
    found = draw_curves(main, over_ratio, optima=True)
    label_axes(main, RATIO.label, shown_figure(results, name).label, [curve.x for curve in over_ratio])
    main.margins(x=0.06)
    main.autoscale(axis="x")
    for axes, figure_name in ((upper, name), (lower, "oil_ratio")):
        curves = curves_of_slice(results, layout, chosen, None, figure_name)
        draw_curves(axes, curves, optima=False)
        label_axes(axes, SPEED.label, shown_figure(results, figure_name).quantity, [curve.x for curve in curves])
    upper.set_xlabel("")
    upper.tick_params(labelbottom=False)
    heading, words = families.curves_heading(results, layout)
    told = (*remarks(over_ratio, found), families.band_words(results, over_ratio))
    note(figure, constant, words, *told, left_out(results, layout, chosen, over_ratio))
    if layout.curves is None:
        label_along(main, over_ratio[0].x, over_ratio[0].y, [f"{speed:.0f} rpm" for speed in over_ratio[0].at])
        return figure
    names = ((upper, name), (lower, "oil_ratio"))
    label_curves(((axes, curves_of_slice(results, layout, chosen, None, shown)) for axes, shown in names), heading)
    return figure
