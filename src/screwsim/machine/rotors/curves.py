"""All curves of a machine over a chamber's own angle, as tables for `numerics.spline.pack_curve`.

Angles count from the beginning of a chamber's life (0) to its end (`Rotors.life`, not forced to 720°). A leakage curve
belongs to the interface of a chamber with the one `offset` lobe pitches behind it: `angle` is the leading chamber's;
`behind` is the same table over the trailing chamber's angle, which the effects need. Units SI.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from screwsim.machine.rotors import leakage, ports
from screwsim.machine.rotors.leakage import female_tip, male_tip, sealing_line
from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.rotors import Rotors
from screwsim.machine.rotors.sections import TURN
from screwsim.machine.rotors.settings import SlideValve
from screwsim.machine.rotors.slide import PlacedSlide, placed_slide, slot_areas, slot_breakpoints

STEP = np.radians(0.5)  # largest spacing of the tables between breakpoints
OVERLAP = np.radians(20.0)  # angle before suction closes from which paths on the suction side count (`profile_law`)
TOGETHER = 1e-6  # [rad] distance below which two breakpoints are one


@dataclass(frozen=True, eq=False)
class Curve:
    """A table: angle [rad], value in `unit`, and the angles [rad] at which its slope may jump."""

    angle: Array
    value: Array
    unit: str
    breakpoints: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Path:
    """A leakage path from a chamber to the one `offset` pitches behind; unit m: length of a clearance, m^2: area."""

    name: str
    offset: int
    pitch: float
    curve: Curve

    @property
    def behind(self) -> Curve:
        """The curve over the trailing chamber's angle (negative before that chamber's birth)."""
        shift, c = self.offset * self.pitch, self.curve
        return Curve(c.angle - shift, c.value, c.unit, tuple(at - shift for at in c.breakpoints))


@dataclass(frozen=True, eq=False)
class Curves:
    """All curves by angle: volume, ports, leakage paths."""

    life: float
    volume: Curve
    suction: dict[str, Curve]
    discharge: dict[str, Curve]
    paths: tuple[Path, ...]
    suction_closes: float
    discharge_opens: float
    slot: Curve | None = None  # of a slide valve, to suction
    compresses: float | None = None  # where a moved slide valve's slot is passed, later than suction_closes


Grid = tuple[Array, tuple[float, ...]]


def _grid(rotors: Rotors, breakpoints: list[float]) -> Grid:
    """Return angles φ [rad] over the life, evenly spaced between the breakpoints inside it, and these as own angles.

    The number of intervals between breakpoints is even, so that every second angle also includes all breakpoints.
    """
    start, end = rotors.start, rotors.wrap
    inside = [start]
    for at in sorted(breakpoints):
        if inside[-1] + TOGETHER < at < end - TOGETHER:
            inside.append(at)
    edges = np.array([*inside, end])
    counts = 2 * np.ceil(0.5 * np.diff(edges) / STEP).astype(int)
    begins = np.cumsum(counts) - counts
    number = np.arange(counts.sum()) - np.repeat(begins, counts)
    phi = number * np.repeat(np.diff(edges) / counts, counts) + np.repeat(edges[:-1], counts)
    return np.append(phi, end), tuple((edges[1:-1] - start).tolist())


def _curve(rotors: Rotors, grid: Grid, unit: str, value: Array) -> Curve:
    phi, kept = grid
    return Curve(phi - rotors.start, value, unit, (0.0, *kept, rotors.life))


def section_breakpoints(rotors: Rotors) -> list[float]:
    """Return the angles ψ at which the slope of the section area jumps [rad]."""
    pair, S = rotors.pair, float(rotors.chain.psi[rotors.chain.trail])
    p = pair.pitch
    mesh = contact_breakpoints(rotors)
    return [*(m - TURN for m in mesh), mesh[-1] - TURN - p, *mesh, -pair.beta1 - p, -pair.beta1, S]


def contact_breakpoints(rotors: Rotors) -> list[float]:
    """Return the angles ψ at which the contact line begins, ends, or runs along the flat [rad]."""
    chain, p = rotors.chain, rotors.pair.pitch
    S, lead = float(chain.psi[chain.trail]), float(chain.psi[chain.lead])
    return [S - p, chain.land_start - p, chain.land_end, lead]


def _both_ends(rotors: Rotors, psi: list[float]) -> list[float]:
    return [*psi, *(x + rotors.wrap for x in psi)]


def _volume_curve(rotors: Rotors) -> Curve:
    grid = _grid(rotors, [*_both_ends(rotors, section_breakpoints(rotors)), rotors.largest[0]])
    return _curve(rotors, grid, "m^3", rotors.volume(grid[0]))


def _suction_curves(rotors: Rotors, grooves: ports.UncoveredArea, closes: float) -> dict[str, Curve]:
    grid = _grid(rotors, [closes, closes - rotors.pair.pitch, -TURN + rotors.pair.beta1])
    phi, cut = grid[0], rotors.sections
    middle = 0.5 * (cut.psi[0] + cut.psi[-1])
    gained = np.where(phi < middle, cut.area_at(phi) / cut.grooves, 1.0)  # a chamber is born shut, whatever its grooves
    one, two = ports.radial_suction(rotors, phi, closes)
    parts = {"axial": ports.axial_suction(rotors, grooves, phi, closes), "radial": gained * (one + two)}
    return {name: _curve(rotors, grid, "m^2", area) for name, area in parts.items()}


def _discharge_curves(
    rotors: Rotors, grooves: ports.UncoveredArea, opens: float, face_opens: float
) -> dict[str, Curve]:
    """Return the areas of the discharge port: on the bores from `opens` [rad] on, on the end face from `face_opens`."""
    pair = rotors.pair
    begins = [each + later for each in dict.fromkeys((opens, face_opens)) for later in (0.0, pair.pitch)]
    begins.append(ports.axial_opening(rotors, grooves, face_opens))
    grid = _grid(rotors, [*begins, rotors.wrap - pair.beta1 - pair.pitch, rotors.wrap - pair.beta1])
    phi = grid[0]
    one, two = ports.radial_discharge(rotors, phi, opens)
    parts = {"axial": ports.axial_discharge(rotors, grooves, phi, face_opens), "radial": one + two}
    return {name: _curve(rotors, grid, "m^2", area) for name, area in parts.items()}


def _paths(rotors: Rotors, closes: float) -> tuple[Path, ...]:
    """Return the leakage paths of a chamber, each to the chamber `offset` pitches behind."""
    pair, chain, h, wrap = rotors.pair, rotors.chain, rotors.h, rotors.wrap
    z1, S = pair.male_lobes, float(chain.psi[chain.trail])

    def path(name: str, offset: int, unit: str, breakpoints: Sequence[float], size: Callable[[Array], Array]) -> Path:
        grid = _grid(rotors, [*breakpoints, rotors.start + offset * pair.pitch])
        return Path(name, offset, pair.pitch, _curve(rotors, grid, unit, size(grid[0])))

    line, contact = sealing_line(pair, chain, h), _both_ends(rotors, [*contact_breakpoints(rotors), S])
    lines = (
        path("sealing_line", z1, "m", contact, lambda phi: line.lengths_at(phi, wrap)[0]),
        path("sealing_line_over_tip", z1 + 1, "m", contact, lambda phi: line.lengths_at(phi, wrap)[1]),
    )
    male, female = male_tip(pair, h), female_tip(pair, chain, h)
    bores = _both_ends(rotors, [male.start, male.end, female.start, female.end])
    tips = (
        path("male_tip", 1, "m", bores, lambda phi: male.length_at(phi, wrap)),
        path("female_tip", 1, "m", bores, lambda phi: female.length_at(phi, wrap)),
    )
    hole, back = rotors.blow_hole, rotors.suction_blow_hole
    angles = [float(psi) for psi in (hole.psi_male[0], S, hole.psi_female[0])]
    early = [-TURN - float(psi) for psi in (back.psi_male[0], back.psi_male[-1], back.psi_female[0])]
    at_suction = [*_both_ends(rotors, early), closes - OVERLAP]
    holes = (
        path("blow_hole", 1, "m^2", _both_ends(rotors, angles), lambda phi: hole.area_at(phi, wrap, h)),
        path("suction_blow_hole", 1, "m^2", at_suction, lambda phi: back.area_at(wrap - phi - TURN, wrap, h)),
    )
    births = [rotors.start + offset * pair.pitch for offset in (1, z1 - 1, z1, z1 + 1)]
    face = [*_both_ends(rotors, [*section_breakpoints(rotors), S - pair.pitch, S]), closes - OVERLAP, *births]
    phi = _grid(rotors, face)[0]
    faces = {"end": leakage.face_lengths(pair, chain, phi - wrap), "suction": leakage.face_lengths(pair, chain, phi)}
    ends = (
        path(f"{side}_face_{offset}", offset, "m", face, lambda _, lengths=lengths: lengths)
        for side, by_offset in faces.items()
        for offset, lengths in by_offset.items()
    )
    return (*lines, *tips, *holes, *ends)


def _slot_curve(rotors: Rotors, at: PlacedSlide) -> Curve:
    """Return the area of a slide's slot to suction, on both bores together."""
    grid = _grid(rotors, slot_breakpoints(rotors, at))
    one, two = slot_areas(rotors, at, grid[0])
    return _curve(rotors, grid, "m^2", one + two)


