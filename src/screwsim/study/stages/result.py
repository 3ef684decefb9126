"""Results of two stages together: record, capacities and COP, numerical errors (docs/model.md M203, M395, M410)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from screwsim.evaluate.performance import NO_POWER, heating, parted
from screwsim.figures import Performance
from screwsim.figures.errors import error_in_unit, error_scale, zeros_for_none
from screwsim.inputs.faults import UsageError
from screwsim.outputs import STAGES, Figures, Result
from screwsim.outputs.customary import in_celsius
from screwsim.outputs.display import picked
from screwsim.scene import Scene, lines
from screwsim.study.stages.axes import STAGE_NAMES, Intercooler

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain
    from screwsim.study.stages.figures import StagePair

PRESSURE_STEP = 1.02  # factor of the pressure between the stages, for the slopes by that pressure
TEMPERATURE_STEP = 1.0  # K, warming of the first stage's gas, for the slopes by its temperature
ELECTRICAL, NO_ELECTRICAL = "electrical_power", "the electrical power is not positive"
STAGE_FIGURES = (
    *("gas_mass_flow", "shaft_power", ELECTRICAL, "fan_power"),
    *("discharge_temperature", "separator_temperature", "oil_cooler_duty"),
)


@dataclass(frozen=True)
class ChainResult:
    """Results of two stages together; `performance` has the names of M200–M203, `stages` the results of both."""

    status: str
    message: str = ""
    stages: tuple[Result, ...] = ()
    scenes: tuple[Scene, ...] = ()
    performance: Figures = field(default_factory=Figures)
    notes: Mapping[str, str] = field(default_factory=dict)  # why a figure is None
    error: Figures = field(default_factory=Figures)  # estimated, of each figure over its scale (M395)
    warnings: tuple[str, ...] = ()  # of the whole; those of a stage are in its result
    uncertainty: Mapping[str, Any] = field(default_factory=dict)  # by the inputs of both, where they have tolerances

    def as_result(self) -> WholeResult:
        """Return the figures of the whole as the result of one machine, with the warnings of both stages."""
        named = zip(STAGE_NAMES, self.stages, strict=False)
        warnings = (*self.warnings, *(f"{which} stage: {text}" for which, each in named for text in each.warnings))
        figures = {"performance": self.performance, "error": self.error, "uncertainty": self.uncertainty}
        return WholeResult(self.status, self.message, warnings, notes=self.notes, **figures, whole=self)

    def as_json(self) -> dict[str, Any]:
        """Return what `run --json` prints for two stages."""
        own = picked(self, "status", "message", "warnings", "performance", "error", "notes")
        own |= {"uncertainty": dict(self.uncertainty)} if self.uncertainty else {}
        return own | {"stages": [result.as_json() for result in self.stages]}


@dataclass(frozen=True, eq=False, repr=False)
class WholeResult(Result):
    """Figures of two stages together as the result of one machine, and the `whole` that they are of."""

    whole: ChainResult = field(default=ChainResult("failed"), compare=False)


def solution_of(result: Result, chain: StageChain) -> ChainResult:
    """Return the solution of two stages that a result is of.

    Raise UsageError for that of one machine, and of two whose machines, speeds or outer pressures are others.
    """
    if not isinstance(result, WholeResult):
        raise UsageError("result: belongs to one machine, and here are two stages (leave it out)")
    for (stage, here), there in zip(chain.by_stage.items(), result.whole.scenes, strict=False):
        same = here.machine == there.machine and here.operation.speed == there.operation.speed
        outer = "p_s" if stage == STAGE_NAMES[0] else "p_d"
        if not (same and getattr(lines(here), outer) == getattr(lines(there), outer)):
            what = f"belongs to two other stages: the {stage} one has another machine, speed or outer pressure"
            raise UsageError(f"result: {what} (pass that of these two, or none)")
    return result.whole


def figures_of_both(values: Mapping[str, Any]) -> Performance:
    """Return figures of two stages together with their declarations."""
    return Performance(values, {name: STAGES[name] for name in values})


FiguresAndReasons = tuple[dict[str, float | None], dict[str, str]]  # figures, and why some are None


def capacities(
    cooling: float,
    power: float,
    second: Mapping[str, Any],
    rejected: float | None,
    unparted: str = "",
    beyond: float | str = 0.0,
) -> FiguresAndReasons:
    """Return both capacities [W] and their COP relative to the power of both stages [W], or None with the reason.

    `second` has the figures of the second stage, whose gas gives off `rejected` [J/kg] in the condenser, and the vapour
    of a tank `beyond` [W] besides; `rejected` is None where gas and oil are not separated, for the reason `unparted`.
    """
    cop = cooling / power if power > 0.0 else None
    heat = unparted if rejected is None else rejected
    given = heating({"shaft_power": power}, second["gas_mass_flow"], heat, beyond)
    warming, reasons = parted(given)
    notes = reasons if cop is not None else {"cop": NO_POWER, **reasons}
    return {"cooling_capacity": cooling, "cop": cop, **warming}, notes


def electrical_figures(
    results: tuple[Result, Result], found: Mapping[str, float | None], reasons: Mapping[str, str]
) -> FiguresAndReasons:
    """Return the electrical power [W] of both stages and the COP of the capacities found; none without any motor.

    With one motor alone they have no value, and this reason. A COP whose capacity has no value has none either, for
    the same one of the `reasons`.
    """
    if not any(ELECTRICAL in each.performance for each in results):
        return {}, {}
    powers = [each.performance.get(ELECTRICAL) for each in results]
    power = None if None in powers else sum(each for each in powers if each is not None)
    unknown = NO_ELECTRICAL if power is not None else next(_why_no_power(results))
    given: dict[str, float | str | None] = {ELECTRICAL: unknown if power is None else power}
    for name, capacity in (("electrical_cop", "cooling_capacity"), ("electrical_heating_cop", "heating_capacity")):
        if capacity in found:
            value = found[capacity]
            of_power = value / power if value is not None and power is not None and power > 0.0 else unknown
            given[name] = reasons[capacity] if value is None else of_power
    return parted(given)


def _why_no_power(results: tuple[Result, Result]) -> Iterator[str]:
    """Yield the reason of each stage without electrical power."""
    for which, each in zip(STAGE_NAMES, results, strict=True):
        if ELECTRICAL not in each.performance:
            yield f"the {which} stage has no motor (give it one as well)"
        elif each.performance[ELECTRICAL] is None:
            yield f"{which} stage: {each.notes.get(ELECTRICAL, 'its motor has no electrical power')}"


def chain_errors(
    pair: StagePair,
    figures: Callable[[StagePair], Mapping[str, Any]],
    beside: Callable[[float], StagePair],
    warmer: Callable[[float], StagePair],
) -> Figures:
    """Return the estimated error of each figure of a chain, over its scale; empty where a stage has no estimates.

    `figures` returns the figures of a pair of stages, `beside` the pair at another pressure [Pa] between them, `warmer`
    the pair at the same pressure with the gas from the first stage warmer by some kelvins.
    """
    if not all(result.error for result in pair.results):
        return Figures()
    found = figures(pair)
    off, left = dict.fromkeys(found, 0.0), abs(pair.excess)
    for which, name, error in _stage_errors(pair.results):
        hands_on = which == 0 and name == delivery_temperature_figure(pair.results[0])
        other = warmer(TEMPERATURE_STEP) if hands_on else _with_changed_figure(pair, which, name, error)
        share = error / TEMPERATURE_STEP if hands_on else 1.0
        left += share * abs(other.excess - pair.excess)
        off = {key: off[key] + share * size for key, size in _figure_changes(found, figures(other)).items()}
    other = beside(pair.p * PRESSURE_STEP)
    shift = left / max(abs(other.excess - pair.excess), 1e-300)  # fraction of the step to that other pressure
    by_pressure = _figure_changes(found, figures(other))
    known = zeros_for_none(found)
    scales = {name: STAGES[name].scale for name, value in found.items() if value is not None}
    sizes = {name: error_scale(name, scale, known) for name, scale in scales.items() if not scale.unasked}
    errors = {name: off[name] + shift * by_pressure[name] for name in found}
    return Figures({name: by / max(sizes[name], 1e-300) if name in sizes else None for name, by in errors.items()})


def delivery_temperature_figure(first: Result) -> str:
    """Return the figure that is the temperature of the first stage's gas: behind its separator, where it has oil."""
    separated = first.performance.get("separator_temperature") is not None
    return "separator_temperature" if separated else "discharge_temperature"


