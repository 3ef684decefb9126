"""Areas on which a chamber presses on both rotors, by its angle, and the forces of all chambers (M158).

What a chamber bounds in the section at a distance z from the suction end depends on φ − z/h alone, h = L/τ. So its
pieces of the profile are added up over one pitch of sections, and the areas of the whole flanks are integrals over a
wrap angle of that. As a screw motion does not change a flank, its axial area follows from the torque of its pieces.

End faces: the chamber that bounds a piece of the profile presses on the sector from that piece inwards to the shaft;
the area of the shaft is at suction pressure. So within a lobe the pressures of two neighbouring chambers meet near its
tip (half of each, which equals the total of a pressure that falls evenly across the lobe).

Angles [rad] have the origin of `machine.rotors.rotors`, z runs from the suction end, moments are about that end. Gears,
balance pistons and weights are not included. Integrating over a mesh of both surfaces, and virtual work, give the same
(tests/export/test_rotor_balance.py, test_loads.py). Units SI.

Source: pressures on flanks and end faces as in Stošić, Smith, Kovačević, Screw Compressors, 2005, ch. 4; ours.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from screwsim.machine.rotors.contact import contact_force
from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.rotors import MOST_CACHED, Rotors
from screwsim.machine.rotors.surface import Surface, section_ages, surfaces, turns_of

NAMES = ("male", "female")
SECTIONS = 240  # per pitch
EXPANDED_RATIO = 1.02  # over the suction pressure: from there the remainder of a chamber's last charge has expanded
Diameters = tuple[float, float]  # [m] of the shafts of male and female, which the gas on the end faces does not reach


@dataclass(frozen=True, eq=False)
class PressedAreas:
    """What one chamber's unit of pressure makes of one rotor, at evenly spaced angles of the chamber; 0 beyond them.

    `columns`: force_x, force_y, axial_force [m²] of the flanks, their torque and moment_x, moment_y [m³] (Σ z F less
    what axial forces tilt); suction_end_force, discharge_end_force [m²], end_moment_x, end_moment_y [m³].
    """

    angle: Array
    columns: Mapping[str, Array]

    def at(self, phi: Array) -> dict[str, Array]:
        """Return the columns at angles `phi` of chambers."""
        return {name: np.interp(phi, self.angle, values, left=0.0, right=0.0) for name, values in self.columns.items()}


@lru_cache(maxsize=MOST_CACHED)
def pressed_areas(rotors: Rotors, shafts: Diameters) -> tuple[PressedAreas, PressedAreas]:
    """Return the areas of male and female rotor, with shafts of those diameters [m]."""
    male, female = (
        _pressed(rotors, surface, 0.5 * shaft) for surface, shaft in zip(surfaces(rotors), shafts, strict=True)
    )
    return male, female


def _pressed(rotors: Rotors, surface: Surface, shaft: float) -> PressedAreas:
    step, h, wrap = rotors.pair.pitch / SECTIONS, rotors.h, rotors.wrap
    ages, sums = _sums_over_pieces(rotors, surface, shaft)
    angle = np.arange(ages[0], ages[-1] + wrap + step, step)

    def at(values: Array, phi: Array) -> Array:
        return np.interp(phi, ages, values, left=0.0, right=0.0)

    def along(values: Array) -> Array:
        """Return the integral over the length, of values that are straight between the sections."""
        whole = np.concatenate([[0.0], np.cumsum(0.5 * step * (values[1:] + values[:-1]))])

        def up_to(phi: Array) -> Array:
            i = np.clip(np.floor((phi - ages[0]) / step).astype(int), 0, len(ages) - 1)
            return whole[i] + 0.5 * (np.minimum(phi, ages[-1]) - ages[i]) * (values[i] + at(values, phi))

        return h * (up_to(angle) - up_to(np.maximum(angle - wrap, ages[0])))

    tilt = surface.turns / h  # axial force of a piece over its torque, by screw motion
    columns = {f"force_{way}": along(sums[f"force_{way}"]) for way in "xy"}
    torque = along(sums["torque"])
    columns |= {"axial_force": tilt * torque, "torque": surface.outward * torque}
    for way in "xy":
        force = sums[f"force_{way}"]
        from_suction_end = h * (angle * along(force) - along(ages * force))  # Σ z F, as z = h (φ − age)
        columns[f"moment_{way}"] = from_suction_end - tilt * along(sums[f"place_{way}"])
    columns |= {"suction_end_force": at(sums["end"], angle), "discharge_end_force": -at(sums["end"], angle - wrap)}
    columns |= {
        f"end_moment_{way}": at(sums[f"end_{way}"], angle - wrap) - at(sums[f"end_{way}"], angle) for way in "xy"
    }
    return PressedAreas(angle, columns)


def _sums_over_pieces(rotors: Rotors, surface: Surface, shaft: float) -> tuple[Array, dict[str, Array]]:
    """Return the angle of a chamber in a section, and by it the sums over the pieces of the profile that bound it.

    force_x, force_y: components of the force [m] by unit of pressure and length; torque [m²]; place_x, place_y: the
    torque times the place of the piece [m³]; end: area of the sectors [m²]; end_x, end_y: their moments [m³].
    """
    step = rotors.pair.pitch / SECTIONS
    phi = step * np.arange(SECTIONS)
    number = np.rint(section_ages(surface, rotors, phi) / step).astype(int)
    first = int(number.min()) - 1  # nothing presses there, nor at the last
    count = int(number.max()) - first + 2
    c, s = turns_of(surface, phi)
    x1, x2, y1, y2 = surface.x[:-1], surface.x[1:], surface.y[:-1], surface.y[1:]
    torque = 0.5 * surface.outward * ((x2**2 + y2**2) - (x1**2 + y1**2))
    end, end_x, end_y = sectors(surface, shaft)
    turning = {  # vectors in the rotor's frame
        "force": (surface.outward * (y1 - y2), surface.outward * (x2 - x1)),
        "place": (0.5 * torque * (x1 + x2), 0.5 * torque * (y1 + y2)),
        "end": (end_x, end_y),
    }
    pieces = {name: values[None, :, None] + 0.0 * c for name, values in (("torque", torque), ("end", end))}
    for name, (x, y) in turning.items():
        x, y = x[None, :, None], y[None, :, None]
        pieces |= {f"{name}_x": c * x - s * y, f"{name}_y": s * x + c * y}
    at = (number - first).ravel()
    return step * np.arange(first, first + count), {
        name: np.bincount(at, values.ravel(), count) for name, values in pieces.items()
    }


def sectors(surface: Surface, shaft: float) -> tuple[Array, Array, Array]:
    """Return areas [m²] and first moments [m³] of an end face's sectors below pieces, less a shaft's radius [m].

    In the rotor's frame, of the pieces of one pitch of the profile.
    """
    x1, x2, y1, y2 = surface.x[:-1], surface.x[1:], surface.y[:-1], surface.y[1:]
    whole = 0.5 * surface.outward * (x1 * y2 - x2 * y1)
    length1, length2 = np.hypot(x1, y1), np.hypot(x2, y2)
    turned = surface.outward * np.arctan2(x1 * y2 - x2 * y1, x1 * x2 + y1 * y2)
    cut = shaft**3 / 3.0 * surface.outward
    return (
        whole - 0.5 * shaft**2 * turned,
        whole * (x1 + x2) / 3.0 - cut * (y2 / length2 - y1 / length1),
        whole * (y1 + y2) / 3.0 + cut * (x2 / length2 - x1 / length1),
    )


def thick_shaft(rotors: Rotors, shafts: Diameters) -> str:
    """Return the fault of a shaft [m], of male or female, that is not thinner than its rotor's roots; empty if none."""
    roots = rotors.chain.male_radii.min(), rotors.chain.female_radii(rotors.pair).min()
    for name, shaft, root in zip(NAMES, shafts, roots, strict=True):
        if 0.5 * shaft >= root:
            return (
                f"{1e3 * shaft:.4g} mm is not less than {2e3 * root:.4g} mm, the {name} rotor's diameter "
                "at the roots (write the shaft diameter at the end face)"
            )
    return ""


