"""A map of two inputs as a Modelica package: blocks with tables of the standard library, and polynomial functions."""

import math
import re
from collections.abc import Sequence

import numpy as np

from screwsim.export.hermite import Array, Grid, evaluate, points_of
from screwsim.export.inputs import Input, plain
from screwsim.export.map_table import MapTable
from screwsim.export.table import scales
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.outputs import Figure
from screwsim.study.maps.performance_map import TERMS

WRITTEN_MARK = "written by screwsim; error "  # in the first line of a package
FINE_POINTS = 25  # points along an axis to which polynomials are fitted, and at which errors are evaluated
_TABLE = "Modelica.Blocks.Tables.CombiTable2Ds"
_TAKEN = {"real", "integer", "boolean", "string", "complex", "clock", "modelica", "modelicaservices", "stateselect"}


def check_inputs(inputs: Sequence[Input]) -> None:
    """Raise UsageError unless a map has two inputs."""
    if len(inputs) != 2:
        count = f"{counted(len(inputs), 'input')} ({', '.join(one.name for one in inputs)})"
        remedy = "name two with --over, or a sweep over two; fmu takes any number"
        raise UsageError(f"the map has {count}, and {_TABLE} two ({remedy})")


def package(table: MapTable, name: str) -> str:
    """Return the text of a package; raise UsageError unless the map has two inputs."""
    check_inputs(table.inputs)
    words = _quoted(f"{table.title or name}: {WRITTEN_MARK}{_error_in_words(table)}")
    return "\n".join(
        (
            f"package {name} {words}",
            "  extends Modelica.Icons.Package;",
            _tables(table),
            '  package Polynomials "The same figures as cubic polynomials of both inputs"',
            "    extends Modelica.Icons.Package;",
            *(_function(table, i) for i in range(len(table.outputs))),
            "  end Polynomials;",
            '  annotation (uses(Modelica(version="4.0.0")));',
            f"end {name};",
            "",
        )
    )


def identifier(stem: str) -> str:
    """Return a valid, capitalised Modelica name that is neither a keyword nor a library's name."""
    name = re.sub(r"\W", "_", stem, flags=re.ASCII)
    name = name if name[:1].isalpha() and name.lower() not in _TAKEN else f"Map_{name}"
    return name[:1].upper() + name[1:]


def _error_in_words(table: MapTable) -> str:
    """Return the error of the tables as interpolated by Modelica: that of the map, plus the difference between both."""
    if not math.isfinite(table.error):
        return table.error_in_words
    off = max(own + more for own, more in zip(table.errors, akima_differences(table), strict=True))
    return f"{off:.2g}, of the map ({table.how}) and of Akima's interpolation against it"


def akima_differences(table: MapTable) -> Array:
    """Return the largest difference of Akima's interpolation (1974) of the nodes from the map, relative to each output.

    CombiTable2Ds interpolates so with continuous derivatives, whereas the map uses a spline.
    """
    nodes, values = table.nodes, table.grid.data[0, 0]
    along = [_akima_slopes(x, values, axis) for axis, x in enumerate(nodes)]
    mixed = _akima_slopes(nodes[0], along[1], 0)
    akima = Grid(nodes, np.array([[values, along[1]], [along[0], mixed]]), table.grid.sound)
    x = _mesh(table)
    ours, inside = table(x)
    if not inside.any():
        return np.zeros(len(table.outputs))
    size = scales(table.outputs, np.where(inside[:, None], ours, np.nan))
    return np.max(np.abs(evaluate(akima, x)[0] - ours)[inside] / size[inside], axis=0)


def _akima_slopes(x: Array, values: Array, axis: int) -> Array:
    from scipy.interpolate import Akima1DInterpolator

    if len(x) == 2:
        return np.repeat(np.diff(values, axis=axis) / (x[1] - x[0]), 2, axis=axis)
    return Akima1DInterpolator(x, values, axis=axis).derivative()(x)


def _mesh(table: MapTable) -> Array:
    """Return points of a regular grid over both inputs' ranges (n, inputs)."""
    return points_of([np.linspace(one.low, one.high, FINE_POINTS) for one in table.inputs])


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ") + '"'


def _port(kind: str, each: Input | Figure, indent: str) -> str:
    head = f'Modelica.Blocks.Interfaces.Real{kind} {each.name}(unit="{plain(each.units)}")'
    return f"{indent}{head} {_quoted(each.long_name)};"


