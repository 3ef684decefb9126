"""The Jacobian of all chambers at once (`coupled.all_rates`).

Source: docs/model.md M1–M13, M24.
"""

from __future__ import annotations

from screwsim.model.coupled import clear_heads, side_of, sideways, total_rates
from screwsim.model.film import film_between, film_beyond
from screwsim.model.flows import line_place
from screwsim.model.places import fill_place, perturbation, place_derivatives
from screwsim.model.port_oil import oil_slopes, release_slopes
from screwsim.model.slopes import beyond_slopes, gap_slopes
from screwsim.model.slots import (
    ACROSS,
    ALL_LINES,
    BETWEEN,
    CATEGORIES,
    CHAMBERS,
    DISSOLVES,
    E_AREAS,
    FILMED,
    FIRST_OWN,
    GAP_OFFSET,
    N_GAPS,
    N_PLENUM,
    OFFSETS,
    OWN_PLENUMS,
    P_OMEGA,
    PLACE,
    PLENUM,
    PORT_OIL,
    PORTED,
    Q_HEAT,
    Q_STREAMS,
    Q_WALLS,
    Q_WORK,
    S_RHO,
    STREAM_OIL,
    WALLS,
    WIDTH,
    N,
    gas_phase,
)
from screwsim.model.streams import finish
from screwsim.numerics.kernel import kernel


@kernel
def all_jacobian(y, E, E_next, delta, context, f, g, J, Jq, f_phi, g_phi):
    """Fill f, g and their derivatives by y and φ, for all chambers and interfaces (as `chamber_jacobian`)."""
    P, TAB, R, places, changed, work = context.P, context.TAB, context.R, context.places, context.changed, context.work
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    n_sums = CATEGORIES * width
    n_all = CHAMBERS * N
    d = CHAMBERS * n_sums  # work: sums; place derivatives by each state, then by φ; derivatives of the sums
    ds = d + (n_all + CHAMBERS) * PLACE
    spare = ds + CHAMBERS * (n_all + 1) * n_sums
    phases = (CHAMBERS + 1) * PLACE
    for i in range(d):
        work[i] = 0.0
    for i in range(ds, spare):
        work[i] = 0.0
    for j in range(CHAMBERS):
        places[phases + j] = gas_phase(y[j * N], y[j * N + S_RHO])
        fill_place(places[phases + j], y, j * N, P, TAB, places, j * PLACE)
        place_derivatives(places[phases + j], y, j * N, P, TAB, places, j * PLACE, changed, work[d + j * N * PLACE :])
        row = d + (n_all + j) * PLACE
        for i in range(PLACE):
            work[row + i] = 0.0
    for j in range(CHAMBERS):
        for i in range(N_PLENUM + N_GAPS):
            area = E[j * size + E_AREAS + i]
            darea = (E_next[j * size + E_AREAS + i] - area) / delta
            if area > 0.0 or darea > 0.0:
                ahead = j + OFFSETS[GAP_OFFSET[i - N_PLENUM]] if i >= N_PLENUM else -1
                if i >= N_PLENUM and ahead < CHAMBERS:
                    gap_slopes(i - N_PLENUM, area, darea, j, ahead, context, d, ds)
                    if FILMED == 1:
                        film_between(i - N_PLENUM, area, darea, j, ahead, context, d, ds)
                else:
                    to = PLENUM[i] if i < N_PLENUM else 1
                    line, b = line_place(to, R, E, ALL_LINES)
                    line_next, _b = line_place(to, R, E_next, ALL_LINES)
                    beyond_slopes(i, area, darea, j, line, line_next, b, delta, context, d, ds)
                    if FILMED == 1 and i >= N_PLENUM:
                        film_beyond(i - N_PLENUM, area, darea, j, line, line_next, b, delta, context, d, ds)
    if PORTED == 1:
        n_cols = n_all + 1
        for j in range(CHAMBERS):
            at = j * n_sums + PORT_OIL * width + STREAM_OIL
            own = ds + (j * n_cols + j * N) * n_sums + PORT_OIL * width + STREAM_OIL
            over_phi = ds + (j * n_cols + n_all) * n_sums + PORT_OIL * width + STREAM_OIL
            first = d + j * N * PLACE
            oil_slopes(E, E_next, j * size, delta, places, j * PLACE, P, TAB, work, at, first, own, n_sums, over_phi)
            if DISSOLVES == 1:
                e = j * size
                row = j * PLACE
                release_slopes(
                    y, j * N, E, E_next, e, delta, places, row, P, TAB, work, at, first, own, n_sums, over_phi
                )
    total_rates(y, E, P, R, places, work, f, g)
    for c in range(CHAMBERS):
        for k in range(N):
            column(y, E, c, k, context, d, ds, spare, f, g, J, Jq)
    angle_columns(y, E_next, delta, context, ds, f, g, f_phi, g_phi)


