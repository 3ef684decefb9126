"""The stage equations of slices as compiled kernels: factor band matrices, follow changes through all slices.

Rows are ordered by chamber, within it by node, so that a matrix whose chambers couple only to the next ones is a band
of blocks. Pivots are sought within a chamber: its own block is regular, but where a port is open its derivatives are
large and nearly of rank one, while the coupling of chambers over a slice is small beside that. So the band is
preserved.

Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins 2013, 4.3 and 4.5 (band systems, block
tridiagonal ones).
"""

from functools import partial

import numpy as np

from screwsim.codegen.modules import of_kernels
from screwsim.derivatives.radau import INTEGRALS
from screwsim.numerics.kernel import kernel

LITTLE = 24  # rows of a matrix up to which columns are eliminated one by one


@kernel
def fill(J, k, h, n, reach, M, m):
    """Fill M[m] with 1 − h a J of slice k.

    J (slices nodes, N, N), n states a chamber, coupled to `reach` chambers on.
    """
    N = J.shape[1]
    chambers = N // n
    for row in range(3 * N):
        for column in range(3 * N):
            M[m, row, column] = 0.0
    for c in range(chambers):
        for d in range(max(0, c - reach), min(chambers, c + reach + 1)):
            for i in range(3):
                for j in range(3):
                    weight = h * INTEGRALS[i, j]
                    at = 3 * k + j
                    for s in range(n):
                        row = (3 * c + i) * n + s
                        for t in range(n):
                            M[m, row, (3 * d + j) * n + t] = -weight * J[at, c * n + s, d * n + t]
    for row in range(3 * N):
        M[m, row, row] += 1.0


@kernel
def pivoted(M, k, column, last, wide):
    """Swap the row of M[k] from `column` to `last` with the largest entry there into place; return its index."""
    p = column
    for i in range(column + 1, last):
        if abs(M[k, i, column]) > abs(M[k, p, column]):
            p = i
    if p != column:
        for j in range(wide):  # including the factors: rows then stay consistent
            M[k, column, j], M[k, p, j] = M[k, p, j], M[k, column, j]
    return p


@kernel
def eliminate(M, k, column, row, first, last):
    """Subtract from a row of M[k], in columns from first to last, its share of the row at `column`."""
    share = M[k, row, column]
    if share != 0.0:
        for j in range(first, last):
            M[k, row, j] -= share * M[k, column, j]


@kernel
def eliminate_four(M, k, column, row, last):
    """Do the same for the four rows from `column` on, in the columns after them."""
    s0 = M[k, row, column]
    s1 = M[k, row, column + 1]
    s2 = M[k, row, column + 2]
    s3 = M[k, row, column + 3]
    if s0 != 0.0 or s1 != 0.0 or s2 != 0.0 or s3 != 0.0:
        for j in range(column + 4, last):
            M[k, row, j] -= (
                s0 * M[k, column, j] + s1 * M[k, column + 1, j] + (s2 * M[k, column + 2, j] + s3 * M[k, column + 3, j])
            )


@kernel
def share_of_four(M, k, column, row):
    """Turn a row of M[k] into its shares of the four rows from `column` on, whose diagonal is inverted."""
    s0 = M[k, row, column] * M[k, column, column]
    s1 = (M[k, row, column + 1] - s0 * M[k, column, column + 1]) * M[k, column + 1, column + 1]
    s2 = M[k, row, column + 2] - s0 * M[k, column, column + 2] - s1 * M[k, column + 1, column + 2]
    s2 *= M[k, column + 2, column + 2]
    s3 = M[k, row, column + 3] - s0 * M[k, column, column + 3] - s1 * M[k, column + 1, column + 3]
    s3 = (s3 - s2 * M[k, column + 2, column + 3]) * M[k, column + 3, column + 3]
    M[k, row, column] = s0
    M[k, row, column + 1] = s1
    M[k, row, column + 2] = s2
    M[k, row, column + 3] = s3


