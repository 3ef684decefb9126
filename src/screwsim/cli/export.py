"""The command `export`: a machine's map, loads and spectra in the forms that other tools read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from screwsim.cli import options
from screwsim.cli.options import NOT_ALL_OK, OK, AsJson, Jobs, Overrides, Without, option

if TYPE_CHECKING:
    from screwsim.export.table import Table

app = typer.Typer(
    help="Write what other tools read: FMU, maps for system simulation, loads of the rotors.",
    no_args_is_help=True,
    suggest_commands=False,
    rich_markup_mode=None,
)

Source = Annotated[
    str,
    typer.Argument(metavar="SCENE|OUT.h5", help="A scene, which is simulated, or a sweep's file.", show_default=False),
]
Over = Annotated[
    list[str] | None,
    option("PATH=LOW..HIGH", "What the map is over (default: the scene's sweep); repeat it.", "--over"),
]
Named = Annotated[
    list[str] | None,
    option("NAME", "What it gives (default: flow, power, discharge temperature, capacity).", "--figure"),
]
Wanted = Annotated[
    float | None, option("E", "Relative error of the map that is asked for (default: 0.005).", "--error")
]
Most = Annotated[int | None, option("N", "Cases of the grid at most (default: 5000).", "--most-cases", min=2)]
RANGES = "narrow the ranges, or allow more --most-cases"


def made(
    source: str,
    over: Over,
    figures: Named,
    wanted: Wanted,
    most: Most,
    overrides: Overrides,
    without: Without,
    jobs: Jobs,
) -> Table:
    """Return the map that a command names, and say on stderr what is simulated for it."""
    from screwsim.export.inputs import range_of
    from screwsim.export.source import map_of
    from screwsim.study.progress import for_terminal

    def told(scene, inputs) -> None:
        ranges = ", ".join(f"{one.name} {range_of(scene, one)}" for one in inputs)
        typer.echo(f"export: simulating a map over {ranges}", err=True)

    return map_of(
        source,
        over or (),
        figures or (),
        wanted,
        most,
        overrides or (),
        without or (),
        jobs,
        lambda: for_terminal("export"),
        told,
    )


def ended(table: Table, files: list[str], as_json: bool) -> int:
    """Print a map and its files; return the exit code, not ok where its error is above that asked for."""
    from screwsim.printing import show
    from screwsim.printing.export import map_document, print_map, shortfall

    show(as_json, map_document, print_map, table, files)
    if why := shortfall(table, RANGES):
        return options.complain(f"export: {why}", NOT_ALL_OK)
    return OK


@app.command()
def fmu(
    source: Source,
    output: Annotated[Path, option("OUT.fmu", "Where the unit goes.", "-o", show_default=False)],
    over: Over = None,
    figures: Named = None,
    wanted: Wanted = None,
    most: Most = None,
    version: Annotated[Literal["2", "3"], option("2|3", "Version of FMI.", "--fmi")] = "2",
    sources_only: Annotated[
        bool, typer.Option("--sources-only", help="Do not compile: C for whoever imports it.")
    ] = False,
    overrides: Overrides = None,
    without: Without = None,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Write a functional mock-up unit for co-simulation: C, without Python where it runs."""
    options.check_target(output, ".fmu")
    from screwsim.export.fmu import compiler, write_fmu
    from screwsim.results.atomic import keep_others, make_folder

    keep_others(output, b"PK\x03\x04")
    if not sources_only:
        compiler()  # is asked for before the map is simulated
    table = made(source, over, figures, wanted, most, overrides, without, jobs)
    make_folder(output.parent)
    write_fmu(table, output, version, compiled=not sources_only)
    return ended(table, [str(output)], as_json)
