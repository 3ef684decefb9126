"""Oil that leaks through gaps as a film, beside the gas: its stream, and the derivatives of that.

Source: docs/model.md M250–M253. A film takes no gas: to the sums of a category it adds oil, energy of oil and what the
oil holds, at the upstream place's state. It flows down the pressure difference of both places.
"""

from __future__ import annotations

from screwsim.model.slots import (
    BETWEEN,
    CATEGORIES,
    CHAMBERS,
    DISSOLVED,
    DISSOLVES,
    OIL_RATIO,
    OIL_TEMPERATURE,
    PLACE,
    PRESSURE,
    STREAM_HELD,
    STREAM_OIL,
    STREAM_OIL_HEAT,
    WIDTH,
    N,
    gap_film,
    gap_film_slopes,
)
from screwsim.model.streams import category, gap_category
from screwsim.numerics.kernel import kernel


@kernel
def film_flow(i, area, own, a, other, b, P):
    """Return the oil [kg/s] that flows through gap i from place `other[b]` into place `own[a]` as a film (M252)."""
    drop = other[b + PRESSURE] - own[a + PRESSURE]
    if drop >= 0.0:
        return area * gap_film(i, drop, other[b + OIL_RATIO], P)
    return -area * gap_film(i, -drop, own[a + OIL_RATIO], P)


@kernel
def film_slopes(i, own, a, other, b, P):
    """Return the film's flow per unit area and its slopes by the pressure difference and both oil ratios."""
    drop = other[b + PRESSURE] - own[a + PRESSURE]
    ratio = other[b + OIL_RATIO] if drop >= 0.0 else own[a + OIL_RATIO]
    flux, by_drop, by_x = gap_film_slopes(i, abs(drop), ratio, P)
    if drop >= 0.0:
        return flux, by_drop, 0.0, by_x
    return -flux, by_drop, -by_x, 0.0


@kernel
def add_film(sums, at, q, source, s):
    """Add oil q [kg/s] that has the state of place `source[s]` to the sums of one category."""
    sums[at + STREAM_OIL] += q
    sums[at + STREAM_OIL_HEAT] += q * source[s + OIL_TEMPERATURE]
    if DISSOLVES == 1:
        sums[at + STREAM_HELD] += q * source[s + DISSOLVED]


@kernel
def add_film_slope(sums, at, q, dq, source, s, d, r):
    """Add the derivative of such oil: dq with the source's state, and q with the change d[r] of that state."""
    add_film(sums, at, dq, source, s)
    sums[at + STREAM_OIL_HEAT] += q * d[r + OIL_TEMPERATURE]
    if DISSOLVES == 1:
        sums[at + STREAM_HELD] += q * d[r + DISSOLVED]


@kernel
def film_beside(i, area, darea, own, source, b, P, work, d, other, n_sums):
    """Add gap i's film and its derivatives to the sums of one chamber among histories (`chamber_jacobian.jacobian`).

    The derivatives of the own place begin at work[d], those of the neighbour's place by the angle at work[other].
    """
    q, by_drop, x_1, x_2 = film_slopes(i, own, 0, source, b, P)
    ds = d + (N + 1) * PLACE
    at = gap_category(source, b, q) * WIDTH
    d_phi = d + N * PLACE
    by_phi = q * darea + area * (by_drop * work[other + PRESSURE] + x_2 * work[other + OIL_RATIO])
    inward = q >= 0.0
    q *= area
    if inward:
        add_film(work, at, q, source, b)
        add_film_slope(work, ds + N * n_sums + at, q, by_phi, source, b, work, other)
    else:
        add_film(work, at, q, own, 0)
        add_film_slope(work, ds + N * n_sums + at, q, by_phi, own, 0, work, d_phi)
    for j in range(N):
        row = d + j * PLACE
        dq = area * (x_1 * work[row + OIL_RATIO] - by_drop * work[row + PRESSURE])
        if inward:
            add_film(work, ds + j * n_sums + at, dq, source, b)
        else:
            add_film_slope(work, ds + j * n_sums + at, q, dq, own, 0, work, row)


@kernel
def film_between(i, area, darea, j, ahead, context, d, ds):
    """Add gap i's film between chambers j and `ahead`, and its derivatives, to the sums of both."""
    P, places, work = context.P, context.places, context.work
    n_sums = CATEGORIES * WIDTH
    n_cols = CHAMBERS * N + 1
    at = BETWEEN * WIDTH
    q, by_drop, x_1, x_2 = film_slopes(i, places, j * PLACE, places, ahead * PLACE, P)
    source = (ahead if q >= 0.0 else j) * PLACE
    by_phi = q * darea
    q *= area
    add_film(work, j * n_sums + at, q, places, source)
    add_film(work, ahead * n_sums + at, -q, places, source)
    add_film(work, ds + (j * n_cols + CHAMBERS * N) * n_sums + at, by_phi, places, source)
    add_film(work, ds + (ahead * n_cols + CHAMBERS * N) * n_sums + at, -by_phi, places, source)
    for side in range(2):
        c = j if side == 0 else ahead
        by_p = area * (-by_drop if side == 0 else by_drop)
        by_x = area * (x_1 if side == 0 else x_2)
        for k in range(N):
            row = d + (c * N + k) * PLACE
            dq = by_p * work[row + PRESSURE] + by_x * work[row + OIL_RATIO]
            mine = ds + (j * n_cols + c * N + k) * n_sums + at
            theirs = ds + (ahead * n_cols + c * N + k) * n_sums + at
            if source == c * PLACE:
                add_film_slope(work, mine, q, dq, places, source, work, row)
                add_film_slope(work, theirs, -q, -dq, places, source, work, row)
            else:
                add_film(work, mine, dq, places, source)
                add_film(work, theirs, -dq, places, source)


@kernel
def film_beyond(i, area, darea, j, line, line_next, b, delta, context, d, ds):
    """Add gap i's film between chamber j and the discharge line beyond it, and its derivatives, to its sums.

    The line's place stands at line[b]; at the angle `delta` further on it is line_next[b].
    """
    P, places, work = context.P, context.places, context.work
    n_sums = CATEGORIES * WIDTH
    n_cols = CHAMBERS * N + 1
    own = j * PLACE
    q, by_drop, x_1, _x = film_slopes(i, places, own, line, b, P)
    at = category(1, q) * WIDTH
    by_phi = q * darea + area * by_drop * (line_next[b + PRESSURE] - line[b + PRESSURE]) / delta
    inward = q >= 0.0
    q *= area
    over_phi = ds + (j * n_cols + CHAMBERS * N) * n_sums + at
    if inward:
        add_film(work, j * n_sums + at, q, line, b)
        add_film(work, over_phi, by_phi, line, b)
        work[over_phi + STREAM_OIL_HEAT] += q * (line_next[b + OIL_TEMPERATURE] - line[b + OIL_TEMPERATURE]) / delta
    else:
        add_film(work, j * n_sums + at, q, places, own)
        add_film(work, over_phi, by_phi, places, own)
    for k in range(N):
        row = d + (j * N + k) * PLACE
        dq = area * (x_1 * work[row + OIL_RATIO] - by_drop * work[row + PRESSURE])
        mine = ds + (j * n_cols + j * N + k) * n_sums + at
        if inward:
            add_film(work, mine, dq, line, b)
        else:
            add_film_slope(work, mine, q, dq, places, own, work, row)
