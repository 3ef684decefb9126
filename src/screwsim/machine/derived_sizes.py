"""What a twin-screw scene states other than by lengths and angles: displacement, family of rotors, volume ratio.

Quantities that follow are filled in as `Derived` values, and again whenever a case of a sweep changes what they follow
from. A scene that states the same thing twice is refused: nothing is overridden silently. Units SI.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from typing import Any

from screwsim.inputs.declare import Derived, DerivedCount, DerivedWord, is_derived
from screwsim.inputs.faults import Fault, UsageError, given_twice
from screwsim.machine.geometry import Geometry
from screwsim.machine.moved_port import LAST, PATH
from screwsim.machine.paper_law import TURN
from screwsim.machine.rotors.settings import FAMILIES, Profile
from screwsim.machine.settings import LIFE, TwinScrew

LENGTHS = (
    "centre_distance",
    "female_diameter",
    "male_tip_radius",
    "female_tip_radius",
    "flank_radius",
    "pressure_angle",
    "root_radius",
    "file",
)
OPENING = 5.0 / 16.0  # (φ_C − φ_dis) over half of the port's open angle, as of rotors (b)


def own_value(value: Any) -> Any:
    """Return a value that the scene itself states; None for one that is derived."""
    return None if is_derived(value) else value


def _opened_by_ratio(machine: TwinScrew) -> bool:
    return machine.built_in_volume_ratio is not None and not machine.volume.from_rotors


def with_derived_sizes(machine: TwinScrew) -> TwinScrew:
    """Return a machine with all derived values filled in; unchanged where `stated_faults` finds a fault."""
    otherwise = machine.family is not None or machine.displacement is not None or _opened_by_ratio(machine)
    if not otherwise or any(stated_faults(machine)):
        return machine
    machine = _sized(_lobed(machine))
    if machine.profile is not None and machine.family is not None:
        machine = replace(machine, profile=_of_size(machine.profile, machine.rotor_diameter))
    return _opened(machine)


# ---- family and size -----------------------------------------------------------------------------------------


def _lobed(machine: TwinScrew) -> TwinScrew:
    profile, family = machine.profile, machine.family
    if profile is None or family is None:
        return machine
    wrap = own_value(profile.wrap_angle) or Derived(family.wrap_angle)
    profile = replace(profile, kind=DerivedWord(family.kind), wrap_angle=wrap)
    lobes = DerivedCount(family.male_lobes), DerivedCount(family.female_lobes)
    return replace(machine, profile=profile, male_lobes=lobes[0], female_lobes=lobes[1])


def _sized(machine: TwinScrew) -> TwinScrew:
    """Return a machine whose diameter and length, or chamber volume, follow from a displacement."""
    profile, family, stated = machine.profile, machine.family, machine.displacement
    if stated is not None and not machine.volume.from_rotors:
        return replace(machine, volume=replace(machine.volume, max=Derived(stated.volume / machine.male_lobes)))
    if profile is None or family is None:
        return machine
    length, diameter = own_value(machine.rotor_length), own_value(machine.rotor_diameter)
    if stated is not None:
        volume = stated.volume / family.male_lobes / unit_volume(profile.family or "", profile.wrap_angle)
        diameter = Derived((volume / family.length) ** (1.0 / 3.0) if length is None else math.sqrt(volume / length))
    assert diameter is not None  # else a fault
    return replace(machine, rotor_diameter=diameter, rotor_length=length or Derived(family.length * diameter))


def _of_size(profile: Profile, diameter: float) -> Profile:
    family = FAMILIES[profile.family or ""]
    lengths: dict[str, Any] = {name: Derived(share * diameter) for name, share in family.shares.items()}
    angle = None if family.pressure_angle is None else Derived(family.pressure_angle)
    return replace(profile, **lengths, pressure_angle=angle)


@lru_cache(maxsize=64)
def unit_volume(name: str, wrap: float) -> float:
    """Return the largest chamber volume over D² L of a family with a wrap [rad], which does not depend on the size."""
    from screwsim.machine.rotors.rotors import make_rotors  # here: rotors take long to import

    family = FAMILIES[name]
    profile = _of_size(Profile(family=name, kind=family.kind, wrap_angle=wrap), 1.0)
    return make_rotors(profile, family.male_lobes, family.female_lobes, 1.0, 1.0).largest[1]


# ---- the discharge port of the paper's law -------------------------------------------------------------------


def _opened(machine: TwinScrew) -> TwinScrew:
    port, ratio = machine.discharge_port, machine.built_in_volume_ratio
    if port is None or ratio is None or port.from_file or not _opened_by_ratio(machine):
        return machine
    opens = opening_angle(machine, ratio)
    end = Derived(opens + OPENING * 0.5 * (LIFE - opens))
    return replace(machine, discharge_port=replace(port, opens=Derived(opens), phi_C=end))


def opening_angle(machine: TwinScrew, ratio: float) -> float:
    """Return the angle [rad] at which a chamber has its largest volume over a ratio: M16 inverted, or a table searched.

    Volumes include the dead volume, as in the result's `built_in_volume_ratio`. The life's end where there is no such
    angle.
    """
    law = machine.volume
    if law.from_file:
        try:
            found = Geometry(machine).opening_angle(ratio)
        except UsageError:  # reported where files are checked
            found = 0.75 * LIFE
        return LIFE if found is None else found
    largest, c = law.max or 0.0, float(law.phi_A or 0.0) / TURN
    if largest <= 0.0:  # reported with the volume
        return 0.75 * LIFE
    left = ((largest + law.dead) / ratio - law.dead) / largest  # value of the bump, M15
    if left <= 0.0:
        return LIFE
    x = 2.0 - math.sqrt(c * left) if left < c else 1.0 + math.sqrt((1.0 - left) * (1.0 - c))
    return x * TURN


# ---- what contradicts ----------------------------------------------------------------------------------------


def stated_faults(machine: TwinScrew) -> Iterator[Fault]:
    """Yield faults of quantities that are stated twice, or not at all."""
    yield from _of_family(machine)
    yield from _of_displacement(machine)
    by_family = machine.family is not None and machine.volume.from_rotors
    if own_value(machine.rotor_diameter) is None and not (by_family and machine.displacement is not None):
        what = "is missing (write rotor_diameter: … mm; outer diameter of the male rotor"
        only = "; here displacement gives volume.max only)" if machine.displacement is not None else ")"
        yield Fault("machine.rotor_diameter", what + only)
    if own_value(machine.rotor_length) is None and not by_family:
        yield Fault("machine.rotor_length", "is missing (write rotor_length: … mm; length of the rotors)")
    if _opened_by_ratio(machine):
        yield from _of_ratio(machine)
    if machine.axial_volume_ratio is not None and not machine.volume.from_rotors:
        what = "applies only to law: profile, whose discharge port has two parts (remove it)"
        yield Fault("machine.axial_volume_ratio", what)
    if machine.slide_valve is not None:
        yield from _of_slide(machine)


def _of_slide(machine: TwinScrew) -> Iterator[Fault]:
    port, path = machine.discharge_port, "machine.slide_valve"
    if not machine.volume.from_rotors or port is None or not port.from_rotors:
        what = "needs rotors: machine.volume.law and machine.discharge_port.law: profile"
        yield Fault(path, f"{what} (write these; under other laws effects.slide_valve states the angles itself)")
    elif machine.expands:
        yield Fault(path, "applies only to machine.mode: compressor (remove it)")


def _of_family(machine: TwinScrew) -> Iterator[Fault]:
    profile, family, beside = machine.profile, machine.family, "is given as well as machine.profile.family"
    if profile is None or family is None:
        return
    for name in LENGTHS:
        if own_value(getattr(profile, name)) is not None:
            known = "machine.profile.family, whose rotors follow from rotor_diameter"
            yield given_twice(f"machine.profile.{name}", known)
    if own_value(profile.kind) not in (None, family.kind):
        yield Fault("machine.profile.kind", f"{beside}: {profile.family}, which is {family.kind} (remove it)")
    for name in ("male_lobes", "female_lobes"):
        value, known = own_value(getattr(machine, name)), getattr(family, name)
        if value not in (None, known):
            yield Fault(f"machine.{name}", f"{beside}: {profile.family}, which has {known} (remove it)")


def _of_displacement(machine: TwinScrew) -> Iterator[Fault]:
    if machine.displacement is None:
        return
    path = "machine.displacement"
    if not machine.volume.from_rotors:
        if own_value(machine.volume.max) is not None:
            yield given_twice("machine.volume.max", f"{path}, which states it already")
    elif machine.family is None:
        what = "needs machine.profile.family: this profile states the size of its rotors by lengths"
        yield Fault(path, f"{what} (write family: b, or remove it)")
    elif own_value(machine.rotor_diameter) is not None:
        yield given_twice("machine.rotor_diameter", f"{path}, which states it already")


def _of_ratio(machine: TwinScrew) -> Iterator[Fault]:
    port = machine.discharge_port
    if port is None:
        yield Fault(PATH, "needs the section machine.discharge_port, which it opens (write it, or remove this)")
        return
    if port.from_file:
        yield from table_port_faults(_sized(machine))
        return
    for name in ("opens", "phi_C"):
        if own_value(getattr(port, name)) is not None:
            yield given_twice(f"machine.discharge_port.{name}", f"{PATH}, from which it follows")
    law, ratio = machine.volume, machine.built_in_volume_ratio or 0.0
    known = law.phi_A is not None and 0.0 < law.phi_A <= TURN if law.by_formula else law.file is not None
    known = known and bool(law.max or machine.displacement is not None)
    if known and opening_angle(_sized(machine), ratio) > LIFE - LAST:
        what = f"{ratio:.4g} leaves the port less than 10 deg before the end of discharge"
        yield Fault(PATH, f"{what} (choose a smaller ratio)")


def table_port_faults(machine: TwinScrew) -> list[Fault]:
    """Return why a tabulated discharge port cannot be moved to the built-in volume ratio; empty where it can."""
    port, law = machine.discharge_port, machine.volume
    if port is None or port.file is None or (law.from_file and (law.file is None or not law.max)):
        return []  # missing keys are reported elsewhere
    if law.by_formula and not (law.max and law.phi_A is not None and 0.0 < law.phi_A <= TURN):
        return []
    try:
        Geometry(machine).discharge_law()
    except UsageError as error:
        path, _, what = str(error).partition(": ")
        return [Fault(path, what)] if path == PATH else []  # unreadable files are reported elsewhere
    return []
