"""Export of polynomials of both saturation temperatures, and of efficiencies."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from screwsim.cli import options
from screwsim.cli.declare import Texts, option, switch
from screwsim.cli.export.shared import BAR, RANGES, SOURCE, announce_map, announced_after, app, write_content
from screwsim.cli.options import AS_JSON, JOBS, OK, OVERRIDES, WITHOUT, print_document_or_text
from screwsim.screen import say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from screwsim.export.polynomials import Polynomials


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
    told = announced_after(lambda scene, inputs: check_scene(scene))
    with swept_results(source, over, overrides, without, jobs, BAR(), told) as results:
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
    return _print_polynomials_and_files(document, FIGURES, rows, [write_content(output, written)], as_json, changed)


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
    told = announced_after(lambda scene, inputs: check_conditions(scene))
    with swept_results(source, over, overrides, without, jobs, BAR(), told) as results:
        found = polynomials(results, [made_for.power_of(results.figures), made_for.CAPACITY])
    objects = made_for.energyplus_objects(found, output.stem)
    text, changed = output.suffix.lower() == ".idf", options.changes(overrides, without)
    notes = made_for.notes(options.titled(found, changed))
    file = write_content(output, made_for.idf(objects, notes) if text else made_for.epjson(objects))
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
    with swept_results(source, over, overrides, without, jobs, BAR(), announce_map) as results:
        optional = (name for name in made_for.OPTIONAL_FIGURES if name in results.figures)
        found = polynomials(results, [*made_for.FIGURES, *optional])
    if other := made_for.other_condensing(found):
        say(f"export: {other}", err=True)
    changed, errors = options.changes(overrides, without), _polynomial_errors(found)
    document, titled = made_for.en12900_document(found, ip), options.titled(found, changed)
    made = made_for.en12900_csv if output.suffix.lower() == ".csv" else made_for.en12900_document
    file = write_content(output, made(titled, ip))
    return _print_polynomials_and_files(document, list(found.units), errors, [file], as_json, changed)


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
