"""Output of `screwsim optimum`, printed and written."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from screwsim.figures import declared
from screwsim.figures.engineering import engineering, figure_text, shown_name
from screwsim.outputs.display import grouped
from screwsim.printing.tables import column_heads, print_scene_title, print_table, print_text, print_wrapped
from screwsim.scene.grid import unit_of
from screwsim.screen import say
from screwsim.study.asked.inputs import shown_number, shown_range, shown_value
from screwsim.study.asked.spans import BORDER_MARKS, LOWER, UPPER, border_note, idle_note
from screwsim.study.asked.varied import Varied, leaf_of
from screwsim.study.best.optimum import FROM, TO, Best, Question
from screwsim.study.columns import Column, figure_column, input_column, write_columns

MOST_PLACES = 3  # points that a note names; of more it names the first


def optimum_document(scene: Varied, asked: Question, rows: Sequence[Best]) -> dict[str, Any]:
    """Return what `optimum --json` prints: the question, one row per point of the other axes, counts; in SI units."""
    return {
        "title": scene.title,
        "path": asked.path,
        "figure": asked.figure,
        "sense": "minimum" if asked.minimum else "maximum",
        "from": asked.low,
        "to": asked.high,
        # figures beside the one sought are those of two stages, and one machine has none
        "rows": [{name: value for name, value in asdict(row).items() if value or name != "beside"} for row in rows],
        "solutions": sum(row.solutions for row in rows),
        "failed_solutions": sum(row.failed for row in rows),
    }


def print_optimum(scene: Varied, asked: Question, rows: Sequence[Best], changed: Sequence[str] = ()) -> None:
    """Print one row per point of the other axes, then remarks on single ones."""
    word = "lowest" if asked.minimum else "highest"
    print_scene_title(scene.title, changed)
    ends = shown_range(scene, asked.path, asked.low, asked.high)
    print_text(f"{word} {shown_name(asked.figure)} over {asked.path}, {ends}")
    say()
    paths = [path for path in scene.sweep if path != asked.path]
    *heads, sought = column_heads([*paths, asked.path])
    own = asked.path.rpartition(".")[2]  # in one line, as it was typed, where that is enough
    heads += [own if sought == own.replace("_", " ") else sought, "as good"]
    heads += [shown_name(asked.figure), "error", *map(shown_name, _beside(rows)), "accuracy", "simulated"]
    print_table(heads, [_cells(scene, asked, paths, row, _beside(rows)) for row in rows])
    told = ((note, row.values) for row in rows for note in _notes(scene, asked, row))
    notes = grouped((note, ", ".join(shown_value(scene, path, at[path]) for path in paths)) for note, at in told)
    if notes:
        say()
    print_wrapped(line for note, where in notes.items() for line in _with_places(note, where))
    if any(row.value is not None for row in rows):
        print_text("as good: range in which the figure is within its estimated error of the best")


def _beside(rows: Sequence[Best]) -> list[str]:
    """Return the figures that are told beside the one sought, of two stages."""
    return list(dict.fromkeys(name for row in rows for name in row.beside))


def _cells(scene: Varied, asked: Question, paths: Sequence[str], row: Best, beside: Sequence[str]) -> list[str]:
    head = [shown_value(scene, path, row.values[path]) for path in paths]
    if row.value is None or row.figure is None or row.error is None:
        return [*head, row.status, "", "", "", *("" for _ in beside), "", str(row.solutions)]
    number, unit = engineering(asked.figure, row.figure)
    low, high = (shown_number(scene, asked.path, end) for end in (row.low, row.high))
    mark = BORDER_MARKS.get(row.place or "", "")
    place = [shown_value(scene, asked.path, row.value, 4) + mark, f"{low} … {high}", f"{number} {unit}".strip()]
    error = f"{row.error / abs(row.figure):.0e}" if row.figure else ""
    others = ["" if (value := row.beside.get(name)) is None else figure_text(name, value) for name in beside]
    return [*head, *place, error, *others, f"{row.accuracy:.0e}", str(row.solutions)]


def _with_places(note: str, where: Sequence[str]) -> list[str]:
    """Return a note with its point, a line each; of many points the first one and their number in one line."""
    if len(where) > MOST_PLACES:
        return [f"{len(where)} points, the first at {where[0]}: {note}"]
    return [f"{each}: {note}" if each else note for each in where]


def _notes(scene: Varied, asked: Question, row: Best) -> Iterator[str]:
    if row.place in (LOWER, UPPER):
        end = asked.ends[row.place == UPPER]
        remedy = f" ({end})" if end in (FROM, TO) else f" ({end} of --path)"
        yield border_note(asked.path, row.place, row.beyond, remedy)
    elif row.beyond:
        yield f"at the edge of the values that have a solution: {row.beyond}"
    if row.place == "anywhere":
        yield idle_note(asked.path)
    for value, figure in row.others:
        shown = figure_text(asked.figure, figure)
        yield f"another local optimum at {shown_value(scene, asked.path, value, 4)}: {shown}"
    if row.message:
        yield row.message
    for warning in row.warnings:
        yield f"warning: {warning}"


def write_optimum(path: Path, scene: Varied, asked: Question, rows: Sequence[Best]) -> None:
    """Write one row per point of the other axes as CSV or HDF5, in SI units."""
    axes = (axis for axis in scene.sweep if axis != asked.path)
    columns = {axis: input_column(leaf_of(scene, axis), [row.values[axis] for row in rows]) for axis in axes}
    sought = leaf_of(scene, asked.path)
    units, doc = unit_of(sought), sought.doc
    about = declared(asked.figure)
    meanings = {
        "value": (asked.path, units, f"best {doc}"),
        "low": (f"{asked.path}_low", units, "lower end of the values as good within the error"),
        "high": (f"{asked.path}_high", units, "upper end of the values as good within the error"),
        "figure": (asked.figure, about.units, about.long_name),
        "error": (f"{asked.figure}_error", about.units, "its estimated numerical error, absolute"),
        "accuracy": ("accuracy", "1", "accuracy requested of the last solutions"),
        "solutions": ("solutions", "1", "number of solutions"),
        "failed": ("failed_solutions", "1", "number of solutions that failed or did not close"),
        "status": ("status", "", "ok or failed"),
        "place": ("place", "", "inside the range, or the border it lies at"),
        "beyond": ("beyond", "", "why there is no solution next to the best value, where there is none"),
        "message": ("message", "", "why solutions failed"),
    }
    for name, (column, unit, meaning) in meanings.items():
        columns[column] = Column([getattr(row, name) for row in rows], unit, meaning)
    for name in _beside(rows):
        own = figure_column(name, [row.beside.get(name) for row in rows])
        columns[name] = own._replace(long_name=f"{own.long_name}, at the best")
    columns["warnings"] = Column(["; ".join(row.warnings) for row in rows], "", "warnings of the best solution")
    write_columns(path, f"optimum of {asked.path}", columns)
