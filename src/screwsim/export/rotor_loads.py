"""Forces on the rotors of a closed cycle: pressures integrated over their surfaces, by angle.

First come those of the gas on the flanks, for pressures above suction; then those of the gas on the end faces and of
the rotors' contact (`rotor_balance`). Gears, balance pistons and weights are not included. The mapping of pressures to
the surface is checked against virtual work: the male torque agrees within 1.5 %, the female one within 2.5 % of the
male's (tests/export/test_loads.py).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from screwsim.export.rotor_balance import check_shafts, contact_force, end_forces
from screwsim.export.rotor_surface import ALONG, Surface, areas, centres, chamber_angles, positions, surfaces
from screwsim.machine.profile_law import LaidCurves
from screwsim.machine.rotors.pair import Array
from screwsim.outputs import Result

NAMES = ("male", "female")
PITCH_POINTS = 48  # points of a pitch
EXPANDED_RATIO = 1.02  # over the suction pressure: from there the remainder of a chamber's last charge has expanded


@dataclass(frozen=True, eq=False)
class Pressures:
    """Pressure [Pa] of a chamber over its angle φ, with the origin of `machine.rotors.rotors`; `low` is suction's."""

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
    """Return the pressures of a result that keeps its cycle.

    A chamber is born with the remainder of its last charge in almost no volume, which presses on nothing: until its
    pressure has first fallen to that of suction, the suction pressure replaces it.
    """
    angle, pressure = np.radians(result.cycle["angle"]), np.array(result.cycle["pressure"])
    low = float(result.performance["suction_pressure"])
    down = np.flatnonzero((angle >= laid.born) & (pressure <= EXPANDED_RATIO * low))
    pressure[: int(down[0]) if len(down) else 0] = low
    return Pressures(laid, angle, pressure, low)


@dataclass(frozen=True, eq=False)
class Loads:
    """Columns over one pitch of the male rotor (`angle` [rad]): forces [N], torques [N m], bearing forces by name."""

    angle: Array
    columns: Mapping[str, Array]


def loads_of(
    pressures: Pressures, spans: tuple[float, float] = (0.0, 0.0), shafts: tuple[float, float] = (0.0, 0.0)
) -> Loads:
    """Return the loads over one pitch of the male rotor.

    `spans` [m] are the distances of the bearings outside of the end planes, suction first; `shafts` [m] the diameters
    of the shafts of male and female, which the gas on the end faces does not reach.
    """
    rotors = pressures.laid.rotors
    check_shafts(rotors, shafts)
    z = np.linspace(0.0, rotors.length, ALONG + 1)
    angle = np.arange(PITCH_POINTS) * rotors.pair.pitch / PITCH_POINTS
    columns: dict[str, Array] = {}
    both = surfaces(rotors)
    for name, surface in zip(NAMES, both, strict=True):
        rows = [_gas_loads_at(pressures, surface, float(phi), z) for phi in angle]
        found = {key: np.array([row[key] for row in rows]) for key in rows[0]}
        columns |= {f"{name}_{key}": values for key, values in found.items()}
        columns |= _bearings(name, found, rotors.length, spans)
    columns |= _torques_by_virtual_work(pressures, angle)
    moments = {key: value for key, value in columns.items() if "_moment_" in key}
    columns = {key: value for key, value in columns.items() if key not in moments}
    touching = contact_force(rotors, columns["female_torque"])
    for name, surface, shaft in zip(NAMES, both, shafts, strict=True):
        ends = [end_forces(surface, rotors, float(phi), 0.5 * shaft, pressures.excess) for phi in angle]
        columns |= _with_bearings(name, columns, moments, touching[name], ends, rotors.length, spans)
    columns["shaft_torque"] = columns["male_torque"] + touching["male"]["contact_torque"]
    return Loads(angle, columns)


