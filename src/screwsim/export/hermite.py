"""Interpolation on a grid with continuous first derivatives: tensor products of cubic Hermite polynomials.

The polynomial of a cell follows from values, slopes and mixed derivatives at its corners alone; neighbours share those,
so that value and gradient are continuous everywhere, whatever the slopes are. The slopes are those of a cubic spline
through the nodes of a line (error of order h⁴), limited as by Hyman (1983): |slope| ≤ 3 |secant| of both neighbouring
steps, and of their sign where these agree. So along grid lines the interpolation is monotone where the nodes are, and
next to an extreme node it overshoots by at most √2 − 1 of a step (tests/export).
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes of each axis, and `data` (2, …, 2, nodes …, outputs): values, with index 1 for a derivative by that axis.

    `sound` (nodes …) says which nodes have values of their own; the others are filled so that nothing is undefined.
    """

    nodes: tuple[Array, ...]
    data: Array
    sound: Array


def with_middles(x: Array) -> Array:
    """Return increasing values and the middles between them."""
    return np.sort(np.concatenate([x, 0.5 * (x[1:] + x[:-1])]))


def points_of(axes: Sequence[Array]) -> Array:
    """Return all points (n, axes) of a grid, the last axis fastest."""
    return np.column_stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")])


def grid_of(nodes: Sequence[Array], values: Array, sound: Array) -> Grid:
    """Return the interpolation of values (nodes …, outputs) over increasing axes; unsound nodes have no influence."""
    filled = _filled(values, sound)
    derived = [filled]
    for axis, x in enumerate(nodes):
        derived += [_slopes(x, each, sound, axis, limited=i == 0) for i, each in enumerate(derived)]
    data = np.empty((*(2,) * len(nodes), *values.shape))
    for number, each in enumerate(derived):
        data[tuple(number >> axis & 1 for axis in range(len(nodes)))] = each
    return Grid(tuple(np.asarray(x, float) for x in nodes), data, sound)


def evaluate(grid: Grid, x: Array) -> tuple[Array, Array]:
    """Return the outputs at points (n, axes), constant beyond the border, and whether each lies among sound nodes."""
    x = np.atleast_2d(np.asarray(x, float))
    places, bases, inside = [], [], np.ones(len(x), bool)
    for axis, nodes in enumerate(grid.nodes):
        slack = 1e-12 * (nodes[-1] - nodes[0])
        inside &= (x[:, axis] >= nodes[0] - slack) & (x[:, axis] <= nodes[-1] + slack)
        at = np.clip(x[:, axis], nodes[0], nodes[-1])
        cell = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
        width = nodes[cell + 1] - nodes[cell]
        places.append(cell)
        bases.append(basis((at - nodes[cell]) / width, width))
    found = np.zeros((len(x), grid.data.shape[-1]))
    for corner in itertools.product((0, 1), repeat=len(places)):
        index = tuple(cell + step for cell, step in zip(places, corner, strict=True))
        inside &= grid.sound[index]
        for derived in itertools.product((0, 1), repeat=len(places)):
            weight = np.ones(len(x))
            for axis, (step, order) in enumerate(zip(corner, derived, strict=True)):
                weight = weight * bases[axis][step][order]
            found += weight[:, None] * grid.data[derived][index]
    return found, inside


def slopes(x: Array, values: Array, axis: int) -> Array:
    """Return the slopes of values along an axis with nodes x, from a cubic spline; they are linear in the values."""
    return _slopes(x, np.asarray(values, float), np.ones(np.shape(values)[:-1], bool), axis, limited=False)


def basis(t: Array, width: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return the weights of value and slope at both ends of an interval, at the fraction t of its width."""
    s = 1.0 - t
    return (s * s * (1.0 + 2.0 * t), width * t * s * s), (t * t * (3.0 - 2.0 * t), -width * t * t * s)


def _filled(values: Array, sound: Array) -> Array:
    """Return values in which each unsound node has those of the nearest sound one."""
    from scipy.ndimage import distance_transform_edt

    if sound.all():
        return np.asarray(values, float)
    nearest: Any = distance_transform_edt(~sound, return_distances=False, return_indices=True)
    return np.asarray(values, float)[tuple(nearest)]


def _slopes(x: Array, values: Array, sound: Array, axis: int, limited: bool) -> Array:
    """Return the slopes of values along an axis, from each run of sound nodes separately; 0 at unsound ones."""
    y = np.moveaxis(values, axis, 0)
    own = np.broadcast_to(sound[..., None], values.shape)
    ok = np.moveaxis(own, axis, 0).reshape(len(x), -1)
    flat = y.reshape(len(x), -1)
    found = np.zeros_like(flat)
    whole = ok.all(axis=0)
    if whole.any():
        found[:, whole] = _run(x, flat[:, whole], limited)
    for column in np.flatnonzero(~whole):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], ok[:, column].astype(int), [0]])))
        for first, last in [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > 1]:
            piece = slice(first, last)
            found[piece, column] = _run(x[piece], flat[piece, column : column + 1], limited)[:, 0]
    return np.moveaxis(found.reshape(y.shape), 0, axis)


def _run(x: Array, y: Array, limited: bool) -> Array:
    """Return the slopes of columns y at nodes x: of a spline, of a parabola for three nodes, of a line for two."""
    from scipy.interpolate import CubicSpline

    if len(x) == 2:
        return np.repeat((y[1:] - y[:-1]) / (x[1] - x[0]), 2, axis=0)
    slopes = CubicSpline(x, y, axis=0, bc_type="not-a-knot")(x, 1)
    return _limited(slopes, np.diff(y, axis=0) / np.diff(x)[:, None]) if limited else slopes


def _limited(slopes: Array, secants: Array) -> Array:
    """Return slopes limited to three times both neighbouring secants, and to their sign where these agree (Hyman)."""
    left, right = np.vstack([secants[:1], secants]), np.vstack([secants, secants[-1:]])
    most = 3.0 * np.minimum(np.abs(left), np.abs(right))
    sign = np.sign(left)
    steady = np.clip(slopes * sign, 0.0, most) * sign
    return np.where(left * right > 0.0, steady, np.clip(slopes, -most, most))
