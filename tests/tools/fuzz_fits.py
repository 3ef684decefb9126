"""Ask for random fits with priors, plans and posteriors of one or two unknowns, and judge each by numpy.

Run: fuzz_fits.py [fits|plans|posteriors] [--seed 1] [--count 20]. The fits are those of `drawn_fits.py`. A fit must be
the least of its own sum of squares with priors, its errors and correlations those of its slopes, and the scene that it
writes the fitted machine. A plan's deviations and gains must be those of the information matrix by differences of runs,
and no other choice of points better. A posterior's quantiles must be those of an integral over a grid, with the widths
of the discrepancies integrated out. Prints a line per contradiction, then how many were asked.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import os
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from asking import OK, PARTLY, Contradiction, command, document
from drawn_fits import BASE, FIGURES, PRESSURE, RPM, SPEED, DrawnFit, OwnModel, drawn_fit
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import least_squares

from screwsim.scene import load, value_at, with_values
from screwsim.simulate import simulate

KELVIN = ("discharge_temperature",)
LOWER = 0.03  # by which another chi squared must be lower than the fit's
SIMILAR = 0.08  # relative difference of two standard errors by differences of runs
DETERMINED = 1e4  # condition of the slopes up to which errors are compared
RANGES = {SPEED: (800.0 * RPM, 4000.0 * RPM), PRESSURE: (7e5, 13e5)}
WORSE = 0.05  # [nats] by which the chosen points may be worse than the best of all
SHIFTED = 0.15  # standard deviations by which a quantile of 4000 draws may be off
NODES, FINE_NODES = {1: 41, 2: 21}, {1: 1201, 2: 141}  # of the grid that is solved, and of that which is integrated
WIDTHS = np.linspace(-9.0, 7.0, 161)  # logarithms of the discrepancies' widths over their scales

Judge = Callable[[np.random.Generator, Path, Counter[str]], Iterator[str]]


def asked(*arguments: str) -> dict[str, Any]:
    """Return the document of a command that must answer."""
    code, out, said = command(*arguments, "--jobs", "1", "--json")
    if code not in (OK, PARTLY):
        raise Contradiction(f"exit code {code}: {said}")
    return document(out)


def judge_fit(random: np.random.Generator, folder: Path, counts: Counter[str]) -> Iterator[str]:
    """Yield what is odd about a fit."""
    fit = drawn_fit(random, folder)
    model, out = OwnModel(fit, folder), asked("calibrate", "x.fit.yaml", "-o", "out")
    counts["asked"] += 1
    if out["status"] != "ok":
        yield f"{out['status']}: {out['message']}: {fit.text}"
        return
    told = [out["parameters"][each.path] for each in fit.unknowns]
    values = np.array([each["value"] for each in told])
    free, places = [not each["at_bound"] for each in told], model.places(values)
    here = float(np.sum(model.residuals(places) ** 2))
    if abs(out["chi_squared"] - here) > 0.02 * (1.0 + math.sqrt(here)):
        yield f"chi squared {out['chi_squared']}, by its residuals and priors {here}: {fit.text}"
    freedom = len(model.measured) + len(model.held) - sum(free)
    if out["degrees_of_freedom"] != freedom:
        yield f"{out['degrees_of_freedom']} degrees of freedom, not {freedom}: {fit.text}"
    for start in (places, model.places(np.array(list(fit.truth.values())))):
        inside = np.clip(start, 1e-3, 1.0 - 1e-3)
        other = least_squares(model.residuals, inside, bounds=(0.0, 1.0), diff_step=3e-3, xtol=1e-6, max_nfev=15)
        if 2.0 * other.cost < here - LOWER:
            yield f"chi squared {here} at {values}, {2.0 * other.cost} at {model.values(other.x)}: {fit.text}"
    yield from _odd_errors(fit, model, out, places, all(free))
    fitted = load("out/scene.yaml")
    for (at, _), number in zip(fit.points, itertools.count(0, len(fit.points[0][1])), strict=False):
        figures = simulate(with_values(fitted, at), trace=False).performance
        for name, row in zip(fit.points[0][1], out["points"][number:], strict=False):
            if abs(figures[name] - row["ours"]) > 0.1 * row["uncertainty"]:
                yield f"the scene written gives {name} {figures[name]}, the fit {row['ours']}: {fit.text}"


def _odd_errors(fit: DrawnFit, model: OwnModel, out: dict[str, Any], places: np.ndarray, free: bool) -> Iterator[str]:
    slopes = model.slopes(places)
    if not free or np.linalg.cond(slopes) > DETERMINED:
        return
    covariance = np.linalg.inv(slopes.T @ slopes)
    deviations = np.sqrt(np.diag(covariance))
    for each, deviation in zip(fit.unknowns, deviations, strict=True):
        told = out["parameters"][each.path]
        error = float(deviation) * each.slope(told["value"])
        if abs(told["standard_error"] - error) > SIMILAR * error:
            yield f"standard error of {each.path} {told['standard_error']}, by differences {error}: {fit.text}"
    correlation = covariance / np.outer(deviations, deviations)
    if np.max(np.abs(correlation - np.array(out["correlation"], float))) > SIMILAR:
        yield f"correlations {out['correlation']}, by differences {correlation.tolist()}: {fit.text}"


def judge_plan(random: np.random.Generator, folder: Path, counts: Counter[str]) -> Iterator[str]:
    """Yield what is odd about a plan over speed and pressure."""
    fit = drawn_fit(random, folder)
    levels, count = int(random.integers(2, 4)), int(random.integers(1, 4))
    ranges = [f"{SPEED}=800 rpm..4000 rpm", f"{PRESSURE}=7 bar..13 bar"]
    request = [part for each in ranges for part in ("--path", each)]
    out = asked("plan", "x.fit.yaml", "--levels", str(levels), "--count", str(count), *request)
    counts["asked"] += 1
    model, n = OwnModel(fit, folder), len(fit.unknowns)
    stated = [float(value_at(load(BASE), each.path)) for each in fit.unknowns]
    pairs = list(zip(fit.unknowns, stated, strict=True))
    values = [each.prior.mean if each.prior else value for each, value in pairs]
    spans = np.array([each.slope(value) for each, value in zip(fit.unknowns, values, strict=True)])
    known = _prior_information(fit, model, values, spans)
    usual = _usual_uncertainties(model)
    names = list(usual)
    for at, measured in fit.points:
        slopes, _ = _slopes(model, at, values, list(measured))
        rows = slopes / np.array([[sigma] for _, sigma in measured.values()])
        known = known + rows.T @ rows
    grid = itertools.product(*(np.linspace(*ends, levels) for ends in RANGES.values()))
    candidates = [dict(zip(RANGES, each, strict=True)) for each in grid]
    pieces = []
    for at in candidates:
        slopes, figures = _slopes(model, at, values, names)
        rows = slopes / np.array([[usual[key] * (1.0 if key in KELVIN else figures[key])] for key in names])
        pieces.append(rows.T @ rows)
    yield from _odd_deviations("now", fit, known, out["deviations"])
    information = known
    for row in out["points"]:
        at = row["conditions"]
        piece = pieces[int(np.argmin([sum(abs(each[key] / at[key] - 1.0) for key in each) for each in candidates]))]
        gain = 0.5 * float(np.linalg.slogdet(information + piece)[1] - np.linalg.slogdet(information)[1])
        information = information + piece
        if abs(gain - row["gain"]) > 0.06 * gain + 0.01:
            yield f"gain {row['gain']} of {row['name']}, by differences {gain}: {fit.text}"
        yield from _odd_deviations(row["name"], fit, information, row["deviations"])
    subsets = itertools.combinations(pieces, min(count, len(pieces)))
    best = max(float(np.linalg.slogdet(known + sum(each))[1]) for each in subsets)
    if best > np.linalg.slogdet(information)[1] + WORSE:
        yield f"other points say more, by {best - np.linalg.slogdet(information)[1]} nats: {fit.text}"
    counts["unknowns"] += n


def _usual_uncertainties(model: OwnModel) -> dict[str, float]:
    """Return the median uncertainty of each measured figure, as a share of its value, of a temperature [K]."""
    found = {}
    for name in FIGURES:
        rows = [row for key, row in zip(model.names, model.measured, strict=True) if key == name]
        if rows:
            found[name] = float(np.median([sigma / (1.0 if name in KELVIN else value) for value, sigma in rows]))
    return found


def _prior_information(fit: DrawnFit, model: OwnModel, values: list[float], spans: np.ndarray) -> np.ndarray:
    """Return the information [1/SI²] of priors, or of the bounds alone."""
    found = np.diag(12.0 / spans**2)
    held = [(fit.unknowns[i].prior, values[i]) for i in model.held]
    widths = [each.deviation * (value if each.logarithmic else 1.0) for each, value in held if each is not None]
    of = model.whitener / np.array(widths) if widths else np.zeros((0, 0))
    found[np.ix_(model.held, model.held)] = of.T @ of
    return found


def _slopes(model: OwnModel, at: dict[str, float], values: list[float], names: list[str]) -> tuple[np.ndarray, Any]:
    """Return the derivatives [SI] of figures at a point by the unknowns, and the figures."""
    paths = [each.path for each in model.fit.unknowns]

    def figures(shifted: list[float]) -> Any:
        changes = model.fit.changes(dict(zip(paths, shifted, strict=True)))
        return simulate(with_values(with_values(model.scene, changes), at), trace=False).performance

    columns = []
    for i, value in enumerate(values):
        step = 4e-3 * value
        low, high = (figures([x + sign * step * (i == k) for k, x in enumerate(values)]) for sign in (-1.0, 1.0))
        columns.append([(high[name] - low[name]) / (2.0 * step) for name in names])
    return np.array(columns).T, figures(values)


def _odd_deviations(when: str, fit: DrawnFit, information: np.ndarray, told: dict[str, float]) -> Iterator[str]:
    for each, deviation in zip(fit.unknowns, np.sqrt(np.diag(np.linalg.inv(information))), strict=True):
        if abs(told[each.path] - deviation) > SIMILAR * deviation:
            yield f"{when}: deviation of {each.path} {told[each.path]}, by differences {deviation}: {fit.text}"


def judge_posterior(random: np.random.Generator, folder: Path, counts: Counter[str]) -> Iterator[str]:
    """Yield the quantiles of a posterior that are not those of an integral."""
    fit = drawn_fit(random, folder, most=2)
    out = asked("calibrate", "x.fit.yaml", "--posterior", "-o", "out")["posterior"]
    counts.update({"asked": 1, out["status"]: 1})
    if out["status"] != "ok":
        return
    model, n = OwnModel(fit, folder), len(fit.unknowns)
    drawn = np.loadtxt("out/posterior.csv", delimiter=",", skiprows=1)[:, :n]
    places = np.array([model.places(each) for each in drawn])
    wide = 0.3 * np.ptp(places, axis=0)
    low, high = np.maximum(0.0, places.min(axis=0) - wide), np.minimum(1.0, places.max(axis=0) + wide)
    axes, fine = ([np.linspace(a, b, each[n]) for a, b in zip(low, high, strict=True)] for each in (NODES, FINE_NODES))
    solved = np.array([model.figures(model.values(np.array(at))) for at in itertools.product(*axes)])
    between = RegularGridInterpolator(axes, solved.reshape(*map(len, axes), -1), method="cubic")
    grid = np.array(list(itertools.product(*fine)))
    height = np.array([_log_prior(model, at) for at in grid]) + _log_likelihood(model, between(grid))
    weights = np.exp(height - height.max()).reshape([len(each) for each in fine])
    for i, each in enumerate(fit.unknowns):
        marginal = weights.sum(axis=tuple(k for k in range(n) if k != i))
        mass = np.concatenate([[0.0], np.cumsum(0.5 * (marginal[1:] + marginal[:-1]))])
        true = [each.value(float(np.interp(share * mass[-1], mass, fine[i]))) for share in (0.05, 0.5, 0.95)]
        told = [out["parameters"][each.path][name] for name in ("low", "median", "high")]
        deviation = (true[2] - true[0]) / 3.29
        if max(abs(a - b) for a, b in zip(told, true, strict=True)) > SHIFTED * deviation:
            yield f"{each.path}: quantiles {told}, by the integral {true}: {fit.text}"


def _log_prior(model: OwnModel, places: np.ndarray) -> float:
    """Return the logarithm of the priors' density over the places."""
    values = model.values(places)
    total = -0.5 * float(np.sum(model.off(values) ** 2))
    for i in model.held:
        prior, each, value = model.fit.unknowns[i].prior, model.fit.unknowns[i], float(values[i])
        total += math.log(each.slope(value)) - (math.log(value) if prior is not None and prior.logarithmic else 0.0)
    return total


