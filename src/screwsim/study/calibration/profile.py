"""Likelihood of measured points over one parameter at a time, and the evidence of its best change.

Gauss-Newton steps with slopes lead from the unchanged value of the parameter to a best one; a few places between the
bounds are solved, too, because a figure that falls and rises with the parameter (power over the oil ratio) may fit
twice. Between solutions the residuals are interpolated (modified Akima); where the likelihood lies, more are added.

With residuals r over their uncertainties, slopes j over the place u of the parameter (0 … 1 between its bounds) and C =
1 + M Mᵀ, where the columns of M are the changes of the residuals by one standard uncertainty of each input of the
unchanged machine, the likelihood is exp(-½ (r + j s)ᵀ C⁻¹ (r + j s)) over steps s. The evidence is its integral over
the places, uniform between the bounds (MacKay 2003, chapter 28): of two that fit equally well, the one with less
freedom is more probable.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from screwsim.study.calibration.hypotheses import INTERVAL_LEVEL
from screwsim.study.calibration.residuals import Array, Objective

TAILS = 0.5 - 0.5 * INTERVAL_LEVEL, 0.5 + 0.5 * INTERVAL_LEVEL  # probabilities below the ends of an interval
STEPS, HALVINGS = 6, 4
LAST_STEP = 0.1  # of a standard error: a shorter step ends the search
SCANNED_PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)  # places between the bounds
ROUNDS, QUANTILES = 2, (0.05, 0.5, 0.95)  # rounds of further solutions, and the quantiles of their places
LEAST_SPACING = 0.15  # of the distance between the outer two quantiles: least distance from known solutions
GRID, FINER = 401, 3  # places of a grid, and number of its refinements where the likelihood lies
NEGLIGIBLE_DEPTH = 60.0  # of chi² above the least, where the likelihood is negligible
BARRIER, DEEP = 2.0, 6.0  # of chi²: least barrier between two best values, and largest depth above the best


@dataclass(frozen=True)
class LinearLikelihood:
    """Likelihood along one place, from residuals and slopes at a place: best place, its chi², its sharpness.

    `information` is one over the variance of the place; 0 where the residuals do not depend on it.
    """

    place: float
    chi_squared: float
    information: float

    @property
    def estimate(self) -> float:
        """Best place between the bounds."""
        return float(np.clip(self.place, 0.0, 1.0))

    @property
    def misfit(self) -> float:
        """Chi² at the best place between the bounds."""
        return self.chi_squared + self.information * (self.estimate - self.place) ** 2

    @property
    def log_evidence(self) -> float:
        """Logarithm of the mean likelihood between the bounds."""
        if self.information <= 0.0:
            return -0.5 * self.chi_squared
        sharp = self.information**0.5
        width = float(log_mass(-self.place * sharp, (1.0 - self.place) * sharp))
        return -0.5 * self.chi_squared + 0.5 * float(np.log(2.0 * np.pi / self.information)) + width

    @property
    def interval(self) -> tuple[float, float]:
        """Places between which the parameter lies with a probability of `INTERVAL_LEVEL`."""
        from scipy.stats import truncnorm

        if self.information <= 0.0:
            return TAILS
        deviation = self.information**-0.5
        ends = (0.0 - self.place) / deviation, (1.0 - self.place) / deviation
        low, high = (float(each) for each in truncnorm.ppf(TAILS, *ends, loc=self.place, scale=deviation))
        return low, high


def linear_likelihood(place: float, residuals: Array, slopes: Array) -> LinearLikelihood:
    """Return the likelihood along a place from whitened residuals and slopes (n,) there."""
    information, chi_squared = float(slopes @ slopes), float(residuals @ residuals)
    if information <= 1e-12:
        return LinearLikelihood(place, chi_squared, 0.0)
    step = -float(slopes @ residuals) / information
    return LinearLikelihood(place + step, max(0.0, chi_squared - information * step**2), information)


def whitener(inputs: Array) -> Array:
    """Return W (n, n) with WᵀW the inverse of 1 + M Mᵀ, from the columns M (n, inputs)."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(np.eye(len(inputs)) + inputs @ inputs.T)), float)


def log_mass(low: float | Array, high: float | Array) -> Array:
    """Return the logarithm of the standard normal distribution's mass between two ends, accurate in the tails."""
    from scipy.special import log_ndtr

    right = np.greater(low, 0.0)
    low, high = np.where(right, -np.asarray(high), low), np.where(right, -np.asarray(low), high)
    below, above = log_ndtr(low), log_ndtr(high)
    inside = above > below
    share = -np.exp(np.minimum(np.where(inside, below - above, -1.0), -1e-300))
    return np.where(inside, above + np.log1p(share), -np.inf)


