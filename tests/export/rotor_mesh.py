"""A mesh of both rotors' surfaces, and the forces of pressures on it: another way to `machine.rotors.loads`."""

import numpy as np

from screwsim.export.rotor_loads import Pressures
from screwsim.machine.rotors.rotors import Rotors
from screwsim.machine.rotors.surface import Surface, chamber_angles

ALONG = 160  # pieces along the rotor


def positions(surface: Surface, rotors: Rotors, phi: float, z):
    """Return x, y [m] of the points (lobes, profile, z) in the machine's frame, with the rotor at `phi`."""
    lobe = np.arange(surface.lobes)[:, None, None] * surface.pitch
    turned = lobe + surface.turns * (phi - z / rotors.h)[None, None, :]
    c, s = np.cos(turned), np.sin(turned)
    x, y = surface.x[None, :, None], surface.y[None, :, None]
    return surface.centre + c * x - s * y, s * x + c * y


def areas(surface: Surface, x, y, z):
    """Return the outward vector areas [m²] of the pieces between points (lobes, profile, z)."""
    z = np.broadcast_to(z, x.shape)
    one = [a[:, 1:, 1:] - a[:, :-1, :-1] for a in (x, y, z)]
    two = [a[:, :-1, 1:] - a[:, 1:, :-1] for a in (x, y, z)]
    factor = 0.5 * surface.outward
    return (
        factor * (one[1] * two[2] - one[2] * two[1]),
        factor * (one[2] * two[0] - one[0] * two[2]),
        factor * (one[0] * two[1] - one[1] * two[0]),
    )


def centres(a):
    """Return the centres of the pieces between points (lobes, profile, z)."""
    return 0.25 * (a[:, 1:, 1:] + a[:, :-1, :-1] + a[:, :-1, 1:] + a[:, 1:, :-1])


def gas_loads(pressures: Pressures, surface: Surface, phi: float) -> dict[str, float]:
    """Return force [N], torque about the axis [N m], and moments about the suction end [N m] at one angle."""
    rotors = pressures.laid.rotors
    z = np.linspace(0.0, rotors.length, ALONG + 1)
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
        "moment_x": float((fx * middle - fz * rx).sum()),
        "moment_y": float((fy * middle - fz * ry).sum()),
    }


def end_loads(pressures: Pressures, surface: Surface, phi: float, shaft: float) -> dict[str, float]:
    """Return the axial forces [N] on both end faces outside of a shaft of diameter `shaft` [m], and their moments.

    Triangles from the axis to the pieces of the profile, less sectors of the shaft's circle.
    """
    rotors, found = pressures.laid.rotors, {"end_moment_x": 0.0, "end_moment_y": 0.0}
    for name, z, push in (("suction", 0.0, 1.0), ("discharge", rotors.length, -1.0)):
        x, y = (points[:, :, 0] for points in positions(surface, rotors, phi, np.array([z])))
        r = np.stack([x - surface.centre, y], -1)
        one, two = r[:, :-1], r[:, 1:]
        triangle = 0.5 * surface.outward * (one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0])
        around = np.angle((two[..., 0] + 1j * two[..., 1]) / (one[..., 0] + 1j * one[..., 1])) * surface.outward
        half = 0.5 * (one / np.linalg.norm(one, axis=-1)[..., None] + two / np.linalg.norm(two, axis=-1)[..., None])
        sector = 0.5 * (0.5 * shaft) ** 2 * around
        moment = triangle[..., None] * (one + two) / 3.0 - (sector * shaft / 3.0)[..., None] * half
        p = push * pressures.excess(chamber_angles(surface, rotors, phi, np.array([z])))[:, :, 0]
        found[f"{name}_end_force"] = float((p * (triangle - sector)).sum())
        for i, way in enumerate("xy"):
            found[f"end_moment_{way}"] -= float((p * moment[..., i]).sum())
    return found
