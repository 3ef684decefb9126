"""The exact Jacobian of one chamber among neighbours whose histories are known (`chamber.rates`).

Source: docs/model.md M1–M13.
"""

from __future__ import annotations

from screwsim.model.chamber import SIDE
from screwsim.model.film import film_beside
from screwsim.model.flows import gap_flow_slopes, line_place, port_flow, port_flow_slopes
from screwsim.model.places import fill_place, perturbation, place_derivatives
from screwsim.model.port_oil import oil_slopes, release_slopes
from screwsim.model.slots import (
    CARRIED,
    CATEGORIES,
    DENSITY,
    DISSOLVED,
    DISSOLVES,
    E_AREAS,
    E_LINES,
    ENTHALPY,
    FILMED,
    GAP_OFFSET,
    N_GAPS,
    N_PLENUM,
    OIL_RATIO,
    OIL_TEMPERATURE,
    ONE_WAY,
    OPENED,
    OPENING,
    OWN_STATES,
    P_OMEGA,
    PLACE,
    PLENUM,
    PORT_OIL,
    PORTED,
    PRESSURE,
    PULSATING,
    Q_HEAT,
    Q_STREAMS,
    Q_WALLS,
    Q_WORK,
    RESISTED,
    S_RHO,
    S_T,
    STOPS,
    STREAM_OIL,
    VOLUMED,
    WALLS,
    WIDTH,
    N,
    gas_phase,
)
from screwsim.model.stops import keep_at_rest, keep_rows_at_rest, note_start
from screwsim.model.streams import (
    add_stream,
    add_stream_slope,
    category,
    finish,
    flow_over_angle,
    gap_category,
)
from screwsim.model.valve import opening_by_state, opening_slope
from screwsim.numerics.kernel import kernel


