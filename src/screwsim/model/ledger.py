"""What every stream and heat of a closed cycle moves and generates, summed over one life: the ledger's raw material.

Source: docs/model.md M50–M57. Gauss–Legendre quadrature of the dense output on each step; all sums are free of the
ambient temperature and of the mean states of the lines, which `screwsim.ledger` adds.
"""

from __future__ import annotations

import math

import numpy as np

from screwsim.model.chamber import SIDE
from screwsim.model.port_oil import released
from screwsim.model.room import gas_mass
from screwsim.model.slots import (
    CARRIED,
    DENSITY,
    DISSOLVED,
    DISSOLVES,
    E_ANGLE,
    E_AREAS,
    E_LINES,
    E_OILED,
    E_VOLUME,
    ENTHALPY,
    FILMED,
    FIRST_OWN,
    FLASH,
    FLASHED,
    GAP_OFFSET,
    HEATED,
    HELD,
    N_GAPS,
    N_HEATS,
    N_OFFSETS,
    N_PLENUM,
    OFFSETS,
    OIL_RATIO,
    OIL_TEMPERATURE,
    OWN_PLENUMS,
    P_C_OIL,
    P_H_PORT,
    P_OMEGA,
    P_PITCH,
    P_T_OIL,
    PLACE,
    PLENUM,
    PLENUM_ENTROPY,
    PORTED,
    PRESSURE,
    PULSATING,
    R_DISCHARGE,
    R_RATIO,
    S_RHO,
    S_T,
    S_T_OIL,
    S_X_OIL,
    VOLUMED,
    WALLS,
    N,
    film_flows,
    flash_terms,
    gas_entropy,
    heat_part,
    held_gas,
    oil_inflow,
    solution_entropy,
    wall_state,
)
from screwsim.model.within import NODES, POINTS, WEIGHTS, flows_within
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import dense_value

# of one path: |flow| [kg], the enthalpy it carries [J] and the entropy generated where it arrives [J/K] in a chamber;
# of what leaves to the path's line: mass, enthalpy, entropy, oil [kg], oil × T_oil, oil × ln T_oil
MOVED, CARRIES, GENERATED, OUT_MASS, OUT_ENTHALPY, OUT_ENTROPY, OUT_OIL, OUT_OIL_T, OUT_OIL_LOG = range(9)
# and of what that oil holds dissolved: gas [kg], entropy [J/K]
OUT_HELD, OUT_HELD_ENTROPY = range(9, 11)
PATH_SUMS = 11
# of one heat rate: heat into the gas [J], entropy generated [J/K]; of a wall, behind the heat rates, the same
HEAT, HEAT_GENERATED = range(2)
HEAT_SUMS = 2
# of oil that is not conserved: oil made [kg], × T_oil, × ln T_oil; heat the oil loses beyond the gas's, and over T_oil
MADE, MADE_T, MADE_LOG, LOST, LOST_OVER_T = range(5)
# of the oil that comes through ports: mass [kg], × chamber pressure [kg Pa], entropy generated in the chamber [J/K]
PORT_MASS, PORT_PRESSURE, PORT_GENERATED = range(5, 8)
# of the gas that flashes out of it: mass [kg], entropy generated where it arrives [J/K], oil included
FLASH_MASS, FLASH_GENERATED = range(8, 10)
RELEASED = 10  # of gas that oil gives off over time: energy that the oil loses [J]
OIL_SUMS = 11


@kernel
def arriving(m, h_i, s_i, h, s, T):
    """Return the entropy generated [W/K] where a stream m [kg/s] of state i meets a chamber's gas (M50)."""
    return m * ((h_i - h) / T - (s_i - s))


@kernel
def oil_arriving(m, T_i, T):
    """Return the entropy generated over c_oil [kg/s] where oil of temperature T_i mixes with oil of T (M51).

    The cubic between two steps of the temperature of next to no oil may pass below zero; m is nothing there.
    """
    if not (T_i > 0.0 and T > 0.0):
        return 0.0
    return m * ((T_i - T) / T - math.log(T_i / T))


