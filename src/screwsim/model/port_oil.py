"""Oil that enters a chamber through a port, and the gas that flashes out of it: streams and their derivatives.

Source: docs/model.md M104, M194–M197.
"""

from __future__ import annotations

from screwsim.model.places import (
    STEP,
)
from screwsim.model.slots import (
    CARRIED,
    E_ANGLE,
    FLASH,
    FLASHED,
    P_H_PORT,
    PLACE,
    PORT_OIL,
    PRESSURE,
    N,
    flash_terms,
    oil_inflow,
)
from screwsim.numerics.kernel import kernel

OPENING_STEP = 1e-5  # of the width of the regularisation, for differences of an opening by the pressure difference
SWITCHED = 1e-4  # of the width of the regularisation, by which a step passes the place where a valve opens or shuts
SIDE = PLACE + 1  # a neighbour in E: its place, and whether it is the discharge plenum


@kernel
def oil_slopes(E, E_next, e, delta, place, row, P, TAB, work, at, d, ds, stride, over_phi):
    """Set the oil that comes through ports, work[at …], and its derivatives by the own states and by the angle."""
    p = place[row + PRESSURE]
    oil = oil_inflow(E[e + E_ANGLE], p, P, TAB)
    by_p = (oil_inflow(E[e + E_ANGLE], p * (1.0 + STEP), P, TAB) - oil) / (p * STEP)
    by_phi = (oil_inflow(E_next[e + E_ANGLE], p, P, TAB) - oil) / delta
    for i in range(2):
        factor = 1.0 if i == 0 else P[P_H_PORT]
        work[at + i] = factor * oil
        work[over_phi + i] = factor * by_phi
        for j in range(N):
            work[ds + j * stride + i] = factor * by_p * work[d + j * PLACE + PRESSURE]
    if FLASHED == 1:
        flash_slopes(oil, p, by_p, by_phi, P, TAB, work, at, d, ds, stride, over_phi)


@kernel
def add_flash(oil, p, P, TAB, work, first):
    """Add the gas that flashes out of oil [kg/s] that enters at p [Pa] to sums that begin at `first` (M196)."""
    width = 4 if CARRIED == 1 else 2
    gas, enthalpy, heat = flash_terms(oil, p, P, TAB)
    work[first + FLASH * width] = gas
    work[first + FLASH * width + 1] = enthalpy
    work[first + PORT_OIL * width + 3] -= heat


@kernel
def flash_slopes(oil, p, by_p, by_phi, P, TAB, work, at, d, ds, stride, over_phi):
    """Set the gas that flashes and its derivatives, as `oil_slopes` those of its oil; `at` … are the oil's places."""
    width = 4 if CARRIED == 1 else 2
    away = (FLASH - PORT_OIL) * width - 2  # from the oil to the gas
    gas, enthalpy, heat = flash_terms(oil, p, P, TAB)
    one, _h, _heat = flash_terms(1.0, p, P, TAB)
    more, _h, _heat = flash_terms(1.0, p * (1.0 + STEP), P, TAB)
    slope = oil * (more - one) / (p * STEP) + by_p * one
    per_gas, h, lost = flash_terms(1.0 / one if one > 0.0 else 0.0, p, P, TAB)
    work[at + away] = gas
    work[at + away + 1] = enthalpy
    work[at + 1] -= heat
    work[over_phi + away] = by_phi * one * per_gas
    work[over_phi + away + 1] = by_phi * one * h
    work[over_phi + 1] -= by_phi * one * lost
    for j in range(N):
        by_state = slope * work[d + j * PLACE + PRESSURE]
        work[ds + j * stride + away] = by_state * per_gas
        work[ds + j * stride + away + 1] = by_state * h
        work[ds + j * stride + 1] -= by_state * lost
