"""Studies for use from Python: they take scenes and results in any form, return values in SI units, and show progress.

Each function is the study of the command of the same name and takes the same arguments.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.export.map_table import MapTable
from screwsim.export.source import is_results, map_of_results, map_of_scene, refuse_changes
from screwsim.inputs.arguments import (
    FILE,
    FLAG,
    MAPPING,
    NUMBER,
    QUANTITY,
    TEXT,
    TEXTS,
    as_list,
    checked_arguments,
    one_of,
    whole,
)
from screwsim.inputs.faults import UsageError
from screwsim.report.datasheet import check_sheet, write_sheet
from screwsim.results import Results, open_results
from screwsim.scene import SceneLike, without_sweep
from screwsim.study import compare as _compare
from screwsim.study.asked.spans import read_ranges
from screwsim.study.best import optimum as _optimum
from screwsim.study.calibration import calibrate as _calibrate
from screwsim.study.calibration import read_fit
from screwsim.study.calibration.answers import Posterior
from screwsim.study.calibration.diagnosis import PRIOR_PAIR_ODDS, PRIOR_UNCHANGED, Diagnosis
from screwsim.study.calibration.diagnosis import diagnose as _diagnose
from screwsim.study.calibration.fit import Fit
from screwsim.study.calibration.plan import COUNT, LEVELS, Plan, candidates_of
from screwsim.study.calibration.plan import plan as _plan
from screwsim.study.calibration.predict import points_to_predict
from screwsim.study.calibration.predict import posterior_with_predictions as _sampled
from screwsim.study.calibration.solve import Calibration
from screwsim.study.datasheet import RANGE_OPTIONS, Sheet, SheetOptions, sheet_of
from screwsim.study.maps import performance_map as _map
from screwsim.study.pool.progress import Progress, progress_of
from screwsim.study.stages import scene_or_stages
from screwsim.study.sweep import run_sweep
from screwsim.study.uncertainty.sobol import Sensitivity
from screwsim.study.uncertainty.sobol import sensitivity as _indices

ResultsLike = Results | str | os.PathLike[str]


@checked_arguments(path=TEXT, low=QUANTITY, high=QUANTITY)
def optimum(
    scene: SceneLike,
    path: str = _optimum.OIL_RATIO,
    figure: str | None = None,
    *,
    low: float | str | None = None,
    high: float | str | None = None,
    minimum: bool = False,
    jobs: int | None = None,
    progress: Progress | bool | None = None,
) -> list[_optimum.Best]:
    """Return the best value of a path for each point of the scene's other axes (`screwsim optimum`).

        best, = screwsim.optimum("point.yaml", "oil_supply.ratio", low=0.5, high=4)
        best, = screwsim.optimum("plant.stages.yaml", "second.operation.speed=1000 rpm..2000 rpm")

    `low` and `high` are numbers or texts with a unit; the default is the range of the scene's own axis. The default
    figure is the efficiency that the command uses. `progress`: None shows a bar in a notebook only.
    """
    at = scene_or_stages(scene)
    ends = {"first": None if low is None else str(low), "last": None if high is None else str(high)}
    asked = _optimum.question(at, path, figure, minimum=minimum, **ends)
    return _optimum.optimum(at, asked, jobs=jobs, progress=progress_of("optimum", progress))


@checked_arguments(
    **dict.fromkeys(("evaporating", "condensing", "suction", "discharge", "receiver", "band"), TEXT),
    limits=TEXTS,
    heating=FLAG,
    profile=FILE,
    units=one_of("metric", "us"),
)
def datasheet(
    scene: SceneLike,
    *,
    evaporating: str | None = None,
    condensing: str | None = None,
    suction: str | None = None,
    discharge: str | None = None,
    limits: Sequence[str] = (),
    heating: bool = False,
    profile: str | os.PathLike[str] | None = None,
    receiver: str | None = None,
    band: str | None = None,
    units: str = "metric",
    output: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    progress: Progress | bool | None = None,
) -> Sheet:
    """Return the data sheet of a compressor, an expander, an air package or two stages (`screwsim datasheet`).

        sheet = screwsim.datasheet("point.yaml", limits=["discharge_temperature<110 degC"], output="sheet.pdf")

    `sheet.document` is the sheet in SI units, as `--json` prints it; `units` are those of its text, 'metric' or 'us'.
    `output` is the page to write (.html, .pdf), or the table of its points (.csv). With `heating` it also gives the
    heating capacity and COP of a heat pump; with a `profile` (a CSV file of flows and hours) the energy that an air
    package uses over that profile, which it meets from a `receiver` ('2 m^3') within a `band` ('0.7 bar'); with
    `discharge` its full flow at other outlet pressures. Two stages are given by the path of their file
    (`plant.stages.yaml`).
    """
    if output is not None:
        check_sheet(Path(output))
    ranges = dict(zip(RANGE_OPTIONS, (evaporating, condensing, suction, discharge), strict=True))
    told, bar = None if profile is None else os.fspath(profile), progress_of("datasheet", progress)
    asked = SheetOptions(ranges, limits, heating, told, jobs, bar, units, receiver, band)
    found = sheet_of(scene_or_stages(scene), asked)
    if output is not None:
        write_sheet(found, Path(output))
    return found


@checked_arguments(
    ranges=TEXTS, figures=TEXTS, samples=whole(2, "too few samples (pass a power of two)"), seed=whole(0, "below 0")
)
def sobol_indices(
    scene: SceneLike,
    ranges: Sequence[str],
    figures: Sequence[str] = (),
    *,
    samples: int | None = None,
    seed: int = 1,
    jobs: int | None = None,
    progress: Progress | bool | None = None,
) -> Sensitivity:
    """Return the Sobol indices of figures to inputs that vary over ranges (`screwsim sensitivity --path`).

        found = screwsim.sobol_indices("point.yaml", ["oil_supply.ratio=0.3..3", "oil.viscosity=10 mPa s..30 mPa s"])
        found.to_pandas()

    The default figures are the efficiency that the command uses and the gas mass flow. It takes samples · (inputs + 2)
    solutions, 256 samples (32 of one input) by default.
    """
    at = without_sweep(scene_or_stages(scene))
    spans = read_ranges(at, as_list(ranges), "ranges")
    shown = progress_of("sensitivity", progress)
    return _indices(at, spans, as_list(figures), samples=samples, seed=seed, jobs=jobs, progress=shown)


@checked_arguments()
def performance_map(results: ResultsLike, figures: Sequence[str] = ()) -> list[_map.PerformanceMap]:
    """Return the ten-coefficient maps of a sweep over both temperatures, one for each point of its other axes.

    The default figures are the electrical power (the shaft power of a machine without a motor), flow and capacity.
    `results` is the path of a sweep's file or what `open_results` returns; run the sweep first with
    `screwsim.run_sweep(scene, "map.h5")`.
    """
    return _map.performance_maps(results_of(results), as_list(figures))


@checked_arguments(over=TEXTS, error=NUMBER, most_cases=whole(2, "too few grid points (pass 2 or more)"))
def tabulate(
    source: SceneLike | Results,
    over: str | Iterable[str] | Mapping[str, tuple[float, float]] = (),
    *,
    figures: str | Sequence[str] = (),
    error: float | None = None,
    most_cases: int | None = None,
    jobs: int | None = None,
    progress: Progress | bool | None = None,
) -> MapTable:
    """Return a map of a scene or of two stages over some paths, as `screwsim export` makes it, to evaluate at will.

        table = screwsim.tabulate("x.yaml", ["operation.speed=1500 rpm..4500 rpm"], error=0.01)
        table.evaluate(speed=[200.0, 300.0])["shaft_power"]    a masked array [W], at speeds in rad/s
        table.errors                                           relative, one for each figure, at points between nodes

    `over` are texts PATH=LOW..HIGH or {path: (low, high) [SI]}; the default is the range of the scene's own sweep.
    `source` may also be the results of a sweep or the path of their file, whose grid is the map: then nothing is
    simulated, and `over`, `error` and `most_cases` are refused. A table can be pickled. `error` (0.005) is the largest
    relative error allowed; where `most_cases` (5000) do not reach it, `table.met` is False. Errors are nan where an
    axis of a sweep has too few values to tell.
    """
    stored = source if isinstance(source, Results) else None
    if isinstance(source, str | os.PathLike) and is_results(os.fspath(source)):
        stored = open_results(source)
    if stored is not None:
        refuse_changes(str(stored.path), {"over": over, "error": error, "most_cases": most_cases})
        return map_of_results(stored, as_list(figures))
    asked = over if isinstance(over, Mapping) else as_list(over)
    bar = partial(progress_of, "tabulate", progress)
    return map_of_scene(scene_or_stages(source), asked, as_list(figures), error, most_cases, jobs, bar, dashes="")


@checked_arguments(tolerance=NUMBER)
def compare(a: ResultsLike, b: ResultsLike, *, tolerance: float = 0.0) -> _compare.Comparison:
    """Return what differs from results A to results B at their common points (`screwsim compare`).

        found = screwsim.compare("before.h5", "after.h5")
        found.equal, [each.figure for each in found.figures if each.beyond]

    A change within twice both numerical errors together, or within `tolerance` of the larger value, is none.
    """
    return _compare.compare(results_of(a), results_of(b), tolerance)


@checked_arguments()
def calibrate(
    fit: Fit | str | os.PathLike[str], *, jobs: int | None = None, progress: Progress | bool | None = None
) -> Calibration:
    """Return parameters fitted to measured points (`screwsim calibrate`); `fit` is a `Fit` or the path of its file.

    Ctrl-C raises `screwsim.Interrupted`, a KeyboardInterrupt whose `found` is the best fit so far.
    """
    return _calibrate(_read(fit), jobs=jobs, progress=progress_of("calibrate", progress))


@checked_arguments(predict=FILE)
def posterior(
    fit: Calibration | Fit | str | os.PathLike[str],
    *,
    predict: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    progress: Progress | bool | None = None,
) -> Posterior:
    """Return the posterior distribution of parameters given measured points (`screwsim calibrate --posterior`).

        found = screwsim.posterior("x.fit.yaml", predict="later.csv")
        found.parameters[0].low, found.parameters[0].high    the interval of 90 % [SI]
        found.samples                                        (n, parameters) [SI]
        found.predictions.figures[0].median                  predicted at the first point of later.csv [SI]

    `fit` is the path of a fit file, a `Fit`, or what `calibrate` returned, which saves fitting again. `predict` is
    a CSV file of other operating points with the columns of the fit's data, figures empty or absent; columns
    `…_uncertainty` state how accurately they would be measured (default: as the fit's points). Raises SceneError,
    and UsageError (also if emcee, the extra `posterior`, is not installed). Ctrl-C raises KeyboardInterrupt, while it
    still fits as in `calibrate`.
    """
    asked = fit.fit if isinstance(fit, Calibration) else _read(fit)
    points = () if predict is None else points_to_predict(asked, predict)
    found = fit if isinstance(fit, Calibration) else calibrate(asked, jobs=jobs, progress=progress)
    return _sampled(found, points, jobs=jobs, progress=progress_of("posterior", progress))


@checked_arguments(scene=FILE, data=FILE, unchanged=NUMBER, pairs=NUMBER)
def diagnose(
    fit: Fit | str | os.PathLike[str],
    *,
    scene: str | os.PathLike[str] | None = None,
    data: str | os.PathLike[str] | None = None,
    unchanged: float = PRIOR_UNCHANGED,
    pairs: float = PRIOR_PAIR_ODDS,
    jobs: int | None = None,
    progress: Progress | bool | None = None,
) -> Diagnosis:
    """Return the probabilities that one or two parameters of a fit's machine have changed (`screwsim diagnose`).

    `scene` and `data` replace the files that the fit names; `unchanged` is the prior probability that nothing has
    changed, `pairs` the prior odds of two simultaneous changes against one (0: single changes only).
    """
    asked = _read(fit, scene, data, fixed=False)
    return _diagnose(asked, unchanged=unchanged, pairs=pairs, jobs=jobs, progress=progress_of("diagnose", progress))


@checked_arguments(
    candidates=FILE,
    ranges=MAPPING,
    levels=whole(2, "too few values (pass 2 or more)"),
    count=whole(1, "too few points (pass 1 or more)"),
    scene=FILE,
    data=FILE,
)
def plan(
    fit: Fit | str | os.PathLike[str],
    *,
    candidates: str | os.PathLike[str] | None = None,
    ranges: Mapping[str, tuple[str | float, str | float]] | None = None,
    levels: int = LEVELS,
    count: int = COUNT,
    scene: str | os.PathLike[str] | None = None,
    data: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    progress: Progress | bool | None = None,
) -> Plan:
    """Return the candidate points to measure next, the most informative first (`screwsim plan`).

        screwsim.plan("x.fit.yaml", ranges={"operation.speed": ("1000 rpm", "4000 rpm")}, count=2)

    Candidates are the points of a CSV file, or all combinations of `levels` values from each range.
    """
    asked = _read(fit, scene, data, fixed=False)
    for path, ends in (ranges or {}).items():
        if isinstance(ends, str | bytes | Mapping) or not isinstance(ends, Collection) or len(ends) != 2:
            raise UsageError(f"ranges[{path!r}]: {ends!r} is not a pair (pass e.g. ('1000 rpm', '4000 rpm'))")
    texts = [f"{path}={low}..{high}" for path, (low, high) in (ranges or {}).items()]
    points = candidates_of(asked, candidates, texts, levels)
    return _plan(asked, points, count=count, jobs=jobs, progress=progress_of("plan", progress))


def _read(fit: Any, scene: Any = None, data: Any = None, fixed: bool = True) -> Fit:
    """Return a fit, given or read from a file with other files substituted; raise UsageError with what to pass."""
    if not isinstance(fit, Fit | str | os.PathLike):
        raise UsageError(f"{type(fit).__name__} is not a fit (pass the path of a FIT.yaml)")
    if not isinstance(fit, Fit):
        return read_fit(fit, scene=scene, data=data, fixed=fixed)
    if scene is not None or data is not None:
        raise UsageError("scene and data replace entries of a fit file (pass its path, not a Fit)")
    return fit


def results_of(given: Any) -> Results:
    """Return results, given as such or by their path; raise UsageError with what to pass instead."""
    if isinstance(given, Results):
        return given
    if isinstance(given, str | os.PathLike):
        return open_results(os.fspath(given))
    what = "an xarray.Dataset" if type(given).__name__ == "Dataset" else type(given).__name__
    raise UsageError(f"{what} is not a results file (pass the path of one, written by screwsim.run_sweep)")


__all__ = [
    "calibrate",
    "compare",
    "datasheet",
    "diagnose",
    "optimum",
    "performance_map",
    "plan",
    "posterior",
    "results_of",
    "run_sweep",
    "tabulate",
]
