"""Surroundings of chambers: what depends on the angle alone, and of one among neighbours what these do.

Source: docs/model.md M1–M13, M24. What neighbours do is read from histories: those ahead from the last turn, those
behind from the turn being integrated, which has passed their angle already. Of all chambers together, over one lobe
pitch, chamber j stands at s + j pitch. A context is one of `contexts`.
"""

from __future__ import annotations

from screwsim.model.places import angle_terms, read_neighbour
from screwsim.model.slots import (
    CHAMBERS,
    E_AREAS,
    GAP_OFFSET,
    N_GAPS,
    N_OFFSETS,
    N_PLENUM,
    OFFSETS,
    P_LIFE,
    P_PITCH,
    PLACE,
    all_lines_at,
    beyond_last,
    gap_area,
    lines_at,
)
from screwsim.numerics.kernel import kernel

SIDE = PLACE + 1  # a neighbour in E: its place, and whether it is the discharge plenum


@kernel
def around_chamber(phi, middle, context, E):
    """Fill E for a chamber at phi: own angle terms, areas of all gaps on both sides, places of the neighbours."""
    P, TAB, R, kept, hints, state = context.P, context.TAB, context.R, context.kept, context.hints, context.state
    t_old, d_old, t_new, d_new = context.t_old, context.d_old, context.t_new, context.d_new
    angle_terms(phi, middle, P, TAB, E, 0)
    areas = E_AREAS + N_PLENUM
    sides = areas + 2 * N_GAPS
    lines_at(phi, P, R, E)
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
                beyond_last(R, E, at)
            else:
                read_neighbour(phi + shift, middle + shift, t_old, d_old, kept[1], hints, 2 * o, P, R, state, E, at)
        at += SIDE
        if behind > 0.0:
            if kept[0] > 0 and t_new[kept[0]] >= phi - shift:
                read_neighbour(phi - shift, middle - shift, t_new, d_new, kept[0], hints, 2 * o + 1, P, R, state, E, at)
            else:
                read_neighbour(phi - shift, middle - shift, t_old, d_old, kept[1], hints, 2 * o + 1, P, R, state, E, at)


@kernel
def around_chambers(s, middle, context, E):
    """Fill E for all chambers, the first at angle s: angle terms and, for the trailing side, areas of the gaps."""
    P, TAB, R = context.P, context.TAB, context.R
    size = E_AREAS + N_PLENUM + N_GAPS
    for j in range(CHAMBERS):
        phi = s + j * P[P_PITCH]
        angle_terms(phi, middle + j * P[P_PITCH], P, TAB, E, j * size)
        for i in range(N_GAPS):
            E[j * size + E_AREAS + N_PLENUM + i] = gap_area(i, phi, P, TAB)
    all_lines_at(s, P, R, E)
