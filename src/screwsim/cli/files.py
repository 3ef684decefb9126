"""The commands that show: rotors, results as figures and as a page, comparisons with sources, schemas."""

from pathlib import Path
from shlex import quote

from screwsim.cli import options
from screwsim.cli.declare import File, Text, Texts, argument, option, switch
from screwsim.cli.options import AS_JSON, JOBS, NOT_ALL_OK, OK, OVERRIDES, RESULTS_FILE, SCENE_FILE, WITHOUT
from screwsim.inputs.faults import Interrupted, UsageError
from screwsim.screen import say


def rotors(
    scene_file: str = SCENE_FILE,
    folder: File = option("DIR", "Folder for figures, page, profiles and tables.", "-o"),
    overrides: Texts = OVERRIDES,
    as_json: bool = AS_JSON,
) -> None:
    """Print and draw the rotor geometry that follows from a scene's profile."""
    options.check_folder(folder)
    scene = options.loaded_point(scene_file, overrides, None)
    from screwsim.printing import print_json
    from screwsim.report.rotors_scene import document, table_text, write
    from screwsim.scene.plausible import scene_warnings

    text = table_text(scene)
    for warning in (each for each in scene_warnings(scene) if each.startswith("machine.")):
        say(f"warning: {warning}", err=True)
    files = write(scene, folder) if folder is not None else []
    if as_json:
        print_json(document(scene, files))
    else:
        say(text)
        options.print_files(files)
    if folder is not None:
        options.tell_left(folder, files, "curves/*_face_*.csv", "table/*_leakage.csv", "table/blow_hole.csv")


def plot(
    results_file: str = RESULTS_FILE,
    folder: Text = option("DIR", "Folder for the figures.", "-o"),
    measured: File = option(
        "POINTS.csv", "Measured chamber pressures to draw, too (columns angle_deg or volume_cm3, and pressure_bar)."
    ),
    at: Texts = option(
        "PATH=VALUE",
        "Of a sweep: draw the cycle of this case, not the best; e.g. operation.speed='2950 rpm'; repeatable.",
    ),
) -> None:
    """Draw the figures of a results file."""
    options.check_folder(Path(folder) if folder is not None else None)
    from screwsim.report import plot as drawn
    from screwsim.results.chosen import case_in_words, read_case

    asked = read_case(at or ())
    if measured is None:
        options.print_files(drawn(results_file, folder, at=asked))
        return
    from screwsim.figures.indicated import read_indicated
    from screwsim.printing.tables import print_text
    from screwsim.report.indicated import at_angles, deviation_in_words, shift_in_words
    from screwsim.report.trace import best_case, chosen_trace, status_in_words
    from screwsim.results import open_results

    read, results = read_indicated(measured), open_results(results_file)
    if results.stages:
        alone = f"screwsim scene {quote(results_file)} --stage {next(iter(results.stages))} gives its scene, to be run"
        raise UsageError(f"{results_file}: holds two stages, and --measured needs the results of one machine ({alone})")
    results = results.showing(asked) if asked else results
    trace, index = chosen_trace(results), best_case(results) if "angle" in results.cycle else None
    if trace is None or index is None:
        remedy = "run stores one; a sweep with output.keep: cycle those of its cases that closed"
        raise UsageError(f"{results_file}: holds no cycle to compare ({remedy})")
    points = at_angles(read, trace)
    files = drawn(results_file, folder, points, asked)
    case = case_in_words(results, index)
    if case:
        print_text(f"at {case}" if asked else f"at {case}, the best case (--at PATH=VALUE chooses another)")
    if refused := status_in_words(results, index):
        print_text(f"status: {refused}")
    print_text(deviation_in_words(points, trace))
    shift = shift_in_words(points, trace)
    if shift:
        print_text(shift)
    options.print_files(files)


def scene(
    results_file: str = RESULTS_FILE,
    output: File = option("SCENE.yaml", "File to write it to, two stages beside it (default: the screen).", "-o"),
    stage: Text = option("first|second", "Of two stages: this one alone, with the line between both as found."),
) -> None:
    """Write the scene stored in a results file, to simulate it again."""
    options.check_target(output, ".yaml", ".yml")
    from screwsim.results import open_results
    from screwsim.results.atomic import write_text
    from screwsim.results.read import stage_scene, stored_scenes

    results = open_results(results_file)
    scenes = stored_scenes(results) if stage is None else {"": stage_scene(results, stage)}
    if output is None:
        say("\n".join(f"# {file}\n{text}" if file else text for file, text in scenes.items()).rstrip("\n"))
        if len(scenes) > 1:
            say("scene: these are several files (-o NAME.stages.yaml writes all, to be simulated)", err=True)
        return
    places = {output.with_name(file or output.name): text for file, text in scenes.items()}
    if len(places) < len(scenes):
        named = ", ".join(filter(None, scenes))
        raise UsageError(f"-o {output}: is the name of a stage's file, {named} (choose another name)")
    for place in places:
        options.check_new(place)
    options.print_files([write_text(place, text) for place, text in places.items()])


