"""Flows between the ends of the steps of a closed cycle: what integrals over its life are made of.

Source: ours; Gauss–Legendre quadrature of the dense output on each step.
"""

from __future__ import annotations

import numpy as np

from screwsim.model.chamber import surroundings
from screwsim.model.room import gas_mass_slope
from screwsim.model.slots import (
    E_AREAS,
    E_LINES,
    E_SLOPE,
    E_VOLUME,
    FIRST_OWN,
    HOLDS,
    N_GAPS,
    N_PLENUM,
    OPENED,
    OPENING,
    OWN_PLENUMS,
    P_OMEGA,
    P_PORT_WIDTH,
    PLENUM,
    PRESSURE,
    PULSATING,
    R_DISCHARGE,
    S_RHO,
    S_X_OIL,
    VOLUMED,
    given_off,
    path_flows,
)
from screwsim.numerics.history import read
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import dense_slope

NEAR = 100.0  # widths ε of a port within which the chamber's balance tells its flow better than its Δp does
POINTS = 2
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(POINTS)
NODES = 0.5 + 0.5 * _NODES
WEIGHTS = 0.5 * _WEIGHTS


@kernel
def balanced(flows, mass_rate, E, own, R, P):
    """Let the mass balance tell the flow through the widest open port where its pressures are nearly equal.

    Such a port is held there by a tiny Δp, which between the ends of a step carries the whole error of the pressure.
    """
    widest = 0.0
    port = 0
    total = 0.0
    for i in range(N_PLENUM):
        total += flows[i]
        if OWN_PLENUMS > 0 and PLENUM[i] >= FIRST_OWN:
            continue
        if OPENED == 1:
            if HOLDS[i] * E[E_AREAS + i] * own[OPENING + i] > widest:
                widest = E[E_AREAS + i] * own[OPENING + i]
                port = i
            continue
        if E[E_AREAS + i] > widest:
            widest = E[E_AREAS + i]
            port = i
    for i in range(2 * N_GAPS):
        total += flows[N_PLENUM + i]
    if widest > 0.0:
        drop = R[R_DISCHARGE * PLENUM[port] + PRESSURE] - own[PRESSURE]
        if PULSATING == 1:
            drop = E[E_LINES + R_DISCHARGE * PLENUM[port] + PRESSURE] - own[PRESSURE]
        if abs(drop) < NEAR * P[P_PORT_WIDTH + PLENUM[port]]:
            flows[port] += mass_rate - total


@kernel
def flows_within(theta, step, times, dense, context, E, y, flows):
    """Fill state, surroundings and the flow of each path [kg/s] at a share of a step; return dm/dt of the gas."""
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
    h = times[step + 1] - times[step]
    phi = times[step] + theta * h
    read(phi, times, dense, step, y)
    surroundings(phi, times[step] + 0.5 * h, context, E)
    path_flows(y, E, context, flows)
    rise = dense[step, 1, 1] - dense[step, 0, 1]
    bend = (1.0 - 2.0 * theta) * dense[step, 2, 1] + (2.0 - 3.0 * theta) * theta * dense[step, 3, 1]
    mass_rate = P[P_OMEGA] * (E[E_VOLUME] * (rise + bend) / h + E[E_SLOPE] * y[S_RHO])
    if VOLUMED == 1:
        dx = dense_slope(theta, dense[step, 0, 3], dense[step, 1, 3], dense[step, 2, 3], dense[step, 3, 3]) / h
        mass_rate = P[P_OMEGA] * gas_mass_slope(E[E_VOLUME], E[E_SLOPE], y[S_RHO], (rise + bend) / h, y[S_X_OIL], dx, P)
    balanced(flows, mass_rate - given_off(y, phi, E, own, P, TAB), E, own, R, P)
    return mass_rate
