"""Plenums: the volumes behind both ports are finite, so that their pressure pulsates with the lobes.

What: a plenum's gas is compressed by the difference between the flow from the chambers and that into the line (M184),
harmonic by harmonic of the lobe frequency; the chambers see that pressure (M185, M186), which is found together with
the cycle. The line is infinitely long (no reflection) or passes a steady flow; port and line take a pressure drop from
the mean (M184). A check valve between plenum and line lets nothing back, and stays shut where the machine would deliver
nothing (M220–M222); between two valves that stay shut is an amount of gas that the scene does not determine (M240).
Source: filling of a volume, plane waves in an endless pipe (textbook acoustics); that pulsations of screw compressors
come from the flow through the ports: E. Mujic, A. Kovacevic, N. Stosic, I. K. Smith, Noise control by suppression of
gas pulsation in screw compressors, in: Advances in Noise Analysis, Mitigation and Control, InTech 2016.
Assumptions: one pressure in a plenum (shorter than a quarter of a wave of the lobe frequency; beyond a half a warning
says so), isentropic pulsation around the mean, constant sound speed, a stated number of harmonics; a check valve is
tight and has no mass (a warning says where a line without one would need it).
Parameters: volume, line area, loss coefficient and check valve of suction and discharge, harmonics.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from math import hypot, pi
from typing import Any, NamedTuple

import numpy as np

from screwsim.effects.base import (
    DISCHARGE,
    LINES,
    Effect,
    Faults,
    FeedbackUnknown,
    LineFlow,
    Made,
    Pulsation,
    Reading,
    Turn,
)
from screwsim.effects.parts import line_valve
from screwsim.effects.parts.line_valve import Valve
from screwsim.inputs.declare import count, number, optional
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import PORTS
from screwsim.outputs import Figure, Trace, names_of, over

Array = np.ndarray
NAME = "plenums"
TRACE = 360  # points per pitch of a trace
LOWEST = -0.9  # lower bound of the mean's relative offset: there the line takes all of the pressure
EMPTY = -0.999  # the same with a check valve, behind which a plenum may stay near suction pressure
LOCKED = (
    "both check valves of effects.plenums stay shut: the machine delivers nothing, since its leaks take all that it "
    "displaces before the discharge plenum reaches its line's pressure; nothing passes between the lines, and how "
    "much gas is locked between them depends on how the machine got there, not on the scene; the figures are those "
    "without suction_valve (leave it out, or choose smaller leaks, a higher speed or a lower discharge pressure)"
)
STUCK = (
    "a check valve of effects.plenums stays shut and the turns do not settle: the machine leaks more than it takes in "
    "and delivers nothing (leave the valve out, or choose smaller leaks or a higher speed)"
)
IDLE = "a check valve of effects.plenums stays shut: against the line's pressure the machine {nothing}"
SWINGS = (
    "the pressure of the {to} plenum would swing by more than its mean: a chamber displaces more gas than the plenum "
    "holds (choose a larger effects.plenums.{to}_volume, or a higher speed)"
)
SPREADS = (
    "the {to} plenum is at least {edge:.2g} m long, as a cube of its volume, and half a wave of the lobe frequency is "
    "{half:.2g} m there: it has no single pressure, as M184 gives it (state the volume next to the port alone as "
    "effects.plenums.{to}_volume, or take its pulsation for an order of magnitude)"
)
SHUT = "the {to} line takes up the whole pressure (choose a wider effects.plenums.{to}_area or a smaller {to}_loss)"
WHICH = ("the", "twice the", "three times the", "four times the")  # of the harmonics among the figures


def _declared(to: str) -> Iterator[Figure]:
    """Yield the figures of a plenum; errors of pulsating ones are relative to the line's pressure."""
    line, needs, what = over(f"{to}_pressure", alone=True), (f".{to}_volume",), f"in the {to} plenum"
    yield Figure(f"{to}_plenum_pressure", "Pa", f"mean pressure {what}", needs=needs)
    swing = f"pressure {what}, highest minus lowest value"
    yield Figure(f"{to}_pulsation_peak_to_peak", "Pa", swing, line, needs, swing_of=f"{to}_plenum_pressure")
    for k, which in enumerate(WHICH, 1):
        amplitude = f"amplitude of the pressure {what} at {which} lobe frequency"
        yield Figure(f"{to}_pulsation_harmonic_{k}", "Pa", amplitude, line, needs)


