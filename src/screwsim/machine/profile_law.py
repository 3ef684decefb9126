"""Laws from a rotor profile: volume, ports and leakage paths on the angle axis on which the cycle is solved.

Neither a chamber's true life nor the angle at which its suction closes is a whole number of lobe pitches, but the
solver needs neighbours to be whole pitches apart. So suction closes at k pitches, and the life is extended to a whole
number of pitches. Before its birth and after its end a chamber is idle: it keeps its dead volume, nothing is open, and
its charge waits for the next life. That is exact, not an approximation (docs/reference/rotors.md).

The tables are smooth between the breakpoints, where steps end. V is the cubic spline with the rotors' V and dV/dφ at
its rows; the slopes of an area are differences of its rows, taken separately on each side of a kink. So every curve is
smooth between two breakpoints, and dV/dφ is the derivative of V. A step ends at each breakpoint where a curve bends
enough to matter (docs/reference/rotors.md). Units SI, angles in rad.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from screwsim.inputs.declare import AREA
from screwsim.inputs.faults import Fault, UsageError
from screwsim.machine.moved_port import LAST, opening_row
from screwsim.machine.protocol import BLOW_HOLE, CONTACT_GAP, END_GAP, TIP_GAP
from screwsim.machine.rotors.curves import OVERLAP, Curve, Curves, Path, closed_in, make_curves
from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.rotors import MOST_CACHED, Rotors, make_rotors
from screwsim.machine.rotors.settings import SlideValve
from screwsim.machine.settings import TwinScrew
from screwsim.numerics.spline import LEAST, differences, read_curve, side_slopes

BIRTH = math.radians(20.0)  # angle over which a path opens whose length is not zero at the chamber's birth
BEFORE_CLOSING = np.radians((2.0, 0.5, 0.1))  # steps end there: error control misses the layer before a port closes
AFTER_OPENING = np.radians((2.0, 5.0, 10.0, 20.0))  # and there, next to a chamber whose pressure jumps as it opens
DEG = math.radians(1.0)
EVERY = 2  # the tables keep every second row of the curves, which are 0.5° apart
BEYOND = 1.0 * DEG  # length of a last interval of zeros, so that a cubic's rounding does not leave an opening
BEND = 0.02  # jump of d²V/dφ² over V_max [1/rad²] below which no step ends there
KINK = 0.2  # the same for a jump of an area's slope over its largest value [1/rad]
STEEP = 8.0  # change of an area's slope between rows over its largest value [1/rad] that marks the ends of a jump

_NO_SUCTION = "machine.profile.wrap_angle: leaves no opening for the suction port (choose another)"
_SHUT = "machine.built_in_volume_ratio: {:.4g} leaves no opening for the discharge port (choose a smaller ratio)"

# the paths of each kind of gap: those of one group with the same offset form one interface
PATHS = {
    TIP_GAP: (("male_tip", "female_tip"),),
    CONTACT_GAP: (("sealing_line", "sealing_line_over_tip"),),
    BLOW_HOLE: (("blow_hole",), ("suction_blow_hole",)),
    END_GAP: (("end_face", "suction_face"),),
}


@dataclass(frozen=True, eq=False)
class Table:
    """A curve over the scene's angle [rad], its slopes at both ends of each interval, and where steps end."""

    angle: Array
    value: Array
    slope: Array
    breakpoints: tuple[float, ...]

    @property
    def ends(self) -> tuple[float, float]:
        """Where the curve begins and ends [rad]."""
        return self.breakpoints[0], self.breakpoints[-1]

    @property
    def curve(self) -> tuple[Array, Array, Array]:
        """The table as `numerics.spline.pack_curve` takes it."""
        return self.angle, self.value, self.slope

    def times(self, factor: float) -> Table:
        """Return the table multiplied."""
        return replace(self, value=factor * self.value, slope=factor * self.slope)

    def landing(self, angles: Iterable[float]) -> Table:
        """Return the table with further angles [rad] at which steps end, as far as they lie between its ends."""
        first, last = self.ends
        return replace(self, breakpoints=tuple(sorted({*self.breakpoints, *(x for x in angles if first < x < last)})))


@dataclass(frozen=True, eq=False)
class Interface:
    """The gap between a chamber and the one `offset` pitches behind it, over the angle of the trailing one.

    table: length [m] of a clearance, or area [m²] of the blow-hole.
    """

    offset: int
    table: Table


def sized_holes(holes: tuple[Interface, ...], area: float | None) -> tuple[Interface, ...]:
    """Return blow-holes, the first, at the high-pressure cusp, scaled to a largest area [m²]; as they are for None."""
    if area is None or not holes:
        return holes
    first = holes[0].table
    return (replace(holes[0], table=first.times(area / float(first.value.max()))), *holes[1:])


