"""Forces on the rotors of a closed cycle: pressures integrated over their surfaces, by angle.

First come those of the gas on the flanks, for pressures above that before the suction port; then those of the gas on
the end faces and of the rotors' contact at the pitch line. Gears, balance pistons and weights are not included. The
mapping of pressures to the surface is checked against virtual work: the male torque agrees within 1.5 %, the female one
within 2.5 % of the male's (tests/export/test_loads.py).

End faces: the chamber that bounds a piece of the profile presses on the sector from that piece inwards to the shaft;
the area of the shaft is at suction pressure. So within a lobe the pressures of two neighbouring chambers meet near its
tip (half of each, which equals the total of a pressure that falls evenly across the lobe).

Contact: the male rotor drives. It balances the gas torque on the female rotor at the pitch point, along the common
normal of the flanks there, without friction; on helical flanks a normal force of torque M has the axial component M
k/h. It is assumed to be distributed evenly over the length, so that its resultant is at the middle.

Source: statics of helical gears; pressures on end faces as in Stošić, Smith, Kovačević, Screw Compressors, 2005, ch. 4.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from screwsim.export.rotor_surface import ALONG, Surface, areas, centres, chamber_angles, positions, surfaces
from screwsim.inputs.faults import UsageError
from screwsim.machine.profile_law import LaidCurves
from screwsim.machine.rotors.pair import Array, Chain
from screwsim.machine.rotors.rotors import Rotors
from screwsim.outputs import Result

NAMES = ("male", "female")
PITCH_POINTS = 48  # points of a pitch
EXPANDED_RATIO = 1.02  # over the suction pressure: from there the remainder of a chamber's last charge has expanded
STEEPEST_NORMAL = 30.0  # tan α of the normal: more than 88 deg from the pitch circle's tangent


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
    """Return the pressures of a result that keeps its cycle.

    A chamber is born with the remainder of its last charge in almost no volume, which presses on nothing: until its
    pressure has first fallen to that of suction, the suction pressure replaces it.
    """
    angle, pressure = np.radians(result.cycle["angle"]), np.array(result.cycle["pressure"])
    low = intake_pressure(result)
    down = np.flatnonzero((angle >= laid.born) & (pressure <= EXPANDED_RATIO * low))
    pressure[: int(down[0]) if len(down) else 0] = low
    return Pressures(laid, angle, pressure, low)


def intake_pressure(result: Result) -> float:
    """Return the mean pressure [Pa] before the suction port: in its plenum, behind a throttle, or in the line."""
    found = result.performance
    known = (found.get(name) for name in ("suction_plenum_pressure", "intake_pressure", "suction_pressure"))
    return float(next(each for each in known if each is not None))


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
    male = rotors.male_slope(phi)
    both = rotors.volume_slope(phi)
    alive = (phi >= rotors.start) & (phi <= rotors.wrap)
    own, other = (np.where(alive, -p * slope, 0.0).sum(axis=1) for slope in (male, both - male))
    return {"male_torque_by_virtual_work": own, "female_torque_by_virtual_work": other / rotors.pair.k}


@dataclass(frozen=True, eq=False)
class EndFace:
    """Areas [m²] and first moments [m³] about the rotor's axis of the sectors of an end face (lobes, profile)."""

    area: Array
    x: Array
    y: Array


def end_face(surface: Surface, rotors: Rotors, phi: float, z: float, shaft: float = 0.0) -> EndFace:
    """Return an end face's sectors at `z` [m], without a shaft of radius `shaft` [m], with the rotor at `phi`."""
    x, y = (points[:, :, 0] for points in positions(surface, rotors, phi, np.array([z])))
    x = x - surface.centre
    x1, x2, y1, y2 = x[:, :-1], x[:, 1:], y[:, :-1], y[:, 1:]
    whole = 0.5 * surface.outward * (x1 * y2 - x2 * y1)
    length1, length2 = np.hypot(x1, y1), np.hypot(x2, y2)
    turned = surface.outward * np.arctan2(x1 * y2 - x2 * y1, x1 * x2 + y1 * y2)
    cut = shaft**3 / 3.0 * surface.outward
    return EndFace(
        whole - 0.5 * shaft**2 * turned,
        whole * (x1 + x2) / 3.0 - cut * (y2 / length2 - y1 / length1),
        whole * (y1 + y2) / 3.0 + cut * (x2 / length2 - x1 / length1),
    )


