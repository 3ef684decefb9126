"""Figures of a validation, from its document: ours as lines, the source's as points with their uncertainty."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.report.style import COLOURS, DASHES, DOUBLE, SINGLE, log_scale, note, panels, write_all

HEIGHT = 74.0  # [mm] of one row of panels
MARKERS = "os^Dv<>P"
SOURCE_COLOUR = COLOURS[2]
OWN_COLOURS = tuple(colour for colour in COLOURS if colour != SOURCE_COLOUR)
LEGEND_CHARACTERS = 58  # characters that fit side by side above a panel, including handles
HANDLE_CHARACTERS = 7  # width of a handle in characters


def draw(document: Mapping[str, Any], folder: Path) -> list[str]:
    """Write one figure per source that has panels, as PNG and PDF; return the paths."""
    drawn = {name: source for name, source in document["sources"].items() if source["panels"]}
    return write_all({name: partial(_figure, source) for name, source in drawn.items()}, folder)


def _figure(source: Mapping[str, Any]) -> Any:
    columns = min(2, len(source["panels"]))
    width = DOUBLE if columns == 2 else 1.4 * SINGLE
    figure, places = panels(len(source["panels"]), 0.0, HEIGHT, columns, width)
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
