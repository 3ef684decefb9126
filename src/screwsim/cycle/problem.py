"""What is to be solved: a scene, what it names built and composed, the lines between which it works, the accuracy."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Any, NamedTuple

import numpy as np

from screwsim.build import Stock, Temperatures, completed, parts_of
from screwsim.cycle.continuation import Course
from screwsim.cycle.solution import Wanted, wanted_of
from screwsim.cycle.suction import SuctionState, suction_of
from screwsim.effects.base import SUCTION, FlowPath, Made, PressureLosses
from screwsim.figures import called_for
from screwsim.machine.protocol import MachineGeometry
from screwsim.model.composition import Composition
from screwsim.model.exchange import station
from screwsim.model.parts import Effects, Parts
from screwsim.model.series import Composer
from screwsim.model.slots import DENSITY, ENTHALPY
from screwsim.numerics.at_once import at_once
from screwsim.numerics.integrators import Rosenbrock, find_integrator
from screwsim.numerics.made import Entries, Entry
from screwsim.numerics.remembered import Remembered, once
from screwsim.outputs import Figure
from screwsim.scene.lines import Lines, lines, refrigerating_effect, suction_enthalpy
from screwsim.scene.types import Scene

Array = np.ndarray
NEARLY = 1e-6  # rad: angles so near to each other are one
LEAST_OIL = 1e-4  # oil per gas below which its change does not count


class Inlet(NamedTuple):
    """What is sucked in: density [kg/m³] and specific enthalpy [J/kg] in the suction line."""

    density: float
    enthalpy: float


@at_once
@dataclass(frozen=True, eq=False)
class Problem:
    """What is to be solved, and with which numbers every solution of it begins (`composition.P`, read-only).

    `entries` are the feedback unknowns: numbers that the cycle makes and that act back on it. `parameters` tell one
    problem of a series from the next.
    """

    scene: Scene
    parts: Parts
    composition: Composition
    lines: Lines
    inlet: Inlet
    suction: SuctionState
    entries: Entries
    parameters: Array
    wanted: Wanted

    @once
    def parted(self) -> float | None:
        """The angle [rad] beyond which no wide opening leads to the suction line; None where one does to the end.

        It is the injection angle, or where what else is open to that line has closed: the slot of a slide, a bore.
        """
        return _parted(self.parts.geometry, self.parts.effects)

    @once
    def rate(self) -> float:
        """Chambers born a second [1/s]."""
        return self.parts.omega / self.parts.geometry.pitch

    @once
    def pv(self) -> float:
        """p/ρ of the suction line [J/kg], the scale of work."""
        return self.lines.p_s / self.inlet.density

    @once
    def h_isentropic(self) -> float:
        """Enthalpy [J/kg] of the suction gas compressed to the discharge pressure at its entropy."""
        return _h_isentropic(self.parts, self.lines, self.inlet)

    @once
    def leaked(self) -> dict[bytes, Any]:
        """What leaks beside the chambers by the states of both lines, those last met: who reads a life asks often."""
        return {}

    @once
    def refrigerating_effect(self) -> float | None:
        """What a kilogram of refrigerant takes up in the evaporator [J/kg]; None where there is none."""
        return refrigerating_effect(self.scene)

    @once
    def called(self) -> dict[str, Figure]:
        """The figures that the scene calls for."""
        return called_for(self.scene, self.parts)

    def pressed(self, p: float) -> float:
        """Return p/(ρ_oil c_oil) [K], which a port state's oil temperature is higher by where oil takes room (M108)."""
        oil = self.parts.oil
        return p / (oil.density * oil.heat_capacity) if oil is not None and self.parts.oil_room else 0.0

    def gas_share(self, rho: float, ratio: float) -> float:
        """Return the gas's share of a volume, 1 where the oil takes no room (M106)."""
        return 1.0 / (1.0 + ratio * rho / self.parts.oil.density) if self.parts.oil and self.parts.oil_room else 1.0


Built = tuple[Stock, Composer]
shared: ContextVar[Built | None] = ContextVar("shared", default=None)  # of what is solved side by side


class Series:
    """What scenes solved one after the other leave to the next: what was built, what was composed, what closed."""

    def __init__(self, built: Built | None = None) -> None:
        self.stock, self.composer = built or shared.get() or (Stock(), Composer())
        self.course = Course()
        self.temperatures: Temperatures | None = None  # that effects.separator found last
        self.losses: PressureLosses | None = None  # of a package, found last
        self.sought: list[float] | None = None  # where other open numbers were found last (`screwsim.build.sought`)
        self.per_step: dict[str, float] = {}  # relative change of the figures by these, per kelvin or kPa
        self.around: tuple[Array | None, float] = None, 1.0  # Jacobian of these, and what the first guess left open


_free: list[Built] = []
KEPT = 32  # of them: so many threads may solve points


