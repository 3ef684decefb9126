"""What a scene leaves out that scenes of its kind of machine name: its leaks first, in one line each.

A machine with half its leaks has efficiencies that no machine has, and nothing of its figures shows it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from screwsim.effects import catalogue
from screwsim.machine.kinds import kind_of
from screwsim.machine.protocol import CYLINDER, ROTORS
from screwsim.scene.types import Scene

LEAKS = {
    ROTORS: ("tip_leakage", "interlobe_leakage", "blow_hole", "end_face_leakage", "shaft_leakage"),
    CYLINDER: ("ring_leakage",),
}
OTHERS = {  # each by its names, of which one is enough
    ROTORS: (
        ("oil_heat", "droplets"),
        ("hydromechanical",),
        ("mechanical", "bearings"),
        ("suction_line",),
        ("separator",),
        ("motor",),
    ),
    CYLINDER: (("cylinder_heat", "wall_heat"), ("mechanical", "bearings")),
}
OF_OIL = {"oil_heat", "hydromechanical", "separator"}  # a dry machine has none


def what_is_left_out(scene: Scene) -> list[str]:
    """Return in a line each which leaks, and how many effects, a scene leaves out."""
    return [line for line in (leaks_told(scene), left_out_told(scene)) if line]


def leaks_told(scene: Scene) -> str:
    """Return which of a machine's leaks are simulated, where not all of them are; empty where they are."""
    kind = kind_of(scene.machine)
    leaks = next((names for offer, names in LEAKS.items() if offer in kind.offers), ())
    there, lacking = _parted(scene, leaks)
    if not lacking:
        return ""
    only = f"{_listed([_short(name) for name in there])} only" if there else "none"
    return f"leaks simulated: {only}; typical scenes name {_listed(lacking)}{', too' if there else ''}"


def left_out_told(scene: Scene) -> str:
    """Return in one line what is not simulated: how many effects, and those that typical scenes name."""
    kind = kind_of(scene.machine)
    left = [name for name, effect in catalogue().items() if name not in scene.effects and effect.fits(kind)]
    if not left:
        return ""
    usual = list(_usual(scene))
    among = f", among them {_listed(usual)}, which typical scenes name" if usual else ""
    many = f"{len(left)} effects" if len(left) > 1 else "1 effect"
    return f"not simulated: {many} of a {scene.machine.kind}{among} (screwsim explain says what each is)"


def _usual(scene: Scene) -> Iterator[str]:
    """Yield what scenes of this kind of machine name, and this one does not, leaks apart."""
    kind = kind_of(scene.machine)
    groups = next((names for offer, names in OTHERS.items() if offer in kind.offers), ())
    for names in groups:
        dry = scene.oil_supply is None and names[0] in OF_OIL
        if not dry and not any(name in scene.effects for name in names):
            yield " or ".join(names)


def _parted(scene: Scene, names: Sequence[str]) -> tuple[list[str], list[str]]:
    there = [name for name in names if name in scene.effects]
    return there, [name for name in names if name not in scene.effects]


def _short(name: str) -> str:
    return name.removesuffix("_leakage").replace("_", " ")


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
