"""Powers of a closed cycle: of the gas, of what lifts the oil, of what effects lose, and of the shaft.

Source: docs/model.md M28–M33, M58, M257, M491.
"""

import math
from typing import NamedTuple

from screwsim.cycle.cycle_figures import CycleFigures
from screwsim.cycle.problem import Problem
from screwsim.effects.base import PowerLoss
from screwsim.inputs.faults import checked_own_number
from screwsim.model.parts import Parts


class Powers(NamedTuple):
    """Powers [W]: of the gas, what lifts the oil (0 without oil), and losses by the names of their figures."""

    gas: float
    lift: float
    losses: dict[str, float]

    @property
    def shaft(self) -> float:
        """The shaft power (M29)."""
        return self.gas + self.lift + sum(self.losses.values())


def powers_of(parts: Parts, known: CycleFigures) -> Powers:
    """Return the powers of a closed cycle; raise Impossible where a user's effect gives no number or a gain."""
    lift = _oil_lift(parts, known) if parts.oil is not None else 0.0
    return Powers(known.indicated_power, lift, power_losses(parts, known))


def _oil_lift(parts: Parts, known: CycleFigures) -> float:
    """Return the power [W] that lifts the oil to discharge (M28).

    Where oil takes room ∮ p dV contains it, except for the work of walls that drag oil through gaps (M257).
    """
    if parts.oil_room:
        return known.drag_power
    lifted = known.oil_volume_flow * (known.plenum_pressure - known.injection_pressure)
    return lifted + known.leaked_oil_flow * (known.plenum_pressure - known.intake_pressure)


def power_losses(parts: Parts, known: CycleFigures) -> dict[str, float]:
    """Return the power losses [W], summed by name; raise Impossible where a user's effect gives no number or a gain."""
    found = {}
    for name, part in parts.all(PowerLoss):
        power = part.power(known)
        if "." in name and math.isfinite(known.indicated_power):
            checked_own_number(name, f"its power {part.figure} [W]", power, 0.0)
        found[part.figure] = found.get(part.figure, 0.0) + float(power)
    return found


def kept_in_oil(parts: Parts, known: CycleFigures) -> float:
    """Return the part of the losses' powers [W] that raises the oil's pressure (M58)."""
    return sum(float(part.kept(known)) for _, part in parts.all(PowerLoss) if part.kept is not None)


def brought_by_oil(problem: Problem, known: CycleFigures) -> float:
    """Return the flow work [W] that the oil brings to an expander, less what the shaft's own pump gave it (M491)."""
    return known.oil_volume_flow * (problem.lines.p_s - problem.lines.p_d) - kept_in_oil(problem.parts, known)
