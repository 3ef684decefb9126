"""What the integrator calls for a chamber between its steps, as text: errors, jumps, borders, the mass balance.

Source: docs/model.md M9, M30, M104–M110; docs/explanation/integrator.md.
"""

from screwsim.model.borders import (
    closes,
    share_before_border,
    share_before_flash,
    share_before_switch,
    share_while_steep,
    stiff,
)
from screwsim.model.network.cell import Cell
from screwsim.model.network.flows import NUMBERS, PortState, stream_terms
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, writes
from screwsim.model.network.stops import stop_texts
from screwsim.model.oil_displacement import density_of, displaced, gas_mass_slope, locked
from screwsim.model.port_states import IMPOSSIBLE, NO_OIL, SHARP, SOME_GAS, SOME_OIL, relative
from screwsim.numerics.kernel import Kernel
from screwsim.numerics.rodas import dense_slope

CONTEXT = "P, TAB, R, own = context.P, context.TAB, context.R, context.own"


def step_texts(network: Network) -> list[str]:
    """Return the functions that the integrator calls for one chamber, and those that both drivers share."""
    own = (_error, _error_size, _lands, _inject, _at_breakpoint, _share_in_phase, _into, _conserve, _jump)
    return [*(text(network) for text in own), *stop_texts(network)]


def step_kernels(network: Network) -> list[Kernel]:
    """Return the kernels that those functions call, and those of port states and of gas between two steps."""
    asked = {share_before_border: network.phases, share_before_flash: network.flash is not None}
    asked |= dict.fromkeys((share_before_switch, share_while_steep), any(port.one_way for port in network.ports))
    asked |= dict.fromkeys((density_of, displaced, locked, gas_mass_slope), network.roomed)
    return [relative, dense_slope, closes, stiff, *(each for each, wanted in asked.items() if wanted)]


# ---- errors ----------------------------------------------------------------------------------------------------------


@writes("chamber__error(y0, y1, error, at, port_state, row, P)")
def _error(to: Statements, network: Network) -> None:
    """Return the largest relative error of a chamber's states; huge for states that cannot be."""
    # The error is relative, except for very little oil. In the dome p follows T by 7:1 and more, and flows follow p:
    # the error of T counts as that of the resulting pressure, at fixed density, where that is larger (for an ideal
    # gas they are equal). Negative T, ρ or oil ratio must be rejected explicitly: they would pass where they are
    # small beside the value before the step, and a negative oil ratio is unstable.
    own = dict(zip(network.own_states, network.positive, strict=True))
    positive = dict.fromkeys(("T", "rho", "T_oil"), True) | own
    if network.roomed:
        with to.within("if oil_displacement__locked(y1, at, P)"):
            to.add(f"return {IMPOSSIBLE!r}")
    to.add("worst = 0.0")
    if network.carried:
        to.add(f"some_oil = min(1.0, max(abs(y0[at + S_x_oil]), abs(y1[at + S_x_oil])) / {SOME_OIL!r})")
    scales = {"x_oil": SOME_OIL, "w_gas": SOME_GAS} | {name: SHARP for name in own if not own[name]}
    for name in network.states:
        error, before, after = (f"{array}[at + S_{name}]" for array in ("error", "y0", "y1"))
        to.add(f"e = {relative.flat_name}({error}, {before}, {after}, {scales.get(name, 1e-300)!r})")
        if name == "T":
            to.add("e *= max(1.0, port_state[row + TPT] / port_state[row + PRESSURE])")
        if name == "T_oil" and network.carried:
            to.add("e *= some_oil")
        if name == "w_gas":
            to.add(f"e = max(e * some_oil, abs({error} * y1[at + S_x_oil]))")
        with to.within("if not (e <= worst)"):
            to.add("worst = e")
        with to.within("if e != e"):
            to.add(f"return {IMPOSSIBLE!r}")
    possible = [f"y1[at + S_{name}] > 0.0" for name in network.states if positive.get(name)]
    if network.carried:
        possible.append(f"y1[at + S_x_oil] > {-NO_OIL!r}")
    with to.within(f"if not ({' and '.join(possible)})"):
        to.add(f"return {IMPOSSIBLE!r}")
    to.add("return worst")


@writes("chamber__error_size(y0, y1, error, context)")
def _error_size(to: Statements, network: Network) -> None:
    """Return the largest relative error of the states over a step."""
    to.add("return chamber__error(y0, y1, error, 0, context.own, 0, context.P)")  # `own` is that of the last stage


