"""One chamber among neighbours whose histories are known: its surroundings, rates and exact Jacobian.

Source: docs/model.md M1–M13. What the neighbours do is read from histories: those ahead from the last turn, those
behind from the turn being integrated, which has passed their angle already.

A context is the tuple (P, TAB, R, t_old, d_old, t_new, d_new, kept, hints, state, own, work): parameters, tables,
run-time cells, two histories, their numbers of steps (kept[0] new, kept[1] old), search hints, and working arrays;
own[PLACE] is the phase that the gas is held in during a step (`slots.FREE`: none).
"""

from __future__ import annotations

from screwsim.model.film import add_film, film_beside, film_flow
from screwsim.model.places import (
    IMPOSSIBLE,
    angle_terms,
    fill_place,
    neighbour,
    perturbation,
    place_derivatives,
    relative_error,
    share_before_border,
)
from screwsim.model.port_oil import add_flash, add_release, oil_slopes, release_slopes
from screwsim.model.pulsation import fill_lines
from screwsim.model.room import density_of, displaced, gas_mass, locked, with_room
from screwsim.model.slots import (
    CARRIED,
    CATEGORIES,
    DENSITY,
    DISSOLVED,
    DISSOLVES,
    E_ANGLE,
    E_AREAS,
    E_LINES,
    E_VOLUME,
    ENTHALPY,
    FILMED,
    FIRST_OWN,
    FLASHED,
    FREE,
    GAP_OFFSET,
    HEATED,
    LOOSE,
    N_GAPS,
    N_OFFSETS,
    N_PLENUM,
    OFFSETS,
    OIL_RATIO,
    OIL_TEMPERATURE,
    OILED,
    ONE_WAY,
    OPENED,
    OPENING,
    OWN_PLENUMS,
    OWN_STATES,
    P_GAP_WIDTH,
    P_H_PORT,
    P_INJECTION,
    P_LIFE,
    P_OMEGA,
    P_PITCH,
    P_PORT_WIDTH,
    P_T_OIL,
    P_TO_RATIO,
    P_TRAPPED,
    PLACE,
    PLENUM,
    PORT_OIL,
    PORTED,
    PRESSURE,
    PULSATING,
    PUMPED,
    Q_HEAT,
    Q_STREAMS,
    Q_WALLS,
    Q_WORK,
    R_DISCHARGE,
    R_INJECTED,
    R_OIL_BEFORE,
    R_PRESSURE,
    R_RATIO,
    R_TRAPPED,
    RESISTED,
    STOPS,
    SUCTION_IN,
    TPT,
    VOLUMED,
    WALLS,
    WIDTH,
    N,
    gap_area,
    gas_phase,
    gas_state,
    injected_oil,
    oil_inflow,
    path_opening,
    volume_at,
)
from screwsim.model.stops import (
    begin,
    keep_at_rest,
    keep_rows_at_rest,
    note_end,
    note_start,
    put_within,
    share_before_event,
    take_event,
)
from screwsim.model.streams import (
    add_stream,
    add_stream_slope,
    category,
    finish,
    flow_over_angle,
    gap_category,
    held_back,
    held_slopes,
    place_flow,
    place_slopes,
)
from screwsim.model.valve import held_share, opening_by_state, opening_slope, share_before_switch
from screwsim.numerics.kernel import inlined, kernel

OPENING_STEP = 1e-5  # of the width of the regularisation, for differences of an opening by the pressure difference
SWITCHED = 1e-4  # of the width of the regularisation, by which a step passes the place where a valve opens or shuts
SIDE = PLACE + 1  # a neighbour in E: its place, and whether it is the discharge plenum