def _tables(table: MapTable) -> str:
    one, two = table.inputs
    nodes, values = table.nodes, table.grid.data[0, 0]
    lines = ['  model Tables "Figures by tables with continuous derivatives, held beyond their ranges"']
    lines += [_port("Input", each, "    ") for each in table.inputs]
    lines += [_port("Output", output, "    ") for output in table.outputs]
    lines.append('    Modelica.Blocks.Interfaces.BooleanOutput valid "inside, among points whose cycles closed";')
    lines.append("  protected")
    smooth = "Modelica.Blocks.Types.Smoothness.ContinuousDerivative"
    for i, each in enumerate(table.outputs):
        lines.append(_block(f"{each.name}_table", _matrix(nodes, values[..., i]), smooth))
    linear = "Modelica.Blocks.Types.Smoothness.LinearSegments"
    lines.append(_block("closed", _matrix(nodes, table.grid.sound.astype(float)), linear))
    lines.append("  equation")
    for block in (*(f"{output.name}_table" for output in table.outputs), "closed"):
        lines += [f"    {block}.u1 = {one.name};", f"    {block}.u2 = {two.name};"]
    lines += [f"    {output.name} = {output.name}_table.y;" for output in table.outputs]
    ranges = " and ".join(f"{each.name} >= {each.low!r} and {each.name} <= {each.high!r}" for each in table.inputs)
    lines += [f"    valid = {ranges} and closed.y > 0.999999;", "  end Tables;"]
    return "\n".join(lines)


def _block(name: str, matrix: str, smoothness: str) -> str:
    held = "Modelica.Blocks.Types.Extrapolation.HoldLastPoint"
    return f"    {_TABLE} {name}(\n      smoothness={smoothness},\n      extrapolation={held},\n      table={matrix});"


def _matrix(nodes: Sequence[np.ndarray], values: np.ndarray) -> str:
    rows = [[0.0, *nodes[1]], *([x, *row] for x, row in zip(nodes[0], values, strict=True))]
    return "[" + ";\n        ".join(", ".join(f"{float(v):.12g}" for v in row) for row in rows) + "]"


def cubic(table: MapTable, number: int) -> tuple[np.ndarray, list[tuple[float, float]], float]:
    """Return the coefficients of an output over scaled inputs, (middle, half width) of each, and the error inside."""
    ends = [(one.low, one.high) for one in table.inputs]
    x = _mesh(table)
    values, inside = table(x)
    if inside.sum() < len(TERMS):
        raise UsageError("too few cycles closed for polynomials (choose other ranges)")
    middles = [(0.5 * (low + high), 0.5 * (high - low)) for low, high in ends]
    u, v = ((x[inside, i] - middle) / half for i, (middle, half) in enumerate(middles))
    matrix = np.column_stack([u**i * v**j for i, j in TERMS])
    wanted = values[inside, number]
    found, *_ = np.linalg.lstsq(matrix, wanted, rcond=None)
    size = scales(table.outputs, values[inside])[:, number]
    return found, middles, float(np.max(np.abs(matrix @ found - wanted) / size))


def _function(table: MapTable, number: int) -> str:
    each = table.outputs[number]
    coefficients, middles, error = cubic(table, number)
    terms = []
    for c, (i, j) in zip(coefficients, TERMS, strict=True):
        powers = [name if n == 1 else f"{name}^{n}" for name, n in (("u", i), ("v", j)) if n]
        terms.append("*".join([f"({float(c)!r})", *powers]))
    named = zip("uv", table.inputs, middles, strict=True)
    scaled = [f"    Real {letter} = ({one.name} - {middle!r})/{half!r};" for letter, one, (middle, half) in named]
    inputs = [f'    input Real {one.name}(unit="{plain(one.units)}") {_quoted(one.long_name)};' for one in table.inputs]
    lines = [
        f"  function {each.name} {_quoted(f'{each.long_name}; off from the tables by {error:.2g} at most')}",
        "    extends Modelica.Icons.Function;",
        *inputs,
        f'    output Real y(unit="{plain(each.units)}");',
        "  protected",
        *scaled,
        "  algorithm",
        "    y := " + "\n      + ".join(terms) + ";",
        f"  end {each.name};",
    ]
    return "\n".join("  " + line for line in lines)
