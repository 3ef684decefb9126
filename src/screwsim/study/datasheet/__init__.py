"""Data sheet of a scene, in the form that its trade uses: each kind has its modules, all produce the same `Sheet`."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any, NamedTuple

from screwsim.build import package_of
from screwsim.figures import declared
from screwsim.figures.engineering import shown_name
from screwsim.inputs.faults import UsageError
from screwsim.outputs import EFFICIENCY, Result
from screwsim.results.left_out import left_out_words
from screwsim.scene import Scene, without_sweep
from screwsim.study.datasheet.air_pressures import OPTION as OUTLETS
from screwsim.study.datasheet.air_year import Demand, read_profile
from screwsim.study.datasheet.bounds import limits_of
from screwsim.study.datasheet.load_unload import BAND_OPTION, Receiver, read_receiver
from screwsim.study.datasheet.load_unload import OPTION as RECEIVER
from screwsim.study.datasheet.sheet import Sheet
from screwsim.study.datasheet.units import BY_NAME
from screwsim.study.pool.progress import Progress
from screwsim.study.stages.chain import StageChain

__all__ = ["Sheet", "SheetOptions", "sheet_of"]

BY_TEMPERATURE, BY_PRESSURE = ("--evaporating", "--condensing"), ("--suction", "--discharge")
RANGE_OPTIONS = *BY_TEMPERATURE, *BY_PRESSURE
REFRIGERATES, STATES = "a refrigeration machine", "a machine whose lines are stated by pressures"
AIR_PACKAGE = "an air package"
OPTIONS_BY_KIND = (
    dict.fromkeys((*BY_TEMPERATURE, "--heating"), REFRIGERATES)
    | {"--limit": "one machine, or two stages of another gas"}
    | dict.fromkeys(BY_PRESSURE, STATES)
    | dict.fromkeys(("--profile", RECEIVER, BAND_OPTION), AIR_PACKAGE)
)
FIGURES = (
    *("gas_mass_flow", "free_air_delivered", "cooling_capacity", "shaft_power", "electrical_power", "cop"),
    *("specific_power", "package_specific_power"),
)


class SheetOptions(NamedTuple):
    """What is asked of a sheet: ranges by option ('--evaporating'), limits, heating, profile …; see `sheet_of`."""

    ranges: Mapping[str, str | None] = MappingProxyType({})
    limits: Sequence[str] = ()
    heating: bool = False
    profile: str | None = None
    jobs: int | None = None
    progress: Progress | None = None
    units: str = "metric"
    receiver: str | None = None
    band: str | None = None

    @property
    def of_points(self) -> dict[str, Any]:
        """The options that no air package takes."""
        return {**self.ranges, "--limit": tuple(self.limits) or None, "--heating": self.heating or None}

    @property
    def of_packages(self) -> dict[str, Any]:
        """The options that only air packages take."""
        return {"--profile": self.profile, RECEIVER: self.receiver, BAND_OPTION: self.band}

    @property
    def demands(self) -> tuple[Demand, ...]:
        """The demands of the profile; raise UsageError where it cannot be read."""
        return () if self.profile is None else read_profile(self.profile)

    @property
    def storage(self) -> Receiver | None:
        """The receiver on which a package loads and unloads; raise UsageError where it cannot be read."""
        found = read_receiver(self.receiver, self.band)
        if found is not None and self.profile is None:
            raise UsageError(f"{RECEIVER}: is that of the demands of --profile (add --profile LOADS.csv)")
        return found


def sheet_of(subject: Scene | StageChain, asked: SheetOptions) -> Sheet:
    """Return the data sheet of a scene, or of two stages in series.

    Raises UsageError, in one line, where the scene leaves open what is rated, or for what does not belong to it.

    For a refrigeration machine --evaporating and --condensing are ranges ('-10 degC..10 degC') that replace those of
    the scene's sweep; for a gas compressor or an expander, whose scenes state pressures, --suction and --discharge are
    ('4 bar..6 bar'). `limits` state what must hold ('discharge_temperature<110 degC'); `heating` adds the tables of a
    heat pump. An air package (of two stages: air with two motors) takes none of these, but a `profile`, a CSV file of
    flows and hours, met from a `receiver` within its `band`, and one of a single stage limits of temperatures, for its
    hottest room. Where a scene states tolerances, or names the validation of its model, lines give the resulting
    uncertainties of its own point. `units` is 'metric' or 'us'; the document is in SI units in any case.
    """
    sheet = _sheet_of_scene(subject, asked) if isinstance(subject, Scene) else _sheet_of_stages(subject, asked)
    own = _own_point(subject)
    return sheet if own is None else _with_uncertainty_lines(sheet, own)


def _sheet_of_scene(scene: Scene, asked: SheetOptions) -> Sheet:
    if package_of(scene) is not None and scene.gas.is_air:
        from screwsim.study.datasheet.air_rating import rating as air_rating
        from screwsim.study.datasheet.air_sheet import air_sheet
        from screwsim.study.datasheet.hottest_room import room_limits

        taken = dict.fromkeys(("--limit", OUTLETS))
        _refuse_unused_options({**asked.of_points, **taken}, "the scene is an air package")
        demands, bounds = asked.demands, room_limits(scene, asked.limits)
        rated = air_rating(scene, asked.progress, bounds, asked.storage, asked.ranges.get(OUTLETS))
        return air_sheet(scene, replace(rated, units=BY_NAME[asked.units]), demands)
    _refuse_unused_options(asked.of_packages, "the scene is not one")
    from screwsim.study.datasheet.rated import rating

    ranges, bounds, units = asked.ranges, limits_of(scene, asked.limits), BY_NAME[asked.units]
    operation = scene.operation
    states_lines = operation.condensing_temperature is not None or operation.gas_cooler is not None
    if states_lines and not scene.machine.expands:
        from screwsim.study.datasheet.refrigeration_sheet import rating_request, refrigeration_sheet

        pressures = {name: ranges.get(name) for name in BY_PRESSURE}
        _refuse_unused_options(pressures, "the scene states saturation temperatures")
        request = rating_request(
            scene, ranges.get("--evaporating"), ranges.get("--condensing"), bounds, units, asked.heating
        )
        return refrigeration_sheet(rating(request, asked.jobs, asked.progress), asked.heating)
    from screwsim.study.datasheet import gas_sheet

    options = gas_sheet.options_of(scene)
    stated = "pressures" if "--suction" in options else "saturation temperatures"
    unused: dict[str, Any] = {name: text for name, text in ranges.items() if name not in options}
    _refuse_unused_options({**unused, "--heating": asked.heating or None}, f"the scene states {stated}")
    request = gas_sheet.rating_request(scene, ranges, bounds, units)
    return gas_sheet.gas_sheet(rating(request, asked.jobs, asked.progress))


def _sheet_of_stages(chain: StageChain, asked: SheetOptions) -> Sheet:
    from screwsim.study.datasheet import stages_rating as rating
    from screwsim.study.datasheet.stages_air import air_stages_sheet, is_air_package

    units = BY_NAME[asked.units]
    if is_air_package(chain):
        _refuse_unused_options({**asked.of_points, OUTLETS: None}, "the stages compress air as a package")
        at = asked.ranges.get(OUTLETS)
        return air_stages_sheet(chain, asked.demands, asked.storage, asked.jobs, asked.progress, units, at)
    _refuse_unused_options(asked.of_packages, "the two stages are not one (air, and a motor in both)")
    from screwsim.study.datasheet.stages_sheet import stages_sheet

    options = rating.axis_options(chain)
    unused: dict[str, Any] = {name: text for name, text in asked.ranges.items() if name not in options}
    unused |= {} if rating.refrigerates(chain) else {"--heating": asked.heating or None}
    _refuse_unused_options(unused, f"these two stages are rated over {' and '.join(options)}")
    request = rating.rating_request(chain, asked.ranges, limits_of(chain, asked.limits), units, asked.heating)
    return stages_sheet(rating.rating(request, asked.jobs, asked.progress), asked.heating)


def _own_point(subject: Scene | StageChain) -> Result | None:
    """Return the own point with its uncertainties, each part by itself; None where no scene states any."""
    if isinstance(subject, Scene):
        from screwsim.simulate import simulate
        from screwsim.study.uncertainty.point import with_uncertainty

        asked = subject.uncertain or subject.model_error
        return with_uncertainty(subject, simulate(subject, trace=False)) if asked else None
    from screwsim.study.stages.solve import run_stages
    from screwsim.study.uncertainty.spreads import tolerances_of
    from screwsim.study.uncertainty.stages import with_uncertainty as of_both

    base = without_sweep(subject)
    return of_both(base, run_stages(base)).as_result() if tolerances_of(subject).uncertain else None


def _with_uncertainty_lines(sheet: Sheet, result: Result) -> Sheet:
    """Return a sheet with lines on the uncertainties of the result at its own point."""
    if result.status != "ok":
        return replace(sheet, lines=[*sheet.lines, ("uncertain", f"not known: {result.told}")])
    told, model = result.uncertainty, result.uncertainty.get("model", {})
    lines = [("uncertain", _input_uncertainties(result, told))] if "figures" in told else []
    lines += [("model", _model_uncertainty(result, model))] if model else []
    return replace(sheet, lines=[*sheet.lines, *lines], document={**sheet.document, "uncertainty": told})


def _input_uncertainties(result: Result, uncertainty: Mapping[str, Any]) -> str:
    figures, lost = uncertainty["figures"], left_out_words(list(uncertainty["left_out"]))
    known = [name for name in FIGURES if name in figures and result.performance[name]]
    shares = (100.0 * figures[name]["expanded"] / abs(result.performance[name]) for name in known)
    parts = [f"{shown_name(name)} ± {share:.2g} %" for name, share in zip(known, shares, strict=True)]
    told = "at the scene's point, 95 %, by the tolerances of the inputs alone"
    told += f"; {lost}, so too small" if lost else ""
    return f"{', '.join(parts)} {told}" if parts else "nothing is known for these figures"


def _model_uncertainty(result: Result, model: Mapping[str, Any]) -> str:
    """Return the interval of the model error, in points for efficiencies, relative to their size for other figures."""
    parts = []
    for name, each in model["figures"].items():
        about, size = declared(name, result.performance), abs(result.performance[name])
        factor, unit = (100.0, "points") if about.scale == EFFICIENCY else (100.0 / size, "%")
        ends = " … ".join(f"{factor * each[end]:+.2g}" for end in ("low", "high"))
        parts.append(f"{shown_name(name)} {ends} {unit}")
    outside = f"; this scene lies outside: {'; '.join(model['outside'])}" if model["outside"] else ""
    return f"computed less measured, {', '.join(parts) or 'no figure of this scene'} by validate {model['of']}{outside}"


def _refuse_unused_options(given: Mapping[str, Any], why: str) -> None:
    """Raise UsageError where an option is given that the scene has no use for."""
    wrong = next((option for option, value in given.items() if value is not None), None)
    if wrong is not None:
        raise UsageError(f"{wrong}: belongs to {OPTIONS_BY_KIND[wrong]}, and {why} (remove it)")
