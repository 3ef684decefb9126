"""Flows of the coupled chambers with their derivatives: through gaps, and to lines whose pressure stands or pulsates.

Source: docs/model.md M10–M13, M184–M186. Used by `coupled_jacobian.all_jacobian`.
"""

from __future__ import annotations

from screwsim.model.slots import (
    ALL_LINES,
    BETWEEN,
    BEYOND,
    CATEGORIES,
    CHAMBERS,
    DENSITY,
    ENTHALPY,
    OIL_RATIO,
    P_GAP_WIDTH,
    PLACE,
    PRESSURE,
    R_DISCHARGE,
    RESISTED,
    VOLUMED,
    WIDTH,
    N,
)
from screwsim.model.streams import (
    add_stream,
    add_stream_slope,
    category,
    flow_over_angle,
    held_slopes,
    place_slopes,
)
from screwsim.numerics.kernel import kernel


@kernel
def gap_slopes(area, darea, j, ahead, at, context, d, ds):
    """Add the flow of a gap between chambers j and `ahead`, and its derivatives, to the sums of both."""
    P, places, work = context.P, context.places, context.work
    width = WIDTH
    if RESISTED == 1:
        gap = at - BEYOND
        at = BETWEEN * width
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    own = j * PLACE
    other = ahead * PLACE
    d_phi = d + CHAMBERS * N * PLACE
    m, p_1, rho_1, p_2, rho_2 = place_slopes(1.0, places, own, places, other, P[P_GAP_WIDTH])
    if RESISTED == 1:
        m, p_1, rho_1, p_2, rho_2, x_1, x_2 = held_slopes(gap, m, p_1, rho_1, p_2, rho_2, places, own, places, other, P)  # pyright: ignore[reportPossiblyUnboundVariable]
    source = other if m >= 0.0 else own
    by_phi = flow_over_angle(area, darea, m, p_1, rho_1, p_2, rho_2, work, d_phi + own, work, d_phi + other)
    m *= area
    mine = ds + (j * n_cols + CHAMBERS * N) * n_sums + at
    theirs = ds + (ahead * n_cols + CHAMBERS * N) * n_sums + at
    add_stream(work, j * n_sums + at, m, places, source)
    add_stream(work, ahead * n_sums + at, -m, places, source)
    add_stream_slope(work, mine, m, by_phi, places, source, work, d_phi + source)
    add_stream_slope(work, theirs, -m, -by_phi, places, source, work, d_phi + source)
    for side in range(2):
        c = j if side == 0 else ahead
        by_p = area * (p_1 if side == 0 else p_2)
        by_rho = area * (rho_1 if side == 0 else rho_2)
        for k in range(N):
            if VOLUMED == 0 and k >= 2 and source != c * PLACE:
                continue  # an oil's state sets no flow; it goes with what leaves its chamber
            row = d + (c * N + k) * PLACE
            dm = by_p * work[row + PRESSURE] + by_rho * work[row + DENSITY]
            if RESISTED == 1:
                dm += area * (x_1 if side == 0 else x_2) * work[row + OIL_RATIO]  # pyright: ignore[reportPossiblyUnboundVariable]
            mine = ds + (j * n_cols + c * N + k) * n_sums + at
            theirs = ds + (ahead * n_cols + c * N + k) * n_sums + at
            if source == c * PLACE:
                add_stream_slope(work, mine, m, dm, places, source, work, row)
                add_stream_slope(work, theirs, -m, -dm, places, source, work, row)
            else:
                add_stream(work, mine, dm, places, source)
                add_stream(work, theirs, -dm, places, source)


