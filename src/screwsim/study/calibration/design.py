"""D-optimal choice of experiments: from rows of slopes per candidate and prior information, the best candidates.

The unknowns are the parameters followed by nuisance inputs, which are not known exactly but not wanted either. With the
information A = prior + Σ JᵀJ of what is measured, candidates are chosen that minimise the determinant of the
parameters' block of A⁻¹ (Ds-optimal): one after the other, then exchanged one for one until no exchange helps
(Fedorov).

Sources: V. V. Fedorov, Theory of Optimal Experiments, Academic Press 1972; K. Chaloner, I. Verdinelli, Statistical
Science 10 (1995) 273.
"""

from collections.abc import Sequence

import numpy as np

from screwsim.study.calibration.residuals import Array

LEAST_IMPROVEMENT = 1e-9  # least improvement of the logarithm of a determinant


def covariance(information: Array, asked: int) -> Array:
    """Return the covariance of the first `asked` unknowns."""
    return np.asarray(np.linalg.inv(information)[:asked, :asked], float)


def log_determinant(information: Array, asked: int) -> float:
    """Return the logarithm of the determinant of the covariance of the first `asked` unknowns."""
    return float(np.linalg.slogdet(covariance(information, asked))[1])


def log_determinants_with(known: Array, pieces: Array, asked: int) -> Array:
    """Return the `log_determinant` with each of the `pieces` (n, unknowns, unknowns) added to what is known."""
    return np.linalg.slogdet(np.linalg.inv(known + pieces)[:, :asked, :asked])[1]


def optimal_choice(known: Array, pieces: Sequence[Array], asked: int, count: int) -> list[int]:
    """Return the indices of the `count` pieces of information that minimise the spread, the most informative first."""
    picked = greedy_choice(known, pieces, asked, range(len(pieces)), count)
    every, improved = np.array(pieces), True
    while improved:
        improved = False
        for place in range(len(picked)):
            rest = known + sum((pieces[i] for k, i in enumerate(picked) if k != place), np.zeros_like(known))
            here = log_determinant(rest + pieces[picked[place]], asked)
            others = sorted(set(range(len(pieces))).difference(picked))
            if not others:
                break
            found = log_determinants_with(rest, every[others], asked)
            best = int(np.argmin(found))
            if found[best] < here - LEAST_IMPROVEMENT:
                picked[place], improved = others[best], True
    return greedy_choice(known, pieces, asked, picked, count)


def greedy_choice(known: Array, pieces: Sequence[Array], asked: int, among: Sequence[int], count: int) -> list[int]:
    """Return up to `count` of the indices `among`, each the one that minimises the spread after those before it."""
    left, picked, information, every = list(among), [], known, np.array(pieces)
    while left and len(picked) < count:
        best = left.pop(int(np.argmin(log_determinants_with(information, every[left], asked))))
        picked.append(best)
        information = information + pieces[best]
    return picked
