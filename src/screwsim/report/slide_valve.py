"""Figure of a slide valve: what it uncovers of a chamber at five positions, and what that leaves of the volume."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from screwsim.machine.rotors.curves import closed_in, make_curves
from screwsim.machine.rotors.rotors import Rotors
from screwsim.machine.rotors.settings import SlideValve
from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, new_figure, plain_ticks

POSITIONS = (0.0, 0.25, 0.5, 0.75, 1.0)
CM2 = 1e4  # [cm²/m²]
LEAST = 1e-6  # of the travel: the slot is open, and as narrow as can be


def slide_figure(rotors: Rotors, volume_ratio: float, axial_ratio: float | None, slide: SlideValve) -> Any:
    """Draw the slot to suction and the discharge port over the angle, and volume and volume ratio over the position."""
    figure = new_figure(DOUBLE, 118.0)
    upper, lower = figure.subplots(2, 2, gridspec_kw={"width_ratios": (1.7, 1.0)})
    known = [make_curves(rotors, volume_ratio, axial_ratio, replace(slide, position=x)) for x in POSITIONS]
    for i, (x, curves) in enumerate(zip(POSITIONS, known, strict=True)):
        style = {"color": COLOURS[i], "linestyle": DASHES[i], "label": f"{100 * x:.0f} %"}
        if curves.slot is not None:
            upper[0].plot(np.degrees(curves.slot.angle), CM2 * curves.slot.value, **style)
        parts = curves.discharge
        both = CM2 * (parts["axial"].value + parts["radial"].value)
        lower[0].plot(np.degrees(parts["axial"].angle), both, **style)
    axial = known[-1].discharge["axial"]
    line = lower[0].plot(np.degrees(axial.angle), CM2 * axial.value, color=GREY, linewidth=0.6)
    for axes, label in ((upper[0], "slot to suction (cm²)"), (lower[0], "discharge port (cm²)")):
        axes.set(xlim=(0.0, math.degrees(rotors.life)), ylim=(0.0, None), ylabel=label)
        axes.axvline(math.degrees(known[0].suction_closes), color=GREY, linewidth=0.5, linestyle=(0, (1, 2)), zorder=1)
        plain_ticks(axes.yaxis, most=5)
    upper[0].annotate(
        "largest volume", (math.degrees(known[0].suction_closes), 1.02), xycoords=("data", "axes fraction"), ha="center"
    )
    lower[0].set_xlabel("angle of the chamber's life (°)")
    upper[0].legend(title="position", loc="upper left")
    lower[0].legend(line, ["axial part alone"], loc="upper left")
    _over_position(rotors, volume_ratio, axial_ratio, slide, (upper[1], lower[1]))
    return figure


def _over_position(
    rotors: Rotors, volume_ratio: float, axial_ratio: float | None, slide: SlideValve, panels: Any
) -> None:
    moved = np.linspace(LEAST, 1.0, 21)
    found = [
        closed_in(rotors, make_curves(rotors, volume_ratio, axial_ratio, replace(slide, position=x))) for x in moved
    ]
    full = closed_in(rotors, make_curves(rotors, volume_ratio, axial_ratio))
    labels = (100.0, "closed-in volume (% of the largest)"), (1.0, "volume ratio")
    for axes, k, (factor, label) in zip(panels, (0, 1), labels, strict=True):
        axes.plot(100.0 * moved, [factor * each[k] for each in found], color=COLOURS[0])
        axes.plot(0.0, factor * full[k], "o", color=COLOURS[0], markersize=3.5, label="full load, slot shut")
        axes.set(ylabel=label, xlim=(-4.0, 100.0), ylim=(0.0, None))
        plain_ticks(axes.yaxis, most=5)
    panels[0].legend(loc="lower left")
    panels[1].set_xlabel("position (% of the travel)")
