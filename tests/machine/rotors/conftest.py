"""The three reference pairs of docs/reference/rotors.md: (a) symmetric 4/6, (b) asymmetric 4/6, (c) asymmetric 5/6."""

import math

import pytest

from screwsim.machine.rotors.rotors import Rotors, make_rotors
from screwsim.machine.rotors.settings import Profile

MM, DEG = 1e-3, math.pi / 180.0


def profile(kind: str, centre: float, female: float, **radii: float) -> Profile:
    """Return a profile with lengths in mm."""
    angle = radii.pop("pressure_angle", None)
    lengths = {name: value * MM for name, value in radii.items()}
    return Profile(
        kind=kind,
        centre_distance=centre * MM,
        female_diameter=female * MM,
        wrap_angle=300.0 * DEG,
        pressure_angle=None if angle is None else angle * DEG,
        **lengths,
    )


B = {"male_tip_radius": 1.0, "female_tip_radius": 3.0, "flank_radius": 22.0, "pressure_angle": 35.0, "root_radius": 3.0}
C = {"male_tip_radius": 1.0, "female_tip_radius": 4.0, "flank_radius": 19.0, "pressure_angle": 32.0, "root_radius": 3.0}
PROFILES = {
    "a": (profile("circular", 80.0, 100.0, female_tip_radius=3.0), 4, 6),
    "b": (profile("rack", 80.0, 100.0, **B), 4, 6),
    "c": (profile("rack", 73.0, 86.0, **C), 5, 6),
}


@pytest.fixture(scope="session")
def pairs() -> dict[str, Rotors]:
    """Return the three pairs, D1 = 100 mm, L/D = 1.1, wrap 300°."""
    return {name: make_rotors(*case, 100.0 * MM, 110.0 * MM) for name, case in PROFILES.items()}


@pytest.fixture(scope="session")
def long_pairs() -> dict[str, Rotors]:
    """Return the three pairs with L/D = 1.65."""
    return {name: make_rotors(*case, 100.0 * MM, 165.0 * MM) for name, case in PROFILES.items()}