@kernel
def jacobian(y, E, E_next, delta, context, f, g, J, Jq, f_phi, g_phi):
    """Fill f, g and their derivatives by y and by φ: flows by their analytic slopes, smooth functions by differences.

    E_next is E at φ + delta. The square-root behaviour of a flow near equal pressures never enters a difference: a
    step of 1e-6 in the angle alone would change p by more than a wide port's Δp.
    """
    P, TAB, R, state, own, work = context.P, context.TAB, context.R, context.state, context.own, context.work
    width = WIDTH
    per_delta = 1.0 / delta
    n_sums = CATEGORIES * width
    d = n_sums  # work: sums; derivatives of the own place by each state, then by φ; derivatives of the sums likewise
    ds = d + (N + 1) * PLACE
    other = ds + (N + 1) * n_sums + N + 2
    if WALLS > 0:
        other += 2 * WALLS
    own[PLACE] = gas_phase(y[S_T], y[S_RHO])
    fill_place(own[PLACE], y, 0, P, TAB, own, 0)
    place_derivatives(own[PLACE], y, 0, P, TAB, own, 0, state, work[d:])
    d_phi = d + N * PLACE
    for i in range(PLACE):
        work[d_phi + i] = 0.0
        work[other + i] = 0.0
    for i in range(n_sums):
        work[i] = 0.0
    for i in range(ds, ds + (N + 1) * n_sums):
        work[i] = 0.0
    areas = E_AREAS + N_PLENUM
    for i in range(N_PLENUM + 2 * N_GAPS):
        area = E[E_AREAS + i]
        darea = (E_next[E_AREAS + i] - area) * per_delta
        if area > 0.0 or darea > 0.0:
            gap = i - N_PLENUM
            if gap < 0:
                source, b = line_place(PLENUM[i], R, E, E_LINES)
                m, p_1, rho_1, p_2, rho_2, x_1, x_2 = port_flow_slopes(i, own, 0, source, b, P)
                if OPENED == 1:
                    drop = source[b + PRESSURE] - own[PRESSURE]
                    if ONE_WAY[i] != 0:
                        own[OPENING + N_PLENUM + i] = 1.0 if ONE_WAY[i] * drop > 0.0 else 0.0
                    opened, by_drop = opening_slope(i, drop, y, own, P)
                    p_1 = p_1 * opened - m * by_drop
                    p_2 = p_2 * opened + m * by_drop
                    m *= opened
                    rho_1 *= opened
                    rho_2 *= opened
                if PULSATING == 1:
                    change_of_place(E, E_next, b, per_delta, work, other)
                at = category(PLENUM[i], m) * width
            else:
                b = areas + 2 * N_GAPS + (2 * GAP_OFFSET[gap // 2] + gap % 2) * SIDE
                source = E if area > 0.0 else E_next
                m, p_1, rho_1, p_2, rho_2, x_1, x_2 = gap_flow_slopes(gap // 2, own, 0, source, b, P)
                at = gap_category(source, b, m) * width
                if area > 0.0:
                    change_of_place(E, E_next, b, per_delta, work, other)
            by_phi = flow_over_angle(area, darea, m, p_1, rho_1, p_2, rho_2, work, d_phi, work, other)
            if RESISTED == 1:
                by_phi += area * x_2 * work[other + OIL_RATIO]
            m *= area
            if m < 0.0 or (area == 0.0 and by_phi < 0.0):
                add_stream(work, at, m, own, 0)
                add_stream_slope(work, ds + N * n_sums + at, m, by_phi, own, 0, work, d_phi)
            else:
                add_stream(work, at, m, source, b)
                add_stream_slope(work, ds + N * n_sums + at, m, by_phi, source, b, work, other)
            if FILMED == 1 and gap >= 0:
                film_beside(gap // 2, area, darea, own, source, b, P, work, d, other, n_sums)
            if gap >= 0 or PULSATING == 1:
                for k in range(PLACE):
                    work[other + k] = 0.0
            for j in range(N):
                if VOLUMED == 0 and OWN_STATES == 0 and j >= 2 and m >= 0.0:
                    continue  # the oil's states set no flow, and what comes in brings the oil of its source
                row = d + j * PLACE
                dm = area * (p_1 * work[row + PRESSURE] + rho_1 * work[row + DENSITY])
                if RESISTED == 1:
                    dm += area * x_1 * work[row + OIL_RATIO]
                if OPENED == 1 and gap < 0 and j >= N - OWN_STATES:
                    open_flow = port_flow(i, area, own, 0, source, b, P)
                    dm = open_flow * opening_by_state(i, source[b + PRESSURE] - own[PRESSURE], j, y, state, P)
                if m < 0.0:
                    add_stream_slope(work, ds + j * n_sums + at, m, dm, own, 0, work, row)
                else:
                    add_stream(work, ds + j * n_sums + at, dm, source, b)
    if PORTED == 1:
        at = PORT_OIL * width + STREAM_OIL
        oil_slopes(E, E_next, 0, delta, own, 0, P, TAB, work, at, d, ds + at, n_sums, ds + N * n_sums + at)
        if DISSOLVES == 1:
            release_slopes(
                y, 0, E, E_next, 0, delta, own, 0, P, TAB, work, at, d, ds + at, n_sums, ds + N * n_sums + at
            )
    g[Q_WORK] = 0.0
    g[Q_HEAT] = 0.0
    if WALLS > 0:
        for i in range(Q_WALLS, Q_STREAMS):
            g[i] = 0.0
    finish(y, 0, E, 0, own, 0, R, P, work, 0, f, g)
    per_omega = 1.0 / P[P_OMEGA]
    for i in range(n_sums):
        g[Q_STREAMS + i] = work[i] * per_omega
    for j in range(N):
        own_column(y, j, E, own, state, work, d, other, n_sums, per_omega, P, R, f, g, J, Jq)
    angle_column(y, E_next, delta, per_delta, own, work, ds + N * n_sums, n_sums, per_omega, P, R, f, g, f_phi, g_phi)
    if STOPS > 0:
        keep_at_rest(own, f)
        keep_at_rest(own, f_phi)
        keep_rows_at_rest(own, J, N)
        note_start(E, own)


@kernel
def change_of_place(E, E_next, b, per_delta, d, at):
    """Fill d[at …] with the derivative by the angle of the place at E[b …], as far as streams from there ask for it."""
    d[at + PRESSURE] = (E_next[b + PRESSURE] - E[b + PRESSURE]) * per_delta
    d[at + DENSITY] = (E_next[b + DENSITY] - E[b + DENSITY]) * per_delta
    d[at + ENTHALPY] = (E_next[b + ENTHALPY] - E[b + ENTHALPY]) * per_delta
    if CARRIED == 1:
        d[at + OIL_RATIO] = (E_next[b + OIL_RATIO] - E[b + OIL_RATIO]) * per_delta
        d[at + OIL_TEMPERATURE] = (E_next[b + OIL_TEMPERATURE] - E[b + OIL_TEMPERATURE]) * per_delta
    if DISSOLVES == 1:
        d[at + DISSOLVED] = (E_next[b + DISSOLVED] - E[b + DISSOLVED]) * per_delta


@kernel
def own_column(y, j, E, own, state, work, d, place, n_sums, per_omega, P, R, f, g, J, Jq):
    """Fill column j of J and Jq: change one state, its place and (linearly) its streams; difference the first law."""
    ds = d + (N + 1) * PLACE
    changed = ds + (N + 1) * n_sums
    delta = perturbation(y, 0, j)
    per_delta = 1.0 / delta
    for i in range(N):
        state[i] = y[i]
    state[j] += delta
    for i in range(PLACE):
        work[place + i] = own[i] + delta * work[d + j * PLACE + i]
    sums = ds + j * n_sums
    for i in range(n_sums):
        Jq[Q_STREAMS + i, j] = work[sums + i] * per_omega
        work[sums + i] = work[i] + delta * work[sums + i]
    work[changed + N] = 0.0
    work[changed + N + 1] = 0.0
    if WALLS > 0:
        for i in range(Q_WALLS, Q_STREAMS):
            work[changed + N + i] = 0.0
    finish(state, 0, E, 0, work, place, R, P, work, sums, work[changed:], work[changed + N :])
    for i in range(N):
        J[i, j] = (work[changed + i] - f[i]) * per_delta
    for i in range(Q_STREAMS):
        Jq[i, j] = (work[changed + N + i] - g[i]) * per_delta


@kernel
def angle_column(y, E_next, delta, per_delta, own, work, sums, n_sums, per_omega, P, R, f, g, f_phi, g_phi):
    """Fill ∂f/∂φ and ∂g/∂φ in the same way, from the surroundings at φ + delta."""
    for i in range(n_sums):
        g_phi[Q_STREAMS + i] = work[sums + i] * per_omega
        work[sums + i] = work[i] + delta * work[sums + i]
    g_phi[Q_WORK] = 0.0
    g_phi[Q_HEAT] = 0.0
    if WALLS > 0:
        for i in range(Q_WALLS, Q_STREAMS):
            g_phi[i] = 0.0
    finish(y, 0, E_next, 0, own, 0, R, P, work, sums, f_phi, g_phi)
    for i in range(N):
        f_phi[i] = (f_phi[i] - f[i]) * per_delta
    for i in range(Q_STREAMS):
        g_phi[i] = (g_phi[i] - g[i]) * per_delta
