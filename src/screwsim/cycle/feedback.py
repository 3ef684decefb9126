"""Feedback unknowns: numbers besides the states that a cycle determines and that act back on it.

They are the states of the lines and what effects declare (wall temperatures, factors on areas). A turn or pitch maps
them, together with the states, to their next values (`image`).
"""

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import NamedTuple, Self

import numpy as np

from screwsim.cycle import suction_line
from screwsim.cycle.balances import net_into, outflow_dissolved_gas, outflow_of, streams_of, walls_of
from screwsim.cycle.cycle_figures import cycle_figures
from screwsim.cycle.powers import powers_of
from screwsim.cycle.problem import Problem
from screwsim.effects.base import LineFlow, Made, OilSolution, SuctionHeat, Turn
from screwsim.effects.parts.gap import ClearanceParameters
from screwsim.inputs.faults import UsageError, checked_own_number
from screwsim.model.all_chambers import install_pitch, moved_on
from screwsim.model.run import Machinery
from screwsim.model.slots import (
    DENSITY,
    DISCHARGE_IN,
    DISCHARGE_OUT,
    DISSOLVED,
    ENTHALPY,
    FIRST_OWN,
    OF_GAS,
    OIL_RATIO,
    OIL_TEMPERATURE,
    PLENUM_ENTROPY,
    PORT_STATE,
    PRESSURE,
    Q_WORK,
    R_DISCHARGE,
    R_SUCTION,
)
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.integrators import Check
from screwsim.scene.types import parameters_of_type

Array = np.ndarray
OF_LINE = ENTHALPY, OIL_RATIO, OIL_TEMPERATURE, DISSOLVED
AT_ENTHALPY, AT_RATIO, AT_TEMPERATURE, AT_HELD = range(len(OF_LINE))  # their indices among the unknowns
UP_TO_OIL = OIL_TEMPERATURE + 1  # length of a port state up to the oil's temperature: gas, oil per gas, temperature
LINE_POINTS = 256  # angles of a pitch around which the flow to a pulsating line is averaged


class LineInflow(NamedTuple):
    """Flows [kg/s] into suction and discharge line (2, LINE_POINTS), means around angles; volumes [m³] open to each."""

    flow: Array
    volume: Array

    def moved(self, flow: Array, volume: Array | None = None) -> Self:
        """Return these with a change of the flows, and with other volumes."""
        return self._make((self.flow + flow, self.volume if volume is None else volume))


def unknowns(problem: Problem, machinery: Machinery) -> Array:
    """Return the unknowns that the next turn will use: discharge line, suction line, what effects declare."""
    composition, R = machinery.composition, machinery.R
    lines = [line_unknowns(problem, R), *([suction_line.values(problem, R)] if problem.parts.suction_line else [])]
    if not composition.made:
        return lines[0] if len(lines) == 1 else np.concatenate(lines)
    return np.concatenate([*lines, composition.P[list(composition.made)]])


def set_unknowns(problem: Problem, machinery: Machinery, values: Array) -> None:
    """Set the unknowns for the next turn."""
    made = len(values) - len(problem.parts.made)
    line = len(_unknown_indices(problem))
    _set_line(problem, machinery.R, values[:line])
    if problem.parts.suction_line:
        suction_line.set_values(problem, machinery.R, values[line:made])
    if machinery.composition.made:
        machinery.composition.P[list(machinery.composition.made)] = values[made:]


def image(
    problem: Problem, life: Trajectory, q: Array, turn: Turn | None = None, into: LineInflow | None = None
) -> Array:
    """Return the unknowns' next values by a life with quadratures q; `turn` and `into` may be given where known."""
    lines = [_outflow(problem, life.R, q)]
    turn = turn or turn_of(problem, life, q, into) if problem.parts.made else None
    if problem.parts.suction_line:
        heat = _suction_heat(problem, life, q, turn) / problem.rate
        streams = streams_of(problem.composition, q)
        lines.append(suction_line.image(problem, life.R, streams, float(lines[0][AT_ENTHALPY]), heat))
    if turn is None:
        return lines[0] if len(lines) == 1 else np.concatenate(lines)
    return np.concatenate([*lines, list(turn.made.values())])


