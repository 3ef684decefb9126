"""The problem to be solved: a scene, its built parts and composed module, the line states and the wanted accuracy."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from screwsim.build import PartsCache, completed, parts_of
from screwsim.cycle.continuation import Course
from screwsim.cycle.intake import IntakeState, intake_of
from screwsim.cycle.solution import ClosingCriteria, closing_criteria
from screwsim.cycle.surroundings import KnownSurroundings
from screwsim.effects.base import SUCTION, FlowPath, Made
from screwsim.figures import called_for
from screwsim.machine.protocol import MachineGeometry
from screwsim.model.composition import Composition
from screwsim.model.parts import Effects, Parts
from screwsim.model.run import Machinery
from screwsim.model.series import Composer
from screwsim.model.slots import DENSITY, ENTHALPY
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics.feedback_unknowns import FeedbackUnknown, FeedbackUnknowns
from screwsim.numerics.frozen import fast_init
from screwsim.numerics.identity_cache import IdentityCache, once
from screwsim.numerics.integrators import Rosenbrock, find_integrator
from screwsim.outputs import Figure
from screwsim.scene.lines import Lines, lines, refrigerating_effect, suction_enthalpy
from screwsim.scene.types import Scene

Array = np.ndarray
EQUAL_WITHIN = 1e-6  # rad, angles closer than this count as equal
LEAST_OIL = 1e-4  # oil per gas below which a relative change of it is ignored
LEAST_ENTHALPY = 0.5  # of c_p T_s: enthalpy of the suction gas below which its zero is in the way of logarithms


class Inlet(NamedTuple):
    """The gas in the suction line: density [kg/m³] and specific enthalpy [J/kg]."""

    density: float
    enthalpy: float


@fast_init
@dataclass(frozen=True, eq=False)
class Problem:
    """The problem to be solved; every solution of it starts from a copy of the numbers `composition.P` (read-only).

    `entries` are the feedback unknowns: numbers that the cycle determines and that act back on it (discharge line,
    effects' own). `parameters` are the coordinates of this problem among the others of a series, for extrapolation.
    """

    scene: Scene
    parts: Parts
    composition: Composition
    lines: Lines
    inlet: Inlet
    suction: IntakeState
    entries: FeedbackUnknowns
    parameters: Array
    criteria: ClosingCriteria

    @once
    def parted(self) -> float | None:
        """The angle [rad] at which chambers leave the suction line; None where a wide opening leads there to the end.

        It is the injection angle, or the angle at which the last other opening to that line (the slot of a
        slide, a bore) has closed.
        """
        return _parted(self.parts.geometry, self.parts.effects)

    @once
    def rate(self) -> float:
        """Chambers that begin their life per second [1/s]."""
        return self.parts.omega / self.parts.geometry.pitch

    @once
    def pv(self) -> float:
        """p/ρ of the suction line [J/kg], the scale of work."""
        return self.lines.p_s / self.inlet.density

    @once
    def h_isentropic(self) -> float:
        """Enthalpy [J/kg] of the suction gas compressed to the discharge pressure at its entropy."""
        return _h_isentropic(self.parts, self.lines, self.inlet)

    @property
    def enthalpy_shift(self) -> float:
        """What is added to enthalpies [J/kg] where they count as positive numbers (`enthalpy_shift`)."""
        return float(self.entries.shifts[0])

    @once
    def leaked(self) -> dict[bytes, Any]:
        """Cache of the leaks that bypass the chambers, by the states of both lines, as they are asked for often."""
        return {}

    @once
    def refrigerating_effect(self) -> float | None:
        """The heat that a kilogram of refrigerant takes up in the evaporator [J/kg]; None where there is none."""
        return refrigerating_effect(self.scene)

    @once
    def called(self) -> dict[str, Figure]:
        """The figures that the scene calls for."""
        return called_for(self.scene, self.parts)

    def oil_pressure_term(self, p: float) -> float:
        """Return p/(ρ_oil c_oil) [K], added to the oil temperature of a port state where oil takes room (M108)."""
        oil = self.parts.oil
        return p / (oil.density * oil.heat_capacity) if oil is not None and self.parts.oil_room else 0.0

    def gas_share(self, rho: Any, ratio: Any) -> Any:
        """Return the gas's share of a volume at ρ [kg/m³] and oil per gas, or arrays; 1 without room for oil (M106)."""
        return 1.0 / self.parts.volume_over_gas(rho, ratio)

    def gas_mass(self, rho: Any, ratio: Any, volume: Any) -> Any:
        """Return the gas [kg] at ρ [kg/m³] in a volume [m³] that it shares with oil (M106)."""
        return rho * self.gas_share(rho, ratio) * volume

    def density_in_flow(self, rho: Any, ratio: Any) -> Any:
        """Return ρ β² [kg/m³], the density of a port state with which gas flows through its share β (M107)."""
        return rho * self.gas_share(rho, ratio) ** 2


class ClosingTask(NamedTuple):
    """What is to be closed: a problem, the machinery that integrates it, and by which criteria."""

    problem: Problem
    machinery: Machinery
    criteria: ClosingCriteria


BuiltParts = tuple[PartsCache, Composer]
shared: ContextVar[BuiltParts | None] = ContextVar("shared", default=None)  # used by all series begun inside `sharing`


class Series:
    """What consecutive scenes pass on: built parts, composed modules, closed cycles and values that were solved for."""

    def __init__(self, built: BuiltParts | None = None) -> None:
        self.parts_cache, self.composer = built or shared.get() or (PartsCache(), Composer())
        self.course = Course()
        self.surroundings = KnownSurroundings()


_free: list[BuiltParts] = []
MOST_FREE = 32  # number of `_free` that are kept: as many threads may solve points at once


def series_of_one() -> Series:
    """Return a series for a single scene that reuses earlier built parts and composed modules, and nothing else.

    The result has the same numbers as with newly built parts. Hand the series back with `release_series` when done.
    """
    if shared.get() is not None:
        return Series()
    try:
        return Series(_free.pop())  # atomic in the interpreter, so safe among threads
    except IndexError:
        return Series()


def release_series(series: Series) -> None:
    """Keep the built parts and composed modules of a series for the next scene that is solved alone."""
    if shared.get() is None and len(_free) < MOST_FREE:
        _free.append((series.parts_cache, series.composer))


@contextmanager
def sharing() -> Iterator[None]:
    """Let all series begun inside share one stock of parts and one composer: equal sections are built once."""
    before = shared.set((PartsCache(), Composer()))
    try:
        yield
    finally:
        shared.reset(before)


def problem_of(scene: Scene, series: Series | None = None, set_speed: float | None = None) -> Problem:
    """Return a scene's problem; `set_speed` [rad/s] is the stated one where the scene's speed was derived from it."""
    series = series or Series()
    known = series.surroundings
    scene = completed(scene, known.temperatures, known.losses, known.sought)
    reach_station()
    parts, at = parts_of(scene, series.parts_cache, set_speed), lines(scene)
    reach_station()
    composition = _with_integrator(scene.numerics.integrator, series.composer.compose(parts))
    composition.P.flags.writeable = False
    reach_station()
    line = (
        parts.gas.port_state(at.p_s, at.T_s)
        if at.quality is None
        else parts.gas.port_state_of_enthalpy(at.p_s, suction_enthalpy(scene))
    )
    lost = 0.0 if scene.losses is None else scene.losses.before
    inlet, suction = Inlet(line[DENSITY], line[ENTHALPY]), intake_of(parts, line, lost)
    begins = suction.port_state(_h_isentropic(parts, at, inlet)) if suction.changed else line
    arriving = [parts.arriving_oil] if parts.oil is not None and parts.geometry.expands else []
    parameters = np.concatenate([composition.P, [*begins, at.p_d, *parts.geometry.outcomes, *arriving]])
    about = composition.carried, composition.dissolves, enthalpy_shift(parts.gas.c_p * at.T_s, inlet.enthalpy)
    lines_of = (*_discharge_line(*about), *(_suction_line(*about) if parts.suction_line else ()))
    entries = _entries((*lines_of, *(part.entry for _, part in parts.all(Made))))
    criteria = closing_criteria(scene.numerics, tuple(composition.P[composition.widths].tolist()))
    return Problem(scene, parts, composition, at, inlet, suction, entries, parameters, criteria)


@IdentityCache
def _parted(geometry: MachineGeometry, effects: Effects) -> float | None:
    """Return the value of `Problem.parted`, computed once for a machine and its effects."""
    at, opens = geometry.injection_angle, geometry.discharge_opens
    wide = [path for _, path in effects.all(FlowPath) if path.to == SUCTION and not path.narrow]
    closed = max((max((*path.breakpoints, *path.own_breakpoints), default=at) for path in wide), default=at)
    if closed <= at + EQUAL_WITHIN:
        return at
    return closed if opens is None or closed < opens else None


def _h_isentropic(parts: Parts, at: Lines, inlet: Inlet) -> float:
    """Return the enthalpy [J/kg] of the suction gas after isentropic compression to the discharge pressure."""
    if at.quality is not None:
        return inlet.enthalpy + parts.gas.isentropic_work_of_enthalpy(at.p_s, at.p_d, inlet.enthalpy)
    return inlet.enthalpy + parts.gas.isentropic_work(at.p_s, at.p_d, at.T_s)


def _with_integrator(integrator: str, composition: Composition) -> Composition:
    """Return a composition whose text uses the given integrator; for an integrator that is only a check, Rodas4."""
    found = find_integrator(integrator)
    if not isinstance(found, Rosenbrock):
        return composition
    text, together = found.into(composition.text), composition.together
    if text is composition.text:
        return composition
    return replace(composition, text=text, together=lambda: found.into(together()))


def enthalpy_shift(usual: float, h_s: float) -> float:
    """Return what is added to enthalpies [J/kg] so that they count as positive numbers: 0 for most fluids.

    Where the zero of enthalpy, which is arbitrary, leaves that of the suction gas h_s small or negative, the sum is
    `usual`, c_p T_s of an ideal gas.
    """
    return 0.0 if h_s > LEAST_ENTHALPY * usual else usual - h_s


@lru_cache(maxsize=8)
def _discharge_line(carried: bool, dissolves: bool, shift: float) -> tuple[FeedbackUnknown, ...]:
    """Return the unknowns of the discharge line (M27): its enthalpy; with carried oil its oil ratio and temperature.

    Where oil dissolves gas, also the dissolved gas (M230).
    """
    ratio = FeedbackUnknown("discharge_oil_ratio", floor=LEAST_OIL)
    oil = (ratio, FeedbackUnknown("discharge_oil_temperature", of=ratio.name)) if carried else ()
    if dissolves:
        oil = (*oil, FeedbackUnknown("discharge_held_gas", of=ratio.name, scale=1.0))
    return FeedbackUnknown("discharge_enthalpy", shift=shift), *oil


@lru_cache(maxsize=8)
def _suction_line(carried: bool, dissolves: bool, shift: float) -> tuple[FeedbackUnknown, ...]:
    """Return the unknowns of a suction line that mixes in backflow (M270): its enthalpy, oil, gas dissolved in the oil.

    The amounts are per kilogram of gas, and their changes count as they are, not relative to the amount.
    """
    amounts = ("suction_oil", "suction_held_gas")[: carried + dissolves]
    return FeedbackUnknown("suction_enthalpy", shift=shift), *(FeedbackUnknown(name, scale=1.0) for name in amounts)


_entries = lru_cache(maxsize=8)(FeedbackUnknowns)
