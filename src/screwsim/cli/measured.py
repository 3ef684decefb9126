"""The commands on measured points of a machine: what has changed since, and which points to measure next."""

from typing import Annotated

from screwsim.cli.declare import File, Texts, argument, option
from screwsim.cli.options import (
    NOT_ALL_OK,
    OK,
    AsJson,
    Jobs,
    check_target,
    print_document_or_text,
    print_files,
    progress_bar,
)
from screwsim.inputs.faults import UsageError

FitFile = Annotated[str, argument("FIT", "Machine, parameters and points: a fit's YAML file.")]
OtherScene = Annotated[
    File, option("SCENE", "Machine to use instead of the fit's own, e.g. scene.yaml of a calibration.", "--scene")
]
OtherData = Annotated[File, option("POINTS.csv", "Measured points to use instead of the fit's own.", "--data")]


def diagnose(
    fit_file: FitFile,
    scene: OtherScene = None,
    data: OtherData = None,
    unchanged: Annotated[float, option("P", "Prior probability that nothing has changed.")] = 0.5,
    pairs: Annotated[float, option("ODDS", "Prior odds of two changes against one; 0: single changes only.")] = 0.1,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Find from new measurements which one or two parameters of a machine have changed, with probabilities."""
    from screwsim.printing.diagnosis import diagnosis_document, print_diagnosis
    from screwsim.study.calibration import read_fit
    from screwsim.study.calibration.diagnosis import diagnose as diagnosed

    fit = read_fit(fit_file, scene=scene, data=data, fixed=False)
    found = diagnosed(fit, unchanged=unchanged, pairs=pairs, jobs=jobs, progress=progress_bar("diagnose"))
    print_document_or_text(as_json, diagnosis_document, print_diagnosis, found)
    return OK if found.status == "ok" else NOT_ALL_OK


def plan(
    fit_file: FitFile,
    candidates: Annotated[File, option("GRID.csv", "Operating points that could be measured.", "--candidates")] = None,
    paths: Annotated[
        Texts,
        option(
            "PATH=LOW..HIGH",
            "Or a range of a condition; all combinations of the ranges are candidates; repeatable.",
            "--path",
        ),
    ] = None,
    levels: Annotated[int | None, option("N", "Values per range (default 4).")] = None,
    count: Annotated[int, option("N", "Number of points to choose.")] = 3,
    output: Annotated[File, option("NEXT.csv", "Write them as a data file for a fit, to be filled in.", "-o")] = None,
    scene: OtherScene = None,
    data: OtherData = None,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Choose further operating points whose measurement would fix the parameters of a fit best."""
    check_target(output, ".csv")
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
    found = planned(fit, points, count=count, jobs=jobs, progress=progress_bar("plan"))
    print_document_or_text(as_json, plan_document, print_plan, found)
    if output is not None and found.steps:
        print_files([write_plan(output, found)], as_json)
    return OK if found.status == "ok" else NOT_ALL_OK
