"""Reed valves: plates with mass and spring between cylinder and lines, whose lift and speed are states of their own.

What: m ẍ = c_F A Δp − F_0 − k x − 2 ζ √(k m) ẋ (S25) between seat and stop, at which the speed jumps, v' = −e v (S26);
flow through port and curtain in series (S27). The lift is stored over that of the stop, the speed over a scale.
Source: one degree of freedom: M. Costagliola, J. Appl. Mech. 17 (1950) 415; impact: Newton's law of restitution.
Assumptions: one degree of freedom; the port's pressure difference acts on the port's area at every lift; quasi-steady
flow; no sticking, no gas spring, no flow when shut; seat and stop are rigid. The restitution of a reed is seldom known:
0.3 is assumed at both. The work that the gas does on the reed is not taken from the gas: damping and impacts turn it
into heat within the turn, which the gas would get back (docs/reference/slider-crank.md says how much it is).
Parameters: of each valve port_area, perimeter, stop, mass, stiffness, preload; damping_ratio, seat_restitution,
stop_restitution, force_coefficient, flow_coefficient.
"""

import math
from dataclasses import dataclass
from functools import cache

from screwsim.effects.base import ChamberState, Effect, Faults, FlowPath, Reading, Stops
from screwsim.effects.parts.gap import flow_coefficient
from screwsim.effects.parts.usual import WAY_IN, WAY_OUT, Sized
from screwsim.effects.parts.valves import SIDES, VALVE_LOSSES, port_area, stated_once, valve_losses
from screwsim.inputs.declare import number, quantity
from screwsim.machine.protocol import BORE, CYLINDER, PISTON
from screwsim.numerics.kernel import Kernel, kernel
from screwsim.outputs import Trace


@dataclass(frozen=True)
class Parameters:
    """Two reeds, and what they have in common."""

    suction_port_area: float = quantity("area", "area A of the suction valve's port", gt=0.0)
    suction_perimeter: float = quantity("length", "perimeter of that port: curtain area over lift", gt=0.0)
    suction_stop: float = quantity("length", "lift of the suction reed at its stop", gt=0.0)
    suction_mass: float = quantity("mass", "equivalent mass m of the suction reed", gt=0.0)
    suction_stiffness: float = quantity("stiffness", "stiffness k of the suction reed at the port", gt=0.0)
    discharge_port_area: float = quantity("area", "area A of the discharge valve's port", gt=0.0)
    discharge_perimeter: float = quantity("length", "perimeter of that port", gt=0.0)
    discharge_stop: float = quantity("length", "lift of the discharge reed at its stop", gt=0.0)
    discharge_mass: float = quantity("mass", "equivalent mass m of the discharge reed", gt=0.0)
    discharge_stiffness: float = quantity("stiffness", "stiffness k of the discharge reed at the port", gt=0.0)
    suction_preload: float = quantity("force", "force that presses the suction reed onto its seat", 0.0, ge=0.0)
    discharge_preload: float = quantity("force", "force that presses the discharge reed onto its seat", 0.0, ge=0.0)
    damping_ratio: float = number("zeta: damping ratio of the free reed", 0.1, ge=0.0, le=2.0)
    seat_restitution: float = number("e: speed after an impact on the seat, over that before it", 0.3, ge=0.0, lt=1.0)
    stop_restitution: float = number("e for an impact on the stop", 0.3, ge=0.0, lt=1.0)
    force_coefficient: float = number(
        "c_F: force over (port area times pressure difference)", 1.0, gt=0.0, le=100.0, hardly=(None, 3.0)
    )
    flow_coefficient: float = flow_coefficient("the valves", 0.7)


@kernel
def speed_scale(load, stiffness, mass, stop):
    """Return the frequency Ω [1/s] by which speeds are scaled: η = dx/dt over Ω times the stop's lift (S25)."""
    return math.sqrt((load / stop + stiffness) / mass)


@kernel
def reed_acceleration(speed, push, load, stiffness, mass, stop, damping_ratio):
    """Return dη/dt [1/s] of a reed at scaled speed η under a push (S25)."""
    return speed_scale(load, stiffness, mass, stop) * push - 2.0 * damping_ratio * math.sqrt(stiffness / mass) * speed


@kernel
def push_of(lift, force, load, stiffness, stop, preload):
    """Return the net force on a reed at rest at lift ξ under a gas force [N], over the force that defines Ω (S25)."""
    return (force - preload - stiffness * stop * lift) / (load + stiffness * stop)


