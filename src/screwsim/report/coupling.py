"""Figures of the rubber-cord coupling: cords, the angle at which they cross, torque and stiffness over the twist."""

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.machine.drive.rubber_cord_coupling import RubberCordCoupling, central_angle, crossing_angle, torque_band
from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, SINGLE, SMALL, plain_ticks, subplots, write_all

MM = 1e3  # [mm/m]


class CordLean(NamedTuple):
    """A measured lean of cords: mean, lowest, highest [rad]."""

    mean: float
    low: float
    high: float


def draw_coupling(
    coupling: RubberCordCoupling,
    drawn: RubberCordCoupling,
    leans: tuple[CordLean, ...],
    nominal: float,
    folder: str | Path,
) -> list[str]:
    """Write the figures (PNG, PDF) and return their paths; `drawn` has few cords, so that they can be seen."""
    plans = {
        "coupling_cords": partial(cords_figure, drawn),
        "coupling_crossing_angle": partial(crossing_figure, drawn),
        "coupling_torque": partial(torque_figure, coupling, leans, nominal),
    }
    return write_all(plans, folder)


def cords_figure(coupling: RubberCordCoupling, twist: float = math.radians(3.0)) -> Any:
    """Draw the cords of one layer in each direction, unloaded, and those of the + direction under a twist [rad]."""
    figure, panels = subplots(DOUBLE, 88.0, 1, 2)
    r_A, r_B = MM * coupling.inner_radius, MM * coupling.outer_radius
    starts = coupling.pitch * np.arange(coupling.cords)
    spans = [central_angle(lean, r_A, r_B) for lean in (coupling.lean_plus, -coupling.lean_minus)]
    families = (
        (panels[0], ((spans[0], 0, "direction +"), (spans[1], 2, "direction −"))),
        (panels[1], ((spans[0], 0, "unloaded"), (spans[0] + twist, 3, f"twisted by {math.degrees(twist):g}°"))),
    )
    circle = np.linspace(0.0, 2.0 * math.pi, 400)
    for axes, cords in families:
        for radius in (r_A, r_B):
            axes.plot(radius * np.cos(circle), radius * np.sin(circle), color=GREY, linewidth=1.2)
        for i, (span, colour, name) in enumerate(cords):
            x = np.array([r_A * np.cos(starts), r_B * np.cos(starts + span)])
            y = np.array([r_A * np.sin(starts), r_B * np.sin(starts + span)])
            lines = axes.plot(x, y, color=COLOURS[colour], linewidth=0.7, linestyle=DASHES[i])
            lines[0].set_label(name)
        axes.legend(loc="center")
        axes.set_aspect("equal")
        axes.set_xlabel("$x$ (mm)")
        plain_ticks(axes.xaxis, axes.yaxis)
    panels[0].set_ylabel("$y$ (mm)")
    return figure


def crossing_figure(coupling: RubberCordCoupling) -> Any:
    """Draw the crossing angle of cords of both directions, over the radius."""
    figure, axes = subplots(SINGLE, 60.0)
    radii = np.linspace(coupling.inner_radius, coupling.outer_radius, 200)
    angle = [math.degrees(crossing_angle(float(r), coupling.lean_plus, coupling.inner_radius)) for r in radii]
    axes.plot(MM * radii, angle, color=COLOURS[0])
    plain_ticks(axes.xaxis, axes.yaxis)
    axes.set(xlabel="radius of the crossing $r$ (mm)", ylabel="crossing angle $γ$ (°)")
    axes.set_xlim(MM * radii[0], MM * radii[-1])
    return figure


def torque_figure(
    coupling: RubberCordCoupling, leans: tuple[CordLean, ...], nominal: float, most: float = math.radians(3.0)
) -> Any:
    """Draw torque and tangent stiffness over the twist for measured leans; the band is the scatter of the last one."""
    figure, (left, right) = subplots(DOUBLE, 78.0, 1, 2, sharex=True)
    twists = np.linspace(0.0, most, 121)
    degrees = np.degrees(twists)
    scattered = [torque_band(coupling, float(theta), leans[-1].low, leans[-1].high) for theta in twists]
    low, high = ([1e-3 * getattr(each, name) for each in scattered] for name in ("least", "largest"))
    left.fill_between(degrees, low, high, color="#dddddd", linewidth=0.0, label="scatter of the lean")
    for i, lean in enumerate(leans):
        each = replace(coupling, lean_plus=lean.mean, lean_minus=lean.mean)
        look = {"color": COLOURS[(0, 2, 4)[i % 3]], "linestyle": DASHES[i], "label": f"{math.degrees(lean.mean):.1f}°"}
        left.plot(degrees, [1e-3 * each.torque(float(theta)) for theta in twists], **look)
        right.plot(degrees, [1e-3 * each.stiffness(float(theta)) for theta in twists], **look)
    left.axhline(1e-3 * nominal, color=GREY, linewidth=0.5, linestyle=DASHES[1])
    look = {"xytext": (-6, -3), "textcoords": "offset points", "ha": "right", "va": "top", "fontsize": SMALL}
    left.annotate("nominal", (degrees[-1], 1e-3 * nominal), **look)
    left.set_ylabel("torque $M$ (kN m)")
    right.set_ylabel("tangent stiffness d$M$/d$Θ$ (kN m/rad)")
    for axes in (left, right):
        axes.set(xlim=(0.0, degrees[-1]), ylim=(0.0, None), xlabel="twist $Θ$ (°)")
        axes.legend(loc="upper left" if axes is left else "lower right")
        plain_ticks(axes.xaxis, axes.yaxis)
    return figure