@kernel
def opening_slopes(area, darea, j, to, epsilon, context, d, ds):
    """Add the flow between chamber j and a plenum (0 suction, 1 discharge), and its derivatives, to its sums."""
    P, R, places, work = context.P, context.R, context.places, context.work
    width = WIDTH
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    own = j * PLACE
    if RESISTED == 1:
        gap = to - BEYOND
        to = 1 if to >= BEYOND else to
        x_1 = 0.0
    b = R_DISCHARGE * to
    d_phi = d + (CHAMBERS * N + j) * PLACE
    m, p_1, rho_1, _p, _rho = place_slopes(1.0, places, own, R, b, epsilon)
    if RESISTED == 1 and gap >= 0:  # pyright: ignore[reportPossiblyUnboundVariable]
        m, p_1, rho_1, _p, _rho, x_1, _x = held_slopes(gap, m, p_1, rho_1, _p, _rho, places, own, R, b, P)  # pyright: ignore[reportPossiblyUnboundVariable]
    at = category(to, m) * width
    by_phi = m * darea + area * (p_1 * work[d_phi + PRESSURE] + rho_1 * work[d_phi + DENSITY])
    inward = m >= 0.0
    m *= area
    over_phi = ds + (j * n_cols + CHAMBERS * N) * n_sums + at
    if inward:
        add_stream(work, j * n_sums + at, m, R, b)
        add_stream(work, over_phi, by_phi, R, b)
    else:
        add_stream(work, j * n_sums + at, m, places, own)
        add_stream_slope(work, over_phi, m, by_phi, places, own, work, d_phi)
    for k in range(N):
        if VOLUMED == 0 and k >= 2 and inward:
            continue
        row = d + (j * N + k) * PLACE
        dm = area * (p_1 * work[row + PRESSURE] + rho_1 * work[row + DENSITY])
        if RESISTED == 1:
            dm += area * x_1 * work[row + OIL_RATIO]  # pyright: ignore[reportPossiblyUnboundVariable]
        mine = ds + (j * n_cols + j * N + k) * n_sums + at
        if inward:
            add_stream(work, mine, dm, R, b)
        else:
            add_stream_slope(work, mine, m, dm, places, own, work, row)


@kernel
def pulsating_slopes(area, darea, j, to, epsilon, delta, E, E_next, context, d, ds):
    """Do what `opening_slopes` does where the places of the plenums change with the angle."""
    P, places, work = context.P, context.places, context.work
    width = WIDTH
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    own = j * PLACE
    if RESISTED == 1:
        gap = to - BEYOND
        to = 1 if to >= BEYOND else to
        x_1 = 0.0
    b = ALL_LINES + R_DISCHARGE * to
    d_phi = d + (CHAMBERS * N + j) * PLACE
    m, p_1, rho_1, p_2, rho_2 = place_slopes(1.0, places, own, E, b, epsilon)
    if RESISTED == 1 and gap >= 0:  # pyright: ignore[reportPossiblyUnboundVariable]
        m, p_1, rho_1, p_2, rho_2, x_1, _x = held_slopes(gap, m, p_1, rho_1, p_2, rho_2, places, own, E, b, P)  # pyright: ignore[reportPossiblyUnboundVariable]
    at = category(to, m) * width
    by_phi = m * darea + area * (p_1 * work[d_phi + PRESSURE] + rho_1 * work[d_phi + DENSITY])
    by_phi += area * p_2 * (E_next[b + PRESSURE] - E[b + PRESSURE]) / delta
    by_phi += area * rho_2 * (E_next[b + DENSITY] - E[b + DENSITY]) / delta
    inward = m >= 0.0
    m *= area
    over_phi = ds + (j * n_cols + CHAMBERS * N) * n_sums + at
    if inward:
        add_stream(work, j * n_sums + at, m, E, b)
        add_stream(work, over_phi, by_phi, E, b)
        work[over_phi + 1] += m * (E_next[b + ENTHALPY] - E[b + ENTHALPY]) / delta
    else:
        add_stream(work, j * n_sums + at, m, places, own)
        add_stream_slope(work, over_phi, m, by_phi, places, own, work, d_phi)
    for k in range(N):
        if VOLUMED == 0 and k >= 2 and inward:
            continue
        row = d + (j * N + k) * PLACE
        dm = area * (p_1 * work[row + PRESSURE] + rho_1 * work[row + DENSITY])
        if RESISTED == 1:
            dm += area * x_1 * work[row + OIL_RATIO]  # pyright: ignore[reportPossiblyUnboundVariable]
        mine = ds + (j * n_cols + j * N + k) * n_sums + at
        if inward:
            add_stream(work, mine, dm, E, b)
        else:
            add_stream_slope(work, mine, m, dm, places, own, work, row)
