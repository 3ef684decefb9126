"""Oil that enters a chamber through a port, and the gas that flashes out of it: streams and their derivatives.

Source: docs/model.md M104, M194–M197, M230–M234.
"""

from __future__ import annotations

from screwsim.model.places import STEP, perturbation
from screwsim.model.room import gas_mass
from screwsim.model.slots import (
    DISSOLVES,
    E_ANGLE,
    E_VOLUME,
    ENTHALPY,
    FLASH,
    FLASHED,
    HELD,
    P_H_PORT,
    PLACE,
    PORT_OIL,
    PRESSURE,
    S_RHO,
    S_T,
    S_T_OIL,
    S_X_OIL,
    STREAM_ENTHALPY,
    STREAM_HELD,
    STREAM_OIL_HEAT,
    VOLUMED,
    WIDTH,
    N,
    flash_terms,
    held_gas,
    oil_inflow,
    oil_inflow_slope,
    release_terms,
)
from screwsim.numerics.kernel import kernel


@kernel
def oil_slopes(E, E_next, e, delta, place, row, P, TAB, work, at, d, ds, stride, over_phi):
    """Set the oil that comes through ports, work[at …], and its derivatives by the own states and by the angle."""
    p = place[row + PRESSURE]
    oil, by_p = oil_inflow_slope(E[e + E_ANGLE], p, P, TAB)
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
    width = WIDTH
    gas, enthalpy, heat = flash_terms(oil, p, P, TAB)
    work[first + FLASH * width] = gas
    work[first + FLASH * width + STREAM_ENTHALPY] = enthalpy
    work[first + PORT_OIL * width + STREAM_OIL_HEAT] -= heat


@kernel
def flash_slopes(oil, p, by_p, by_phi, P, TAB, work, at, d, ds, stride, over_phi):
    """Set the gas that flashes and its derivatives, as `oil_slopes` those of its oil; `at` … are the oil's places."""
    width = WIDTH
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


@kernel
def add_release(y, at, E, e, oil, place, row, P, TAB, work, first):
    """Add the gas that a chamber's oil gives off, and what oil [kg/s] brings dissolved, to sums at `first` (M231)."""
    width = WIDTH
    V = E[e + E_VOLUME]
    gas, enthalpy, heat = release(
        y[at],
        y[at + S_RHO],
        y[at + S_T_OIL],
        y[at + S_X_OIL],
        y[at + HELD],
        place[row + ENTHALPY],
        V,
        E[e + E_ANGLE],
        P,
        TAB,
    )
    work[first + FLASH * width] = gas
    work[first + FLASH * width + STREAM_ENTHALPY] = enthalpy
    work[first + PORT_OIL * width + STREAM_OIL_HEAT] -= heat
    work[first + PORT_OIL * width + STREAM_HELD] = held_gas(oil, P) - gas


@kernel
def release_slopes(y, at_y, E, E_next, e, delta, place, row, P, TAB, work, at, d, ds, stride, over_phi):
    """Set what `add_release` adds, and its derivatives, behind `oil_slopes` and with its arguments.

    The law is smooth, but for where what is released turns to what is taken up: by differences.
    """
    away = (FLASH - PORT_OIL) * WIDTH - 2
    T = y[at_y]
    rho = y[at_y + S_RHO]
    T_oil = y[at_y + S_T_OIL]
    x = y[at_y + S_X_OIL]
    w = y[at_y + HELD]
    h = place[row + ENTHALPY]
    phi = E[e + E_ANGLE]
    gas, enthalpy, heat = release(T, rho, T_oil, x, w, h, E[e + E_VOLUME], phi, P, TAB)
    work[at + 2] = held_gas(work[at], P) - gas
    work[at + 1] -= heat
    work[at + away] = gas
    work[at + away + 1] = enthalpy
    for j in range(N + 1):
        to = ds + j * stride if j < N else over_phi
        if j < N:
            by = perturbation(y, at_y, j)
            gas_1, enthalpy_1, heat_1 = release(
                T + (by if j == 0 else 0.0),
                rho + (by if j == 1 else 0.0),
                T_oil + (by if j == 2 else 0.0),
                x + (by if j == 3 else 0.0),
                w + (by if j == HELD else 0.0),
                h + by * work[d + j * PLACE + ENTHALPY],
                E[e + E_VOLUME],
                phi,
                P,
                TAB,
            )
        else:
            by = delta
            V = E_next[e + E_VOLUME]
            gas_1, enthalpy_1, heat_1 = release(T, rho, T_oil, x, w, h, V, E_next[e + E_ANGLE], P, TAB)
        work[to + 2] = held_gas(work[to], P) - (gas_1 - gas) / by
        work[to + 1] -= (heat_1 - heat) / by
        work[to + away] = (gas_1 - gas) / by
        work[to + away + 1] = (enthalpy_1 - enthalpy) / by
