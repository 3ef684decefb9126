"""The search commands: values for given figures, best values, what has changed in a machine, what to measure next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from screwsim.cli import options
from screwsim.cli.declare import File, Text, Texts, argument, option, switch
from screwsim.cli.options import AS_JSON, JOBS, NOT_ALL_OK, OK, OVERRIDES, SCENE_FILE, WITHOUT
from screwsim.inputs.faults import UsageError
from screwsim.screen import say

if TYPE_CHECKING:
    from screwsim.study.asked.varied import Varied

FIT_FILE = argument("FIT", "Machine, parameters and points: a fit's YAML file.")
OTHER_SCENE = option("SCENE", "Machine to use instead of the fit's own, e.g. scene.yaml of a calibration.", "--scene")
OTHER_DATA = option("POINTS.csv", "Measured points to use instead of the fit's own.", "--data")


def find(
    scene_file: str = SCENE_FILE,
    vary: Texts = option("PATH[=LOW..HIGH]", "Path to vary, e.g. operation.speed; repeatable.", "--vary"),
    goals: Texts = option("FIGURE=VALUE", "Target, e.g. 'cooling_capacity=500 kW'; repeatable.", "--for"),
    catalogue: Text = option(
        "SIZES", "Available sizes, e.g. '140,163,204 mm'; the next larger one is chosen.", "--catalogue"
    ),
    output: File = option(
        "FOUND.yaml", "Write the scene or stages found (for a sweep, rows as .csv, .xlsx or .h5).", "-o"
    ),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Find values of paths that give wanted figures, of a scene or two stages: a speed for a capacity, a size."""
    scene = options.loaded_scene_or_stages(scene_file, "find", overrides, without)
    from screwsim.printing.find import find_document, print_find, write_find
    from screwsim.scene import case_count
    from screwsim.scene.grid import without_axes
    from screwsim.study.seek import find_each, question

    asked = question(scene, vary or (), goals or (), catalogue or ())
    varied = [span.path for span in asked.spans]
    several = case_count(without_axes(scene, varied)) > 1
    table = output is not None and output.suffix.lower() in (*options.TABLES, ".h5")
    if table:
        options.check_columns(output, "goal seek", "solutions", "failed_solutions", "status", "message")
    if output is not None and not table:
        if several:
            raise UsageError(f"-o {output}: the sweep gives one answer per row (write -o FOUND.csv, .xlsx or .h5)")
        _check_found(output, "-o", scene, scene_file)
    with options.counted_progress("find", "rows") as shown:
        rows = find_each(scene, asked, jobs=jobs, progress=shown)
    printed = partial(print_find, changed=options.changes(overrides, without))
    options.print_document_or_text(as_json, find_document, printed, scene, asked, rows)
    found = rows[0]
    if output is not None and table:
        write_find(output, scene, asked, rows)
        options.print_files([output], as_json)
    elif output is not None and found.scene is not None:
        values = {varied[0]: found.size.value} if found.size else found.values
        wanted = ", ".join(f"--for '{text}'" for text in goals or ())
        told = f"find {Path(scene_file).name} --vary {', '.join(varied)} {wanted}"
        written = _write_found(output, found.scene, values, (scene_file, overrides or (), without or ()), told)
        options.print_files(written, as_json)
    return OK if all(row.status == "ok" for row in rows) else NOT_ALL_OK


def _check_found(output: Path, option: str, of: Varied, file: str) -> None:
    """Raise UsageError where a scene found of that in a file, or both scenes of two stages, cannot be written."""
    from screwsim.scene import Scene
    from screwsim.study.scene_files import check_found_stages, check_scene_file

    if isinstance(of, Scene):
        check_scene_file(output, option, file)
    else:
        check_found_stages(output, option)


def _write_found(
    output: Path, found: Varied, values: Mapping[str, float], given: tuple[str, Sequence[str], Sequence[str]], told: str
) -> list[str]:
    """Write a scene found, or two stages, over the `given` file, overrides and effects left out; return the files."""
    from screwsim.scene import Scene
    from screwsim.study.scene_files import write_found, write_found_stages

    if isinstance(found, Scene):
        return [write_found(output, found, values, *given, told)]
    return write_found_stages(output, found, values, told)


