"""What a scene leaves out that scenes of its kind of machine name: its leaks first, in one line each.

A machine with half its leaks has efficiencies that no machine has, and nothing of its figures shows it.
"""

from collections.abc import Iterator, Sequence

from screwsim.effects import catalogue
from screwsim.effects.parts.usual import LEAK, USUAL, Usual
from screwsim.machine.kinds import kind_of
from screwsim.scene.types import Scene


def what_is_left_out(scene: Scene) -> list[str]:
    """Return in a line each which leaks, and how many effects, a scene leaves out."""
    return [line for line in (leaks_told(scene), left_out_told(scene)) if line]


def leaks_told(scene: Scene) -> str:
    """Return which of a machine's leaks are simulated, where not all of them are; empty where they are."""
    there, lacking = _parted(scene, _named(scene).get(LEAK, []))
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
    named = _named(scene)
    for what in USUAL:
        names = named.get(what, [])
        dry = scene.oil_supply is None and what.oiled
        if names and not dry and not any(name in scene.effects for name in names):
            yield " or ".join(names)


def _named(scene: Scene) -> dict[Usual, list[str]]:
    """Return the effects that are something usual of this kind of machine, by what they are."""
    kind, found = kind_of(scene.machine), {}
    for name, effect in catalogue().items():
        for offer, what in effect.usual.items():
            if offer in kind.offers:
                found.setdefault(what, []).append(name)
    return found


def _parted(scene: Scene, names: Sequence[str]) -> tuple[list[str], list[str]]:
    there = [name for name in names if name in scene.effects]
    return there, [name for name in names if name not in scene.effects]


def _short(name: str) -> str:
    return name.removesuffix("_leakage").replace("_", " ")


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