@dataclass(frozen=True, eq=False)
class LaidCurves:
    """All curves of a machine on the scene's angle axis; angles [rad], volumes [m³], areas [m²], lengths [m]."""

    rotors: Rotors
    curves: Curves
    life: float
    injection: float  # where suction closes and the volume is largest
    born: float
    swept: float
    volume: Table
    suction: Table
    discharge: Table
    interfaces: Mapping[str, tuple[Interface, ...]]  # by kind of gap
    slot: Table | None = None  # of machine.slide_valve, to suction
    moved: bool = False  # whether that slide is away from full load

    @property
    def ends(self) -> float:
        """Angle at which the chamber ends [rad]; it is idle from there to the end of the life."""
        return self.born + self.curves.life

    def on_rotors(self, angle: Array, expands: bool) -> Array:
        """Return angles [rad] of chambers on the rotors' own axis, which an expander passes backwards (M150)."""
        return (self.life - angle if expands else angle) - self.born + self.rotors.start

    @property
    def opens(self) -> float:
        """Angle at which the discharge port opens [rad]."""
        return self.born + self.curves.discharge_opens

    @property
    def volume_ratio(self) -> float | None:
        """Volume where a slide's slot has been passed over that where the port opens; None for a slide at full load."""
        return closed_in(self.rotors, self.curves)[1] if self.moved else None


def laid_curves(machine: TwinScrew) -> LaidCurves:
    """Return the curves of a machine with a profile; raise UsageError with one line per fault."""
    profile, ratio = machine.profile, machine.built_in_volume_ratio
    if profile is None or (ratio is None and not _opens_as_drawn(machine)):
        raise UsageError("\n".join(map(str, _missing(machine))))
    sizes = machine.male_lobes, machine.female_lobes, machine.rotor_diameter, machine.rotor_length
    rotors = make_rotors(profile, *sizes)
    found = _ratio_as_drawn(rotors, machine) if ratio is None else ratio
    try:
        return _laid(rotors, found, machine.axial_volume_ratio, machine.slide_valve)
    except UsageError as error:
        if ratio is not None or not str(error).startswith("machine.built_in_volume_ratio: "):
            raise
        what = "opens so close to the end of discharge that nothing is left of the port (begin it earlier)"
        raise UsageError(f"machine.discharge_port.file: {what}") from None


def _opens_as_drawn(machine: TwinScrew) -> bool:
    """Tell whether a table says where the discharge port opens, so that no volume ratio has to."""
    port = machine.discharge_port
    return port is not None and port.from_file and port.file is not None


def _ratio_as_drawn(rotors: Rotors, machine: TwinScrew) -> float:
    """Return the largest volume over that where the table of the discharge port opens; 1 if it opens before."""
    assert machine.discharge_port is not None  # with a table
    opens = opening_row(*read_curve(str(machine.discharge_port.file), AREA))
    closes, largest = rotors.largest
    pitch = rotors.pair.pitch
    turned = opens - _pitches_before(closes - rotors.start, pitch) * pitch  # after suction has closed
    angle = min(closes + max(turned, 0.0), rotors.wrap - LAST)
    return largest / float(rotors.volume(np.array(angle)))


def _pitches_before(closes: float, pitch: float) -> int:
    """Return the whole pitches of the scene's angle at which suction closes, at the rotors' angle `closes` [rad]."""
    return math.ceil(closes / pitch - 1e-9)


@lru_cache(maxsize=MOST_CACHED)
def _laid(rotors: Rotors, ratio: float, axial_ratio: float | None, slide: SlideValve | None) -> LaidCurves:
    curves, pitch = make_curves(rotors, ratio, axial_ratio, slide), rotors.pair.pitch
    before = _pitches_before(curves.suction_closes, pitch)
    after = math.ceil((curves.life - curves.suction_closes) / pitch - 1e-9)
    born = before * pitch - curves.suction_closes
    return LaidCurves(
        rotors,
        curves,
        (before + after) * pitch,
        before * pitch,
        born,
        rotors.largest[1],
        volume_table(curves, rotors, born),
        _port(curves.suction, born, _NO_SUCTION).landing(before * pitch - BEFORE_CLOSING),
        _port(curves.discharge, born, _SHUT.format(ratio)),
        {gap: _interfaces(curves, kinds, born) for gap, kinds in PATHS.items()},
        None if curves.slot is None else _slot(curves.slot, born),
        slide is not None and slide.position > 0.0,
    )


def _slot(curve: Curve, born: float) -> Table:
    """Return the area of a slide's slot; zero over the whole life where the slide is at full load."""
    if curve.value.max() > 0.0:
        return area_table(curve, born)
    ends = curve.angle[[0, -1]] + born
    return Table(ends, np.zeros(2), np.zeros((1, 2)), (float(ends[0]), float(ends[1])))


def _port(parts: Mapping[str, Curve], born: float, shut: str) -> Table:
    total = _summed(list(parts.values()))
    if total.value.max() <= 0.0:
        raise UsageError(shut)
    return area_table(total, born)


def _summed(curves: Sequence[Curve]) -> Curve:
    """Return the sum of curves with the same rows, cut off at zero."""
    first = curves[0]
    return replace(first, value=np.maximum(np.sum([curve.value for curve in curves], axis=0), 0.0))