def optimize(
    scene_file: str = SCENE_FILE,
    vary: Texts = option(
        "PATH=LOW..HIGH", "Path to vary and its range, e.g. oil_supply.ratio=0.3..3; repeatable.", "--vary"
    ),
    maximize: Texts = option("FIGURE", "Figure to maximize; repeatable.", "--maximize"),
    minimize: Texts = option("FIGURE", "Figure to minimize; repeatable.", "--minimize"),
    subject_to: Texts = option(
        "FIGURE<VALUE", "Bound on a figure, e.g. 'discharge_temperature<90 degC'; repeatable.", "--subject-to"
    ),
    over: Text = option(
        "POINTS.csv|NAME",
        "Weighted operating points: a file, IPLV, ESEER, SEER, SEPR, SCOP-35, SCOP-55, …-water, …-brine.",
        "--over",
    ),
    print_points: bool = switch("--print-points", "Print the points of --over as editable CSV, and exit."),
    output: File = option(
        "OUT.h5", "Store all evaluations, so that an interrupted run can resume; of two stages also as a table.", "-o"
    ),
    best: File = option("BEST.yaml", "Write the best scene (single aim only).", "--best"),
    evaluations: int | None = option("N", "Largest number of evaluations (default: 100 per path).", min=1),
    seed: int = option("N", "Random seed of the search.", min=0, default=1),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    restart: bool = switch("--restart", "Discard stored results and start over."),
    as_json: bool = AS_JSON,
) -> int:
    """Find values of paths that make figures best: one or several aims, within bounds, over operating points."""
    from screwsim.scene import Scene

    scene = options.loaded_scene_or_stages(scene_file, "optimize", overrides, without)
    if not isinstance(scene, Scene):
        refused = {"--over": over, "--print-points": print_points}
        options.refuse_for_stages(scene_file, "optimize", refused)
    from screwsim.printing.optimize import optimize_document, print_optimize
    from screwsim.study.optimize import question, run_question, spans_of
    from screwsim.study.optimize.points import as_csv, read_points
    from screwsim.study.optimize.store import TABLE_COLUMNS, TABLE_TITLE
    from screwsim.study.seek import rounded

    if print_points and isinstance(scene, Scene):
        if over is None:
            raise UsageError("--print-points: needs --over NAME, e.g. --over SEPR")
        say(as_csv(read_points(scene, over)).rstrip())
        return OK
    spans = spans_of(scene, vary or ())
    base = options.base_point(scene, scene_file)
    more = {"subject_to": subject_to or (), "over": over, "evaluations": evaluations, "seed": seed}
    asked = question(base, spans, maximize or (), minimize or (), **more)
    if output is not None and isinstance(scene, Scene):
        options.check_results(output)
    elif output is not None:
        options.check_columns(output, TABLE_TITLE, *TABLE_COLUMNS)
    if best is not None:
        if len(asked.aims) > 1:
            remedy = "pick a point of the front: --json lists their values"
            raise UsageError(f"--best {best}: several aims have no single best ({remedy})")
        if not spans:
            raise UsageError(f"--best {best}: nothing varies (write --vary PATH=LOW..HIGH, or leave it out)")
        _check_found(best, "--best", scene, scene_file)
    found = run_question(asked, output, jobs=jobs, restart=restart, progress=options.progress_bar("optimize"))
    printed = partial(print_optimize, changed=options.changes(overrides, without))
    options.print_document_or_text(as_json, optimize_document, printed, found)
    written = [] if output is None else [str(output)]
    if best is not None and found.scene is not None:
        told = f"optimize {Path(scene_file).name} --vary {', '.join(span.path for span in asked.spans)}"
        values = rounded(found.asked.scene, found.values)
        written += _write_found(best, found.scene, values, (scene_file, overrides or (), without or ()), told)
    options.print_files(written, as_json)
    return OK if found.status == "ok" else NOT_ALL_OK


def diagnose(
    fit_file: str = FIT_FILE,
    scene: File = OTHER_SCENE,
    data: File = OTHER_DATA,
    unchanged: float = option("P", "Prior probability that nothing has changed.", default=0.5),
    pairs: float = option("ODDS", "Prior odds of two changes against one; 0: single changes only.", default=0.1),
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Find from new measurements which one or two parameters of a machine have changed, with probabilities."""
    from screwsim.printing.diagnosis import diagnosis_document, print_diagnosis
    from screwsim.study.calibration import read_fit
    from screwsim.study.calibration.diagnosis import diagnose as diagnosed

    fit = read_fit(fit_file, scene=scene, data=data, fixed=False)
    found = diagnosed(fit, unchanged=unchanged, pairs=pairs, jobs=jobs, progress=options.progress_bar("diagnose"))
    options.print_document_or_text(as_json, diagnosis_document, print_diagnosis, found)
    return OK if found.status == "ok" else NOT_ALL_OK


def plan(
    fit_file: str = FIT_FILE,
    candidates: File = option("GRID.csv", "Operating points that could be measured.", "--candidates"),
    paths: Texts = option(
        "PATH=LOW..HIGH",
        "Or a range of a condition; all combinations of the ranges are candidates; repeatable.",
        "--path",
    ),
    levels: int | None = option("N", "Values per range (default 4)."),
    count: int = option("N", "Number of points to choose.", default=3),
    output: File = option("NEXT.csv", "Write them as a data file for a fit, to be filled in.", "-o"),
    scene: File = OTHER_SCENE,
    data: File = OTHER_DATA,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Choose further operating points whose measurement would fix the parameters of a fit best."""
    options.check_target(output, *options.TABLES)
    from screwsim.printing.plan import plan_document, print_plan, protect_measured, write_plan
    from screwsim.study.calibration import read_fit
    from screwsim.study.calibration.plan import LEVELS, candidates_of
    from screwsim.study.calibration.plan import plan as planned

    if levels is not None and not paths:
        raise UsageError(f"--levels {levels}: applies to ranges only (write --path PATH=LOW..HIGH)")
    if output is not None:
        protect_measured(output)
    fit = read_fit(fit_file, scene=scene, data=data, fixed=False)
    points = candidates_of(fit, candidates, paths or (), LEVELS if levels is None else levels)
    found = planned(fit, points, count=count, jobs=jobs, progress=options.progress_bar("plan"))
    options.print_document_or_text(as_json, plan_document, print_plan, found)
    if output is not None and found.steps:
        options.print_files([write_plan(output, found)], as_json)
    return OK if found.status == "ok" else NOT_ALL_OK