@inlined
def surroundings(phi, middle, context, E):
    """Fill E for a chamber at phi: own angle terms, areas of all gaps on both sides, places of the neighbours."""
    P, TAB, R, t_old, d_old, t_new, d_new, kept, hints, state, _own, _work = context
    angle_terms(phi, middle, P, TAB, E, 0)
    areas = E_AREAS + N_PLENUM
    sides = areas + 2 * N_GAPS
    if PULSATING == 1:
        fill_lines(phi, P, R, E, E_LINES)
    for o in range(N_OFFSETS):
        shift = OFFSETS[o] * P[P_PITCH]
        ahead = 0.0
        behind = 0.0
        for i in range(N_GAPS):
            if GAP_OFFSET[i] == o:
                E[areas + 2 * i] = gap_area(i, phi, P, TAB)
                E[areas + 2 * i + 1] = gap_area(i, phi - shift, P, TAB) if middle > shift else 0.0
                ahead += E[areas + 2 * i]
                behind += E[areas + 2 * i + 1]
        at = sides + 2 * o * SIDE
        if ahead > 0.0:
            if middle + shift > P[P_LIFE]:
                for i in range(PLACE):
                    E[at + i] = R[R_DISCHARGE + i]
                if PULSATING == 1:
                    for i in range(PLACE):
                        E[at + i] = E[E_LINES + R_DISCHARGE + i]
                E[at + PLACE] = 1.0
            else:
                neighbour(phi + shift, middle + shift, t_old, d_old, kept[1], hints, 2 * o, R, state, E, at)
                if VOLUMED == 1:
                    with_room(E, at, P)
        at += SIDE
        if behind > 0.0:
            if kept[0] > 0 and t_new[kept[0]] >= phi - shift:
                neighbour(phi - shift, middle - shift, t_new, d_new, kept[0], hints, 2 * o + 1, R, state, E, at)
            else:
                neighbour(phi - shift, middle - shift, t_old, d_old, kept[1], hints, 2 * o + 1, R, state, E, at)
            if VOLUMED == 1:
                with_room(E, at, P)


