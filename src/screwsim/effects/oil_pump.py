"""Oil pump: the shaft power of an independent oil pump.

What: P = V̇_oil max(0, p_delivery − p_source)/η, with p_delivery = max(p_injection, p_source) + Δp (M31): from the
separator the pump pays only the line and nozzle loss Δp, from a sump at suction pressure also the rise to the chamber.
Source: Chernov et al. 2015 name the pump's power without a formula; this form is ours.
Assumptions: incompressible oil; injection pressure is the chamber's at 360°, or while it faces a port (M255).
Parameters: efficiency, pressure_loss.
"""

from __future__ import annotations

from dataclasses import dataclass

from screwsim.declare import number, quantity
from screwsim.effects.base import Effect, Faults, PowerLoss
from screwsim.faults import Fault
from screwsim.machine.protocol import OIL
from screwsim.outputs import power_figure


@dataclass(frozen=True)
class Parameters:
    """Efficiency of the pump with its drive, and the loss of line and nozzles."""

    efficiency: float = number("efficiency of the pump with its drive", gt=0.0, le=1.0, hardly=(0.05, 0.95))
    pressure_loss: float = quantity(
        "pressure_difference", "pressure loss of oil line and nozzles", 0.0, ge=0.0, hardly=(None, 3e6)
    )


def build(parameters: Parameters, machine) -> list[PowerLoss]:
    def power(figures) -> float:
        """Return the pump's power [W] (M31)."""
        delivery = figures.delivery_pressure + parameters.pressure_loss
        return figures.oil_volume_flow * max(0.0, delivery - figures.oil_source_pressure) / parameters.efficiency

    def kept(figures) -> float:
        """Return the power [W] that lifts the oil from its source to the chamber (M58)."""
        return figures.oil_volume_flow * max(0.0, figures.delivery_pressure - figures.oil_source_pressure)

    return [PowerLoss("oil_pump_power", power, kept)]


def check(parameters: Parameters, facts) -> Faults:
    if facts.oil_supply is not None and facts.oil_supply.kind != "pump":
        yield Fault("effects.oil_pump", "displacement supply has no pump (remove it, or write oil_supply.kind: pump)")


EFFECT = Effect(
    name="oil_pump",
    title="shaft power of an independent oil pump",
    equations=("M31",),
    source="ours",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    check=check,
    needs=frozenset({OIL}),
    figures=(power_figure("oil_pump_power", "shaft power of the oil pump"),),
)
