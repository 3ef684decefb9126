"""All chambers alive at once, over one lobe pitch: each interface is evaluated once, so what leaves one enters another.

Source: docs/model.md M1–M13, M24. Chamber j stands at s + j pitch; the states are y[j N + i]. The flows between
chambers cancel exactly in the sum. The same kernels serve the Rosenbrock method and scipy's integrators.

A context is the tuple (P, TAB, R, places, changed, work): parameters, tables, run-time cells, one place a chamber, a
spare state, and working memory for sums and derivatives.
"""

from __future__ import annotations

from screwsim.model.chamber import (
    add_stream,
    add_stream_slope,
    angle_terms,
    category,
    fill_place,
    finish,
    perturbation,
    place_derivatives,
    place_flow,
    place_slopes,
)
from screwsim.model.slots import (
    BETWEEN,
    CARRIED,
    CATEGORIES,
    CHAMBERS,
    DENSITY,
    DISCHARGE_IN,
    E_AREAS,
    E_VOLUME,
    GAP_OFFSET,
    N_GAPS,
    N_PLENUM,
    OFFSETS,
    P_OMEGA,
    P_PITCH,
    PLACE,
    PLENUM,
    PRESSURE,
    Q_HEAT,
    Q_STREAMS,
    Q_WORK,
    R_DISCHARGE,
    N,
    gap_area,
)
from screwsim.numerics.kernel import kernel


@kernel
def all_surroundings(s, middle, context, E):
    """Fill E for all chambers, the first at angle s: angle terms and, for the trailing side, areas of the gaps."""
    P, TAB, _R, _places, _changed, _work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    for j in range(CHAMBERS):
        phi = s + j * P[P_PITCH]
        angle_terms(phi, middle + j * P[P_PITCH], P, TAB, E, j * size)
        for i in range(N_GAPS):
            E[j * size + E_AREAS + N_PLENUM + i] = gap_area(i, phi, P, TAB)


@kernel
def all_rates(y, E, context, f, g):
    """Fill f = dy/dφ of all chambers, and g: quadrature rates summed over the chambers."""
    P, _TAB, R, places, _changed, work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    width = 4 if CARRIED == 1 else 2
    n_sums = CATEGORIES * width
    for i in range(CHAMBERS * n_sums):
        work[i] = 0.0
    for j in range(CHAMBERS):
        fill_place(y, j * N, E[j * size + E_VOLUME], P, places, j * PLACE)
    for j in range(CHAMBERS):
        e = j * size + E_AREAS
        for i in range(N_PLENUM):
            if E[e + i] > 0.0:
                b = R_DISCHARGE * PLENUM[i]
                m = place_flow(E[e + i], places, j * PLACE, R, b, P)
                at = j * n_sums + category(PLENUM[i], m) * width
                if m >= 0.0:
                    add_stream(work, at, m, R, b)
                else:
                    add_stream(work, at, m, places, j * PLACE)
        for i in range(N_GAPS):
            area = E[e + N_PLENUM + i]
            if area > 0.0:
                ahead = j + OFFSETS[GAP_OFFSET[i]]
                if ahead < CHAMBERS:
                    m = place_flow(area, places, j * PLACE, places, ahead * PLACE, P)
                    source = (ahead if m >= 0.0 else j) * PLACE
                    add_stream(work, j * n_sums + BETWEEN * width, m, places, source)
                    add_stream(work, ahead * n_sums + BETWEEN * width, -m, places, source)
                else:
                    m = place_flow(area, places, j * PLACE, R, R_DISCHARGE, P)
                    if m >= 0.0:
                        add_stream(work, j * n_sums + DISCHARGE_IN * width, m, R, R_DISCHARGE)
                    else:
                        add_stream(work, j * n_sums + (DISCHARGE_IN + 1) * width, m, places, j * PLACE)
    total_rates(y, E, P, R, places, work, f, g)


@kernel
def total_rates(y, E, P, R, places, work, f, g):
    """Fill f and g from the summed streams."""
    size = E_AREAS + N_PLENUM + N_GAPS
    width = 4 if CARRIED == 1 else 2
    n_sums = CATEGORIES * width
    for i in range(Q_STREAMS + n_sums):
        g[i] = 0.0
    for j in range(CHAMBERS):
        finish(y, j * N, E, j * size, places, j * PLACE, R, P, work, j * n_sums, f, g)
        for i in range(n_sums):
            g[Q_STREAMS + i] += work[j * n_sums + i] / P[P_OMEGA]


