"""Posterior of a fit's parameters given its measured points, by Bayes' rule, sampled with emcee.

Measured = model (parameters) + discrepancy + measurement. The discrepancy of each figure, what the model cannot follow
whatever its parameters, is an independent normal deviation at every point, whose width is inferred with the parameters.
Priors: parameters uniform between their bounds, or normal where the fit states a prior, or by the tolerance that the
scene states; widths half-Cauchy, with the scale of the figure's stated uncertainty (Gelman 2006: weak, and without an
upper end). Places are 0 … 1 between the bounds.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.study.calibration.answers import QUANTILES, ParameterInterval, Posterior, PredictiveCheck
from screwsim.study.calibration.emulator import Emulator, Key, figures_at, fitted, places_within, solved_rows
from screwsim.study.calibration.fit import Fit, Parameter, Prior
from screwsim.study.calibration.residuals import Array, Simulate
from screwsim.study.calibration.solve import Calibration
from screwsim.study.pool.progress import Progress

# standard errors of the fit to each side in which the posterior is sought; widened where it is cut off,
REGION_WIDTH = 5.0
MOST_WIDENINGS = 3  # times at most
LEAST_REGION = 0.02  # of the bounds, likewise: polynomials of a smaller region would follow the errors of the solutions
# share of the samples in the outer twentieth of the region on one side, from which on it is cut off
CUT_OFF_SHARE = 0.003
WALKERS, STEPS, MOST_STEPS = 6, 2000, 16000  # walkers per dimension; steps per stretch, and in all
LEAST_AUTOCORRELATION_TIMES = 50.0  # autocorrelation times that a chain must have (emcee's advice)
CONVERGED_R_HAT = 1.01  # split-R̂ below which chains have converged (Vehtari et al. 2021)
CHECKED_DRAWS = 8  # draws that are solved to find the errors of the polynomials
# of a figure's uncertainty: with larger errors the posterior is that of the polynomials, not the model
TOLERATED_ERROR = 0.5
# likewise of the log-posterior's error: no parameter's mean is shifted by more of its standard deviation
TOLERATED_SHIFT = 0.5
# width of a parameter's posterior over its prior's from which on the points hardly determine it
UNDETERMINED_SHARE = 0.8


@dataclass(frozen=True)
class _LogPosterior:
    """Logarithm of the posterior over places and logarithms of the widths.

    For correlated parameters the state holds their deviations in standard deviations instead of places: their
    correlation is linear there, which chains can follow.
    """

    fit: Fit
    emulator: Emulator
    figures: tuple[str, ...]
    which: np.ndarray  # index of the figure of each key
    fitted: np.ndarray  # which keys belong to fitted points
    value: Array
    uncertainty: Array
    scale: Array  # of the widths, by figure

    @property
    def size(self) -> int:
        return len(self.fit.parameters) + len(self.figures)

    def parted(self, at: Array) -> tuple[Array, Array]:
        """Return places and widths [SI] of states (…, size)."""
        count = len(self.fit.parameters)
        places = np.array(at[..., :count])
        for i in self._bound:
            places[..., i] = _places_of_off(self.fit.parameters[i], self.fit.held[i], at[..., i])
        return places, np.exp(np.clip(at[..., count:], -30.0, 30.0)) * self.scale

    @property
    def _bound(self) -> tuple[int, ...]:
        return tuple(i for group in self.fit.together for i in group)

    def begun(self, places: Array) -> Array:
        """Return the first part of states, from places (n, parameters)."""
        found = np.array(places)
        for i in self._bound:
            parameter, prior = self.fit.parameters[i], self.fit.held[i]
            found[:, i] = [prior.off(parameter.value(place)) for place in places[:, i].tolist()]
        return found

    def __call__(self, at: Array) -> Array:
        """Return the logarithms of the posterior of states (n, size)."""
        places, widths = self.parted(at)
        inside = np.all((places >= self.emulator.low) & (places <= self.emulator.high), axis=-1)
        left = self.misfit(self.emulator(places), widths, self.emulator.off)
        ratio = at[:, places.shape[-1] :]
        wide = -np.sum(np.logaddexp(ratio, -ratio), axis=-1)  # half-Cauchy over the logarithm: falls to both sides
        return np.where(inside, -0.5 * left + wide + self._prior(places), -np.inf)

    def misfit(self, figures: Array, widths: Array, off: Array) -> Array:
        """Return −2 log-likelihood of the fitted measurements, given figures (n, keys) with the errors `off`."""
        variance = self.uncertainty**2 + off**2 + widths[:, self.which] ** 2
        return np.where(self.fitted, (figures - self.value) ** 2 / variance + np.log(variance), 0.0).sum(axis=-1)

    def _prior(self, places: Array) -> Array:
        """Return the logarithm of the parameters' priors, stated over the value, as densities over the place.

        Where nothing else is known, the density over the place is uniform.
        """
        total = np.zeros(len(places))
        off = np.zeros((len(self.fit.held), len(places)))
        for row, (i, prior) in enumerate(self.fit.held.items()):
            parameter = self.fit.parameters[i]
            values = [parameter.value(float(place)) for place in places[:, i]]
            off[row] = [prior.off(value) for value in values]
            # else the derivative is the same everywhere
            if i not in self._bound and prior.logarithmic != parameter.logarithmic:
                total += np.log([prior.slope(value) * parameter.slope(value) for value in values])
        if self.fit.together:
            off = self.fit.whitener @ off
        return total - 0.5 * np.sum(off**2, axis=0)


def _places_of_off(parameter: Parameter, prior: Prior, off: Array) -> Array:
    """Return the places at which a parameter is so many standard deviations off its prior's mean."""
    by = prior.deviation * off
    values = prior.mean * np.exp(np.clip(by, -700.0, 700.0)) if prior.logarithmic else prior.mean + by
    if parameter.logarithmic:
        size = np.log(parameter.high / parameter.low)
        return np.log(np.maximum(values / parameter.low, 1e-300)) / size
    return (values - parameter.low) / (parameter.high - parameter.low)


