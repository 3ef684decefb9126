"""Oil that enters a chamber through a port, and the gas that flashes out of it: streams and their derivatives.

Source: docs/model.md M104, M194–M197, M230–M234.
"""

from __future__ import annotations

from screwsim.model.room import gas_mass
from screwsim.model.slots import (
    DISSOLVES,
    E_VOLUME,
    ENTHALPY,
    FLASHED,
    HELD,
    PRESSURE,
    S_RHO,
    S_T,
    S_T_OIL,
    S_X_OIL,
    VOLUMED,
    flash_terms,
    oil_inflow,
    release_terms,
)
from screwsim.numerics.kernel import kernel


@kernel
def release(T, rho, T_oil, x, w, h, V, phi, P, TAB):
    """Return the gas [kg/s] that a chamber's oil gives off, its enthalpy, and its heat over c_oil (M231)."""
    m = rho * V
    if VOLUMED == 1:
        m = gas_mass(V, rho, x, P)
    return release_terms(phi, x * m, w, T, rho, h, T_oil, P, TAB)


@kernel
def released(y, phi, E, place, P, TAB):
    """Return what `release` does for one chamber at phi, whose place is filled."""
    return release(y[S_T], y[S_RHO], y[S_T_OIL], y[S_X_OIL], y[HELD], place[ENTHALPY], E[E_VOLUME], phi, P, TAB)


@kernel
def given_off(y, phi, E, place, P, TAB):
    """Return the gas [kg/s] that comes from oil, and through no path: in the chamber (M231) or as it enters (M196)."""
    gas = 0.0
    if DISSOLVES == 1:
        gas, _h, _heat = released(y, phi, E, place, P, TAB)
    if FLASHED == 1:
        gas, _h, _heat = flash_terms(oil_inflow(phi, place[PRESSURE], P, TAB), place[PRESSURE], P, TAB)
    return gas
