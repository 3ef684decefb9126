"""One axis of a sweep: a list, an evenly spaced range, or a column of a CSV file, as values in SI units."""

import dataclasses
import math
import os
from collections import Counter
from collections.abc import Mapping
from typing import Any

from screwsim.inputs.declare import AUTO, FoundWithCycle
from screwsim.inputs.sheets import BadSheet, read_sheet
from screwsim.inputs.textfiles import Unreadable
from screwsim.scene.fields import Leaf, stray_key, unknown_key
from screwsim.scene.fluids import listed_fluid
from screwsim.scene.numerals import odd_number, odd_number_text
from screwsim.scene.sections import read_leaf
from screwsim.scene.tolerances import tolerance_sign
from screwsim.scene.units import Refused, customary_unit, to_customary
from screwsim.scene.values import convert, shown, text_of
from screwsim.scene.yaml_tree import LocatedFaults, Node, join

LONGEST_AXIS = 100_000  # values; more is taken for a typing error
SPACING = Leaf("choice", "spacing of the values", "linear", {"options": ("linear", "log")})
_COUNT = Leaf("count", "number of values", dataclasses.MISSING, {"ge": 1, "le": LONGEST_AXIS})
_WORD = Leaf("word", "a word", None, {})
OF_WORDS = {"choice": "is a choice: write a list of its options", "fluid": "is a fluid: write a list of names"}
_RANGE = "write {from: …, to: …, count: …}"
_COLUMN = "write {file: x.csv, column: …}"


def read_axis(leaf: Leaf, node: Node, path: str, problems: LocatedFaults, distinct: bool = True) -> tuple[Any, ...]:
    """Return the values of an axis; where they must be `distinct`, a repeated one is a fault."""
    if isinstance(node.value, dict):
        read = _column if "file" in node.value else _range
        values = read(leaf, node, path, problems)
    elif isinstance(node.value, list):
        values = [_item(leaf, item, path, problems) for item in node.value]
    else:
        remedy = _range_of_text(node.value) or f"write e.g. [{example(leaf)}]"
        problems.add(node.place, path, f"{shown(node.value)} is neither a list nor {{from, to, count}} ({remedy})")
        return ()
    if any(isinstance(value, FoundWithCycle) for value in values):
        problems.add(node.place, path, f"lists {AUTO}, which is not a value (write values, or a separate scene)")
        return ()
    good = [value for value in values if value is not None]
    twice = next((value for value, times in Counter(good).items() if times > 1), None) if distinct else None
    if not values and isinstance(node.value, list):
        problems.add(node.place, path, f"has no values (write e.g. [{example(leaf)}])")
    elif twice is not None:
        items = node.value if isinstance(node.value, list) else [node]
        whole = all(isinstance(item.value, int) for item in items)  # as where decimals are written with commas
        comma = ", or write decimals with a point" if leaf.kind == "number" and whole else ""
        problems.add(node.place, path, f"has {text_of(leaf, twice)} twice (remove one{comma})")
    return tuple(good)


def _item(leaf: Leaf, node: Node, path: str, problems: LocatedFaults) -> Any:
    """Return one value of a list, or None after its fault was added."""
    if isinstance(node.value, str) and tolerance_sign(node.value):
        of = path.removeprefix("sweep.")
        remedy = f"write it after the value of {of}; it then applies to every value of the sweep"
        problems.add(node.place, path, f"{shown(node.value)} has a tolerance of its own ({remedy})")
        return None
    if leaf.kind != "fluid":
        return read_leaf(leaf, node, path, problems)
    with problems.at(node.place, path):
        return listed_fluid(node.value)
    return None


def _range_of_text(value: Any) -> str:
    """Return how to write a range that is stated as options of commands have it, LOW..HIGH; '' for anything else."""
    ends, _, count = value.partition(",") if isinstance(value, str) else ("", "", "")
    low, dots, high = (part.strip() for part in ends.partition(".."))
    return f"write {{from: {low}, to: {high}, count: {count.strip() or '…'}}}" if low and dots and high else ""


def example(leaf: Leaf) -> str:
    """Return example values of an input as a user writes them."""
    if leaf.dimension is not None:
        return leaf.dimension.example
    return {"choice": leaf.limits.get("options", ("",))[0], "fluid": "R134a, R1234yf"}.get(leaf.kind, "1, 2")


def read_fields(
    fields: Mapping[str, Leaf], node: Node, path: str, problems: LocatedFaults, remedy: str, also: tuple[str, ...] = ()
) -> dict[str, Any] | None:
    """Return the values of a small mapping, or None after faults were added; the names `also` are read elsewhere."""
    if not isinstance(node.value, dict):
        problems.add(node.place, path, f"{shown(node.value)} is not a mapping ({remedy})")
        return None
    before = len(problems)
    for name, child in node.value.items():
        if name not in fields and name not in also:
            problems.add(child.heading, join(path, name), stray_key(name, [*fields, *also]))
    given: dict[str, Any] = {}
    for name, field in fields.items():
        child = node.value.get(name)
        if child is not None:
            given[name] = read_leaf(field, child, join(path, name), problems)
        elif field.required:
            problems.add(node.heading, join(path, name), f"is missing ({remedy})")
        else:
            given[name] = field.default
    return given if len(problems) == before else None


