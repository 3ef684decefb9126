"""Figure of a calibration: what is left over at each point, fitted less measured, with the uncertainty."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.report.style import COLOURS, DOUBLE, GREY, SINGLE, grid, new_figure, note, plain_ticks, write_all

HEIGHT = 62.0  # [mm] of a panel
MOST_NAMES = 16  # points whose names fit below an axis
Left = tuple[int, bool, float, float]  # number of the point, fitted, residual, uncertainty


def draw(panels: Mapping[str, Sequence[Left]], names: Sequence[str], folder: Path, name: str) -> list[str]:
    """Write a panel a figure, residuals over points, as PNG and PDF; return the paths."""
    return write_all({name: partial(_figure, panels, names)}, folder)


def _figure(panels: Mapping[str, Sequence[Left]], names: Sequence[str]) -> Any:
    columns = min(2, len(panels))
    figure = new_figure(DOUBLE if columns == 2 else 1.4 * SINGLE, HEIGHT * -(-len(panels) // columns))
    for axes, (label, left) in zip(grid(figure, len(panels), columns), panels.items(), strict=True):
        _panel(axes, label, left, names)
    some = any(not fitted for left in panels.values() for _, fitted, _, _ in left)
    told = "filled: in the fit; open: predicted" if some else ""
    note(figure, "fitted less measured, with the measurement's standard uncertainty", told)
    return figure


def _panel(axes: Any, label: str, left: Sequence[Left], names: Sequence[str]) -> None:
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    for wanted, face in ((True, COLOURS[1]), (False, "white")):
        chosen = [each for each in left if each[1] is wanted]
        if chosen:
            number, _, residual, width = zip(*chosen, strict=True)
            look = {"color": COLOURS[1], "markerfacecolor": face, "capsize": 1.5, "elinewidth": 0.6}
            axes.errorbar([each + 1 for each in number], residual, yerr=width, fmt="o", **look)
    axes.set(ylabel=label, xlim=(0.5, len(names) + 0.5))
    plain_ticks(axes.yaxis)
    if len(names) <= MOST_NAMES:
        axes.set_xticks(range(1, len(names) + 1), names, rotation=45, ha="right")
    else:
        axes.set_xlabel("point")
        plain_ticks(axes.xaxis)