def end_forces(
    surface: Surface, rotors: Rotors, phi: float, shaft: float, excess: Callable[[Array], Array]
) -> dict[str, float]:
    """Return the axial forces [N] of the gas on both ends of a rotor at one angle, and their moments [N m].

    `excess(phi)` is the pressure above suction [Pa] of chambers at φ [rad]. Moments are defined as for the flanks.
    """
    forces, moment_x, moment_y = [], 0.0, 0.0
    for z, push in ((0.0, 1.0), (rotors.length, -1.0)):
        sectors = end_face(surface, rotors, phi, z, shaft)
        p = push * excess(chamber_angles(surface, rotors, phi, np.array([z])))[:, :, 0]
        forces.append(float((p * sectors.area).sum()))
        moment_x -= float((p * sectors.x).sum())
        moment_y -= float((p * sectors.y).sum())
    return {
        "suction_end_force": forces[0],
        "discharge_end_force": forces[1],
        "end_moment_x": moment_x,
        "end_moment_y": moment_y,
    }


def check_shafts(rotors: Rotors, shafts: tuple[float, float]) -> None:
    """Raise UsageError if a shaft's diameter [m], of male or female, is not less than that of its rotor's roots."""
    roots = rotors.chain.male_radii.min(), rotors.chain.female_radii(rotors.pair).min()
    for name, shaft, root in zip(NAMES, shafts, roots, strict=True):
        if 0.5 * shaft >= root:
            raise UsageError(
                f"--shafts: {1e3 * shaft:.4g} mm is not less than {2e3 * root:.4g} mm, the {name} rotor's diameter "
                "at the roots (write the shaft diameter at the end face)"
            )


def slope_at_pitch(rotors: Rotors, leading: bool) -> float:
    """Return tan α of the flanks' common normal at the pitch circle: its component towards the axes over the other.

    It is that of the male's leading flank, which drives, or of the trailing one. Raise UsageError where the flank lies
    along the pitch circle, and so cannot transmit a torque.
    """
    chain, radius = rotors.chain, rotors.pair.r1
    points = np.arange(chain.edges[0], chain.tip + 1) if leading else np.arange(chain.edges[1], chain.tip - 1, -1)
    beyond = np.flatnonzero(chain.male_radii[points] > radius * (1.0 + 1e-9))
    i = max(int(beyond[0]), 1) if len(beyond) else len(points) - 1
    return _tangent(chain, int(points[i - 1]), int(points[i]))


def _tangent(chain: Chain, one: int, two: int) -> float:
    """Return |normal in x| over |normal in y| of the male flank between two contact points, when in contact."""
    x, y = chain.male
    angle = -0.5 * (chain.psi[one] + chain.psi[two])  # from the rotor's frame
    dx, dy = x[two] - x[one], y[two] - y[one]
    along, across = np.cos(angle) * dx - np.sin(angle) * dy, np.sin(angle) * dx + np.cos(angle) * dy
    if abs(across) > STEEPEST_NORMAL * abs(along):
        raise UsageError("the flanks of this profile lie along the pitch circle, so they transmit no torque there")
    return float(abs(across / along))


def contact_force(rotors: Rotors, torque: Array) -> dict[str, dict[str, Array]]:
    """Return the contact's force [N] on each rotor, its torque about the axis, and its moments [N m], by angle.

    `torque` [N m] holds the female against the gas, as `female_torque` does; its sign decides which flank is in
    contact.
    """
    pair = rotors.pair
    flank = np.where(torque > 0.0, slope_at_pitch(rotors, True), slope_at_pitch(rotors, False))
    along = torque / pair.r2
    radial, axial = np.abs(along) * flank, torque * pair.k / rotors.h
    found = {}
    for name, sign, arm in (("male", 1.0, pair.r1), ("female", -1.0, -pair.r2)):
        fx, fy, fz = -sign * radial, sign * along, -sign * axial
        found[name] = {
            "contact_force_x": fx,
            "contact_force_y": fy,
            "contact_force_z": fz,
            "contact_torque": arm * fy,
            "contact_moment_x": 0.5 * rotors.length * fx - fz * arm,
            "contact_moment_y": 0.5 * rotors.length * fy,
        }
    return found
