"""The table of a validation as text, and the line that sums it up."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

from screwsim.study.validation.record import JUDGED, shown

WIDTH = 118
_COLUMNS = (("quantity", 46), ("ours", 12), ("theirs", 12), ("±", 9), ("unit", 7), ("kind", 11), ("verdict", 10))


def _line(cells: Mapping[str, str]) -> str:
    quantity, *rest = (f"{cells[name]:<{width}}" for name, width in _COLUMNS)
    return (quantity + " " + " ".join(rest)).rstrip()


def row_text(row: Mapping[str, Any]) -> list[str]:
    """Return the lines of one row: what is too long for its column stands below."""
    ours, theirs = shown(row["ours"]), shown(row["theirs"])
    cells = {
        "quantity": row["quantity"],
        "ours": ours,
        "theirs": theirs,
        "±": "–" if row["uncertainty"] is None else shown(row["uncertainty"], 2),
        "unit": row["unit"],
        "kind": row["kind"],
        "verdict": row["verdict"],
    }
    below = []
    for name, width in _COLUMNS[:3]:
        if len(cells[name]) > width:
            below.append(f"{name}: {cells[name]}" if name != "quantity" else cells[name])
            cells[name] = "…" if name != "quantity" else textwrap.shorten(cells[name], width, placeholder=" …")
    text = [_line(cells)]
    for part in (*below, row["basis"], row["note"]):
        if part:
            text += textwrap.wrap(part, WIDTH - 4, initial_indent="    ", subsequent_indent="    ")
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