def next_pitch(
    problem: Problem, machinery: Machinery, y: Array, unknowns_in: Array, rtol: float, check: Check | None = None
) -> tuple[Array, Array, Array] | None:
    """Integrate a pitch; return the states and unknowns that the next one starts with, and its quadratures.

    The pitch becomes the last history; y is advanced to its end [in place]. None where the integration stops.
    """
    set_unknowns(problem, machinery, unknowns_in)
    status, _, q = machinery.pitch(y, rtol, check=check)
    if status != 0:
        return None
    install_pitch(machinery)
    unknowns_out = image(problem, machinery.trajectory, q)
    return moved_on(machinery, y), unknowns_out, q


def _suction_heat(problem: Problem, life: Trajectory, q: Array, turn: Turn | None) -> float:
    """Return the heat [W] that the fresh gas takes up on its way to the suction line (M275)."""
    parts = problem.parts
    if not parts.all(SuctionHeat) or not np.isfinite(q[Q_WORK]):
        return 0.0
    powers = powers_of(parts, cycle_figures(problem, life, q, turn=turn))
    return suction_line.suction_heat(problem, powers.shaft)


def turn_of(problem: Problem, life: Trajectory, q: Array, into: LineInflow | None = None) -> Turn:
    """Return what effects can read of a life with quadratures q, including the next values of their unknowns (`made`).

    `into` is the flow into pulsating lines, where it is known; otherwise it is read from the life.
    """
    parts, P, c = problem.parts, life.composition.P, problem.composition
    names = [wall.name for _, wall in parts.walls]
    sums = (problem.rate * walls_of(c, q)).T.tolist()
    heat, conductance = (dict(zip(names, each, strict=True)) for each in sums)
    gaps = {name: gap.gap for name, gap in parameters_of_type(problem.scene.effects, ClearanceParameters).items()}
    held = dict(zip(parts.made, P[list(c.made)].tolist(), strict=True))
    made, ambient = dict(held), problem.scene.operation.ambient_temperature
    flows, pitch = _line_flows(problem, life, q, into), parts.geometry.pitch
    turn = Turn(held, made, heat, conductance, gaps, ambient, flows, parts.omega, pitch, not parts.plenums)
    for name, part in parts.all(Made):
        found = part.image(turn)
        if np.isfinite(q[Q_WORK]):
            checked_own_number(name, f"the cycle's value of {part.entry.name}", found)
        made[part.entry.name] = max(float(found), part.least)
    return turn


def into_lines(life: Trajectory) -> LineInflow:
    """Return the flow of a life's chambers into pulsating lines."""
    return LineInflow(*life.into_lines(LINE_POINTS))


def _line_flows(problem: Problem, life: Trajectory, q: Array, into: LineInflow | None) -> Callable[[str], LineFlow]:
    """Return a function that gives the chambers' flow to a line; the life is read once, on the first call."""
    taken, gas = cache(lambda: into or into_lines(life)), problem.parts.gas

    @cache
    def flow_to(line: str) -> LineFlow:
        """Return the flow over one pitch, shifted so that its mean is that of the quadratures."""
        number = problem.parts.number(line)
        flow, volume = (each[number] for each in taken())
        streams = streams_of(problem.composition, q)[2 * number : 2 * number + 2, OF_GAS]
        mean = -float(streams.sum()) * problem.parts.omega / problem.parts.geometry.pitch
        h = float(life.R[number * PORT_STATE + ENTHALPY])
        p, rho, _h, exponent, *_ = gas.port_state_of_enthalpy(float(life.R[number * PORT_STATE + PRESSURE]), h)
        net = net_into(problem, life, q, number) * problem.rate
        return LineFlow(at_angles(flow) + (mean - flow.mean()), float(volume), p, rho, 1.0 / exponent, net)

    return flow_to


