"""Backflow from the discharge line: extrapolate its effect from one turn to all turns to come.

Gas and oil that flow back mix with what is compressed and leave with it. If they are warmer by ΔT, they warm the
outflow by s ΔT, where s is their share of its heat capacity, and that is what flows back next: all later turns together
add s/(1 − s) ΔT. This holds where oil is carried, whose heat leaves with it. It does not hold for heat that goes to a
stated outlet temperature, to droplets, or to a gas whose two phases are followed: that heat does not come back.

Source: docs/explanation/closing.md, oil and heat that flow back.
"""

from typing import NamedTuple

import numpy as np

from screwsim.cycle.balances import streams_of
from screwsim.cycle.feedback import AT_ENTHALPY, AT_TEMPERATURE
from screwsim.cycle.problem import Problem
from screwsim.model.slots import DISCHARGE_IN, DISCHARGE_OUT, OF_GAS, OF_OIL

Array = np.ndarray
LARGEST_SHARE = 0.5  # largest share of backflow for which it is assumed that nothing else takes its heat
LEAST_OIL = 0.1  # smallest heat capacity of the oil over the gas's; with less, the amount of oil itself returns slowly
MOST_TURNS = 20.0  # turns' worth of a warming that is still to come, at most
LARGEST_CHANGE = 0.1  # largest relative change of the oil's temperature that is extrapolated


class BackflowFeedback(NamedTuple):
    """The share of the outflow that flows back, and the later turns' addition to the discharge line [J/kg], [K]."""

    share: float = 0.0
    enthalpy: float = 0.0
    temperature: float = 0.0

    def extrapolated(self, unknowns_out: Array) -> Array:
        """Return `unknowns_out` with the addition of later turns; unchanged where that is zero."""
        if self.temperature == 0.0:
            return unknowns_out
        line = unknowns_out.copy()
        line[AT_ENTHALPY] += self.enthalpy
        line[AT_TEMPERATURE] += self.temperature
        return line


NO_FEEDBACK = BackflowFeedback()


def backflow_feedback(problem: Problem, q: Array, unknowns_in: Array, unknowns_out: Array) -> BackflowFeedback:
    """Return the backflow's share and later effect after a life of quadratures q."""
    found = _backflow(problem, q, unknowns_in, unknowns_out)
    if found is None or found.oil < LEAST_OIL:
        return NO_FEEDBACK
    share = min(found.share, LARGEST_SHARE)
    gas, later = problem.parts.gas.c_p, share / (1.0 - share) * found.warmer
    believed = abs(later) < LARGEST_CHANGE * unknowns_out[AT_TEMPERATURE] and abs(gas * later) < LARGEST_CHANGE * (
        unknowns_out[AT_ENTHALPY] + problem.enthalpy_shift
    )
    return BackflowFeedback(share, gas * later, later) if believed else BackflowFeedback(share)


def later_warming(problem: Problem, q: Array, unknowns_in: Array, unknowns_out: Array) -> float:
    """Return by how much [K] turns after a life of quadratures q still warm what flows out; 0 where that is not known.

    Whatever the share, but of at most `MOST_TURNS` turns.
    """
    found = _backflow(problem, q, unknowns_in, unknowns_out)
    return 0.0 if found is None else min(found.share / (1.0 - found.share), MOST_TURNS) * found.warmer


class _Backflow(NamedTuple):
    """Heat capacity of the backflow over that of the outflow, of its oil over its gas's; by how much it warmed [K]."""

    share: float
    oil: float
    warmer: float


def _backflow(problem: Problem, q: Array, unknowns_in: Array, unknowns_out: Array) -> _Backflow | None:
    """Return the backflow of a life of quadratures q; None where its heat does not return, or nothing is delivered."""
    parts, known = problem.parts, problem.scene.gas
    if not problem.composition.carried or parts.oil is None or parts.held_back or known.equilibrium:
        return None
    if problem.scene.operation.discharge.temperature is not None:
        return None
    at_line = streams_of(problem.composition, q)[DISCHARGE_IN : DISCHARGE_OUT + 1]
    back, out = at_line[:, [OF_GAS, OF_OIL]].tolist()  # [kg]
    gas, oil = parts.gas.c_p, parts.oil.heat_capacity
    comes, goes = (gas * flow[0] + oil * flow[1] for flow in (back, out))
    if not (0.0 < comes < -goes and out[0] < 0.0):
        return None
    change = unknowns_out - unknowns_in
    warmer = float(back[0] * change[AT_ENTHALPY] + back[1] * oil * change[AT_TEMPERATURE]) / comes
    return _Backflow(comes / -goes, oil * out[1] / (gas * out[0]), warmer)
