"""The contact of both rotors at the pitch line: what the male rotor must push the female with, and what that loads.

The male rotor drives. It balances the gas torque on the female rotor at the pitch point, along the common normal of the
flanks there, without friction; on helical flanks a normal force of torque M has the axial component M k/h. It is
assumed to be distributed evenly over the length, so that its resultant is at the middle. Units SI.

Source: statics of helical gears.
"""

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors.pair import Array, Chain
from screwsim.machine.rotors.rotors import Rotors

STEEPEST_NORMAL = 30.0  # tan α of the normal: more than 88 deg from the pitch circle's tangent


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