def _interfaces(curves: Curves, groups: Sequence[Sequence[str]], born: float) -> tuple[Interface, ...]:
    """Return the paths of a kind of gap while both chambers live, those of one group and offset added up."""
    by_offset: dict[tuple[int, int], list[Path]] = {}
    for path in curves.paths:
        for i, kinds in enumerate(groups):
            if path.name in kinds or path.name.rpartition("_")[0] in kinds:
                by_offset.setdefault((i, path.offset), []).append(path)
    found = []
    for (_, offset), paths in sorted(by_offset.items()):
        whole = _summed([_path_while_alive(path, curves.suction_closes) for path in paths])
        if whole.value.max() > 0.0:
            table = area_table(whole, born)
            found.append(Interface(offset, table.landing(born + curves.discharge_opens + AFTER_OPENING)))
    return tuple(found)


def _path_while_alive(path: Path, closes: float) -> Curve:
    """Return a path from the birth of its trailing chamber on; one with a length there opens over 20°.

    A path on the suction side opens over the 20° before the suction of the leading chamber closes: until then it lies
    between two chambers at suction pressure.
    """
    curve = path.behind
    first = max(0.0, closes - OVERLAP - path.offset * path.pitch) if path.name.startswith("suction") else 0.0
    living = curve.angle > -1e-9
    angle, value = curve.angle[living], curve.value[living]
    if np.interp(first, angle, value) > LEAST * value.max():
        x = np.clip((angle - first) / BIRTH, 0.0, 1.0)
        value = value * x * x * (3.0 - 2.0 * x)
    return replace(curve, angle=angle, value=value, breakpoints=tuple(at for at in curve.breakpoints if at > -1e-9))


def _missing(machine: TwinScrew) -> list[Fault]:
    needs = {
        "profile": "needs it: kind, centre_distance, female_diameter, wrap_angle …",
        "built_in_volume_ratio": "needs it, e.g. built_in_volume_ratio: 3.2; it places the discharge port",
    }
    if _opens_as_drawn(machine):
        del needs["built_in_volume_ratio"]
    lacking = (name for name in needs if getattr(machine, name) is None)
    return [Fault(f"machine.{name}", f"is missing (law: profile {needs[name]})") for name in lacking]


def check_profile_law(machine: TwinScrew) -> list[Fault]:
    """Return the faults of a machine whose volume comes from its profile: missing keys, impossible rotors."""
    if not machine.volume.from_rotors:
        what = f"is not used: machine.volume.law is {machine.volume.law} (write law: profile there, or remove this)"
        return [Fault("machine.profile", what)] if machine.profile is not None else []
    try:
        laid_curves(machine)
    except UsageError as error:
        return [_fault(line, machine) for line in str(error).splitlines()]
    return []


def _fault(line: str, machine: TwinScrew) -> Fault:
    path, _, what = line.partition(": ")
    of_table = machine.discharge_port is not None and path == machine.discharge_port.file
    other = "machine.discharge_port.file" if of_table else "machine.profile.file"
    return Fault(path, what) if path.startswith("machine.") else Fault(other, line)


def volume_table(curves: Curves, rotors: Rotors, born: float) -> Table:
    """Return V over the scene's angle: cubics with the rotors' V and dV/dφ at every row."""
    rows, value = curves.volume.angle[::EVERY], curves.volume.value[::EVERY].copy()
    slope = rotors.volume_slope(rows + rotors.start)
    value[[0, -1]] = slope[[0, -1]] = 0.0
    own = curves.volume.breakpoints
    seen = _bent(rows, differences(rows, slope, own), own, BEND * value.max())
    breakpoints = born, *(at + born for at in seen), born + curves.life
    return Table(rows + born, value, np.column_stack([slope[:-1], slope[1:]]), breakpoints)


def area_table(curve: Curve, born: float) -> Table:
    """Return an area (or length) over the scene's angle, exactly zero before its first row and after its last."""
    rows, value = curve.angle[::EVERY], curve.value[::EVERY]
    some = np.flatnonzero(value > LEAST * value.max())
    part = slice(max(int(some[0]) - 1, 0), min(int(some[-1]) + 2, len(value)))
    rows, value = rows[part], value[part].copy()
    value[[0, -1]] = 0.0
    end = float(rows[-1])
    inside = [at for at in curve.breakpoints if rows[0] < at < end - 1e-9]
    angle, value = np.append(rows, end + BEYOND), np.append(value, 0.0)
    slope, largest = side_slopes(angle, value, [*inside, end]), float(value.max())
    secant = np.diff(value) / np.diff(angle)
    jumps = rows[1:-1][np.abs(np.diff(secant[:-1])) > STEEP * largest]
    seen = sorted({*_bent(angle, slope, inside, KINK * largest), *(float(x) for x in jumps)})
    return Table(angle + born, value, slope, (float(rows[0]) + born, *(x + born for x in seen), end + born))


def _bent(x: Array, slope: Array, breakpoints: Sequence[float], least: float) -> list[float]:
    """Return the breakpoints between the ends at which the slope of a curve jumps by more than `least`."""
    rows = [int(i) for i in np.searchsorted(x, np.sort(breakpoints) - 1e-9) if 0 < i < len(x) - 1]
    return [float(x[i]) for i in rows if abs(slope[i, 0] - slope[i - 1, 1]) > least]