def report(
    results_file: str = RESULTS_FILE,
    output: Text = option("OUT.html", "File to write the page to (default: next to OUT.h5).", "-o"),
    other: Text = option("OTHER.h5", "The paper's other sweep; its claims need both.", "--with"),
) -> None:
    """Make one HTML page of a results file: figures, cycles, checks, scene; it opens offline in any browser."""
    from screwsim.report.page import pages
    from screwsim.results import open_results
    from screwsim.study.claims import claims_of

    open_results(results_file)  # a file that is missing is told before a place that cannot be written
    target = output or str(Path(results_file).with_suffix(".html"))
    options.check_page(Path(target))
    options.print_files(pages(results_file, target, claims_of(results_file, other)))


def validate(
    names: Texts = argument("[NAME]...", "Sources (default: all).", None),
    folder: File = option("DIR", "Folder of the reference programs to run (default: those of this package)."),
    output: File = option("DIR", "Folder for validation.json and a figure per source.", "-o"),
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Compare computed results with published references. A failed comparison still exits with 0."""
    options.check_folder(output)
    from screwsim.printing import print_json, write_json
    from screwsim.report.evidence import draw_validation
    from screwsim.results.atomic import make_folder
    from screwsim.results.protection import protect_other_json
    from screwsim.study.validation import INTERRUPTED, document, errors_of, folder_of, run_sources
    from screwsim.study.validation.record import errors_report, report

    if output is not None:
        protect_other_json(output / "validation.json", "version", "verdicts", "sources")
    try:
        outcomes = run_sources(folder_of(folder), names or (), options.progress_bar("validate"), jobs)
    except Interrupted as pressed:
        outcomes = pressed.found
    found, errors = document(outcomes), errors_of(outcomes)
    if as_json:
        print_json({**found, "model_errors": errors, "seconds": {each.name: each.seconds for each in outcomes}})
    else:
        say(report(found))
        if errors:
            say(f"\n{errors_report(errors)}")
    stopped = any(outcome.reason == INTERRUPTED for outcome in outcomes)
    kept = None if output is None or not stopped else output / "validation.json"
    if kept is not None and kept.exists():  # it may hold all sources
        say(f"{kept}: stays as it was, since not all sources were compared (name another -o for these)", err=True)
    elif output is not None:
        make_folder(output)
        written = [write_json(found, output / "validation.json")]
        written += [write_json(errors, output / "model_errors.json")] if errors else []
        options.print_files([*written, *draw_validation(found, output)], as_json)
    if stopped:
        return options.INTERRUPTED
    return OK if all(outcome.comparison is not None for outcome in outcomes) else NOT_ALL_OK


def schema(
    fit: bool = switch("--fit", "Schema of a fit (screwsim calibrate) instead."),
    stages: bool = switch("--stages", "Schema of a two-stage file instead."),
) -> None:
    """Print the JSON Schema of a scene."""
    from screwsim.printing import print_json

    if fit and stages:
        raise UsageError("--fit and --stages are schemas of different files (ask for one of the two)")
    if stages:
        from screwsim.study.stages import stages_schema as wanted
    elif fit:
        from screwsim.study.calibration.read import fit_schema as wanted
    else:
        from screwsim.scene import schema as wanted
    print_json(wanted())


def explore(
    scene_file: str = SCENE_FILE,
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    port: int | None = option("N", "Port (default: 8421, or any that is free).", "--port", min=0, max=65535),
    host: str = option(
        "ADDRESS", "Address to listen on; any but loopback requires a token.", "--host", default="127.0.0.1"
    ),
    browser: bool = switch("--browser/--no-browser", "Open the page in a browser.", default=True),
) -> None:
    """Open a scene as a live page in the browser: sliders, turning rotors, p–V diagram; Ctrl-C ends it."""
    from screwsim.explore import check_extra

    check_extra()
    from screwsim.explore.serve import serve

    serve(scene_file, overrides or (), without or (), host, port, browser, say)
