"""Figures of one cycle: the p–V loop, the states over the angle, the flow of each path, and the gas torque.

The torque is drawn over two lobe pitches, with its harmonics of the lobe frequency.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from screwsim.figures.indicated import Indicated
from screwsim.report import style
from screwsim.report.annotate import label_points
from screwsim.report.indicated import draw_over_angle, draw_over_volume
from screwsim.report.quantities import ANGLE, GAS_MASS, MASS_FLOW, PRESSURE, TEMPERATURE, VOLUME, short
from screwsim.report.style import COLOURS, DASHES, GREY, SINGLE, SMALL, note, plain_ticks, subplots
from screwsim.report.trace import Trace, chosen_trace, flow_paths, pressure_limit, temperature_limits
from screwsim.results import Results

_LIFTS = {"suction_valve_lift": "suction valve", "discharge_valve_lift": "discharge valve"}
_BESIDE_LEGEND = 0.75  # of the width
_NEAR = 170.0  # [degree] closer marks have their texts side by side, not centred
_VANISHING = 10.0  # ratio of the largest flows of two paths from which the smaller is a line at zero
_HARMONICS = 10
_FINE = 720  # points of a pitch for the spectrum


def plans(results: Results, measured: Indicated | None = None) -> Iterator[tuple[str, Any]]:
    """Yield the figures of the stored cycle (in a sweep that of its best case), with measured pressures if given."""
    trace = chosen_trace(results)
    if trace is None:
        return
    yield "pressure_volume", partial(_loop, trace, measured)
    yield "states", partial(_states, trace, measured)
    if flow_paths(trace.values):
        yield "mass_flows", partial(_flows, trace)
    if any(name in trace.values for name in _LIFTS):
        yield "valve_lifts", partial(_valves, trace)
    torque = trace.values.get("gas_torque")
    if np.isfinite(trace.male_lobes) and torque is not None and np.isfinite(torque).all():
        yield "gas_torque", partial(_torque, trace, 360.0 / trace.male_lobes)


def _valves(trace: Trace) -> Any:
    """Draw the lifts of both valves over the angle, and the pressure above them."""
    figure, (upper, lower) = subplots(SINGLE, 84.0, 2, 1, sharex=True)
    clipped = _pressure(upper, trace)
    for i, (name, words) in enumerate(_LIFTS.items()):
        lower.plot(trace.angle, trace.values[name], color=COLOURS[i + 1], linestyle=DASHES[i], label=words)
    lower.axhline(1.0, color=GREY, linewidth=0.4)
    lower.set_ylim(-0.1, 1.45)  # room for the legend
    lower.legend(loc="upper center", ncols=2)
    lower.set(xlabel=trace.axis.label, ylabel="lift over that of the stop")
    for axes in (upper, lower):
        _angle_axis(axes, trace)
    note(figure, trace.title, clipped)
    return figure


def _loop(trace: Trace, measured: Indicated | None) -> Any:
    """Draw pressure over volume, with the lines' pressures and the points where oil enters and ports open."""
    figure, axes = subplots(SINGLE, 68.0)
    clipped, V, p = _draw_loop(axes, trace)
    if measured is not None:
        draw_over_volume(axes, measured, trace)
    note(figure, trace.title, clipped)
    # the free corner is above and to the right of the compression line
    axes.figure.draw_without_rendering()
    labels = [(at, text, ((1, 1), (-1, 1))) for text, at in marked_points(axes, trace, V, p)]
    label_points(axes, labels, axes.transData.transform(np.column_stack([V, p])))
    return figure


def draw_loop(axes: Any, trace: Trace) -> None:
    """Draw pressure over volume into axes, with named circles at the marked angles."""
    _, V, p = _draw_loop(axes, trace)
    for text, at in marked_points(axes, trace, V, p):
        axes.annotate(text, at, (6, 6), textcoords="offset points", fontsize=SMALL)


def marked_points(axes: Any, trace: Trace, x: Any, y: Any) -> Iterator[tuple[str, tuple[float, float]]]:
    """Draw a circle on a loop (x, y) at each marked angle, and yield its text and place."""
    for text, angle in trace.marks.items():
        at = float(np.interp(angle, trace.angle, x)), float(np.interp(angle, trace.angle, y))
        axes.plot(*at, "o", color=COLOURS[0], markerfacecolor="white", markeredgewidth=0.9, zorder=3)
        yield f"{text}, {short(angle)}°", at


