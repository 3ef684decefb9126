"""The commands of studies: many solutions, or stored results, that answer one question."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from screwsim.cli import options
from screwsim.cli.declare import File, Text, Texts, argument, option, switch
from screwsim.cli.options import AS_JSON, JOBS, NOT_ALL_OK, OK, OVERRIDES, SCENE_FILE, WITHOUT
from screwsim.inputs.faults import Interrupted, UsageError
from screwsim.screen import say

if TYPE_CHECKING:
    from screwsim.study.asked.varied import Varied


def optimum(
    scene_file: str = SCENE_FILE,
    path: str = option(
        "PATH[=LOW..HIGH]",
        "Path to vary, and its range; of two stages first.PATH or second.PATH.",
        default="oil_supply.ratio",
    ),
    figure: Text = option("NAME", "Figure to maximize (default: an efficiency that suits the gas).", "--figure"),
    minimum: bool = switch("--minimize", "Minimize it instead.", "--minimum"),
    first: Text = option("VALUE", "Lower end of the range.", "--from"),
    last: Text = option("VALUE", "Upper end of the range.", "--to"),
    output: File = option("OUT.csv|.xlsx|.h5", "Write the table.", "-o"),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Find the best value of one path at each point of the sweep's other axes, of a scene or of two stages."""
    scene = options.loaded_scene_or_stages(scene_file, "optimum", overrides, without)
    from screwsim.printing.optimum import optimum_document, print_optimum, write_optimum
    from screwsim.study.asked.inputs import efficiency_note
    from screwsim.study.best.optimum import optimum as found
    from screwsim.study.best.optimum import question

    asked = question(scene, path, figure, minimum=minimum, first=first, last=last)
    options.check_columns(output, "optimum of", "accuracy", "solutions", "failed_solutions", "place")
    if figure is None and (told := efficiency_note(scene)):
        say(f"optimum: {told}", err=True)
    with options.counted_progress("optimum", "rows") as shown:
        rows = found(scene, asked, jobs=jobs, progress=shown)
    printed = partial(print_optimum, changed=options.changes(overrides, without))
    options.print_document_or_text(as_json, optimum_document, printed, scene, asked, rows)
    if output is not None:
        write_optimum(output, scene, asked, rows)
        options.print_files([output], as_json)
    return OK if all(row.status == "ok" for row in rows) else NOT_ALL_OK


def performance_map(
    results_file: str = argument("OUT.h5", "Results file of a sweep."),
    figures: Texts = option(
        "NAME", "Figure to fit (default: electrical or shaft power, mass flow, cooling capacity).", "--figure"
    ),
    points: Texts = option(
        "NAME=VALUE,…",
        "Evaluate the map at e.g. 'evaporating_temperature=0 degC, condensing_temperature=40 degC'; repeatable.",
        "--at",
    ),
    output: File = option("OUT.csv|.xlsx|.json", "Write the map.", "-o"),
    as_json: bool = AS_JSON,
) -> int:
    """Fit the ten AHRI 540 / EN 12900 coefficients to a sweep over both temperatures, or evaluate them."""
    from screwsim.printing import performance_map as printed
    from screwsim.results import open_results
    from screwsim.study.maps.map_points import points_at
    from screwsim.study.maps.performance_map import performance_maps

    results = open_results(results_file)
    options.check_target(output, *options.TABLES, ".json")
    if output is not None:
        printed.protect_other_maps(output)
    maps = performance_maps(results, tuple(dict.fromkeys(figures or ())))
    found = points_at(results, maps, points or ())
    if found:
        options.print_document_or_text(as_json, printed.points_document, printed.print_points, results, found)
    else:
        options.print_document_or_text(as_json, printed.map_document, printed.print_maps, results, maps)
    if output is not None:
        printed.write_maps(output, results, maps)
        options.print_files([output], as_json)
    return OK if found or not any(each.message or each.not_ok for each in maps) else NOT_ALL_OK