def at_angles(means: Array) -> Array:
    """Return a flow at evenly spaced angles of a pitch, from its means around these angles.

    The harmonics of the means are those of the flow times sin x/x.
    """
    harmonics, count = np.fft.rfft(means), len(means)
    return np.fft.irfft(harmonics / np.sinc(np.arange(len(harmonics)) / count), count)


def suction_line_imbalance(problem: Problem, life: Trajectory, q: Array) -> str:
    """Return why a closed cycle's suction line is not in equilibrium with what flows to it; empty where it is."""
    if not problem.parts.suction_line:
        return ""
    turn = turn_of(problem, life, q) if problem.parts.made else None
    streams, h_d = streams_of(problem.composition, q), float(_outflow(problem, life.R, q)[AT_ENTHALPY])
    heat = _suction_heat(problem, life, q, turn) / problem.rate
    return suction_line.imbalance(problem, life.R, streams, h_d, heat)


def unknown_at_limit(problem: Problem, life: Trajectory) -> str:
    """Return why an unknown stopped at the end of its range, and what to do; empty where none did."""
    if not problem.composition.made:
        return ""
    values = life.composition.P[list(problem.composition.made)]
    for (_, part), value in zip(problem.parts.all(Made), values, strict=True):
        if value <= part.least + 1e-9 * abs(part.least):
            return part.beyond
    return ""


def line_unknowns(problem: Problem, R: Array) -> Array:
    """Return the discharge line's unknowns.

    They are its enthalpy [J/kg], with carried oil its oil ratio and oil temperature [K], and dissolved gas if a
    state.
    """
    port_state, cells = R[R_DISCHARGE : R_DISCHARGE + PORT_STATE].tolist(), _unknown_indices(problem)
    pairs = zip(cells, problem.entries.shifts.tolist(), strict=False)  # the line's entries come first
    return np.array([max(port_state[cell] + shift, 1e-9) - shift for cell, shift in pairs])


def _unknown_indices(problem: Problem) -> tuple[int, ...]:
    """Return the indices of a port state that are unknowns of the discharge line."""
    if problem.parts.dissolves:
        return OF_LINE if problem.composition.carried else (ENTHALPY, DISSOLVED)
    return OF_LINE[:AT_HELD] if problem.composition.carried else OF_LINE[:AT_RATIO]


def _outflow(problem: Problem, R: Array, q: Array) -> Array:
    """Return the discharge line that results from an outflow (M27): its flow-weighted mean, or the stated temperature.

    Backflow beyond the outflow comes from the line and brings no oil. So the plenum is a continuous function of the
    flows; one that jumped where the net flow passes zero would leave such a machine without a cycle. A check valve
    lets nothing back from the line: all backflow flowed out before, in this turn or an earlier one.
    """
    parts, streams = problem.parts, streams_of(problem.composition, q)
    mean = outflow_of(streams)
    plenum = line_unknowns(problem, R)
    if parts.held_back and mean is None:
        return plenum
    given = problem.scene.operation.discharge.temperature is not None
    back, out = float(streams[DISCHARGE_IN, OF_GAS]), -float(streams[DISCHARGE_OUT, OF_GAS])
    all_own = back <= max(out, 0.0) or parts.held_back
    own = 1.0 if all_own else out / back  # share of what flows back that had flowed out before
    if not given:
        plenum[AT_ENTHALPY] = mean.enthalpy if mean is not None else 0.0 - problem.enthalpy_shift
        if mean is None or own < 1.0:
            plenum[AT_ENTHALPY] = own * plenum[AT_ENTHALPY] + (1.0 - own) * problem.h_isentropic
    if problem.composition.carried:
        assert parts.oil is not None
        if mean is not None and mean.T_oil > 0.0:
            plenum[AT_RATIO], plenum[AT_TEMPERATURE] = max(own * mean.oil_ratio, 1e-9), mean.T_oil
        else:
            plenum[AT_RATIO] = 1e-9
            plenum[AT_TEMPERATURE] = parts.oil.temperature + problem.oil_pressure_term(problem.lines.p_d)
        plenum[AT_HELD:] = outflow_dissolved_gas(streams)
    return plenum


