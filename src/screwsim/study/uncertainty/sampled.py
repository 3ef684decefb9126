"""A sample of the inputs within their tolerances: whether the linear uncertainty of a scene or two stages is enough."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from screwsim.figures import declared
from screwsim.inputs.faults import UsageError
from screwsim.scene.values import within
from screwsim.study.asked.varied import Varied, leaf_of, value_at
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.solving import results_at
from screwsim.study.uncertainty.point import uncertainty
from screwsim.study.uncertainty.spreads import FigureSample, Tolerances, Uncertainty, groups_of, tolerances_of

# of a standard uncertainty: tolerated difference of sampled and linear one; for few samples their scatter
LINEAR_TOLERANCE = 0.25
MEAN_TOLERANCE = 0.5  # of a standard uncertainty: allowed distance of a sample's mean from the figure
LEAST_COUNT = 8
SHARE_NEEDED = 0.5  # of the samples: with fewer solutions they say nothing
ROUNDING, ROUNDING_KELVIN = 1e-9, 1e-6  # of a figure; [K] of a temperature, and of a difference of two


def checked_by_sample(
    of: Varied,
    linear: Uncertainty,
    count: int,
    *,
    seed: int = 1,
    jobs: int | None,
    progress: Progress | None = None,
) -> Uncertainty:
    """Return the same with a Sobol sample of the inputs beside it: where both differ, the linear estimate is wrong.

    Samples without figures are left out, and the message tells their number and why.
    """
    refuse_count(count)
    points = drawn_inputs(of, count, seed)
    results = results_at(of, points, jobs=jobs, progress=progress)
    good = [result for result in results if result.status == "ok"]
    bad = next((result for result in results if result.status != "ok"), None)
    message = "" if bad is None else f"{count - len(good)} of {count} samples have no figures: {bad.told}"
    if len(good) < SHARE_NEEDED * count:
        return replace(linear, samples=count, message=message)
    sampled, here = {}, linear.slopes.result.performance
    for name, spread in linear.spreads.items():
        values = [result.performance.get(name) for result in good]
        if None not in values:
            sampled[name] = _compared(np.array(values, float), here[name], spread.standard, rounding(name, here[name]))
    return replace(linear, samples=count, sampled=sampled, message=message)


def refuse_count(count: int) -> None:
    """Raise UsageError for a number of samples that a Sobol sequence cannot have."""
    if count < LEAST_COUNT or count & (count - 1):
        raise UsageError(f"--check-sobol {count}: is not a power of two from {LEAST_COUNT} on (write e.g. 64)")


def linear_uncertainty(of: Varied, figures: Sequence[str], *, jobs: int | None) -> Uncertainty:
    """Return the linear uncertainties of figures (none: all) of a scene or two stages; raise UsageError."""
    found = uncertainty(of, jobs=jobs)
    if lacking := next((name for name in figures if found.spreads and name not in found.spreads), ""):
        raise UsageError(f"--figure {lacking}: has no uncertainty from the inputs here (choose another)")
    return replace(found, spreads={name: found.spreads[name] for name in figures or found.spreads if found.spreads})


def rounding(name: str, value: float) -> float:
    """Return the size of a difference of a figure, in its own unit, below which it is rounding."""
    return ROUNDING_KELVIN if declared(name).units in ("K", "kelvin") else ROUNDING * abs(value)


def drawn_inputs(of: Varied, count: int, seed: int = 1) -> list[dict[str, float]]:
    """Return a Sobol sample of the inputs [SI]; correlated inputs move together."""
    from scipy.stats import norm, qmc

    tolerances = tolerances_of(of)
    groups = groups_of(tolerances)
    sample = qmc.Sobol(len(groups), scramble=True, rng=seed).random(count)
    deviations = np.asarray(norm.ppf(np.clip(sample, 1e-9, 1.0 - 1e-9)))
    named = [(i, path) for i, group in enumerate(groups) for path in group]
    return [
        {path: _value_within_limits(of, tolerances, path, float(row[i])) for i, path in named} for row in deviations
    ]


def _value_within_limits(of: Varied, tolerances: Tolerances, path: str, deviation: float) -> float:
    """Return the value [SI] at so many standard uncertainties; clipped to its 95 % interval where out of limits."""
    value = float(value_at(of, path))
    tolerance = tolerances.uncertain[path].around(value)
    found = tolerance.at(value, deviation)
    return found if within(leaf_of(of, path), found) else tolerance.at(value, float(np.clip(deviation, -2.0, 2.0)))


def _compared(values: np.ndarray, figure: float, linear: float, least: float) -> FigureSample:
    mean, standard = float(values.mean()), float(values.std(ddof=1))
    largest, chance = max(standard, linear, least), 2.0 / (2.0 * (len(values) - 1)) ** 0.5
    wrong = []
    if abs(standard - linear) > max(LINEAR_TOLERANCE, chance) * largest:
        wrong.append(f"its spread is {standard / linear if linear else float('inf'):.2g} times the linear one")
    if abs(mean - figure) > MEAN_TOLERANCE * largest:
        wrong.append("its mean differs from the figure")
    return FigureSample(mean, standard, ", and ".join(wrong))
