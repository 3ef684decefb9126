"""A reciprocating refrigeration compressor: the cylinder of configs/slider_crank/r134a.yaml in another size."""

import math
from collections.abc import Mapping
from typing import NamedTuple

from screwsim.fluid import constants
from screwsim.fluid.transport import transport
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import RPM
from screwsim.template import duty as duties
from screwsim.template import sizes, valves
from screwsim.template.duty import Duty, conditions, duty_of
from screwsim.template.request import SceneRequest, condition_of, refuse_option
from screwsim.template.texts import filled, two_phase


class Cylinder(NamedTuple):
    """A known cylinder, in SI units, with what is known of it; `wall`: its temperature, from coldest to hottest gas."""

    known: str
    evidence: str
    bore: float
    crank: float
    rod: float
    offset: float
    stroke: float
    clearance: float
    speed: float
    ring: float
    wall: float

    @property
    def swept(self) -> float:
        """Swept volume [m³]."""
        return 0.25 * math.pi * self.bore**2 * self.stroke


RATED = """\
# Its clearance, and the natural frequency and damping of its reeds, were fitted to the volumetric efficiency of two
# semi-hermetic compressors of 13.4 and 18.1 m^3/h on R134a; one of 32.5 m^3/h is within 4 points of it from 25 to 87 Hz
# (validation/varispeed). Friction was fitted to a series of rated machines on R134a and R507A (validation/energyplus).
# With a motor as efficient as that of a whole machine, the isentropic efficiency of the electrical power is within 2
# points of the mean of six others on R404A and of seven on R134a, and 2 to 7 points above that of those three."""
KNOWN = Cylinder(
    known="configs/slider_crank/r134a.yaml (bore 25.4 mm, 2950 rpm)",
    evidence=RATED,
    bore=25.4e-3,
    crank=8e-3,
    rod=40e-3,
    offset=2e-3,
    stroke=16.045e-3,  # from that crank, rod and offset
    clearance=0.345e-6,  # fitted (validation/varispeed)
    speed=2950.0 * RPM,
    ring=1e-6,
    wall=0.57,  # 360 K in the known machine
)
CARBON_DIOXIDE = Cylinder(
    known="configs/co2/transcritical.yaml (bore 30 mm, 1450 rpm)",
    evidence="# Friction was fitted to rated machines on R134a and R507A (validation/energyplus). At -10/15 degC the\n"
    "# isentropic efficiency of the electrical power is then within 2 points of the mean of nine rated compressors\n"
    "# (validation/co2).",
    bore=30e-3,
    crank=12.7e-3,
    rod=62e-3,
    offset=0.0,
    stroke=25.4e-3,
    clearance=0.9e-6,
    speed=1450.0 * RPM,
    ring=2e-6,
    wall=0.84,  # 350 K in the known machine
)
# of the indicated power, and [bar] of the displaced flow: fitted to rated machines (validation/energyplus/friction.py)
FRICTION, FRICTION_PRESSURE = 0.135, 0.28
FLOW, SMALL_FLOW = 10.0 / 3600.0, 1.5 / 3600.0  # [m³/s] default displacement of a cylinder; of CO2, which is denser
LITTLE_SUPERHEAT = 8.0  # [K] below which gas may get wet where it expands into the cylinder: up to 4 K do at 1450 rpm
ESTIMATED_EFFICIENCY = 0.65  # for an estimate of the power
CUBE = math.pi**2 / 6.0  # mean cube of a piston's sinusoidal speed over the cube of its mean
BESIDE = 0.7  # efficiency beside losses in valves and by friction, which prevail where pressures are close, or low


