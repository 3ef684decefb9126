"""One scene made ready: its machinery, and the states of the lines between which it works."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim import performance
from screwsim.build import Stock, build_parts, wanted_of
from screwsim.effects.base import Made
from screwsim.intake import suction_of
from screwsim.model import leases, residues
from screwsim.model.compose import Composer, Composition
from screwsim.model.continuation import Course
from screwsim.model.slots import (
    DENSITY,
    ENTHALPY,
    R_INJECTED,
    R_PRESSURE,
)
from screwsim.numerics.integrators import Rosenbrock, find_integrator
from screwsim.numerics.made import Entries, Entry
from screwsim.scene.lines import lines, suction_enthalpy
from screwsim.scene.types import Scene


@lru_cache(maxsize=8)
def _entries(entries: tuple[Entry, ...]) -> Entries:
    return Entries(entries)


def _by(integrator: str, composition: Composition) -> Composition:
    """Return a composition that goes by an integrator; a check's own method is Rodas4."""
    found = find_integrator(integrator)
    if not isinstance(found, Rosenbrock):
        return composition
    text = found.into(composition.text)
    return composition if text is composition.text else replace(composition, text=text)


class Series:
    """What the scenes of a series leave to the next: what was built, what was composed, the cycles that closed."""

    def __init__(self) -> None:
        self.stock, self.composer, self.course = Stock(), Composer(), Course()


class Prepared:
    """A scene, what it names built, its own machinery, its lines, and what is asked of the closing.

    Any number of them live side by side, in any number of threads; only those of one series go one after the other.
    """

    def __init__(self, scene: Scene, series: Series | None = None, set_speed: float | None = None) -> None:
        """Prepare a scene; `set_speed` [rad/s]: what was stated, where the scene's speed was found from it."""
        self.scene = scene
        self._read: dict[tuple[Any, ...], dict[str, Any]] = {}  # of the last two histories
        self.moved: Any = None  # the curve of the speed that the drive made last (model.speed)
        self.series = series or Series()
        self.course = self.series.course
        self.parts = build_parts(scene, self.series.stock, set_speed)
        self.wanted = wanted_of(scene)
        self.lines = lines(scene)
        self.machinery = leases.lease(_by(scene.numerics.integrator, self.series.composer.compose(self.parts)))
        line = self._suction_place()
        self.inlet = performance.Inlet(line[DENSITY], line[ENTHALPY])
        self.suction = suction_of(self.parts.gas, line, self.parts.effects.values())
        begins = self.suction.place(self._h_isentropic()) if self.suction.changed else line
        self.pv = self.lines.p_s / self.inlet.density
        # what tells one scene from the next on a course; tightening changes the composition's own copy
        P, outcomes = self.machinery.composition.P, self.parts.geometry.outcomes
        self.parameters = np.concatenate([P, [*begins, self.lines.p_d, *outcomes]])
        c_oil = self.parts.oil.heat_capacity if self.parts.oil else 0.0
        self.balances = residues.Balances(self.machinery, c_oil, self._oil_in)
        line_entries = residues.discharge_line(self.machinery.composition.carried, self.parts.dissolves)
        self.entries = _entries((*line_entries, *(part.entry for _, part in self.parts.all(Made))))

    def release(self) -> None:
        """Give the working arrays to whoever needs the like next; what is read of a cycle is read before."""
        machinery = self.machinery
        del self.machinery, self.balances  # nobody reads what another one writes
        leases.give_back(machinery)

    def _suction_place(self) -> tuple[float, ...]:
        """Return the place of the suction line; wet where the scene gives a quality."""
        gas, at = self.parts.gas, self.lines
        if at.quality is None:
            return gas.place(at.p_s, at.T_s)
        return gas.place_of_enthalpy(at.p_s, suction_enthalpy(self.scene))

    def _oil_in(self) -> tuple[float, float]:
        """Return the oil [kg] injected at one angle, and its enthalpy over its heat capacity [K]."""
        R, oil = self.machinery.R, self.parts.oil
        if oil is None:
            return 0.0, 0.0
        return float(R[R_INJECTED]), oil.temperature + self._pressed(max(oil.source_pressure, float(R[R_PRESSURE])))

    def _pressed(self, p: float) -> float:
        """Return p/(ρ_oil c_oil) [K], by which a place's oil temperature is higher where the oil takes room (M108)."""
        oil = self.parts.oil
        return p / (oil.density * oil.heat_capacity) if oil is not None and self.parts.oil_room else 0.0

    def _share(self, rho: float, ratio: float) -> float:
        """Return the gas's share of a volume, 1 where the oil takes no room (M106)."""
        return 1.0 / (1.0 + ratio * rho / self.parts.oil.density) if self.parts.oil and self.parts.oil_room else 1.0

    def _h_isentropic(self) -> float:
        lines = self.lines
        if lines.quality is not None:
            return self.inlet.enthalpy + self.parts.gas.isentropic_work_of_enthalpy(
                lines.p_s, lines.p_d, self.inlet.enthalpy
            )
        return self.inlet.enthalpy + self.parts.gas.isentropic_work(lines.p_s, lines.p_d, lines.T_s)

    @property
    def lives_per_second(self) -> float:
        """Return how many chambers are born a second [1/s]."""
        return self.parts.omega / self.parts.geometry.pitch
