"""A map as ten-coefficient polynomials (AHRI 540, EN 12900) of both saturation temperatures, instead of a table.

There is one polynomial for each figure at each node of the other inputs, between which its coefficients follow a cubic
spline. A cell of cubic Hermite polynomials represents a cubic exactly, so that the same C code reads it: two nodes per
temperature suffice if all nodes of the table closed; else the table's nodes stay, with its flags.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from screwsim.export.hermite import Array, Grid, evaluate, points_of, slopes, with_middles
from screwsim.export.inputs import Input
from screwsim.export.map_table import MapTable
from screwsim.export.table import scales
from screwsim.inputs.faults import UsageError
from screwsim.study.maps.performance_map import TERMS, temperature_paths
from screwsim.study.stages.axes import STAGE_NAMES

FITTED_VALUES = 6  # values of each temperature to which a polynomial is fitted


def polynomial_table(table: MapTable, wanted: float | None = None) -> MapTable:
    """Return a map whose figures are polynomials fitted to another's; raise UsageError without both temperatures.

    Its errors are the largest differences from that table, at its nodes and half-way between, plus the table's own.
    """
    paths = [one.path for one in table.inputs]
    temperatures = [paths.index(path) for path in check_inputs(table.inputs)]
    grid = _grid(table.grid, temperatures)
    # the points of the grid and those half-way between
    points = points_of([with_middles(x) for x in table.grid.nodes])
    there, inside = evaluate(table.grid, points)
    found, _ = evaluate(grid, points)
    off = np.abs(found - there)[inside] / scales(table.outputs, np.where(inside[:, None], there, np.nan))[inside]
    errors = tuple(float(own + more) for own, more in zip(table.errors, off.max(axis=0), strict=True))
    how = table.how
    if math.isfinite(max(errors)):
        how = f"largest difference from a table at {len(off)} points of its grid, and the table's own: {table.how}"
    return replace(table, grid=grid, errors=errors, how=how, wanted=wanted)


def check_inputs(inputs: Sequence[Input]) -> tuple[str, str]:
    """Return the paths of both temperatures; raise UsageError where a map's inputs lack one of them."""
    paths = [one.path for one in inputs]
    both = temperature_paths(any(path.startswith(STAGE_NAMES) for path in paths))
    missing = [path for path in both if path not in paths]
    if missing:
        what = f"they need {' and '.join(missing)}, over which the map does not run"
        raise UsageError(f"no polynomials: {what} (name ranges with --over)")
    return both


def _grid(table: Grid, temperatures: Sequence[int]) -> Grid:
    """Return polynomials in two of the axes as a grid over all axes, in their order."""
    others = [axis for axis in range(len(table.nodes)) if axis not in temperatures]
    ends = [(table.nodes[axis][0], table.nodes[axis][-1]) for axis in temperatures]
    coefficients = _fitted(table, temperatures, others, ends)
    nodes = list(table.nodes)
    sound = table.sound
    if sound.all():
        for axis, both in zip(temperatures, ends, strict=True):
            nodes[axis] = np.array(both)
        sound = np.ones([len(x) for x in nodes], bool)
    data = np.empty((*(2,) * len(nodes), *sound.shape, coefficients.shape[-1]))
    for order in itertools.product((0, 1), repeat=len(nodes)):
        here = coefficients
        for place, axis in enumerate(others):
            if order[axis]:
                here = slopes(nodes[axis], here, place)
        powers = [_powers(nodes[axis], both, order[axis]) for axis, both in zip(temperatures, ends, strict=True)]
        terms = np.stack([powers[0][p][:, None] * powers[1][q] for p, q in TERMS], axis=-1)
        values = np.tensordot(terms, np.moveaxis(here, -2, 0), axes=1)  # temperatures, others, outputs
        data[order] = np.moveaxis(values, range(len(nodes)), [*temperatures, *others])
    return Grid(tuple(nodes), data, sound)


def _fitted(
    table: Grid, temperatures: Sequence[int], others: Sequence[int], ends: Sequence[tuple[float, float]]
) -> Array:
    """Return least-squares coefficients (others …, terms, outputs), with temperatures scaled to −1 … 1."""
    fitted = [np.linspace(*both, FITTED_VALUES) for both in ends]
    S, D = (x.ravel() for x in np.meshgrid(*fitted, indexing="ij"))
    powers = [_powers(x, both, 0) for x, both in zip((S, D), ends, strict=True)]
    design = np.stack([powers[0][p] * powers[1][q] for p, q in TERMS], axis=-1)
    shape = [len(table.nodes[axis]) for axis in others]
    found = np.empty((*shape, len(TERMS), table.data.shape[-1]))
    for index in np.ndindex(*shape):
        points = np.empty((len(S), len(table.nodes)))
        points[:, temperatures[0]], points[:, temperatures[1]] = S, D
        for axis, number in zip(others, index, strict=True):
            points[:, axis] = table.nodes[axis][number]
        values, inside = evaluate(table, points)
        found[index], _, rank, _ = np.linalg.lstsq(design[inside], values[inside])
        if rank < len(TERMS):
            raise UsageError(
                f"no polynomials: of {len(S)} points at one value of the other inputs only {int(inside.sum())} lie "
                f"among closed ones (narrow the ranges)"
            )
    return found


def _powers(x: Array, ends: tuple[float, float], order: int) -> list[Array]:
    """Return 1, t, t², t³ or their derivatives by x, where t is −1 and 1 at the ends."""
    half = 0.5 * (ends[1] - ends[0])
    t = (np.asarray(x) - ends[0]) / half - 1.0
    return [t**n for n in range(4)] if order == 0 else [n * t ** max(n - 1, 0) / half for n in range(4)]
