"""Predicted measurements at other operating points, from the posterior of a fit, and the parts of their uncertainty.

A measurement is the model at parameters of the posterior, plus a discrepancy with a width from the posterior, plus the
measurement's own uncertainty. The figures at each point are polynomials over the region of the posterior, as are those
of the fit's points.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.study.calibration.answers import QUANTILES, Posterior, Prediction, Predictions
from screwsim.study.calibration.emulator import fitted, places_within, solved_rows
from screwsim.study.calibration.fit import Fit, Measurement, Point
from screwsim.study.calibration.machine import points_of, typical_uncertainties
from screwsim.study.calibration.posterior import CHECKED_DRAWS, TOLERATED_ERROR, posterior
from screwsim.study.calibration.residuals import Array, Simulate
from screwsim.study.calibration.solve import Calibration
from screwsim.study.pool.progress import Progress


def points_to_predict(fit: Fit, file: str | os.PathLike[str], option: str = "predict") -> tuple[Point, ...]:
    """Return the points of a CSV file for `predict`; raise SceneError with one line per fault, UsageError."""
    points = points_of(fit, file, option, "points to predict")
    known_figures(fit, points)
    return points


def posterior_with_predictions(
    found: Calibration, points: Sequence[Point], *, jobs: int | None, progress: Progress | None = None
) -> Posterior:
    """Return the posterior of a fit, with predictions at points where there are any."""
    wide = posterior(found, jobs=jobs, progress=progress)
    return replace(wide, predictions=predict(wide, points, jobs=jobs, progress=progress)) if points else wide


def known_figures(fit: Fit, points: Sequence[Point]) -> tuple[str, ...]:
    """Return the figures that the fitted points measure; raise UsageError where others are to be predicted."""
    known = tuple(dict.fromkeys(name for point in fit.fitted for name in point.measured))
    for point in points:
        for name in point.measured:
            if name not in known:
                why = "is measured at no fitted point, so its discrepancy is not known"
                raise UsageError(f"{name}: {why} (known: {', '.join(known)})")
    return known


def predict(
    found: Posterior,
    points: Sequence[Point],
    *,
    simulate: Simulate | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Predictions:
    """Return predicted measurements at points, of every figure that the fitted points measure.

    The uncertainty of a measurement is the one that a point states for a figure, or the usual one of the fit's points
    (the median share of the value; for temperatures the median itself). A value that a point states is listed for
    comparison. Raises UsageError.
    """
    figures = known_figures(found.fit, points)
    if found.samples is None or found.widths is None or found.region is None:
        return Predictions("failed", f"there is no posterior to predict from: {found.message}", tuple(points))
    fit, usual = found.fit, typical_uncertainties(found.fit)
    measured = dict.fromkeys(figures, _NO_MEASUREMENT)
    asked = [replace(fit, points=(replace(point, measured=measured),)) for point in points]
    low, high = found.region
    samples = (zip(fit.parameters, row, strict=True) for row in found.samples.tolist())
    draws = np.array([[parameter.place(value) for parameter, value in sample] for sample in samples])
    spreads = [spread.name for spread in found.discrepancies]
    widths = found.widths[:, [spreads.index(name) for name in figures]]
    places = np.vstack([places_within(fit, low, high), draws[:CHECKED_DRAWS]])
    rows = solved_rows(asked, places, simulate, jobs, progress)
    generator = np.random.default_rng([fit.seed, 1])
    told: list[Prediction] = []
    reasons: dict[str, str] = {}
    far: dict[str, float] = {}
    for number, (point, fit_of_point) in enumerate(zip(points, asked, strict=True)):
        own = rows[number * len(places) : (number + 1) * len(places)]
        polynomials = fitted(fit_of_point, low, high, places[:-CHECKED_DRAWS], own[:-CHECKED_DRAWS])
        if polynomials is None:
            reasons[point.name] = next((row.why for row in own if row.why), "a figure has no value")
            continue
        drawn = polynomials(draws)
        stated, medians = point.measured, dict(zip(figures, np.median(drawn, axis=0).tolist(), strict=True))
        sizes = (stated[name].uncertainty if name in stated else usual[name].of(medians[name]) for name in figures)
        uncertainty = np.array(list(sizes))
        told += _point_predictions(point, figures, (drawn, widths, uncertainty, polynomials.off), generator)
        solved = [(at, row) for at, row in zip(draws, own[-CHECKED_DRAWS:], strict=False) if row.figures]
        solved = [(at, row) for at, row in solved if np.isfinite(row.figures).all()]
        off = [np.max(np.abs(polynomials(at) - row.figures) / uncertainty) for at, row in solved]
        far[point.name] = float(max(off, default=np.inf))
    failed = sum(bool(row.why) for row in rows)
    worst = max(far.values(), default=None)
    status, message = _status_and_message(reasons, len(points), far)
    return Predictions(status, message, tuple(points), tuple(told), reasons, worst, len(rows), failed)


_NO_MEASUREMENT = Measurement(0.0, 1.0)


def _point_predictions(
    point: Point, figures: Sequence[str], parts: tuple[Array, Array, Array, Array], generator: np.random.Generator
) -> list[Prediction]:
    """Return a point's predictions from figures and widths at draws, measurement uncertainties, polynomial errors."""
    computed, widths, uncertainty, off = parts
    variance = widths**2 + uncertainty**2 + off**2
    drawn = computed + np.sqrt(variance) * generator.standard_normal(computed.shape)
    ends = np.quantile(drawn, QUANTILES, axis=0)
    sizes = np.array([computed.std(axis=0), np.sqrt(np.mean(widths**2, axis=0)), uncertainty, off])
    found = []
    for i, name in enumerate(figures):
        value = point.measured[name].value if name in point.measured else np.nan
        known = None if np.isnan(value) else float(value)
        found.append(Prediction(point.name, name, *ends[:, i].tolist(), *sizes[:, i].tolist(), measured=known))
    return found


def _status_and_message(reasons: Mapping[str, str], count: int, far: Mapping[str, float]) -> tuple[str, str]:
    if reasons:
        return "failed", f"{len(reasons)} of {count} points have no solution"
    bad = [name for name, off in far.items() if off > TOLERATED_ERROR]
    if bad:
        what = f"the polynomials are off by up to {max(far.values()):.2g} uncertainties at {', '.join(bad)}"
        return "not converged", f"{what} (narrow the bounds)"
    return "ok", ""