@kernel
def reed_push(lift, p, p_suction, p_discharge, opens, force_area, stiffness, stop, preload):
    """Return the push on the suction reed, which opens into the cylinder (`opens` 1), or the discharge reed (-1)."""
    load = force_area * abs(p_discharge - p_suction)
    along = p_suction - p if opens > 0.0 else p - p_discharge
    return push_of(lift, force_area * along, load, stiffness, stop, preload)


@kernel
def lift_rate(speed, p_suction, p_discharge, force_area, stiffness, mass, stop):
    """Return dξ/dt [1/s] of a reed."""
    return speed * speed_scale(force_area * abs(p_discharge - p_suction), stiffness, mass, stop)


@kernel
def speed_rate(
    lift, speed, p, p_suction, p_discharge, opens, force_area, stiffness, mass, stop, preload, damping_ratio
):
    """Return dη/dt [1/s] of a reed."""
    load = force_area * abs(p_discharge - p_suction)
    push = reed_push(lift, p, p_suction, p_discharge, opens, force_area, stiffness, stop, preload)
    return reed_acceleration(speed, push, load, stiffness, mass, stop, damping_ratio)


@kernel
def opened(lift, curtain):
    """Return the open share of a port under a reed at lift ξ; `curtain`: full curtain area over the port's (S27)."""
    if lift < 0.0:  # at zero lift the slope is that of an opening reed
        return 0.0
    a = curtain * lift
    return a / math.sqrt(1.0 + a * a)


RESTLESS = "a smaller effects.reed_valves.seat_restitution or stop_restitution"


@cache
def of_side(kernel: Kernel, side: str) -> Kernel:
    """Return a kernel that asks for the lift and the speed of one side's reed."""
    return kernel.asking(lift=f"{side}_valve_lift", speed=f"{side}_valve_speed")


def reed(parameters: Parameters, side: str) -> dict[str, float]:
    """Return the values [SI] of one reed's kernel arguments."""
    own = {name: getattr(parameters, f"{side}_{name}") for name in ("stop", "mass", "stiffness", "preload")}
    area = getattr(parameters, f"{side}_port_area")
    return own | {
        "area": area,
        "opens": SIDES[side],
        "curtain": getattr(parameters, f"{side}_perimeter") * own["stop"] / area,
        "force_area": parameters.force_coefficient * area,
        "damping_ratio": parameters.damping_ratio,
    }


def build(parameters: Parameters, machine) -> list[FlowPath | ChamberState | Stops | Reading]:
    built: list[FlowPath | ChamberState | Stops | Reading] = []
    restitution = parameters.seat_restitution, parameters.stop_restitution
    for side in SIDES:
        values = reed(parameters, side)
        coefficient, opening = parameters.flow_coefficient, of_side(opened, side)
        names = f"{side}_valve_lift", f"{side}_valve_speed"
        built.append(FlowPath(side, port_area, values, flow_coefficient=coefficient, opening=opening))
        rates = of_side(lift_rate, side), of_side(speed_rate, side)
        built += [ChamberState(name, rate, values) for name, rate in zip(names, rates, strict=True)]
        built.append(Stops(*names, of_side(reed_push, side), values, restitution, RESTLESS))
    return [*built, valve_losses()]


def check(parameters: Parameters, facts) -> Faults:
    yield from stated_once("reed_valves", "check_valves", facts)


EFFECT = Effect(
    name="reed_valves",
    title="reed valves with mass and spring between cylinder and both lines",
    equations=("M12", "M13", "S24", "S25", "S26", "S27", "S32", "S33"),
    source="Costagliola 1950; Newton's law of restitution",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({CYLINDER}),
    roles={WAY_IN: "", WAY_OUT: ""},
    figures=VALVE_LOSSES,
    traces=tuple(
        Trace(f"{side}_valve_{what}", "1", f"{what} of the {side} valve over {over}")
        for side in SIDES
        for what, over in (("lift", "that of its stop"), ("speed", "its scale"))
    ),
    sizes=(
        Sized("suction_port_area", PISTON, 100.0, (0.0, 1.0)),
        Sized("discharge_port_area", PISTON, 100.0, (0.0, 1.0)),
        Sized("suction_perimeter", BORE, 1000.0, (0.0, 50.0)),
        Sized("discharge_perimeter", BORE, 1000.0, (0.0, 50.0)),
        Sized("suction_stop", BORE, 1.0, (0.0, 0.1)),
        Sized("discharge_stop", BORE, 1.0, (0.0, 0.1)),
    ),
)
