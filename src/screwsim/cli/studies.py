"""The commands of studies: many solutions, or stored results, for one question."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from screwsim.cli.options import NOT_ALL_OK, OK, AsJson, Jobs, Overrides, SceneFile, Without, loaded


def optimum(
    scene_file: SceneFile,
    path: Annotated[str, typer.Option(metavar="PATH", help="What is varied.")] = "oil_supply.ratio",
    figure: Annotated[str, typer.Option(metavar="NAME", help="What is to be highest.")] = "isothermal_efficiency",
    minimum: Annotated[bool, typer.Option("--minimum", help="Look for the lowest instead.")] = False,
    first: Annotated[str | None, typer.Option("--from", metavar="VALUE", help="Where the range begins.")] = None,
    last: Annotated[str | None, typer.Option("--to", metavar="VALUE", help="Where the range ends.")] = None,
    output: Annotated[Path | None, typer.Option("-o", metavar="OUT.csv|.h5", help="Write the table.")] = None,
    overrides: Overrides = None,
    without: Without = None,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Find the best value of one path, for each point of the sweep's other axes."""
    scene = loaded(scene_file, overrides, without)
    from screwsim.printing import print_json
    from screwsim.printing.optimum import optimum_document, print_optimum, write_optimum
    from screwsim.study.columns import check_target
    from screwsim.study.optimum import optimum as found
    from screwsim.study.optimum import question
    from screwsim.study.progress import for_terminal

    asked = question(scene, path, figure, minimum=minimum, first=first, last=last)
    if output is not None:
        check_target(output, (".csv", ".h5"))
    rows = found(scene, asked, jobs=jobs, progress=for_terminal("optimum"))
    if output is not None:
        write_optimum(output, scene, asked, rows)
    if as_json:
        print_json(optimum_document(scene, asked, rows))
    else:
        print_optimum(scene, asked, rows)
    return OK if all(row.status == "ok" and not row.failed for row in rows) else NOT_ALL_OK


def add_to(app: typer.Typer) -> None:
    """Add these commands."""
    app.command()(optimum)
