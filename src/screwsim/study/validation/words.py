"""The table of a validation as text, and the line that sums it up."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

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
