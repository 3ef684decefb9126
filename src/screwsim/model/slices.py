"""Kernels for all chambers at many angles of a pitch in one call: rates and their derivatives by the states.

Row k of every array belongs to angle k. At the middles of slices the states are also adjusted (`derivatives`): a
chamber that is open to a line follows its pressure within a few pascals, which drive the flow, and between the ends of
steps a history errs by as many. So the states are moved to where they change at the same rate as the history.

They call the slots of the integrator (`numerics.rodas`).

Source: docs/explanation/closing.md, Newton's correction.
"""

import math

import numpy as np

from screwsim.numerics.kernel import Slot, kernel
from screwsim.numerics.linear import lu_factor, lu_solve
from screwsim.numerics.rodas import QUADRATURES, STATES, jacobian, rates, surroundings

INSIDE = 1e-6  # rad, offset that keeps an angle within its segment of the laws
BESIDE = 1e-7  # rad, for derivatives by the angle, which are not used here

exact_jacobian = Slot("exact_jacobian")


@kernel
def rates_at(angles, middles, y, context, n_e, f, g):
    """Fill f[k] with the rates of the states y[k] at angles[k] [rad], g[k] with those of the quadratures.

    `middles` are angles in the same segments of the laws; they select the side of a breakpoint.
    """
    E = np.empty(n_e)
    for k in range(angles.shape[0]):
        surroundings(angles[k], middles[k], context, E)
        rates(y[k], E, context, f[k], g[k])


@kernel
def derivatives_at(angles, middles, y, context, n_e, f, g, J, Jq, own):
    """Do the same as `rates_at`; fill J[k] and Jq[k] with the exact derivatives of both by the states.

    If `own` has rows, it is filled instead with the derivatives of each chamber's rates by its own states, at all k
    for the first chamber, then for the next; J, Jq and g then have one row, which is overwritten.
    """
    E = np.empty(n_e)
    f_phi = np.empty(STATES)
    g_phi = np.empty(QUADRATURES)
    many = angles.shape[0]
    alone = own.shape[0] > 0
    n = own.shape[1]
    for k in range(many):
        row = 0 if alone else k
        surroundings(angles[k], middles[k], context, E)
        exact_jacobian(y[k], E, E, BESIDE, context, f[k], g[row], J[row], Jq[row], f_phi, g_phi)
        if alone:
            for chamber in range(STATES // n):
                for i in range(n):
                    for j in range(n):
                        own[chamber * many + k, i, j] = J[0, chamber * n + i, chamber * n + j]


@kernel
def in_coordinates(y, f, A, width, change, logarithmic, size, least_oil, off):
    """Turn rates f and derivatives A of states y into those of coordinates (in place); return the largest mismatch.

    The mismatch `off` is the change over a slice of that width [rad] beyond `change`; the largest is that of T and
    ρ. `logarithmic` is 1 for coordinates that are logarithms. A chamber has `size` states; with `least_oil` its oil
    is in the third and fourth, which do not change below that oil ratio.
    """
    largest = 0.0
    for i in range(STATES):
        if logarithmic[i] > 0.0:
            f[i] /= max(abs(y[i]), 1e-300)
        for j in range(STATES):
            if logarithmic[j] > 0.0:
                A[i, j] *= max(abs(y[j]), 1e-300)
            if logarithmic[i] > 0.0:
                A[i, j] /= max(abs(y[i]), 1e-300)
        if logarithmic[i] > 0.0:
            A[i, i] -= f[i]
        off[i] = width * f[i] - change[i]
        if i % size < 2:
            largest = max(largest, abs(off[i]))
        if least_oil > 0.0 and (i % size == 2 or i % size == 3) and y[i - i % size + 3] <= least_oil:
            off[i] = 0.0
            for j in range(STATES):
                A[i, j] = 0.0
    return largest


@kernel
def lead(y, A, width, off, logarithmic, most, M, pivots):
    """Move states (in place) by a Newton step, (1 − width A) δ = off, of at most `most` in coordinates."""
    for i in range(STATES):
        for j in range(STATES):
            M[i, j] = -width * A[i, j]
        M[i, i] += 1.0
    lu_factor(M, pivots, STATES)
    lu_solve(M, pivots, off, STATES)
    for i in range(STATES):
        move = min(max(off[i], -most), most)
        if logarithmic[i] > 0.0:
            y[i] *= math.exp(move)
        else:
            y[i] += move


@kernel
def fill(target, source):
    """Copy a row of numbers."""
    for i in range(target.shape[0]):
        target[i] = source[i]


@kernel
def by_unknowns(phi, y, f, g, logarithmic, R, P, shift, context, E, F, G):
    """Fill derivatives by unknowns of the rates f, in coordinates, and g; row k of R and P has unknown k shifted.

    The last rows are the unshifted ones. The phases of the gas are those of the preceding call for derivatives.
    """
    last = R.shape[0] - 1
    for k in range(last):
        fill(context.R, R[k])
        fill(context.P, P[k])
        surroundings(phi, phi - INSIDE, context, E)
        rates(y, E, context, F[k], G[k])
        for i in range(STATES):
            rate = F[k, i] / max(abs(y[i]), 1e-300) if logarithmic[i] > 0.0 else F[k, i]
            F[k, i] = (rate - f[i]) / shift
        for i in range(QUADRATURES):
            G[k, i] = (G[k, i] - g[i]) / shift
    fill(context.R, R[last])
    fill(context.P, P[last])


@kernel
def derivatives(phi, widths, y, changes, logarithmic, size, least_oil, led, R, P, shift, context, n_e, A, Jq, F, G):
    """Fill the derivatives of rates, one row for each slice, at its middle phi.

    Return how many Jacobians were evaluated. A are the derivatives of the coordinates' rates by states, Jq those of
    the quadratures', F and G those by the unknowns (`by_unknowns`). The states y (slices, N) are adjusted (in
    place) in at most led[0] steps of at most led[1], while T or ρ would change by led[2] more over their slice than
    `changes`.
    """
    E = np.empty(n_e)
    f = np.empty(STATES)
    g = np.empty(QUADRATURES)
    f_phi = np.empty(STATES)
    g_phi = np.empty(QUADRATURES)
    off = np.empty(STATES)
    M = np.empty((STATES, STATES))
    pivots = np.empty(STATES, np.int64)
    asked = 0
    for k in range(phi.shape[0]):
        surroundings(phi[k], phi[k] - INSIDE, context, E)
        left = led[0]
        while left >= 0.0:
            jacobian(y[k], E, E, BESIDE, context, f, g, A[k], Jq[k], f_phi, g_phi)
            asked += 1
            largest = in_coordinates(y[k], f, A[k], widths[k], changes[k], logarithmic, size, least_oil, off)
            if left == 0.0 or not largest > led[2]:
                left = -1.0
            else:
                lead(y[k], A[k], widths[k], off, logarithmic, led[1], M, pivots)
                left -= 1.0
        by_unknowns(phi[k], y[k], f, g, logarithmic, R, P, shift, context, E, F[k], G[k])
    return asked
