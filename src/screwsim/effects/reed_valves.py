"""Reed valves: plates with mass and spring between cylinder and lines, with lift and speed as states of their own.

What: m ẍ = c_F A Δp − F_0 − k x − 2 ζ √(k m) ẋ + contact (S25), contact with seat and stop by Hunt and Crossley
(S26), flow through port and curtain in series (S27). Lift over that of the stop, speed over a scale.
Source: one degree of freedom: M. Costagliola, J. Appl. Mech. 17 (1950) 415; contact: K. H. Hunt, F. R. E. Crossley, J.
Appl. Mech. 42 (1975) 440.
Assumptions: one degree of freedom; the port's pressure difference acts on the port's area at every lift; quasi-steady
flow; no sticking, no gas spring, no flow when shut. Seat and stop give way by a stated share of the lift. What the gas
does on the reed is not taken from the gas: damping and impacts turn it into heat within the turn, which the gas would
get back (docs/slider-crank.md says how much it is).
Parameters: of each valve port_area, perimeter, stop, mass, stiffness, preload; damping_ratio, restitution, softness,
force_coefficient, flow_coefficient.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from screwsim.declare import number, quantity
from screwsim.effects.base import ChamberState, Effect, FlowPath, Reading
from screwsim.effects.valves import SIDES, port_area, valve_losses
from screwsim.faults import Fault
from screwsim.machine.kinds import SLIDER_CRANK
from screwsim.numerics.kernel import kernel


@dataclass(frozen=True)
class Parameters:
    """Two reeds, and what they have in common."""

    suction_port_area: float = quantity("area", "area A of the suction valve's port", gt=0.0)
    suction_perimeter: float = quantity("length", "perimeter of that port: the curtain's area over the lift", gt=0.0)
    suction_stop: float = quantity("length", "lift of the suction reed at its stop", gt=0.0)
    suction_mass: float = quantity("mass", "equivalent mass m of the suction reed", gt=0.0)
    suction_stiffness: float = quantity("stiffness", "stiffness k of the suction reed at the port", gt=0.0)
    discharge_port_area: float = quantity("area", "area A of the discharge valve's port", gt=0.0)
    discharge_perimeter: float = quantity("length", "perimeter of that port", gt=0.0)
    discharge_stop: float = quantity("length", "lift of the discharge reed at its stop", gt=0.0)
    discharge_mass: float = quantity("mass", "equivalent mass m of the discharge reed", gt=0.0)
    discharge_stiffness: float = quantity("stiffness", "stiffness k of the discharge reed at the port", gt=0.0)
    suction_preload: float = quantity("force", "force that presses the suction reed on its seat", 0.0, ge=0.0)
    discharge_preload: float = quantity("force", "force that presses the discharge reed on its seat", 0.0, ge=0.0)
    damping_ratio: float = number("zeta of the free reed", 0.1, ge=0.0, le=2.0)
    restitution: float = number("speed after over speed before an impact at the scale of speed", 0.3, gt=0.0, lt=1.0)
    softness: float = number(
        "share of the stop's lift by which the full pressure difference dents seat and stop", 1e-3, gt=0.0, le=0.1
    )
    force_coefficient: float = number("c_F: force over port area times pressure difference", 1.0, gt=0.0)
    flow_coefficient: float = number("flow coefficient of the valves", 0.7, ge=0.0)


@lru_cache(maxsize=32)
def contact_damping(restitution: float) -> float:
    """Return λ of the contact law whose restitution at the scale of speed is given (S26), by bisection."""
    low, high = 0.0, 1.0 / restitution
    for _ in range(200):
        middle = 0.5 * (low + high)
        before = middle - math.log1p(middle)
        after = -middle * restitution - math.log1p(-middle * restitution) if middle * restitution < 1.0 else math.inf
        low, high = (middle, high) if after < before else (low, middle)
    return 0.5 * (low + high)


@kernel
def speed_scale(load, stiffness, mass, stop):
    """Return the frequency Ω [1/s] to whose product with the stop's lift the speed is related (S25)."""
    return math.sqrt((load / stop + stiffness) / mass)


@kernel
def contact(dent, approach, contact_stiffness, contact_damping):
    """Return the acceleration over Ω and lift with which a dented seat or stop pushes back (S26); it never pulls."""
    if dent <= 0.0:
        return 0.0
    return contact_stiffness * dent * max(0.0, 1.0 + contact_damping * approach)


@kernel
def reed_acceleration(
    lift, speed, force, load, stiffness, mass, stop, preload, damping_ratio, contact_stiffness, contact_damping
):
    """Return dη/dt [1/s] of a reed at lift ξ and speed η under a gas force [N] (S25)."""
    scale = speed_scale(load, stiffness, mass, stop)
    pushed = (force - preload) / (mass * stop) - stiffness / mass * lift
    own = math.sqrt(stiffness / mass)
    free = pushed / scale - 2.0 * damping_ratio * own * speed
    seat = contact(-lift, -speed, contact_stiffness, contact_damping)
    return free + scale * (seat - contact(lift - 1.0, speed, contact_stiffness, contact_damping))