@kernel
def factor_one(J, k, h, n, reach, M, m, pivots):
    """Factor 1 − h a J of slice k in M[m] (3 N, 3 N); row swaps are stored in pivots[m].

    Four columns of a chamber are eliminated at once, so that the rest is traversed once and not four times; columns
    of small matrices, and a chamber's last fewer than four, one by one.
    """
    size = M.shape[1]
    fill(J, k, h, n, reach, M, m)
    column = 0
    while column < size:
        own = (column // (3 * n) + 1) * 3 * n  # where the chamber ends
        wide = min(size, own + 3 * n * reach)  # ... and those that it meets
        behind = column + 4 if size > LITTLE and column + 4 <= own else column + 1
        for c in range(column, behind):
            pivots[m, c] = pivoted(M, m, c, own, wide)
            inverse = 1.0 / M[m, c, c]
            M[m, c, c] = inverse
            for i in range(c + 1, own):
                M[m, i, c] *= inverse
                eliminate(M, m, c, i, c + 1, behind)
        for c in range(column, behind):
            for i in range(c + 1, behind):
                eliminate(M, m, c, i, behind, wide)
        for i in range(behind, wide):
            if behind == column + 4:
                if i >= own:
                    share_of_four(M, m, column, i)
                eliminate_four(M, m, column, i, wide)
            else:
                if i >= own:
                    M[m, i, column] *= M[m, column, column]
                eliminate(M, m, column, i, behind, wide)
        column = behind


@kernel
def factor(J, widths, n, reach, M, pivots):
    """Factor 1 − h a J of all slices [h: widths] in M (slices, 3 N, 3 N); row swaps are stored in pivots."""
    for k in range(widths.shape[0]):
        factor_one(J, k, widths[k], n, reach, M, k, pivots)


@kernel
def places(n, chambers, place):
    """Fill place with the index, among rows ordered by node, of each row of the band, ordered by chamber."""
    for c in range(chambers):
        for i in range(3):
            for s in range(n):
                place[(3 * c + i) * n + s] = (i * chambers + c) * n + s


@kernel
def lessen(B, k, M, m, row, first, last, place):
    """Subtract from a row of B[k] those from first to last, weighted by a row of factors; four at once."""
    columns = B.shape[2]
    a = place[row]
    j = first
    while j + 4 <= last:
        s0 = M[m, row, j]
        s1 = M[m, row, j + 1]
        s2 = M[m, row, j + 2]
        s3 = M[m, row, j + 3]
        if s0 != 0.0 or s1 != 0.0 or s2 != 0.0 or s3 != 0.0:
            b0 = place[j]
            b1 = place[j + 1]
            b2 = place[j + 2]
            b3 = place[j + 3]
            for c in range(columns):
                B[k, a, c] -= s0 * B[k, b0, c] + s1 * B[k, b1, c] + (s2 * B[k, b2, c] + s3 * B[k, b3, c])
        j += 4
    for i in range(j, last):
        share = M[m, row, i]
        b = place[i]
        if share != 0.0:
            for c in range(columns):
                B[k, a, c] -= share * B[k, b, c]


@kernel
def solve(M, pivots, m, place, n, reach, B, k):
    """Solve with the factors M[m], right sides B[k] (3 N, columns) in place, their rows by node."""
    size = M.shape[1]
    block = 3 * n
    columns = B.shape[2]
    for row in range(size):
        a = place[row]
        b = place[pivots[m, row]]
        if a != b:
            for c in range(columns):
                B[k, a, c], B[k, b, c] = B[k, b, c], B[k, a, c]
    for row in range(size):
        lessen(B, k, M, m, row, max(0, row // block - reach) * block, row, place)
    for row in range(size - 1, -1, -1):
        lessen(B, k, M, m, row, row + 1, min(size, (row // block + reach + 1) * block), place)
        a = place[row]
        inverse = M[m, row, row]
        for c in range(columns):
            B[k, a, c] *= inverse


@kernel
def through(M, pivots, m, place, n, reach, now, B, k):
    """Follow changes through slice k with the factors M[m], from `now` (N, columns), which becomes those at its end."""
    size = M.shape[1]
    N = size // 3
    for row in range(size):
        for c in range(B.shape[2]):
            B[k, row, c] += now[row % N, c]
    solve(M, pivots, m, place, n, reach, B, k)
    for i in range(N):
        for c in range(B.shape[2]):
            now[i, c] = B[k, 2 * N + i, c]


@kernel
def follow(M, pivots, n, reach, now, B):
    """Follow changes through all slices with the factors of `factor`: B (slices, 3 N, columns) becomes those at nodes.

    They start with `now` (N, columns), which becomes those at the end; B holds the right sides of the stage
    equations.
    """
    size = M.shape[1]
    place = np.empty(size, np.int64)
    places(n, size // 3 // n, place)
    for k in range(B.shape[0]):
        through(M, pivots, k, place, n, reach, now, B, k)


@kernel
def follow_once(J, widths, n, reach, now, B):
    """Do the same as `factor` and `follow`, slice by slice, without keeping the factors."""
    N = J.shape[1]
    M = np.empty((1, 3 * N, 3 * N))
    pivots = np.empty((1, 3 * N), np.int64)
    place = np.empty(3 * N, np.int64)
    places(n, N // n, place)
    for k in range(B.shape[0]):
        factor_one(J, k, widths[k], n, reach, M, 0, pivots)
        through(M, pivots, 0, place, n, reach, now, B, k)


compiled = partial(of_kernels, "stages", factor, follow, follow_once)
