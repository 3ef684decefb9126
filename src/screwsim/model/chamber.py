"""One chamber among neighbours whose histories are known: its surroundings and rates.

Source: docs/model.md M1–M13. What the neighbours do is read from histories: those ahead from the last turn, those
behind from the turn being integrated, which has passed their angle already.

A context is a `contexts.ChamberContext`.
"""

from __future__ import annotations

from screwsim.model.film import film_flow
from screwsim.model.flows import gap_flow, line_place, open_share, port_flow, take, take_film
from screwsim.model.places import angle_terms, fill_place, neighbour
from screwsim.model.port_oil import add_flash, add_release
from screwsim.model.pulsation import fill_lines
from screwsim.model.room import with_room
from screwsim.model.slots import (
    CATEGORIES,
    DISSOLVES,
    E_ANGLE,
    E_AREAS,
    E_LINES,
    FILMED,
    FLASHED,
    FREE,
    GAP_OFFSET,
    LOOSE,
    N_GAPS,
    N_OFFSETS,
    N_PLENUM,
    OFFSETS,
    OPENED,
    OPENING,
    P_H_PORT,
    P_LIFE,
    P_OMEGA,
    P_PITCH,
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
    R_DISCHARGE,
    STOPS,
    STREAM_OIL,
    STREAM_OIL_HEAT,
    VOLUMED,
    WALLS,
    WIDTH,
    gap_area,
    oil_inflow,
)
from screwsim.model.stops import keep_at_rest, note_end
from screwsim.model.streams import category, finish, gap_category
from screwsim.numerics.kernel import kernel

SIDE = PLACE + 1  # a neighbour in E: its place, and whether it is the discharge plenum


@kernel
def surroundings(phi, middle, context, E):
    """Fill E for a chamber at phi: own angle terms, areas of all gaps on both sides, places of the neighbours."""
    P, TAB, R, kept, hints, state = context.P, context.TAB, context.R, context.kept, context.hints, context.state
    t_old, d_old, t_new, d_new = context.t_old, context.d_old, context.t_new, context.d_new
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


@kernel
def rates(y, E, context, f, g):
    """Fill f = dy/dφ and the quadrature rates g of one chamber."""
    P, TAB, R, own, work = context.P, context.TAB, context.R, context.own, context.work
    width = WIDTH
    fill_place(own[PLACE], y, 0, P, TAB, own, 0)
    for i in range(CATEGORIES * width):
        work[i] = 0.0
    for i in range(N_PLENUM):
        area = E[E_AREAS + i]
        if area > 0.0:
            line, b = line_place(PLENUM[i], R, E, E_LINES)
            m = port_flow(i, area, own, 0, line, b, P)
            if OPENED == 1:
                m *= open_share(i, y, own, line, b, own[OPENING + N_PLENUM + i], P)
            at = category(PLENUM[i], 1.0) * width
            take(work, at, at + width, m, own, 0, line, b)
    areas = E_AREAS + N_PLENUM
    for i in range(2 * N_GAPS):
        area = E[areas + i]
        if area > 0.0:
            b = areas + 2 * N_GAPS + (2 * GAP_OFFSET[i // 2] + i % 2) * SIDE
            m = gap_flow(i // 2, area, own, 0, E, b, P)
            inward, outward = gap_category(E, b, 1.0) * width, gap_category(E, b, -1.0) * width
            take(work, inward, outward, m, own, 0, E, b)
            if FILMED == 1:
                q = film_flow(i // 2, area, own, 0, E, b, P)
                take_film(work, inward, outward, q, own, 0, E, b)
    if PORTED == 1:
        oil = oil_inflow(E[E_ANGLE], own[PRESSURE], P, TAB)
        work[PORT_OIL * width + STREAM_OIL] = oil
        work[PORT_OIL * width + STREAM_OIL_HEAT] = oil * P[P_H_PORT]
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
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
    fill_place(FREE, y, 0, P, TAB, own, 0)
    for i in range(N_PLENUM):
        out[i] = 0.0
        if E[E_AREAS + i] > 0.0:
            line, b = line_place(PLENUM[i], R, E, E_LINES)
            out[i] = port_flow(i, E[E_AREAS + i], own, 0, line, b, P)
            if OPENED == 1:
                own[OPENING + i] = open_share(i, y, own, line, b, LOOSE, P)
                out[i] *= own[OPENING + i]
    areas = E_AREAS + N_PLENUM
    for i in range(2 * N_GAPS):
        b = areas + 2 * N_GAPS + (2 * GAP_OFFSET[i // 2] + i % 2) * SIDE
        out[N_PLENUM + i] = gap_flow(i // 2, E[areas + i], own, 0, E, b, P) if E[areas + i] > 0.0 else 0.0


@kernel
def film_flows(y, E, context, out):
    """Fill `out` with the oil [kg/s] that flows into the chamber as films: each gap ahead and behind (M252)."""
    P, TAB, own = context.P, context.TAB, context.own
    fill_place(FREE, y, 0, P, TAB, own, 0)
    areas = E_AREAS + N_PLENUM
    for i in range(2 * N_GAPS):
        b = areas + 2 * N_GAPS + (2 * GAP_OFFSET[i // 2] + i % 2) * SIDE
        out[i] = film_flow(i // 2, E[areas + i], own, 0, E, b, P) if E[areas + i] > 0.0 else 0.0
