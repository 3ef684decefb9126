"""Balances of a cycle from its quadratures: residuals of mass, energy and oil, and the mean outflow.

Source: docs/model.md M27, M37–M39.
"""

from typing import NamedTuple

import numpy as np

from screwsim.cycle.gaps_at_discharge import misread_at_discharge
from screwsim.cycle.problem import LEAST_OIL, Problem
from screwsim.model import slots
from screwsim.model.composition import Composition
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
LEAST = 1e-300  # smallest divisor
LEAST_WORK = 1e-6  # share of p V of the trapped gas below which work is rounding


class Residuals(NamedTuple):
    """Relative residuals of gas mass, energy and oil mass over one life (M37–M39).

    `oil_share` is the oil residual with the trapped gas as the least scale, for little oil; `oil_left` [kg] is the
    oil residual itself where oil is carried.
    """

    mass: float
    energy: float
    oil: float
    oil_share: float
    oil_left: float

    @property
    def largest(self) -> float:
        """The largest residual, the oil's by `oil_share`."""
        return max(self.mass, self.energy, self.oil_share)


class Outflow(NamedTuple):
    """Flow-weighted means of the outflow to discharge: gas enthalpy [J/kg], oil per gas, oil temperature [K]."""

    enthalpy: float
    oil_ratio: float
    T_oil: float


def streams_of(c: Composition, q: Array) -> Array:
    """Return the sums of the streams over one life as rows, by the categories of `slots`: suction in, suction out, …"""
    return q[c.first_stream :].reshape(-1, c.width)


def heat_flowing_back(problem: Problem, streams: Array, T_oil: float) -> float:
    """Return the heat [W] that gas and carried oil take into the suction line, by the streams of a life (M492).

    It is that above gas of the line and above oil of `T_oil` [K] at the line's pressure.
    """
    oil, out = problem.parts.oil, streams[slots.SUCTION_OUT]
    heat = -float(out[slots.OF_ENERGY] - problem.inlet.enthalpy * out[slots.OF_GAS])
    if oil is not None and problem.composition.carried:
        T = T_oil + problem.oil_pressure_term(problem.lines.p_s)
        heat -= oil.heat_capacity * float(out[slots.OF_OIL_HEAT] - T * out[slots.OF_OIL])
    return heat * problem.rate + 0.0  # turns −0 into 0


def walls_of(c: Composition, q: Array) -> Array:
    """Return for each wall the heat to the gas [J] and the integral of the conductance [J/K] over one life (M170)."""
    return q[slots.Q_WALLS : slots.Q_WALLS + 2 * len(c.walls)].reshape(-1, 2)


def wall_drag_work(c: Composition, q: Array) -> float:
    """Return the work [J] over one life of oil on the walls that drag it along (M257)."""
    return float(q[c.first_stream - 1]) if c.pushes else 0.0


def mass_in(c: Composition, q: Array) -> float:
    """Return the gas [kg] that a life takes in beyond what it gives back; zero in a closed cycle."""
    return float(sum(_columns(c, q)[0]))


def meets_line_at_angle(problem: Problem) -> bool:
    """Return whether the net gas flow is taken across an angle (`flow_past_suction_port`) rather than at the port."""
    return bool(problem.composition.offsets) and not problem.parts.geometry.expands and problem.parted is not None


def exits_late(problem: Problem) -> bool:
    """Return whether chambers leave the suction line after the injection angle (a slide's slot, a bore)."""
    at = problem.parted
    return at is None or at > problem.parts.geometry.injection_angle


def flow_past_suction_port(problem: Problem, life: Trajectory) -> float:
    """Return the gas [kg/life] to add to that through the suction port, for what passes the angle of leaving the line.

    A chamber reads those ahead from the turn before, so what it gets from them is not quite what they give to those
    behind. Between chambers that are open to one line Δp is a few pascals, and both flows err as the pressure does;
    what passes the angle at which chambers leave the line does not, up to what chambers open to the discharge line
    misread of it (`cycle.gaps_at_discharge`).
    """
    if not meets_line_at_angle(problem):
        return 0.0
    c, at, pitch = problem.composition, problem.parted or 0.0, problem.parts.geometry.pitch
    sums = [
        (life.sum_until(at, c.met(i, slots.AHEAD)), life.sum_until(at + offset * pitch, c.met(i, slots.BEHIND)))
        for i, offset in enumerate(c.offsets)
    ]
    return sum(got + gave for got, gave in sums) - misread_at_discharge(problem, life, at, sums)


def net_into(problem: Problem, life: Trajectory, q: Array, line: int) -> float:
    """Return the gas [kg/life] into a line (0: suction, 1: discharge), taken across an angle where the net flow is.

    The discharge line gets what chambers take in elsewhere. The sum of its own port also has what gaps between
    chambers that are open to the same line leave open, which the port makes good.
    """
    c = problem.composition
    out = -float(streams_of(c, q)[2 * line : 2 * line + 2, slots.OF_GAS].sum())
    if not meets_line_at_angle(problem):
        return out
    across = flow_past_suction_port(problem, life)
    return mass_in(c, q) + out + across if line else out - across


