"""The command `startup`: a drive from a creeping speed to its steady one."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from screwsim.cli.options import NOT_ALL_OK, OK, AsJson, Overrides, SceneFile, Without, base_point, check_drawer, loaded
from screwsim.screen import say

RPM = math.pi / 30.0


def startup(
    scene_file: SceneFile,
    folder: Annotated[Path | None, typer.Option("-o", metavar="DIR", help="Where traces and figure go.")] = None,
    creep: Annotated[float, typer.Option(min=0.1, metavar="RPM", help="Speed at which the start begins.")] = 30.0,
    longest: Annotated[float, typer.Option(min=0.01, metavar="SECONDS", help="Give up after so long.")] = 10.0,
    overrides: Overrides = None,
    without: Without = None,
    as_json: AsJson = False,
) -> int:
    """Start a machine that has a drive, against the discharge pressure."""
    check_drawer(folder)
    scene = base_point(loaded(scene_file, overrides, without), scene_file)
    from screwsim.printing import print_json
    from screwsim.printing.startup import text, write_traces
    from screwsim.report.drive import draw_start
    from screwsim.results.atomic import make_folder
    from screwsim.start_up import start_up

    if folder is not None:
        make_folder(folder)
    found = start_up(scene, creep * RPM, longest)
    if as_json:
        print_json(found.as_json())
    else:
        say(text(scene.title, found))
    if folder is not None and found.traces:
        for path in (write_traces(folder / "startup.csv", found), *draw_start(found, scene.title, folder)):
            say(path, err=as_json)
    return OK if found.status == "ok" else NOT_ALL_OK


def add_to(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(startup)
