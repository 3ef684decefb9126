"""Solve for the intermediate pressure of two stages (docs/model.md M200–M202)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.build import package_of
from screwsim.cycle.problem import Series, release_series, series_of_one
from screwsim.effects import catalogue, stating
from screwsim.effects.base import CoolsOil, InSeparator
from screwsim.evaluate.cautions import inaccurate
from screwsim.fluid import constants
from screwsim.fluid.models import condenses
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.outputs.customary import in_bar, in_celsius
from screwsim.scene import Scene, cross_check, lines, with_values, without_sweep
from screwsim.scene.types import ActiveEffect, parameters_of_type
from screwsim.simulate import simulate_next
from screwsim.study.asked.varied import with_text
from screwsim.study.stages.axes import SOLVED, STAGE_NAMES, UNLOADED_STAGE
from screwsim.study.stages.figures import (
    ChainEnds,
    StagePair,
    chain_figures,
    delivery_temperature,
    without_free_air,
)
from screwsim.study.stages.result import ChainResult, chain_errors, delivery_temperature_figure, idle_cooler

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain

BRACKET_GROWTH = 1.25  # factor between successive pressures while the solution is being bracketed
LEAST_STAGE_RATIO = 1.02  # least pressure ratio of a stage that is tried
FLOW_TOLERANCE = 0.1  # of the wanted accuracy: difference of both flows at which the search ends
MOST_PAIRS = 40  # pairs of simulations
# of the way between both ends, in ln p: first points tried, until one succeeds
START_FRACTIONS = (0.5, 0.25, 0.75, 0.1, 0.9)
MOST_HALVINGS = 5  # halvings of the way back from a pressure at which a stage has no result
WET_TOLERANCE = 1e-6  # relative distance from the saturation temperature within which vapour counts as wet
_STATED = ("suction.superheat", "suction.quality", "evaporating_temperature", "condensing_temperature", "superheat")
_STATED += ("subcooling", "gas_cooler")


class Stop(Exception):
    """Reason why no pair of stages can be simulated further; `results` of the stages simulated so far."""

    def __init__(self, status: str, message: str, results: tuple[Result, ...] = ()) -> None:
        super().__init__(message)
        self.status, self.results = status, results


def _set_lines(scene: Scene, which: str, p_s: float, state: tuple[str, float], p_d: float) -> Scene:
    changed = _with_lines(scene, p_s, state, p_d)
    faults = cross_check(changed)
    if faults:
        raise Stop("failed", f"the {which} stage, {p_s / 1e5:.4g} to {p_d / 1e5:.4g} bar: {faults[0]}")
    return with_text(changed)


def _with_lines(scene: Scene, p_s: float, state: tuple[str, float], p_d: float) -> Scene:
    name, value = state  # of the suction gas, besides its pressure
    values: dict[str, Any] = {f"operation.{each}": None for each in _STATED}
    values |= {"operation.suction.temperature": None, "operation.suction.pressure": p_s}
    values |= {f"operation.suction.{name}": value}
    return with_values(without_sweep(scene), {**values, "operation.discharge.pressure": p_d})


def _with_separator(scene: Scene) -> Scene:
    """Return a scene with a separator for gas and oil: only the gas goes on to the other stage (M201)."""
    if scene.oil_supply is None or parameters_of_type(scene.effects, CoolsOil):
        return scene
    name = stating(CoolsOil)
    effect = catalogue()[name]
    parted = replace(scene, effects={**scene.effects, name: ActiveEffect(effect, effect.parameters())})
    stated = parameters_of_type(scene.effects, InSeparator)  # a file cannot state both
    return parted if stated else with_text(parted)


class ChainSolver(ChainEnds):
    """Solver of a chain, and of what lies between both stages.

    With `series` of both stages each cycle starts from those of its stage before, where these are close enough.
    """

    tried = 0  # pairs of stages

    def __init__(self, chain: StageChain, series: Mapping[str, Series] | None = None) -> None:
        super().__init__(chain)
        self._series = series or {}

    def pair(self, p: float, trace: bool = False) -> StagePair:
        """Return both stages at an intermediate pressure [Pa]; raise `Stop` where one has no result."""
        self.tried += 1
        try:
            return self._pair(p, trace)
        except UsageError as error:
            raise Stop("failed", f"at {p / 1e5:.4g} bar between the stages: {error}") from None

    def _pair(self, p: float, trace: bool) -> StagePair:
        between = self.chain.intercooler
        quality = self.low.quality
        state = ("temperature", self.low.T_s) if quality is None else ("quality", quality)
        scene = _with_separator(_set_lines(self.chain.first, "first", self.low.p_s, state, p))
        first = self._solved(scene, "first", trace)
        T_d = delivery_temperature(first)
        self._check_dry(p, T_d, first)
        vapour, T = self.between(p, T_d)
        out = p - between.pressure_drop
        if between.cools and T == between.outlet_temperature and self._is_liquid(out, T):
            what = f"the cooler leaves a liquid at {in_celsius(T)} and {in_bar(out)}"
            raise Stop("failed", f"{what} (choose a higher intercooler.outlet_temperature)", (first,))
        return self._with_second(p, scene, first, vapour, T, trace)

    def warmer(self, pair: StagePair, kelvin: float) -> StagePair:
        """Return a pair at the same pressure with the first stage's gas warmer by some kelvins."""
        first, second = pair.results
        changed = first.performance.copy()
        changed[delivery_temperature_figure(first)] += kelvin
        first = replace(first, performance=changed)
        vapour, T = self.between(pair.p, delivery_temperature(first))
        if T == pair.T:
            return pair._replace(results=(first, second), vapour=vapour)
        return self._with_second(pair.p, pair.scenes[0], first, vapour, T, True)

    def _with_second(self, p: float, scene: Scene, first: Result, vapour: float, T: float, trace: bool) -> StagePair:
        """Return a first stage with the second one at the suction temperature T [K].

        At the end (`trace`) it has a separator, or the pair says why gas and oil are not separated; nothing else in the
        chain depends on that separator.
        """
        out = p - self.chain.intercooler.pressure_drop
        other = _set_lines(self.chain.second, "second", out, ("temperature", T), self.high.p_d)
        parted, unparted = _with_separator(other) if trace else other, ""
        if parted is not other:
            second = simulate_next(self._series.get("second"), parted, trace)
            if second.status == "ok":
                return StagePair(p, (scene, parted), (first, second), vapour, T)
            unparted = second.message
        second = self._solved(other, "second", trace, (first,))
        return StagePair(p, (scene, other), (first, second), vapour, T, unparted)

    def _solved(self, scene: Scene, name: str, trace: bool, before: tuple[Result, ...] = ()) -> Result:
        if not getattr(package_of(scene), "delivers", True):
            raise Stop("failed", f"the {name} stage {UNLOADED_STAGE}", before)
        result = simulate_next(self._series.get(name), scene, trace)
        at = f"{lines(scene).p_s / 1e5:.4g} to {lines(scene).p_d / 1e5:.4g} bar"
        if result.status != "ok":
            raise Stop(result.status, f"the {name} stage, {at}: {result.message}", (*before, result))
        if result.performance.gas_mass_flow <= 0.0 or result.performance.discharge_temperature is None:
            raise Stop("failed", f"the {name} stage delivers nothing, {at}", (*before, result))
        return result

    def _check_dry(self, p: float, T_d: float, first: Result) -> None:
        """Raise `Stop` where the first stage delivers wet vapour: its temperature does not determine its enthalpy."""
        saturation = self.saturation(p) if self.chain.first.gas.equilibrium else None
        if saturation is not None and T_d <= saturation * (1.0 + WET_TOLERANCE):
            what = f"the first stage delivers wet vapour at {p / 1e5:.4g} bar"
            raise Stop("failed", f"{what} (use warmer or less oil there, or drier suction gas)", (first,))

    def between(self, p: float, T_d: float) -> tuple[float, float]:
        """Return vapour per unit of first-stage gas, and the suction temperature [K] of the second (M201, M202)."""
        between = self.chain.intercooler
        out = p - between.pressure_drop
        if between.cools:
            assert between.outlet_temperature is not None  # checked on reading
            throttled = self.gas.temperature(out, self.gas.enthalpy(p, T_d))
            return 0.0, min(throttled, between.outlet_temperature)
        if between.flashes:
            return self._beside_tank(p, T_d)
        return 0.0, self.gas.temperature(out, self.gas.enthalpy(p, T_d))

    def _beside_tank(self, p: float, T_d: float) -> tuple[float, float]:
        """Return vapour of a flash tank per unit of first-stage gas, and the second suction temperature [K] (M202)."""
        fluid, between = self.chain.first.gas.name, self.chain.intercooler
        try:
            self.liquid()
            T_e = constants.saturation_temperature(fluid, p)
        except UsageError:
            what = f"a flash tank at {p / 1e5:.4g} bar separates nothing: {fluid} has no saturation there"
            raise Stop("failed", f"{what} (choose kind: cooler, or a larger or faster second stage)") from None
        vapour, h_d, out = self.gas.vapour(p, T_e).h, self.gas.enthalpy(p, T_d), p - between.pressure_drop
        try:
            y = self.flashed(p, h_d - vapour if between.bathes else 0.0)
        except UsageError as error:
            raise Stop("failed", str(error)) from None
        if between.bathes:
            return y, self.gas.temperature(out, vapour) if out < p else T_e
        return y, self.gas.temperature(out, (h_d + y * vapour) / (1.0 + y))

    def _is_liquid(self, p: float, T: float) -> bool:
        """Return whether a real gas is liquid at p [Pa], T [K]."""
        saturation = self.saturation(p) if condenses(self.chain.first.gas) else None
        return saturation is not None and T < saturation

    # ---- the pressure ------------------------------------------------------------------------------------------

    def solve(self) -> StagePair:
        """Return the pair whose flows match (M200); raise `Stop` where none does."""
        drop = self.chain.intercooler.pressure_drop
        least, most = LEAST_STAGE_RATIO * self.low.p_s + drop, self.high.p_d / LEAST_STAGE_RATIO
        if not least < most:
            raise Stop("failed", self._no_room(drop if least - drop < most else 0.0))
        at = self._begun(least, most)
        guess = float(np.clip(at.p * np.exp(at.excess), least, most))
        a, b = self._enclosed(at, self._towards(guess, at) if guess != at.p else at, least, most)
        tolerance = FLOW_TOLERANCE * max(scene.numerics.accuracy for scene in at.scenes)
        while min(abs(a.excess), abs(b.excess)) > tolerance and self.tried < MOST_PAIRS:
            share = a.excess / (a.excess - b.excess)  # of the way in ln p, kept off the ends
            p = float(np.exp(np.log(a.p) + min(max(share, 0.02), 0.98) * np.log(b.p / a.p)))
            middle = self.pair(p)
            a, b = (middle, b) if middle.excess > 0.0 else (a, middle)
            if b.p / a.p < 1.0 + 1e-9:
                break
        best = min((a, b), key=lambda each: abs(each.excess))
        return self.pair(best.p, trace=True)

    def _no_room(self, drop: float) -> str:
        """Return why no pressure fits between both ends; `drop` [Pa] is that of the intercooler where it is why."""
        if drop > 0.0:
            what = f"intercooler.pressure_drop is {drop / 1e5:.4g} bar, which leaves no pressure between the stages"
            return f"{what} from {in_bar(self.low.p_s)} to {in_bar(self.high.p_d)} (choose a smaller one)"
        return "the second stage's discharge pressure is not above the first one's suction pressure"

    def _begun(self, least: float, most: float) -> StagePair:
        """Return a first pair with results, at the geometric mean of both ends if possible; raise its `Stop`."""
        stops: list[Stop] = []
        for share in START_FRACTIONS:
            try:
                return self.pair(float(np.sqrt(least * most)) if share == 0.5 else least * (most / least) ** share)
            except Stop as stop:
                stops.append(stop)
        raise stops[0]

    def _towards(self, p: float, here: StagePair) -> StagePair:
        """Return the pair at p [Pa], or as near to it from `here` as both stages have results; raise `Stop`."""
        stops: list[Stop] = []
        while len(stops) <= MOST_HALVINGS and self.tried < MOST_PAIRS:
            try:
                return self.pair(p)
            except Stop as stop:
                stops.append(stop)
                p = float(np.sqrt(p * here.p))
        if stops:
            less = here.excess > 0.0
            takes, small = ("less", "small or too slow") if less else ("more", "large or too fast")
            even = f"the second stage takes {takes} than the first one delivers even at {here.p / 1e5:.4g} bar"
            raise Stop(stops[0].status, f"{even}, so it is too {small}; beyond, {stops[0]}", stops[0].results)
        what = f"no intermediate pressure is found in {MOST_PAIRS} tries, the last at {here.p / 1e5:.4g} bar"
        raise Stop("failed", f"{what} (change one of the stages)", here.results)

    def _enclosed(self, one: StagePair, other: StagePair, least: float, most: float) -> tuple[StagePair, StagePair]:
        """Return two pairs around the solution: too much gas arrives at the lower pressure, too little at the other."""
        a, b = (one, other) if one.p <= other.p else (other, one)
        while a.excess < 0.0:
            if a.p <= least * (1.0 + 1e-12):
                raise Stop("failed", self._none("takes more", least, "smaller or slower"), a.results)
            a, b = self._towards(max(a.p / BRACKET_GROWTH, least), a), a
        while b.excess > 0.0:
            if b.p >= most * (1.0 - 1e-12):
                raise Stop("failed", self._none("takes less", most, "larger or faster"), b.results)
            a, b = b, self._towards(min(b.p * BRACKET_GROWTH, most), b)
        return a, b

    def _none(self, what: str, p: float, remedy: str) -> str:
        return (
            f"no intermediate pressure: the second stage {what} than the first one delivers even at {p / 1e5:.4g} bar "
            f"(make the second stage {remedy}, or the first one the other way)"
        )

    def errors(self, pair: StagePair) -> tuple[Figures, tuple[str, ...]]:
        """Return the estimated errors of the figures of the whole (M395), or a warning why there are none."""
        try:
            beside, warmer = partial(self.pair, trace=True), partial(self.warmer, pair)
            return chain_errors(pair, lambda each: chain_figures(self, each)[0], beside, warmer), ()
        except (Stop, UsageError) as stop:
            return Figures(), (f"the errors of the two-stage figures could not be estimated: {stop}",)


