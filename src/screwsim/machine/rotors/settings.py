"""The settings of a rotor profile in a scene (typed, SI units), and families of rotors.

A family is a named set of proportions, as shares of the male rotor's diameter, from which a diameter makes rotors
(docs/reference/rotors.md). Source: ours; the machines of configs/rotors are these at 160 mm.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields

from screwsim.inputs.declare import DerivedWord, choice, file, number, optional, quantity
from screwsim.inputs.faults import Fault

CIRCULAR, RACK, POINTS = "circular", "rack", "points"  # kinds of profiles
_NEEDS = {
    CIRCULAR: ("female_tip_radius",),
    RACK: ("male_tip_radius", "female_tip_radius", "flank_radius", "pressure_angle", "root_radius"),
    POINTS: ("file",),
}
_READS = {**_NEEDS, POINTS: ("file", "curve", "tolerance", "smoothing")}


@dataclass(frozen=True)
class Family:
    """A kind of profile with its lobes, other lengths over diameter by name, angles [rad], and length over diameter."""

    kind: str
    male_lobes: int
    female_lobes: int
    shares: Mapping[str, float]
    pressure_angle: float | None = None
    wrap_angle: float = math.radians(300.0)
    length: float = 1.1


_SAME_SIZE = {"centre_distance": 0.8, "female_diameter": 1.0, "female_tip_radius": 0.03}
FAMILIES: dict[str, Family] = {
    "a": Family("circular", 4, 6, _SAME_SIZE),
    "b": Family(
        "rack",
        4,
        6,
        {**_SAME_SIZE, "male_tip_radius": 0.01, "flank_radius": 0.22, "root_radius": 0.03},
        math.radians(35.0),
    ),
    "c": Family(
        "rack",
        5,
        6,
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


@dataclass(frozen=True)
class Profile:
    """A profile of a rotor pair; the male outer diameter and the lobes are the machine's."""

    family: str | None = choice(
        "named rotors (docs/reference/rotors.md), from which kind, lobes, wrap and, with rotor_diameter, all lengths "
        "follow",
        tuple(FAMILIES),
        None,
    )
    kind: str = choice(
        "circular: symmetric, arcs about the pitch point; rack: asymmetric, leading flank from a rack; points: a file",
        (CIRCULAR, RACK, POINTS),
        DerivedWord(RACK),
    )
    centre_distance: float = quantity("length", "distance of the rotors' axes", None, gt=0.0, otherwise=("family",))
    female_diameter: float = quantity(
        "length", "outer diameter of the female rotor", None, gt=0.0, otherwise=("family",)
    )
    wrap_angle: float = quantity(
        "angle",
        "angle by which the male rotor is twisted over its length (overrides that of a family)",
        None,
        gt=0.0,
        otherwise=("family",),
    )
    male_tip_radius: float | None = optional("length", "r3: tip of the male lobe (kind: rack)")
    female_tip_radius: float | None = optional("length", "r4: tip of the female lobe (circular, rack)")
    flank_radius: float | None = optional("length", "rho: arc of the rack at the male tip (kind: rack)")
    pressure_angle: float | None = optional(
        "angle", "alpha: between the rack's straight line and its height (kind: rack)"
    )
    root_radius: float | None = optional("length", "r5: arc of the rack at its root (kind: rack)")
    file: str | None = file("CSV with columns x_mm, y_mm of one lobe, from root to root (kind: points)")
    curve: str = choice("what the points describe: the male lobe, or the rack", ("male", "rack"), "male")
    tolerance: float = quantity(
        "length",
        "largest distance between the faired curve and measured points (3 to 5 times their noise)",
        0.0,
        ge=0.0,
    )
    smoothing: float = quantity("length", "length over which the tangent of the points is averaged", 0.0, ge=0.0)

    @property
    def measured(self) -> bool:
        """Whether the profile is given as points of a file."""
        return self.kind == POINTS


@dataclass(frozen=True)
class SlideValve:
    """A slide valve in the cusp of the bores, stated by its geometry (law: profile)."""

    position: float = number("x: 0 is full load, 1 the end of the travel", 0.0, ge=0.0, le=1.0)
    travel: float = quantity("length", "travel of the slide from full load to its end", gt=0.0)
    length: float | None = optional(
        "length",
        "length from the end at the stop to the edge of the radial port at the cusp (default: starts at the rotors' "
        "inlet end)",
    )
    male_span: float = quantity("angle", "angle of the male bore that the slide forms, counted from the cusp", gt=0.0)
    female_span: float = quantity(
        "angle", "angle of the female bore that the slide forms, counted from the cusp", gt=0.0
    )


def check_settings(profile: Profile) -> list[Fault]:
    """Return faults of the parameters that a kind of profile needs and lacks."""
    return [
        Fault(f"machine.profile.{name}", f"is missing (kind: {profile.kind} needs it)")
        for name in _NEEDS[profile.kind]
        if getattr(profile, name) is None
    ]


def unused_parameters(profile: Profile) -> Iterator[tuple[str, str]]:
    """Yield (path, what) of each stated parameter that this kind of profile does not use."""
    defaults = {each.name: each.default for each in fields(profile)}
    for name in dict.fromkeys(name for names in _READS.values() for name in names):
        value = getattr(profile, name)
        if name not in _READS[profile.kind] and value not in (None, defaults[name]):
            kinds = " and ".join(kind for kind, names in _READS.items() if name in names)
            yield f"machine.profile.{name}", f"applies only to kind: {kinds}, and kind: {profile.kind} does not read it"
