"""A reciprocating refrigeration compressor: the cylinder of configs/slider_crank/r134a.yaml in another size."""

import math

from screwsim.fluid.description import is_mixture
from screwsim.inputs.faults import UsageError
from screwsim.template import sizes
from screwsim.template.refrigeration import Duty, conditions, duty_of
from screwsim.template.request import SceneRequest, refuse_option
from screwsim.template.texts import filled

RPM = math.pi / 30.0
BORE, CRANK, ROD, OFFSET, CLEARANCE = 25.4e-3, 8e-3, 40e-3, 2e-3, 0.16e-6
STROKE = 16.045e-3  # [m], from that crank, rod and offset
SWEPT, SPEED = 0.25 * math.pi * BORE**2 * STROKE, 2950.0 * RPM
LARGEST_PORT_SHARE = 0.3  # of the piston's area: largest possible port
ESTIMATED_EFFICIENCY = 0.65  # for an estimate of the power
WALL_TEMPERATURE_SHARE = 0.57  # of the way from suction gas to gas compressed without loss: 360 K in the known machine


def reciprocating(asked: SceneRequest) -> str:
    """Return the scene of a single cylinder."""
    refuse_option(
        "--vi", asked.ratio, "a cylinder has no built-in volume ratio, as its valves are self-acting (remove it)"
    )
    refuse_option("--diameter", asked.diameter, "is for rotors; the bore follows from --displacement (write that)")
    refuse_option("--oil", asked.oil, "no oil is injected into a cylinder (remove it)")
    fluid, speed, example = asked.fluid or "R134a", asked.speed or 1450.0 * RPM, "-10/40 degC, 20 K"
    flow = asked.flow or 10.0 / 3600.0
    duty = duty_of(fluid, flow, asked.condition or example, example)
    s = (2.0 * math.pi * flow / speed / SWEPT) ** (1.0 / 3.0)
    faster = s * speed / SPEED  # mean piston speed over the known one
    if 50e-6 * s**2 * faster > LARGEST_PORT_SHARE * 0.25 * math.pi * (BORE * s) ** 2:
        what = f"leaves no room for valves at {faster * 1.58:.3g} m/s of its piston"
        raise UsageError(
            f"--displacement {sizes.flow_text(flow)} at {sizes.rpm(speed)}: one cylinder {what} (a lower --speed)"
        )
    return _text(fluid, duty, s, faster, flow, speed)


def _wall(fluid: str, T: float) -> str:
    """Return the line on the heat between gas and wall [K]; for a blend, why there is none."""
    if is_mixture(fluid):
        return f"  # No cylinder_heat: CoolProp has no transport properties of blends such as {fluid}.\n"
    told = "between the temperatures of inflow and outflow"
    return f"  cylinder_heat: {{wall_temperature: {T:.0f} K}}    # {told}\n"


def _text(fluid: str, duty: Duty, s: float, faster: float, flow: float, speed: float) -> str:
    wide = s * math.sqrt(faster)  # scale of a port's lengths: its area grows with the piston speed
    stiff = s**3 * (speed / SPEED) ** 2  # reeds follow the crank as in the known machine
    rated = sizes.motor_for(duty.gas_flow * duty.work / ESTIMATED_EFFICIENCY)
    T_s = duty.T_e + duty.more
    values = {
        **conditions(duty),
        "fluid": fluid,
        "flow": sizes.flow_text(flow),
        "speed": sizes.rpm(speed),
        "bore": sizes.mm(BORE * s, 4),
        "crank": sizes.mm(CRANK * s, 4),
        "rod": sizes.mm(ROD * s, 4),
        "offset": sizes.mm(OFFSET * s),
        "clearance": f"{1e6 * CLEARANCE * s**3:.3g} cm^3",
        "suction_area": sizes.area(50e-6 * wide**2),
        "suction_perimeter": sizes.mm(25e-3 * wide),
        "suction_stop": sizes.mm(1.5e-3 * wide),
        "suction_mass": f"{0.25 * s**3:.3g} g",
        "suction_stiffness": f"{300.0 * stiff:.3g} N/m",
        "discharge_area": sizes.area(28e-6 * wide**2),
        "discharge_perimeter": sizes.mm(19e-3 * wide),
        "discharge_stop": sizes.mm(1e-3 * wide),
        "discharge_mass": f"{0.2 * s**3:.3g} g",
        "discharge_stiffness": f"{600.0 * stiff:.3g} N/m",
        "ring": sizes.um(1e-6 * s),
        "wall": _wall(fluid, T_s + WALL_TEMPERATURE_SHARE * (duty.hottest - T_s)),
        "rated": f"{rated:g} kW",
        "efficiency": sizes.motor_efficiency(rated),
    }
    return filled("reciprocating", values)
