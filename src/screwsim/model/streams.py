"""Streams between places, summed by category, and the first law of the chamber that they feed.

Source: docs/model.md M1–M13. `sums` holds mass, enthalpy and, with carried oil, oil mass and oil mass × T_oil, and the
gas that the oil holds where that is a state (M230).
"""

from __future__ import annotations

from screwsim.fluid.nozzle import flow, flow_slopes
from screwsim.model.balance import held_slope, oil_temperature_slope, temperature_slope
from screwsim.model.room import gas_mass
from screwsim.model.slots import (
    BETWEEN,
    C_V,
    CARRIED,
    CATEGORIES,
    CHOKE,
    CHOKED,
    DENSITY,
    DISCHARGE_IN,
    DISSOLVED,
    DISSOLVES,
    E_ANGLE,
    E_OILED,
    E_SLOPE,
    E_VOLUME,
    ENTHALPY,
    EXPONENT,
    HEATED,
    HELD,
    OIL_RATIO,
    OIL_TEMPERATURE,
    OWN_STATES,
    P_C_OIL,
    P_OMEGA,
    P_ROOM,
    PLACE,
    PRESSURE,
    Q_HEAT,
    Q_WALLS,
    Q_WORK,
    R_DISCHARGE,
    R_RATIO,
    R_SUCTION,
    S_RHO,
    S_T_OIL,
    S_X_OIL,
    STREAM_ENTHALPY,
    STREAM_HELD,
    STREAM_OIL,
    STREAM_OIL_HEAT,
    SUCTION_IN,
    TPT,
    VOLUMED,
    WALLS,
    WIDTH,
    N,
    gap_share,
    gap_share_slopes,
    heat_rates,
    state_rate,
    wall_state,
)
from screwsim.numerics.kernel import kernel


@kernel
def place_flow(area, own, a, other, b, width):
    """Return the mass flow [kg/s] from place `other[b]` into place `own[a]`."""
    return flow(
        area,
        own[a + PRESSURE],
        own[a + DENSITY],
        own[a + EXPONENT],
        own[a + CHOKE],
        own[a + CHOKED],
        other[b + PRESSURE],
        other[b + DENSITY],
        other[b + EXPONENT],
        other[b + CHOKE],
        other[b + CHOKED],
        width,
    )


@kernel
def place_slopes(area, own, a, other, b, width):
    """Return the mass flow and its slopes by pressure and density of both places."""
    return flow_slopes(
        area,
        own[a + PRESSURE],
        own[a + DENSITY],
        own[a + EXPONENT],
        own[a + CHOKE],
        own[a + CHOKED],
        other[b + PRESSURE],
        other[b + DENSITY],
        other[b + EXPONENT],
        other[b + CHOKE],
        other[b + CHOKED],
        width,
    )


@kernel
def share_of(i, flux, place, row, P):
    """Return the share of a nozzle's flux [kg/(m² s)] from a place that gap i lets pass (M190)."""
    ratio = place[row + OIL_RATIO] if CARRIED == 1 else 0.0
    return gap_share(i, flux, place[row + DENSITY], ratio, P)


@kernel
def held_back(i, m, area, own, a, other, b, P):
    """Return what gap i lets pass of a nozzle's flow m [kg/s] through an area."""
    flux = abs(m) / area
    if m >= 0.0:
        return m * share_of(i, flux, other, b, P)
    return m * share_of(i, flux, own, a, P)


@kernel
def held_slopes(i, m, p_1, rho_1, p_2, rho_2, own, a, other, b, P):
    """Return flow and slopes of gap i, and those by both oil ratios, from a nozzle's per unit area (M190)."""
    flux = abs(m)
    if m >= 0.0:
        ratio = other[b + OIL_RATIO] if CARRIED == 1 else 0.0
        density = other[b + DENSITY]
    else:
        ratio = own[a + OIL_RATIO] if CARRIED == 1 else 0.0
        density = own[a + DENSITY]
    share, by_flux, by_rho, by_x = gap_share_slopes(i, flux, density, ratio, P)
    by_rho *= m
    by_x *= m
    grown = share + flux * by_flux
    if m >= 0.0:
        return m * share, grown * p_1, grown * rho_1, grown * p_2, grown * rho_2 + by_rho, 0.0, by_x
    return m * share, grown * p_1, grown * rho_1 + by_rho, grown * p_2, grown * rho_2, by_x, 0.0


@kernel
def add_stream(sums, at, m, source, s):
    """Add a stream of mass flow m that has the state of place `source[s]` to the sums of one category."""
    sums[at] += m
    sums[at + STREAM_ENTHALPY] += m * source[s + ENTHALPY]
    if CARRIED == 1:
        oil = m * source[s + OIL_RATIO]
        sums[at + STREAM_OIL] += oil
        sums[at + STREAM_OIL_HEAT] += oil * source[s + OIL_TEMPERATURE]
        if DISSOLVES == 1:
            sums[at + STREAM_HELD] += oil * source[s + DISSOLVED]


@kernel
def add_stream_slope(sums, at, m, dm, source, s, d, r):
    """Add the derivative of a stream: dm with the source's state, and m with the change d[r] of that state."""
    add_stream(sums, at, dm, source, s)
    sums[at + STREAM_ENTHALPY] += m * d[r + ENTHALPY]
    if CARRIED == 1:
        ratio = m * d[r + OIL_RATIO]
        sums[at + STREAM_OIL] += ratio
        sums[at + STREAM_OIL_HEAT] += (
            ratio * source[s + OIL_TEMPERATURE] + m * source[s + OIL_RATIO] * d[r + OIL_TEMPERATURE]
        )
        if DISSOLVES == 1:
            sums[at + STREAM_HELD] += ratio * source[s + DISSOLVED] + m * source[s + OIL_RATIO] * d[r + DISSOLVED]


