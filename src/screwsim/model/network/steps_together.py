"""What the integrator asks of all chambers at once between its steps, as text: errors, phases, the mass balance.

Source: docs/model.md M24; docs/explanation/numerics.md. Chamber j has its states at y[j N], its place in row j.
"""

from __future__ import annotations

from screwsim.model.network.balances import heads
from screwsim.model.network.cell import Cell
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, function
from screwsim.model.slots import FIRST_OWN

SIDE = "0 if (j + 0.5) * P[P_PITCH] < P[P_INJECTION] else 1"  # of chamber j: before the injection angle, or beyond it
CONTEXT = "P, TAB, R, places = context.P, context.TAB, context.R, context.places"


def step_texts_together(network: Network) -> list[str]:
    """Return the functions that the integrator asks of all chambers."""
    nothing = [
        function(head, ["pass"])
        # the only jump, oil injection, lies at the border between two pitches; places are filled when the pitch becomes
        # a life (`places.places_along`)
        for head in ("chambers__at_breakpoint(phi, y, context)", "chambers__keep_places(step, dense, context)")
    ]
    jump = function("chambers__jump(y, rtol, context)", ["return True"])
    return [_error_size(network), _share_in_phase(network), _conserve(network), *nothing, jump]


def held_phase(network: Network, j: str) -> str:
    """Return where the phase stands that chamber j is held in during a step."""
    return f"places[{network.chambers + 1} * PLACE + {j}]"


def _error_size(network: Network) -> str:
    """Return the text of a step's error, the largest of all chambers."""
    to, n = Statements(), len(network.states)
    to.add("worst = 0.0")
    with to.within(f"for j in range({network.chambers})"):
        error = f"chamber__error(y0, y1, error, j * {n}, context.places, j * PLACE, context.P)"
        to.add(f"worst = max(worst, {error})")
    to.add("return worst")
    return function("chambers__error_size(y0, y1, error, context)", to.lines)


def _share_in_phase(network: Network) -> str:
    """Return the text of the share of a step after which the first chamber leaves its phase."""
    to, n = Statements(), len(network.states)
    to.add("share = 1.0")
    if network.phases:
        with to.within(f"for j in range({network.chambers})"):
            to.add("steep = places[j * PLACE + TPT] / places[j * PLACE + PRESSURE]")
            to.add(f"held = {held_phase(network, 'j')}")
            to.add(f"share = min(share, borders__share_before_border(held, y, y1, u, j * {n}, steep, rtol, P, TAB))")
    to.add("return share")
    return function("chambers__share_in_phase(y, y1, u, rtol, context)", [CONTEXT], to.lines)


def _conserve(network: Network) -> str:
    """Return the text that lets the mass balances of a step set the flows through the ports, as in one chamber.

    Chambers before the injection angle are the suction side, the others the discharge side.
    """
    to, cell, n, width = Statements(), Cell(network), len(network.states), len(network.quantities)
    first, categories = len(heads(network)), len(cell.sums)
    to.add(f"crossing = dq[{first + categories * width}]")
    with to.within("for side in range(2)"):
        to.add(f"at = {first} + 2 * side * {width}", "line = side", "widest = 0.0", "open_one = 0")
        to.add(f"defect = -dq[at] - dq[at + {width}] - (crossing if side == 0 else -crossing)")
        if categories > 2 * FIRST_OWN:  # what crosses holds what comes from own plenums to the suction side
            with to.within("if side == 1"):
                to.add(*(f"defect -= dq[{first + c * width}]" for c in range(2 * FIRST_OWN, categories)))
        with to.within(f"for j in range({network.chambers})"), to.within(f"if ({SIDE}) == side"):
            to.add(f"e = j * (E_AREAS + {len(network.ports) + len(network.gaps)})")
            gas = [f"chamber__gas({E}[e + E_VOLUME], {y}, j * {n}, P)" for E, y in (("E_next", "y1"), ("E", "y"))]
            to.add(f"defect += {gas[0]} - {gas[1]}")  # first what is small
            for port in network.ports:
                if port.number < FIRST_OWN:
                    to.add(f"area = E[e + E_AREAS + {port.index}] + E_next[e + E_AREAS + {port.index}]")
                    here = "" if network.across else f"side == {port.number} and "
                    with to.within(f"if {here}area > widest"):
                        to.add("widest = area", "open_one = j", f"line = {port.number}")
        with to.within("if widest > 0.0"):
            to.add(f"at = {first} + 2 * line * {width}")
            with to.within(f"if dq[at] + dq[at + {width}] >= 0.0"):
                to.add("chamber__into(dq, at, defect, R, line * PLACE)")
            with to.within("else"):
                to.add(f"held = {held_phase(network, 'open_one')}", "row = open_one * PLACE")
                to.add(f"chamber__place(held, y1, open_one * {n}, P, TAB, places, row)")
                to.add(f"chamber__into(dq, at + {width}, defect, places, row)")
    return function("chambers__conserve(y, y1, E, E_next, context, dq)", [CONTEXT], to.lines)
