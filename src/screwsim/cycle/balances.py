"""What a cycle leaves open: residuals of mass, energy and oil, and the mean of what flows out, from its quadratures.

Source: docs/model.md M27, M37–M39.
"""

from typing import NamedTuple

import numpy as np

from screwsim.cycle.problem import LEAST_OIL, Problem
from screwsim.model import slots
from screwsim.model.composition import Composition
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
LEAST = 1e-300  # of what something is divided by
LEAST_WORK = 1e-6  # of p V of the trapped gas: work below this is rounding


class Residuals(NamedTuple):
    """Relative residuals of gas mass, energy and oil mass over one life (M37–M39).

    The last two: that of the oil where there is little of it, as a share of the trapped gas; carried oil itself [kg].
    """

    mass: float
    energy: float
    oil: float
    oil_share: float
    oil_left: float

    @property
    def largest(self) -> float:
        """The largest, little oil as a share of the gas."""
        return max(self.mass, self.energy, self.oil_share)


class Outflow(NamedTuple):
    """The mean of what flows out to discharge, by its flow: gas enthalpy [J/kg], oil per gas, oil temperature [K]."""

    enthalpy: float
    oil_ratio: float
    T_oil: float


def streams_of(c: Composition, q: Array) -> Array:
    """Return the sums as rows, by the categories of slots: suction in, suction out, discharge in …"""
    return q[c.first_stream :].reshape(-1, c.width)


def walls_of(c: Composition, q: Array) -> Array:
    """Return of each wall the heat into the gas [J] and the conductance times time [J/K] over one life (M170)."""
    return q[slots.Q_WALLS : slots.Q_WALLS + 2 * len(c.walls)].reshape(-1, 2)


def pushed_of(c: Composition, q: Array) -> float:
    """Return the work [J] that oil does over one life on walls that drag it along (M257)."""
    return float(q[c.first_stream - 1]) if c.pushes else 0.0


def mass_in(c: Composition, q: Array) -> float:
    """Return the gas [kg] that a life takes in beyond what it gives back: nothing, where the cycle is closed."""
    return float(sum(_columns(c, q)[0]))


def met_across(problem: Problem) -> bool:
    """Tell whether the net gas flow is taken where it crosses an angle (`crossed`), not at the port."""
    return bool(problem.composition.offsets) and not problem.parts.geometry.expands and problem.parted is not None


def left_late(problem: Problem) -> bool:
    """Tell whether chambers leave the suction line later than at the injection angle: by a slide's slot, by a bore."""
    at = problem.parted
    return at is None or at > problem.parts.geometry.injection_angle


def crossed(problem: Problem, life: Trajectory) -> float:
    """Return the gas [kg] a life by which what is sucked differs from what goes on beyond where the line is left.

    A chamber meets those ahead as they were a turn before, so that what it gets from them is not quite what they give
    to those behind. Between chambers that are open to one line Δp is a few pascals, and both are off by the error of
    the pressure; what crosses the angle at which chambers leave it is not.
    """
    if not met_across(problem):
        return 0.0
    c, at, pitch, gained = problem.composition, problem.parted or 0.0, problem.parts.geometry.pitch, 0.0
    for i, offset in enumerate(c.offsets):
        ahead, behind = c.first_met + 2 * i, c.first_met + 2 * i + 1
        gained += life.sum_until(at, ahead) + life.sum_until(at + offset * pitch, behind)
    return gained