@writes("chamber__lands(h, J, E, E_end, context)")
def _lands(to: Statements, network: Network) -> None:
    """Tell whether a step may end where the segment does: not along a port that closes, where it is stiff."""
    layout = Layout(network)
    if network.ports:
        with to.within(f"if {closing_test(layout, network, '')}"), to.within(f"if {stiff_test(network, '')}"):
            to.add("return False")
    to.add("return True")


def closing_test(layout: Layout, network: Network, e: str) -> str:
    """Return a test for a port closing along a step; the chamber's surroundings begin at E[e]."""
    areas = [f"[{e}{layout.area(port)}]" for port in network.ports]
    return " or ".join(f"{closes.flat_name}(E{at}, E_end{at})" for at in areas)


def stiff_test(network: Network, own: str) -> str:
    """Return a test for a step being too long for what is left; the chamber's states begin at `own`."""
    return " or ".join(f"{stiff.flat_name}(h, J[{own}S_{name}, {own}S_{name}])" for name in network.states)


# ---- jumps and borders -----------------------------------------------------------------------------------------------


@writes("chamber__inject(y, at, P, TAB, R)")  # M9, M30, M104, M110
def _inject(to: Statements, network: Network) -> None:
    """Let the oil in at the injection angle, and note trapped gas, its pressure, and the oil."""
    before = "0.0"
    to.add("V = volume_at(P[P_INJECTION], P, TAB)", "m = chamber__gas(V, y, at, P)")
    to.add("p, _h, _c_v, _TpT, _exponent, _choke, _choked = gas_state(y[at + S_T], y[at + S_rho], P, TAB)")
    to.add("R[R_TRAPPED] = m", "R[R_PRESSURE] = p")
    if network.inflow is not None and network.inflow.pumped:
        to.add("P[P_TRAPPED] = m")
    if network.carried:
        before = "y[at + S_x_oil] * m"
    if network.ported:
        to.add("R[R_RATIO] = y[at + S_x_oil]", f"R[R_OIL_BEFORE] = {before}")
    elif network.supplied:
        to.add("offered = injected_oil(p, m, P)", f"before = {before}", "R[R_OIL_BEFORE] = before")
        to.add("injected = max(0.0, offered - before) if P[P_TO_RATIO] > 0.0 else offered", "R[R_INJECTED] = injected")
        to.add("total = before + injected", "R[R_RATIO] = total / m")
        if network.roomed:
            to.add(
                "oil_displacement__displaced(y, at, m, V, before, injected, P, TAB, R)", "y[at + S_x_oil] = total / m"
            )
        elif network.carried:
            with to.within("if total > 0.0"):
                to.add("y[at + S_T_oil] = (before * y[at + S_T_oil] + injected * P[P_T_OIL]) / total")
            to.add("y[at + S_x_oil] = total / m")
        elif network.heated:
            to.add("y[at + S_T_oil] = P[P_T_OIL]")


@writes("chamber__at_breakpoint(phi, y, context)", CONTEXT)
def _at_breakpoint(to: Statements, network: Network) -> None:
    """Let the state jump where it does: the oil comes at the injection angle (M9)."""
    with to.within("if abs(phi - P[P_INJECTION]) < 1e-9"):
        to.add("chamber__inject(y, 0, P, TAB, R)")
    if network.stops:
        with to.within("if phi == 0.0"):
            to.add("chamber__begin_modes(y, own, R, P, TAB)")


@writes("chamber__share_in_phase(y, y1, u, rtol, context)", CONTEXT)
def _share_in_phase(to: Statements, network: Network) -> None:
    """Return the share of a step that holds: up to a switch, an impact or a border of the phases."""
    layout = Layout(network)
    switched = any(port.one_way for port in network.ports)
    if switched:
        to.add("share = 1.0")
    for port in network.ports:
        if port.one_way:
            line, held = f"R[R_{port.cell} + PRESSURE]", layout.share(port, "HELD")
            ends = f"{port.one_way}, {line}, {port.width}, {held}, share"
            to.add(f"share = {share_before_switch.flat_name}({ends}, y, y1, u, P, TAB)")
            steep = f"{line}, {port.width}, {held}, share"
            to.add(f"share = {share_while_steep.flat_name}({steep}, y, y1, u, P, TAB)")
    tests = ["chamber__share_before_event(y, y1, u, rtol, own, R, P, TAB)"] if network.stops else []
    if network.phases:
        steep = "own[TPT] / own[PRESSURE]"
        tests.append(f"borders__share_before_border(own[PHASE], y, y1, u, 0, {steep}, rtol, P, TAB)")
    if not switched:
        to.add(f"share = {tests.pop(0) if tests else '1.0'}")
    for test in tests:
        with to.within("if share == 1.0"):
            to.add(f"share = {test}")
    if network.flash is not None:  # where oil flows in at either end: the bore's window ends on breakpoints
        with to.within("if share == 1.0 and own[FED_FIRST] + own[FED_LAST] > 0.0"):
            to.add(f"share = {share_before_flash.flat_name}({network.flash.begins}, y, y1, u, P, TAB)")
    to.add("return share")