FIGURES = (
    *(figure for to in LINES for figure in _declared(to)),
    Figure(
        "discharge_line_least_flow",
        "kg s-1",
        "lowest mass flow from the discharge plenum into its line",
        over("gas_mass_flow"),  # it passes through zero
        (".discharge_volume",),
        by_flow=True,
    ),
)


@dataclass(frozen=True)
class Parameters:
    """Volumes, what lies behind them, and how finely the pressure is resolved."""

    discharge_volume: float | None = optional("volume", "volume of the discharge plenum (absent: none)")
    suction_volume: float | None = optional("volume", "volume of the suction plenum (absent: none)")
    discharge_area: float | None = optional(
        "area", "cross-section of the discharge line, which reflects nothing (absent: its flow is steady)"
    )
    suction_area: float | None = optional("area", "cross-section of the suction line, likewise")
    discharge_loss: float = number(
        "loss coefficient of port and line, with discharge_area", 0.0, ge=0.0, le=1e6, hardly=(None, 100.0)
    )
    suction_loss: float = number(
        "loss coefficient of port and line, with suction_area", 0.0, ge=0.0, le=1e6, hardly=(None, 100.0)
    )
    discharge_valve: Valve | None = None
    suction_valve: Valve | None = None
    harmonics: int = count("number of harmonics of the lobe frequency that are followed", 8, ge=len(WHICH), le=24)


def pulsation(line: LineFlow, before: Array, volume: float, area: float | None, frequency: float) -> Array:
    """Return the amplitudes a_k − i b_k of each harmonic over the line's pressure (M184); frequency [rad/s].

    `before` are the amplitudes with which the turn was integrated. Chambers open to the plenum respond to a change of
    its pressure as if they were part of its volume; including that response improves the next guess and leaves the
    fixed point unchanged.
    """
    k = np.arange(1, len(before) + 1)
    flow = np.fft.rfft(line.flow)[1 : len(before) + 1] * (2.0 / len(line.flow))
    rate = 1j * k * frequency / line.sound**2
    leaving = 0.0 if area is None else area / line.sound
    answering = rate * line.open_volume
    return (flow + answering * before * line.p) / (rate * volume + answering + leaving) / line.p


def offset(line: LineFlow, area: float | None, loss: float) -> float:
    """Return the relative offset of the mean pressure from the line's (M184)."""
    mean = float(np.mean(line.flow))
    return 0.0 if area is None else 0.5 * loss * mean * abs(mean) / (line.rho * area**2) / line.p


class PlenumState(NamedTuple):
    """State of a plenum after a turn: offset, amplitudes, whether its check valve stays shut, the valve's least flow.

    Offset and amplitudes a_k − i b_k are over the line's pressure; the least flow [kg/s] counts along the valve,
    and is that of a given net flow. `found`: whether the flow through the valve was found.
    """

    offset: float
    amplitudes: Array
    shut: bool = False
    least: Callable[[float], float] | None = None  # None without a valve
    found: bool = True


def answer(line: LineFlow, before: Array, capacity: float, frequency: float) -> Array:
    """Return the flow [kg/s] into the line with the response of chambers open to the plenum added (see `pulsation`)."""
    k = np.arange(1, len(before) + 1)
    return line.flow + line.p * capacity * _wave(1j * k * frequency * before, len(line.flow))


def _wave(amplitudes: Array, count: int) -> Array:
    """Return the sum of harmonics with amplitudes a_k − i b_k at `count` evenly spaced angles of a pitch."""
    return np.real(_harmonics(count, len(amplitudes)) @ amplitudes)