def make_curves(
    rotors: Rotors, volume_ratio: float, axial_ratio: float | None = None, slide: SlideValve | None = None
) -> Curves:
    """Return all curves; suction closes where the volume is largest.

    The discharge port opens at a built-in volume ratio; with `axial_ratio` its part on the end face opens at that one.
    A slide valve moves the edge of the part on the bores, and opens a slot to suction.
    """
    closes, opens = rotors.largest[0], rotors.discharge_angle(volume_ratio)
    face_opens = opens if axial_ratio is None else rotors.discharge_angle(axial_ratio, "axial_volume_ratio")
    at = None if slide is None else placed_slide(rotors, slide, opens, face_opens)
    opens = opens if at is None else at.edge
    later = at is not None and at.closes is not None and at.closes > closes
    grooves = ports.uncovered_area(rotors)
    return Curves(
        rotors.life,
        _volume_curve(rotors),
        _suction_curves(rotors, grooves, closes),
        _discharge_curves(rotors, grooves, opens, face_opens),
        _paths(rotors, closes),
        closes - rotors.start,
        min(opens, face_opens) - rotors.start,
        None if at is None else _slot_curve(rotors, at),
        at.closes - rotors.start if at is not None and at.closes is not None and later else None,
    )


def closed_in(rotors: Rotors, curves: Curves) -> tuple[float, float]:
    """Return the volume at which a chamber is closed: over the largest volume, and over that where its port opens.

    It closes where suction ends or, if later, where it has passed the slot of a slide valve.
    """
    begins = curves.suction_closes if curves.compresses is None else curves.compresses
    one, two = rotors.volume(np.array([begins, curves.discharge_opens]) + rotors.start)
    return float(one) / rotors.largest[1], float(one / two)
