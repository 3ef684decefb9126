"""Output of `screwsim export` for a map: its inputs with their nodes, its outputs with their errors, the files."""

from collections.abc import Mapping, Sequence
from typing import Any

from screwsim.export.fmu import known_error, map_description
from screwsim.export.inputs import plain
from screwsim.export.loads import ExportedLoads, document, unit_of
from screwsim.export.map_table import MapTable
from screwsim.inputs.suggestions import counted
from screwsim.outputs import Result
from screwsim.printing.tables import print_scene_title, print_table, print_text, print_wrapped
from screwsim.screen import say
from screwsim.study.maps.map_points import place_in_words


def map_document(table: MapTable, files: Sequence[str]) -> dict[str, Any]:
    """Return what `--json` prints."""
    return {
        **map_description(table),
        "error": known_error(table.error),
        "error_wanted": table.wanted,
        "cases": table.cases,
        "points_checked": table.checked,
        "files": list(files),
    }


def print_map(table: MapTable, files: Sequence[str], changed: Sequence[str] = ()) -> None:
    """Print a map, in SI units; `changed` has what the command line changes in its scene."""
    print_scene_title(table.title, changed)
    inputs = zip(table.inputs, table.grid.nodes, strict=True)
    rows = [[one.name, f"{one.low:.6g}", f"{one.high:.6g}", plain(one.units), str(len(nodes))] for one, nodes in inputs]
    print_table(["input", "from", "to", "unit", "nodes"], rows, 1)
    say()
    errors = zip(table.outputs, table.errors, strict=True)
    rows = [[each.name, plain(each.units), _percent(error)] for each, error in errors]
    print_table(["output", "unit", "error"], rows, 1)
    print_text(f"errors: {table.how}; of temperatures, over 100 K")
    print_text(f"{table.cases} cases{_open_nodes(table)}")
    print_wrapped(table.warnings_told())
    say("\n".join(files))


def _open_nodes(table: MapTable) -> str:
    """Return how many nodes have no closed cycle, where, and why the first has none; empty where all have one."""
    if not table.not_ok:
        return f"; a check point without a closed cycle: {table.why}" if table.why else ""
    where = f", at {table.where_open()}" if table.where_open() else ""
    why = f" (the first: {table.why})" if table.why else ""
    nodes = f"{counted(table.not_ok, 'node')} of {table.grid.sound.size}"
    return f"; {nodes} without a closed cycle, flagged as not valid{where}{why}"


Errors = Sequence[tuple[Mapping[str, float], Sequence[float]]]  # values of the other axes, errors of the figures


def print_polynomials(
    document: Mapping[str, Any], figures: Sequence[str], rows: Errors, files: Sequence[str], changed: Sequence[str] = ()
) -> None:
    """Print the largest error of each polynomial, one row per map, and the files; `changed` as of `print_map`."""
    title, fluid = document["title"], document["fluid"]
    print_scene_title(title if fluid in title else f"{title} ({fluid})", changed)
    body = [[place_in_words(at) or "map", *map(_percent, errors)] for at, errors in rows]
    print_table(["largest error", *(name.replace("_", " ") for name in figures)], body, 1)
    say("\n".join(files))


def loads_document(found: ExportedLoads, result: Result, files: Sequence[str]) -> dict[str, Any]:
    """Return what `export loads --json` prints."""
    return {**document(found), "status": result.status, "files": files}


def print_loads(found: ExportedLoads, result: Result, files: Sequence[str], changed: Sequence[str] = ()) -> None:
    """Print mean and first harmonics of each curve, and the files; `changed` by the command line in the scene."""
    print_scene_title(found.title or "loads", changed)
    print_text(f"status: {result.told if result.message else result.status}; lobe frequency {found.frequency:.5g} Hz")
    rows = [
        [name, unit_of(name), *(f"{each.amplitude:.4g}" for each in spectrum[:4])]
        for name, spectrum in found.spectra.items()
    ]
    print_table(["curve", "unit", "mean", "1st", "2nd", "3rd"], rows, 2)
    say("\n".join(files))


def _percent(error: float) -> str:
    return "not known" if known_error(error) is None else f"{100.0 * error:.2g} %"
