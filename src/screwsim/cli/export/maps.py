"""Export of a map over any inputs: FMU, Modelica, table."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from screwsim.cli import options
from screwsim.cli.declare import Texts, option, switch
from screwsim.cli.export.shared import BAR, RANGES, SOURCE, announce_map, announced_after, app, write_content
from screwsim.cli.options import AS_JSON, JOBS, NOT_ALL_OK, OK, OVERRIDES, WITHOUT, print_document_or_text
from screwsim.screen import say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from screwsim.export.map_table import MapTable


FIGURE_NAMES = option("NAME", "An output of the map (default: flows, powers, temperatures, capacities).", "--figure")
LARGEST_ERROR = option("E", "Largest relative error allowed in the map (default: 0.005).", "--error")
MOST_CASES = option("N", "Largest number of grid points to simulate (default: 5000).", "--most-cases", min=2)


@app.command()
def fmu(
    source: str = SOURCE,
    output: Path = option("OUT.fmu", "File to write the FMU to.", "-o", default=..., show_default=False),
    over: Texts = RANGES,
    figures: Texts = FIGURE_NAMES,
    wanted: float | None = LARGEST_ERROR,
    most: int | None = MOST_CASES,
    version: Literal["2", "3"] = option("2|3", "FMI version.", "--fmi", default="2"),
    sources_only: bool = switch("--sources-only", "Do not compile; ship C sources for the importing tool."),
    kind: Literal["table", "polynomial"] = option(
        "table|polynomial",
        "C1 table, or AHRI 540 polynomials of both saturation temperatures.",
        "--map",
        default="table",
    ),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Write a functional mock-up unit for co-simulation: C, without Python where it runs."""
    options.check_target(output, ".fmu")
    from screwsim.export.fmu import compiler, protect_other_units, write_fmu
    from screwsim.export.polynomial_table import check_inputs, polynomial_table
    from screwsim.export.source import map_of
    from screwsim.results.atomic import make_folder

    protect_other_units(output)
    if not sources_only:
        compiler()  # reports a missing compiler before the map is simulated
    told = announced_after(lambda scene, inputs: check_inputs(inputs)) if kind == "polynomial" else announce_map
    table = map_of(source, over, figures, wanted, most, overrides, without, jobs, BAR, told)
    if kind == "polynomial":
        table = polynomial_table(table, wanted)
    make_folder(output.parent)
    changed = options.changes(overrides, without)
    write_fmu(options.titled(table, changed), output, version, compiled=not sources_only)
    return print_map_and_files(table, [str(output)], as_json, changed)


@app.command()
def modelica(
    source: str = SOURCE,
    output: Path = option("OUT.mo", "File to write the package to.", "-o", default=..., show_default=False),
    over: Texts = RANGES,
    figures: Texts = FIGURE_NAMES,
    wanted: float | None = LARGEST_ERROR,
    most: int | None = MOST_CASES,
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Write a Modelica package of a map with two inputs: standard-library tables, and polynomials."""
    options.check_target(output, ".mo")
    from screwsim.export.modelica import WRITTEN_MARK, check_inputs, identifier, package
    from screwsim.export.source import map_of
    from screwsim.results.protection import protect_unmarked

    protect_unmarked(output, WRITTEN_MARK)
    told = announced_after(lambda scene, inputs: check_inputs(inputs))
    table = map_of(source, over, figures, wanted, most, overrides, without, jobs, BAR, told)
    name, changed = identifier(output.stem), options.changes(overrides, without)
    written = [write_content(output, package(options.titled(table, changed), name))]
    if name != output.stem:
        say(f"{output}: holds package {name}; tools that look packages up by file name expect {name}.mo", err=True)
    return print_map_and_files(table, written, as_json, changed)


@app.command("csv")
def comma_separated(
    source: str = SOURCE,
    output: Path = option("OUT.csv", "File to write the table to.", "-o", default=..., show_default=False),
    over: Texts = RANGES,
    figures: Texts = FIGURE_NAMES,
    wanted: float | None = LARGEST_ERROR,
    most: int | None = MOST_CASES,
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Write the nodes of a map as a table in SI units."""
    options.check_target(output, ".csv")
    from screwsim.export.source import map_of
    from screwsim.export.table import TITLE_SEPARATOR, csv_table
    from screwsim.results.protection import protect_unmarked

    protect_unmarked(output, TITLE_SEPARATOR)
    table = map_of(source, over, figures, wanted, most, overrides, without, jobs, BAR, announce_map)
    changed = options.changes(overrides, without)
    files = [write_content(output, csv_table(options.titled(table, changed)))]
    return print_map_and_files(table, files, as_json, changed)


def print_map_and_files(table: MapTable, files: list[str], as_json: bool, changed: Sequence[str]) -> int:
    """Print a map, with what the command line changes in its scene, and its files.

    Return the exit code, not ok where its error exceeds the requested one.
    """
    from screwsim.printing.export import map_document, print_map

    print_document_or_text(as_json, map_document, partial(print_map, changed=changed), table, files)
    if table.met:
        return OK
    why = f"the error {table.error:.2g} is above the {table.wanted:g} requested"
    return options.print_error(f"export: {why} (narrow the ranges, or allow more --most-cases)", NOT_ALL_OK)