def sensitivity(
    scene_file: str = SCENE_FILE,
    places: Texts = argument("[PATH]…", "With --local: inputs to differentiate by (default: all).", None),
    local: bool = switch("--local", "Derivatives at the point itself, instead of indices."),
    check_sobol: int | None = option(
        "N", "Check the linear uncertainty from the scene's tolerances against N samples."
    ),
    paths: Texts = option(
        "PATH=LOW..HIGH", "Path to vary and its range, e.g. oil_supply.ratio=0.5..2; repeatable.", "--path"
    ),
    figures: Texts = option("NAME", "Figure to study (default: efficiency and mass flow; --local: all).", "--figure"),
    samples: int | None = option(
        "N", "Base samples, a power of two (default: 256; 32 for one path); takes N (paths + 2) solutions."
    ),
    seed: int = option("N", "Random seed of the samples and confidence intervals.", min=0, default=1),
    output: File = option("OUT.csv|.xlsx|.h5", "Write the indices.", "-o"),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Rank the inputs that a figure depends on: Sobol indices over ranges, or derivatives at the point (--local)."""
    scene = options.base_point(options.loaded_scene_or_stages(scene_file, "study", overrides, without), scene_file)
    if check_sobol is not None:
        others = {"--local": local, "path": places, "--path": paths, "--samples": samples}
        if other := options.first_given(others):
            raise UsageError(f"--check-sobol {check_sobol}: takes no {other} (the scene's tolerances say what varies)")
        return _checked_uncertainty(scene, check_sobol, seed, figures or (), output, jobs, as_json)
    if local:
        if paths:
            raise UsageError(f"--path {paths[0]}: --local takes no ranges (name the path alone, without --path)")
        changed = options.changes(overrides, without)
        return _local_sensitivity(scene, places or (), figures or (), output, jobs, as_json, changed)
    if places:
        raise UsageError(f"{places[0]}: has no range (write --path PATH=LOW..HIGH, or add --local)")
    from screwsim.printing.sensitivity import print_sensitivity, sensitivity_document, write_sensitivity
    from screwsim.printing.tables import print_text
    from screwsim.study.asked.inputs import efficiency_note
    from screwsim.study.asked.spans import read_ranges
    from screwsim.study.uncertainty.sobol import check_samples, cost_in_words, usual_samples
    from screwsim.study.uncertainty.sobol import sensitivity as studied

    options.check_columns(output, "Sobol indices", "figure", "path", "first_order", "total")
    names = tuple(dict.fromkeys(figures or ()))
    ranges = read_ranges(scene, paths or ())
    samples = usual_samples(len(ranges)) if samples is None else samples
    check_samples(len(ranges), samples)
    if not names and (told := efficiency_note(scene)):
        say(f"sensitivity: {told}", err=True)
    if sys.stderr.isatty():
        print_text(f"sensitivity: {cost_in_words(len(ranges), samples)}", err=True)
    with options.counted_progress("sensitivity", "solutions") as shown:
        found = studied(scene, ranges, names, samples=samples, seed=seed, jobs=jobs, progress=shown)
    printed = partial(print_sensitivity, changed=options.changes(overrides, without))
    options.print_document_or_text(as_json, sensitivity_document, printed, scene, found)
    if output is not None and not found.message:
        write_sensitivity(output, found)
        options.print_files([output], as_json)
    return OK if not found.message else NOT_ALL_OK


def _checked_uncertainty(
    of: Varied, count: int, seed: int, figures: Sequence[str], output: File, jobs: int | None, as_json: bool
) -> int:
    """Print and write the linear uncertainties of figures beside those of a sample of the inputs."""
    from screwsim.printing.uncertain import check_document, print_check, write_check
    from screwsim.study.asked.figures import figure_of
    from screwsim.study.uncertainty.sampled import checked_by_sample, linear_uncertainty, refuse_count

    options.check_columns(output, "linear and sampled uncertainties", "figure", "linear", "sampled")
    names = [figure_of(of, name) for name in figures]
    refuse_count(count)
    found = linear_uncertainty(of, names, jobs=jobs)
    if found.slopes.result.status == "ok":
        shown = options.progress_bar("samples")
        found = checked_by_sample(of, found, count, seed=seed, jobs=jobs, progress=shown)
    options.print_document_or_text(as_json, check_document, print_check, of, found)
    if output is not None and found.sampled:
        write_check(output, found)
        options.print_files([output], as_json)
    return OK if found.slopes.result.status == "ok" and not found.message else NOT_ALL_OK


def _local_sensitivity(
    scene: Varied,
    places: Sequence[str],
    figures: Sequence[str],
    output: File,
    jobs: int | None,
    as_json: bool,
    changed: Sequence[str],
) -> int:
    """Print and write the derivatives of a scene's figures by its numbers."""
    from screwsim.printing.sensitivity import local_document, print_local, write_local
    from screwsim.scene import Scene
    from screwsim.study.asked.figures import figure_of
    from screwsim.study.uncertainty.point import sensitivities

    if output is not None and not isinstance(scene, Scene) and output.suffix.lower() not in options.TABLES:
        raise UsageError(f"-o {output}: derivatives of two stages are a table (write -o {output.with_suffix('.csv')})")
    if output is not None and output.suffix.lower() == ".h5":
        options.check_place(output)
    else:
        options.check_columns(output, "local sensitivities", "figure", "path", "number", "derivative")
    names = [figure_of(scene, name) for name in figures]
    with options.counted_progress("sensitivity", "solutions") as shown:
        found = sensitivities(scene, places, names, jobs=jobs, progress=shown)
    printed = partial(print_local, chosen=names, changed=changed)
    options.print_document_or_text(as_json, local_document, printed, scene, found)
    if output is not None and found.derivatives:
        write_local(output, scene, found)
        options.print_files([output], as_json)
    return OK if found.result.status == "ok" else NOT_ALL_OK


def compare(
    first: str = argument("A.h5", "Results of run or sweep."),
    second: str = argument("B.h5", "Results file to compare it with."),
    tolerance: float = option("T", "Relative difference to ignore, in addition to the numerical error.", default=0.0),
    folder: File = option("DIR", "Folder for a table of all common points and figures of both files.", "-o"),
    as_json: bool = AS_JSON,
) -> int:
    """Compare two results files. A difference still exits with 0."""
    options.check_folder(folder)
    from screwsim.printing.compare import comparison_document, print_comparison, write_comparison
    from screwsim.results import open_results
    from screwsim.study.compare import compare as compared

    a, b = open_results(first), open_results(second)
    found = compared(a, b, tolerance)
    options.print_document_or_text(as_json, comparison_document, print_comparison, a, b, found)
    if folder is not None:
        options.print_files(write_comparison(a, b, found, folder), as_json)
    return OK


def calibrate(
    fit_file: str = argument("FIT", "Fit file (YAML): scene, measured points and parameters."),
    folder: File = option("DIR", "Folder for scene.yaml, fit.json and the residual figure.", "-o"),
    posterior: bool = switch("--posterior", "Also sample the posterior of the parameters (extra `posterior`)."),
    predict: File = option("POINTS.csv", "Predict other points, with intervals (implies --posterior)."),
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Fit parameters of a scene to measured points, and report how well the data fix them."""
    options.check_folder(folder)
    from screwsim.printing import print_json
    from screwsim.printing.calibration import calibration_document, check_folder, print_calibration, write_calibration
    from screwsim.printing.posterior import (
        PAIRS,
        PREDICTED,
        posterior_document,
        print_posterior,
        protect_other_samples,
        write_posterior,
    )
    from screwsim.printing.tables import print_text
    from screwsim.results.atomic import make_folder
    from screwsim.study.calibration import calibrate as calibrated
    from screwsim.study.calibration import cost_in_words, read_fit
    from screwsim.study.calibration.posterior import refuse_curves
    from screwsim.study.calibration.predict import points_to_predict, posterior_with_predictions

    fit = read_fit(fit_file)
    if posterior or predict is not None:
        refuse_curves(fit)
    asked = () if predict is None else points_to_predict(fit, predict, "--predict")
    if folder is not None:
        make_folder(folder)
        check_folder(folder, fit.scene_file)
        if posterior or asked:
            protect_other_samples(folder)
    if sys.stderr.isatty():
        print_text(f"calibrate: {cost_in_words(fit)}", err=True)
    try:
        found = calibrated(fit, jobs=jobs, progress=options.progress_bar("calibrate"))
    except Interrupted as pressed:
        found = pressed.found
    wide = None
    if (posterior or asked) and found.status != "interrupted":
        wide = posterior_with_predictions(found, asked, jobs=jobs, progress=options.progress_bar("posterior"))
    if as_json:
        print_json(calibration_document(found) | ({} if wide is None else {"posterior": posterior_document(wide)}))
    else:
        print_calibration(found)
        if wide is not None:
            print_posterior(found, wide)
    if folder is not None:
        files = [*write_calibration(found, folder), *([] if wide is None else write_posterior(found, wide, folder))]
        options.print_files(files, as_json)
        options.tell_left(folder, files, f"{PAIRS}.*", PREDICTED)
    if found.status == "interrupted":
        options.tell_with_interruption(f"calibrate: {found.message}")
        return options.INTERRUPTED
    statuses = [found.status, *([] if wide is None else [wide.status])]
    if wide is not None and wide.predictions is not None:
        statuses.append(wide.predictions.status)
    return OK if all(status == "ok" for status in statuses) else NOT_ALL_OK


def tolerance(
    scene_file: str = SCENE_FILE,
    grade: int = option("N", "ISO 286 tolerance grade of crank, rod and offset, e.g. 7 for IT7.", default=10),
    crank_grade: int | None = option("N", "Grade of the crank alone."),
    rod_grade: int | None = option("N", "Grade of the rod alone."),
    offset_grade: int | None = option("N", "Grade of the offset alone."),
    bore_grade: int | None = option("N", "Grade of the bore (default: exact)."),
    count: int = option("N", "Number of machines to draw.", default=64),
    seed: int = option("N", "Random seed.", min=0, default=1),
    folder: File = option("DIR", "Write the figures.", "-o"),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Find how length errors of a slider-crank change its motion and, by Monte Carlo, the compressor."""
    options.check_folder(folder)
    scene = options.loaded_point(scene_file, overrides, without)
    from screwsim.printing.machine import print_tolerance, tolerance_document
    from screwsim.study.tolerance import tolerances

    grades = {"crank_radius": crank_grade, "rod_length": rod_grade, "offset": offset_grade}
    asked = {name: grade if own is None else own for name, own in grades.items()}
    asked |= {} if bore_grade is None else {"bore": bore_grade}
    with options.counted_progress("tolerance", "machines") as shown:
        found = tolerances(scene, asked, count=count, seed=seed, jobs=jobs, progress=shown)
    options.print_document_or_text(as_json, tolerance_document, print_tolerance, scene, found)
    if folder is not None:
        from screwsim.report.slider_crank import draw_machine

        deviations = {spread.figure: found.values[spread.figure] / spread.nominal - 1.0 for spread in found.spreads}
        options.print_files(draw_machine(found.links, (found.table, found.shifts, deviations), folder), as_json)
    return OK if not found.failed else NOT_ALL_OK
