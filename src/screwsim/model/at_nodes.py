"""Rates of all chambers, and their derivatives, at many angles of a pitch in one call.

Reached by the slots of the integrator (`numerics.rodas`); row k of every array is of the angle k.
"""

from __future__ import annotations

import numpy as np

from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import QUADRATURES, STATES, jacobian, rates, surroundings

DELTA = 1e-7  # rad, for derivatives by the angle, which nothing here uses


@kernel
def rates_at(angles, middles, y, context, n_e, f, g):
    """Fill f[k] with the rates of the states y[k] at angles[k] [rad], g[k] with those of the quadratures.

    `middles` are angles of the same segments of the laws: they tell the side of a breakpoint.
    """
    E = np.empty(n_e)
    for k in range(angles.shape[0]):
        surroundings(angles[k], middles[k], context, E)
        rates(y[k], E, context, f[k], g[k])


@kernel
def derivatives_at(angles, middles, y, context, n_e, f, g, J, Jq):
    """Do what `rates_at` does; fill J[k] and Jq[k] with the derivatives of both by the states, row by row."""
    E = np.empty(n_e)
    f_phi = np.empty(STATES)
    g_phi = np.empty(QUADRATURES)
    J_k = np.empty((STATES, STATES))
    Jq_k = np.empty((QUADRATURES, STATES))
    for k in range(angles.shape[0]):
        surroundings(angles[k], middles[k], context, E)
        jacobian(y[k], E, E, DELTA, context, f[k], g[k], J_k, Jq_k, f_phi, g_phi)
        for i in range(STATES):
            for j in range(STATES):
                J[k, i, j] = J_k[i, j]
        for i in range(QUADRATURES):
            for j in range(STATES):
                Jq[k, i, j] = Jq_k[i, j]