def one_alone() -> Series:
    """Return a series for one scene that has nothing to do with those before, but what was built and composed of them.

    That gives the numbers that building anew does. Whoever is done with it gives it back (`leave`).
    """
    if shared.get() is not None:
        return Series()
    try:
        return Series(_free.pop())  # one step of the interpreter's own
    except IndexError:
        return Series()


def leave(series: Series) -> None:
    """Keep what was built and composed for the next scene that is solved alone."""
    if shared.get() is None and len(_free) < KEPT:
        _free.append((series.stock, series.composer))


@contextmanager
def sharing() -> Iterator[None]:
    """Let all series that are begun within build and compose as one: scenes of the same sections share the parts."""
    before = shared.set((Stock(), Composer()))
    try:
        yield
    finally:
        shared.reset(before)


def problem_of(scene: Scene, series: Series | None = None, set_speed: float | None = None) -> Problem:
    """Return what a scene asks; `set_speed` [rad/s]: what was stated, where the scene's speed was found from it."""
    series = series or Series()
    scene = completed(scene, series.temperatures, series.losses, series.sought)
    station()
    parts, at = parts_of(scene, series.stock, set_speed), lines(scene)
    station()
    composition = _by(scene.numerics.integrator, series.composer.compose(parts))
    composition.P.flags.writeable = False
    station()
    dry = at.quality is None
    line = (
        parts.gas.port_state(at.p_s, at.T_s)
        if dry
        else parts.gas.port_state_of_enthalpy(at.p_s, suction_enthalpy(scene))
    )
    lost = 0.0 if scene.losses is None else scene.losses.before
    inlet, suction = Inlet(line[DENSITY], line[ENTHALPY]), suction_of(parts, line, lost)
    begins = suction.port_state(_h_isentropic(parts, at, inlet)) if suction.changed else line
    parameters = np.concatenate([composition.P, [*begins, at.p_d, *parts.geometry.outcomes]])
    of_oil = composition.carried, composition.dissolves
    lines_of = (*_discharge_line(*of_oil), *(_suction_line(*of_oil) if parts.suction_line else ()))
    entries = _entries((*lines_of, *(part.entry for _, part in parts.all(Made))))
    wanted = wanted_of(scene.numerics, tuple(composition.P[composition.widths].tolist()))
    return Problem(scene, parts, composition, at, inlet, suction, entries, parameters, wanted)


@Remembered
def _parted(geometry: MachineGeometry, effects: Effects) -> float | None:
    """Return what `Problem.parted` is, once a machine."""
    at, opens = geometry.injection_angle, geometry.discharge_opens
    wide = [path for _, path in effects.all(FlowPath) if path.to == SUCTION and not path.narrow]
    closed = max((max((*path.breakpoints, *path.own_breakpoints), default=at) for path in wide), default=at)
    if closed <= at + NEARLY:
        return at
    return closed if opens is None or closed < opens else None


def _h_isentropic(parts: Parts, at: Lines, inlet: Inlet) -> float:
    if at.quality is not None:
        return inlet.enthalpy + parts.gas.isentropic_work_of_enthalpy(at.p_s, at.p_d, inlet.enthalpy)
    return inlet.enthalpy + parts.gas.isentropic_work(at.p_s, at.p_d, at.T_s)


def _by(integrator: str, composition: Composition) -> Composition:
    """Return a composition that goes by an integrator; a check's own method is Rodas4."""
    found = find_integrator(integrator)
    if not isinstance(found, Rosenbrock):
        return composition
    text, together = found.into(composition.text), composition.together
    if text is composition.text:
        return composition
    return replace(composition, text=text, together=lambda: found.into(together()))


@cache
def _discharge_line(carried: bool, dissolves: bool) -> tuple[Entry, ...]:
    """Return the entries of the discharge line (M27): its enthalpy, and with carried oil its ratio and temperature.

    Where oil dissolves gas, also what it holds there (M230).
    """
    ratio = Entry("discharge_oil_ratio", floor=LEAST_OIL)
    oil = (ratio, Entry("discharge_oil_temperature", of=ratio.name)) if carried else ()
    if dissolves:
        oil = (*oil, Entry("discharge_held_gas", of=ratio.name, scale=1.0))
    return Entry("discharge_enthalpy"), *oil


@cache
def _suction_line(carried: bool, dissolves: bool) -> tuple[Entry, ...]:
    """Return the entries of a suction line that keeps what flows back (M270): its enthalpy, oil, gas held in that.

    The amounts are those of a kilogram of gas, over which their changes count: little of them is of little account.
    """
    amounts = ("suction_oil", "suction_held_gas")[: carried + dissolves]
    return Entry("suction_enthalpy"), *(Entry(name, scale=1.0) for name in amounts)


_entries = lru_cache(maxsize=8)(Entries)