@inlined
def rates(y, E, context, f, g):
    """Fill f = dy/dφ and the quadrature rates g of one chamber."""
    P, TAB, R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, _state, own, work = context
    width = WIDTH
    fill_place(own[PLACE], y, 0, P, TAB, own, 0)
    for i in range(CATEGORIES * width):
        work[i] = 0.0
    for i in range(N_PLENUM):
        if E[E_AREAS + i] > 0.0:
            b = R_DISCHARGE * PLENUM[i]
            if PULSATING == 0:
                m = place_flow(E[E_AREAS + i], own, 0, R, b, P[P_PORT_WIDTH + PLENUM[i]])
                if OPENED == 1:
                    held = own[OPENING + N_PLENUM + i]
                    m *= path_opening(i, R[b + PRESSURE] - own[PRESSURE], P[P_PORT_WIDTH + PLENUM[i]], held, y, 0, P)
                if m >= 0.0:
                    add_stream(work, category(PLENUM[i], m) * width, m, R, b)
                else:
                    add_stream(work, category(PLENUM[i], m) * width, m, own, 0)
            else:
                m = place_flow(E[E_AREAS + i], own, 0, E, E_LINES + b, P[P_PORT_WIDTH + PLENUM[i]])
                if m >= 0.0:
                    add_stream(work, category(PLENUM[i], m) * width, m, E, E_LINES + b)
                else:
                    add_stream(work, category(PLENUM[i], m) * width, m, own, 0)
    areas = E_AREAS + N_PLENUM
    for i in range(2 * N_GAPS):
        if E[areas + i] > 0.0:
            b = areas + 2 * N_GAPS + (2 * GAP_OFFSET[i // 2] + i % 2) * SIDE
            m = place_flow(E[areas + i], own, 0, E, b, P[P_GAP_WIDTH])
            if RESISTED == 1:
                m = held_back(i // 2, m, E[areas + i], own, 0, E, b, P)
            if m >= 0.0:
                add_stream(work, gap_category(E, b, m) * width, m, E, b)
            else:
                add_stream(work, gap_category(E, b, m) * width, m, own, 0)
            if FILMED == 1:
                q = film_flow(i // 2, E[areas + i], own, 0, E, b, P)
                if q >= 0.0:
                    add_film(work, gap_category(E, b, q) * width, q, E, b)
                else:
                    add_film(work, gap_category(E, b, q) * width, q, own, 0)
    if PORTED == 1:
        oil = oil_inflow(E[E_ANGLE], own[PRESSURE], P, TAB)
        work[PORT_OIL * width + 2] = oil
        work[PORT_OIL * width + 3] = oil * P[P_H_PORT]
        if FLASHED == 1:
            add_flash(oil, own[PRESSURE], P, TAB, work, 0)
        if DISSOLVES == 1:
            add_release(y, 0, E, 0, oil, own, 0, P, TAB, work, 0)
    g[Q_WORK] = 0.0
    g[Q_HEAT] = 0.0
    if WALLS > 0:
        for i in range(Q_WALLS, Q_STREAMS):
            g[i] = 0.0
    finish(y, 0, E, 0, own, 0, R, P, work, 0, f, g)
    if STOPS > 0:
        keep_at_rest(own, f)
        note_end(E, own)
    per_omega = 1.0 / P[P_OMEGA]
    for i in range(CATEGORIES * width):
        g[Q_STREAMS + i] = work[i] * per_omega


@kernel
def path_flows(y, E, context, out):
    """Fill `out` with the mass flow [kg/s] into the chamber: plenum paths, then each gap ahead and behind."""
    P, TAB, R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, _state, own, _work = context
    fill_place(FREE, y, 0, P, TAB, own, 0)
    for i in range(N_PLENUM):
        out[i] = 0.0
        if E[E_AREAS + i] > 0.0:
            if PULSATING == 0:
                out[i] = place_flow(E[E_AREAS + i], own, 0, R, R_DISCHARGE * PLENUM[i], P[P_PORT_WIDTH + PLENUM[i]])
                if OPENED == 1:
                    drop = R[R_DISCHARGE * PLENUM[i] + PRESSURE] - own[PRESSURE]
                    own[OPENING + i] = path_opening(i, drop, P[P_PORT_WIDTH + PLENUM[i]], LOOSE, y, 0, P)
                    out[i] *= own[OPENING + i]
            else:
                b = E_LINES + R_DISCHARGE * PLENUM[i]
                out[i] = place_flow(E[E_AREAS + i], own, 0, E, b, P[P_PORT_WIDTH + PLENUM[i]])
    areas = E_AREAS + N_PLENUM
    for i in range(2 * N_GAPS):
        b = areas + 2 * N_GAPS + (2 * GAP_OFFSET[i // 2] + i % 2) * SIDE
        out[N_PLENUM + i] = place_flow(E[areas + i], own, 0, E, b, P[P_GAP_WIDTH]) if E[areas + i] > 0.0 else 0.0
        if RESISTED == 1 and E[areas + i] > 0.0:
            out[N_PLENUM + i] = held_back(i // 2, out[N_PLENUM + i], E[areas + i], own, 0, E, b, P)


@kernel
def film_flows(y, E, context, out):
    """Fill `out` with the oil [kg/s] that flows into the chamber as films: each gap ahead and behind (M252)."""
    P, TAB, _R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, _state, own, _work = context
    fill_place(FREE, y, 0, P, TAB, own, 0)
    areas = E_AREAS + N_PLENUM
    for i in range(2 * N_GAPS):
        b = areas + 2 * N_GAPS + (2 * GAP_OFFSET[i // 2] + i % 2) * SIDE
        out[i] = film_flow(i // 2, E[areas + i], own, 0, E, b, P) if E[areas + i] > 0.0 else 0.0


@inlined
def jacobian(y, E, E_next, delta, context, f, g, J, Jq, f_phi, g_phi):
    """Fill f, g and their derivatives by y and by φ: flows by their analytic slopes, smooth functions by differences.

    E_next is E at φ + delta. The square-root behaviour of a flow near equal pressures never enters a difference: a
    step of 1e-6 in the angle alone would change p by more than a wide port's Δp.
    """
    P, TAB, R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, state, own, work = context
    width = WIDTH
    per_delta = 1.0 / delta
    n_sums = CATEGORIES * width
    d = n_sums  # work: sums; derivatives of the own place by each state, then by φ; derivatives of the sums likewise
    ds = d + (N + 1) * PLACE
    other = ds + (N + 1) * n_sums + N + 2
    if WALLS > 0:
        other += 2 * WALLS
    own[PLACE] = gas_phase(y[0], y[1])
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
            if RESISTED == 1:
                x_1 = 0.0
                x_2 = 0.0
            gap = i - N_PLENUM
            if gap < 0:
                b = R_DISCHARGE * PLENUM[i]
                if PULSATING == 0:
                    source = R
                    m, p_1, rho_1, p_2, rho_2 = place_slopes(1.0, own, 0, R, b, P[P_PORT_WIDTH + PLENUM[i]])
                    if OPENED == 1:
                        drop = R[b + PRESSURE] - own[PRESSURE]
                        if ONE_WAY[i] != 0:
                            own[OPENING + N_PLENUM + i] = 1.0 if ONE_WAY[i] * drop > 0.0 else 0.0
                        opened, by_drop = opening_slope(i, drop, y, own, P)
                        p_1 = p_1 * opened - m * by_drop
                        p_2 = p_2 * opened + m * by_drop
                        m *= opened
                        rho_1 *= opened
                        rho_2 *= opened
                else:
                    b += E_LINES
                    source = E
                    m, p_1, rho_1, p_2, rho_2 = place_slopes(1.0, own, 0, E, b, P[P_PORT_WIDTH + PLENUM[i]])
                    change_of_place(E, E_next, b, per_delta, work, other)
                at = category(PLENUM[i], m) * width
            else:
                b = areas + 2 * N_GAPS + (2 * GAP_OFFSET[gap // 2] + gap % 2) * SIDE
                source = E if area > 0.0 else E_next
                m, p_1, rho_1, p_2, rho_2 = place_slopes(1.0, own, 0, source, b, P[P_GAP_WIDTH])
                if RESISTED == 1:
                    m, p_1, rho_1, p_2, rho_2, x_1, x_2 = held_slopes(
                        gap // 2, m, p_1, rho_1, p_2, rho_2, own, 0, source, b, P
                    )
                at = gap_category(source, b, m) * width
                if area > 0.0:
                    change_of_place(E, E_next, b, per_delta, work, other)
            by_phi = flow_over_angle(area, darea, m, p_1, rho_1, p_2, rho_2, work, d_phi, work, other)
            if RESISTED == 1:
                by_phi += area * x_2 * work[other + OIL_RATIO]  # pyright: ignore[reportPossiblyUnboundVariable]
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
                    dm += area * x_1 * work[row + OIL_RATIO]  # pyright: ignore[reportPossiblyUnboundVariable]
                if OPENED == 1 and gap < 0 and j >= N - OWN_STATES:
                    open_flow = place_flow(area, own, 0, R, b, P[P_PORT_WIDTH + PLENUM[i]])
                    dm = open_flow * opening_by_state(i, R[b + PRESSURE] - own[PRESSURE], j, y, state, P)
                if m < 0.0:
                    add_stream_slope(work, ds + j * n_sums + at, m, dm, own, 0, work, row)
                else:
                    add_stream(work, ds + j * n_sums + at, dm, source, b)
    if PORTED == 1:
        at = PORT_OIL * width + 2
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


@inlined
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


@inlined
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


@inlined
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


@kernel
def inject(y, at, P, TAB, R):
    """Let the oil in at the injection angle, and note what is there: trapped mass, pressure, oil (M9, M30)."""
    m = y[at + 1] * volume_at(P[P_INJECTION], P, TAB)
    if VOLUMED == 1:
        m = gas_mass(volume_at(P[P_INJECTION], P, TAB), y[at + 1], y[at + 3], P)
    p, _h, _c, _t, _a, _x, _f = gas_state(y[at], y[at + 1], P, TAB)
    R[R_TRAPPED] = m
    R[R_PRESSURE] = p
    if OILED == 0:
        return
    if PUMPED == 1:
        P[P_TRAPPED] = m
    if PORTED == 1:
        R[R_RATIO] = y[at + 3]
        R[R_OIL_BEFORE] = y[at + 3] * m
        return
    offered = injected_oil(p, m, P)
    before = y[at + 3] * m if CARRIED == 1 else 0.0
    R[R_OIL_BEFORE] = before
    R[R_INJECTED] = max(0.0, offered - before) if P[P_TO_RATIO] > 0.0 else offered
    R[R_RATIO] = (before + R[R_INJECTED]) / m
    if VOLUMED == 1:
        displaced(y, at, m, volume_at(P[P_INJECTION], P, TAB), before, R[R_INJECTED], P, TAB, R)
        y[at + 3] = (before + R[R_INJECTED]) / m
        return
    if CARRIED == 1:
        total = before + R[R_INJECTED]
        if total > 0.0:
            y[at + 2] = (before * y[at + 2] + R[R_INJECTED] * P[P_T_OIL]) / total
        y[at + 3] = total / m
    elif HEATED == 1:
        y[at + 2] = P[P_T_OIL]


@kernel
def at_knot(phi, y, context):
    """Apply the jump at a knot of the chamber's life: oil is injected at its angle."""
    P, TAB, R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, _state, _own, _work = context
    if abs(phi - P[P_INJECTION]) < 1e-9:
        inject(y, 0, P, TAB, R)
    if STOPS > 0 and phi == 0.0:
        begin(y, _own, R, P, TAB)


@kernel
def error_size(y0, y1, error, context):
    """Return the size of a step's error; the place of the last stage is that of y1 all but for the error itself."""
    P, _TAB, _R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, _state, own, _work = context
    if VOLUMED == 1 and locked(y1, 0, P):
        return IMPOSSIBLE
    return relative_error(y0, y1, error, 0, own, 0)


@kernel
def share_in_phase(y, y1, u, rtol, context):
    """Return the share of a step after which the gas leaves its phase (`places.share_before_border`)."""
    _P, _TAB, _R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, _state, own, _work = context
    if OPENED == 1:
        switched = share_before_switch(y, y1, u, _R, _P, _TAB, own)
        if switched < 1.0:
            return switched
    if STOPS > 0:
        share = share_before_event(y, y1, u, rtol, own, _R, _P, _TAB)
        if share < 1.0:
            return share
    return share_before_border(own[PLACE], y, y1, u, 0, own[TPT] / own[PRESSURE], rtol)


@kernel
def conserve(y, y1, E, E_next, context, dq):
    """Close the step's mass balance: by the flow through the widest open port, else by the density (docs/numerics.md).

    A wide port holds p to the plenum's by a tiny Δp, whose quadrature carries the error of the whole state; the change
    of ρV over the step does not. Where no port is open the flows are smooth, and it is ρV that follows them.
    """
    P, TAB, R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, _state, own, _work = context
    width = WIDTH
    widest = 0.0
    port = 0
    for i in range(N_PLENUM):
        area = E[E_AREAS + i] + E_next[E_AREAS + i]
        if OWN_PLENUMS > 0 and PLENUM[i] >= FIRST_OWN:  # such ports are narrow: they do not hold the pressure
            area = 0.0
        if OPENED == 1:
            fill_place(own[PLACE], y, 0, P, TAB, own, 0)
            area = E[E_AREAS + i] * held_share(i, y, own, R, P)
            fill_place(own[PLACE], y1, 0, P, TAB, own, 0)
            area += E_next[E_AREAS + i] * held_share(i, y1, own, R, P)
        if area > widest:
            widest = area
            port = PLENUM[i]
    if STOPS > 0:
        put_within(y1, own)
    defect = y1[1] * E_next[E_VOLUME] - y[1] * E[E_VOLUME]
    if VOLUMED == 1:
        defect = gas_mass(E_next[E_VOLUME], y1[1], y1[3], P) - gas_mass(E[E_VOLUME], y[1], y[3], P)
    for c in range(CATEGORIES):
        defect -= dq[Q_STREAMS + c * width]
    if widest == 0.0:
        if VOLUMED == 0:
            y1[1] -= defect / E_next[E_VOLUME]
        else:
            m = gas_mass(E_next[E_VOLUME], y1[1], y1[3], P) - defect
            y1[1] = density_of(m, E_next[E_VOLUME], y1[3], P)
        return
    at = Q_STREAMS + (SUCTION_IN + 2 * port) * width
    if dq[at] + dq[at + width] >= 0.0:
        add_stream(dq, at, defect, R, R_DISCHARGE * port)
    else:
        fill_place(own[PLACE], y1, 0, P, TAB, own, 0)
        add_stream(dq, at + width, defect, own, 0)


@kernel
def jump(y, rtol, context):
    """Let states jump between two steps where that is due; return whether the integration may go on."""
    P, TAB, R, _t_old, _d_old, _t_new, _d_new, _kept, _hints, _state, own, _work = context
    return take_event(y, rtol, own, R, P, TAB)