def _draw_loop(axes: Any, trace: Trace) -> tuple[str, Any, Any]:
    """Draw the loop alone; return the note on what exceeds the axes, and volume and pressure as shown."""
    V, p = trace.values["volume"] * VOLUME.factor, trace.values["pressure"] * PRESSURE.factor
    axes.plot(V, p, color=COLOURS[0])
    clipped = _pressure_axis(axes, trace)
    axes.set_xlim(-0.02 * float(np.nanmax(V)), 1.05 * float(np.nanmax(V)))
    axes.set(xlabel=VOLUME.label, ylabel=PRESSURE.label)
    plain_ticks(axes.xaxis)
    return clipped, V, p


def _states(trace: Trace, measured: Indicated | None) -> Any:
    """Draw pressure, temperatures and gas mass over the angle, one below another."""
    figure, (upper, middle, lower) = subplots(SINGLE, 130.0, 3, 1, sharex=True)
    clipped = _pressure(upper, trace)
    if measured is not None:
        draw_over_angle(upper, measured)
    if _temperatures(middle, trace):
        middle.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    hidden = _temperature_axis(middle, trace)
    lower.plot(trace.angle, trace.values["gas_mass"] * GAS_MASS.factor, color=COLOURS[0])
    lower.set(xlabel=trace.axis.label, ylabel=GAS_MASS.label, ylim=(0.0, None))
    for axes in (upper, middle, lower):
        _angle_axis(axes, trace)
    # texts of close marks point away from each other
    marks = list(trace.marks.items())
    for i, (text, angle) in enumerate(marks):
        near_left = i > 0 and angle - marks[i - 1][1] < _NEAR
        near_right = i + 1 < len(marks) and marks[i + 1][1] - angle < _NEAR
        side = "left" if near_left else "right" if near_right else "center"
        style.name_above(upper, angle, text, side)
    note(figure, trace.title, clipped, hidden)
    return figure


def _pressure(axes: Any, trace: Trace) -> str:
    axes.plot(trace.angle, trace.values["pressure"] * PRESSURE.factor, color=COLOURS[0])
    axes.set_ylabel(PRESSURE.label)
    return _pressure_axis(axes, trace)


def _temperatures(axes: Any, trace: Trace) -> bool:
    """Draw the gas temperature, and the oil's if present; return whether it is."""
    axes.plot(trace.angle, TEMPERATURE.of(trace.values["gas_temperature"]), color=COLOURS[0], label="gas $T$")
    axes.set_ylabel(TEMPERATURE.label)
    if not np.isfinite(trace.values.get("oil_temperature", np.nan)).any():
        return False
    oil = TEMPERATURE.of(trace.values["oil_temperature"])
    axes.plot(trace.angle, oil, color=COLOURS[3], linestyle=DASHES[1], label=r"oil $T_\mathrm{oil}$")
    return True


def draw_pressure(axes: Any, trace: Trace) -> None:
    """Draw the pressure over the angle into axes."""
    _pressure(axes, trace)
    _angle_axis(axes, trace, trace.axis.label)


def draw_temperatures(axes: Any, trace: Trace) -> None:
    """Draw the temperatures over the angle into axes."""
    if _temperatures(axes, trace):
        axes.legend()
    _temperature_axis(axes, trace)
    _angle_axis(axes, trace, trace.axis.label)


def draw_flows(axes: Any, trace: Trace) -> None:
    """Draw the mass flow of each path over the angle into axes, one colour per path; paths without any are left out.

    Where leaks would vanish beside the flow of a port, the axis is linear up to the smallest path's largest flow and
    logarithmic beyond.
    """
    axes.axhline(0.0, color=GREY, linewidth=0.4)
    peaks = _peaks(trace)
    shown = [MASS_FLOW.factor * peak for peak in peaks.values() if peak]
    if shown and max(shown) > _VANISHING * min(shown):
        axes.set_yscale("symlog", linthresh=min(shown))
    flowing = {words: sides for words, sides in flow_paths(trace.values).items() if peaks[words]}
    for i, (words, sides) in enumerate(flowing.items()):
        for j, (side, name) in enumerate(sides.items()):
            flow = trace.values[name] * MASS_FLOW.factor
            style = {"color": COLOURS[i % len(COLOURS)], "linestyle": DASHES[j]}
            axes.plot(trace.angle, flow, **style, label=f"{words}, {side}" if side else words)
    axes.set_ylabel(MASS_FLOW.label)
    if flowing:
        axes.legend(fontsize=SMALL)
    _angle_axis(axes, trace, trace.axis.label, plain=axes.get_yscale() == "linear")


def _peaks(trace: Trace) -> dict[str, float]:
    """Return the largest flow [kg/s] of each path, in either direction."""
    paths = flow_paths(trace.values)
    return {
        words: max(float(np.nanmax(np.abs(trace.values[name]))) for name in sides.values())
        for words, sides in paths.items()
    }


