"""The commands that ask measured points of a machine: what has changed since, and which points to measure next."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from screwsim.cli.options import NOT_ALL_OK, OK, AsJson, Jobs, option

FitFile = Annotated[
    str, typer.Argument(metavar="FIT", help="Machine, parameters and points: a fit's YAML file.", show_default=False)
]
OtherScene = Annotated[
    Path | None, option("SCENE", "The machine, in place of the fit's own: e.g. scene.yaml of a calibration.", "--scene")
]
OtherData = Annotated[Path | None, option("POINTS.csv", "Measured points in place of those of the fit.", "--data")]


def diagnose(
    fit_file: FitFile,
    scene: OtherScene = None,
    data: OtherData = None,
    unchanged: Annotated[float, option("P", "How probable it is beforehand that nothing changed.")] = 0.5,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Tell from new measured points which one parameter of a machine has changed, and with what probability."""
    from screwsim.printing import show
    from screwsim.printing.diagnosis import diagnosis_document, print_diagnosis
    from screwsim.study.calibration import read_fit
    from screwsim.study.calibration.diagnosis import diagnose as diagnosed
    from screwsim.study.progress import for_terminal

    fit = read_fit(fit_file, scene=scene, data=data, fixed=False)
    found = diagnosed(fit, unchanged=unchanged, jobs=jobs, progress=for_terminal("diagnose"))
    show(as_json, diagnosis_document, print_diagnosis, found)
    return OK if found.status == "ok" else NOT_ALL_OK
