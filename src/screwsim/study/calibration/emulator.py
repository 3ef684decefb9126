"""Figures of a fit over its parameters as quadratic polynomials through solutions, with their errors.

A chain needs some hundred thousand evaluations; polynomials over the relevant region provide them, and their errors are
estimated from each solution's deviation from the fit to the others.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from screwsim.study.calibration.fit import Fit
from screwsim.study.calibration.residuals import Array, Objective, Simulate
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED

PER_TERM = 2  # solutions per coefficient
Key = tuple[str, str]  # name of the point, figure


class FigureRow(NamedTuple):
    """Figures [SI] of all points at one set of places; NaN for missing ones."""

    figures: tuple[float, ...]
    why: str = ""


@dataclass(frozen=True)
class Emulator:
    """Figures over places 0 … 1 within `low` … `high`; rows of `coefficients` are the terms, columns the figures.

    `off`: root mean square of the leave-one-out errors, by figure [SI]. `solutions` is the number of solutions,
    `failed` the number of places without all figures.
    """

    keys: tuple[Key, ...]
    low: Array
    high: Array
    coefficients: Array
    off: Array
    solutions: int
    failed: int

    def __call__(self, places: Array) -> Array:
        """Return all figures [SI] at places (…, parameters)."""
        return terms((places - self.low) / (self.high - self.low)) @ self.coefficients


def terms(x: Array) -> Array:
    """Return 1, x, and all products of two of x (…, terms), with x the places scaled from 0 … 1 to −1 … 1."""
    x = 2.0 * np.asarray(x, float) - 1.0
    size = x.shape[-1]
    products = [x[..., i] * x[..., j] for i in range(size) for j in range(i, size)]
    return np.stack([np.ones(x.shape[:-1]), *np.moveaxis(x, -1, 0), *products], axis=-1)


def solved_rows(
    fits: Sequence[Fit], places: Array, simulate: Simulate | None, jobs: int | None, progress: Progress | None
) -> list[FigureRow]:
    """Return the figures of one fit after the other at all places."""
    return parallel_map(
        partial(_solved_row, fits, places, simulate),
        len(fits) * len(places),
        died=lambda number: FigureRow((), WORKER_DIED),
        jobs=jobs,
        progress=progress,
    )


def _solved_row(fits: Sequence[Fit], places: Array, simulate: Simulate | None, number: int) -> FigureRow:
    fit, place = divmod(number, len(places))
    return figures_at(fits[fit], places[place], simulate)


def places_within(fit: Fit, low: Array, high: Array) -> Array:
    """Return the places of a region that are solved for its polynomials: its middle and a Latin hypercube."""
    from scipy.stats import qmc

    size = len(low)
    count = PER_TERM * (size + 1) * (size + 2) // 2
    cube = qmc.LatinHypercube(size, rng=np.random.default_rng(fit.seed)).random(count)
    return low + (high - low) * np.vstack([np.full(size, 0.5), cube])


def figures_at(fit: Fit, places: Array, simulate: Simulate | None) -> FigureRow:
    """Return the figures of every point at one set of places (parameters,)."""
    asked = Objective(fit, simulate)
    values, found, why = asked.values(places), [], ""
    for point in fit.points:
        result = asked.solved(point, values)
        why = why or ("" if result.status == "ok" else f"{point.name}: {result.told}")
        found += [result.performance.get(figure) for figure in point.measured]
    return FigureRow(tuple(np.nan if value is None else float(value) for value in found), why)


def fitted(fit: Fit, low: Array, high: Array, places: Array, rows: list[FigureRow]) -> Emulator | None:
    """Return polynomials of all measured figures over a region of places; None where too few solutions have figures.

    They are those of least squares through the solutions at `places`.
    """
    keys = tuple((point.name, figure) for point in fit.points for figure in point.measured)
    whole = [len(row.figures) == len(keys) and bool(np.isfinite(row.figures).all()) for row in rows]
    design = terms((places[whole] - low) / (high - low))
    if len(design) <= design.shape[1]:
        return None
    values = np.array([row.figures for row, good in zip(rows, whole, strict=True) if good])
    coefficients = np.asarray(np.linalg.lstsq(design, values)[0], float)
    leverage = np.einsum("ij,ji->i", design, np.linalg.pinv(design))
    left_out = (values - design @ coefficients) / np.maximum(1.0 - leverage, 1e-6)[:, None]
    off = np.sqrt(np.mean(left_out**2, axis=0))
    return Emulator(keys, low, high, coefficients, off, len(rows) * len(fit.points), len(rows) - int(sum(whole)))