@lru_cache(maxsize=4)
def _harmonics(count: int, many: int) -> Array:
    """Return e^{i k φ} of `many` harmonics k at `count` evenly spaced angles φ of a pitch, a column each."""
    return np.exp(2j * pi * np.outer(np.arange(count), np.arange(1, many + 1)) / count)


@lru_cache(maxsize=4)
def _waves(count: int) -> Array:
    """Return cosine and sine of each harmonic over a pitch, a column each."""
    phase = 2.0 * pi * np.arange(TRACE) / TRACE
    return np.column_stack([wave(k * phase) for k in range(1, count + 1) for wave in (np.cos, np.sin)])


def _nothing(_: Any) -> float:
    return 0.0


class PlenumWithLine:
    """What lies behind one port: the plenum and its line."""

    def __init__(self, to: str, parameters: Parameters) -> None:
        self.to, self.count = to, parameters.harmonics
        self.volume = float(getattr(parameters, f"{to}_volume") or 0.0)
        self.area, self.loss = getattr(parameters, f"{to}_area"), getattr(parameters, f"{to}_loss")
        self.valve: Valve | None = getattr(parameters, f"{to}_valve")
        self.along = 1.0 if to == DISCHARGE else -1.0
        self.downstream: PlenumWithLine | None = None  # of a suction valve: the plenum of the other check valve
        self.names = [f"{to}_{part}_{k}" for k in range(1, self.count + 1) for part in ("cos", "sin")]
        self._last: tuple[Any, PlenumState] = None, PlenumState(0.0, np.empty(0))

    def state(self, turn: Turn) -> PlenumState:
        """Return the plenum's state after a turn, computed once a turn."""
        of, found = self._last  # one read of the tuple: threads that read other turns share it
        if of is not turn.line:
            held = np.array([turn.held[name] for name in self.names]).reshape(-1, 2)
            before, frequency = held[:, 0] - 1j * held[:, 1], 2.0 * pi * turn.omega / turn.pitch
            line = turn.line(self.to)
            if self.valve is None or (self.downstream is not None and self.downstream.locks_in(turn)):
                amplitudes = pulsation(line, before, self.volume, self.area, frequency)
                found = PlenumState(offset(line, self.area, self.loss), amplitudes)
            else:
                found = self._valved(self.valve, line, before, turn, frequency)
            self._last = turn.line, found
        return found

    def _valved(self, valve: Valve, line: LineFlow, before: Array, turn: Turn, frequency: float) -> PlenumState:
        """Return the state of a plenum with a check valve after a turn, integrated with a held offset (M220–M222)."""
        flow, p, held = self.along * line.flow, line.p, turn.held[f"{self.to}_offset"]
        given = self.along * answer(line, before, line.open_volume / line.sound**2, frequency)
        impedance = 0.0 if self.area is None else line.sound / self.area
        capacity = (self.volume + line.open_volume) / line.sound**2
        behind = line_valve.ValveSurroundings(capacity, impedance, frequency, line.rho)
        mean, least, converged = max(float(flow.mean()), 0.0), _nothing, True
        answering = (1.0 + held) * p * line.open_volume / line.sound**2 * frequency / (2.0 * pi)
        pressure = line_valve.closed(given, behind)
        level = valve.pressure - (0.0 if self.area is None else float(pressure.max()))
        if mean > 0.0 and self.area is None:
            level, least = float(valve.drop(np.array([mean]), line.rho)[0][0]), lambda net: max(net, 0.0)
        elif mean > 0.0:
            passed = line_valve.valve_flow(valve, given, behind)
            pressure, converged = passed.pressure, passed.converged
            least = partial(line_valve.least_flow, valve, given, behind, passed)
            level = float(pressure.mean()) + abs(offset(line, self.area, self.loss)) * p
        near = abs(self.along * level / p - held) <= line_valve.MOST_CHANGE * (1.0 + held)
        across = 1.0 + held - (0.0 if near else self._far(turn) / p)  # a turn that may open the valve is allowed to
        stands = self.along * line_valve.standing(held, line.flow, answering, across)
        shut = stands < level / p
        if shut:  # leaks respond to a change of its pressure as open chambers do, and are included likewise
            leaking = (float(np.mean(np.abs(flow))) + answering) / (line_valve.driving(held, across) * p)
            pressure = line_valve.closed(given + self.along * leaking * p * _wave(before, len(given)), behind, leaking)
        spectrum = np.fft.rfft(pressure)[1 : self.count + 1] * (2.0 / len(pressure))
        along = self.along * (stands if shut else level / p)
        amplitudes = self.along * spectrum / p
        return PlenumState(along, amplitudes, shut, _nothing if shut else least, shut or converged)

    def _far(self, turn: Turn) -> float:
        """Return the mean pressure [Pa] beyond the machine's other port."""
        (to,) = {*LINES} - {self.to}
        return turn.line(to).p * (1.0 + turn.held.get(f"{to}_offset", 0.0))

    def coefficient(self, i: int, turn: Turn) -> float:
        """Return the i-th of the coefficients a_1, b_1, a_2 … after a turn."""
        amplitude = self.state(turn).amplitudes[i // 2]
        return float(-amplitude.imag if i % 2 else amplitude.real)

    def offset(self, turn: Turn) -> float:
        """Return the relative offset of the mean pressure after a turn."""
        return self.state(turn).offset

    def pressure(self, turn: Turn) -> Array:
        """Return the plenum's pressure over the line's, at evenly spaced angles of a pitch (M185)."""
        amplitudes = np.array([turn.made[name] for name in self.names])
        return 1.0 + turn.made[f"{self.to}_offset"] + _waves(self.count) @ amplitudes

    def shut(self, turn: Turn) -> bool:
        """Tell whether the check valve stays shut over the whole pitch."""
        return self.state(turn).shut

    def locks_in(self, turn: Turn) -> bool:
        """Tell whether gas leaves the chambers only to the suction line, whose valve would stay shut, too (M240)."""
        return turn.two_lines and self.shut(turn)

    def unknown(self, turn: Turn, closed: bool) -> str:
        """Return a text that says that the gas between two shut valves is undetermined; empty where it is not so.

        For a cycle that did not close the text is returned only where the plenum's pressure fell below the middle of
        both pressures, far from where its valve opens.
        """
        held, far = 1.0 + turn.held[f"{self.to}_offset"], self._far(turn) / turn.line(self.to).p
        return LOCKED if self.locks_in(turn) and (closed or held < 0.5 * (1.0 + far)) else ""

    def parts(self) -> list[Made | Pulsation]:
        """Return the declared parts: offset, coefficients one after the other, and the pressure that they describe."""
        first = f"{self.to}_offset"
        least = LOWEST if self.valve is None else EMPTY
        entry = FeedbackUnknown(first, scale=1.0) if self.valve is None else FeedbackUnknown(first, shift=1.0)
        made = [Made(entry, _nothing, self.offset, least, SHUT.format(to=self.to))]
        made += [
            Made(FeedbackUnknown(name, scale=1.0), _nothing, partial(self.coefficient, i))
            for i, name in enumerate(self.names)
        ]
        shut = None if self.valve is None else self.shut
        unknown = None if self.downstream is None else self.downstream.unknown
        swings = SWINGS.format(to=self.to)
        return [*made, Pulsation(self.to, first, tuple(self.names), shut, unknown, STUCK, IDLE, swings)]

    def spread(self, turn: Turn) -> str:
        """Return a text where a plenum is longer than half a wave of the lobe frequency; empty where it is shorter.

        From its middle to an end is then more than a quarter of a wave, over which the pressure changes its sign.
        """
        half, edge = 0.5 * turn.line(self.to).sound * turn.pitch / turn.omega, self.volume ** (1.0 / 3.0)
        return SPREADS.format(to=self.to, edge=edge, half=half) if edge > half else ""

    def figures(self, turn: Turn) -> dict[str, float | None]:
        """Return mean, peak-to-peak value and harmonics of the pressure [Pa]."""
        p, pressure = turn.line(self.to).p, self.pressure(turn)
        lowest, highest = line_valve.lowest(pressure), -line_valve.lowest(-pressure)
        pairs = [(turn.made[f"{self.to}_cos_{k}"], turn.made[f"{self.to}_sin_{k}"]) for k in range(1, len(WHICH) + 1)]
        found = {f"{self.to}_pulsation_harmonic_{k}": p * hypot(*pair) for k, pair in enumerate(pairs, 1)}
        found[f"{self.to}_plenum_pressure"] = p * (1.0 + turn.made[f"{self.to}_offset"])
        if self.to == DISCHARGE:
            line, least = turn.line(self.to), self.state(turn).least
            wave = 0.0 if self.area is None else self.area / line.sound * p * (lowest - float(pressure.mean()))
            found["discharge_line_least_flow"] = line.net + wave if least is None else least(line.net)
        return {**found, f"{self.to}_pulsation_peak_to_peak": p * (highest - lowest)}


def build(parameters: Parameters, machine) -> list[Made | Pulsation | Reading]:
    behind = [PlenumWithLine(to, parameters) for to in LINES if getattr(parameters, f"{to}_volume") is not None]
    if len(behind) == len(LINES) and all(one.valve is not None for one in behind):
        behind[0].downstream = behind[1]

    def read(figures) -> dict[str, float | None]:
        return {name: value for one in behind for name, value in one.figures(figures.turn).items()}

    def judge(figures) -> tuple[str, tuple[str, ...]]:
        """Return a text on a valve whose flow was not found, and warnings of plenums too long to have one pressure."""
        failures = [line_valve.UNFOUND.format(to=one.to) for one in behind if not one.state(figures.turn).found]
        found = (one.spread(figures.turn) for one in behind)
        return "".join(failures[:1]), tuple(each for each in found if each)

    def traces(figures) -> dict[str, Any]:
        """Return the pressures [Pa] over a pitch."""
        turn = figures.turn
        return {f"{one.to}_plenum_pressure": turn.line(one.to).p * one.pressure(turn) for one in behind}

    return [*(part for one in behind for part in one.parts()), Reading(names_of(FIGURES), read, traces, judge)]


def warnings(found: Mapping[str, Any]) -> Iterator[str]:
    """Yield a warning where the pulsation reverses the flow in the discharge line."""
    if (found.get("discharge_line_least_flow") or 0.0) < 0.0 < (found.get("gas_mass_flow") or 0.0):
        yield (
            "the pulsation reverses the flow in the discharge line: a check valve would shut (name "
            "effects.plenums.discharge_valve, a larger discharge_volume or a smaller discharge_area)"
        )


def check(parameters: Parameters, facts) -> Faults:
    path = f"effects.{NAME}"
    if parameters.suction_volume is None and parameters.discharge_volume is None:
        yield Fault(path, "has no plenum (write e.g. discharge_volume: 5 l, or remove it)")
    for to in LINES:
        volume, area, loss = (getattr(parameters, f"{to}_{what}") for what in ("volume", "area", "loss"))
        if loss > 0.0 and area is None:
            yield Fault(f"{path}.{to}_area", f"is missing ({to}_loss needs it, e.g. 20 cm^2)")
        given = next((what for what in ("area", "valve") if getattr(parameters, f"{to}_{what}") is not None), None)
        if volume is None and given is not None:
            yield Fault(f"{path}.{to}_volume", f"is missing ({to}_{given} needs it, e.g. 5 l)")


EFFECT = Effect(
    name=NAME,
    title="finite volumes behind the ports, whose pressure pulsates",
    equations=("M184", "M185", "M186", "M187", "M220", "M221", "M222", "M240"),
    source="filling of a volume, plane waves (textbook)",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({PORTS}),
    figures=FIGURES,
    warnings=warnings,
    traces=tuple(
        Trace(f"{to}_plenum_pressure", "Pa", f"pressure in the {to} plenum, by the youngest chamber's angle")
        for to in LINES
    ),
    in_expander="dry",
)
