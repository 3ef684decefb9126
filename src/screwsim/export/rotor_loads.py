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
from screwsim.machine.profile_law import LaidCurves, laid_curves
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
from screwsim.machine.settings import MachineSettings, TwinScrew
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

    `low` is that before the suction port, behind which an expander's gas leaves; forces count from it.
    """

    laid: LaidCurves
    angle: Array  # [rad], on the rotors' axis
    pressure: Array
    low: float
    backwards: bool = False  # the rotors of an expander turn the other way

    def turned(self, angle: Array) -> Array:
        """Return angles of the male rotor [rad] after it has turned, in the machine's direction, by `angle`."""
        return -angle if self.backwards else angle

    def at(self, phi: Array) -> Array:
        """Return the pressure of chambers; before their birth that of suction, after their end the last value."""
        rotors = self.laid.rotors
        axis = np.minimum(phi, rotors.wrap)
        return np.where(phi < rotors.start, self.low, np.interp(axis, self.angle, self.pressure))

    def excess(self, phi: Array) -> Array:
        """Return the pressure of chambers above suction [Pa]."""
        return self.at(phi) - self.low


def pressures_of(machine: TwinScrew, result: Result) -> Pressures:
    """Return the pressures of a result that keeps its cycle, without the remainder of a chamber's last charge."""
    laid, (low, _), backwards = laid_curves(machine), line_pressures(machine, result), machine.expands
    angle, pressure = laid.on_rotors(np.radians(result.cycle["angle"]), backwards), np.array(result.cycle["pressure"])
    if backwards:
        angle, pressure = angle[::-1], pressure[::-1]
    return Pressures(laid, angle, expanded(low, laid.rotors.start, angle, pressure), low, backwards)


def line_pressures(machine: MachineSettings, result: Result) -> tuple[float, float]:
    """Return the mean pressures [Pa] at both ends of the rotors: those of a compressor's intake and outlet.

    They are those of the plenum there, behind a throttle, or in the line; an expander's inlet is the higher one.
    """
    inlet = _first_known(result, "suction_plenum_pressure", "intake_pressure", "suction_pressure")
    outlet = _first_known(result, "discharge_plenum_pressure", "discharge_pressure")
    return (outlet, inlet) if machine.expands else (inlet, outlet)


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
    phi = chambers_at(rotors, areas, pressures.turned(angle))
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
    turning = {name: -values for name, values in columns.items() if "torque" in name} if pressures.backwards else {}
    return angle, columns | turning


def _torques_by_virtual_work(pressures: Pressures, angle: Array) -> dict[str, Array]:
    """Return the torques [N m] of both rotors by virtual work (M144, M145), as a check of those from the surfaces."""
    rotors = pressures.laid.rotors
    pitch = rotors.pair.pitch
    first = math.ceil((rotors.start - pitch) / pitch)
    phi = pressures.turned(angle)[:, None] % pitch + pitch * np.arange(first, math.ceil(rotors.wrap / pitch) + 1)
    p = pressures.at(phi) - pressures.low
    male = rotors.male_slope(phi)
    both = rotors.volume_slope(phi)
    alive = (phi >= rotors.start) & (phi <= rotors.wrap)
    own, other = (np.where(alive, -p * slope, 0.0).sum(axis=1) for slope in (male, both - male))
    return {"male_torque_by_virtual_work": own, "female_torque_by_virtual_work": other / rotors.pair.k}