@kernel
def angle_columns(y, E_next, delta, context, ds, f, g, f_phi, g_phi):
    """Fill ∂f/∂φ and ∂g/∂φ of all chambers, from the surroundings at φ + delta; the sums are used up."""
    P, R, places, work = context.P, context.R, context.places, context.work
    width = WIDTH
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    for j in range(CHAMBERS):
        for i in range(n_sums):
            work[j * n_sums + i] += delta * work[ds + (j * n_cols + CHAMBERS * N) * n_sums + i]
    total_rates(y, E_next, P, R, places, work, f_phi, g_phi)
    for i in range(CHAMBERS * N):
        f_phi[i] = (f_phi[i] - f[i]) / delta
    for i in range(Q_STREAMS + n_sums + 1):
        g_phi[i] = (g_phi[i] - g[i]) / delta


@kernel
def column(y, E, c, k, context, d, ds, spare, f, g, J, Jq):
    """Fill the column of state k of chamber c: its own first law differenced, the others' linear in their streams."""
    P, R, places, changed, work = context.P, context.R, context.places, context.changed, context.work
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    col = c * N + k
    delta = perturbation(y, c * N, k)
    first = c  # of the chambers whose streams the state touches
    last = c
    for r in range(CHAMBERS):
        sums = ds + (r * n_cols + col) * n_sums
        for i in range(n_sums):
            if work[sums + i] != 0.0:
                first = min(first, r)
                last = max(last, r)
    for i in range(n_sums):
        total = 0.0
        for r in range(first, last + 1):
            total += work[ds + (r * n_cols + col) * n_sums + i]
        Jq[Q_STREAMS + i, col] = total / P[P_OMEGA]
        if i == BETWEEN * width or (OWN_PLENUMS > 0 and i >= 2 * FIRST_OWN * width and i % width == 0):
            crossing = 0.0
            for r in range(first, last + 1):
                if side_of(r, P) == 0:
                    crossing += work[ds + (r * n_cols + col) * n_sums + i]
            if i == BETWEEN * width:
                Jq[Q_STREAMS + n_sums, col] = crossing / P[P_OMEGA]
            if OWN_PLENUMS > 0 and i >= 2 * FIRST_OWN * width:
                Jq[Q_STREAMS + n_sums, col] += crossing / P[P_OMEGA]
    if ACROSS == 1:
        for r in range(CHAMBERS):
            Jq[Q_STREAMS + n_sums, col] += sideways(r, work, ds + (r * n_cols + col) * n_sums, P) / P[P_OMEGA]
    base = work[spare : spare + N + 2]
    new = work[spare + N + 2 : spare + 2 * N + 4]
    if WALLS > 0:
        base = work[spare : spare + N + Q_STREAMS]
        new = work[spare + N + Q_STREAMS : spare + 2 * (N + Q_STREAMS)]
    row = places[CHAMBERS * PLACE :]
    for r in range(CHAMBERS):
        if r < first or r > last:
            for i in range(N):
                J[r * N + i, col] = 0.0
            continue
        for i in range(N):
            changed[i] = y[r * N + i]
        e = r * size
        for i in range(PLACE):
            row[i] = places[r * PLACE + i]
        sums = ds + (r * n_cols + col) * n_sums
        if r == c:  # what the chamber adds to work and heat of all
            clear_heads(base)
            finish(changed, 0, E, e, row, 0, R, P, work, r * n_sums, base, base[N:])
            changed[k] += delta
            for i in range(PLACE):
                row[i] += delta * work[d + col * PLACE + i]
        for i in range(n_sums):
            work[sums + i] = work[r * n_sums + i] + delta * work[sums + i]
        clear_heads(new)
        finish(changed, 0, E, e, row, 0, R, P, work, sums, new, new[N:])
        for i in range(N):
            J[r * N + i, col] = (new[i] - f[r * N + i]) / delta
        if r == c:
            Jq[Q_WORK, col] = (new[N] - base[N]) / delta
            Jq[Q_HEAT, col] = (new[N + 1] - base[N + 1]) / delta
            if WALLS > 0:
                for i in range(Q_WALLS, Q_STREAMS):
                    Jq[i, col] = (new[N + i] - base[N + i]) / delta