@kernel
def opening_slopes(y, E, e, j, i, context, sums, d, ds):
    """Add flow i of chamber j (plenum paths, then gaps) and its derivatives to the sums of both its chambers."""
    P, _TAB, R, places, _changed, work = context
    width = 4 if CARRIED == 1 else 2
    n_sums = CATEGORIES * width
    n_all = CHAMBERS * N
    area = E[e + i]
    ahead = j + OFFSETS[GAP_OFFSET[i - N_PLENUM]] if i >= N_PLENUM else -1
    own = j * PLACE
    if 0 <= ahead < CHAMBERS:
        other = ahead * PLACE
        m, p_1, rho_1, p_2, rho_2 = place_slopes(area, places, own, places, other, P)
        source = other if m >= 0.0 else own
        at = BETWEEN * width
        add_stream(work, sums + j * n_sums + at, m, places, source)
        add_stream(work, sums + ahead * n_sums + at, -m, places, source)
        for side in range(2):
            c = j if side == 0 else ahead
            by_p = p_1 if side == 0 else p_2
            by_rho = rho_1 if side == 0 else rho_2
            upstream = (m < 0.0) == (side == 0)
            for k in range(N):
                row = d + (c * N + k) * PLACE
                dm = by_p * work[row + PRESSURE] + by_rho * work[row + DENSITY]
                mine = ds + (j * n_all + c * N + k) * n_sums + at
                theirs = ds + (ahead * n_all + c * N + k) * n_sums + at
                if upstream:
                    add_stream_slope(work, mine, m, dm, places, source, work, row)
                    add_stream_slope(work, theirs, -m, -dm, places, source, work, row)
                else:
                    add_stream(work, mine, dm, places, source)
                    add_stream(work, theirs, -dm, places, source)
        return
    to = 1 if i >= N_PLENUM else PLENUM[i]
    b = R_DISCHARGE * to
    m, p_1, rho_1, _p, _rho = place_slopes(area, places, own, R, b, P)
    at = category(to, m) * width
    if m >= 0.0:
        add_stream(work, sums + j * n_sums + at, m, R, b)
    else:
        add_stream(work, sums + j * n_sums + at, m, places, own)
    for k in range(N):
        row = d + (j * N + k) * PLACE
        dm = p_1 * work[row + PRESSURE] + rho_1 * work[row + DENSITY]
        mine = ds + (j * n_all + j * N + k) * n_sums + at
        if m >= 0.0:
            add_stream(work, mine, dm, R, b)
        else:
            add_stream_slope(work, mine, m, dm, places, own, work, row)


@kernel
def all_jacobian(y, E, context, f, g, J, Jq):
    """Fill f, g and their derivatives by y, as `chamber.jacobian` does, for all chambers and interfaces."""
    P, _TAB, R, places, changed, work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    width = 4 if CARRIED == 1 else 2
    n_sums = CATEGORIES * width
    n_all = CHAMBERS * N
    d = CHAMBERS * n_sums
    ds = d + n_all * PLACE
    spare = ds + CHAMBERS * n_all * n_sums
    for i in range(d):
        work[i] = 0.0
    for i in range(ds, spare):
        work[i] = 0.0
    for j in range(CHAMBERS):
        fill_place(y, j * N, E[j * size + E_VOLUME], P, places, j * PLACE)
        place_derivatives(
            y, j * N, E[j * size + E_VOLUME], P, places, j * PLACE, changed, work[d + j * N * PLACE :]
        )
    for j in range(CHAMBERS):
        for i in range(N_PLENUM + N_GAPS):
            if E[j * size + E_AREAS + i] > 0.0:
                opening_slopes(y, E, j * size + E_AREAS, j, i, context, 0, d, ds)
    total_rates(y, E, P, R, places, work, f, g)
    for c in range(CHAMBERS):
        for k in range(N):
            column(y, E, c, k, context, ds, spare, f, g, J, Jq)


@kernel
def column(y, E, c, k, context, ds, spare, f, g, J, Jq):
    """Fill the column of state k of chamber c: its own first law differenced, the others' linear in their streams."""
    P, _TAB, R, places, changed, work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    width = 4 if CARRIED == 1 else 2
    n_sums = CATEGORIES * width
    n_all = CHAMBERS * N
    col = c * N + k
    delta = perturbation(y, c * N, k)
    for i in range(n_sums):
        total = 0.0
        for r in range(CHAMBERS):
            total += work[ds + (r * n_all + col) * n_sums + i]
        Jq[Q_STREAMS + i, col] = total / P[P_OMEGA]
    base = work[spare : spare + N + 2]
    new = work[spare + N + 2 : spare + 2 * N + 4]
    row = places[CHAMBERS * PLACE :]
    for r in range(CHAMBERS):
        sums = ds + (r * n_all + col) * n_sums
        touched = r == c
        for i in range(n_sums):
            if work[sums + i] != 0.0:
                touched = True
        if not touched:
            for i in range(N):
                J[r * N + i, col] = 0.0
            continue
        for i in range(N):
            changed[i] = y[r * N + i]
        e = r * size
        for i in range(PLACE):
            row[i] = places[r * PLACE + i]
        base[N] = 0.0
        base[N + 1] = 0.0
        finish(changed, 0, E, e, row, 0, R, P, work, r * n_sums, base, base[N:])
        for i in range(n_sums):
            work[sums + i] = work[r * n_sums + i] + delta * work[sums + i]
        if r == c:
            changed[k] += delta
            fill_place(changed, 0, E[e + E_VOLUME], P, row, 0)
        new[N] = 0.0
        new[N + 1] = 0.0
        finish(changed, 0, E, e, row, 0, R, P, work, sums, new, new[N:])
        for i in range(N):
            J[r * N + i, col] = (new[i] - base[i]) / delta
        if r == c:
            Jq[Q_WORK, col] = (new[N] - base[N]) / delta
            Jq[Q_HEAT, col] = (new[N + 1] - base[N + 1]) / delta


@kernel
def no_knot(phi, y, context):
    """Leave the states alone: the only jump, oil injection, lies at the border between two pitches."""
