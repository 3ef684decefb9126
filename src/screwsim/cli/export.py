"""The command `export`: a machine's map, loads and spectra in the formats of other tools."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import typer

from screwsim.cli import options
from screwsim.cli.declare import Text, Texts, argument, option, switch
from screwsim.cli.options import AS_JSON, JOBS, NOT_ALL_OK, OK, OVERRIDES, WITHOUT, print_document_or_text, progress_bar
from screwsim.screen import say

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from screwsim.export.inputs import Input
    from screwsim.export.map_table import MapTable
    from screwsim.export.polynomials import Polynomials
    from screwsim.study.asked.varied import Varied

app = typer.Typer(
    help="Write files for other tools: FMU, maps for system simulation, rotor loads.",
    no_args_is_help=True,
    suggest_commands=False,
    rich_markup_mode=None,
)

SOURCE = argument("SCENE|OUT.h5", "A scene or two stages to simulate, or the results file of a sweep.")
RANGES = option(
    "PATH=LOW..HIGH", "An input of the map and its range (default: the scene's sweep); repeatable.", "--over"
)
FIGURE_NAMES = option("NAME", "An output of the map (default: flows, powers, temperatures, capacities).", "--figure")
LARGEST_ERROR = option("E", "Largest relative error allowed in the map (default: 0.005).", "--error")
MOST_CASES = option("N", "Largest number of grid points to simulate (default: 5000).", "--most-cases", min=2)
_BAR = partial(progress_bar, "export")


def _announce_map(scene: Varied, inputs: Sequence[Input]) -> None:
    from screwsim.study.asked.inputs import shown_range

    ranges = []
    for one in inputs:
        others = (f"{path} {shown_range(scene, path, values[0], values[-1])}" for path, _, values in one.follows)
        together = " with ".join((shown_range(scene, one.path, one.low, one.high), *others))
        ranges.append(f"{one.name} {together}")
    say(f"export: simulating a map over {', '.join(ranges)}", err=True)


def _announced_after(check: Callable[[Varied, Sequence[Input]], object]) -> Callable[[Varied, Sequence[Input]], None]:
    """Return a function that announces a map once it has passed a check."""

    def announce(scene: Varied, inputs: Sequence[Input]) -> None:
        check(scene, inputs)
        _announce_map(scene, inputs)

    return announce


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
    told = _announced_after(lambda scene, inputs: check_inputs(inputs)) if kind == "polynomial" else _announce_map
    table = map_of(source, over, figures, wanted, most, overrides, without, jobs, _BAR, told)
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
    told = _announced_after(lambda scene, inputs: check_inputs(inputs))
    table = map_of(source, over, figures, wanted, most, overrides, without, jobs, _BAR, told)
    name, changed = identifier(output.stem), options.changes(overrides, without)
    written = [_write_content(output, package(options.titled(table, changed), name))]
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
    table = map_of(source, over, figures, wanted, most, overrides, without, jobs, _BAR, _announce_map)
    changed = options.changes(overrides, without)
    files = [_write_content(output, csv_table(options.titled(table, changed)))]
    return print_map_and_files(table, files, as_json, changed)


@app.command()
def cases(
    source: Path = argument("OUT.h5", "The results file of a sweep or a run."),
    output: Path = option("OUT.csv|.xlsx", "File to write the table to.", "-o", default=..., show_default=False),
    units: Literal["si", "metric", "us"] = option(
        "si|metric|us", "Units: SI; kW, bar, degC, Nm3/h; or hp, psia, degF, acfm, MMSCFD.", "--units", default="si"
    ),
    as_json: bool = AS_JSON,
) -> int:
    """Write every case of a results file as a row: varied paths, status, all figures."""
    options.check_target(output, ".csv", ".xlsx")
    from screwsim.export.cases import case_columns, protect_other_cases, write_cases
    from screwsim.printing import print_json
    from screwsim.results import open_results

    protect_other_cases(output)
    columns = case_columns(open_results(source), units)
    file = write_cases(output, columns)
    if as_json:
        heads = [{"name": each.name, "unit": each.unit, "coverage": each.coverage} for each in columns]
        print_json({"file": file, "cases": len(columns[0].values), "columns": heads})
    else:
        say(file)
    return OK


@app.command()
def tespy(
    source: str = SOURCE,
    output: Path = option("OUT.json", "File to write the attributes to.", "-o", default=..., show_default=False),
    over: Texts = RANGES,
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Write the attributes of TESPy's PolynomialCompressor: efficiency polynomials, one per speed."""
    options.check_target(output, ".json")
    from screwsim.export.polynomials import swept_results
    from screwsim.export.source import refuse_stages
    from screwsim.export.tespy import FIGURES, ONE_MACHINE, check_scene, tespy_document
    from screwsim.results.protection import protect_other_json

    refuse_stages(source, ONE_MACHINE)
    protect_other_json(output, "for", "fluid", "maps")
    told = _announced_after(lambda scene, inputs: check_scene(scene))
    with swept_results(source, over, overrides, without, jobs, _BAR(), told) as results:
        document = tespy_document(results)
    rows = [(each["at"], [each["largest_error"][name] for name in FIGURES]) for each in document["maps"]]
    errors = [tuple(each["errors_by_dissipation_ratio"].values()) for each in document["maps"]]
    kelvin, heat = map(max, zip(*errors, strict=True))
    say(
        "export: TESPy loses one share of the power as heat at all points of a map; that puts the temperature of the "
        f"leaving gas up to {kelvin:.2g} K off, the condenser's heat up to {100.0 * heat:.2g} %",
        err=True,
    )
    if any(sum(each["dissipation_ratio_range"]) < 0.0 for each in document["maps"]):
        why = "TESPy ignores heat added to the gas, e.g. by a motor, so its discharge temperature is too low"
        say(f"export: {why} (dissipation_ratio_range: as a share of the power)", err=True)
    changed = options.changes(overrides, without)
    written = {**document, "title": options.title_with(document["title"], changed)}
    return _print_polynomials_and_files(document, FIGURES, rows, [_write_content(output, written)], as_json, changed)