def _range(leaf: Leaf, node: Node, path: str, problems: LocatedFaults) -> list[Any]:
    """Return the values of {from, to, count, spacing}, or an empty list after faults were added."""
    if leaf.kind in OF_WORDS:
        problems.add(node.place, path, OF_WORDS[leaf.kind])
        return []
    end = dataclasses.replace(leaf, default=dataclasses.MISSING)
    fields = {"from": end, "to": end, "count": _COUNT, "spacing": SPACING}
    given = read_fields(fields, node, path, problems, _RANGE)
    if given is None:
        return []
    with problems.at(node.place, path):
        return spread(leaf, given["from"], given["to"], given["count"], given["spacing"])
    return []


def spread(leaf: Leaf, first: float, last: float, count: int, spacing: str) -> list[Any]:
    """Return `count` values from first to last [SI], evenly spaced in the customary unit or in its logarithm."""
    if spacing == "log" and not (first > 0.0 and last > 0.0):
        raise Refused("log spacing needs ends above zero (choose others, or spacing: linear)")
    if count == 1:
        return [first]
    kind = leaf.dimension
    ends = [to_customary(kind, end) if kind else end for end in (first, last)]
    if spacing == "log":
        ends = [math.log(end) for end in ends]
    inner = [ends[0] + (ends[1] - ends[0]) * index / (count - 1) for index in range(1, count - 1)]
    if spacing == "log":
        inner = [math.exp(number) for number in inner]
    return [first, *(_rounded(leaf, number) for number in inner), last]


def _rounded(leaf: Leaf, number: float) -> Any:
    """Return a number given in the customary unit as an SI value, rounded to 14 digits so that the axis reads well."""
    text = f"{number:.14g}"
    if leaf.kind == "count":
        if "." in text:
            raise Refused("does not give whole numbers (change count, or write a list)")
        return int(float(text))
    kind = leaf.dimension
    return convert(leaf, f"{text} {customary_unit(kind)}" if kind else float(text))


def _column(leaf: Leaf, node: Node, path: str, problems: LocatedFaults) -> list[Any]:
    """Return the values of {file, column, unit}: a column of a CSV file whose first line names the columns."""
    required = dataclasses.replace(_WORD, default=dataclasses.MISSING)
    given = read_fields({"file": required, "column": required, "unit": _WORD}, node, path, problems, _COLUMN)
    if given is None:
        return []
    with problems.at(node.place, path):
        cells = _cells(os.path.join(node.place.folder, given["file"]), given["file"], given["column"])
        return [_cell(leaf, text, given["unit"], f"{given['file']} line {line}") for line, text in cells]
    return []


def _cells(name: str, label: str, column: str) -> list[tuple[int, str]]:
    """Return (line, text) of every row of a column; raise `Refused`. Lines that begin with # are comments."""
    try:
        sheet = read_sheet(name)
    except Unreadable as reason:
        raise Refused(f"{shown(label)} cannot be read: {reason} (name a CSV file, relative to the scene)") from None
    except BadSheet as fault:
        raise Refused(f"{label} {fault}" if fault.line else f"{shown(label)} {fault}") from None
    if column not in sheet.names:
        raise Refused(f"{shown(label)}: column {shown(column)} {unknown_key(column, sheet.names)}")
    if not 1 <= len(sheet.rows) <= LONGEST_AXIS:
        raise Refused(f"{shown(label)} has {len(sheet.rows)} rows of values (1 to {LONGEST_AXIS} are allowed)")
    return [(line, cell) for line, (cell,) in sheet.columns(column)]


def _cell(leaf: Leaf, text: str, unit: str | None, where: str) -> Any:
    percent = unit == "%" and leaf.kind == "number"
    if unit and leaf.dimension is None and not percent:
        raise Refused(f"has no unit, but unit: {shown(unit)} is given (remove unit)")
    odd = odd_number(text) if unit else None
    if odd is not None:
        raise Refused(f"{where}: {shown(text)} {odd_number_text(odd, '')}")
    try:
        if leaf.kind == "fluid":
            return listed_fluid(text)
        if leaf.dimension is not None:
            return convert(leaf, f"{text} {unit}" if unit else text)
        value = text if leaf.kind == "choice" else _number_or_text(text)
        return convert(leaf, 0.01 * value if percent and isinstance(value, int | float) else value)
    except Refused as refusal:
        share = leaf.kind == "number" and 1 in (leaf.limits.get("le"), leaf.limits.get("lt"))
        example = "rpm" if leaf.dimension is not None else "'%'" if share else ""
        hint = f" or name the unit of the column, e.g. unit: {example}" if example and not unit else ""
        raise Refused(f"{where}: {refusal}{hint}") from None


def _number_or_text(text: str) -> Any:
    """Return a cell as a number if it is one, else as its text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
