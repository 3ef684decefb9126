"""What the integrator calls for all chambers at once between its steps, as text: errors, phases, the mass balance.

Source: docs/model.md M24; docs/explanation/integrator.md. Chamber j has its states at y[j N], its port state in row j.
"""

from collections.abc import Sequence

from screwsim.model.network.layout import Layout
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, function, writes
from screwsim.model.network.steps import closing_test, exchanged, stiff_test
from screwsim.model.slots import FIRST_OWN

BEFORE = "(j + 0.5) * P[P_PITCH] < P[P_INJECTION]"  # test for chamber j being before the injection angle
HELD = "port_states[(CHAMBERS + 1) * PORT_STATE + j]"  # the phase in which chamber j is held during a step
CONTEXT = "P, TAB, R, port_states = context.P, context.TAB, context.R, context.port_states"


def step_texts_together(network: Network) -> list[str]:
    """Return the functions that the integrator calls for all chambers."""
    nothing = [
        function(head, ["pass"])
        # the only jump, oil injection, is at the border between two pitches; port states are filled when the pitch
        # becomes a life (`port_states.port_states_along`)
        for head in ("chambers__at_breakpoint(phi, y, context)", "chambers__keep_port_states(step, dense, context)")
    ]
    jump = function("chambers__jump(y, rtol, context)", ["return True"])
    own = [_error_size(network), _share_in_phase(network), _lands(network), _through_port(network), _conserve(network)]
    return [*own, *nothing, jump]


@writes("chambers__error_size(y0, y1, error, context)")
def _error_size(to: Statements, network: Network) -> None:
    """Return the largest relative error of the states of all chambers over a step."""
    to.add("worst = 0.0")
    with to.within("for j in range(CHAMBERS)"):
        error = "chamber__error(y0, y1, error, j * N, context.port_states, j * PORT_STATE, context.P)"
        to.add(f"worst = max(worst, {error})")
    to.add("return worst")


@writes("chambers__share_in_phase(y, y1, u, rtol, context)", CONTEXT)
def _share_in_phase(to: Statements, network: Network) -> None:
    """Return the share of a step that holds: up to the first border of the phases that a chamber meets."""
    to.add("share = 1.0")
    if network.phases:
        with to.within("for j in range(CHAMBERS)"):
            to.add("steep = port_states[j * PORT_STATE + TPT] / port_states[j * PORT_STATE + PRESSURE]")
            to.add(f"held = {HELD}")
            to.add("share = min(share, borders__share_before_border(held, y, y1, u, j * N, steep, rtol, P, TAB))")
    to.add("return share")


@writes("chambers__conserve(y, y1, E, E_next, context, dq)", CONTEXT)
def _conserve(to: Statements, network: Network) -> None:
    """Close the mass balances of a step: on the side of the suction, then on that of the discharge (M1)."""
    # by flows through ports, as in one chamber; chambers before the injection angle are the suction side
    suction, discharge, *others = filter(None, network.cells)
    to.add("crossing = dq[Q_crossing]")
    _close_side(to, network, suction, BEFORE, "- crossing", [])
    # the crossing gas includes flows from own plenums to the suction side
    own = [f"Q_mass_{cell}_{way}" for cell in others for way in ("in", "out")]
    _close_side(to, network, discharge, f"not ({BEFORE})", "+ crossing", own)


def _close_side(to: Statements, network: Network, line: str, test: str, crossing: str, own: Sequence[str]) -> None:
    """Close the mass balance of the chambers on the side of a line by the flow through the widest of their ports."""
    layout = Layout(network)
    to.add(*exchanged(line), "widest = 0.0", "open_one = 0")
    to.add(f"defect = -dq[inward] - dq[outward] {crossing}", *(f"defect -= dq[{each}]" for each in own))
    with to.within("for j in range(CHAMBERS)"), to.within(f"if {test}"):
        to.add("e = j * E_CHAMBER")
        gas = [f"chamber__gas({E}[e + E_VOLUME], {y}, j * N, P)" for E, y in (("E_next", "y1"), ("E", "y"))]
        to.add(f"defect += {gas[0]} - {gas[1]}")  # small terms first
        for port in network.ports:
            if port.cell == line or (network.across and port.number < FIRST_OWN):
                at = f"[e + {layout.area(port)}]"
                to.add(f"area = E{at} + E_next{at}")
                with to.within("if area > widest"):
                    to.add("widest = area", "open_one = j", *exchanged(port.cell))
    with to.within("if widest > 0.0"):
        to.add("chambers__through_port(defect, open_one, inward, outward, line, y1, context, dq)")


@writes("chambers__through_port(defect, j, inward, outward, line, y1, context, dq)", CONTEXT)
def _through_port(to: Statements, network: Network) -> None:
    """Add what a mass balance lacks to the stream from a line into chamber j, or out of it to that line."""
    with to.within("if dq[inward] + dq[outward] >= 0.0"):
        to.add("chamber__into(dq, inward, defect, R, line)")
    with to.within("else"):
        to.add(f"held = {HELD}", "row = j * PORT_STATE")
        to.add(
            "chamber__port_state(held, y1, j * N, P, TAB, port_states, row)",
            "chamber__into(dq, outward, defect, port_states, row)",
        )


@writes("chambers__lands(h, J, E, E_end, context)")
def _lands(to: Statements, network: Network) -> None:
    """Tell whether a step may end where the segment does, for all chambers."""
    layout = Layout(network)
    if network.ports:
        with to.within("for j in range(CHAMBERS)"):
            to.add("e = j * E_CHAMBER", "own = j * N")
            closing, too_long = closing_test(layout, network, "e + "), stiff_test(network, "own + ")
            with to.within(f"if ({closing}) and ({too_long})"):
                to.add("return False")
    to.add("return True")