def chain_faults(chain: StageChain) -> tuple[str, ...]:
    """Return what does not fit together in a stage at any pressure between both that is tried first.

    Such a chain has no solution. What concerns the line between both is left to the solution, which finds that line.
    """
    try:
        low, high = lines(chain.first), lines(chain.second)
    except UsageError:
        return ()  # solving tells of it
    if not low.p_s < high.p_d:
        return ()  # likewise
    suction = ("temperature", low.T_s) if low.quality is None else ("quality", low.quality)
    pressures = [low.p_s * (high.p_d / low.p_s) ** share for share in START_FRACTIONS]
    trials = {
        "first": [_with_lines(chain.first, low.p_s, suction, p) for p in pressures],
        "second": [_with_lines(chain.second, p, ("temperature", high.T_s), high.p_d) for p in pressures],
    }
    found: list[str] = []
    for stage, scenes in trials.items():
        faults = [[each for each in cross_check(scene) if not each.path.startswith(SOLVED[stage])] for scene in scenes]
        found += [f"{stage}.{each}" for each in faults[0]] if all(faults) else []
    return tuple(found)


def run_stages(chain: StageChain, warm: bool = False) -> ChainResult:
    """Return both stages at the intermediate pressure at which their flows match; a status where there is none.

    With `warm` the cycles of the search start from one another, for a quarter to a half less work. Figures differ by
    less than the accuracy from those of the stages alone.
    """
    series = {name: series_of_one() for name in (STAGE_NAMES if warm else ())}
    try:
        return _run(chain, series)
    except Stop as stop:
        return ChainResult(stop.status, str(stop), stop.results)
    except UsageError as error:
        return ChainResult("failed", str(error))
    finally:
        for each in series.values():
            release_series(each)


def _run(chain: StageChain, series: Mapping[str, Series]) -> ChainResult:
    solving = ChainSolver(chain, series)
    pair = solving.solve()
    found, notes = chain_figures(solving, pair)
    bound = max(scene.numerics.accuracy for scene in pair.scenes)
    status, message = "ok", ""
    if found.flow_mismatch > bound:
        status, message = "not_closed", f"the flows of the two stages differ by {found.flow_mismatch:.2g} (relative)"
    error, warnings = solving.errors(pair)
    warnings = (*idle_cooler(chain.intercooler, pair.T), *(warnings or inaccurate(bound, error)))
    stages = pair.results[0], without_free_air(pair.results[1])
    return ChainResult(status, message, stages, pair.scenes, found, notes, error, warnings)