def refuse_curves(fit: Fit) -> None:
    """Raise UsageError where a fit measures curves at angles, which the model of a discrepancy does not suit."""
    if any(point.traced for point in fit.points):
        what = "a posterior has a discrepancy for each figure, and values of one cycle miss the model together"
        raise UsageError(f"{what} (take their columns out of the data)")


def posterior(
    found: Calibration,
    *,
    simulate: Simulate | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
    most_steps: int = MOST_STEPS,
) -> Posterior:
    """Return the posterior of the parameters of a fit, starting from its best values.

    Raise UsageError for a fit to curves at angles: each would need a width of its own for what the model misses.
    """
    refuse_curves(found.fit)
    try:
        import emcee
    except ImportError:
        remedy = "pip install 'screwsim[posterior]'"
        raise UsageError(f"emcee is not installed, which --posterior needs (install it with: {remedy})") from None
    if not found.values:
        return Posterior(found.fit, "failed", f"there is no fit to start from: {found.message}")
    reach = np.maximum(REGION_WIDTH * _errors(found), LEAST_REGION)
    places = found.fit.places(found.values)
    low, high = np.maximum(0.0, places - reach), np.minimum(1.0, places + reach)
    solutions = failed = widened = 0
    while True:
        at = places_within(found.fit, low, high)
        emulator = fitted(found.fit, low, high, at, solved_rows([found.fit], at, simulate, jobs, progress))
        if emulator is None:
            why = "too few solutions near the best fit have all figures (narrow the bounds)"
            return Posterior(found.fit, "failed", why, solutions=solutions, failed=failed)
        solutions, failed = solutions + emulator.solutions, failed + emulator.failed
        problem = _problem(found.fit, emulator)
        chain = _sampled_chain(emcee, problem, found, most_steps)
        cut = _cut_off_sides(problem.parted(chain.flat)[0], low, high)
        if widened == MOST_WIDENINGS or not cut.any():
            return _posterior_of_chain(problem, chain, simulate, cut, (solutions, failed))
        width = high - low
        low = np.where(cut[0], np.maximum(0.0, low - width), low)
        high = np.where(cut[1], np.minimum(1.0, high + width), high)
        widened += 1


def _errors(found: Calibration) -> Array:
    """Return the standard errors of the best fit's places; a share of the bounds for those that are not known."""
    if found.certainty is None:
        return np.full(len(found.fit.parameters), 1.0 / REGION_WIDTH)
    pairs = zip(found.fit.parameters, found.certainty.errors, strict=True)
    slopes = [(max(each.slope(found.values[each.path]), 1e-300), error) for each, error in pairs]
    return np.array([1.0 / REGION_WIDTH if error is None else found.scale * error / slope for slope, error in slopes])


