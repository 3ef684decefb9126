"""Laws from a rotor profile: volume, ports and leakage paths, laid on the angle axis on which the cycle is solved.

A chamber's true life is no whole number of lobe pitches, nor is the angle at which its suction closes; the solver meets
neighbours a whole number of pitches apart. So suction closes at k pitches, and the life is as much longer as makes it
whole. Before its birth and after its end a chamber is idle: it keeps its dead volume, nothing is open, and its charge
waits for the next life. That is exact, not an approximation (docs/rotors.md). Units SI.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from screwsim.faults import Fault, UsageError
from screwsim.machine.rotors.curves import Curve, Curves, Path, make_curves
from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.rotors import Rotors, make_rotors
from screwsim.machine.settings import TwinScrew

BIRTH = math.radians(20.0)  # over which a path opens that is longer than nothing at the birth of a chamber
EVERY = 2  # row of the curves' 0.5° that the tables keep: steps see each row, and finer ones change no figure by 1e-4
BEYOND = math.radians(1.0)  # a last interval of zeros: at the end of a cubic its rounding would be left open
LEAST = 1e-9  # of its largest value: a curve that stays below it is nothing

_SHUT = "machine.built_in_volume_ratio: {:.4g} leaves the discharge port no opening (choose a smaller ratio)"

# the paths of each effect; the blow-hole at the suction cusp lies between filling chambers and is left out
EFFECTS = {
    "tip_leakage": ("male_tip", "female_tip"),
    "interlobe_leakage": ("sealing_line", "sealing_line_over_tip"),
    "blow_hole": ("blow_hole",),
    "end_face_leakage": ("end_face",),
}


@dataclass(frozen=True, eq=False)
class Table:
    """A curve over the scene's angle [rad], and the angles at which it begins, ends or jumps."""

    angle: Array
    value: Array
    knots: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Interface:
    """What lies between a chamber and the one `offset` pitches behind it, over the angle of the trailing one.

    table: length [m] for a clearance, or area [m²] of the blow-hole.
    """

    offset: int
    table: Table


@dataclass(frozen=True, eq=False)
class Laid:
    """All curves of a machine on the scene's angle axis; angles [rad], volumes [m³], areas [m²], lengths [m]."""

    rotors: Rotors
    curves: Curves
    life: float
    injection: float  # suction closes, the volume is largest
    born: float
    swept: float
    volume: Table
    suction: Table
    discharge: Table
    interfaces: Mapping[str, tuple[Interface, ...]]  # by effect

    @property
    def ends(self) -> float:
        """Angle at which the chamber ends [rad]; it is idle from there to the end of the life."""
        return self.born + self.curves.life

    @property
    def opens(self) -> float:
        """Angle at which the discharge port opens [rad]."""
        return self.born + self.curves.discharge_opens


def lay(machine: TwinScrew) -> Laid:
    """Return the curves of a machine with a profile; raise UsageError with one line a fault."""
    profile, ratio = machine.profile, machine.built_in_volume_ratio
    if profile is None or ratio is None:
        raise UsageError("\n".join(f"{fault.path}: {fault.what}" for fault in _missing(machine)))
    sizes = machine.male_lobes, machine.female_lobes, machine.rotor_diameter, machine.rotor_length
    return _laid(make_rotors(profile, *sizes), ratio)


@lru_cache(maxsize=64)
def _laid(rotors: Rotors, ratio: float) -> Laid:
    curves, pitch = make_curves(rotors, ratio), rotors.pair.pitch
    before = math.ceil(curves.suction_closes / pitch - 1e-9)
    after = math.ceil((curves.life - curves.suction_closes) / pitch - 1e-9)
    born = before * pitch - curves.suction_closes
    volume = _with_row(curves.volume.angle, curves.volume.value, curves.suction_closes, rotors.largest[1])
    return Laid(
        rotors,
        curves,
        (before + after) * pitch,
        before * pitch,
        born,
        rotors.largest[1],
        _table(volume[0] + born, volume[1]),
        _port(curves.suction, born, "machine.profile.wrap_angle: leaves the suction port no opening (choose another)"),
        _port(curves.discharge, born, _SHUT.format(ratio)),
        {effect: _interfaces(curves, kinds, born) for effect, kinds in EFFECTS.items()},
    )


