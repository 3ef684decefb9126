"""What the integrator asks of one chamber between its steps: knots, errors, phases, the mass balance, jumps.

Source: docs/model.md M9, M30; docs/explanation/numerics.md.
"""

from __future__ import annotations

from screwsim.model.places import IMPOSSIBLE, fill_place, relative_error, share_before_border
from screwsim.model.room import density_of, displaced, gas_mass, locked
from screwsim.model.slots import (
    CARRIED,
    CATEGORIES,
    E_AREAS,
    E_VOLUME,
    FIRST_OWN,
    HEATED,
    N_PLENUM,
    OILED,
    OPENED,
    OWN_PLENUMS,
    P_INJECTION,
    P_T_OIL,
    P_TO_RATIO,
    P_TRAPPED,
    PLACE,
    PLENUM,
    PORTED,
    PRESSURE,
    PUMPED,
    Q_STREAMS,
    R_DISCHARGE,
    R_INJECTED,
    R_OIL_BEFORE,
    R_PRESSURE,
    R_RATIO,
    R_TRAPPED,
    S_RHO,
    S_T_OIL,
    S_X_OIL,
    STOPS,
    SUCTION_IN,
    TPT,
    VOLUMED,
    WIDTH,
    gas_state,
    injected_oil,
    volume_at,
)
from screwsim.model.stops import begin, put_within, share_before_event, take_event
from screwsim.model.streams import add_stream
from screwsim.model.valve import held_share, share_before_switch
from screwsim.numerics.kernel import kernel


@kernel
def inject(y, at, P, TAB, R):
    """Let the oil in at the injection angle, and note what is there: trapped mass, pressure, oil (M9, M30)."""
    m = y[at + S_RHO] * volume_at(P[P_INJECTION], P, TAB)
    if VOLUMED == 1:
        m = gas_mass(volume_at(P[P_INJECTION], P, TAB), y[at + S_RHO], y[at + S_X_OIL], P)
    p, _h, _c, _t, _a, _x, _f = gas_state(y[at], y[at + S_RHO], P, TAB)
    R[R_TRAPPED] = m
    R[R_PRESSURE] = p
    if OILED == 0:
        return
    if PUMPED == 1:
        P[P_TRAPPED] = m
    if PORTED == 1:
        R[R_RATIO] = y[at + S_X_OIL]
        R[R_OIL_BEFORE] = y[at + S_X_OIL] * m
        return
    offered = injected_oil(p, m, P)
    before = y[at + S_X_OIL] * m if CARRIED == 1 else 0.0
    R[R_OIL_BEFORE] = before
    R[R_INJECTED] = max(0.0, offered - before) if P[P_TO_RATIO] > 0.0 else offered
    R[R_RATIO] = (before + R[R_INJECTED]) / m
    if VOLUMED == 1:
        displaced(y, at, m, volume_at(P[P_INJECTION], P, TAB), before, R[R_INJECTED], P, TAB, R)
        y[at + S_X_OIL] = (before + R[R_INJECTED]) / m
        return
    if CARRIED == 1:
        total = before + R[R_INJECTED]
        if total > 0.0:
            y[at + S_T_OIL] = (before * y[at + S_T_OIL] + R[R_INJECTED] * P[P_T_OIL]) / total
        y[at + S_X_OIL] = total / m
    elif HEATED == 1:
        y[at + S_T_OIL] = P[P_T_OIL]


@kernel
def at_knot(phi, y, context):
    """Apply the jump at a knot of the chamber's life: oil is injected at its angle."""
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
    if abs(phi - P[P_INJECTION]) < 1e-9:
        inject(y, 0, P, TAB, R)
    if STOPS > 0 and phi == 0.0:
        begin(y, own, R, P, TAB)


@kernel
def error_size(y0, y1, error, context):
    """Return the size of a step's error; the place of the last stage is that of y1 all but for the error itself."""
    P, own = context.P, context.own
    if VOLUMED == 1 and locked(y1, 0, P):
        return IMPOSSIBLE
    return relative_error(y0, y1, error, 0, own, 0)


@kernel
def share_in_phase(y, y1, u, rtol, context):
    """Return the share of a step after which the gas leaves its phase (`places.share_before_border`)."""
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
    if OPENED == 1:
        switched = share_before_switch(y, y1, u, R, P, TAB, own)
        if switched < 1.0:
            return switched
    if STOPS > 0:
        share = share_before_event(y, y1, u, rtol, own, R, P, TAB)
        if share < 1.0:
            return share
    return share_before_border(own[PLACE], y, y1, u, 0, own[TPT] / own[PRESSURE], rtol)


@kernel
def conserve(y, y1, E, E_next, context, dq):
    """Close the step's mass balance: by the flow through the widest open port, else by the density.

    A wide port holds p to the plenum's by a tiny Δp, whose quadrature carries the error of the whole state; the change
    of ρV over the step does not. Where no port is open the flows are smooth, and it is ρV that follows them.
    """
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
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
    defect = y1[S_RHO] * E_next[E_VOLUME] - y[S_RHO] * E[E_VOLUME]
    if VOLUMED == 1:
        defect = gas_mass(E_next[E_VOLUME], y1[S_RHO], y1[S_X_OIL], P) - gas_mass(E[E_VOLUME], y[S_RHO], y[S_X_OIL], P)
    for c in range(CATEGORIES):
        defect -= dq[Q_STREAMS + c * width]
    if widest == 0.0:
        if VOLUMED == 0:
            y1[S_RHO] -= defect / E_next[E_VOLUME]
        else:
            m = gas_mass(E_next[E_VOLUME], y1[S_RHO], y1[S_X_OIL], P) - defect
            y1[S_RHO] = density_of(m, E_next[E_VOLUME], y1[S_X_OIL], P)
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
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
    return take_event(y, rtol, own, R, P, TAB)
