"""Measure the linear systems of a step of all chambers: as they are, and with the zeros of each row's ends left out.

Run: .venv/bin/python scripts/coupled_systems.py. A chamber feels its neighbours and those of its gaps, so that most of
the Jacobian is zero. Times are the least of several on one core of this machine.
"""

from __future__ import annotations

import numba
import numpy as np
from solver_choices import POINT, Life
from step_times import nanoseconds

from screwsim.model import close as closing
from screwsim.model.slots import P_PITCH
from screwsim.numerics import rodas
from screwsim.scene import load

SHIFT = 200.0  # 1/(γ h) of a step of 1.1 degrees
TIMES = 3000
Array = np.ndarray


def matrix_of(life: Life, y: Array) -> Array:
    """Return the matrix of a step of all chambers in the middle of a pitch."""
    machinery, module = life.machinery, life.module
    c, n, nq = machinery.composition, len(y), machinery.nq + 1
    machinery.pitch(y.copy(), life.closed.rtol, 1e-3)
    context, E, E_next = machinery.coupled_context, np.empty(c.n_E_all), np.empty(c.n_E_all)
    f, g, J, Jq = np.empty(n), np.empty(nq), np.empty((n, n)), np.empty((nq, n))
    s = 0.5 * float(c.P[P_PITCH]) + 1e-3
    module.coupled__all_surroundings(s, s, context, E)
    module.coupled__all_surroundings(s + rodas.ANGLE_STEP, s, context, E_next)
    module.coupled_jacobian__all_jacobian(
        y, E, E_next, rodas.ANGLE_STEP, context, f, g, J, Jq, np.empty(n), np.empty(nq)
    )
    return SHIFT * np.eye(n) - J


@numba.njit
def ends(M, first, last):
    """Set where the rows begin and end to differ from zero."""
    n = len(M)
    for i in range(n):
        first[i] = last[i] = i
        for j in range(n - 1, i, -1):
            if M[i, j] != 0.0:
                last[i] = j
                break
        for j in range(i):
            if M[i, j] != 0.0:
                first[i] = j
                break


@numba.njit
def swap(M, first, last, k, p):
    """Exchange two rows."""
    for j in range(len(M)):
        M[k, j], M[p, j] = M[p, j], M[k, j]
    first[k], first[p] = first[p], first[k]
    last[k], last[p] = last[p], last[k]


@numba.njit
def factor_within(M, pivots, first, last):
    """Do what `linear.lu_factor` does, each row between its ends."""
    n = len(M)
    ends(M, first, last)
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if first[i] <= k and abs(M[i, k]) > abs(M[p, k]):
                p = i
        pivots[k] = p
        if p != k:
            swap(M, first, last, k, p)
        inverse = 1.0 / M[k, k]
        for i in range(k + 1, n):
            if first[i] > k:
                continue
            factor = M[i, k] * inverse
            M[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, last[k] + 1):
                    M[i, j] -= factor * M[k, j]
                last[i] = max(last[i], last[k])


@numba.njit
def solve_within(M, pivots, b, first, last):
    """Do what `linear.lu_solve` does, each row between its ends."""
    n = len(b)
    for k in range(n):
        p = pivots[k]
        if p != k:
            b[k], b[p] = b[p], b[k]
    for i in range(1, n):
        value = b[i]
        for j in range(first[i], i):
            value -= M[i, j] * b[j]
        b[i] = value
    for i in range(n - 1, -1, -1):
        value = b[i]
        for j in range(i + 1, last[i] + 1):
            value -= M[i, j] * b[j]
        b[i] = value / M[i, i]


def systems_table(transport: str) -> None:
    """Print what the systems of a step take, both ways, and the step."""
    life = Life(load(str(POINT), [f"oil.transport={transport}"]))
    factor, solve = life.module.linear__lu_factor, life.module.linear__lu_solve
    y = closing.chambers_at_pitches(life.machinery)
    matrix = matrix_of(life, y)
    n = len(y)
    M, b, right = matrix.copy(), np.empty(n), np.random.default_rng(1).uniform(size=n)
    pivots, first, last = (np.zeros(n, np.int64) for _ in range(3))

    @numba.njit
    def as_it_is(times, matrix, M, pivots, b, right):
        for _ in range(times):
            M[:] = matrix
            factor(M, pivots, len(b))
            for _ in range(6):
                b[:] = right
                solve(M, pivots, b, len(b))

    @numba.njit
    def within(times, matrix, M, pivots, b, right, first, last):
        for _ in range(times):
            M[:] = matrix
            factor_within(M, pivots, first, last)
            for _ in range(6):
                b[:] = right
                solve_within(M, pivots, b, first, last)

    def pitches(times: int) -> None:
        for _ in range(times):
            life.machinery.pitch(y.copy(), life.closed.rtol, 1e-3)

    ways = (
        lambda times: as_it_is(times, matrix, M, pivots, b, right),
        lambda times: within(times, matrix, M, pivots, b, right, first, last),
    )
    took, solutions = [], []
    for way in ways:
        took.append(nanoseconds(way, TIMES))
        solutions.append(b.copy())
    before = life.machinery.counts.copy()
    pitches(1)
    counts = life.machinery.counts - before
    step = nanoseconds(pitches, 20) / (counts[0] + counts[1])
    same = "same bits" if np.array_equal(*solutions) else "other bits"
    filled = np.count_nonzero(matrix) / matrix.size
    print(
        f"oil {transport}: {n} states, {filled:.0%} not zero; a step {step:.0f} ns, its "
        f"systems {took[0] / step:.0%}, within the ends of rows {took[1] / step:.0%} ({same})"
    )


if __name__ == "__main__":
    for each in ("paper", "carried"):
        systems_table(each)
