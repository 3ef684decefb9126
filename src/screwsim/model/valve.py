"""Openings that depend on a chamber's state (`FlowPath.opening`): their derivatives, and where a one-way path switches.

Source: docs/reference/slider-crank.md S22, S25–S27; docs/explanation/numerics.md.
"""

from __future__ import annotations

from screwsim.model.slots import (
    HOLDS,
    N_PLENUM,
    ONE_WAY,
    OPENING,
    P_PORT_WIDTH,
    PLACE,
    PLENUM,
    PRESSURE,
    R_DISCHARGE,
    S_RHO,
    S_T,
    gas_state,
    path_opening,
)
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import dense_coefficients, dense_value

SWITCHED = 1e-4  # of the width of the regularisation, by which a step passes the place where a valve opens or shuts
SIDE = PLACE + 1  # a neighbour in E: its place, and whether it is the discharge plenum


@kernel
def held_share(i, y, own, R, P):
    """Return how far plenum path i is open to a chamber of state y and place `own`; 0 of one that is narrow."""
    drop = R[R_DISCHARGE * PLENUM[i] + PRESSURE] - own[PRESSURE]
    held = own[OPENING + N_PLENUM + i]
    return HOLDS[i] * path_opening(i, drop, P[P_PORT_WIDTH + PLENUM[i]], held, y, 0, P)


@kernel
def share_before_switch(y, y1, u, R, P, TAB, own):
    """Return the share of a step after which the first one-way path opens or shuts; 1 where none does.

    Beyond it lies at most SWITCHED of the width of the regularisation.
    """
    share = 1.0
    p1, _h, _c, _t, _a, _x, _f = gas_state(y1[S_T], y1[S_RHO], P, TAB)
    T3, T4 = dense_coefficients(u, 0)
    rho3, rho4 = dense_coefficients(u, 1)
    for i in range(N_PLENUM):
        if ONE_WAY[i] != 0:
            line = R[R_DISCHARGE * PLENUM[i] + PRESSURE]
            most = SWITCHED * P[P_PORT_WIDTH + PLENUM[i]]
            against = -1.0 if own[OPENING + N_PLENUM + i] == 1.0 else 1.0  # of the way in which it switches
            if against * ONE_WAY[i] * (line - p1) > most:
                low = 0.0
                high = share
                while high - low > 1e-12:
                    middle = 0.5 * (low + high)
                    T = dense_value(middle, y[S_T], y1[S_T], T3, T4)
                    rho = dense_value(middle, y[S_RHO], y1[S_RHO], rho3, rho4)
                    p, _h, _c, _t, _a, _x, _f = gas_state(T, rho, P, TAB)
                    if against * ONE_WAY[i] * (line - p) > 0.5 * most:
                        high = middle
                    else:
                        low = middle
                share = high
    return share