def gap_flow_compensation(problem: Problem, life: Trajectory, opens: float, closes: float) -> tuple[float, float]:
    """Return by how much both sides of gaps disagree [kg/life] while a plenum's port is open, and the early part of it.

    Flows through gaps are integrated twice, by the chamber ahead and by the one behind. While a port holds the
    pressure, it makes good the difference. The first number sums both sides; the second is the part before chambers
    leave the suction line. Where the chamber ahead is open to the discharge line, that line makes it good instead. When
    all chambers are integrated together, both sides agree to rounding.
    """
    c, geometry, at = problem.composition, problem.parts.geometry, problem.parted or 0.0
    pitch, ahead_until = geometry.pitch, geometry.discharge_opens or geometry.life
    own, others, across = 0.0, 0.0, 0.0

    def differs(side: int, shift: float, begin: float, end: float) -> float:
        """Return what the chamber behind got beyond what the one ahead gave, by the angles of the one behind."""
        if end <= begin:
            return 0.0
        ahead, behind = c.met(side, slots.AHEAD), c.met(side, slots.BEHIND)
        got = life.sum_until(end, ahead) - life.sum_until(begin, ahead)
        return got + life.sum_until(end + shift, behind) - life.sum_until(begin + shift, behind)

    for side, offset in enumerate(c.offsets):
        shift = offset * pitch
        begin, end = max(0.0, opens - shift), closes - shift
        others += differs(side, shift, begin, end)
        across += differs(side, shift, begin, min(end, at))
        own += differs(side, shift, opens, min(closes, ahead_until - shift))
    return abs(own) + abs(others), abs(across)


def dissolved_gas_residual(problem: Problem, q: Array) -> float:
    """Return the residual of the gas dissolved in oil over a life [kg]."""
    return abs(float(sum(_columns(problem.composition, q)[slots.OF_HELD]))) if problem.composition.dissolves else 0.0


def _columns(c: Composition, q: Array) -> list[list[float]]:
    """Return the sums of all categories but that between chambers, by column (lists: faster for a few numbers)."""
    rows = streams_of(c, q).tolist()
    return list(map(list, zip(*rows[: slots.BETWEEN], *rows[slots.BETWEEN + 1 :], strict=True)))


def incoming_oil(problem: Problem, R: Array, q: Array) -> float:
    """Return the oil [kg/life] that comes in: injected, through a port, or with the gas of an expander, net (M490)."""
    c, parts, streams = problem.composition, problem.parts, streams_of(problem.composition, q)
    if c.ported:
        return float(streams[slots.PORT_OIL, slots.OF_OIL])
    if not parts.geometry.expands:
        return float(R[slots.R_INJECTED])
    net = streams[slots.SUCTION_IN] + streams[slots.SUCTION_OUT]
    return float(net[slots.OF_OIL]) if c.carried else parts.arriving_oil * float(net[slots.OF_GAS])


def injection_pressure(problem: Problem, R: Array) -> float:
    """Return the pressure [Pa] where oil comes in at once: of the chamber, or of an expander's suction line."""
    return problem.suction.pressure if problem.parts.geometry.expands else float(R[slots.R_PRESSURE])


def incoming_oil_temperature(problem: Problem, R: Array) -> float:
    """Return the temperature [K] of oil that comes in at once, with its flow work where it takes room (M108)."""
    oil = problem.parts.oil
    assert oil is not None
    return oil.temperature + problem.oil_pressure_term(max(oil.source_pressure, injection_pressure(problem, R)))


def residuals(problem: Problem, R: Array, q: Array) -> Residuals:
    """Return the residuals of a life, from its quadratures and the run-time cells R that it left."""
    c, part, trapped = problem.composition, problem.parts.oil, float(R[slots.R_TRAPPED])
    mass, heat, *of_oil = _columns(c, q)
    work, h = float(q[slots.Q_WORK]), problem.inlet.enthalpy
    enthalpy = [each - h * m for each, m in zip(heat, mass, strict=True)]
    energy = sum(enthalpy) + work - wall_drag_work(c, q)
    scale = sum(map(abs, enthalpy)) + abs(work)
    oil = oil_share = lost = 0.0
    if c.carried and part is not None:
        injected = float(R[slots.R_INJECTED])
        net = sum(of_oil[0])
        energy += part.heat_capacity * (sum(of_oil[1]) - incoming_oil_temperature(problem, R) * net)
        lost, through = abs(net + injected), max(injected, sum(map(abs, of_oil[0])) / 2)
        oil, oil_share = lost / max(through, LEAST_OIL * trapped, LEAST), lost / max(through, trapped, LEAST)
        if c.dissolves:  # the dissolved gas, relative to the gas
            held = abs(sum(of_oil[2])) / max(trapped, sum(map(abs, of_oil[2])) / 2, LEAST)
            oil, oil_share = max(oil, held), max(oil_share, held)
    else:
        energy += float(q[slots.Q_HEAT])
    if c.walls:
        heats = walls_of(c, q)[:, 0].tolist()
        energy, scale = energy + sum(heats), scale + sum(map(abs, heats))
    mass_scale = max(trapped, 0.5 * sum(map(abs, mass)), LEAST)
    open_energy = abs(energy) / max(scale, LEAST_WORK * trapped * problem.pv, LEAST)
    return Residuals(abs(sum(mass)) / mass_scale, open_energy, oil, oil_share, lost)


def outflow_of(streams: Array) -> Outflow | None:
    """Return the mean outflow to discharge; None when nothing flows out."""
    mass, enthalpy, *of_oil = streams[slots.DISCHARGE_OUT].tolist()
    if not mass < 0.0:
        return None
    ratio = T_oil = 0.0
    if of_oil:
        oil, warmth = of_oil[:2]
        ratio, T_oil = oil / mass, warmth / oil if oil < 0.0 else 0.0
    return Outflow(enthalpy / mass, ratio, T_oil)


def outflow_dissolved_gas(streams: Array) -> float:
    """Return the mean dissolved gas of the outflow's oil [kg/kg]; 0 where it is no state or no oil flows out."""
    out = streams[slots.DISCHARGE_OUT]
    flows = len(out) > slots.OF_HELD and out[slots.OF_OIL] < 0.0
    return float(out[slots.OF_HELD] / out[slots.OF_OIL]) if flows else 0.0
