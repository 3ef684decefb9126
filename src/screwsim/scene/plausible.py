"""Warnings of what is possible but unusual in a scene, and of effects that scenes of its kind name and it omits.

Single values are compared with the bounds that their fields declare (`hardly=`), sizes with those of the machine
(`scene.sizes`), the lines with what the fluid allows (`scene.plausible_media`). The scene is solved as it is written.

A machine without half of its leaks has unrealistic efficiencies, and nothing in its figures shows why.
"""

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from itertools import chain
from typing import Any

import numpy as np

from screwsim.effects import catalogue
from screwsim.effects.parts.usual import LEAK, USUAL, Usual
from screwsim.inputs.declare import KINDS, UNBOUNDED, VOLUME, is_derived
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import joined_names
from screwsim.machine.kinds import kind_of
from screwsim.machine.rotors.settings import Profile, unused_parameters
from screwsim.machine.settings import TwinScrew, VolumeLaw
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.numerics.spline import read_curve, slope_oscillation
from screwsim.scene.fields import Leaf, Section, section_of
from screwsim.scene.plausible_media import medium_warnings
from screwsim.scene.sizes import size_warnings
from screwsim.scene.types import ActiveEffect, Scene
from screwsim.scene.units import readable_quantity

ASK_IF_MEANT = "is that intended?"
# share of the largest volume that a table's smallest may have: the displacement is off by as much
LEAST_VOLUME_SHARE = 1e-3
MIRRORED_RATIO = 1.5  # ratio of a lobe's blow-hole areas from which it looks mirrored: asymmetric profiles have 0.1
RESCALED_DEVIATION = 0.01  # relative deviation allowed between a table's largest volume and the stated one
# over its largest slope, how far a table's slope may jump back and forth; cut-off digits give half of it
ROUGH_SLOPE = 0.25
PLAIN_SECTIONS = ("gas", "oil", "operation", "oil_supply", "machine")


def scene_warnings(scene: Scene) -> tuple[str, ...]:
    """Return warnings about a scene that passed `cross_check`, one line each, which begins with the path."""
    of_machine = *_volume(scene), *_profile(scene), *size_warnings(scene)
    found = [*_fields(scene), *of_machine, *medium_warnings(scene)]
    return tuple(f"{path}: {what}; {ASK_IF_MEANT}" for path, what in found)


def _fields(scene: Scene) -> Iterator[tuple[str, str]]:
    for name in PLAIN_SECTIONS:
        part = getattr(scene, name)
        if part is not None:
            yield from _section_warnings(part, name)
    yield from _effect_warnings(scene.effects)


@IdentityCache
def _section_warnings(part: Any, path: str) -> tuple[tuple[str, str], ...]:
    return tuple(_outside_usual_range(part, path))


@IdentityCache
def _effect_warnings(effects: Mapping[str, ActiveEffect]) -> tuple[tuple[str, str], ...]:
    found = (_outside_usual_range(effect.parameters, f"effects.{name}") for name, effect in effects.items())
    return tuple(chain.from_iterable(found))


def _outside_usual_range(part: Any, path: str) -> Iterator[tuple[str, str]]:
    """Yield (path, what) of the values of a section, and of those below it, outside their usual bounds."""
    leaves, sections = _bounded(type(part))
    for name, leaf, low, high in leaves:
        value = getattr(part, name)
        if value is not None and not low <= value <= high:
            over = value > high
            usual = f"at most {_shown(leaf, high)}" if over else f"at least {_shown(leaf, low)}"
            yield f"{path}.{name}", f"{_shown(leaf, value)} is unusual (usual: {usual})"
    for name in sections:
        inner = getattr(part, name)
        if inner is not None:
            yield from _outside_usual_range(inner, f"{path}.{name}")


@cache
def _bounded(cls: type) -> tuple[tuple[tuple[str, Leaf, float, float], ...], tuple[str, ...]]:
    """Return (name, leaf, low, high) of the fields of a section with usual bounds, and the names of its sections."""
    fields, leaves = section_of(cls).fields, []
    for name, item in fields.items():
        if isinstance(item, Leaf) and item.hardly != UNBOUNDED:
            low, high = item.hardly
            leaves.append((name, item, -math.inf if low is None else low, math.inf if high is None else high))
    return tuple(leaves), tuple(name for name, item in fields.items() if isinstance(item, Section))


def _shown(leaf: Leaf, value: float) -> str:
    return f"{value:.6g}" if leaf.dimension is None else readable_quantity(leaf.dimension, value)