def _cut_off_sides(places: Array, low: Array, high: Array) -> np.ndarray:
    """Return on which sides (2, parameters) of the region, other than the bounds, the samples are cut off."""
    edge = 0.05 * (high - low)
    below = (np.mean(places < low + edge, axis=0) > CUT_OFF_SHARE) & (low > 0.0)
    above = (np.mean(places > high - edge, axis=0) > CUT_OFF_SHARE) & (high < 1.0)
    return np.array([below, above])


def _problem(fit: Fit, emulator: Emulator) -> _LogPosterior:
    measured = [each for point in fit.points for each in point.measured.values()]  # as the emulator has them
    fitted = {point.name for point in fit.fitted}
    figures = tuple(dict.fromkeys(figure for point, figure in emulator.keys if point in fitted))
    which = np.array([figures.index(figure) if figure in figures else 0 for _, figure in emulator.keys])
    uncertainty = np.array([each.uncertainty for each in measured])
    used = np.array([point in fitted for point, _ in emulator.keys])
    scale = np.array([np.median(uncertainty[used & (which == i)]) for i in range(len(figures))])
    value = np.array([each.value for each in measured])
    return _LogPosterior(fit, emulator, figures, which, used, value, uncertainty, scale)


@dataclass(frozen=True)
class _Chain:
    states: Array  # (steps, walkers, size), without the burn-in
    steps: int
    autocorrelation: float
    r_hat: float

    @property
    def flat(self) -> Array:
        return self.states.reshape(-1, self.states.shape[-1])


