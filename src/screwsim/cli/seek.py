"""The search commands: values for given figures, and best values of paths."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from screwsim.cli import options
from screwsim.cli.declare import File, Text, Texts, option, switch
from screwsim.cli.options import NOT_ALL_OK, OK, AsJson, Jobs, Overrides, SceneFile, Without, bar, loaded, show
from screwsim.inputs.faults import UsageError
from screwsim.screen import say

if TYPE_CHECKING:
    from screwsim.study.optimize import Optimum


def find(
    scene_file: SceneFile,
    vary: Annotated[
        Texts, option("PATH[=LOW..HIGH]", "What is varied, e.g. operation.speed; repeat it.", "--vary")
    ] = None,
    goals: Annotated[
        Texts, option("FIGURE=VALUE", "What is wanted, e.g. 'cooling_capacity=500 kW'; repeat it.", "--for")
    ] = None,
    catalogue: Annotated[
        Text, option("SIZES", "Sizes that there are, e.g. '140,163,204 mm': the next one up.", "--catalogue")
    ] = None,
    output: Annotated[
        File, option("FOUND.yaml", "Write the scene found (the rows of a sweep: .csv, .h5).", "-o")
    ] = None,
    overrides: Overrides = None,
    without: Without = None,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Find the values of paths at which figures are what you want: a speed for a capacity, a size for a duty."""
    scene = loaded(scene_file, overrides, without)
    from screwsim.printing.find import find_document, print_find, write_find
    from screwsim.scene import case_count
    from screwsim.scene.grid import only
    from screwsim.study.seek import find_each, question
    from screwsim.study.written import check_scene_file, write_found

    asked = question(scene, vary or (), goals or (), catalogue or ())
    varied = [span.path for span in asked.spans]
    several = case_count(only(scene, [path for path in scene.sweep if path not in varied])) > 1
    table = output is not None and output.suffix.lower() in (".csv", ".h5")
    if table:
        options.check_columns(output, "goal seek", "solutions", "failed_solutions", "status", "message")
    if output is not None and not table:
        if several:
            raise UsageError(f"-o {output}: the sweep gives several answers, a row each (write -o FOUND.csv or .h5)")
        check_scene_file(output)
    rows = find_each(scene, asked, jobs=jobs, progress=bar("find"))
    show(as_json, find_document, print_find, scene, asked, rows)
    found = rows[0]
    if output is not None and table:
        write_find(output, scene, asked, rows)
    elif output is not None and found.scene is not None:
        values = {varied[0]: found.size.value} if found.size else found.values
        wanted = ", ".join(f"--for '{text}'" for text in goals or ())
        told = f"find {Path(scene_file).name} --vary {', '.join(varied)} {wanted}"
        say(write_found(output, found.scene, values, scene_file, overrides or (), without or (), told), err=True)
    return OK if all(row.status == "ok" for row in rows) else NOT_ALL_OK


def optimize(
    scene_file: SceneFile,
    vary: Annotated[
        Texts, option("PATH=LOW..HIGH", "What is varied, e.g. oil_supply.ratio=0.3..3; repeat it.", "--vary")
    ] = None,
    maximize: Annotated[Texts, option("FIGURE", "What is to be highest; repeat it.", "--maximize")] = None,
    minimize: Annotated[Texts, option("FIGURE", "What is to be lowest; repeat it.", "--minimize")] = None,
    subject_to: Annotated[
        Texts, option("FIGURE<VALUE", "A bound, e.g. 'discharge_temperature<90 degC'; repeat it.", "--subject-to")
    ] = None,
    over: Annotated[
        Text, option("POINTS.csv|NAME", "Weighted over points: a file, IPLV, ESEER, SEER, SEPR, or …-water.", "--over")
    ] = None,
    print_points: Annotated[
        bool, switch("--print-points", "Print the points of --over as CSV, to be changed, and end.")
    ] = False,
    output: Annotated[File, option("OUT.h5", "Keep all evaluations; an interrupted run goes on.", "-o")] = None,
    best: Annotated[File, option("BEST.yaml", "Write the best scene (of one aim).", "--best")] = None,
    evaluations: Annotated[int | None, option("N", "Sets of values at most (default: 100 a path).", min=1)] = None,
    seed: Annotated[int, option("N", "Seed of the search.", min=0)] = 1,
    overrides: Overrides = None,
    without: Without = None,
    jobs: Jobs = None,
    restart: Annotated[bool, switch("--restart", "Compute again what is there.")] = False,
    as_json: AsJson = False,
) -> int:
    """Find the values of paths at which figures are best: one aim or several, within bounds, over operating points."""
    scene = loaded(scene_file, overrides, without)
    from screwsim.printing.optimize import optimize_document, print_optimize
    from screwsim.study.optimize import question, run, spans_of
    from screwsim.study.optimize.points import as_csv, read_points
    from screwsim.study.written import check_scene_file, write_found

    if print_points:
        if over is None:
            raise UsageError("--print-points: needs --over NAME, e.g. --over SEPR")
        say(as_csv(read_points(scene, over)).rstrip())
        return OK
    spans = spans_of(scene, vary or ())
    base = options.base_point(scene, scene_file)
    more = {"subject_to": subject_to or (), "over": over, "evaluations": evaluations, "seed": seed}
    asked = question(base, spans, maximize or (), minimize or (), **more)
    if output is not None:
        options.check_results(output)
    if best is not None:
        if len(asked.aims) > 1:
            remedy = "take one of the front: --json has its values"
            raise UsageError(f"--best {best}: of several aims there is no best ({remedy})")
        check_scene_file(best, "--best")
    found = run(asked, output, jobs=jobs, restart=restart, progress=bar("optimize"))
    show(as_json, optimize_document, print_optimize, found)
    if best is not None and found.scene is not None:
        told = f"optimize {Path(scene_file).name} --vary {', '.join(span.path for span in asked.spans)}"
        values = rounded_values(found)
        say(write_found(best, found.scene, values, scene_file, overrides or (), without or (), told), err=True)
    return OK if found.status == "ok" else NOT_ALL_OK


def rounded_values(found: Optimum) -> dict[str, float]:
    """Return the best values [SI], rounded as written."""
    from screwsim.study.seek import rounded

    return rounded(found.asked.scene, found.values)
