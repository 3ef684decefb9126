"""Figures of a drive: torsional frequency, lobe harmonics and coupling torque over the speed; and of a start-up."""

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.report import style
from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, SMALL, note, plain_ticks, subplots, write_all

RPM = 30.0 / math.pi


class DrivePoint(NamedTuple):
    """A drive at one speed [rad/s]: torsional frequency [Hz], coupling torque [N m], ripple; None where it failed."""

    speed: float
    frequency: float | None
    mean: float | None
    amplitude: float | None
    ripple: float | None


def draw_campbell(cases: Mapping[str, Sequence[DrivePoint]], lobes: int, folder: Path, name: str) -> list[str]:
    """Write the Campbell diagram of named drives over the speed (PNG, PDF); return the paths."""
    return write_all({name: partial(campbell_figure, cases, lobes, "", 3)}, folder)


def campbell_figure(cases: Mapping[str, Sequence[DrivePoint]], lobes: int, title: str, orders: int) -> Any:
    """Draw frequencies over the speed with the lobe harmonics, and the amplitude of the coupling torque."""
    figure, (left, right) = subplots(DOUBLE, 84.0, 1, 2, sharex=True)
    longest = max(points[-1].speed for points in cases.values()) * RPM
    highest = 1.6 * max(p.frequency for points in cases.values() for p in points if p.frequency is not None)
    for order in range(1, orders + 1):
        ends = np.array([0.0, longest])
        left.plot(ends, ends * order * lobes / 60.0, color=GREY, linewidth=0.6, zorder=1)
        at = min(0.93 * longest, 0.93 * highest * 60.0 / (order * lobes))
        look = {"xytext": (-3, 3), "textcoords": "offset points", "ha": "right", "va": "bottom", "fontsize": SMALL}
        left.annotate(f"{order * lobes}$n$", (at, at * order * lobes / 60.0), **look)
    for i, (name, points) in enumerate(cases.items()):
        known = [p for p in points if p.frequency is not None]
        n, look = np.array([p.speed for p in known]) * RPM, {"color": COLOURS[i], "linestyle": DASHES[i]}
        frequency = np.array([p.frequency for p in known], float)
        left.plot(n, frequency, label=name, **look)
        for order in range(1, orders + 1):
            at = crossing(n, frequency - order * lobes * n / 60.0)
            if at is not None:
                left.plot([at], [order * lobes * at / 60.0], "o", color=COLOURS[i], markersize=3.5)
                right.axvline(at, color=COLOURS[i], linewidth=0.4, linestyle=(0, (2, 2)), zorder=1)
        right.plot(n, [p.amplitude for p in known], label=name, **look)
    known = [p for p in next(iter(cases.values())) if p.mean is not None]
    n, mean = [p.speed * RPM for p in known], [p.mean for p in known]
    right.plot(n, mean, color=GREY, linestyle=DASHES[3], label="mean torque")
    left.set(xlim=(0.0, longest), ylim=(0.0, highest), ylabel="frequency (Hz)")
    right.set(yscale="log", ylim=(0.2, None), ylabel="coupling torque, amplitude (N m)")
    left.legend(loc="center right", bbox_to_anchor=(1.0, 0.3))  # below the lines of the orders
    right.legend(loc="lower left", **style.WHITE_BOX)
    for axes in (left, right):
        axes.set_xlabel("speed $n$ (rpm)")
        plain_ticks(axes.xaxis, most=6)
    plain_ticks(left.yaxis)
    note(figure, title)
    return figure


def crossing(x: np.ndarray, y: np.ndarray) -> float | None:
    """Return the first zero of a curve, by linear interpolation; None without one."""
    changes = np.flatnonzero(np.sign(y[1:]) != np.sign(y[:-1]))
    if len(changes) == 0:
        return None
    i = int(changes[0])
    return float(x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i]))


def draw_start(found: Any, title: str, folder: str | Path) -> list[str]:
    """Write the figure of a start-up (PNG, PDF) and return the paths."""
    return write_all({"startup": partial(start_figure, found, title)}, folder)


def start_figure(found: Any, title: str) -> Any:
    """Draw speeds and torques over time."""
    figure, (upper, lower) = subplots(DOUBLE, 100.0, 2, 1, sharex=True)
    t = found.traces
    upper.plot(t["time"], RPM * t["motor_speed"], color=COLOURS[3], linestyle=DASHES[1], label="motor")
    upper.plot(t["time"], RPM * t["speed"], color=COLOURS[0], label="rotors")
    upper.set_ylabel("speed (rpm)")
    load = t["gas_torque"] + t["loss_torque"]
    lower.plot(t["time"], load, color="#b8b8b8", linewidth=0.5, label="gas and losses")
    lower.plot(t["time"], t["motor_torque"], color=COLOURS[3], linestyle=DASHES[1], label="motor")
    lower.plot(t["time"], t["coupling_torque"], color=COLOURS[0], label="coupling")
    peak, at = found.figures["coupling_torque_peak"], found.figures["coupling_torque_peak_time"]
    lower.plot([at], [peak], "o", color=COLOURS[2], markersize=3.5)
    lower.annotate(f"{peak:.4g} N m", (at, peak), xytext=(6, 2), textcoords="offset points", fontsize=SMALL)
    lower.set(xlabel="time (s)", ylabel="torque (N m)", xlim=(0.0, float(t["time"][-1])))
    upper.legend(loc="lower right")
    lower.legend(loc="upper right", ncols=3)
    lower.set_ylim(top=1.28 * max(float(np.max(t[name])) for name in ("coupling_torque", "motor_torque")))
    plain_ticks(upper.yaxis, lower.yaxis, most=6)
    plain_ticks(lower.xaxis)
    note(figure, title)
    return figure