def _with_bearings(
    name: str,
    gas: Mapping[str, Array],
    moments: Mapping[str, Array],
    touch: Mapping[str, Array],
    rows: Sequence[Mapping[str, float]],
    length: float,
    spans: tuple[float, float],
) -> dict[str, Array]:
    """Return the loads by the ends and the other rotor on a rotor, and the bearing forces [N] from all loads."""
    ends = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    found = {f"force_{way}": gas[f"{name}_force_{way}"] + touch[f"contact_force_{way}"] for way in "xy"}
    for way in "xy":
        own = moments[f"{name}_moment_{way}"]
        found[f"moment_{way}"] = own + ends[f"end_moment_{way}"] + touch[f"contact_moment_{way}"]
    columns = {f"{name}_{end}_end_force": ends[f"{end}_end_force"] for end in ("suction", "discharge")}
    columns |= {f"{name}_contact_force_{way}": touch[f"contact_force_{way}"] for way in "xyz"}
    pushed = columns[f"{name}_suction_end_force"] + columns[f"{name}_discharge_end_force"]
    columns[f"{name}_thrust_bearing"] = gas[f"{name}_axial_force"] + pushed + touch["contact_force_z"]
    carried = _bearings(name, found, length, spans)
    return columns | {key.replace("_bearing", "_bearing_total"): values for key, values in carried.items()}


def _gas_loads_at(pressures: Pressures, surface: Surface, phi: float, z: Array) -> dict[str, float]:
    """Return force [N], torque about the axis [N m], and moments about the suction end [N m] at one angle."""
    rotors = pressures.laid.rotors
    x, y = positions(surface, rotors, phi, z)
    ax, ay, az = areas(surface, x, y, z)
    middle = 0.5 * (z[1:] + z[:-1])
    p = pressures.excess(chamber_angles(surface, rotors, phi, middle))
    fx, fy, fz = -p * ax, -p * ay, -p * az
    rx, ry = centres(x) - surface.centre, centres(y)
    return {
        "force_x": float(fx.sum()),
        "force_y": float(fy.sum()),
        "axial_force": float(fz.sum()),
        "torque": float((rx * fy - ry * fx).sum()) * surface.outward,
        "moment_x": float((fx * middle - fz * rx).sum()),  # Σ z F_x minus the tilting moment of the axial forces
        "moment_y": float((fy * middle - fz * ry).sum()),
    }


def _bearings(name: str, found: Mapping[str, Array], length: float, spans: tuple[float, float]) -> dict[str, Array]:
    """Return the radial forces [N] on both bearings of a rotor, from the balance of moments."""
    columns = {}
    for way in "xy":
        force, moment = found[f"force_{way}"], found[f"moment_{way}"]
        far = (moment + force * spans[0]) / (length + sum(spans))
        columns[f"{name}_discharge_bearing_{way}"] = far
        columns[f"{name}_suction_bearing_{way}"] = force - far
    for end in ("suction", "discharge"):
        both = (columns[f"{name}_{end}_bearing_{way}"] for way in "xy")
        columns[f"{name}_{end}_bearing"] = np.hypot(*both)
    return columns


def _torques_by_virtual_work(pressures: Pressures, angle: Array) -> dict[str, Array]:
    """Return the torques [N m] of both rotors by virtual work (M144, M145), as a check of those from the surfaces."""
    rotors = pressures.laid.rotors
    pitch = rotors.pair.pitch
    first = math.ceil((rotors.start - pitch) / pitch)
    phi = angle[:, None] + pitch * np.arange(first, math.ceil(rotors.wrap / pitch) + 1)
    p = pressures.at(phi) - pressures.low
    male = rotors.sections.male_slope(phi, rotors.wrap, rotors.length)
    both = rotors.volume_slope(phi)
    alive = (phi >= rotors.start) & (phi <= rotors.wrap)
    own, other = (np.where(alive, -p * slope, 0.0).sum(axis=1) for slope in (male, both - male))
    return {"male_torque_by_virtual_work": own, "female_torque_by_virtual_work": other / rotors.pair.k}
