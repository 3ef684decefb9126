"""The commands that solve or describe a scene: one point, a sweep, the cost of accuracy."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

from screwsim.cli import options
from screwsim.cli.declare import File, Text, Texts, argument, option, switch
from screwsim.cli.options import AS_JSON, JOBS, NOT_ALL_OK, OK, OVERRIDES, SCENE_FILE, WITHOUT
from screwsim.inputs.faults import UsageError
from screwsim.screen import say

if TYPE_CHECKING:
    from screwsim.outputs import Result
    from screwsim.scene import Scene
    from screwsim.study.knock_out import LeftOut
    from screwsim.study.stages import StageChain
    from screwsim.study.uncertainty.measured import MeasuredFigure


SHEETS = (*options.TABLES, ".html", ".pdf")  # endings of the points of two stages, beside those of results


def run(
    scene_file: str = SCENE_FILE,
    output: File = option("OUT.h5", "Write the result, including traces.", "-o"),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    knock_out: bool = switch("--knock-out", "Leave out each effect in turn and report what changes."),
    together: Texts = option(
        "GROUP", "Leave out together: leaks, oil, friction, walls, or a comma-separated list of effects; repeatable."
    ),
    measured: Texts = option(
        "FIGURE=VALUE", "Compare with a measured value, e.g. 'shaft_power=132 kW ± 2 kW'; repeatable.", "--measured"
    ),
    short: bool = switch("--short", "Print only the ten main figures, on one screen."),
    as_json: bool = AS_JSON,
) -> int:
    """Simulate one operating point, or two stages in series (a file with stages: [first.yaml, second.yaml])."""
    from screwsim.scene.file_kinds import is_stages

    beside = {"--json": as_json, "--knock-out": knock_out, "--together": together}
    if short and (name := options.first_given(beside)):
        prints = "everything" if name == "--json" else "a table of its own"
        raise UsageError(f"--short: prints the main figures only, but {name} prints {prints} (remove one of the two)")
    if is_stages(scene_file):
        named = {"--short": short, "--together": together}
        options.refuse_for_stages(scene_file, "run", named | {"--knock-out": knock_out, "--without": without})
        return _run_stages(scene_file, output, overrides, measured or (), as_json)
    scene = options.loaded_point(scene_file, overrides, without)
    if output is not None:
        options.check_place(output)
    points: tuple[MeasuredFigure, ...] = ()
    if measured:  # mistakes are reported before anything is simulated
        from screwsim.study.uncertainty.measured import read_measured

        points = read_measured(scene, measured)
    left_out: tuple[LeftOut, ...] = ()
    if knock_out or together:
        from screwsim.study.knock_out import each_alone, read_groups

        left_out = (*read_groups(scene, together or ()), *(each_alone(scene) if knock_out else ()))
    result = _simulated(scene, left_out, traced=output is not None)
    if output is not None:
        from screwsim.study.uncertainty.point import save_point

        options.check_place(output)  # again: a file that has appeared meanwhile is kept
        save_point(output, scene, result)
    compared = None
    if points:
        from screwsim.study.uncertainty.measured import compare_measured

        compared = compare_measured(scene, result, points)
    if as_json:
        from screwsim.printing import print_json

        print_json(result.as_json() | ({} if compared is None else {"measured": compared.as_json()}))
    else:
        changed = options.changes(overrides, without)
        _print_point(scene, result, changed, short)
        if compared is not None:
            from screwsim.printing.measured import print_measured

            print_measured(scene, result, compared)
    options.print_files([] if output is None else [output], as_json)
    return OK if result.status == "ok" and not (compared and compared.none) else NOT_ALL_OK


def _simulated(scene: Scene, left_out: Sequence[LeftOut], traced: bool) -> Result:
    """Return the result of a scene, with its knock-out and its uncertainties where these are asked for."""
    from screwsim.simulate import simulate

    result = simulate(scene, trace=True if traced else "ledger")
    if left_out and result.performance:
        from screwsim.study.knock_out import knock_out

        names = [f"without {each.name}" for each in left_out]
        result = knock_out(scene, result, left_out, options.progress_bar("knock-out", names))
    if scene.uncertain or scene.model_error:
        from screwsim.study.uncertainty.point import with_uncertainty

        result = with_uncertainty(scene, result)
    return result


def _print_point(scene: Scene, result: Result, changed: Sequence[str], short: bool) -> None:
    """Print a result, all of it or its main figures; `changed` are the changes that the command line makes."""
    if short:
        from screwsim.printing.short import print_short

        print_short(scene.title, result, changed, scene.operation.ambient_pressure)
        return
    from screwsim.printing import print_result
    from screwsim.scene.left_out import idle_figures, left_out_lines, moved_port_lines

    told = [*moved_port_lines(scene), *left_out_lines(scene)]
    print_result(scene.title, result, told, changed, idle_figures(scene))
    if result.uncertainty:
        from screwsim.printing.uncertain import print_uncertainty

        print_uncertainty(result)


def _run_stages(file: str, output: Path | None, overrides: Texts, measured: Sequence[str], as_json: bool) -> int:
    from screwsim.printing import print_json
    from screwsim.printing.measured import print_measured
    from screwsim.printing.stages import print_stages
    from screwsim.scene import without_sweep
    from screwsim.study.stages import read_stages, run_stages
    from screwsim.study.stages.store import chain_point, save_chain
    from screwsim.study.uncertainty.measured import compare_measured, read_measured
    from screwsim.study.uncertainty.point import with_slopes
    from screwsim.study.uncertainty.stages import with_uncertainty

    chain = read_stages(file, overrides or ())
    if output is not None:
        options.check_place(output)
    options.report_ignored_sweep(chain, f"{file}: its", f"screwsim sweep {quote(file)} simulates the sweep")
    options.report_sweeps_of_stages(chain, file)
    _report_ignored_model_errors(file, chain)
    base = without_sweep(chain)
    asked = read_measured(base, measured)  # mistakes are reported before anything is simulated
    found = with_uncertainty(base, run_stages(base))
    if output is not None:
        options.check_place(output)  # again: a file that has appeared meanwhile is kept
        save_chain(output, base, [chain_point(found, with_slopes)], "run", found.scenes)
    compared = compare_measured(base, found.as_result(), asked) if asked else None
    if as_json:
        print_json(found.as_json() | ({} if compared is None else {"measured": compared.as_json()}))
    else:
        print_stages(chain.title, found)
        if compared is not None:
            print_measured(base, found.as_result(), compared)
    options.print_files([] if output is None else [output], as_json)
    return OK if found.status == "ok" and not (compared and compared.none) else NOT_ALL_OK


def _report_ignored_model_errors(file: str, chain: StageChain) -> None:
    for name, scene in chain.by_stage.items():
        if scene.model_error:
            told = "model error is ignored (screwsim run of that scene shows it)"
            say(f"{file}: the {name} scene's {told}", err=True)


def _report_ignored_output(file: str, chain: StageChain) -> None:
    for name, scene in chain.by_stage.items():
        asked = {"keep: cycle": scene.output.keeps_cycle, "derivatives: all": scene.output.keeps_slopes}
        for word in (word for word, on in asked.items() if on):
            why = "points of two stages are stored with their figures alone; screwsim run -o stores it of one point"
            say(f"{file}: the {name} scene's output.{word} is ignored ({why})", err=True)


def sweep(
    scene_file: str = SCENE_FILE,
    output: File = option(
        "OUT.h5",
        "Results file (default: results/SCENE.h5); of two stages also .csv (the default), .xlsx, .html, .pdf.",
        "-o",
    ),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    scheduler: Text = option("ADDRESS|FILE", "Compute on a dask scheduler's workers instead."),
    case_limit: float | None = option("SECONDS", "Time limit per case (default: 300; with --jobs 1: none).", min=0.001),
    restart: bool = switch("--restart", "Discard stored results and start over."),
    batch: bool = switch("--batch", "Solve many points at once in the SIMD lanes of each core."),
    gpu: bool = switch("--gpu", "The same on an NVIDIA GPU shared by all workers, for thousands of points."),
    as_json: bool = AS_JSON,
) -> int:
    """Simulate all cases of a sweep, or resume it, of a scene or of two stages in series."""
    from screwsim.scene.file_kinds import is_stages

    if is_stages(scene_file):
        named = {"--without": without, "--scheduler": scheduler, "--case-limit": case_limit}
        options.refuse_for_stages(scene_file, "sweep", named | {"--batch": batch, "--gpu": gpu})
        return _sweep_stages(scene_file, output, overrides, jobs, restart, as_json)
    if scheduler is not None and jobs is not None:
        raise UsageError("--jobs counts workers on this machine; a --scheduler has its own (remove one of the two)")
    scene = options.loaded_scene(scene_file, overrides, without)
    if not scene.sweep:
        raise UsageError(
            f"{scene_file}: has no sweep (add a sweep: block, or --set 'sweep.operation.speed=[1000 rpm, 3000 rpm]'; "
            "one point is simulated by screwsim run)"
        )
    from screwsim.printing import print_json
    from screwsim.printing.sweep import print_sweep, sweep_document
    from screwsim.study.sweep import run_sweep

    if output is not None:
        options.check_results(output)
    file = output or Path("results") / f"{Path(scene_file).stem}.h5"
    where = {"jobs": jobs, "scheduler": scheduler, "case_limit": case_limit, "batch": batch, "gpu": gpu}
    summary = run_sweep(scene, file, **where, restart=restart, progress=options.progress_bar())
    document = sweep_document(scene, summary)
    print_json(document) if as_json else print_sweep(document, scene)
    return OK if summary.ok == summary.cases else NOT_ALL_OK


def _sweep_stages(
    file: str, output: Path | None, overrides: Texts, jobs: int | None, restart: bool, as_json: bool
) -> int:
    from screwsim.printing.machine import print_sheet
    from screwsim.report.datasheet import check_sheet, write_sheet
    from screwsim.study.datasheet.stages_points import points_sheet
    from screwsim.study.stages import read_stages
    from screwsim.study.stages.store import check_place_of_points, save_chain
    from screwsim.study.sweep.stages import KeptPoints, sweep_stages

    chain = read_stages(file, overrides or ())
    if not chain.sweep:
        example = "first.operation.speed: [2000 rpm, 3000 rpm]"
        raise UsageError(f"{file}: has no sweep (add sweep: {{{example}}}; one point is simulated by screwsim run)")
    options.report_sweeps_of_stages(chain, file)
    _report_ignored_model_errors(file, chain)
    place = output or Path("results") / f"{Path(file).stem}.csv"
    as_results = place.suffix.lower() in options.RESULTS
    if not as_results and place.suffix.lower() not in SHEETS:
        good = ", ".join(str(place.with_suffix(ending)) for ending in (".h5", *SHEETS))
        what = "points of two stages are results, a table, a page or a PDF"
        raise UsageError(f"-o {place}: {what} (write one of {good})")
    if as_results:
        _report_ignored_output(file, chain)
        options.check_results(place)
        check_place_of_points(place, chain)
    else:
        check_sheet(place)
    kept = KeptPoints(chain, place)
    points = sweep_stages(chain, kept, jobs=jobs, restart=restart, progress=options.progress_bar())
    sheet = points_sheet(chain, points, kept.reused)
    options.print_document_or_text(as_json, lambda found: found.document, print_sheet, sheet)
    if as_results:
        save_chain(place, chain, points, "sweep")
    options.print_files([place if as_results else write_sheet(sheet, place)], as_json)
    kept.discard()
    return OK if sheet.ok else NOT_ALL_OK


def explain(
    scene_file: str = SCENE_FILE,
    names: Texts = argument(
        "[NAME]...", "With --parameters: effects or sections to list; with --code: equations (M12) or functions.", None
    ),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    code: bool = switch("--code", "Print the code that is compiled for the scene, or those of its functions."),
    parameters: bool = switch("--parameters", "List every key with its unit, default, range and meaning."),
    sources: bool = switch("--sources", "List what to cite: program, gas, and the source of each effect."),
) -> None:
    """List what is simulated and what is left out, for a scene or two stages in series."""
    from screwsim.scene.file_kinds import is_stages

    if names and not (parameters or code):
        kind = "--code" if re.fullmatch(r"[MS]\d+", names[0]) else "--parameters"
        what = "only --parameters and --code take a name"
        raise UsageError(f"{names[0]}: {what} (write screwsim explain {quote(scene_file)} {kind} {names[0]})")
    asked = [each for each, on in (("--parameters", parameters), ("--code", code), ("--sources", sources)) if on]
    if len(asked) > 1:
        raise UsageError(f"{asked[0]} and {asked[1]} exclude each other (remove one of the two)")
    if is_stages(scene_file):
        named = {"--without": without, "--code": code, "--parameters": parameters, "--sources": sources}
        options.refuse_for_stages(scene_file, "explain", named)
        from screwsim.study.stages import explain_stages, read_stages

        say(explain_stages(read_stages(scene_file, overrides or ())))
        return
    scene = options.loaded_scene(scene_file, overrides, without)
    if parameters:
        from screwsim.explain.parameters import parameters as keys

        say(keys(scene, names or ()))
        return
    if sources:
        from screwsim.explain.sources import sources as cited

        say(cited(scene))
        return
    import screwsim.explain as explained

    if code and names:
        from screwsim.explain.excerpt import code_of

        say(code_of(explained.code(scene), names))
        return
    say(explained.code(scene) if code else str(explained.explain(scene)))


def accuracy(
    scene_file: str = SCENE_FILE,
    folder: File = option("DIR", "Folder for table, data and figure (default: not written).", "-o"),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    quick: bool = switch("--quick", "A shorter study: seconds instead of minutes."),
) -> int:
    """Measure how computing time grows with accuracy: integrators, gases, numerical choices, effects, size."""
    from screwsim.scene.file_kinds import is_stages

    if is_stages(scene_file):
        raise UsageError(f"{scene_file}: describes two stages, and accuracy needs one scene (name that of one stage)")
    scene = options.loaded_point(scene_file, overrides, without)
    options.check_folder(folder)
    from screwsim.report.evidence import accuracy_figure
    from screwsim.report.style import write_all
    from screwsim.results.atomic import make_folder
    from screwsim.study.accuracy import QUICK_SCOPE, NoReference, Scope, files, study, words

    if folder is not None:
        make_folder(folder)
        files.protect_other_studies(folder)
    try:
        with options.counted_progress("accuracy", "measurements") as shown:
            found = study(scene, QUICK_SCOPE if quick else Scope(), shown)
    except NoReference as error:
        return options.print_error(f"{scene_file}: {error}", NOT_ALL_OK)
    say(words.report(found))
    if folder is not None:
        make_folder(folder)  # again: another command may have removed the one that it had made and that was still empty
        written = files.write(found, folder)
        options.print_files([*written, *write_all({"accuracy": partial(accuracy_figure, found)}, folder)])
    return OK
