"""Small dense linear systems inside kernels: LU with partial pivoting, in place."""

from screwsim.numerics.kernel import kernel


@kernel
def lu_factor(M, pivots, n):
    """Factor the n×n matrix M in place, with row permutations in `pivots` and inverted pivots.

    A zero pivot gives inf.
    """
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(M[i, k]) > abs(M[p, k]):
                p = i
        pivots[k] = p
        if p != k:
            for j in range(n):
                M[k, j], M[p, j] = M[p, j], M[k, j]
        inverse = 1.0 / M[k, k]
        M[k, k] = inverse
        for i in range(k + 1, n):
            factor = M[i, k] * inverse
            M[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    M[i, j] -= factor * M[k, j]


@kernel
def lu_solve(M, pivots, b, n):
    """Solve a linear system with the factors of `lu_factor`, b in place."""
    for k in range(n):
        p = pivots[k]
        if p != k:
            b[k], b[p] = b[p], b[k]
    for i in range(1, n):
        value = b[i]
        for j in range(i):
            value -= M[i, j] * b[j]
        b[i] = value
    for i in range(n - 1, -1, -1):
        value = b[i]
        for j in range(i + 1, n):
            value -= M[i, j] * b[j]
        b[i] = value * M[i, i]
