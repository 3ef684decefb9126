"""Output of `screwsim compare`."""

import math
import re
from collections.abc import Mapping
from dataclasses import asdict
from itertools import compress
from pathlib import Path
from typing import Any

from screwsim.figures.engineering import engineering, shown_name
from screwsim.inputs.suggestions import counted
from screwsim.outputs import Figure
from screwsim.outputs.customary import printed_celsius
from screwsim.outputs.display import grouped
from screwsim.printing.tables import column_heads, print_table, print_text, print_wrapped
from screwsim.report.overlay import draw_overlay
from screwsim.report.quantities import short, shown_axis
from screwsim.results import Results
from screwsim.results.schema import Axis, quantities_along
from screwsim.screen import say
from screwsim.study.columns import Column, protect_other_columns, write_columns
from screwsim.study.compare import Comparison, FigureChange, common_points

TABLE, TITLE = "comparison.csv", "comparison"
OWN_COLUMNS = "status_a", "status_b"  # columns that identify such a table
DIGITS = 15  # of numbers in a scene, all of which a float holds
_LONG_NUMBER = re.compile(r"(?<![\w.])[0-9]*\.[0-9]{12,}(?:e[-+]?[0-9]+)?")
_ONE_DIGIT_BELOW, _TWO_DIGITS_BELOW = 9.5, 99.5  # what rounds to 10, to 100: beyond, these digits need an exponent
MOST_NAMES = 3  # most figures named for one point of largest change, most differences of scenes over a figure


def comparison_document(a: Results, b: Results, found: Comparison) -> dict[str, Any]:
    """Return what `compare --json` prints, in SI units."""
    return {
        "a": str(a.path),
        "b": str(b.path),
        "versions": [each.attributes["screwsim_version"] for each in (a, b)],
        "equal": found.equal,
        "points": {"common": found.common, "compared": found.compared, "only_a": found.only_a, "only_b": found.only_b},
        "scene": {path: {"a": one, "b": other} for path, (one, other) in found.scene.items()},
        "status_changes": found.status_changes,
        "first_status_changes": [asdict(change) for change in found.first_status_changes],
        "figures": {figure.figure: asdict(figure) for figure in found.figures},
    }


def print_comparison(a: Results, b: Results, found: Comparison) -> None:
    """Print points, scenes, statuses and figures."""
    print_text(f"A: {a.path}")
    print_text(f"B: {b.path}")
    points = f"{counted(found.common, 'point')} in common"
    for name, count in (("A", found.only_a), ("B", found.only_b)):
        points += f", {count} only in {name}" if count else ""
    say(points)
    if found.compared < found.common:
        some = f"{found.compared} are ok in both files; figures of the others are not compared"
        print_text(some if found.compared else "none of them is ok in both files, so no figure is compared")
    if found.scene:
        say()
        rows = [[path, *_shown_pair(one or "-", other or "-")] for path, (one, other) in found.scene.items()]
        print_table(["scene", "A", "B"], rows, 1)
    if found.status_changes:
        say()
        count = found.status_changes
        say(f"{count} point{'s have' if count != 1 else ' has'} another status")
        print_wrapped(f"{change.a} → {change.b}{_where(a, change.at)}" for change in found.first_status_changes)
    if not found.compared:
        return
    say()
    _print_figures(a, b, found)
    say()
    say(f"{'equal within' if found.equal else 'different beyond'} the numerical error or the tolerance")


def _print_figures(a: Results, b: Results, found: Comparison) -> None:
    heads = ["", "A", "B", "", "change", "error", "inputs", "differ"]
    toleranced = any(figure.inputs for figure in found.figures)
    kept = [head != "inputs" or toleranced for head in heads]
    rows = [list(compress(cells, kept)) for cells in (heads, *(_cells(a, b, figure) for figure in found.figures))]
    print_table(rows[0], rows[1:], 1)
    many = any(figure.at for figure in found.figures) and found.common > 1
    residuals = any(_declaration(a, b, figure.figure).scale.unasked for figure in found.figures)
    text = f"change in % of A, of temperatures in K{', of residuals as it is' if residuals else ''}; error in the same"
    text += " unit: both estimates together, twice which counts as no change"
    text += "; inputs: half of the 95 % interval of the change, if inputs are off alike in both" if toleranced else ""
    print_text(f"{text}; the point shown has the largest change relative to what is allowed" if many else text)
    far = (figure for figure in found.figures if many and figure.beyond)
    places = grouped((_where(a, figure.at), shown_name(figure.figure)) for figure in far if figure.at)
    for place, names in places.items():
        few = ", ".join(names[:MOST_NAMES]) + (" …" if len(names) > MOST_NAMES else "")
        print_text(f"largest change{place}: {few}")