def _stage_errors(results: tuple[Result, ...]) -> Iterator[tuple[int, str, float]]:
    """Yield stage, name and error, in its own unit, of each figure that enters those of the whole."""
    for which, result in enumerate(results):
        for name in STAGE_FIGURES:
            error = error_in_unit(name, result.performance, result.error)
            if error is not None:
                yield which, name, error


def _with_changed_figure(pair: StagePair, which: int, name: str, error: float) -> StagePair:
    """Return a pair with one figure of a stage increased by its error."""
    result = pair.results[which]
    performance = result.performance.copy()
    performance[name] += error
    results = list(pair.results)
    results[which] = replace(result, performance=performance)
    return pair._replace(results=(results[0], results[1]))


def _figure_changes(found: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, float]:
    """Return the differences between two chains' figures; zero where one is missing."""
    pairs = ((name, value, other.get(name)) for name, value in found.items())
    return {name: 0.0 if value is None or its is None else abs(its - value) for name, value, its in pairs}


def idle_cooler(between: Intercooler, T: float) -> tuple[str, ...]:
    """Return a warning where the gas reaches the cooler, and leaves it at T [K], colder than it is to leave (M201)."""
    wanted = between.outlet_temperature
    if wanted is None or T >= wanted:
        return ()
    what = f"the intercooler cools nothing: the gas arrives at {in_celsius(T)}, below its outlet_temperature"
    return (f"{what} of {in_celsius(wanted)} (choose a lower intercooler.outlet_temperature, or kind: none)",)