def _log_likelihood(model: OwnModel, figures: np.ndarray) -> np.ndarray:
    """Return the logarithm of the likelihood, integrated over the width of each figure's discrepancy."""
    total = np.zeros(len(figures))
    for name in dict.fromkeys(model.names):
        rows = [i for i, each in enumerate(model.names) if each == name]
        value, sigma = model.measured[rows].T
        variance = sigma**2 + (np.median(sigma) * np.exp(WIDTHS[:, None])) ** 2
        for start in range(0, len(figures), 3000):
            off = (figures[start : start + 3000][:, None, rows] - value) ** 2
            height = -0.5 * (off / variance + np.log(variance)).sum(axis=-1) - np.logaddexp(WIDTHS, -WIDTHS)
            top = height.max(axis=1)
            total[start : start + 3000] += top + np.log(np.exp(height - top[:, None]).sum(axis=1))
    return total


STUDIES: dict[str, Judge] = {"fits": judge_fit, "plans": judge_plan, "posteriors": judge_posterior}


def main() -> None:
    """Print what is odd, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("study", nargs="?", default="fits", choices=tuple(STUDIES))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=20)
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    for number in range(given.count):
        random = np.random.default_rng([given.seed, number])
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for odd in STUDIES[given.study](random, Path(folder), counts):
                    counts["odd"] += 1
                    print(f"{given.seed}/{number} {odd}", flush=True)
            except Exception:  # noqa: BLE001 - whatever a command raises is told with its case
                counts["odd"] += 1
                print(f"{given.seed}/{number} {traceback.format_exc()}", flush=True)
            os.chdir(BASE.parent)
    print(json.dumps(counts))


if __name__ == "__main__":
    main()