def _cells(a: Results, b: Results, change: FigureChange) -> list[str]:
    """Return a row: name, value in A, in B, unit, change, error, part of the inputs, at how many points they differ."""
    differ = f"{change.beyond} of {change.points}" if change.points > 1 else "yes" if change.beyond else "no"
    if change.only_a or change.only_b:
        differ = f"{change.only_a + change.only_b} only in {'A' if change.only_a else 'B'}"
    name = shown_name(change.figure)
    if change.a is None or change.b is None:
        return [name, "", "", "", "", "", "", differ]
    about = _declaration(a, b, change.figure)
    if about.units == "K":
        return [name, printed_celsius(change.a), printed_celsius(change.b), "°C", *_changes(change, 1.0, "K"), differ]
    (in_a, unit_a), (in_b, unit_b) = engineering(about, change.a), engineering(about, change.b)
    if change.a and change.b and unit_a != unit_b:  # as for 900 W and 1.1 kW; zero has the unit of the other one
        in_b = f"{in_b} {unit_b}"
    changes = _changes(change, 100.0 / abs(change.a), "%") if change.a else ["", "", ""]
    if about.scale.unasked:  # a residual, of which no percentage says anything
        changes = _changes(change, 1.0, "")
    return [name, in_a, in_b, unit_a if change.a else unit_b, *changes, differ]


def _declaration(a: Results, b: Results, name: str) -> Figure:
    """Return the declaration of a figure that at least one of both files has."""
    of, own = a.holder(name)
    return (a if own in of.performance else b).figure(name)


def _changes(of: FigureChange, factor: float, unit: str) -> list[str]:
    """Return the change, error of both and uncertainty by the inputs, in a unit by its factor from SI."""
    change = factor * (of.change or 0.0)
    shown = f"{change:+.0f}" if abs(change) >= _TWO_DIGITS_BELOW else f"{change:+.2g}"
    inputs = f"± {_rounded(factor * of.inputs)}" if of.inputs else ""
    return [f"{shown} {unit}".rstrip() if change else "0", _rounded(factor * (of.error or 0.0)), inputs]


def _rounded(size: float) -> str:
    """Return a size with one digit, in whole numbers (no exponent) where it has more before the point."""
    return f"{size:.0f}" if size >= _ONE_DIGIT_BELOW else f"{size:.1g}"


def _shown_pair(one: str, other: str) -> tuple[str, str]:
    """Return two values of a scene without the rounding of their last digits (1.7000000000000002), if they differ."""
    a, b = (_LONG_NUMBER.sub(lambda match: f"{float(match[0]):.{DIGITS}g}", text) for text in (one, other))
    return (a, b) if a != b else (one, other)


def _where(results: Results, at: Mapping[str, Any]) -> str:
    """Return the position of a point, in the units in which figures show it."""
    axes = {inner.path: inner for inner in quantities_along(results.axis_list)}
    words = [f"{path} = {_shown(axes.get(path), value)}" for path, value in at.items()]
    return f" at {', '.join(words)}" if words else ""


def _shown(axis: Axis | None, value: Any) -> str:
    """Return a value [SI] of an axis with its unit; a text is returned as such."""
    if axis is None or isinstance(value, str):
        return value if isinstance(value, str) else short(value)
    shown = shown_axis(axis)
    return f"{short(shown.of(value))} {shown.unit}".strip()


def _apart(scene: Mapping[str, tuple[str | None, str | None]]) -> tuple[str, str]:
    """Return the first values of A's scene that differ from B's, and of B's, in words."""
    some = dict(list(scene.items())[:MOST_NAMES])
    pairs = (_shown_pair(one or "none", other or "none") for one, other in some.values())
    named = zip(column_heads(list(some)), pairs, strict=True)
    told = [(f"{name} {one}", f"{name} {other}") for name, (one, other) in named]
    told += [("…", "…")] if len(scene) > len(some) else []
    a, b = (", ".join(words[side] for words in told) for side in (0, 1))
    return a, b


def write_comparison(a: Results, b: Results, found: Comparison, folder: Path) -> list[str]:
    """Write one row per common point, in SI units, and the figures of both files; return the paths."""
    common, columns = common_points(a, b), {}
    units = {inner.path: inner.units for each in (b, a) for inner in quantities_along(each.axis_list)}
    for path, values in common.places.items():
        columns[path] = Column(values.tolist(), units.get(path, "1"), path)
    for side, status in zip("ab", common.status, strict=True):
        columns[f"status_{side}"] = Column(status.tolist(), "", f"status in {side.upper()}")
    for name, (one, other, error) in common.figures.items():
        about = _declaration(a, b, name)
        named = {"a": (one, "in A"), "b": (other, "in B"), "error": (error, "estimated errors of both files, combined")}
        for end, (column, words) in named.items():
            cells = [None if math.isnan(value) else value for value in column.tolist()]
            columns[f"{name}_{end}"] = Column(cells, about.units, f"{about.long_name}, {words}")
    table = folder / TABLE
    protect_other_columns(table, TITLE, *OWN_COLUMNS)
    write_columns(table, TITLE, columns)
    return [str(table), *draw_overlay(a, b, folder, _apart(found.scene))]
