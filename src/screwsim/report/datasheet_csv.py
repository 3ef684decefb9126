"""The points of a data sheet as a table: a row a point, its operating state and all its figures in customary units."""

import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from screwsim.figures import declaration, declared
from screwsim.figures.engineering import reading_unit
from screwsim.inputs.declare import KINDS
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.results.protection import protect_other_heads
from screwsim.results.tables import write_table as write_rows
from screwsim.scene.fields import Leaf, leaf_paths
from screwsim.scene.units import customary_unit, to_customary

ERROR = "_error"  # behind the name of a figure: its estimated error, relative
UNCERTAINTY = "_uncertainty"  # likewise: half of its 95 % interval by the tolerances of the inputs, in its own unit
STATUS, BEYOND, WARNINGS = "status", "beyond", "warnings"  # of a point, beside its numbers
PLAIN = {"°C": "degC", "²": "^2", "³": "^3"}  # in heads, as in all tables of the program
DIGITS = 6  # significant digits of a number
STAGE = re.compile("^(first|second)_")  # before the operating state of one of two stages
OPERATION = "operation."  # before the path of an axis
OUTLET, FLOW = "outlet_pressure", "flow"  # of the points of an air package at other outlet pressures
SEPARATOR = "; "  # between limits, and between warnings


def check_table(output: Path) -> None:
    """Raise UsageError where a file at `output` is not such a table."""
    protect_other_heads(output, {STATUS, WARNINGS}.issubset)


def write_table(document: Mapping[str, Any], output: Path) -> str:
    """Write the points of a sheet's document; return the path."""
    points = _points(document)
    apart = (STATUS, "message", WARNINGS, "error", "notes")
    axes = {OUTLET: "pressure", **document.get("axes", {})}
    names = list(dict.fromkeys(name for each in points for name in each if name not in apart))
    values = {name: [each.get(name) for each in points] for name in names}
    columns = [_column(name, values, axes) for name in names]
    heads = [*(head for head, _ in columns), STATUS, WARNINGS]
    told = (": ".join(filter(None, (each[STATUS], each["message"]))) for each in points)
    ends = [[status, SEPARATOR.join(each[WARNINGS])] for status, each in zip(told, points, strict=True)]
    cells = zip(*(values for _, values in columns), strict=True)
    return write_rows(output, heads, [[*row, *end] for row, end in zip(cells, ends, strict=True)])


def _points(document: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    """Return the points of a sheet, behind those of an air package the ones at its other outlet pressures."""
    others = document.get("pressures", ())
    if not others:
        return document["points"]
    own = [{OUTLET: document["discharge_pressure"], **point} for point in document["points"]]
    return own + [
        {OUTLET: each[OUTLET], FLOW: name.replace("_", " "), **point}
        for each in others
        for name, point in each.items()
        if isinstance(point, Mapping)
    ]


def _column(name: str, every: Mapping[str, Sequence[Any]], axes: Mapping[str, str | None]) -> tuple[str, list[str]]:
    """Return the head of a column with its unit, and its cells; an uncertainty is in the unit of its figure's column.

    `every` has the values of all columns by their names.
    """
    values = every[name]
    if name == BEYOND:
        return "beyond_limits", [SEPARATOR.join(each or ()) for each in values]
    if any(isinstance(each, str) for each in values):
        return name, ["" if each is None else str(each) for each in values]
    sizes = [abs(each) for each in every.get(name.removesuffix(UNCERTAINTY), values) if each is not None]
    factor, unit, offset = _unit(name, sizes, axes)
    head = f"{name} [{unit}]" if unit else name
    return head, ["" if each is None else f"{factor * each - offset:.{DIGITS}g}" for each in values]


def _unit(name: str, sizes: Sequence[float], axes: Mapping[str, str | None]) -> tuple[float, str, float]:
    """Return factor from SI, unit and the offset that is taken off, for all values of a column.

    `axes` names the kind of quantity of each axis that has a path for a name, None for numbers.
    """
    if name in axes or name.endswith(ERROR):
        kind = KINDS.get(axes.get(name) or "")
        if kind is None:
            return 1.0, "", 0.0
        celsius = kind.name == "temperature"
        return (1.0, "degC", ZERO_CELSIUS) if celsius else (to_customary(kind, 1.0), customary_unit(kind), 0.0)
    leaf = None if declaration(name) else _axes().get(STAGE.sub("", name))
    if leaf is not None and leaf.dimension is not None:
        return to_customary(leaf.dimension, 1.0), customary_unit(leaf.dimension), 0.0
    figure, most = name.removesuffix(UNCERTAINTY), max(sizes, default=0.0)
    if figure != name and declared(figure).units == "K":
        return 1.0, "K", 0.0
    factor, unit, offset = reading_unit(declared(figure), most)
    for sign, plain in PLAIN.items():
        unit = unit.replace(sign, plain)
    return factor, unit, offset


@cache
def _axes() -> dict[str, Leaf]:
    """Return the inputs of an operating state by their names in a sheet's document: `gas_cooler_pressure`."""
    leaves = leaf_paths({}).items()
    return {path.removeprefix(OPERATION).replace(".", "_"): leaf for path, leaf in leaves if path.startswith(OPERATION)}
