"""The figure of a tolerance study: what grades do to the law of motion, and the spread of a compressor's figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.engineering import shown_name
from screwsim.machine.slider_crank.tolerance import Grade
from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, new_figure, plain_ticks, write_all

SHOWN = ("gas_mass_flow", "shaft_power", "isentropic_efficiency")
MARKERS = "o^s"


def draw_spread(
    table: Sequence[Grade], shifts: np.ndarray, deviations: Mapping[str, np.ndarray], folder: str | Path
) -> list[str]:
    """Write the figure (PNG, PDF) and return its paths; `deviations` are those of figures from the nominal value."""
    return write_all({"tolerance": partial(spread_figure, table, shifts, deviations)}, folder)


def spread_figure(table: Sequence[Grade], shifts: np.ndarray, deviations: Mapping[str, np.ndarray]) -> Any:
    """Draw error of the law and shift of the dead centre by grades, and figures over that shift."""
    figure = new_figure(DOUBLE, 78.0)
    left, right = figure.subplots(1, 2)
    numbers = [row.crank for row in table]
    left.semilogy(numbers, [100.0 * row.error for row in table], color=COLOURS[0], label="error of the law [%]")
    heads = [1e3 * row.head for row in table]
    left.semilogy(numbers, heads, color=COLOURS[1], linestyle=DASHES[1], label="dead centre, ± [mm]")
    left.set_xticks(numbers[::2], [f"IT{number}" for number in numbers[::2]])
    left.set(xlabel="grade of crank and rod", title="(a) law of motion")
    left.legend(loc="upper left")
    right.axhline(0.0, color=GREY, linewidth=0.4)
    for i, name in enumerate(name for name in SHOWN if name in deviations):
        style = {"color": COLOURS[i], "markersize": 2.4, "label": shown_name(name)}
        right.plot(1e3 * shifts, 100.0 * deviations[name], MARKERS[i], **style)
    low, high = right.get_ylim()
    right.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    right.set(xlabel="shift of the top dead centre [mm]", ylabel="deviation from the nominal machine [%]")
    right.set_title("(b) machines drawn")
    right.legend(loc="upper left", ncols=2)
    plain_ticks(right.xaxis, right.yaxis)
    return figure
