"""All chambers alive at once, over one lobe pitch: each interface is evaluated once, so what leaves one enters another.

Source: docs/model.md M1–M13, M24. Chamber j stands at s + j pitch; the states are y[j N + i]. The flows between
chambers cancel exactly in the sum. The same kernels serve the Rosenbrock method and scipy's integrators.

A context is a `contexts.CoupledContext`.

Where effects open chambers beyond the injection angle to suction, or others to discharge, what enters the chambers
before that angle from those beyond it is counted with what the lines' sums take for the other side's (`sideways`).
"""

from __future__ import annotations

from screwsim.model.film import film_flow
from screwsim.model.flows import between, film_between_chambers, gap_flow, line_place, port_flow, take, take_film
from screwsim.model.places import angle_terms, fill_place
from screwsim.model.port_oil import add_flash, add_release
from screwsim.model.pulsation import fill_lines
from screwsim.model.slots import (
    ACROSS,
    ALL_LINES,
    BETWEEN,
    CATEGORIES,
    CHAMBERS,
    DISCHARGE_IN,
    DISSOLVES,
    E_ANGLE,
    E_AREAS,
    FILMED,
    FIRST_OWN,
    FLASHED,
    GAP_OFFSET,
    N_GAPS,
    N_PLENUM,
    OFFSETS,
    OWN_PLENUMS,
    P_H_PORT,
    P_INJECTION,
    P_OMEGA,
    P_PITCH,
    PLACE,
    PLENUM,
    PORT_OIL,
    PORTED,
    PRESSURE,
    PULSATING,
    Q_STREAMS,
    Q_WALLS,
    STREAM_OIL,
    STREAM_OIL_HEAT,
    SUCTION_IN,
    WALLS,
    WIDTH,
    N,
    gap_area,
    oil_inflow,
)
from screwsim.model.streams import category, finish
from screwsim.numerics.kernel import kernel


@kernel
def all_surroundings(s, middle, context, E):
    """Fill E for all chambers, the first at angle s: angle terms and, for the trailing side, areas of the gaps."""
    P, TAB, R = context.P, context.TAB, context.R
    size = E_AREAS + N_PLENUM + N_GAPS
    for j in range(CHAMBERS):
        phi = s + j * P[P_PITCH]
        angle_terms(phi, middle + j * P[P_PITCH], P, TAB, E, j * size)
        for i in range(N_GAPS):
            E[j * size + E_AREAS + N_PLENUM + i] = gap_area(i, phi, P, TAB)
    if PULSATING == 1:
        fill_lines(s, P, R, E, ALL_LINES)


@kernel
def all_rates(y, E, context, f, g):
    """Fill f = dy/dφ of all chambers, and g: quadrature rates summed over the chambers.

    The last of g is the gas that enters the chambers before the injection angle from those beyond it.
    """
    P, TAB, R, places, work = context.P, context.TAB, context.R, context.places, context.work
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    n_sums = CATEGORIES * width
    for i in range(CHAMBERS * n_sums):
        work[i] = 0.0
    for j in range(CHAMBERS):
        fill_place(places[(CHAMBERS + 1) * PLACE + j], y, j * N, P, TAB, places, j * PLACE)
    for j in range(CHAMBERS):
        e = j * size + E_AREAS
        sums = j * n_sums
        own = j * PLACE
        for i in range(N_PLENUM):
            if E[e + i] > 0.0:
                line, b = line_place(PLENUM[i], R, E, ALL_LINES)
                m = port_flow(i, E[e + i], places, own, line, b, P)
                at = sums + category(PLENUM[i], 1.0) * width
                take(work, at, at + width, m, places, own, line, b)
        for i in range(N_GAPS):
            area = E[e + N_PLENUM + i]
            if area > 0.0:
                ahead = j + OFFSETS[GAP_OFFSET[i]]
                if ahead < CHAMBERS:
                    here, there = sums + BETWEEN * width, ahead * n_sums + BETWEEN * width
                    m = gap_flow(i, area, places, own, places, ahead * PLACE, P)
                    between(work, here, there, m, places, own, ahead * PLACE)
                    if FILMED == 1:
                        film_between_chambers(work, here, there, i, area, places, own, ahead * PLACE, P)
                else:
                    line, b = line_place(1, R, E, ALL_LINES)
                    m = gap_flow(i, area, places, own, line, b, P)
                    at = sums + category(1, 1.0) * width
                    take(work, at, at + width, m, places, own, line, b)
                    if FILMED == 1:
                        q = film_flow(i, area, places, own, line, b, P)
                        take_film(work, at, at + width, q, places, own, line, b)
    if PORTED == 1:
        for j in range(CHAMBERS):
            oil = oil_inflow(E[j * size + E_ANGLE], places[j * PLACE + PRESSURE], P, TAB)
            work[j * n_sums + PORT_OIL * width + STREAM_OIL] = oil
            work[j * n_sums + PORT_OIL * width + STREAM_OIL_HEAT] = oil * P[P_H_PORT]
            if FLASHED == 1:
                add_flash(oil, places[j * PLACE + PRESSURE], P, TAB, work, j * n_sums)
            if DISSOLVES == 1:
                add_release(y, j * N, E, j * size, oil, places, j * PLACE, P, TAB, work, j * n_sums)
    total_rates(y, E, P, R, places, work, f, g)


@kernel
def total_rates(y, E, P, R, places, work, f, g):
    """Fill f and g from the summed streams."""
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    n_sums = CATEGORIES * width
    for i in range(Q_STREAMS + n_sums + 1):
        g[i] = 0.0
    for j in range(CHAMBERS):
        finish(y, j * N, E, j * size, places, j * PLACE, R, P, work, j * n_sums, f, g)
        for i in range(n_sums):
            g[Q_STREAMS + i] += work[j * n_sums + i] / P[P_OMEGA]
        if side_of(j, P) == 0:
            g[Q_STREAMS + n_sums] += work[j * n_sums + BETWEEN * width] / P[P_OMEGA]
            if OWN_PLENUMS > 0:
                for c in range(2 * FIRST_OWN, CATEGORIES):
                    g[Q_STREAMS + n_sums] += work[j * n_sums + c * width] / P[P_OMEGA]
        if ACROSS == 1:
            g[Q_STREAMS + n_sums] += sideways(j, work, j * n_sums, P) / P[P_OMEGA]


@kernel
def clear_heads(filled):
    """Set to zero what stands behind N rates: work, heat and the like."""
    filled[N] = 0.0
    filled[N + 1] = 0.0
    if WALLS > 0:
        for i in range(Q_WALLS, Q_STREAMS):
            filled[N + i] = 0.0


@kernel
def sideways(j, sums, at, P):
    """Return the gas that the sums of both lines count to the side of the chambers on which chamber j is not.

    What comes from the discharge line into one before the injection angle, less what comes from the suction line into
    one beyond it: the sum of the suction line and this make what enters the chambers before it.
    """
    width = WIDTH
    if side_of(j, P) == 0:
        return sums[at + DISCHARGE_IN * width] + sums[at + (DISCHARGE_IN + 1) * width]
    return -sums[at + SUCTION_IN * width] - sums[at + (SUCTION_IN + 1) * width]


@kernel
def side_of(j, P):
    """Return 0 for a chamber before the injection angle, 1 for one beyond it."""
    return 0 if (j + 0.5) * P[P_PITCH] < P[P_INJECTION] else 1
