"""The stage equations of slices of single chambers as compiled kernels: factor them, follow a change through a life.

They do the same as those of `stages` for one chamber and one change, without looking for bands and columns, which would
take most of the time: a matrix has three rows for each state.
"""

from functools import partial

import numpy as np

from screwsim.codegen.modules import of_kernels
from screwsim.derivatives.radau import INTEGRALS
from screwsim.derivatives.stages import pivoted
from screwsim.numerics.kernel import kernel


@kernel
def lessen_row(M, k, row, column, last):
    """Subtract from a row of M[k], in the columns after `column`, its share of the row there; four at once."""
    share = M[k, row, column]
    j = column + 1
    while j + 4 <= last:
        M[k, row, j] -= share * M[k, column, j]
        M[k, row, j + 1] -= share * M[k, column, j + 1]
        M[k, row, j + 2] -= share * M[k, column, j + 2]
        M[k, row, j + 3] -= share * M[k, column, j + 3]
        j += 4
    for i in range(j, last):
        M[k, row, i] -= share * M[k, column, i]


@kernel
def factor_one(J, k, h, n, M, pivots):
    """Factor 1 − h a J of slice k in M[k] (3 n, 3 n); row swaps are stored in pivots[k]."""
    size = M.shape[1]
    for i in range(3):
        for s in range(n):
            for j in range(3):
                for t in range(n):
                    M[k, i * n + s, j * n + t] = -(h * INTEGRALS[i, j]) * J[3 * k + j, s, t]
    for row in range(size):
        M[k, row, row] += 1.0
    for column in range(size):
        pivots[k, column] = pivoted(M, k, column, size, size)
        inverse = 1.0 / M[k, column, column]
        M[k, column, column] = inverse
        for i in range(column + 1, size):
            M[k, i, column] *= inverse
            lessen_row(M, k, i, column, size)


@kernel
def factor(J, widths, n, M, pivots):
    """Factor 1 − h a J of all slices [h: widths] in M (slices, 3 n, 3 n); J (slices nodes, n, n)."""
    for k in range(widths.shape[0]):
        factor_one(J, k, widths[k], n, M, pivots)


@kernel
def lessened(M, k, row, first, last, x):
    """Return x[row] without those of x from first to last, weighted by a row of the factors M[k]; four at once."""
    found = x[row]
    j = first
    while j + 4 <= last:
        found -= (M[k, row, j] * x[j] + M[k, row, j + 1] * x[j + 1]) + (
            M[k, row, j + 2] * x[j + 2] + M[k, row, j + 3] * x[j + 3]
        )
        j += 4
    for i in range(j, last):
        found -= M[k, row, i] * x[i]
    return found


@kernel
def solve_one(M, pivots, k, x):
    """Solve with the factors M[k] of a full matrix, the right side x (3 n) in place."""
    size = M.shape[1]
    for row in range(size):
        other = pivots[k, row]
        if other != row:
            x[row], x[other] = x[other], x[row]
    for row in range(1, size):
        x[row] = lessened(M, k, row, 0, row, x)
    for row in range(size - 1, -1, -1):
        x[row] = lessened(M, k, row, row + 1, size, x) * M[k, row, row]


@kernel
def follow_one_by_one(M, pivots, n, inject, B):
    """Follow a change chamber by chamber, each with its own factors: B (chambers slices, 3 n) becomes the change.

    B holds the right sides; each chamber starts with `inject` (N, N) applied to the end of the one before.
    """
    chambers = inject.shape[0] // n
    count = B.shape[0] // chambers
    x = np.empty(3 * n)
    before = np.zeros(n)
    now = np.zeros(n)
    for chamber in range(chambers):
        for s in range(n):
            before[s] = now[s]
        for s in range(n):
            begins = 0.0
            for t in range(n):
                begins += inject[chamber * n + s, chamber * n + t] * before[t]
            now[s] = begins
        for k in range(chamber * count, (chamber + 1) * count):
            for i in range(3):
                for s in range(n):
                    x[i * n + s] = B[k, i * n + s] + now[s]
            solve_one(M, pivots, k, x)
            for row in range(3 * n):
                B[k, row] = x[row]
            for s in range(n):
                now[s] = x[2 * n + s]


compiled = partial(of_kernels, "chamber_stages", factor, follow_one_by_one)
