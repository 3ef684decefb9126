"""Families of rotors: proportions under a name, which a diameter makes rotors of (docs/reference/rotors.md).

Source: ours; the machines of configs/rotors are these at 160 mm. All lengths are shares of the male rotor's diameter.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Family:
    """A kind of profile with its lobes, angles [rad], length over diameter, lengths over diameter by their names."""

    kind: str
    male_lobes: int
    female_lobes: int
    wrap_angle: float
    length: float
    shares: Mapping[str, float]
    pressure_angle: float | None = None


_WRAP, _LENGTH = math.radians(300.0), 1.1
_SAME_SIZE = {"centre_distance": 0.8, "female_diameter": 1.0, "female_tip_radius": 0.03}
FAMILIES: dict[str, Family] = {
    "a": Family("circular", 4, 6, _WRAP, _LENGTH, _SAME_SIZE),
    "b": Family(
        "rack",
        4,
        6,
        _WRAP,
        _LENGTH,
        {**_SAME_SIZE, "male_tip_radius": 0.01, "flank_radius": 0.22, "root_radius": 0.03},
        math.radians(35.0),
    ),
    "c": Family(
        "rack",
        5,
        6,
        _WRAP,
        _LENGTH,
        {
            "centre_distance": 0.73,
            "female_diameter": 0.86,
            "male_tip_radius": 0.01,
            "female_tip_radius": 0.04,
            "flank_radius": 0.19,
            "root_radius": 0.03,
        },
        math.radians(32.0),
    ),
}
