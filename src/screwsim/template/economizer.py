"""The economizer of a new refrigeration machine: where its port lies, how large it is, and what gas it adds."""

import math
from typing import NamedTuple

from screwsim.build import build_parts
from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError
from screwsim.scene import loads
from screwsim.template import sizes, texts
from screwsim.template.duty import Duty

BESIDE, SHORTEST = math.radians(5.0), math.radians(30.0)  # of the port: distance from others, length
# mean Mach number of the vapour in the port: wider ones let chambers push more gas back, narrower ones throttle more
# (docs/tools/economizer_port.py)
MACH = 0.4
CLOSED_IN = 1.3  # largest volume of the template's rotors over that at which the port closes, a lobe pitch later
APPROACH = 5.0  # [K] of the subcooled liquid to the vapour's saturation temperature: the effect's default
LEAST = 0.02  # vapour over suction gas for which a port is made, also where there is less
STEPS = 6  # each changes the ratio by less than half of the one before


class Vapour(NamedTuple):
    """An estimate of the vapour that an economizer gives: pressure [Pa], temperature [K], mass over suction gas."""

    p: float
    T: float
    ratio: float


def vapour_of(fluid: str, duty: Duty) -> Vapour:
    """Return the vapour at the pressure of a chamber as it leaves the port, after which none flows back (M102, M371).

    The chamber then holds suction gas and vapour, compressed without losses to the volume there.
    """
    leaves = duty.liquid - duty.subcooling
    h_c, ratio = constants.liquid_enthalpy(fluid, duty.p_d, leaves), 0.0
    p = T = 0.0
    for _ in range(STEPS):
        p = min(duty.p_s * CLOSED_IN**duty.k * (1.0 + ratio), duty.p_d)
        T = constants.saturation_temperature(fluid, p)
        cooled = h_c - constants.liquid_enthalpy(fluid, duty.p_d, min(T + APPROACH, leaves))
        ratio = max(cooled / (constants.vapour_enthalpy(fluid, p, T) - h_c), LEAST)
    return Vapour(p, T, ratio)


def more_power(fluid: str, duty: Duty) -> float:
    """Return an estimate of the power over that without economizer, whose vapour is compressed from its pressure."""
    vapour = vapour_of(fluid, duty)
    R, T = constants.gas_constant(fluid), duty.T_e + duty.more
    return 1.0 + vapour.ratio * sizes.isentropic_work(duty.k, R, T, duty.p_d / vapour.p) / duty.work


def entry(text: str, fluid: str, duty: Duty) -> str:
    """Return the lines of an economizer's port between suction and discharge, for a machine with the given text.

    Raise UsageError where a chamber is not closed long enough for one.
    """
    geometry = build_parts(loads(text)).geometry
    closed, ends = geometry.injection_angle + BESIDE, (geometry.discharge_opens or math.inf) - BESIDE
    shuts = min(closed + geometry.pitch, ends)
    first, last = (math.degrees(angle) for angle in (closed, shuts))
    if shuts - closed < SHORTEST:
        what = f"suction ends at {first - math.degrees(BESIDE):.0f} deg and discharge begins at"
        remedy = "choose a larger built-in volume ratio with --vi"
        raise UsageError(f"--economizer: {what} {math.degrees(ends + BESIDE):.0f} deg: no room for a port ({remedy})")
    values = {"opens": f"{math.ceil(first)} deg", "closes": f"{math.floor(last)} deg", "mach": f"{MACH:g}"}
    return texts.filled("economizer", {**values, "area": sizes.area(_area(fluid, duty), 2)})


def _area(fluid: str, duty: Duty) -> float:
    """Return the area [m²] in which the vapour flows at the mean Mach number `MACH`, by an ideal gas's density."""
    vapour, R = vapour_of(fluid, duty), constants.gas_constant(fluid)
    return vapour.ratio * duty.gas_flow / (MACH * vapour.p * math.sqrt(duty.k / (R * vapour.T)))


def refused_port(what: str) -> str:
    """Return why there can be no economizer, with a remedy among the command's options; empty for other faults."""
    place, _, why = what.partition(": ")
    remedy = "choose a --condition whose ends are farther apart, or no --economizer"
    return f"--economizer: {why.rpartition(' (')[0]} ({remedy})" if place.startswith("effects.economizer") else ""
