"""Flows through openings, each stated once: what chambers one by one, all chambers and the ledger take from here.

Source: docs/model.md M10–M13, M184–M186, M190, M250–M252. A flow [kg/s] is positive into the chamber whose place stands
at own[a], and comes from the place at beyond[b], or goes there.
"""

from __future__ import annotations

from screwsim.model.film import add_film, film_flow
from screwsim.model.slots import (
    OPENED,
    P_GAP_WIDTH,
    P_PORT_WIDTH,
    PLENUM,
    PRESSURE,
    PULSATING,
    R_DISCHARGE,
    RESISTED,
    path_opening,
)
from screwsim.model.streams import add_stream, held_back, held_slopes, place_flow, place_slopes
from screwsim.numerics.kernel import kernel


@kernel
def line_place(line, R, E, at):
    """Return where the place of a line or plenum stands: in R, or where the lines pulsate in E from `at` on (M184)."""
    if PULSATING == 1:
        return E, at + R_DISCHARGE * line
    return R, R_DISCHARGE * line


@kernel
def port_flow(i, area, own, a, beyond, b, P):
    """Return the flow through plenum path i as if it were open (M12)."""
    return place_flow(area, own, a, beyond, b, P[P_PORT_WIDTH + PLENUM[i]])


@kernel
def open_share(i, y, own, beyond, b, held, P):
    """Return how far plenum path i of one chamber is open by its state; `held` is the switch of a one-way path."""
    if OPENED == 1:
        return path_opening(i, beyond[b + PRESSURE] - own[PRESSURE], P[P_PORT_WIDTH + PLENUM[i]], held, y, 0, P)
    return 1.0


@kernel
def gap_flow(i, area, own, a, beyond, b, P):
    """Return the flow through gap i: that of a nozzle (M12), less where the gap holds it back (M190)."""
    m = place_flow(area, own, a, beyond, b, P[P_GAP_WIDTH])
    if RESISTED == 1:
        m = held_back(i, m, area, own, a, beyond, b, P)
    return m


@kernel
def port_flow_slopes(i, own, a, beyond, b, P):
    """Return flow and slopes of plenum path i, as `gap_flow_slopes` does for gaps; its opening is left aside."""
    m, p_1, rho_1, p_2, rho_2 = place_slopes(1.0, own, a, beyond, b, P[P_PORT_WIDTH + PLENUM[i]])
    return m, p_1, rho_1, p_2, rho_2, 0.0, 0.0


@kernel
def gap_flow_slopes(i, own, a, beyond, b, P):
    """Return the flow of gap i per unit area, and its slopes by p and ρ here and beyond, by oil per gas likewise."""
    m, p_1, rho_1, p_2, rho_2 = place_slopes(1.0, own, a, beyond, b, P[P_GAP_WIDTH])
    if RESISTED == 1:
        return held_slopes(i, m, p_1, rho_1, p_2, rho_2, own, a, beyond, b, P)
    return m, p_1, rho_1, p_2, rho_2, 0.0, 0.0


@kernel
def take(sums, inward, outward, m, own, a, beyond, b):
    """Add a flow, with the state of the place that it comes from, to the sums of one category or the other.

    Each way has an index of its own: one that hangs on the flow's sign would keep the sums out of registers.
    """
    if m >= 0.0:
        add_stream(sums, inward, m, beyond, b)
    else:
        add_stream(sums, outward, m, own, a)


@kernel
def take_film(sums, inward, outward, q, own, a, beyond, b):
    """Add oil that flows as a film, with the temperature where it comes from, to one category or the other (M252)."""
    if q >= 0.0:
        add_film(sums, inward, q, beyond, b)
    else:
        add_film(sums, outward, q, own, a)


@kernel
def between(sums, here, there, m, places, own, ahead):
    """Add a flow between two chambers to the sums of both: what enters one leaves the other."""
    source = ahead if m >= 0.0 else own
    add_stream(sums, here, m, places, source)
    add_stream(sums, there, -m, places, source)


@kernel
def film_between_chambers(sums, here, there, i, area, places, own, ahead, P):
    """Add the film of gap i between two chambers to the sums of both."""
    q = film_flow(i, area, places, own, places, ahead, P)
    source = ahead if q >= 0.0 else own
    add_film(sums, here, q, places, source)
    add_film(sums, there, -q, places, source)
