"""Oil injection: the oil enters through a bore while the chamber faces it, instead of all at 360°.

What: displaced oil: orifice flow (M30) through the oil supply's bore, driven by the pressure of the separator less the
loss of the line, or by a stated pressure before the bore, against that of the chamber at that angle (M104); with `line`
the loss of pipe, filter and cooler is proportional to the square of the flow (M392). Pumped oil: the flow that the pump
displaces, whatever the chamber's pressure (M194), against which it works (M255). The oil mixes into the chamber
continuously (M105).
Source: orifice: A. Lichtarowicz, R. K. Duggins, E. Markland, J. Mech. Eng. Sci. 7 (1965) 210; the window and its ramps
are ours.
Assumptions: quasi-steady; a check valve keeps gas out of the oil line, so nothing flows back; one bore sees one chamber
while it passes, so a window is as long as a lobe pitch of the rotor on whose side the bore lies. The bore's C_d is not
changed by a line; the energy that the line dissipates stays in the oil as heat.
Parameters: opens, closes, pressure_loss, line or pressure (displaced oil); bores or the pump's ratio, temperature of
the oil: oil_supply.
"""

import math
from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, OilPort
from screwsim.effects.parts.gap import ramp
from screwsim.effects.parts.port_window import RAMP, CheckWithin, WindowParameters, check_window, window_breakpoints
from screwsim.fluid import constants
from screwsim.fluid.orifice import smooth_orifice_flow
from screwsim.fluid.settings import OilLine
from screwsim.inputs.declare import optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import OIL
from screwsim.numerics.kernel import kernel

NAME = "oil_injection"
NO_LINE = OilLine(pressure_loss=0.0, flow=1.0)  # without a loss, at any flow


@dataclass(frozen=True)
class Parameters(WindowParameters):
    """Where the bore lies, and what the oil loses on its way there."""

    pressure_loss: float = quantity(
        "pressure_difference",
        "pressure loss of the oil line from the separator to the bore",
        0.0,
        ge=0.0,
        hardly=(None, 5e6),
    )
    pressure: float | None = optional(
        "pressure", "pressure of the oil before the bore, in place of separator pressure less pressure_loss"
    )
    line: OilLine | None = None


@kernel
def flow(
    phi,
    p,
    width,
    opens,
    closes,
    pressure_loss,
    line_loss,
    line_flow,
    separator_pressure,
    oil_density,
    oil_viscosity,
    bore_diameter,
    bore_length,
    bore_count,
):
    """Return the oil flow [kg/s] into a chamber at phi [rad] and pressure p [Pa] (M104).

    A line in series loses line_loss [Pa] at line_flow [m³/s] (M392).
    """
    share = ramp(phi, opens, opens + RAMP, closes - RAMP, closes)
    if share == 0.0:
        return 0.0
    dp = separator_pressure - pressure_loss - p
    free = share * smooth_orifice_flow(dp, width, oil_density, oil_viscosity, bore_diameter, bore_length, bore_count)
    if free <= 0.0:
        return 0.0
    available = dp * dp / math.sqrt(dp * dp + width * width)
    nominal = oil_density * line_flow
    return free / math.sqrt(1.0 + line_loss * free * free / (nominal * nominal * available))


@kernel
def pumped(phi, opens, closes, omega):
    """Return the pumped oil flow [kg/s] at phi [rad] per kilogram of trapped gas, for an oil ratio of one (M194)."""
    return omega * ramp(phi, opens, opens + RAMP, closes - RAMP, closes) / (closes - opens - RAMP)


def build(parameters: Parameters, machine) -> list[OilPort]:
    line, loss, stated = parameters.line or NO_LINE, parameters.pressure_loss, parameters.pressure
    values = {"opens": parameters.opens, "closes": parameters.closes, "pressure_loss": loss}
    values |= {"line_loss": line.pressure_loss, "line_flow": line.flow}
    breakpoints = window_breakpoints(parameters)
    if stated is not None:
        values["separator_pressure"] = stated
        return [OilPort(flow, values, parameters.closes, breakpoints, pressure=stated)]
    return [OilPort(flow, values, parameters.closes, breakpoints, loss, pumped)]


def check(parameters: Parameters, facts) -> Faults:
    yield from check_window(NAME, parameters)
    for name, given in (("pressure_loss", parameters.pressure_loss > 0.0), ("line", parameters.line is not None)):
        if facts.oil_supply.pumped and given:
            what = "applies to displaced oil; with oil_supply.kind: pump the pump overcomes the loss"
            yield Fault(f"effects.{NAME}.{name}", f"{what} (write it under effects.oil_pump)")
    if not facts.oil_supply.pumped and parameters.line is not None and parameters.pressure is not None:
        yield Fault(
            f"effects.{NAME}.line", "is given as well as pressure, which is that after the line (remove one of the two)"
        )
    if not facts.oil_supply.pumped and facts.oil_supply.line is not None:
        what = f"is for oil that enters at one angle (write it under effects.{NAME}, whose bore it feeds)"
        yield Fault("oil_supply.line", what)
    if parameters.pressure is not None:
        yield from _stated(parameters.pressure, parameters.pressure_loss, facts)
    if not facts.oil.carried:
        yield Fault(f"effects.{NAME}", "needs oil.transport: carried (write that, or remove the effect)")


def _stated(p: float, loss: float, facts) -> Faults:
    """Yield the faults of a stated pressure p [Pa] before the bore, beside a pressure loss [Pa]."""
    path = f"effects.{NAME}.pressure"
    if facts.oil_supply.pumped:
        what = "applies to displaced oil; with oil_supply.kind: pump the ratio is stated"
        yield Fault(path, f"{what} (remove it, or write oil_supply.kind: displacement)")
    elif loss > 0.0:
        yield Fault(path, "is given as well as pressure_loss (remove one of the two)")
    elif (p_d := discharge_pressure(facts)) is not None and p > p_d:
        what = f"{p / 1e5:.6g} bar is above the {p_d / 1e5:.6g} bar of the separator that pushes the oil"
        yield Fault(path, f"{what} (choose a lower one, or oil_supply.kind: pump)")


def discharge_pressure(facts) -> float | None:
    """Return the pressure [Pa] of the discharge line, stated or of saturation; None where the scene gives neither.

    A condensing temperature without saturation, of which the check of the operation tells, gives none.
    """
    p_d, T_c = facts.operation.discharge.pressure, facts.operation.condensing_temperature
    p_d = p_d if facts.operation.gas_cooler is None else facts.operation.gas_cooler.pressure
    if p_d is not None or T_c is None:
        return p_d
    limits = constants.limits(facts.gas.name)
    saturated = limits is None or limits.T_triple < T_c < limits.T_critical
    return constants.condensing_pressure(facts.gas.name, T_c) if saturated else None


EFFECT = Effect(
    name=NAME,
    title="oil enters through a bore while the chamber faces it",
    equations=("M30", "M104", "M105", "M194", "M255", "M392"),
    source="Lichtarowicz et al. 1965; window: ours",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    states=("T_oil", "x_oil"),
    check=check,
    check_geometry=CheckWithin(NAME),
    needs=frozenset({OIL}),
    in_expander="never",
)