@dataclass(frozen=True)
class ProfileLikelihood:
    """Chi² over a grid of places, the residuals at the best of them, and the solutions behind it.

    `nodes` are the residuals at places that were solved.
    """

    grid: Array
    chi_squared: Array
    residuals: Array
    nodes: Mapping[float, Array]
    solutions: int = 0
    failed: int = 0

    def curve(self) -> Callable[[Any], Array]:
        """Return the residuals as a function of the place, interpolated and extrapolated."""
        return _interpolated(self.nodes)

    @property
    def estimate(self) -> float:
        """Best place."""
        return float(self.grid[np.argmin(self.chi_squared)])

    @property
    def misfit(self) -> float:
        """Chi² at the best place."""
        return float(np.min(self.chi_squared))

    @property
    def log_evidence(self) -> float:
        """Logarithm of the mean likelihood between the bounds."""
        return float(np.log(np.trapezoid(self._density, self.grid))) - 0.5 * self.misfit

    @property
    def _density(self) -> Array:
        return np.exp(-0.5 * (self.chi_squared - self.misfit))

    def quantiles(self, shares: tuple[float, ...]) -> list[float]:
        """Return the places below which the parameter lies with these probabilities."""
        density = self._density
        mass = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(self.grid))])
        return [float(np.interp(share * mass[-1], mass, self.grid)) for share in shares]

    @property
    def interval(self) -> tuple[float, float]:
        """Places between which the parameter lies with a probability of `INTERVAL_LEVEL`."""
        low, high = self.quantiles(TAILS)
        return low, high

    def others(self) -> list[float]:
        """Return the places of other local optima that fit nearly as well and lie behind a barrier."""
        found = [int(np.argmin(self.chi_squared))]
        inner = np.concatenate([[np.inf], self.chi_squared, [np.inf]])
        low = np.flatnonzero((inner[1:-1] <= inner[:-2]) & (inner[1:-1] <= inner[2:]))
        for i in sorted(low.tolist(), key=lambda i: self.chi_squared[i]):
            depth = self.chi_squared[i]
            walls = [np.max(self.chi_squared[min(i, k) : max(i, k) + 1]) for k in found]
            if depth < self.misfit + DEEP and min(walls) > depth + BARRIER:
                found.append(i)
        return [float(self.grid[i]) for i in found[1:]]


def profile_likelihood(asked: Objective, white: Array, place: float, slopes: Array) -> ProfileLikelihood | None:
    """Return the likelihood over the one parameter of `asked`, which lies at a place with whitened slopes there.

    None where no other place has a solution at all points.
    """
    nodes: dict[float, Array] = {}
    _solve(asked, white, place, nodes)
    if not nodes:
        return None
    _gauss_newton(asked, white, place, slopes, nodes)
    for scanned in SCANNED_PLACES:
        if min(abs(scanned - known) for known in nodes) > 0.01:
            _solve(asked, white, scanned, nodes)
    if len(nodes) < 2:
        return None
    found = _likelihood_over(nodes)
    for _ in range(ROUNDS):
        places = [*found.quantiles(QUANTILES), found.estimate]
        near = LEAST_SPACING * (places[2] - places[0])
        for each in places:
            if min(abs(each - known) for known in nodes) > max(near, 1e-5):
                _solve(asked, white, each, nodes)
        found = _likelihood_over(nodes)
    return replace(found, solutions=asked.solutions, failed=asked.failed)


def _solve(asked: Objective, white: Array, place: float, nodes: dict[float, Array]) -> bool:
    """Add the residuals at a place where all points have a solution; return whether they have."""
    there = asked.outcome(np.array([place]))
    if not there.reasons:
        nodes[place] = white @ there.residuals
    return not there.reasons


def _gauss_newton(asked: Objective, white: Array, place: float, slopes: Array, nodes: dict[float, Array]) -> None:
    """Add the residuals along Gauss-Newton steps, halved where chi² grows."""
    for _ in range(STEPS):
        here = nodes[place]
        known = linear_likelihood(place, here, slopes)
        step = known.estimate - place
        if abs(step) * known.information**0.5 < LAST_STEP or abs(step) < 1e-6:
            return
        for _ in range(HALVINGS):
            if _solve(asked, white, place + step, nodes) and np.sum(nodes[place + step] ** 2) < here @ here:
                break
            step *= 0.5
        else:
            return
        place += step
        slopes = white @ asked.slopes(np.array([place]))[:, 0]


def _interpolated(nodes: Mapping[float, Array]) -> Callable[[Any], Array]:
    from scipy.interpolate import Akima1DInterpolator

    places = np.array(sorted(nodes))
    residuals = np.array([nodes[place] for place in places])
    if len(places) > 2:
        return Akima1DInterpolator(places, residuals, method="makima", extrapolate=True)
    slope = (residuals[1] - residuals[0]) / (places[1] - places[0])
    return lambda at: residuals[0] + np.multiply.outer(np.asarray(at) - places[0], slope)


def refined_grid(height: Callable[[Array], Array], depth: float) -> Array:
    """Return a grid of places, finer where a function of the place is less than a depth below its largest value."""
    grid = np.linspace(0.0, 1.0, GRID)
    for _ in range(FINER):
        there = np.flatnonzero(height(grid) > np.max(height(grid)) - depth)
        first, last = max(0, there[0] - 1), min(len(grid) - 1, there[-1] + 1)
        grid = np.union1d(grid, np.linspace(grid[first], grid[last], GRID))
    return grid


def _likelihood_over(nodes: Mapping[float, Array]) -> ProfileLikelihood:
    """Return the likelihood from residuals at places; beyond the outer ones they are extrapolated."""
    places, between = np.array(sorted(nodes)), _interpolated(nodes)
    grid = np.union1d(refined_grid(lambda at: -np.sum(between(at) ** 2, axis=1), NEGLIGIBLE_DEPTH), places)
    chi_squared = np.sum(between(grid) ** 2, axis=1)
    return ProfileLikelihood(grid, chi_squared, between(grid[np.argmin(chi_squared)]), dict(nodes))