def _volume(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield warnings about a table of volumes that never reaches zero, whose slope jumps, or that is rescaled."""
    law = getattr(scene.machine, "volume", None)  # a user-defined machine may have anything here
    if isinstance(law, VolumeLaw) and law.file is not None:
        angles, volumes = read_curve(str(law.file), VOLUME)
        yield from _of_table(angles, volumes)
        yield from _rescaled_volumes(law, float(np.max(volumes)))


def _rescaled_volumes(law: VolumeLaw, largest: float) -> Iterator[tuple[str, str]]:
    """Yield a warning where the volumes of a table are rescaled to the largest volume that the scene states."""
    if law.max is None or abs(law.max - largest) <= RESCALED_DEVIATION * largest or is_derived(law.max):
        return
    held, stated = (readable_quantity(KINDS["volume"], round(each, 12)) for each in (largest, law.max))
    yield (
        "machine.volume.max",
        f"a table whose largest volume is {held} is scaled to {stated} (max: {held} keeps it as it is)",
    )


@IdentityCache
def _of_table(angles: np.ndarray, volumes: np.ndarray) -> tuple[tuple[str, str], ...]:
    """Return warnings about swept volumes that never reach zero (the largest counts as displacement), or jump."""
    told, least = [], float(np.min(volumes) / np.max(volumes))
    if least > LEAST_VOLUME_SHARE:
        what = f"the smallest volume of the table is {least:.2%} of its largest, which is the swept volume only if the"
        told.append(f"{what} smallest is 0 (subtract it from all rows, and write it as machine.volume.min)")
    share, at = slope_oscillation(angles, volumes)
    if share > ROUGH_SLOPE:
        what = f"the slope of the volume jumps back and forth from row to row, at {math.degrees(at):.4g} deg by"
        told.append(f"{what} {share:.0%} of the largest (use a smoother table, more digits, or fewer rows)")
    return tuple(("machine.volume.file", each) for each in told)


def _profile(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield warnings about values of the rotor profile that are not used, and about a lobe that looks mirrored."""
    profile = getattr(scene.machine, "profile", None)
    if isinstance(profile, Profile):
        yield from unused_parameters(profile)
        if profile.measured and isinstance(scene.machine, TwinScrew) and scene.machine.volume.from_rotors:
            yield from _mirrored_lobe(scene.machine)


def _mirrored_lobe(machine: TwinScrew) -> Iterator[tuple[str, str]]:
    from screwsim.machine.profile_law import laid_curves  # imported here so that scenes without rotors start faster

    with suppress(UsageError):  # for rotors that cannot be laid out, which is reported where they are built
        rotors = laid_curves(machine).rotors
        high, low = rotors.blow_hole.area(rotors.h), rotors.suction_blow_hole.area(rotors.h)
        if high > MIRRORED_RATIO * low:
            holes = f"{1e6 * high:.4g} mm² at the high-pressure cusp, {1e6 * low:.4g} mm² at the suction cusp"
            what = f"the larger blow-hole is the high-pressure one ({holes}), as for a lobe of the opposite hand"
            yield "machine.profile.file", f"{what} (reverse the sign of its y if so)"


def left_out_lines(scene: Scene) -> list[str]:
    """Return one line each on the leaks that a scene omits and on the number of effects that it omits."""
    return [line for line in (leaks_in_words(scene), left_out_in_words(scene)) if line]


def leaks_in_words(scene: Scene) -> str:
    """Return which of a machine's leaks are simulated; empty where all of them are."""
    leaks = _usual_effects(scene).get(LEAK, [])
    there = [name.removesuffix("_leakage").replace("_", " ") for name in leaks if name in scene.effects]
    lacking = [name for name in leaks if name not in scene.effects]
    if not lacking:
        return ""
    only = f"{joined_names(there)} only" if there else "none"
    return f"leaks simulated: {only}; typical scenes name {joined_names(lacking)}{', too' if there else ''}"


def left_out_in_words(scene: Scene) -> str:
    """Return in one line how many effects are not simulated, and which of these typical scenes name."""
    kind = kind_of(scene.machine)
    left = [name for name, effect in catalogue().items() if name not in scene.effects and effect.fits(kind)]
    if not left:
        return ""
    usual = list(_usual(scene))
    among = f", among them {joined_names(usual)}, which typical scenes name" if usual else ""
    many = f"{len(left)} effects" if len(left) > 1 else "1 effect"
    return f"not simulated: {many} of a {scene.machine.kind}{among} (screwsim explain says what each is)"


def _usual(scene: Scene) -> Iterator[str]:
    """Yield effects other than leaks that typical scenes of this kind of machine name and this one does not."""
    named = _usual_effects(scene)
    for what in USUAL:
        names = named.get(what, [])
        dry = scene.oil_supply is None and what.oiled
        if names and not dry and not any(name in scene.effects for name in names):
            yield " or ".join(names)


def _usual_effects(scene: Scene) -> dict[Usual, list[str]]:
    """Return the effects that count as usual for this kind of machine, by what they stand for."""
    kind, found = kind_of(scene.machine), {}
    for name, effect in catalogue().items():
        for offer, what in effect.usual.items():
            if offer in kind.offers:
                found.setdefault(what, []).append(name)
    return found