def _sampled_chain(emcee: Any, problem: _LogPosterior, found: Calibration, most: int) -> _Chain:
    """Return states of the posterior, after as many steps as convergence takes, or the most allowed."""
    generator = np.random.default_rng(found.fit.seed)
    places = found.fit.places(found.values)
    width = problem.emulator.high - problem.emulator.low
    walkers = WALKERS * problem.size
    spread = np.minimum(0.05 * width, _errors(found))
    start = places + spread * generator.standard_normal((walkers, len(places)))
    margin = 0.01 * width
    start = np.clip(start, problem.emulator.low + margin, problem.emulator.high - margin)
    # makes walkers distinct that a bound has clipped to the same place
    start += np.minimum(1e-4 * width, spread) * generator.random(start.shape)
    states = np.hstack([problem.begun(start), 0.3 * generator.standard_normal((walkers, len(problem.figures))) - 0.5])
    moves = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DEMove(gamma0=1.0), 0.2)]
    sampler = emcee.EnsembleSampler(walkers, problem.size, problem, vectorize=True, moves=moves)
    sampler.random_state = np.random.RandomState(found.fit.seed).get_state()
    # not DESnookerMove: in emcee 3.1.6 its acceptance does not match its steps, and intervals come out too narrow
    while True:
        states = sampler.run_mcmc(states, min(STEPS, most), skip_initial_state_check=True)
        done = sampler.iteration
        tau = float(np.max(sampler.get_autocorr_time(tol=0)))
        kept = sampler.get_chain(discard=done // 4)
        r_hat = float(np.max(split_r_hat(kept)))
        if (done >= LEAST_AUTOCORRELATION_TIMES * tau and r_hat < CONVERGED_R_HAT) or done >= most:
            return _Chain(kept, done, tau, r_hat)


def split_r_hat(chains: Array) -> Array:
    """Return split-R̂ of chains (steps, chains, size), by coordinate: 1 where halves of all chains agree."""
    half = len(chains) // 2
    parts = np.concatenate([chains[:half], chains[half : 2 * half]], axis=1)
    within = parts.var(axis=0, ddof=1).mean(axis=0)
    between = half * parts.mean(axis=0).var(axis=0, ddof=1)
    return np.sqrt(((half - 1) / half * within + between / half) / np.maximum(within, 1e-300))


def _posterior_of_chain(
    problem: _LogPosterior, chain: _Chain, simulate: Simulate | None, cut: np.ndarray, made: tuple[int, int]
) -> Posterior:
    fit, generator = problem.fit, np.random.default_rng(problem.fit.seed)
    flat = chain.flat
    draws = flat[generator.choice(len(flat), size=min(4000, len(flat)), replace=False)]
    places, widths = problem.parted(draws)
    samples = np.array([[p.value(float(u)) for p, u in zip(fit.parameters, row, strict=True)] for row in places])
    off, shift, bad = _emulator_error(problem, draws, simulate)
    parameters = tuple(_parameter_interval(fit, i, samples[:, i]) for i in range(samples.shape[1]))
    discrepancies = tuple(_interval(name, widths[:, i]) for i, name in enumerate(problem.figures))
    settled = chain.r_hat < CONVERGED_R_HAT and chain.steps >= LEAST_AUTOCORRELATION_TIMES * chain.autocorrelation
    told = []
    if not settled:
        told.append(f"chains have not settled after {chain.steps} steps (R-hat {chain.r_hat:.3f})")
    for i in np.flatnonzero(cut.any(axis=0)):
        told.append(f"{fit.parameters[i].path} extends beyond the region examined (add points, or a prior)")
    if off is not None and off > TOLERATED_ERROR:
        told.append(f"the polynomials are off by up to {off:.2g} uncertainties (narrow the bounds)")
    elif shift is not None and shift > TOLERATED_SHIFT:
        what = f"the polynomials may shift the results by up to {shift:.2g} standard deviations"
        told.append(f"{what} (narrow the bounds)")
    predicted = tuple(_predictions(problem, places, widths, generator))
    return Posterior(
        fit,
        "not converged" if told else "ok",
        "; ".join(told),
        parameters,
        discrepancies,
        predicted,
        samples=samples,
        widths=widths,
        r_hat=chain.r_hat,
        autocorrelation=chain.autocorrelation,
        steps=chain.steps,
        effective=chain.states.shape[0] * chain.states.shape[1] / chain.autocorrelation,
        off=off,
        solutions=made[0] + CHECKED_DRAWS * len(fit.points),
        failed=made[1] + bad,
        region=(problem.emulator.low, problem.emulator.high),
    )


def _emulator_error(
    problem: _LogPosterior, draws: Array, simulate: Simulate | None
) -> tuple[float | None, float | None, int]:
    """Return the largest error of the polynomials at some draws, over the uncertainties; their shift; failed draws.

    The shift is the standard deviation of the polynomials' error in the log-posterior: the mean of no quantity is
    shifted by more of its own standard deviation.
    """
    some, widths = problem.parted(draws[:CHECKED_DRAWS])
    rows = [figures_at(problem.fit, places, simulate) for places in some]
    known = np.array([bool(np.isfinite(row.figures).all()) for row in rows])
    if not known.any():
        return None, None, len(rows)
    true = np.array([row.figures for row, good in zip(rows, known, strict=True) if good])
    ours = problem.emulator(some[known])
    errors = np.zeros_like(problem.emulator.off), problem.emulator.off
    exact, by_them = (problem.misfit(x, widths[known], off) for x, off in zip((true, ours), errors, strict=True))
    shift = float(np.std(0.5 * (exact - by_them), ddof=1)) if known.sum() > 1 else None
    return float(np.max(np.abs(ours - true) / problem.uncertainty)), shift, int(np.sum(~known))


def _parameter_interval(fit: Fit, number: int, values: Array) -> ParameterInterval:
    parameter = fit.parameters[number]
    even = float(np.std([parameter.value(float(u)) for u in np.linspace(0.0, 1.0, 201)]))
    prior = even if parameter.prior is None else min(parameter.prior.spread, even)
    found = _interval(parameter.path, values)
    return replace(found, of_prior=found.deviation / float(prior))


def _interval(name: str, values: Array) -> ParameterInterval:
    low, median, high = (float(each) for each in np.quantile(values, QUANTILES))
    return ParameterInterval(name, low, median, high, float(values.std()))


def _predictions(problem: _LogPosterior, places: Array, widths: Array, generator: np.random.Generator) -> Any:
    """Yield each measured figure with the posterior's prediction of a measurement of it."""
    ours = problem.emulator(places)
    variance = problem.uncertainty**2 + problem.emulator.off**2 + widths[:, problem.which] ** 2
    drawn = ours + np.sqrt(variance) * generator.standard_normal(ours.shape)
    ends = np.quantile(drawn, QUANTILES, axis=0)
    key: Key
    for i, key in enumerate(problem.emulator.keys):
        low, median, high = (float(each) for each in ends[:, i])
        yield PredictiveCheck(*key, bool(problem.fitted[i]), float(problem.value[i]), low, median, high)