def reciprocating(asked: SceneRequest) -> str:
    """Return the scene of a single cylinder."""
    no_ratio = "a cylinder has no built-in volume ratio, as its valves are self-acting (remove it)"
    refuse_option("--vi", asked.ratio, no_ratio)
    refuse_option("--diameter", asked.diameter, "is for rotors; the bore follows from --displacement (write that)")
    refuse_option("--oil", asked.oil, "no oil is injected into a cylinder (remove it)")
    fluid, speed, example = asked.fluid or "R134a", asked.speed or 1450.0 * RPM, "-10/40 degC, 20 K"
    condition = asked.condition or example
    dense = duties.is_carbon_dioxide(fluid)
    of = CARBON_DIOXIDE if dense else KNOWN
    flow = asked.flow or (SMALL_FLOW if dense else FLOW)
    stated = condition_of(condition, "temperature", example)
    pressure = None
    if duties.needs_gas_cooler(fluid, stated):
        duties.refuse_too_warm(condition, stated)
        pressure = duties.best_pressure(stated.low, stated.high)
    duty = duty_of(fluid, flow, condition, example, pressure, lossless=True)
    s = (2.0 * math.pi * flow / speed / of.swept) ** (1.0 / 3.0)
    found = _valves(of, fluid, duty, s, speed)
    if found["suction"].mach > valves.LARGEST_MACH:
        what = f"leaves no room for valves at {s * speed * of.stroke / math.pi:.3g} m/s of its piston"
        where = f"--displacement {sizes.flow_text(flow)} at {sizes.rpm(speed)}"
        raise UsageError(f"{where}: one cylinder {what} (a lower --speed)")
    return _text(of, fluid, duty, s, found, flow, speed, pressure is not None)


def _valves(of: Cylinder, fluid: str, duty: Duty, s: float, speed: float) -> dict[str, valves.Valve]:
    """Return the valves of a cylinder at a scale s of lengths and a speed [rad/s], by side."""
    piston, piston_speed = 0.25 * math.pi * (of.bore * s) ** 2, s * of.stroke * speed / math.pi
    ends = {"suction": (duty.p_s, duty.T_e + duty.more), "discharge": (duty.p_d, duty.hottest)}
    R = constants.gas_constant(fluid)
    return {
        side: valves.valve(piston, piston_speed, speed, p, duty.k, math.sqrt(duty.k * R * T))
        for side, (p, T) in ends.items()
    }


def _valve_losses(duty: Duty, found: Mapping[str, valves.Valve], flow: float) -> float:
    """Return the estimated power [W] lost in both valves: that of each pressure drop and the flow [m³/s] through it."""
    flows = {"suction": flow, "discharge": flow * (duty.p_s / duty.p_d) ** (1.0 / duty.k)}
    return sum(CUBE * each.stiffness * each.stop / each.area * flows[side] for side, each in found.items())


def _wall(fluid: str, p_s: float, T_s: float, T: float) -> str:
    """Return the line on heat between suction gas [Pa, K] and wall [K], or why there is none."""
    try:
        transport(fluid, 1e4, max(T, 300.0))  # as effects.cylinder_heat asks of a scene, and of its gas
        transport(fluid, p_s, max(T_s, T))
    except UsageError as error:
        return f"  # No cylinder_heat: {error}.\n"
    told = "between the temperatures of inflow and outflow"
    return f"  cylinder_heat: {{wall_temperature: {T:.0f} K}}    # {told}\n"


