"""Sums of small changes of the rates at all nodes, as compiled kernels: one sweep, no temporary arrays.

Rates for several numbers lie side by side, a column each; their differences become right sides of the stage equations
and changes of the quadratures. Columns of changed states become lives, one for each column.
"""

from functools import partial

import numpy as np

from screwsim.codegen.modules import of_kernels
from screwsim.derivatives.radau import INTEGRALS, SHARES
from screwsim.numerics.kernel import kernel

X0, X1 = SHARES[:-1].tolist()


@kernel
def add_stages(rates, own, first, there, here, columns, right):
    """Add to right (slices 3, states, …) the differences of rates (slices 3, states, lanes) from `own`.

    Lanes from `first` on are used, weighted by there and here (slices, …) [h over the step]; `columns` are their
    targets.
    """
    many = columns.shape[0]
    changes = np.empty((3, rates.shape[1], many))
    for k in range(there.shape[0]):
        for j in range(3):
            for s in range(rates.shape[1]):
                for lane in range(many):
                    a = there[k, lane] * rates[3 * k + j, s, first + lane]
                    changes[j, s, lane] = a - here[k, lane] * own[3 * k + j, s]
        for i in range(3):
            for s in range(rates.shape[1]):
                for lane in range(many):
                    right[3 * k + i, s, columns[lane]] += (
                        INTEGRALS[i, 0] * changes[0, s, lane]
                        + INTEGRALS[i, 1] * changes[1, s, lane]
                        + INTEGRALS[i, 2] * changes[2, s, lane]
                    )


@kernel
def add_sums(rates, own, first, there, here, columns, sums):
    """Add to sums (quadratures, …) the differences of their rates, as in `add_stages`."""
    for k in range(there.shape[0]):
        for j in range(3):
            for s in range(sums.shape[0]):
                for lane in range(columns.shape[0]):
                    a = there[k, lane] * rates[3 * k + j, s, first + lane] - here[k, lane] * own[3 * k + j, s]
                    sums[s, columns[lane]] += INTEGRALS[2, j] * a


@kernel
def add_through(slopes, nodes, widths, sums):
    """Add to sums (quadratures, …) the effect of changes at nodes (slices 3, states, …), by slopes of the rates."""
    for k in range(widths.shape[0]):
        for j in range(3):
            at = 3 * k + j
            weight = INTEGRALS[2, j] * widths[k]
            for i in range(sums.shape[0]):
                for s in range(nodes.shape[1]):
                    slope = weight * slopes[at, i, s]
                    if slope != 0.0:
                        for c in range(sums.shape[1]):
                            sums[i, c] += slope * nodes[at, s, c]


@kernel
def lives(start, nodes, n, found):
    """Fill found (columns, chambers slices, 4 n) with the dense output for columns of states.

    The columns are states at the start (N, columns) and at the nodes (slices 3, N, columns), or changes of these.
    """
    count = nodes.shape[0] // 3
    for chamber in range(start.shape[0] // n):
        for k in range(count):
            for s in range(n):
                row = chamber * n + s
                for c in range(start.shape[1]):
                    before = start[row, c]
                    if k > 0:
                        before = nodes[3 * k - 1, row, c]
                    end = nodes[3 * k + 2, row, c]
                    bent0 = (nodes[3 * k + 0, row, c] - before * (1.0 - X0) - X0 * end) / (X0 * (1.0 - X0))
                    bent1 = (nodes[3 * k + 1, row, c] - before * (1.0 - X1) - X1 * end) / (X1 * (1.0 - X1))
                    c4 = (bent1 - bent0) / (X1 - X0)
                    at = chamber * count + k
                    found[c, at, s] = before
                    found[c, at, n + s] = end
                    found[c, at, 2 * n + s] = bent0 - X0 * c4
                    found[c, at, 3 * n + s] = c4


compiled = partial(of_kernels, "sweeps", add_stages, add_sums, add_through, lives)
