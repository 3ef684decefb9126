"""Figure of a calibration: what is left over at each point, fitted less measured, with the uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from screwsim.report.style import COLOURS, DOUBLE, GREY, SINGLE, journal, new_figure, note, plain_ticks, write

HEIGHT = 62.0  # [mm] of a panel
MOST_NAMES = 16  # points whose names fit below an axis
Left = tuple[int, bool, float, float]  # number of the point, fitted, residual, uncertainty


def draw(panels: Mapping[str, Sequence[Left]], names: Sequence[str], folder: Path, name: str) -> list[str]:
    """Write a panel a figure, residuals over points, as PNG and PDF; return the paths."""
    with journal():
        columns = min(2, len(panels))
        rows = -(-len(panels) // columns)
        figure = new_figure(DOUBLE if columns == 2 else 1.4 * SINGLE, HEIGHT * rows)
        places = list(figure.subplots(rows, columns, squeeze=False).flat)
        for axes, (label, left) in zip(places, panels.items(), strict=False):
            _panel(axes, label, left, names)
        for axes in places[len(panels) :]:
            axes.set_axis_off()
        some = any(not fitted for left in panels.values() for _, fitted, _, _ in left)
        told = "filled: in the fit; open: predicted" if some else ""
        note(figure, "fitted less measured, with the measurement's standard uncertainty", told)
        return write(figure, folder, name)


def _panel(axes: Any, label: str, left: Sequence[Left], names: Sequence[str]) -> None:
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    for wanted, face in ((True, COLOURS[1]), (False, "white")):
        chosen = [each for each in left if each[1] is wanted]
        if chosen:
            axes.errorbar(
                [each[0] + 1 for each in chosen],
                [each[2] for each in chosen],
                yerr=[each[3] for each in chosen],
                fmt="o",
                color=COLOURS[1],
                markerfacecolor=face,
                capsize=1.5,
                elinewidth=0.6,
            )
    axes.set(ylabel=label, xlim=(0.5, len(names) + 0.5))
    plain_ticks(axes.yaxis)
    if len(names) <= MOST_NAMES:
        axes.set_xticks(range(1, len(names) + 1), names, rotation=45, ha="right")
    else:
        axes.set_xlabel("point")
        plain_ticks(axes.xaxis)
