"""Figures of evidence: a validation beside its sources, and what accuracy costs.

Of a validation ours are lines, the source's values points with their uncertainty; of accuracy the error of the
performance figures is drawn over time and over evaluations, on logarithmic axes.
"""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, SINGLE, log_scale, note, panels, subplots, write_all

ROW_HEIGHT, HEIGHT = 74.0, 92.0  # [mm] of one row of panels of a validation, of the figure of accuracy
MARKERS = "os^Dv<>P"
SOURCE_COLOUR = COLOURS[2]
OWN_COLOURS = tuple(colour for colour in COLOURS if colour != SOURCE_COLOUR)
LEGEND_CHARACTERS = 58  # characters that fit side by side above a panel, including handles
HANDLE_CHARACTERS = 7  # width of a handle in characters
FIRST = (*COLOURS, "#8a8a8a", "#a89000")  # eight methods, each with its own colour, line and marker
LINES = (*DASHES, (0, (1, 0.8)), (0, (7, 2.5)))


def draw_validation(document: Mapping[str, Any], folder: Path) -> list[str]:
    """Write one figure per source that has panels, as PNG and PDF; return the paths."""
    drawn = {name: source for name, source in document["sources"].items() if source["panels"]}
    return write_all({name: partial(_validation, source) for name, source in drawn.items()}, folder)


def _validation(source: Mapping[str, Any]) -> Any:
    columns = min(2, len(source["panels"]))
    width = DOUBLE if columns == 2 else 1.4 * SINGLE
    figure, places = panels(len(source["panels"]), 0.0, ROW_HEIGHT, columns, width)
    for axes, panel in zip(places, source["panels"], strict=True):
        _draw_panel(axes, panel)
    note(figure, source["title"])
    return figure


def _draw_panel(axes: Any, panel: Mapping[str, Any]) -> None:
    ours = theirs = bands = 0
    for series in panel["series"]:
        if series["upper"] is not None:
            look = {"color": OWN_COLOURS[bands % len(OWN_COLOURS)], "label": series["name"] or "_nolegend_"}
            axes.fill_between(series["x"], series["y"], series["upper"], alpha=0.2, linewidth=0.0, **look)
            bands += 1
        elif series["theirs"]:
            mark = {"fmt": MARKERS[theirs % len(MARKERS)], "markersize": 4.0, "capsize": 1.5, "elinewidth": 0.6}
            mark |= {"color": SOURCE_COLOUR, "markerfacecolor": "white" if theirs % 2 else SOURCE_COLOUR}
            axes.errorbar(series["x"], series["y"], yerr=series["error"], label=series["name"], zorder=4, **mark)
            theirs += 1
        else:
            line, marker = DASHES[ours % len(DASHES)], None
            if series["points"]:
                line, marker = "none", MARKERS[ours % len(MARKERS)]
            look = {"color": OWN_COLOURS[ours % len(OWN_COLOURS)], "linestyle": line, "marker": marker}
            axes.plot(series["x"], series["y"], label=series["name"], zorder=3, **look)
            ours += 1
    axes.set(xlabel=panel["x_label"], ylabel=panel["y_label"])
    for which in "xy":
        if panel[f"log_{which}"]:
            log_scale(axes, 1.0, which)
    # above the axes, so that it covers no curve
    _, labels = axes.get_legend_handles_labels()
    longest = max(map(len, labels), default=1) + HANDLE_CHARACTERS
    columns = max(1, min(3, LEGEND_CHARACTERS // longest))
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.01), ncols=columns, columnspacing=1.2)


def accuracy_figure(study: Any) -> Any:
    """Draw what accuracy costs by a study (`study.accuracy.Study`): error over time, and over evaluations."""
    figure, (left, right) = subplots(DOUBLE, HEIGHT, 1, 2, sharey=True)
    cases = [each for each in study.comparable if each.status == "ok"]
    for axes, scale, cost in ((left, 1e3, "time"), (right, 1.0, "evaluations")):
        if best := study.front(cost):
            x, y = [scale * getattr(each, cost) for each in best], [each.error for each in best]
            axes.plot(x, y, color="#c9c9c9", linewidth=6.0, zorder=1, solid_capstyle="round")
        for index, label in enumerate(dict.fromkeys(case.label for case in cases)):
            mine = [case for case in cases if case.label == label]
            x, y = [scale * getattr(each, cost) for each in mine], [each.error for each in mine]
            colour, dashes, marker = (kinds[index % len(kinds)] for kinds in (FIRST, LINES, MARKERS))
            mark = {"marker": marker, "markersize": 4.5, "markerfacecolor": colour if index % 2 == 0 else "white"}
            name = label.replace("scipy-", "scipy ")
            axes.plot(x, y, color=colour, linestyle=dashes, label=name, zorder=3, **mark)
        _guides(axes, study)
        axes.set(xscale="log", yscale="log")
    left.set(xlabel="wall time / ms", ylabel="largest relative error of a figure")
    right.set_xlabel("evaluations of one chamber's right-hand side")
    handles, names = left.get_legend_handles_labels()
    if study.front():
        from matplotlib.lines import Line2D

        handles.append(Line2D([], [], color="#c9c9c9", linewidth=6.0))
        names.append("Pareto front")
    figure.legend(handles, names, loc="outside upper center", ncols=4)
    return figure


def _guides(axes: Any, study: Any) -> None:
    """Draw two levels: below one the references differ, below the other regularisation dominates the error."""
    levels = (
        (study.limit_of_regularisation, "regularisation", "right"),
        (study.reference.difference, "references differ", "left"),
    )
    for level, text, side in levels:
        if level is None or not level > 0.0:
            continue
        axes.axhline(level, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0)
        place, way = (1.0, -3) if side == "right" else (0.0, 3)
        box = {"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.85}
        look = {"ha": side, "color": GREY, "fontsize": 6.5, "bbox": box, "zorder": 2}
        at = {"xycoords": ("axes fraction", "data"), "xytext": (way, 2), "textcoords": "offset points"}
        axes.annotate(text, (place, level), **at, **look)