@kernel
def flow_over_angle(area, darea, m_1, by_p1, by_rho1, by_p2, by_rho2, d_own, a, d_other, b):
    """Return dṁ/dφ at fixed states from the flow and slopes per unit area, and the places' derivatives by the angle."""
    of_places = by_p1 * d_own[a + PRESSURE] + by_rho1 * d_own[a + DENSITY]
    of_places += by_p2 * d_other[b + PRESSURE] + by_rho2 * d_other[b + DENSITY]
    return m_1 * darea + area * of_places


@kernel
def category(path_to, m):
    """Return the category of a stream through an opening to a plenum (0 suction, 1 discharge)."""
    return SUCTION_IN + 2 * path_to + (0 if m >= 0.0 else 1)


@kernel
def gap_category(E, at, m):
    """Return the category of a stream through a gap: between chambers, or of the discharge plenum beyond the last."""
    if E[at + PLACE] > 0.0:
        return DISCHARGE_IN + (0 if m >= 0.0 else 1)
    return BETWEEN


@kernel
def from_walls(T, m, p, rho, V, phi, P, g):
    """Return the heat [W] from the walls to the gas (M170), and add it and the conductances to g, wall by wall."""
    total = 0.0
    for i in range(WALLS):
        conductance, warmth = wall_state(i, T, m, p, rho, V, phi, P)
        heat = conductance * (warmth - T)
        g[Q_WALLS + 2 * i] += heat / P[P_OMEGA]
        g[Q_WALLS + 2 * i + 1] += conductance / P[P_OMEGA]
        total += heat
    return total


@kernel
def finish(y, at, E, e, place, row, R, P, sums, first, f, g):
    """Fill f (rates of one chamber, at `at`) and add work and heat to g from the summed streams; the first law."""
    T = y[at]
    rho = y[at + S_RHO]
    m = rho * E[e + E_VOLUME]
    if VOLUMED == 1:
        m = gas_mass(E[e + E_VOLUME], rho, y[at + S_X_OIL], P)
    width = WIDTH
    mass = 0.0
    enthalpy = 0.0
    oil = 0.0
    oil_energy = 0.0
    if DISSOLVES == 1:
        held = 0.0
    for c in range(CATEGORIES):
        i = first + c * width
        mass += sums[i]
        enthalpy += sums[i + STREAM_ENTHALPY]
        if CARRIED == 1:
            oil += sums[i + STREAM_OIL]
            oil_energy += sums[i + STREAM_OIL_HEAT]
            if DISSOLVES == 1:
                held += sums[i + STREAM_HELD]  # pyright: ignore[reportPossiblyUnboundVariable]
    omega = P[P_OMEGA]
    heat = 0.0
    if HEATED == 1:
        m_oil = (y[at + S_X_OIL] if CARRIED == 1 else E[e + E_OILED] * R[R_RATIO]) * m
        heat, lost = heat_rates(
            T, m, place[row + PRESSURE], rho, E[e + E_VOLUME], E[e + E_ANGLE], y[at + S_T_OIL], m_oil, R[R_RATIO], P
        )
        if VOLUMED == 0:
            f[at + S_T_OIL] = oil_temperature_slope(y[at + S_T_OIL], m_oil, m, P[P_C_OIL], oil, oil_energy, lost, omega)
        else:
            own = place[row + OIL_TEMPERATURE]
            f[at + S_T_OIL] = oil_temperature_slope(own, m_oil, m, P[P_C_OIL], oil, oil_energy, lost, omega)
        if CARRIED == 1:
            f[at + S_X_OIL] = (oil - y[at + S_X_OIL] * mass) / (m * omega)
        if DISSOLVES == 1:
            f[at + HELD] = held_slope(y[at + HELD], m_oil, m, oil, held, omega)  # pyright: ignore[reportPossiblyUnboundVariable]
    if WALLS > 0:
        warmth = from_walls(T, m, place[row + PRESSURE], rho, E[e + E_VOLUME], E[e + E_ANGLE], P, g)
        heat += warmth
        g[Q_HEAT] -= warmth / omega
    if OWN_STATES > 0:
        p = place[row + PRESSURE]
        p_s = R[R_SUCTION + PRESSURE]
        p_d = R[R_DISCHARGE + PRESSURE]
        for i in range(OWN_STATES):
            rate = state_rate(i, T, m, p, rho, E[e + E_VOLUME], E[e + E_ANGLE], p_s, p_d, y, at, P)
            f[at + N - OWN_STATES + i] = rate / omega
    if VOLUMED == 0:
        f[at] = temperature_slope(
            T,
            m,
            rho,
            place[row + ENTHALPY],
            place[row + C_V],
            place[row + TPT],
            mass,
            enthalpy,
            heat,
            E[e + E_SLOPE],
            omega,
        )
        f[at + S_RHO] = (mass / omega - rho * E[e + E_SLOPE]) / E[e + E_VOLUME]
    else:
        slope = E[e + E_SLOPE] - oil * P[P_ROOM] / omega
        f[at] = temperature_slope(
            T, m, rho, place[row + ENTHALPY], place[row + C_V], place[row + TPT], mass, enthalpy, heat, slope, omega
        )
        f[at + S_RHO] = (mass / omega - rho * slope) * rho / m
    g[Q_WORK] -= place[row + PRESSURE] * E[e + E_SLOPE]
    g[Q_HEAT] += heat / omega
