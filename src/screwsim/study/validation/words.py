"""The table of a validation as text, and the line that sums it up."""

import textwrap
from collections.abc import Mapping
from typing import Any

from screwsim.figures import declared
from screwsim.figures.engineering import shown_name
from screwsim.scene.model_errors import range_text
from screwsim.study.validation.record import JUDGED, shown

WIDTH = 120
_COLUMNS = (("quantity", 56), ("ours", 11), ("theirs", 11), ("±", 9), ("unit", 7), ("kind", 10), ("verdict", 10))
_INDENT = "    "


def _line(cells: Mapping[str, str]) -> str:
    return " ".join(f"{cells[name]:<{width}}" for name, width in _COLUMNS).rstrip()


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT)


def row_text(row: Mapping[str, Any]) -> list[str]:
    """Return the lines of one row: what is too long for its column stands below."""
    uncertainty = shown(row["uncertainty"], 2)
    cells = {**row, "ours": shown(row["ours"]), "theirs": shown(row["theirs"]), "±": uncertainty}
    widths, below = dict(_COLUMNS), []
    for name in ("ours", "theirs"):
        if len(cells[name]) > widths[name]:
            below.append(f"{name}: {cells[name]}")
            cells[name] = "below"
    first, *more = textwrap.wrap(row["quantity"], widths["quantity"], subsequent_indent="  ")
    text = [_line({**cells, "quantity": first}), *more]
    for part in (*below, row["basis"], row["note"]):
        text += _wrapped(part)
    return text


def source_text(name: str, source: Mapping[str, Any]) -> str:
    """Return one source as text."""
    if source["status"] != "ok":
        return f"{name}: not run: {source['reason']}"
    lines = [f"{name}: {source['title']}", *textwrap.wrap(source["citation"], WIDTH - 2, initial_indent="  ")]
    lines.append(_line({column: column for column, _ in _COLUMNS}))
    for row in source["rows"]:
        lines += row_text(row)
    return "\n".join(lines)


def errors_report(errors: Mapping[str, Any]) -> str:
    """Return the error of the model by machine and figure, as ASME V&V 20 states it."""
    lines = ["error of the model: E = ours - theirs; between the ends it lies at all points (E ± 2 u_val, ASME V&V 20)"]
    for name, each in errors.items():
        lines += textwrap.wrap(f"{name}: {range_text(each['range'])}", WIDTH)
        for figure, told in each["figures"].items():
            lines += _error_lines(figure, told)
    lines.append("a scene that is like one of them says so by its name: uncertainty: {model: NAME}")
    return "\n".join(lines)


def _error_lines(figure: str, told: Mapping[str, Any]) -> list[str]:
    about = declared(figure)
    factor, unit = (1.0, "K") if about.units == "K" else (100.0, "%" if told["relative"] else "points")
    lines = []
    for kind, words in (("held_out", "held out"), ("fitted", "fitted to, no evidence")):
        one = told[kind]
        if one is not None:
            low, high, mean = (f"{factor * one[end]:+.1f}" for end in ("low", "high", "mean"))
            lines.append(f"  {shown_name(figure)}: {low} … {high} {unit}, mean {mean}: {one['points']} points {words}")
    missing = told["not_stated"]
    return [*lines, *([f"    without {', '.join(missing)}, which nobody states"] if missing else [])]


def summary(document: Mapping[str, Any]) -> str:
    """Return how the verdicts are spread, in one sentence."""
    rows = [row for source in document["sources"].values() for row in source["rows"]]
    judged = [row for row in rows if row["kind"] in JUDGED and row["verdict"] != "no verdict"]
    held = sum(row["verdict"] == "holds" for row in judged)
    open_rows = sum(row["kind"] in JUDGED and row["verdict"] == "no verdict" for row in rows)
    other = len(rows) - len(judged) - open_rows
    return (
        f"{held} of {len(judged)} judged comparisons hold, {len(judged) - held} fail; {open_rows} have no verdict; "
        f"{other} are fitted or estimates and no evidence"
    )


def report(document: Mapping[str, Any]) -> str:
    """Return the whole table."""
    parts = [source_text(name, source) for name, source in document["sources"].items()]
    return "\n\n".join([*parts, summary(document)])
