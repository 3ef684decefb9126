"""Motor: the electrical power behind the shaft power, from a curve of losses over the load.

What: P_el = (P_shaft + P_loss)/η_d, P_loss = ℓ P_r [c + (1 − c) x²], x = P_shaft/P_r, ℓ = 1/η_r − 1 (M148): of the loss
at rated load the share c does not depend on the load, the rest goes with its square. Efficiencies and COP on P_el
follow (M149).
Source: separation of losses of induction machines (textbook; IEC 60034-2-1); IEC 60034-30-1 states η_r by class and
size: a four-pole IE3 motor of 75 kW at 50 Hz has 0.950, which is the default.
Assumptions: the loss does not depend on the speed but through the power; it heats neither gas nor oil. An expander's
generator loses the same at the same load. The ledger divides the shaft power: this loss is beyond it.
Parameters: rated_power, efficiency, constant_share, drive_efficiency.
"""

from __future__ import annotations

from dataclasses import dataclass

from screwsim.declare import number, quantity
from screwsim.effects.base import Effect, Reading

FIGURES = ("motor_loss", "electrical_power", "motor_efficiency")
ON_ELECTRICAL = ("isothermal_efficiency", "isentropic_efficiency", "cop")


@dataclass(frozen=True)
class Parameters:
    """Rated point and loss curve of the motor, and the efficiency of its inverter."""

    rated_power: float = quantity("power", "P_r: rated power at the shaft", gt=0.0)
    efficiency: float = number(
        "eta_r: efficiency at rated power (default: IE3, 75 kW, four poles)", 0.95, gt=0.0, le=1.0
    )
    constant_share: float = number("c: share of the rated loss that does not depend on the load", 0.4, ge=0.0, le=1.0)
    drive_efficiency: float = number("eta_d: efficiency of the inverter (1: none)", 1.0, gt=0.0, le=1.0)


def motor_loss(parameters: Parameters, shaft_power: float) -> float:
    """Return the loss of motor and inverter [W] at a shaft power [W], negative for a generator's (M148)."""
    load, rated = shaft_power / parameters.rated_power, 1.0 / parameters.efficiency - 1.0
    share = parameters.constant_share
    inner = shaft_power + rated * parameters.rated_power * (share + (1.0 - share) * load * load)
    driven = inner / parameters.drive_efficiency if inner >= 0.0 else inner * parameters.drive_efficiency
    return driven - shaft_power


def build(parameters: Parameters, machine) -> list[Reading]:
    def read(figures) -> dict[str, float | None]:
        """Return loss, electrical power and what is referred to it (M148, M149)."""
        shaft = figures.shaft_power
        loss = motor_loss(parameters, shaft)
        electrical = shaft + loss
        driving = shaft > 0.0 and electrical > 0.0
        giving = shaft < 0.0 and electrical < 0.0
        efficiency = shaft / electrical if driving else electrical / shaft if giving else None
        found: dict[str, float | None] = dict(zip(FIGURES, (loss, electrical, efficiency), strict=True))
        for name in ON_ELECTRICAL:
            value = getattr(figures, name)
            found[f"electrical_{name}"] = None if value is None or efficiency is None else value * efficiency
        return found

    return [Reading((*FIGURES, *(f"electrical_{name}" for name in ON_ELECTRICAL)), read)]


EFFECT = Effect(
    name="motor",
    title="electrical power of motor and inverter",
    equations=("M148", "M149"),
    source="separation of losses; IEC 60034-30-1",
    parameters=Parameters,
    build=build,
)
