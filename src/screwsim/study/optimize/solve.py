"""Searches: a bracket and bounded search for one path; differential evolution and a simplex for one aim; else NSGA-II.

Each works on places 0 … 1 between the bounds and asks a `Record` for evaluations until it has converged or all are
used. Failed evaluations are worse than any other; of those that violate bounds, a smaller violation is better.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from screwsim.inputs.faults import UsageError
from screwsim.study.best.search import COARSE_POINTS, Maximum, SearchPoint, find_maximum
from screwsim.study.optimize.evaluate import Evaluation, total_violation
from screwsim.study.optimize.question import Question
from screwsim.study.optimize.record import BudgetExhausted, Record

Array = NDArray[np.float64]
FAILED_SCORE = 1e12  # score of a failed evaluation
VIOLATION_COST = 10.0  # of the largest aim of the first batch: cost of violating a bound by its own size
EVOLUTION_SHARE = 0.7  # share of the evaluations that differential evolution may use
CONVERGED_SPREAD = 3e-4  # relative spread of a population's aims at which it has converged
SIMPLEX, PLACE = 0.05, 1e-3  # of the ranges: initial size and final accuracy of the simplex


def search(record: Record) -> Maximum | None:
    """Search until converged or out of evaluations; for one path with one aim return the top.

    Where nothing varies, evaluate the scene itself.
    """
    try:
        if not record.asked.spans:
            record.evaluate(np.empty((1, 0)))
        elif len(record.asked.aims) > 1:
            _nsga2(record)
        elif len(record.asked.spans) == 1:
            return _bracket_and_narrow(record)
        else:
            _evolution(record)
    except BudgetExhausted:
        pass
    return None


def _score(asked: Question, evaluation: Evaluation, penalty: float) -> float:
    """Return the quantity to minimise for one aim."""
    if evaluation.failed:
        return FAILED_SCORE
    return asked.aims[0].sign * evaluation.aims[0] + penalty * total_violation(asked, evaluation)


def _penalty(evaluations: Sequence[Evaluation]) -> float:
    known = [abs(evaluation.aims[0]) for evaluation in evaluations if not evaluation.failed]
    return VIOLATION_COST * max(known, default=1.0) or VIOLATION_COST


def _bracket_and_narrow(record: Record) -> Maximum | None:
    """Bracket every local optimum at evenly spaced places in one batch; then narrow each."""
    asked = record.asked
    places = np.linspace(0.0, 1.0, COARSE_POINTS)
    first = record.evaluate(places[:, None])
    known, penalty = dict(zip(places.tolist(), first, strict=True)), _penalty(first)

    def point(place: float) -> SearchPoint:
        found = known.get(place) or record.evaluate(np.array([[place]]))[0]
        if found.failed:
            return SearchPoint(place, math.nan)
        return SearchPoint(place, -_score(asked, found, penalty), found.errors[0])

    return find_maximum(point, 0.0, 1.0)


def _initial_places(asked: Question, count: int) -> Array:
    """Return initial places: a Latin hypercube, with the scene's own if it lies in all ranges."""
    from scipy.stats import qmc

    cube = qmc.LatinHypercube(len(asked.spans), rng=np.random.default_rng(asked.seed)).random(count)
    if all(span.start is not None for span in asked.spans):
        cube[0] = [span.first for span in asked.spans]
    return cube


def _evolution(record: Record) -> None:
    """Search for one aim by differential evolution, then by Nelder and Mead's simplex from the best."""
    from scipy.optimize import differential_evolution, minimize

    asked = record.asked
    size, count = len(asked.spans), asked.evaluations
    members = max(5, min(6 * size, math.isqrt(count) + 4))
    first: Any = _initial_places(asked, members)
    penalty = 0.0

    def scores(columns: Array) -> Array:
        nonlocal penalty
        found = record.evaluate(columns.T)
        penalty = penalty or _penalty(found)
        return np.array([_score(asked, each, penalty) for each in found])

    def score(place: Array) -> float:
        return _score(asked, record.evaluate(place[None])[0], penalty)

    generations = max(1, int(EVOLUTION_SHARE * count) // members - 1)
    found = differential_evolution(
        scores,
        [(0.0, 1.0)] * size,
        init=first,
        maxiter=generations,
        tol=CONVERGED_SPREAD,
        rng=np.random.default_rng(asked.seed),
        polish=False,
        updating="deferred",
        vectorized=True,
    )
    best = np.clip(found.x, 0.0, 1.0)
    corners = [best + SIMPLEX * np.eye(size)[i] * (1.0 if best[i] < 0.5 else -1.0) for i in range(size)]
    _, errors, _ = record.columns()
    close = float(np.nanmedian(errors)) if np.isfinite(errors).any() else 1e-9
    ends = {"initial_simplex": np.array([best, *corners]), "xatol": PLACE, "fatol": close, "maxfev": count}
    minimize(score, best, method="Nelder-Mead", bounds=[(0.0, 1.0)] * size, options=ends)


def _nsga2(record: Record) -> None:
    """Search for several aims by NSGA-II, with the bounds as its constraints."""
    try:
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.evaluator import Evaluator
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination
        from pymoo.problems.static import StaticProblem
    except ImportError:
        remedy = "pip install 'screwsim[optimize]'"
        raise UsageError(f"several aims need pymoo, which is not installed (install it with: {remedy})") from None
    asked = record.asked
    size = max(8, 4 * round(1.6 * math.sqrt(asked.evaluations) / 4))
    problem = Problem(n_var=len(asked.spans), n_obj=len(asked.aims), n_ieq_constr=1, xl=0.0, xu=1.0)
    first: Any = _initial_places(asked, size)
    algorithm = NSGA2(pop_size=size, sampling=first)
    algorithm.setup(problem, termination=NoTermination(), seed=asked.seed, verbose=False)
    while True:
        asks: Any = algorithm.ask()
        found = record.evaluate(np.asarray(asks.get("X"), float))
        signs = np.array([aim.sign for aim in asked.aims])
        F = np.array([np.full(len(signs), FAILED_SCORE) if each.failed else signs * each.aims for each in found])
        G = np.array([[FAILED_SCORE if each.failed else total_violation(asked, each)] for each in found])
        Evaluator().eval(StaticProblem(problem, F=F, G=G), asks)
        algorithm.tell(infills=asks)


def front_of(values: Array) -> NDArray[np.intp]:
    """Return the rows that no other row dominates, all columns to be minimised, sorted by the first column.

    Rows with NaN are never in front; of equal rows the first is.
    """
    good = np.flatnonzero(np.all(np.isfinite(values), axis=1))
    order = good[np.lexsort(values[good].T[::-1])]
    kept: list[int] = []
    for row in order:  # no later row dominates it
        ahead = values[kept]
        if not len(kept) or not np.any(np.all(ahead <= values[row], axis=1)):
            kept.append(int(row))
    return np.array(kept, np.intp)