@kernel
def suction_lift_rate(suction_valve_speed, p_suction, p_discharge, force_area, stiffness, mass, stop):
    """Return dξ/dt [1/s] of the suction reed."""
    return suction_valve_speed * speed_scale(force_area * abs(p_discharge - p_suction), stiffness, mass, stop)


@kernel
def discharge_lift_rate(discharge_valve_speed, p_suction, p_discharge, force_area, stiffness, mass, stop):
    """Return dξ/dt [1/s] of the discharge reed."""
    return discharge_valve_speed * speed_scale(force_area * abs(p_discharge - p_suction), stiffness, mass, stop)


@kernel
def suction_speed_rate(
    suction_valve_lift,
    suction_valve_speed,
    p,
    p_suction,
    p_discharge,
    force_area,
    stiffness,
    mass,
    stop,
    preload,
    damping_ratio,
    contact_stiffness,
    contact_damping,
):
    """Return dη/dt [1/s] of the suction reed, which opens into the cylinder."""
    load = force_area * abs(p_discharge - p_suction)
    force = force_area * (p_suction - p)
    return reed_acceleration(
        suction_valve_lift,
        suction_valve_speed,
        force,
        load,
        stiffness,
        mass,
        stop,
        preload,
        damping_ratio,
        contact_stiffness,
        contact_damping,
    )


@kernel
def discharge_speed_rate(
    discharge_valve_lift,
    discharge_valve_speed,
    p,
    p_suction,
    p_discharge,
    force_area,
    stiffness,
    mass,
    stop,
    preload,
    damping_ratio,
    contact_stiffness,
    contact_damping,
):
    """Return dη/dt [1/s] of the discharge reed, which opens out of the cylinder."""
    load = force_area * abs(p_discharge - p_suction)
    force = force_area * (p - p_discharge)
    return reed_acceleration(
        discharge_valve_lift,
        discharge_valve_speed,
        force,
        load,
        stiffness,
        mass,
        stop,
        preload,
        damping_ratio,
        contact_stiffness,
        contact_damping,
    )


@kernel
def opened(lift, curtain):
    """Return the open share of a port under a reed at lift ξ; `curtain`: full curtain's area over the port's (S27)."""
    if lift <= 0.0:
        return 0.0
    a = curtain * lift
    return a / math.sqrt(1.0 + a * a)


@kernel
def suction_opening(suction_valve_lift, curtain):
    """Return the open share of the suction port."""
    return opened(suction_valve_lift, curtain)


@kernel
def discharge_opening(discharge_valve_lift, curtain):
    """Return the open share of the discharge port."""
    return opened(discharge_valve_lift, curtain)


KERNELS = {
    "suction": (suction_lift_rate, suction_speed_rate, suction_opening),
    "discharge": (discharge_lift_rate, discharge_speed_rate, discharge_opening),
}


def reed(parameters: Parameters, side: str) -> dict[str, float]:
    """Return the numbers of one reed behind its kernels' arguments [SI]."""
    own = {name: getattr(parameters, f"{side}_{name}") for name in ("stop", "mass", "stiffness", "preload")}
    area = getattr(parameters, f"{side}_port_area")
    return own | {
        "area": area,
        "curtain": getattr(parameters, f"{side}_perimeter") * own["stop"] / area,
        "force_area": parameters.force_coefficient * area,
        "damping_ratio": parameters.damping_ratio,
        "contact_stiffness": 1.0 / parameters.softness,
        "contact_damping": contact_damping(parameters.restitution),
    }


def build(parameters: Parameters, machine) -> list[FlowPath | ChamberState | Reading]:
    built: list[FlowPath | ChamberState | Reading] = []
    for side in SIDES:
        lift, speed, opening = KERNELS[side]
        values = reed(parameters, side)
        coefficient = parameters.flow_coefficient
        built.append(FlowPath(side, port_area, values, flow_coefficient=coefficient, opening=opening))
        built.append(ChamberState(f"{side}_valve_lift", lift, values))
        built.append(ChamberState(f"{side}_valve_speed", speed, values))
    return [*built, valve_losses()]


def check(parameters: Parameters, facts) -> list[Fault]:
    if "check_valves" in facts.effects:
        return [Fault("effects.reed_valves", "are simulated beside check_valves, the same valves twice (remove one)")]
    return []


EFFECT = Effect(
    name="reed_valves",
    title="reed valves with mass and spring between cylinder and both lines",
    equations=("M12", "M13", "S24", "S25", "S26", "S27"),
    source="Costagliola 1950; Hunt and Crossley 1975",
    parameters=Parameters,
    build=build,
    check=check,
    machines=(SLIDER_CRANK,),
)
