"""Flows of the coupled chambers with their derivatives: through gaps, and to lines whose pressure stands or pulsates.

Source: docs/model.md M10–M13, M184–M186. Used by `coupled_jacobian.all_jacobian`.
"""

from __future__ import annotations

from screwsim.model.flows import gap_flow_slopes, port_flow_slopes
from screwsim.model.slots import (
    BETWEEN,
    CATEGORIES,
    CHAMBERS,
    DENSITY,
    ENTHALPY,
    N_PLENUM,
    OIL_RATIO,
    PLACE,
    PLENUM,
    PRESSURE,
    PULSATING,
    RESISTED,
    STREAM_ENTHALPY,
    VOLUMED,
    WIDTH,
    N,
)
from screwsim.model.streams import add_stream, add_stream_slope, category, flow_over_angle
from screwsim.numerics.kernel import kernel


@kernel
def gap_slopes(i, area, darea, j, ahead, context, d, ds):
    """Add the flow of gap i between chambers j and `ahead`, and its derivatives, to the sums of both."""
    P, places, work = context.P, context.places, context.work
    width = WIDTH
    at = BETWEEN * width
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    own = j * PLACE
    other = ahead * PLACE
    d_phi = d + CHAMBERS * N * PLACE
    m, p_1, rho_1, p_2, rho_2, x_1, x_2 = gap_flow_slopes(i, places, own, places, other, P)
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
                dm += area * (x_1 if side == 0 else x_2) * work[row + OIL_RATIO]
            mine = ds + (j * n_cols + c * N + k) * n_sums + at
            theirs = ds + (ahead * n_cols + c * N + k) * n_sums + at
            if source == c * PLACE:
                add_stream_slope(work, mine, m, dm, places, source, work, row)
                add_stream_slope(work, theirs, -m, -dm, places, source, work, row)
            else:
                add_stream(work, mine, dm, places, source)
                add_stream(work, theirs, -dm, places, source)


@kernel
def beyond_slopes(i, area, darea, j, line, line_next, b, delta, context, d, ds):
    """Add the flow between chamber j and a line or plenum, and its derivatives, to its sums.

    i counts plenum paths, then gaps, which lead to the discharge line here. The line's place stands at line[b]; that at
    the angle `delta` further on, where it pulsates, at line_next[b].
    """
    P, places, work = context.P, context.places, context.work
    width = WIDTH
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    own = j * PLACE
    d_phi = d + (CHAMBERS * N + j) * PLACE
    if i < N_PLENUM:
        to = PLENUM[i]
        m, p_1, rho_1, p_2, rho_2, x_1, _x = port_flow_slopes(i, places, own, line, b, P)
    else:
        to = 1
        m, p_1, rho_1, p_2, rho_2, x_1, _x = gap_flow_slopes(i - N_PLENUM, places, own, line, b, P)
    at = category(to, m) * width
    by_phi = m * darea + area * (p_1 * work[d_phi + PRESSURE] + rho_1 * work[d_phi + DENSITY])
    if PULSATING == 1:
        by_phi += area * p_2 * (line_next[b + PRESSURE] - line[b + PRESSURE]) / delta
        by_phi += area * rho_2 * (line_next[b + DENSITY] - line[b + DENSITY]) / delta
    inward = m >= 0.0
    m *= area
    over_phi = ds + (j * n_cols + CHAMBERS * N) * n_sums + at
    if inward:
        add_stream(work, j * n_sums + at, m, line, b)
        add_stream(work, over_phi, by_phi, line, b)
        if PULSATING == 1:
            work[over_phi + STREAM_ENTHALPY] += m * (line_next[b + ENTHALPY] - line[b + ENTHALPY]) / delta
    else:
        add_stream(work, j * n_sums + at, m, places, own)
        add_stream_slope(work, over_phi, m, by_phi, places, own, work, d_phi)
    for k in range(N):
        if VOLUMED == 0 and k >= 2 and inward:
            continue
        row = d + (j * N + k) * PLACE
        dm = area * (p_1 * work[row + PRESSURE] + rho_1 * work[row + DENSITY])
        if RESISTED == 1:
            dm += area * x_1 * work[row + OIL_RATIO]
        mine = ds + (j * n_cols + j * N + k) * n_sums + at
        if inward:
            add_stream(work, mine, dm, line, b)
        else:
            add_stream_slope(work, mine, m, dm, places, own, work, row)