def _port(parts: Mapping[str, Curve], born: float, shut: str) -> Table:
    angle, value = _summed([(curve.angle, curve.value) for curve in parts.values()], born)
    if value.max() <= 0.0:
        raise UsageError(shut)
    return _table(angle, value)


def _with_row(angle: Array, value: Array, at: float, largest: float) -> tuple[Array, Array]:
    """Return a curve with one more row, or with its value at the row that is there."""
    i = int(np.searchsorted(angle, at - 1e-9))
    if angle[i] < at + 1e-9:
        return angle, np.where(np.arange(len(angle)) == i, largest, value)
    return np.insert(angle, i, at), np.insert(value, i, largest)


def _summed(parts: Sequence[tuple[Array, Array]], shift: float) -> tuple[Array, Array]:
    """Return the sum of curves on the rows of all of them, nothing below zero, shifted by an angle [rad]."""
    rows = np.unique(np.concatenate([angle for angle, _ in parts]).round(12))
    rows = rows[np.concatenate([[True], np.diff(rows) > 1e-9])]
    total = sum(np.interp(rows, angle, value, left=0.0, right=0.0) for angle, value in parts)
    return rows + shift, np.maximum(total, 0.0)


def _table(angle: Array, value: Array) -> Table:
    """Return a table of every second row and the largest one, exactly zero before the first and after the last."""
    some = np.flatnonzero(value > LEAST * value.max())
    first, last = max(int(some[0]) - 1, 0), min(int(some[-1]) + 1, len(value) - 1)
    kept = np.unique([*range(first, last, EVERY), int(np.argmax(value)), last])
    rows, values = angle[kept], value[kept]
    values[[0, -1]] = 0.0
    end = float(rows[-1])
    return Table(np.append(rows, end + BEYOND), np.append(values, 0.0), (float(rows[0]), end))


def _interfaces(curves: Curves, kinds: Sequence[str], born: float) -> tuple[Interface, ...]:
    """Return the paths of an effect, those of one offset together, as far as both chambers live."""
    by_offset: dict[int, list[Path]] = {}
    for path in curves.paths:
        if path.name in kinds or path.name.rpartition("_")[0] in kinds:
            by_offset.setdefault(path.offset, []).append(path)
    found = []
    for offset, paths in sorted(by_offset.items()):
        angle, value = _summed([_alive(path.behind) for path in paths], born)
        if value.max() > 0.0:
            found.append(Interface(offset, _table(angle, value)))
    return tuple(found)


def _alive(curve: Curve) -> tuple[Array, Array]:
    """Return the part of a path from the birth of its trailing chamber on, where it opens from nothing."""
    angle, value = _with_row(curve.angle, curve.value, 0.0, float(np.interp(0.0, curve.angle, curve.value)))
    living = angle >= 0.0
    angle, value = angle[living], value[living]
    if value[0] <= LEAST * value.max():
        return angle, value
    x = np.clip(angle / BIRTH, 0.0, 1.0)
    return angle, value * x * x * (3.0 - 2.0 * x)


def _missing(machine: TwinScrew) -> list[Fault]:
    faults = []
    if machine.profile is None:
        what = "is missing (law: profile needs it: kind, centre_distance, female_diameter, wrap_angle …)"
        faults.append(Fault("machine.profile", what))
    if machine.built_in_volume_ratio is None:
        what = "is missing (law: profile needs it, e.g. built_in_volume_ratio: 3.2; it places the discharge port)"
        faults.append(Fault("machine.built_in_volume_ratio", what))
    return faults


def check_profile_law(machine: TwinScrew) -> list[Fault]:
    """Return the faults of a machine whose volume comes from its profile: what is missing, rotors that cannot be."""
    if machine.volume.law != "profile":
        what = f"is not used: machine.volume.law is {machine.volume.law} (write law: profile there, or remove this)"
        given = {"profile": machine.profile, "built_in_volume_ratio": machine.built_in_volume_ratio}
        return [Fault(f"machine.{name}", what) for name, value in given.items() if value is not None]
    missing = _missing(machine)
    if missing:
        return missing
    try:
        lay(machine)
    except UsageError as error:
        return [_fault(line) for line in str(error).splitlines()]
    return []


def _fault(line: str) -> Fault:
    path, _, what = line.partition(": ")
    return Fault(path, what) if path.startswith("machine.") else Fault("machine.profile.file", line)
