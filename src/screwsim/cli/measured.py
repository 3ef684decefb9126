"""The commands on measured points of a machine: what has changed since, and which points to measure next."""

from typing import Annotated

from screwsim.cli.declare import File, Texts, argument, option
from screwsim.cli.options import NOT_ALL_OK, OK, AsJson, Jobs, bar, check_target, show
from screwsim.inputs.faults import UsageError
from screwsim.screen import say

FitFile = Annotated[str, argument("FIT", "Machine, parameters and points: a fit's YAML file.")]
OtherScene = Annotated[
    File, option("SCENE", "The machine, in place of the fit's own: e.g. scene.yaml of a calibration.", "--scene")
]
OtherData = Annotated[File, option("POINTS.csv", "Measured points in place of those of the fit.", "--data")]


def diagnose(
    fit_file: FitFile,
    scene: OtherScene = None,
    data: OtherData = None,
    unchanged: Annotated[float, option("P", "How probable it is beforehand that nothing changed.")] = 0.5,
    pairs: Annotated[float, option("ODDS", "Odds beforehand of two changes at once against one; 0: one alone.")] = 0.1,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Tell from new measured points which parameters of a machine have changed, one or two, and how probably."""
    from screwsim.printing.diagnosis import diagnosis_document, print_diagnosis
    from screwsim.study.calibration import read_fit
    from screwsim.study.calibration.diagnosis import diagnose as diagnosed

    fit = read_fit(fit_file, scene=scene, data=data, fixed=False)
    found = diagnosed(fit, unchanged=unchanged, pairs=pairs, jobs=jobs, progress=bar("diagnose"))
    show(as_json, diagnosis_document, print_diagnosis, found)
    return OK if found.status == "ok" else NOT_ALL_OK


def plan(
    fit_file: FitFile,
    candidates: Annotated[
        File, option("GRID.csv", "The operating points that could be measured.", "--candidates")
    ] = None,
    paths: Annotated[
        Texts, option("PATH=LOW..HIGH", "Or: all combinations of values of such ranges; repeat it.", "--path")
    ] = None,
    levels: Annotated[int | None, option("N", "Values of each range (default 4).")] = None,
    count: Annotated[int, option("N", "How many points are chosen.")] = 3,
    output: Annotated[File, option("NEXT.csv", "Write them as data of a fit, to be filled in.", "-o")] = None,
    scene: OtherScene = None,
    data: OtherData = None,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Choose the operating points that would tell most about the parameters of a fit, beside its own."""
    check_target(output, ".csv")
    from screwsim.printing.plan import keep_measured, plan_document, print_plan, write_plan
    from screwsim.study.calibration import read_fit
    from screwsim.study.calibration.plan import LEVELS, candidates_of
    from screwsim.study.calibration.plan import plan as planned

    if levels is not None and not paths:
        raise UsageError(f"--levels {levels}: is of ranges (write --path PATH=LOW..HIGH)")
    if output is not None:
        keep_measured(output)
    fit = read_fit(fit_file, scene=scene, data=data, fixed=False)
    points = candidates_of(fit, candidates, paths or (), LEVELS if levels is None else levels)
    found = planned(fit, points, count=count, jobs=jobs, progress=bar("plan"))
    show(as_json, plan_document, print_plan, found)
    if output is not None and found.steps:
        say(write_plan(output, found), err=as_json)
    return OK if found.status == "ok" else NOT_ALL_OK
