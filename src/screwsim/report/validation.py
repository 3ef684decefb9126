"""Figures of a validation, from its document: ours as lines, theirs as points with the source's uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from screwsim.report.style import COLOURS, DASHES, DOUBLE, SINGLE, journal, new_figure, note, write

HEIGHT = 74.0  # [mm] of one row of panels
MARKERS = "os^Dv<>P"


def draw(document: Mapping[str, Any], folder: Path) -> list[str]:
    """Write a figure a source that has panels, as PNG and PDF; return the paths."""
    written = []
    with journal():
        for name, source in document["sources"].items():
            if source["panels"]:
                written += write(_figure(source), folder, name)
    return written


def _figure(source: Mapping[str, Any]) -> Any:
    panels: Sequence[Mapping[str, Any]] = source["panels"]
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    figure = new_figure(DOUBLE if columns == 2 else 1.4 * SINGLE, HEIGHT * rows)
    for axes, panel in zip(figure.subplots(rows, columns, squeeze=False).flat, panels, strict=False):
        _draw_panel(axes, panel)
    for axes in list(figure.axes)[len(panels) :]:
        axes.set_axis_off()
    note(figure, source["title"])
    return figure


def _draw_panel(axes: Any, panel: Mapping[str, Any]) -> None:
    ours = theirs = 0
    for series in panel["series"]:
        if series["theirs"]:
            _theirs(axes, series, theirs)
            theirs += 1
        else:
            _ours(axes, series, ours)
            ours += 1
    axes.set_xlabel(panel["x_label"])
    axes.set_ylabel(panel["y_label"])
    if panel["log_x"]:
        _logarithmic(axes, "x")
    if panel["log_y"]:
        _logarithmic(axes, "y")
    # above the axes, where no curve can run under it
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.01), ncols=3, columnspacing=1.2)


def _logarithmic(axes: Any, which: str) -> None:
    """Give an axis a logarithmic scale with plain numbers."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    axis = getattr(axes, f"{which}axis")
    getattr(axes, f"set_{which}scale")("log")
    axis.set_major_locator(LogLocator(base=10.0, subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def _theirs(axes: Any, series: Mapping[str, Any], index: int) -> None:
    axes.errorbar(
        series["x"],
        series["y"],
        yerr=series["error"],
        fmt=MARKERS[index % len(MARKERS)],
        color="#a01f62",
        markerfacecolor="white" if index % 2 else "#a01f62",
        markersize=4.0,
        capsize=1.5,
        elinewidth=0.6,
        label=series["name"],
        zorder=4,
    )


def _ours(axes: Any, series: Mapping[str, Any], index: int) -> None:
    line = "none" if series["points"] else DASHES[index % len(DASHES)]
    axes.plot(
        series["x"],
        series["y"],
        color=COLOURS[index % len(COLOURS)],
        linestyle=line,
        marker=MARKERS[index % len(MARKERS)] if series["points"] else None,
        label=series["name"],
        zorder=3,
    )