@writes("chamber__jump(y, rtol, context)", CONTEXT)
def _jump(to: Statements, network: Network) -> None:
    """Let happen what is due between two steps; tell whether the integration may go on."""
    to.add(f"return {'chamber__take_event(y, rtol, own, R, P, TAB)' if network.stops else 'True'}")


# ---- the mass balance ------------------------------------------------------------------------------------------------


@writes("chamber__into(sums, at, m, source, s)")  # M1–M13
def _into(to: Statements, network: Network) -> None:
    """Add a stream of m [kg] of the port state at source[s] to sums, from sums[at] on (M10)."""
    terms = stream_terms(to, network, "m", PortState(*(f"source[s + {at}]" for at in NUMBERS.values())))
    to.add(*(f"sums[at + OF_{quantity}] += {term}" for quantity, term in terms.items()))


@writes("chamber__conserve(y, y1, E, E_next, context, dq)", CONTEXT)
def _conserve(to: Statements, network: Network) -> None:
    """Close the mass balance of a step: by the flow through the widest port, else by the density (M1)."""
    # A wide port holds p to the plenum's by a tiny Δp, whose quadrature carries the error of the whole state; the
    # change of ρV over the step does not. Where no port is open the flows are smooth, and ρV is made to follow them.
    layout, first = Layout(network), network.lines[0]
    opened = [port for port in network.ports if port.opening]
    if opened:
        _held_shares(to, network, "y", "share")
        _held_shares(to, network, "y1", "next")
    to.add("widest = 0.0", *exchanged(first))
    for port in network.ports:
        if port.wide:
            at, label = f"[{layout.area(port)}]", layout.label(port)
            shares = (f" * share_{label}", f" * next_{label}") if port in opened else ("", "")
            to.add(f"area = E{at}{shares[0]} + E_next{at}{shares[1]}")
            with to.within("if area > widest"):
                to.add("widest = area", *exchanged(port.cell))
    if network.stops:
        to.add("chamber__put_within(y1, own)")
    to.add("defect = chamber__gas(E_next[E_VOLUME], y1, 0, P) - chamber__gas(E[E_VOLUME], y, 0, P)")
    to.add(*(f"defect -= dq[Q_mass_{each}]" for each in Cell(network).sums))
    with to.within("if widest == 0.0"):
        if network.roomed:
            to.add("m = chamber__gas(E_next[E_VOLUME], y1, 0, P) - defect")
            to.add("y1[S_rho] = oil_displacement__density_of(m, E_next[E_VOLUME], y1[S_x_oil], P)")
        else:
            to.add("y1[S_rho] -= defect / E_next[E_VOLUME]")
        to.add("return")
    with to.within("if dq[inward] + dq[outward] >= 0.0"):
        to.add("chamber__into(dq, inward, defect, R, line)")
    with to.within("else"):
        to.add("chamber__port_state(own[PHASE], y1, 0, P, TAB, own, 0)")
        to.add("chamber__into(dq, outward, defect, own, 0)")


def exchanged(line: str) -> tuple[str, str, str]:
    """Return statements that set the sums of the streams in from a line and out to it, and its port state."""
    return f"inward = Q_mass_{line}_in", f"outward = Q_mass_{line}_out", f"line = R_{line}"


def _held_shares(to: Statements, network: Network, y: str, name: str) -> None:
    """Set the open share of each port whose opening depends on the state, for a chamber of state y.

    Fill its port state.
    """
    to.add(f"chamber__port_state(own[PHASE], {y}, 0, P, TAB, own, 0)")
    layout = Layout(network)
    for port in network.ports:
        if port.opening and port.wide:
            drop, held = f"R[R_{port.cell} + PRESSURE] - own[PRESSURE]", layout.share(port, "HELD")
            call = f"opening__{layout.label(port)}({drop}, {port.width}, {held}, {y}, 0, P)"
            to.add(f"{name}_{layout.label(port)} = {call}")