@kernel
def neighbours_entropy(phi, context, flows, E, s_discharge, entropies):
    """Fill the specific entropy of each neighbour that gas comes from, where `surroundings` found it."""
    P, TAB, times, dense, hints = context.P, context.TAB, context.t_old, context.d_old, context.hints
    for side in range(2 * N_OFFSETS):
        coming = False
        for i in range(N_GAPS):
            if GAP_OFFSET[i] == side // 2 and flows[N_PLENUM + 2 * i + side % 2] > 0.0:
                coming = True
        at = E_AREAS + N_PLENUM + 2 * N_GAPS + side * SIDE
        if coming and E[at + PLACE] > 0.0:
            entropies[side] = s_discharge
        elif coming:
            i = hints[side]
            there = phi + (1 - 2 * (side % 2)) * OFFSETS[side // 2] * P[P_PITCH]
            theta = (there - times[i]) / (times[i + 1] - times[i])
            T = dense_value(theta, dense[i, 0, 0], dense[i, 1, 0], dense[i, 2, 0], dense[i, 3, 0])
            if VOLUMED == 0:
                entropies[side] = gas_entropy(T, E[at + DENSITY], P, TAB)
            else:
                rho = dense_value(theta, dense[i, 0, 1], dense[i, 1, 1], dense[i, 2, 1], dense[i, 3, 1])
                entropies[side] = gas_entropy(T, rho, P, TAB)


@kernel
def pressed_oil_arriving(m, source, b, own, T):
    """Return what `oil_arriving` does for oil that takes room: its enthalpy holds its pressure (M109)."""
    per_pressure = (own[OIL_TEMPERATURE] - T) / own[PRESSURE]
    T_i = source[b + OIL_TEMPERATURE] - source[b + PRESSURE] * per_pressure
    if not (T_i > 0.0 and T > 0.0):
        return 0.0
    return m * ((source[b + OIL_TEMPERATURE] - own[OIL_TEMPERATURE]) / T - math.log(T_i / T))


@kernel
def add_port_oil(phi, own, T, P, TAB, dt, oil):
    """Add the oil that comes through ports, and what it generates in a chamber whose oil has T (M105, M109)."""
    m = oil_inflow(phi, own[PRESSURE], P, TAB)
    oil[PORT_MASS] += dt * m
    oil[PORT_PRESSURE] += dt * m * own[PRESSURE]
    if T > 0.0:
        rise = (P[P_H_PORT] - own[OIL_TEMPERATURE]) / T
        oil[PORT_GENERATED] += dt * m * P[P_C_OIL] * (rise - math.log(P[P_T_OIL] / T))


@kernel
def add_flashed(phi, own, y, P, TAB, R, dt, oil):
    """Add the gas that flashes out of oil that comes through ports, and what that generates (M197).

    The heat comes from the chamber's oil; the refrigerant takes it up at the oil's temperature of supply.
    """
    inflow = oil_inflow(phi, own[PRESSURE], P, TAB)
    gas, enthalpy, heat = flash_terms(inflow, own[PRESSURE], P, TAB)
    oil[FLASH_MASS] += dt * gas
    if gas > 0.0:
        s = gas_entropy(y[S_T], y[S_RHO], P, TAB)
        entropy = R[(FLASH // 2) * PLACE + PLENUM_ENTROPY]
        oil[FLASH_GENERATED] += dt * arriving(gas, enthalpy / gas, entropy, own[ENTHALPY], s, y[S_T])
        oil[FLASH_GENERATED] += dt * heat * P[P_C_OIL] * (1.0 / P[P_T_OIL] - 1.0 / y[S_T_OIL])


@kernel
def held_arriving(m, w_i, w, P, TAB):
    """Return the entropy generated [W/K] where oil m [kg/s] that holds w_i mixes with oil that holds w (M233)."""
    s, total = solution_entropy(w, P, TAB)
    _s, total_i = solution_entropy(w_i, P, TAB)
    return m * (total + s * (w_i - w) - total_i)


@kernel
def add_released(phi, own, y, E, P, TAB, dt, oil):
    """Add the gas that a chamber's oil gives off over time, and what that and the oil of ports generate (M233)."""
    inflow = oil_inflow(phi, own[PRESSURE], P, TAB)
    gas, _h, heat = released(y, phi, E, own, P, TAB)
    s, _total = solution_entropy(y[HELD], P, TAB)
    oil[FLASH_MASS] += dt * gas
    oil[RELEASED] += dt * heat * P[P_C_OIL]
    oil[FLASH_GENERATED] += dt * (gas * (gas_entropy(y[S_T], y[S_RHO], P, TAB) - s) - heat * P[P_C_OIL] / y[S_T_OIL])
    oil[FLASH_GENERATED] += dt * held_arriving(inflow, held_gas(1.0, P), y[HELD], P, TAB)


@kernel
def add_arrival(sums, m, source, b, s_i, own, T, s, T_oil, dt, c_oil):
    """Add what a stream m ≥ 0 from place source[b] moves, and generates in the chamber, over the time dt."""
    sums[MOVED] += dt * m
    sums[CARRIES] += dt * m * source[b + ENTHALPY]
    sums[GENERATED] += dt * arriving(m, source[b + ENTHALPY], s_i, own[ENTHALPY], s, T)
    if CARRIED == 1 and source[b + OIL_RATIO] > 0.0:
        oil = m * source[b + OIL_RATIO]
        if VOLUMED == 0:
            sums[GENERATED] += dt * c_oil * oil_arriving(oil, source[b + OIL_TEMPERATURE], T_oil)
        else:
            sums[GENERATED] += dt * c_oil * pressed_oil_arriving(oil, source, b, own, T_oil)


@kernel
def add_held(sums, m, source, b, w, ratio, dt, P, TAB):
    """Add what the oil of a stream m holds: what its mixing generates in the chamber, or what leaves to a line."""
    if m > 0.0 and source[b + OIL_RATIO] > 0.0:
        sums[GENERATED] += dt * held_arriving(m * source[b + OIL_RATIO], source[b + DISSOLVED], w, P, TAB)
    elif m < 0.0 and ratio > 0.0:
        _s, total = solution_entropy(w, P, TAB)
        sums[OUT_HELD] -= dt * m * ratio * w
        sums[OUT_HELD_ENTROPY] -= dt * m * ratio * total


@kernel
def add_departure(sums, m, own, s, ratio, T_oil, dt):
    """Add what a stream m > 0 takes from the chamber to a line over the time dt, `ratio` oil per gas with it."""
    sums[MOVED] += dt * m
    sums[CARRIES] += dt * m * own[ENTHALPY]
    sums[OUT_MASS] += dt * m
    sums[OUT_ENTHALPY] += dt * m * own[ENTHALPY]
    sums[OUT_ENTROPY] += dt * m * s
    if ratio > 0.0 and T_oil > 0.0:
        sums[OUT_OIL] += dt * m * ratio
        if VOLUMED == 0:
            sums[OUT_OIL_T] += dt * m * ratio * T_oil
        else:
            sums[OUT_OIL_T] += dt * m * ratio * own[OIL_TEMPERATURE]
        sums[OUT_OIL_LOG] += dt * m * ratio * math.log(T_oil)


@kernel
def add_film_moment(sums, q, source, b, own, y, dt, P, TAB):
    """Add what a film of oil q [kg/s] generates in the chamber, or what it takes to the line beyond it (M254)."""
    if q > 0.0:
        if VOLUMED == 0:
            sums[GENERATED] += dt * P[P_C_OIL] * oil_arriving(q, source[b + OIL_TEMPERATURE], y[S_T_OIL])
        else:
            sums[GENERATED] += dt * P[P_C_OIL] * pressed_oil_arriving(q, source, b, own, y[S_T_OIL])
        if DISSOLVES == 1:
            sums[GENERATED] += dt * held_arriving(q, source[b + DISSOLVED], y[HELD], P, TAB)
    elif q < 0.0 and source[b + PLACE] > 0.0 and y[S_T_OIL] > 0.0:
        sums[OUT_OIL] -= dt * q
        sums[OUT_OIL_T] -= dt * q * own[OIL_TEMPERATURE]
        sums[OUT_OIL_LOG] -= dt * q * math.log(y[S_T_OIL])
        if DISSOLVES == 1:
            _s, total = solution_entropy(y[HELD], P, TAB)
            sums[OUT_HELD] -= dt * q * y[HELD]
            sums[OUT_HELD_ENTROPY] -= dt * q * total


@kernel
def add_walls(T, m, V, phi, rho, p, dt, P, heats):
    """Add the heat of the walls to the gas, and the entropy that it generates between wall and gas (M171)."""
    for i in range(WALLS):
        conductance, warmth = wall_state(i, T, m, p, rho, V, phi, P)
        heat = dt * conductance * (warmth - T)
        heats[N_HEATS + i, HEAT] += heat
        heats[N_HEATS + i, HEAT_GENERATED] += heat * (1.0 / T - 1.0 / warmth)


@kernel
def add_moment(y, mass_rate, E, context, flows, entropies, s_suction, s_discharge, dt, paths, heats, oil):
    """Add a moment of the cycle, weighted with the time dt [s] that it stands for.

    `paths` has a row for each path (plenum paths, then gaps, both sides of a gap together), `heats` one for each heat
    rate. An outflow generates nothing in its donor: streams between chambers count where they arrive.
    """
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
    if FILMED == 1:
        films = np.empty(2 * N_GAPS)
        film_flows(y, E, context, films)
    T = y[S_T]
    s = gas_entropy(T, y[S_RHO], P, TAB)
    T_oil = y[S_T_OIL] if HEATED == 1 else 1.0
    leaving = 0.0  # oil per gas that leaves to the discharge line
    if CARRIED == 1:
        leaving = y[S_X_OIL]
    elif HEATED == 1:
        leaving = E[E_OILED] * R[R_RATIO]
    discharged = 0.0
    for i in range(N_PLENUM):
        m = flows[i]
        b = R_DISCHARGE * PLENUM[i]
        if m >= 0.0:
            s_i = s_discharge if PLENUM[i] == 1 else s_suction
            if OWN_PLENUMS > 0 and PLENUM[i] >= FIRST_OWN:
                s_i = R[b + PLENUM_ENTROPY]
            if PULSATING == 0:
                add_arrival(paths[i], m, R, b, s_i, own, T, s, T_oil, dt, P[P_C_OIL])
            else:
                add_arrival(paths[i], m, E, E_LINES + b, s_i, own, T, s, T_oil, dt, P[P_C_OIL])
        else:
            ratio = leaving if PLENUM[i] == 1 or CARRIED == 1 else 0.0
            add_departure(paths[i], -m, own, s, ratio, T_oil, dt)
            discharged -= ratio * m
        if DISSOLVES == 1:
            add_held(paths[i], m, R, b, y[HELD], leaving, dt, P, TAB)
    for i in range(2 * N_GAPS):
        m = flows[N_PLENUM + i]
        side = 2 * GAP_OFFSET[i // 2] + i % 2
        b = E_AREAS + N_PLENUM + 2 * N_GAPS + side * SIDE
        if m > 0.0:
            add_arrival(paths[N_PLENUM + i // 2], m, E, b, entropies[side], own, T, s, T_oil, dt, P[P_C_OIL])
        elif m < 0.0 and E[b + PLACE] > 0.0:
            add_departure(paths[N_PLENUM + i // 2], -m, own, s, leaving, T_oil, dt)
            discharged -= leaving * m
        if DISSOLVES == 1 and (m > 0.0 or E[b + PLACE] > 0.0):
            add_held(paths[N_PLENUM + i // 2], m, E, b, y[HELD], leaving, dt, P, TAB)
        if FILMED == 1 and E[E_AREAS + N_PLENUM + i] > 0.0:
            add_film_moment(paths[N_PLENUM + i // 2], films[i], E, b, own, y, dt, P, TAB)
    if HEATED == 1:
        m_gas = y[S_RHO] * E[E_VOLUME]
        if VOLUMED == 1:
            m_gas = gas_mass(E[E_VOLUME], y[S_RHO], y[S_X_OIL], P)
        m_oil = m_gas * leaving
        for i in range(N_HEATS):
            heat, lost = heat_part(
                i, T, m_gas, own[PRESSURE], y[S_RHO], E[E_VOLUME], E[E_ANGLE], T_oil, m_oil, R[R_RATIO], P
            )
            heats[i, HEAT] += dt * heat
            heats[i, HEAT_GENERATED] += dt * heat * (1.0 / T - 1.0 / T_oil)
            oil[LOST] += dt * (lost - heat)
            oil[LOST_OVER_T] += dt * (lost - heat) / T_oil
        if CARRIED == 0 and E[E_OILED] > 0.0:
            made = dt * (R[R_RATIO] * mass_rate + discharged)
            oil[MADE] += made
            oil[MADE_T] += made * T_oil
            oil[MADE_LOG] += made * math.log(T_oil)
    if WALLS > 0:
        m_inside = y[S_RHO] * E[E_VOLUME]
        if VOLUMED == 1:
            m_inside = gas_mass(E[E_VOLUME], y[S_RHO], y[S_X_OIL], P)
        add_walls(T, m_inside, E[E_VOLUME], E[E_ANGLE], y[S_RHO], own[PRESSURE], dt, P, heats)


@kernel
def account(times, dense, steps, context, n_e, s_suction, s_discharge, paths, heats, oil):
    """Sum the moments of a closed cycle over one life into `paths`, `heats` and `oil` (zero before).

    The history must be that of the context's last turn; `s_…` are the specific entropies of the lines' gas.
    """
    P, R, own = context.P, context.R, context.own
    E = np.empty(n_e)
    y = np.empty(N)
    flows = np.empty(N_PLENUM + 2 * N_GAPS)
    entropies = np.empty(2 * N_OFFSETS + 1)
    for i in range(n_e):
        E[i] = 0.0
    for step in range(steps):
        h = times[step + 1] - times[step]
        if not (h > 0.0):  # a step of scipy's may vanish in the rounding of angles when pitches become a life
            continue
        for k in range(POINTS):
            phi = times[step] + NODES[k] * h
            mass_rate = flows_within(NODES[k], step, times, dense, context, E, y, flows)
            neighbours_entropy(phi, context, flows, E, s_discharge, entropies)
            dt = WEIGHTS[k] * h / P[P_OMEGA]
            add_moment(y, mass_rate, E, context, flows, entropies, s_suction, s_discharge, dt, paths, heats, oil)
            if PORTED == 1:
                add_port_oil(phi, own, y[S_T_OIL], P, context.TAB, dt, oil)
            if FLASHED == 1:
                add_flashed(phi, own, y, P, context.TAB, R, dt, oil)
            if DISSOLVES == 1:
                add_released(phi, own, y, E, P, context.TAB, dt, oil)
