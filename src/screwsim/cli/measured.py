"""The commands on measured points of a machine: what has changed since, and which points to measure next."""

from screwsim.cli import options
from screwsim.cli.declare import File, Texts, argument, option
from screwsim.cli.options import AS_JSON, JOBS, NOT_ALL_OK, OK
from screwsim.inputs.faults import UsageError

FIT_FILE = argument("FIT", "Machine, parameters and points: a fit's YAML file.")
OTHER_SCENE = option("SCENE", "Machine to use instead of the fit's own, e.g. scene.yaml of a calibration.", "--scene")
OTHER_DATA = option("POINTS.csv", "Measured points to use instead of the fit's own.", "--data")


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
    options.check_target(output, ".csv")
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
