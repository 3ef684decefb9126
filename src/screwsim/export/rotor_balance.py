"""Loads on a rotor beside the gas on its flanks: gas on its end faces, and the other rotor at the pitch line.

End faces: the chamber that bounds a piece of the profile presses on the sector from that piece inwards to the shaft;
the area of the shaft is at suction pressure. So within a lobe the pressures of two neighbouring chambers meet near its
tip (half of each, which equals the total of a pressure that falls evenly across the lobe).

Contact: the male rotor drives. It balances the gas torque on the female rotor at the pitch point, along the common
normal of the flanks there, without friction; on helical flanks a normal force of torque M has the axial component M
k/h. It is assumed to be distributed evenly over the length, so that its resultant is at the middle.

Source: statics of helical gears; pressures on end faces as in Stošić, Smith, Kovačević, Screw Compressors, 2005, ch. 4.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from screwsim.export.rotor_surface import Surface, chamber_angles, positions
from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors.pair import Array, Chain
from screwsim.machine.rotors.rotors import Rotors

STEEPEST_NORMAL = 30.0  # tan α of the normal: more than 88 deg from the pitch circle's tangent


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
    for name, shaft, root in zip(("male", "female"), shafts, _roots(rotors), strict=True):
        if 0.5 * shaft >= root:
            raise UsageError(
                f"--shafts: {1e3 * shaft:.4g} mm is not less than {2e3 * root:.4g} mm, the {name} rotor's diameter "
                "at the roots (write the shaft diameter at the end face)"
            )


def _roots(rotors: Rotors) -> tuple[float, float]:
    """Return the smallest radii [m] of male and female rotor."""
    return float(rotors.chain.male_radii.min()), float(rotors.chain.female_radii(rotors.pair).min())


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
