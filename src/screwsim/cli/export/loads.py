"""Export of the loads of the rotors, and of the sources of noise."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from screwsim.cli import options
from screwsim.cli.declare import Text, Texts, argument, option
from screwsim.cli.export.shared import app
from screwsim.cli.options import AS_JSON, NOT_ALL_OK, OK, OVERRIDES, WITHOUT, print_document_or_text
from screwsim.screen import say

if TYPE_CHECKING:
    pass


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