@app.command()
def energyplus(
    source: str = SOURCE,
    output: Path = option("OUT.idf|.epJSON", "File to write the objects to.", "-o", default=..., show_default=False),
    over: Texts = RANGES,
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Write EnergyPlus curves: bicubic ones with their Refrigeration:Compressor, and biquadratic ones."""
    options.check_target(output, ".idf", ".epjson")
    from screwsim.export import energyplus as made_for
    from screwsim.export.polynomials import check_conditions, document, polynomials, rated_temperatures, swept_results
    from screwsim.results.protection import protect_other_document

    protect_other_document(output, made_for.WRITTEN_MARK, "Version", *made_for.CLASSES)
    told = _announced_after(lambda scene, inputs: check_conditions(scene))
    with swept_results(source, over, overrides, without, jobs, _BAR(), told) as results:
        found = polynomials(results, [made_for.power_of(results.figures), made_for.CAPACITY])
    objects = made_for.energyplus_objects(found, output.stem)
    text, changed = output.suffix.lower() == ".idf", options.changes(overrides, without)
    notes = made_for.notes(options.titled(found, changed))
    file = _write_content(output, made_for.idf(objects, notes) if text else made_for.epjson(objects))
    curves = [made_for.normalised(one, rated_temperatures(one)) for one in found.maps]
    rows = [
        (at, [*errors, *(error for _, error in curve.values())])
        for (at, errors), curve in zip(_polynomial_errors(found), curves, strict=True)
    ]
    errors = [{word: error for word, (_, error) in curve.items()} for curve in curves]
    said = {**document(found), "objects": objects, "largest_errors_of_normalised": errors}
    return _print_polynomials_and_files(said, [*found.units, *curves[0]], rows, [file], as_json, changed)


@app.command()
def en12900(
    source: str = SOURCE,
    output: Path = option(
        "OUT.csv|.json", "File to write coefficients and tables to.", "-o", default=..., show_default=False
    ),
    over: Texts = RANGES,
    ip: bool = switch("--ip", "AHRI 540 in inch-pound units: degF, Btu/h, lb/h."),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Write the coefficients of EN 12900 and AHRI 540 with rating tables."""
    options.check_target(output, ".csv", ".json")
    from screwsim.export import en12900 as made_for
    from screwsim.export.polynomials import DOCUMENT_KEYS, polynomials, swept_results
    from screwsim.results.protection import protect_other_document

    protect_other_document(output, made_for.HEAD_LINE, *DOCUMENT_KEYS, "maps", notes=made_for.NOTES)
    with swept_results(source, over, overrides, without, jobs, _BAR(), _announce_map) as results:
        optional = (name for name in made_for.OPTIONAL_FIGURES if name in results.figures)
        found = polynomials(results, [*made_for.FIGURES, *optional])
    if other := made_for.other_condensing(found):
        say(f"export: {other}", err=True)
    changed, errors = options.changes(overrides, without), _polynomial_errors(found)
    document, titled = made_for.en12900_document(found, ip), options.titled(found, changed)
    made = made_for.en12900_csv if output.suffix.lower() == ".csv" else made_for.en12900_document
    file = _write_content(output, made(titled, ip))
    return _print_polynomials_and_files(document, list(found.units), errors, [file], as_json, changed)


@app.command()
def loads(
    source: str = argument("SCENE|OUT.h5", "A scene, or the results file of a run."),
    output: Path = option("DIR", "Folder for curves, spectra and surfaces.", "-o", default=..., show_default=False),
    steps: int | None = option("N", "Time steps per revolution on the surfaces (default 48).", min=1),
    bearings: Text = option(
        "A,B",
        "Distances of the bearings of both rotors beyond their ends, suction side first, e.g. '40 mm,60 mm' "
        "(default: those of effects.bearings.male and .female; else 0).",
    ),
    shafts: Text = option(
        "A,B",
        "Shaft diameters at the end faces, male rotor first, e.g. '60 mm,50 mm' "
        "(default: effects.bearings.shaft_diameter; else no shaft).",
    ),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    as_json: bool = AS_JSON,
) -> int:
    """Write loads and noise sources: forces on rotors and bearings, flows in both lines, spectra, rotor surfaces."""
    options.check_folder(output)
    from screwsim.export.loads import REVOLUTION_STEPS, check_rotors, loads, protect_other_loads, write_loads
    from screwsim.export.rotor_supports import assumed_of
    from screwsim.export.source import run_of, spans_of
    from screwsim.printing.export import loads_document, print_loads

    protect_other_loads(output)
    spans, through = spans_of(bearings), spans_of(shafts, "--shafts")
    needs_rotors = options.first_given({"--bearings": bearings, "--shafts": shafts, "--steps": steps})
    scene, result = run_of(source, overrides or (), without or (), partial(check_rotors, option=needs_rotors))
    if not result.cycle:
        return options.print_error(f"{source}: {result.told}", NOT_ALL_OK)
    found = loads(scene, result, spans, through)
    if found.without:
        say(f"export: {found.without}", err=True)
    if assumed := found.supports and assumed_of(found.supports[0]):
        say(f"export: {assumed}", err=True)
    changed = options.changes(overrides, without)
    files = write_loads(scene, result, options.titled(found, changed), output, steps or REVOLUTION_STEPS)
    printed = partial(print_loads, changed=changed)
    print_document_or_text(as_json, loads_document, printed, found, result, files)
    options.tell_left(output, files, "forces*.csv", "*_rotor.xdmf", "*_rotor.h5")
    return OK if result.status == "ok" else NOT_ALL_OK


def _polynomial_errors(found: Polynomials) -> list[tuple[dict[str, float], list[float]]]:
    return [(dict(one.values), [fit.largest for fit in one.fits.values()]) for one in found.maps]


def _print_polynomials_and_files(
    document: dict, figures: Sequence[str], rows: list, files: list[str], as_json: bool, changed: Sequence[str]
) -> int:
    from screwsim.export.polynomials import MISSING
    from screwsim.printing.export import print_polynomials

    for text in document.get(MISSING, ()):
        say(f"export: {text}", err=True)
    whole = {**document, "files": files}
    printed = partial(print_polynomials, changed=changed)
    print_document_or_text(as_json, lambda *_: whole, printed, document, figures, rows, files)
    return OK


def _write_content(output: Path, content: str | dict) -> str:
    """Write a text, or a document as JSON; return the path."""
    from screwsim.printing import write_json
    from screwsim.results.atomic import make_folder, write_text

    make_folder(output.parent)
    return write_text(output, content) if isinstance(content, str) else write_json(content, output)
