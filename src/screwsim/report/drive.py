"""Figures of a drive: its frequencies and torques over the speed, a start-up, and its rubber-cord coupling.

Of the coupling the cords, the angle at which they cross, torque and stiffness over the twist.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.machine.drive.rubber_cord_coupling import RubberCordCoupling, central_angle, crossing_angle, torque_band
from screwsim.outputs.customary import RPM
from screwsim.report import style
from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, SINGLE, SMALL, note, plain_ticks, subplots, write_all

MM = 1e3  # [mm/m]
ORDERS = range(1, 4)  # harmonics of the lobe frequency that are drawn
MOST_TWIST = math.radians(3.0)  # [rad] drawn


class DrivePoint(NamedTuple):
    """A drive at one speed [rad/s]: torsional frequency [Hz], coupling torque [N m], ripple; None where it failed."""

    speed: float
    frequency: float | None
    mean: float | None
    amplitude: float | None
    ripple: float | None


def campbell_figure(cases: Mapping[str, Sequence[DrivePoint]], lobes: int) -> Any:
    """Draw frequencies of drives over the speed with the lobe harmonics, and the amplitude of the coupling torque."""
    figure, (left, right) = subplots(DOUBLE, 84.0, 1, 2, sharex=True)
    longest = max(points[-1].speed for points in cases.values()) / RPM
    highest = 1.6 * max(p.frequency for points in cases.values() for p in points if p.frequency is not None)
    for order in ORDERS:
        ends = np.array([0.0, longest])
        left.plot(ends, ends * order * lobes / 60.0, color=GREY, linewidth=0.6, zorder=1)
        at = min(0.93 * longest, 0.93 * highest * 60.0 / (order * lobes))
        look = {"xytext": (-3, 3), "textcoords": "offset points", "ha": "right", "va": "bottom", "fontsize": SMALL}
        left.annotate(f"{order * lobes}$n$", (at, at * order * lobes / 60.0), **look)
    for i, (name, points) in enumerate(cases.items()):
        known = [p for p in points if p.frequency is not None]
        n, look = np.array([p.speed for p in known]) / RPM, {"color": COLOURS[i], "linestyle": DASHES[i]}
        frequency = np.array([p.frequency for p in known], float)
        left.plot(n, frequency, label=name, **look)
        for order in ORDERS:
            at = crossing(n, frequency - order * lobes * n / 60.0)
            if at is not None:
                left.plot([at], [order * lobes * at / 60.0], "o", color=COLOURS[i], markersize=3.5)
                right.axvline(at, color=COLOURS[i], linewidth=0.4, linestyle=(0, (2, 2)), zorder=1)
        right.plot(n, [p.amplitude for p in known], label=name, **look)
    known = [p for p in next(iter(cases.values())) if p.mean is not None]
    n, mean = [p.speed / RPM for p in known], [p.mean for p in known]
    right.plot(n, mean, color=GREY, linestyle=DASHES[3], label="mean torque")
    left.set(xlim=(0.0, longest), ylim=(0.0, highest), ylabel="frequency (Hz)")
    right.set(yscale="log", ylim=(0.2, None), ylabel="coupling torque, amplitude (N m)")
    left.legend(loc="center right", bbox_to_anchor=(1.0, 0.3))  # below the lines of the orders
    right.legend(loc="lower left", **style.WHITE_BOX)
    for axes in (left, right):
        axes.set_xlabel("speed $n$ (rpm)")
        plain_ticks(axes.xaxis, most=6)
    plain_ticks(left.yaxis)
    return figure


def crossing(x: np.ndarray, y: np.ndarray) -> float | None:
    """Return the first zero of a curve, by linear interpolation; None without one."""
    changes = np.flatnonzero(np.sign(y[1:]) != np.sign(y[:-1]))
    if len(changes) == 0:
        return None
    i = int(changes[0])
    return float(x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i]))


def start_figure(found: Any, title: str) -> Any:
    """Draw speeds and torques of a start-up over time."""
    figure, (upper, lower) = subplots(DOUBLE, 100.0, 2, 1, sharex=True)
    t = found.traces
    upper.plot(t["time"], t["motor_speed"] / RPM, color=COLOURS[3], linestyle=DASHES[1], label="motor")
    upper.plot(t["time"], t["speed"] / RPM, color=COLOURS[0], label="rotors")
    upper.set_ylabel("speed (rpm)")
    load = t["gas_torque"] + t["loss_torque"]
    lower.plot(t["time"], load, color="#b8b8b8", linewidth=0.5, label="gas and losses")
    lower.plot(t["time"], t["motor_torque"], color=COLOURS[3], linestyle=DASHES[1], label="motor")
    lower.plot(t["time"], t["coupling_torque"], color=COLOURS[0], label="coupling")
    peak, at = found.figures["coupling_torque_peak"], found.figures["coupling_torque_peak_time"]
    lower.plot([at], [peak], "o", color=COLOURS[2], markersize=3.5)
    lower.annotate(f"{peak:.4g} N m", (at, peak), xytext=(6, 2), textcoords="offset points", fontsize=SMALL)
    lower.set(xlabel="time (s)", ylabel="torque (N m)", xlim=(0.0, float(t["time"][-1])))
    upper.legend(loc="lower right" if 2.0 * t["speed"][-1] > np.max(t["speed"]) else "upper right")
    lower.legend(loc="upper right", ncols=3)
    lower.set_ylim(top=1.28 * max(float(np.max(t[name])) for name in ("coupling_torque", "motor_torque")))
    plain_ticks(upper.yaxis, lower.yaxis, most=6)
    plain_ticks(lower.xaxis)
    note(figure, title)
    return figure


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


def cords_figure(coupling: RubberCordCoupling) -> Any:
    """Draw the cords of one layer in each direction, unloaded, and those of the + direction under the most twist."""
    figure, panels = subplots(DOUBLE, 88.0, 1, 2)
    r_A, r_B = MM * coupling.inner_radius, MM * coupling.outer_radius
    starts = coupling.pitch * np.arange(coupling.cords)
    spans = [central_angle(lean, r_A, r_B) for lean in (coupling.lean_plus, -coupling.lean_minus)]
    families = (
        (panels[0], ((spans[0], 0, "direction +"), (spans[1], 2, "direction −"))),
        (
            panels[1],
            ((spans[0], 0, "unloaded"), (spans[0] + MOST_TWIST, 3, f"twisted by {math.degrees(MOST_TWIST):g}°")),
        ),
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


def torque_figure(coupling: RubberCordCoupling, leans: tuple[CordLean, ...], nominal: float) -> Any:
    """Draw torque and tangent stiffness over the twist for measured leans; the band is the scatter of the last one."""
    figure, (left, right) = subplots(DOUBLE, 78.0, 1, 2, sharex=True)
    twists = np.linspace(0.0, MOST_TWIST, 121)
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