def chambers_at(rotors: Rotors, areas: Sequence[PressedAreas], angle: Array) -> Array:
    """Return the angles [rad] of all chambers (columns) that press, with the male rotor at each of `angle` (rows)."""
    pitch = rotors.pair.pitch
    first = math.floor(min(of.angle[0] for of in areas) / pitch) - 1
    return angle[:, None] + pitch * np.arange(first, math.ceil(max(of.angle[-1] for of in areas) / pitch) + 1)


def rotor_loads(rotors: Rotors, areas: Sequence[Mapping[str, Array]], excess: Array) -> dict[str, dict[str, Array]]:
    """Return what gas and contact load each rotor with, by angle: forces [N], torque and moments [N m] (M158).

    `areas` are those of male and female (`PressedAreas.at`), `excess` [Pa] the pressures of all chambers (columns) by
    angle (rows) above that before the suction port. Of each rotor: the columns of the areas, what `contact_force`
    returns, and total_x, total_y, thrust (positive towards the discharge end), total_moment_x and total_moment_y.
    """
    gas = [{name: (values * excess).sum(axis=-1) for name, values in of.items()} for of in areas]
    touching = contact_force(rotors, gas[1]["torque"])
    return {name: _with_totals(own | touching[name]) for name, own in zip(NAMES, gas, strict=True)}


