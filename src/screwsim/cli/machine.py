"""Commands on a machine as it is sold: its data sheet, and its start by its drive."""

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Literal

from screwsim.cli import options
from screwsim.cli.declare import File, Text, Texts, option, switch
from screwsim.cli.options import AS_JSON, JOBS, NOT_ALL_OK, OK, OVERRIDES, SCENE_FILE, WITHOUT
from screwsim.inputs.faults import Interrupted, UsageError

LEAST_CREEP = 0.1  # [rpm] slowest start


def _creep_speed(text: str) -> float:
    """Return the speed [rad/s] of --creep; raise UsageError for one that is none."""
    from screwsim.inputs.declare import KINDS
    from screwsim.outputs.customary import RPM
    from screwsim.scene.units import NUMBER, parse_quantity, refused_at

    with refused_at(f"--creep {text}"):
        found = parse_quantity(KINDS["speed"], f"{text} rpm" if re.fullmatch(NUMBER, text.strip()) else text)
    if not found >= LEAST_CREEP * RPM:
        raise UsageError(f"--creep {text}: is below {LEAST_CREEP:g} rpm (write e.g. --creep '30 rpm')")
    return found


@contextmanager
def _shown_speed() -> Iterator[Callable[[float], None]]:
    """Give a function that shows how far a start has come, by its speed over the steady one, on a terminal."""
    from screwsim.study.pool.progress import CountingProgress, OverwrittenLine

    on_terminal = sys.stderr is not None and sys.stderr.isatty()
    shown = OverwrittenLine("startup, % of the steady speed") if on_terminal else CountingProgress()

    def told(share: float) -> None:
        if not shown.counts[1]:  # nothing is shown of a start that is refused
            shown.start(100, 0)
        shown.advance(max(0, min(100, int(100.0 * share)) - shown.counts[0]), 0)

    try:
        yield told
    finally:
        if shown.counts[1]:
            shown.stop()


def startup(
    scene_file: str = SCENE_FILE,
    folder: File = option("DIR", "Folder for traces and figure.", "-o"),
    creep: str = option("SPEED", "Speed at the start; a bare number is in rpm.", default="30 rpm"),
    longest: float = option("SECONDS", "Simulated time after which to give up.", min=0.01, default=10.0),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    as_json: bool = AS_JSON,
) -> int:
    """Start a machine that has a drive, against the discharge pressure."""
    options.check_folder(folder)
    slow = _creep_speed(creep)
    scene = options.loaded_point(scene_file, overrides, without)
    from screwsim.printing.machine import TRACES, print_startup, protect_other_traces, write_traces
    from screwsim.report.drive import start_figure
    from screwsim.report.style import write_all
    from screwsim.results.atomic import make_folder
    from screwsim.solve.start_up import INTERRUPTED, start_up

    if folder is not None:
        make_folder(folder)
        protect_other_traces(folder / TRACES)
    try:
        with _shown_speed() as told:
            found = start_up(scene, slow, longest, told)
    except Interrupted as pressed:
        found = pressed.found
    printed = partial(print_startup, changed=options.changes(overrides, without))
    options.print_document_or_text(as_json, lambda _, found: found.as_json(), printed, scene.title, found)
    if folder is not None and found.traces:
        make_folder(folder)  # again: another command may have removed the one that it had made and that was still empty
        written = [write_traces(folder / TRACES, found)]
        written += write_all({"startup": partial(start_figure, found, scene.title)}, folder)
        options.print_files(written, as_json)
    if found.status == INTERRUPTED:
        return options.INTERRUPTED
    return OK if found.status == "ok" else NOT_ALL_OK


def datasheet(
    scene_file: str = SCENE_FILE,
    output: File = option("OUT.html|.pdf|.csv|.xlsx", "Write the sheet as a page, or its points as a table.", "-o"),
    evaporating: Text = option("LOW..HIGH|LIST", "Evaporating temperatures of the table (refrigeration machine)."),
    condensing: Text = option("LOW..HIGH|LIST", "Its condensing temperatures, or gas-cooler pressures."),
    suction: Text = option(
        "LOW..HIGH|LIST", "Suction pressures of the table (gas compressor), or inlet pressures of an expander."
    ),
    discharge: Text = option(
        "LOW..HIGH|LIST",
        "Its discharge pressures, or outlet pressures of an expander or (one, too) of an air package.",
    ),
    limits: Texts = option("FIGURE<VALUE", "A limit, e.g. 'discharge_temperature<110 degC'; repeatable.", "--limit"),
    heating: bool = switch(
        "--heating", "Add tables of heating capacity and heating COP, part loads by it (heat pump)."
    ),
    profile: str | None = option(
        "LOADS.csv", "Flows and hours of an air package; adds its energy use over them.", "--profile"
    ),
    receiver: Text = option("VOLUME", "Receiver on which that package loads and unloads, e.g. '2 m^3'."),
    band: Text = option("PRESSURE", "Its pressure band (default: 0.7 bar)."),
    units: Literal["metric", "us"] = option(
        "metric|us", "Units of the sheet (of --json always SI).", "--units", default="metric"
    ),
    overrides: Texts = OVERRIDES,
    without: Texts = WITHOUT,
    jobs: int | None = JOBS,
    as_json: bool = AS_JSON,
) -> int:
    """Rate a machine, or two stages, over operating states, at part load and within limits; air by ISO 1217."""
    rated = options.loaded_scene_or_stages(scene_file, "rate", overrides, without)
    from screwsim.report.datasheet import check_sheet, write_sheet

    if output is not None:
        check_sheet(output)
    from screwsim.printing.machine import print_sheet
    from screwsim.study.datasheet import RANGE_OPTIONS, SheetOptions, sheet_of

    ranges = dict(zip(RANGE_OPTIONS, (evaporating, condensing, suction, discharge), strict=True))
    with options.counted_progress("datasheet", "parts") as shown:
        sheet = sheet_of(
            rated, SheetOptions(ranges, limits or (), heating, profile, jobs, shown, units, receiver, band)
        )
    if changes := options.changes(overrides, without):  # the title may name what they replace
        sheet = replace(sheet, lines=[*sheet.lines, ("changed", ", ".join(changes))])
    options.print_document_or_text(as_json, lambda found: found.document, print_sheet, sheet)
    if output is not None:
        options.print_files([write_sheet(sheet, output)], as_json)
    return OK if sheet.ok else NOT_ALL_OK
