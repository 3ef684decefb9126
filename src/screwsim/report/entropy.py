"""Figure of one cycle in temperature and entropy: the gas of a chamber, the lines' isobars, the dew line.

The entropy is that of the gas's own equation at the temperature and density of the traces, so also of wet gas. Its zero
is free: here it is the gas where the chamber's volume is largest. The mass in a chamber changes while a port or a gap
is open; areas of the loop are therefore no heat.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.build import build_parts
from screwsim.fluid.dome import numbers, saturation_kernels
from screwsim.fluid.gas import Gas, kernel_value
from screwsim.fluid.real_gas import RealGas
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.report.annotate import label_points
from screwsim.report.cycle import marked_points
from screwsim.report.quantities import TEMPERATURE
from screwsim.report.style import COLOURS, GREY, SINGLE, SMALL, note, plain_ticks, subplots
from screwsim.report.trace import Trace, best_case, chosen_trace
from screwsim.results import Results
from screwsim.scene import Scene, case, loads

LABEL = r"specific entropy $s - s_1$ (J/(kg K))"
POINTS = 60  # of an isobar and of the dew line
BEYOND = 0.08  # of the range of the loop: how far the axes reach beyond it
NARROW = 0.2  # of the width, at the left: a name there begins at its point, others end at it
EMPTY = 1e-2  # share of the largest mass below which a chamber counts as empty


class Entropies(NamedTuple):
    """Entropies [J/(kg K)] over s_1: `loop` at the traces' angles; isobars and dew line as (s, T [K]) by name."""

    loop: np.ndarray
    isobars: dict[str, tuple[np.ndarray, np.ndarray]]
    dew: tuple[np.ndarray, np.ndarray] | None


def plans(results: Results) -> Iterator[tuple[str, Any]]:
    """Yield the figure of the stored cycle; none where the scene of the file cannot be read from here."""
    trace = chosen_trace(results)
    if trace is None:
        return
    try:
        scene = scene_of_case(results)
    except (SceneError, UsageError):
        return
    yield "temperature_entropy", lambda: _figure(trace, scene)


def scene_of_case(results: Results) -> Scene:
    """Return the scene of the case whose cycle is drawn; raise SceneError where its files are not there."""
    index = best_case(results)
    scene = loads(results.scene_yaml, str(results.path), str(Path(results.path).resolve().parent))
    return case(scene, int(np.ravel_multi_index(index, results.shape)) if index else 0)


def _figure(trace: Trace, scene: Scene) -> Any:
    figure, axes = subplots(SINGLE, 68.0)
    s, T = _draw(axes, trace, scene)
    note(figure, trace.title)
    figure.draw_without_rendering()
    labels = [(at, text, ((-1, -1), (1, 1), (1, -1))) for text, at in marked_points(axes, trace, s, T)]
    there = np.isfinite(s)
    label_points(axes, labels, axes.transData.transform(np.column_stack([s[there], T[there]])))
    return figure


def draw_temperature_entropy(axes: Any, trace: Trace, scene: Scene) -> None:
    """Draw the gas temperature over its entropy, the isobars of both lines, and the dew line of a real gas."""
    s, T = _draw(axes, trace, scene)
    for text, at in marked_points(axes, trace, s, T):
        axes.annotate(text, at, (-6, -10), textcoords="offset points", ha="right", fontsize=SMALL)


def _draw(axes: Any, trace: Trace, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Draw loop and lines without marks; return the loop's entropy and temperature as shown."""
    found = entropies(trace, scene)
    T = np.where(np.isfinite(found.loop), TEMPERATURE.of(trace.values["gas_temperature"]), np.nan)
    axes.plot(found.loop, T, color=COLOURS[0])
    axes.set(xlim=_with_room(found.loop), ylim=_with_room(T), xlabel=LABEL, ylabel=TEMPERATURE.label)
    for symbol, (s, T_line) in found.isobars.items():
        _line(axes, s, TEMPERATURE.of(T_line), symbol, color=GREY, linewidth=0.5, linestyle=(0, (6, 3)))
    if found.dew is not None:
        s, T_dew = found.dew
        _line(axes, s, TEMPERATURE.of(T_dew), "dew line", color=COLOURS[1], linewidth=0.8)
    plain_ticks(axes.xaxis, axes.yaxis)
    return found.loop, T


def _with_room(values: np.ndarray) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = BEYOND * max(high - low, 1e-6 * max(abs(high), 1.0))
    return low - room, high + room


def _line(axes: Any, s: np.ndarray, T: np.ndarray, text: str, **style: Any) -> None:
    """Draw a line behind the loop, with its name at the highest point of it that is in sight."""
    axes.plot(s, T, zorder=1, **style)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    seen = np.flatnonzero((s > left) & (s < right) & (T > low) & (T < high))
    if len(seen):
        top = seen[np.argmax(T[seen])]
        side = "left" if s[top] < left + NARROW * (right - left) else "right"
        axes.annotate(text, (s[top], T[top]), (0, 3), textcoords="offset points", ha=side, fontsize=SMALL)


def entropies(trace: Trace, scene: Scene) -> Entropies:
    """Return the entropies of a cycle's gas, of the isobars of its lines, and of the dew line of a real gas."""
    parts = build_parts(scene)
    gas, T = parts.gas, np.asarray(trace.values["gas_temperature"], float)
    room = np.asarray(trace.values["volume"], float)
    if parts.oil_room and parts.oil is not None and "oil_mass" in trace.values:
        room = room - np.nan_to_num(trace.values["oil_mass"]) / parts.oil.density
    mass = np.asarray(trace.values["gas_mass"], float)
    there = np.isfinite(T) & (room > 0.0) & (mass > EMPTY * float(np.nanmax(mass)))
    s = np.full(T.shape, np.nan)
    states = zip(T[there].tolist(), (mass[there] / room[there]).tolist(), strict=True)
    s[there] = [kernel_value(gas, gas.specific_entropy, *state) for state in states]
    start = s[int(np.nanargmax(np.where(np.isfinite(s), room, -np.inf)))]
    low, high, lines = float(np.min(T[there])), float(np.max(T[there])), trace.pressures.items()
    isobars = {symbol: _isobar(gas, p, gas.nearest_vapour(p, low), high, start) for symbol, p in lines}
    return Entropies(s - start, isobars, _dew(gas, low, high, start) if isinstance(gas, RealGas) else None)


def _isobar(gas: Gas, p: float, low: float, high: float, start: float) -> tuple[np.ndarray, np.ndarray]:
    T = np.linspace(low, max(high, low), POINTS)
    return np.array([gas.entropy(p, float(each)) for each in T]) - start, T


def _dew(gas: RealGas, low: float, high: float, start: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return entropy and temperature of the dew line between two temperatures; None above the critical one."""
    known, density = numbers(gas.fluid), saturation_kernels(gas.fluid).vapour
    T_low, T_c = known["T_low"], known["T_c"]
    T = np.linspace(max(low, T_low), min(high, T_c * (1.0 - 1e-4)), POINTS)
    if T[-1] <= T[0]:
        return None
    s = [kernel_value(gas, gas.specific_entropy, each, density(each)) for each in T.tolist()]
    return np.array(s) - start, T