def _set_line(problem: Problem, R: Array, plenum: Array) -> None:
    """Set the discharge line's enthalpy and oil.

    During iteration the enthalpy may be none that the gas can have (extrapolated, or of no outflow); the gas's
    state then stays as it is.
    """
    suction = problem.suction
    try:
        port_state = problem.parts.gas.port_state_of_enthalpy(problem.lines.p_d, float(plenum[AT_ENTHALPY]))
        if suction.returned > 0.0 and not problem.parts.suction_line:
            R[R_SUCTION : R_SUCTION + OIL_RATIO] = suction.port_state(float(plenum[AT_ENTHALPY]))
    except UsageError:
        port_state = None
    if port_state is not None:
        R[R_DISCHARGE : R_DISCHARGE + len(port_state)] = port_state
    if problem.composition.carried:
        R[R_DISCHARGE + OIL_RATIO], R[R_DISCHARGE + OIL_TEMPERATURE] = plenum[AT_RATIO], plenum[AT_TEMPERATURE]
        R[R_DISCHARGE + DISSOLVED : R_DISCHARGE + DISSOLVED + len(plenum) - AT_HELD] = plenum[AT_HELD:]
        if port_state is not None:
            R[R_DISCHARGE + DENSITY] = problem.density_in_flow(port_state[DENSITY], float(plenum[AT_RATIO]))


def set_lines(problem: Problem, machinery: Machinery, T_d: float, d: float, h_d: float | None = None) -> None:
    """Set the initial state of the lines; T_d [K] and the oil ratio d of the discharge line are guesses.

    `h_d` [J/kg] is the enthalpy that `set_unknowns` will give that line; the state need not be found from T_d then.
    """
    parts, R, p_d = problem.parts, machinery.R, problem.lines.p_d
    T_oil, gas = parts.oil.temperature if parts.oil else problem.lines.T_s, parts.gas
    discharge = None
    if h_d is not None and problem.suction.returned == 0.0:
        with suppress(UsageError):  # no state of the gas there
            discharge = gas.port_state_of_enthalpy(p_d, h_d)
    if discharge is None:
        discharge = gas.port_state(p_d, problem.scene.operation.discharge.temperature or gas.nearest_vapour(p_d, T_d))
    R[R_SUCTION : R_SUCTION + UP_TO_OIL] = *problem.suction.port_state(discharge[ENTHALPY]), 0.0, T_oil
    arriving = parts.arriving_oil
    if arriving > 0.0:  # (M490)
        R[R_SUCTION + OIL_RATIO] = arriving
        R[R_SUCTION + OIL_TEMPERATURE] += problem.oil_pressure_term(problem.suction.pressure)
        R[R_SUCTION + DENSITY] = problem.density_in_flow(float(R[R_SUCTION + DENSITY]), arriving)
    R[R_DISCHARGE : R_DISCHARGE + UP_TO_OIL] = *discharge, d, T_oil + problem.oil_pressure_term(p_d)
    R[R_DISCHARGE + DENSITY] = problem.density_in_flow(float(R[R_DISCHARGE + DENSITY]), d)
    if isinstance(parts.oil_content, OilSolution):
        R[R_DISCHARGE + DISSOLVED] = R[R_SUCTION + DISSOLVED] = parts.oil_content.supply
    for i, state in enumerate(parts.plenums.values(), FIRST_OWN):
        R[i * PORT_STATE : i * PORT_STATE + UP_TO_OIL] = *state.port_state, 0.0, T_oil
        R[i * PORT_STATE + PLENUM_ENTROPY] = state.s