def _flows(trace: Trace) -> Any:
    """Draw the mass flow of each path over the angle, one panel per path, with both sides of a gap in one panel."""
    peaks, every = _peaks(trace), flow_paths(trace.values)
    paths = {words: sides for words, sides in every.items() if peaks[words]} or every
    closed = ", ".join(words for words in every if words not in paths)
    figure, places = style.panels(len(paths), 22.0, 36.0, sharex=True)
    for axes, (words, sides) in zip(places, paths.items(), strict=True):
        axes.axhline(0.0, color=GREY, linewidth=0.4)
        for i, (side, name) in enumerate(sides.items()):
            flow = trace.values[name] * MASS_FLOW.factor
            axes.plot(trace.angle, flow, color=COLOURS[1], linestyle=DASHES[i], label=side)
        axes.set_title(words, loc="left", fontsize=SMALL)
        _angle_axis(axes, trace)
    for axes in places[-2:]:  # the lowest of each column
        axes.tick_params(labelbottom=True)
    if any(len(sides) > 1 for sides in paths.values()):
        figure.legend(*places[-1].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    figure.supxlabel(trace.axis.label, fontsize=8.0)
    figure.supylabel(MASS_FLOW.label, fontsize=8.0)
    lines = ", ".join(f"{text} {short(angle)}°" for text, angle in trace.marks.items())
    told = f"dotted: {lines}" if lines else "", f"no flow: {closed}" if closed else ""
    note(figure, trace.title, *told, share=_BESIDE_LEGEND)
    return figure


def _pressure_axis(axes: Any, trace: Trace) -> str:
    """Draw the lines' pressures, limit the axis, and return the note on what exceeds it."""
    for symbol, pressure in trace.pressures.items():
        style.level(axes, pressure * PRESSURE.factor, symbol)
    top, peak, angle = pressure_limit(trace)
    axes.set_ylim(0.0, top * PRESSURE.factor)
    plain_ticks(axes.yaxis)
    beyond = f"peak of {peak * PRESSURE.factor:.3g} bar at {short(angle)}° not shown"
    return beyond if peak > top else ""


def _temperature_axis(axes: Any, trace: Trace) -> str:
    """Limit the axis to chambers with gas in them, and return the note on what exceeds it."""
    low, high, beyond = temperature_limits(trace)
    if beyond is None:
        return ""
    room = 0.06 * (high - low)
    axes.set_ylim(TEMPERATURE.of(low - room), TEMPERATURE.of(high + room))
    return f"{TEMPERATURE.of(beyond):.0f} °C of the nearly empty chamber not shown"


def _angle_axis(axes: Any, trace: Trace, label: str = "", plain: bool = True) -> None:
    first, last = float(trace.angle[0]), float(trace.angle[-1])
    style.angle_axis(axes, first, last, trace.marks.values(), 120.0 if last - first > 400.0 else 60.0)
    if plain:  # not those of logarithms
        plain_ticks(axes.yaxis, most=6)
    if label:
        axes.set_xlabel(label)


def spectrum(angle: np.ndarray, torque: np.ndarray, pitch: float) -> np.ndarray:
    """Return the amplitudes [N m] of the harmonics 0 (the mean), 1, 2 … of a torque over the angle [degree] (M147)."""
    curve = np.interp(np.arange(_FINE) * pitch / _FINE, angle, torque)
    amplitudes = np.abs(np.fft.rfft(curve))[: _HARMONICS + 1] / _FINE
    return np.concatenate([amplitudes[:1], 2.0 * amplitudes[1:]])


def _torque(trace: Trace, pitch: float) -> Any:
    from matplotlib.ticker import MultipleLocator

    figure, (upper, lower) = subplots(SINGLE, 96.0, 2, 1)
    torque = trace.values["gas_torque"]
    shown = trace.angle <= 2.0 * pitch + 1e-9
    amplitudes = spectrum(trace.angle, torque, pitch)
    mean = float(amplitudes[0])
    upper.plot(trace.angle[shown], torque[shown], color=COLOURS[0])
    style.level(upper, mean, "mean")
    upper.set_xlim(0.0, 2.0 * pitch)
    upper.xaxis.set_major_locator(MultipleLocator(30.0))
    upper.set_ylim(min(0.0, 1.06 * float(torque.min())), max(0.0, 1.06 * float(torque.max())))
    upper.set(xlabel=ANGLE.label, ylabel="gas torque $M$ (N m)")
    order = np.arange(1, _HARMONICS + 1)
    lower.bar(order, amplitudes[1:], width=0.5, color=COLOURS[1], linewidth=0.0)
    lower.set_xticks(order)
    lower.tick_params(axis="x", which="both", length=0.0)
    lower.set(xlabel="multiple of the lobe frequency", ylabel="amplitude $M_k$ (N m)")
    plain_ticks(upper.yaxis, lower.yaxis, most=6)
    note(figure, trace.title)
    return figure
