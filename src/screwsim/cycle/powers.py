"""Powers of a cycle beside the gas work: losses, the oil's lift, what the shaft takes (docs/model.md M28–M33)."""

import math

from screwsim.cycle.known import CycleFigures
from screwsim.effects.base import PowerLoss
from screwsim.inputs.faults import own_number
from screwsim.model.parts import Parts


def oil_lift(parts: Parts, known: CycleFigures) -> float:
    """Return the power [W] that lifts the oil to discharge (M28).

    Where oil takes room ∮ p dV contains it, but for what walls do that drag oil through gaps (M257).
    """
    if parts.oil_room:
        return known.drag_power
    lifted = known.oil_volume_flow * (known.plenum_pressure - known.injection_pressure)
    return lifted + known.leaked_oil_flow * (known.plenum_pressure - known.intake_pressure)


def power_losses(parts: Parts, known: CycleFigures) -> dict[str, float]:
    """Return the power losses [W], of one name their sum; raise Impossible where an own effect gives none or a gain."""
    found = {}
    for name, part in parts.all(PowerLoss):
        power = part.power(known)
        if "." in name and math.isfinite(known.indicated_power):
            own_number(name, f"its power {part.figure} [W]", power, 0.0)
        found[part.figure] = found.get(part.figure, 0.0) + float(power)
    return found


def shaft_power(parts: Parts, known: CycleFigures) -> float:
    """Return the power that the shaft takes [W] (M29)."""
    lift = oil_lift(parts, known) if parts.oil is not None else 0.0
    return known.indicated_power + lift + sum(power_losses(parts, known).values())
