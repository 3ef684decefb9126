"""Forces on the rotors of a closed cycle by angle (`machine.rotors.loads`), and those on their bearings.

First come those of the gas on the flanks, for pressures above that before the suction port; then those of the gas on
the end faces and of the rotors' contact at the pitch line. The mapping of pressures to the surface is checked against
virtual work: the male torque agrees within 1.5 %, the female one within 2.5 % of the male's
(tests/export/test_loads.py).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.profile_law import LaidCurves
from screwsim.machine.rotors.loads import (
    NAMES,
    Diameters,
    bearing_forces,
    chambers_at,
    expanded,
    pressed_areas,
    rotor_loads,
    thick_shaft,
)
from screwsim.machine.rotors.pair import Array
from screwsim.outputs import Result

PITCH_POINTS = 48  # points of a pitch
Spans = tuple[float, float]
GAS = ("force_x", "force_y", "axial_force", "torque")  # columns of the gas on the flanks


class Supports(NamedTuple):
    """What holds male and female rotor.

    `spans` [m]: distances of their bearings outside of the end planes, suction first; `shafts` [m]: diameters of the
    shafts, which the gas on the end faces does not reach; `pushes` [N]: of balance pistons, towards the discharge end.
    `located` and `sized` tell of which rotor the distances and the shaft are stated, not assumed to be 0.
    """

    spans: tuple[Spans, Spans] = ((0.0, 0.0), (0.0, 0.0))
    shafts: Diameters = (0.0, 0.0)
    pushes: tuple[float, float] = (0.0, 0.0)
    located: tuple[bool, bool] = (False, False)
    sized: tuple[bool, bool] = (False, False)


BARE = Supports()


@dataclass(frozen=True, eq=False)
class Pressures:
    """Pressure [Pa] of a chamber over its angle φ, with the origin of `machine.rotors.rotors`.

    `low` is that before the suction port, from which forces count.
    """

    laid: LaidCurves
    angle: Array  # [rad], on the scene's axis
    pressure: Array
    low: float

    def at(self, phi: Array) -> Array:
        """Return the pressure of chambers; before their birth that of suction, after their end the last value."""
        rotors = self.laid.rotors
        axis = self.laid.born + np.minimum(phi, rotors.wrap) - rotors.start
        return np.where(phi < rotors.start, self.low, np.interp(axis, self.angle, self.pressure))

    def excess(self, phi: Array) -> Array:
        """Return the pressure of chambers above suction [Pa]."""
        return self.at(phi) - self.low


def pressures_of(laid: LaidCurves, result: Result) -> Pressures:
    """Return the pressures of a result that keeps its cycle, without the remainder of a chamber's last charge."""
    angle, low = np.radians(result.cycle["angle"]), intake_pressure(result)
    return Pressures(laid, angle, expanded(low, laid.born, angle, np.array(result.cycle["pressure"])), low)


def intake_pressure(result: Result) -> float:
    """Return the mean pressure [Pa] before the suction port: in its plenum, behind a throttle, or in the line."""
    return _first_known(result, "suction_plenum_pressure", "intake_pressure", "suction_pressure")


def outlet_pressure(result: Result) -> float:
    """Return the mean pressure [Pa] behind the discharge port: in its plenum, or in the line."""
    return _first_known(result, "discharge_plenum_pressure", "discharge_pressure")


def _first_known(result: Result, *names: str) -> float:
    known = (result.performance.get(name) for name in names)
    return float(next(each for each in known if each is not None))


def loads_of(pressures: Pressures, supports: Supports = BARE) -> tuple[Array, dict[str, Array]]:
    """Return the angle over one pitch of the male rotor [rad], and by name forces [N], torques [N m], bearing forces.

    Raise UsageError for a shaft that is not thinner than the roots.
    """
    rotors = pressures.laid.rotors
    angle = np.arange(PITCH_POINTS) * rotors.pair.pitch / PITCH_POINTS
    if thick := thick_shaft(rotors, supports.shafts):
        raise UsageError(f"--shafts: {thick}")
    areas = pressed_areas(rotors, supports.shafts)
    phi = chambers_at(rotors, areas, angle)
    found = rotor_loads(rotors, [of.at(phi) for of in areas], pressures.excess(phi))
    columns: dict[str, Array] = {}
    for name, spans in zip(NAMES, supports.spans, strict=True):
        own = found[name]
        columns |= {f"{name}_{key}": own[key] for key in GAS}
        by_flanks = bearing_forces(own, rotors.length, spans, "force", "moment")
        columns |= {f"{name}_{key}": values for key, values in by_flanks.items()}
    columns |= _torques_by_virtual_work(pressures, angle)
    for name, spans, push in zip(NAMES, supports.spans, supports.pushes, strict=True):
        own = found[name]
        shown = {key: own[key] for key in ("suction_end_force", "discharge_end_force")}
        shown |= {key: own[key] for key in ("contact_force_x", "contact_force_y", "contact_force_z")}
        shown["thrust_bearing"] = own["thrust"] + push
        carried = bearing_forces(own, rotors.length, spans)
        shown |= {key.replace("_bearing", "_bearing_total"): values for key, values in carried.items()}
        columns |= {f"{name}_{key}": values for key, values in shown.items()}
    columns["gas_torque"] = found["male"]["torque"] + found["male"]["contact_torque"]
    return angle, columns


def _torques_by_virtual_work(pressures: Pressures, angle: Array) -> dict[str, Array]:
    """Return the torques [N m] of both rotors by virtual work (M144, M145), as a check of those from the surfaces."""
    rotors = pressures.laid.rotors
    pitch = rotors.pair.pitch
    first = math.ceil((rotors.start - pitch) / pitch)
    phi = angle[:, None] + pitch * np.arange(first, math.ceil(rotors.wrap / pitch) + 1)
    p = pressures.at(phi) - pressures.low
    male = rotors.male_slope(phi)
    both = rotors.volume_slope(phi)
    alive = (phi >= rotors.start) & (phi <= rotors.wrap)
    own, other = (np.where(alive, -p * slope, 0.0).sum(axis=1) for slope in (male, both - male))
    return {"male_torque_by_virtual_work": own, "female_torque_by_virtual_work": other / rotors.pair.k}