def _text(
    of: Cylinder,
    fluid: str,
    duty: Duty,
    s: float,
    found: Mapping[str, valves.Valve],
    flow: float,
    speed: float,
    cooled: bool,
) -> str:
    lossless, lost, rubbed = duty.gas_flow * duty.work, _valve_losses(duty, found, flow), 1e5 * FRICTION_PRESSURE * flow
    rated = sizes.motor_for(max(lossless / ESTIMATED_EFFICIENCY, (lossless + lost + rubbed) / BESIDE))
    T_s = duty.T_e + duty.more
    values = {
        **_warm_side(duty, fluid, cooled),
        "known": of.known,
        "evidence": of.evidence,
        "fluid": fluid,
        "two_phase": two_phase(fluid, duty.more < LITTLE_SUPERHEAT),
        "flow": sizes.flow_text(flow),
        "speed": sizes.rpm(speed),
        "bore": sizes.mm(of.bore * s, 4),
        "crank": sizes.mm(of.crank * s, 4),
        "rod": sizes.mm(of.rod * s, 4),
        "offset": f"  offset: {sizes.mm(of.offset * s)}\n" if of.offset else "",
        "clearance": f"{1e6 * of.clearance * s**3:.3g} cm^3",
        "share": f"{100.0 * of.clearance / of.swept:.2g}",
        "reeds": "".join(_reed(side, each, 0.25 * math.pi * (of.bore * s) ** 2, speed) for side, each in found.items()),
        "damping": f"{valves.DAMPING_RATIO:g}",
        "ring": sizes.um(of.ring * s),
        "wall": _wall(fluid, duty.p_s, T_s, T_s + of.wall * (duty.hottest - T_s)),
        "friction": f"{FRICTION:g}",
        "pressure": f"{FRICTION_PRESSURE:g} bar",
        "rated": f"{rated:g} kW",
        **_drive(fluid, sizes.motor_efficiency(rated)),
    }
    return filled("reciprocating", values)


def _drive(fluid: str, efficiency: str) -> dict[str, str]:
    """Return the efficiency of the motor, and what cools it."""
    if not duties.motor_in_gas(fluid):
        told = "Open drive, as the gas attacks copper"
        return {"efficiency": efficiency, "stands": told}
    told = "Semi-hermetic: the suction gas cools the motor"
    return {"efficiency": f"{efficiency}, cooling: suction_gas", "stands": told}


def _reed(side: str, valve: valves.Valve, piston: float, speed: float) -> str:
    """Return the entries of a valve with their basis; area of the piston [m²], speed [rad/s]."""
    full = ", no room for more" if valve.mach > valves.MACH * 1.001 else ""
    share = f"{100.0 * valve.area / piston:.0f} % of the piston{full}"
    times = valve.frequency / speed * 2.0 * math.pi
    entries = (
        (
            "port_area",
            sizes.area(valve.area),
            f"{share}: {valve.velocity:.3g} m/s, {valve.mach:.3f} of the speed of sound",
        ),
        ("perimeter", sizes.mm(valve.perimeter), f"of round ports of {sizes.mm(valve.bore, 2)}"),
        ("stop", sizes.mm(valve.stop), "a quarter of their diameter"),
        ("mass", f"{1e3 * valve.mass:.3g} g", f"{valve.frequency:.0f} Hz, {times:.2g} times the shaft's frequency"),
        ("stiffness", f"{float(f'{valve.stiffness:.3g}'):g} N/m", "as strong at the stop as the gas at that velocity"),
    )
    return "".join(f"    {side}_{name}: {value}    # {told}\n" for name, value, told in entries)


def _warm_side(duty: Duty, fluid: str, cooled: bool) -> dict[str, str]:
    """Return the temperatures of a duty and its lines: of a condenser, or of a gas cooler."""
    told = conditions(duty, fluid)
    if not cooled:
        lines = ("condensing_temperature: {condensing}{point}", "superheat: {superheat}", "subcooling: {subcooling}")
    else:
        pressure = f"{1e-5 * duty.p_d:.1f} bar"
        told["condition"] = f"{told['evaporating']}, gas cooler {pressure}/{told['condensing']}"
        lines = (
            "superheat: {superheat}",
            "# Above its critical point CO2 does not condense. This pressure gives the best COP by",
            f"# {duties.PRESSURE_SOURCE}{duties.range_note(duty.T_e)};",
            "# a sweep of operation.gas_cooler.pressure finds that of this machine.",
            f"gas_cooler: {{{{pressure: {pressure}, outlet_temperature: {{condensing}}}}}}",
        )
    return {**told, "warm_side": "".join(f"  {line}\n" for line in lines).format(**told)}
