"""What the integrator asks of all chambers at once between its steps: errors, phases, the mass balance.

Source: docs/model.md M24; docs/explanation/numerics.md.
"""

from __future__ import annotations

from screwsim.model.coupled import side_of
from screwsim.model.places import IMPOSSIBLE, fill_place, relative_error, share_before_border
from screwsim.model.room import gas_mass, locked
from screwsim.model.slots import (
    ACROSS,
    CATEGORIES,
    CHAMBERS,
    E_AREAS,
    E_VOLUME,
    FIRST_OWN,
    N_GAPS,
    N_PLENUM,
    OWN_PLENUMS,
    PLACE,
    PLENUM,
    PRESSURE,
    Q_STREAMS,
    R_DISCHARGE,
    S_RHO,
    S_X_OIL,
    SUCTION_IN,
    TPT,
    VOLUMED,
    WIDTH,
    N,
)
from screwsim.model.streams import add_stream
from screwsim.numerics.kernel import kernel


@kernel
def no_knot(phi, y, context):
    """Leave the states alone: the only jump, oil injection, lies at the border between two pitches."""


@kernel
def all_error_size(y0, y1, error, context):
    """Return the size of a step's error, the largest of all chambers."""
    P, places = context.P, context.places
    worst = 0.0
    if VOLUMED == 1:
        for j in range(CHAMBERS):
            if locked(y1, j * N, P):
                return IMPOSSIBLE
    for j in range(CHAMBERS):
        worst = max(worst, relative_error(y0, y1, error, j * N, places, j * PLACE))
    return worst


@kernel
def all_share_in_phase(y, y1, u, rtol, context):
    """Return the share of a step after which the first chamber leaves its phase (`places.share_before_border`)."""
    places = context.places
    share = 1.0
    for j in range(CHAMBERS):
        held = places[(CHAMBERS + 1) * PLACE + j]
        steep = places[j * PLACE + TPT] / places[j * PLACE + PRESSURE]
        share = min(share, share_before_border(held, y, y1, u, j * N, steep, rtol))
    return share


@kernel
def all_conserve(y, y1, E, E_next, context, dq):
    """Let the mass balances of a step set the flows through the ports, as `chamber_steps.conserve` does.

    Chambers before the injection angle are the suction side, the others the discharge side.
    """
    P, TAB, R, places = context.P, context.TAB, context.R, context.places
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    crossing = dq[Q_STREAMS + CATEGORIES * width]
    for side in range(2):
        at = Q_STREAMS + (SUCTION_IN + 2 * side) * width
        defect = -dq[at] - dq[at + width] - (crossing if side == 0 else -crossing)
        if OWN_PLENUMS > 0 and side == 1:  # what crosses holds what comes from own plenums to the suction side
            for c in range(2 * FIRST_OWN, CATEGORIES):
                defect -= dq[Q_STREAMS + c * width]
        widest = 0.0
        open_one = 0
        if ACROSS == 1:
            line = side
        for j in range(CHAMBERS):
            if side_of(j, P) == side:
                e = j * size
                if VOLUMED == 0:
                    defect += y1[j * N + S_RHO] * E_next[e + E_VOLUME] - y[j * N + S_RHO] * E[e + E_VOLUME]
                else:
                    defect += gas_mass(E_next[e + E_VOLUME], y1[j * N + S_RHO], y1[j * N + S_X_OIL], P)
                    defect -= gas_mass(E[e + E_VOLUME], y[j * N + S_RHO], y[j * N + S_X_OIL], P)
                for i in range(N_PLENUM):
                    area = E[e + E_AREAS + i] + E_next[e + E_AREAS + i]
                    if PLENUM[i] == side and area > widest:
                        widest = area
                        open_one = j
                        if ACROSS == 1:
                            line = side
                    if ACROSS == 1 and PLENUM[i] == 1 - side and area > widest:
                        widest = area
                        open_one = j
                        line = 1 - side
        if ACROSS == 1:
            at = Q_STREAMS + (SUCTION_IN + 2 * line) * width  # pyright: ignore[reportPossiblyUnboundVariable]
        if widest > 0.0:
            if dq[at] + dq[at + width] >= 0.0:
                if ACROSS == 0:
                    add_stream(dq, at, defect, R, R_DISCHARGE * side)
                if ACROSS == 1:
                    b = R_DISCHARGE * line  # pyright: ignore[reportPossiblyUnboundVariable]
                    add_stream(dq, at, defect, R, b)
            else:
                fill_place(
                    places[(CHAMBERS + 1) * PLACE + open_one], y1, open_one * N, P, TAB, places, open_one * PLACE
                )
                add_stream(dq, at + width, defect, places, open_one * PLACE)


@kernel
def no_places(step, dense, context):
    """Leave the places: they are filled when the pitch becomes a life (`places.places_along`)."""