def _with_totals(loads: dict[str, Array]) -> dict[str, Array]:
    ends = loads["suction_end_force"] + loads["discharge_end_force"]
    totals = {"thrust": loads["axial_force"] + ends + loads["contact_force_z"]}
    for way in "xy":
        totals[f"total_{way}"] = loads[f"force_{way}"] + loads[f"contact_force_{way}"]
        moments = loads[f"moment_{way}"] + loads[f"end_moment_{way}"]
        totals[f"total_moment_{way}"] = moments + loads[f"contact_moment_{way}"]
    return loads | totals


def bearing_forces(
    own: Mapping[str, Array], length: float, spans: Sequence[float], force: str = "total", moment: str = "total_moment"
) -> dict[str, Array]:
    """Return the radial forces [N] on both bearings of a rotor, from the balance of moments about its suction end.

    `own` has its loads (`rotor_loads`), of which `force` and `moment` [N m] begin the names; `spans` [m] are the
    distances of the bearings beyond its ends, suction first (M480). Components are …_bearing_x and …_bearing_y.
    """
    columns = {}
    for way in "xy":
        far = (own[f"{moment}_{way}"] + own[f"{force}_{way}"] * spans[0]) / (length + sum(spans))
        columns[f"discharge_bearing_{way}"] = far
        columns[f"suction_bearing_{way}"] = own[f"{force}_{way}"] - far
    for end in ("suction", "discharge"):
        columns[f"{end}_bearing"] = np.hypot(*(columns[f"{end}_bearing_{way}"] for way in "xy"))
    return columns


def expanded(low: float, born: float, angle: Array, pressure: Array) -> Array:
    """Return the pressure [Pa] of a chamber over its angle without the remainder of its last charge.

    A chamber is born with it, at the angle `born`, in almost no volume, which presses on nothing: until its pressure
    has first fallen to that before the suction port, `low`, that replaces it. Angles that fall are those of an
    expander, whose last remainder is squeezed there.
    """
    if angle[0] > angle[-1]:
        return expanded(low, born, angle[::-1], pressure[::-1])[::-1]
    down = np.flatnonzero((angle >= born) & (pressure <= EXPANDED_RATIO * low))
    return np.where(np.arange(len(pressure)) < (down[0] if len(down) else 0), low, pressure)
