"""Oil pump: the shaft power of an independent oil pump.

What: P = V̇_oil max(0, p_delivery − p_source)/η, with p_delivery = max(p_injection, p_source) + Δp (M31): with oil from
the separator the pump only overcomes the loss Δp of line and nozzles, from a sump at suction pressure also the rise to
the chamber. With `line` Δp is the stated loss of nozzles and filter and that of a pipe by its length and diameter
(M390).
Source: Chernov et al. 2015 name the pump's power without a formula; this form is ours; pipe: Darcy–Weisbach.
Assumptions: incompressible oil; injection pressure is the chamber's at 360°, or while it faces a port (M255); the oil
in the line has the temperature at which it is injected; a smooth pipe.
Parameters: efficiency, pressure_loss, line.
"""

import math
from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, PowerLoss, Reading
from screwsim.effects.parts.usual import PUMPS
from screwsim.inputs.declare import number, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import OIL
from screwsim.outputs import Figure, power_figure

LOSS = "oil_line_pressure_loss"
LAMINAR, TURBULENT, FITTED = 2000.0, 4000.0, 1e5  # Reynolds numbers; the last one ends Blasius's law
BEYOND = (
    "the Reynolds number of effects.oil_pump.line is {Re:.0f}, and the law of its friction holds up to 100000: its "
    "loss comes out too small (choose a larger effects.oil_pump.line.diameter)"
)


@dataclass(frozen=True)
class Line:
    """The pipe from the pump to the machine."""

    length: float = quantity("length", "length of the pipe", gt=0.0, hardly=(0.05, 100.0))
    diameter: float = quantity("length", "inner diameter of the pipe", gt=0.0, hardly=(2e-3, 0.3))
    fittings: float = number("sum of the loss coefficients of bends and valves", 0.0, ge=0.0, hardly=(None, 200.0))


@dataclass(frozen=True)
class Parameters:
    """Efficiency of the pump with its drive, and the loss of line and nozzles."""

    efficiency: float = number("efficiency of the pump with its drive", gt=0.0, le=1.0, hardly=(0.05, 0.95))
    pressure_loss: float = quantity(
        "pressure_difference",
        "pressure loss of oil line and nozzles (with line: of filter and nozzles alone)",
        0.0,
        ge=0.0,
        hardly=(None, 3e6),
    )
    line: Line | None = None


def friction_factor(Re: float) -> float:
    """Return Darcy's friction factor of a smooth pipe at a Reynolds number > 0.

    Source: laminar 64/Re (Hagen–Poiseuille) up to Re = 2000, turbulent 0.3164 Re^−0.25 (Blasius 1913, to Re = 1e5) from
    4000 on; in the transition between, the factor is linear in Re (ours).
    """
    if Re <= LAMINAR:
        return 64.0 / Re
    if Re >= TURBULENT:
        return 0.3164 * Re**-0.25
    share = (Re - LAMINAR) / (TURBULENT - LAMINAR)
    return (1.0 - share) * friction_factor(LAMINAR) + share * friction_factor(TURBULENT)


def pressure_loss(
    volume_flow: float, density: float, viscosity: float, diameter: float, length: float, fittings: float = 0.0
) -> float:
    """Return (f L/D + ζ) ρ w²/2 [Pa] (M390) at a volume flow [m³/s]; `fittings` is the sum of the ζ of fittings."""
    if volume_flow <= 0.0:
        return 0.0
    w = volume_flow / (0.25 * math.pi * diameter**2)
    f = friction_factor(reynolds(volume_flow, density, viscosity, diameter))
    return (f * length / diameter + fittings) * 0.5 * density * w**2


def reynolds(volume_flow: float, density: float, viscosity: float, diameter: float) -> float:
    """Return the Reynolds number of a volume flow [m³/s] in a pipe (M390)."""
    return 4.0 * density * volume_flow / (math.pi * diameter * viscosity)


def build(parameters: Parameters, machine) -> list[PowerLoss | Reading]:
    line = parameters.line

    def flows(figures) -> tuple[float, float, float]:
        """Return volume flow [m³/s], density [kg/m³] and viscosity [Pa s] of the oil that flows."""
        flow = figures.oil_volume_flow
        return flow, figures.oil_mass_flow / flow, figures.supply_viscosity

    def loss(figures) -> float:
        """Return the pressure loss [Pa] between pump and chamber."""
        if line is None or figures.oil_volume_flow <= 0.0:
            return parameters.pressure_loss
        pipe = line.diameter, line.length, line.fittings
        return parameters.pressure_loss + pressure_loss(*flows(figures), *pipe)

    def judge(figures) -> tuple[str, tuple[str, ...]]:
        """Return no text on a failure, and a warning of a flow beyond the range of the friction's law."""
        if line is None or figures.oil_volume_flow <= 0.0:
            return "", ()
        Re = reynolds(*flows(figures), line.diameter)
        return "", (BEYOND.format(Re=Re),) if Re > FITTED else ()

    def power(figures) -> float:
        """Return the pump's power [W] (M31)."""
        delivery = figures.delivery_pressure + loss(figures)
        return figures.oil_volume_flow * max(0.0, delivery - figures.oil_source_pressure) / parameters.efficiency

    def kept(figures) -> float:
        """Return the power [W] that raises the oil from its source's pressure to the chamber's (M58)."""
        return figures.oil_volume_flow * max(0.0, figures.delivery_pressure - figures.oil_source_pressure)

    lost = PowerLoss("oil_pump_power", power, kept)
    return [lost] if line is None else [lost, Reading((LOSS,), lambda figures: {LOSS: loss(figures)}, judge=judge)]


def check(parameters: Parameters, facts) -> Faults:
    if facts.oil_supply is not None and not facts.oil_supply.pumped:
        yield Fault("effects.oil_pump", "displacement supply has no pump (remove it, or write oil_supply.kind: pump)")
    if parameters.line is not None and facts.oil is not None and not facts.oil.knows_viscosity:
        yield Fault("oil.viscosity", "is missing (effects.oil_pump.line needs it)")


EFFECT = Effect(
    name="oil_pump",
    title="shaft power of an independent oil pump",
    equations=("M31", "M390"),
    source="ours; pipe: Darcy-Weisbach",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    check=check,
    needs=frozenset({OIL}),
    figures=(
        power_figure("oil_pump_power", "shaft power of the oil pump"),
        Figure(LOSS, "Pa", "pressure loss of oil line, filter and nozzles", needs=(".line",)),
    ),
    roles={PUMPS: ""},
)