def made_good(problem: Problem, life: Trajectory, opens: float, closes: float) -> tuple[float, float]:
    """Return the gas [kg] a life that a plenum's port makes good while a chamber is open to it, and what crosses of it.

    Flows through gaps are met twice, by the chamber ahead and the one behind. Where both do not agree a port that holds
    the pressure gives or takes the difference: of both sides, the first number; of the side that lies ahead of the
    angle at which chambers leave the suction line, the second. Where the chamber ahead is open to the discharge line,
    that does. All chambers in one turn agree to rounding.
    """
    c, geometry, at = problem.composition, problem.parts.geometry, problem.parted or 0.0
    pitch, ahead_until = geometry.pitch, geometry.discharge_opens or geometry.life
    own, others, across = 0.0, 0.0, 0.0

    def differs(side: int, shift: float, begin: float, end: float) -> float:
        """Return what the chamber behind got beyond what that ahead gave, by the angles of the one behind."""
        if end <= begin:
            return 0.0
        ahead, behind = c.first_met + 2 * side, c.first_met + 2 * side + 1
        got = life.sum_until(end, ahead) - life.sum_until(begin, ahead)
        return got + life.sum_until(end + shift, behind) - life.sum_until(begin + shift, behind)

    for side, offset in enumerate(c.offsets):
        shift = offset * pitch
        begin, end = max(0.0, opens - shift), closes - shift
        others += differs(side, shift, begin, end)
        across += differs(side, shift, begin, min(end, at))
        own += differs(side, shift, opens, min(closes, ahead_until - shift))
    return abs(own) + abs(others), abs(across)


def held_left(problem: Problem, q: Array) -> float:
    """Return what a life leaves open of the gas that its oil holds [kg]."""
    return abs(float(sum(_columns(problem.composition, q)[slots.OF_HELD]))) if problem.composition.dissolves else 0.0


def _columns(c: Composition, q: Array) -> list[list[float]]:
    """Return the sums of all categories but that between chambers, by column: a few numbers, quicker as such."""
    rows = streams_of(c, q).tolist()
    return list(map(list, zip(*rows[: slots.BETWEEN], *rows[slots.BETWEEN + 1 :], strict=True)))


def residuals(problem: Problem, R: Array, q: Array) -> Residuals:
    """Return what a life leaves open, from its quadratures and the run-time cells that it left."""
    c, part, trapped = problem.composition, problem.parts.oil, float(R[slots.R_TRAPPED])
    mass, heat, *of_oil = _columns(c, q)
    work, h = float(q[slots.Q_WORK]), problem.inlet.enthalpy
    enthalpy = [each - h * m for each, m in zip(heat, mass, strict=True)]
    energy = sum(enthalpy) + work - pushed_of(c, q)
    scale = sum(map(abs, enthalpy)) + abs(work)
    oil = oil_share = lost = 0.0
    if c.carried and part is not None:
        injected = float(R[slots.R_INJECTED])
        T_oil = part.temperature + problem.pressed(max(part.source_pressure, float(R[slots.R_PRESSURE])))
        net = sum(of_oil[0])
        energy += part.heat_capacity * (sum(of_oil[1]) - T_oil * net)
        lost, through = abs(net + injected), max(injected, sum(map(abs, of_oil[0])) / 2)
        oil, oil_share = lost / max(through, LEAST_OIL * trapped, LEAST), lost / max(through, trapped, LEAST)
        if c.dissolves:  # what it holds dissolved, over the gas
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
    """Return the mean of what flows out to discharge; None when nothing flows out."""
    mass, enthalpy, *of_oil = streams[slots.DISCHARGE_OUT].tolist()
    if not mass < 0.0:
        return None
    ratio = T_oil = 0.0
    if of_oil:
        oil, warmth = of_oil[:2]
        ratio, T_oil = oil / mass, warmth / oil if oil < 0.0 else 0.0
    return Outflow(enthalpy / mass, ratio, T_oil)


def discharge_held(streams: Array) -> float:
    """Return the gas [kg/kg] that the outflow's oil holds in the mean, 0 where it is no state or none flows out."""
    out = streams[slots.DISCHARGE_OUT]
    return (
        float(out[slots.OF_HELD] / out[slots.OF_OIL]) if len(out) > slots.OF_HELD and out[slots.OF_OIL] < 0.0 else 0.0
    )
