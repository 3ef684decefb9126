"""The command that rates: a scene's data sheet, in the form that its trade uses."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from screwsim.cli import options
from screwsim.cli.options import NOT_ALL_OK, OK, AsJson, Overrides, SceneFile, Without, loaded, option
from screwsim.screen import say


def datasheet(
    scene_file: SceneFile,
    output: Annotated[Path | None, option("OUT.html", "Write the sheet as a page.", "-o")] = None,
    overrides: Overrides = None,
    without: Without = None,
    as_json: AsJson = False,
) -> int:
    """Rate an air package by ISO 1217: flow, power, efficiency from full to lowest flow (sweep.operation.speed)."""
    scene = loaded(scene_file, overrides, without)
    if output is not None:
        options.check_page(output)
    from screwsim.printing import print_json
    from screwsim.printing.datasheet import print_sheet
    from screwsim.report.datasheet import write_page
    from screwsim.study.datasheet import sheet_of

    sheet = sheet_of(scene)
    if as_json:
        print_json(sheet.document)
    else:
        print_sheet(sheet)
    if output is not None:
        say(write_page(sheet, output), err=as_json)
    return OK if sheet.ok else NOT_ALL_OK
