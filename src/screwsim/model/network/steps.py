"""What the integrator asks of a chamber between its steps, as text: errors, jumps, borders, the mass balance.

Source: docs/model.md M9, M30, M104–M110; docs/explanation/numerics.md.
"""

from __future__ import annotations

from screwsim.model.borders import share_before_border, share_before_switch
from screwsim.model.impacts import begin, put_within, share_before_event, take_event
from screwsim.model.network.balances import heads
from screwsim.model.network.cell import Cell
from screwsim.model.network.flows import NUMBERS, Place, stream_terms
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, function
from screwsim.model.oil_displacement import density_of, displaced, gas_mass_slope, locked
from screwsim.model.places import IMPOSSIBLE, NO_OIL, SHARP, SOME_GAS, SOME_OIL, relative
from screwsim.model.pulsation import fill_lines
from screwsim.numerics.kernel import Kernel
from screwsim.numerics.rodas import dense_slope

CONTEXT = "P, TAB, R, own = context.P, context.TAB, context.R, context.own"


def step_texts(network: Network) -> list[str]:
    """Return the functions that the integrator asks of one chamber, and those that both drivers share."""
    return [
        *(_error(network), _error_size(), _inject(network), _at_breakpoint(network), _share_in_phase(network)),
        *(_into(network), _conserve(network), _jump(network)),
    ]


def step_kernels(network: Network) -> list[Kernel]:
    """Return what those functions call, and those of places and of gas between two steps."""
    asked = {
        share_before_border: network.phases,
        share_before_switch: any(port.one_way for port in network.ports),
        fill_lines: network.pulsating,
    }
    asked |= dict.fromkeys((density_of, displaced, locked, gas_mass_slope), network.roomed)
    asked |= dict.fromkeys((begin, put_within, share_before_event, take_event), network.stops > 0)
    return [relative, dense_slope, *(each for each, wanted in asked.items() if wanted)]


# ---- errors ----------------------------------------------------------------------------------------------------------


def _error(network: Network) -> str:
    """Return the text of the largest relative error of one chamber's states.

    Relative, but for next to no oil. In the dome p follows T by 7:1 and more, and flows follow p: the error of T counts
    as that of the pressure that it makes, at fixed density, where that is larger (for an ideal gas they are equal). A
    negative T, ρ or oil ratio would pass where it is small beside the value before the step, and oil less than none is
    unstable.
    """
    to, positive = Statements(), dict(zip(network.own_states, network.positive, strict=True))
    if network.roomed:
        with to.within("if oil_displacement__locked(y1, at, P)"):
            to.add(f"return {IMPOSSIBLE!r}")
    to.add("worst = 0.0")
    if network.carried:
        to.add(f"some_oil = min(1.0, max(abs(y0[at + 3]), abs(y1[at + 3])) / {SOME_OIL!r})")
    scales = {"x_oil": SOME_OIL, "w_gas": SOME_GAS} | {name: SHARP for name in positive if not positive[name]}
    for i, name in enumerate(network.states):
        to.add(f"e = places__relative(error[at + {i}], y0[at + {i}], y1[at + {i}], {scales.get(name, 1e-300)!r})")
        if name == "T":
            to.add("e *= max(1.0, place[row + TPT] / place[row + PRESSURE])")
        if name == "T_oil" and network.carried:
            to.add("e *= some_oil")
        if name == "w_gas":
            to.add(f"e = max(e * some_oil, abs(error[at + {i}] * y1[at + 3]))")
        with to.within("if not (e <= worst)"):
            to.add("worst = e")
        with to.within("if e != e"):
            to.add(f"return {IMPOSSIBLE!r}")
    possible = [f"y1[at + {i}] > 0.0" for i, name in enumerate(network.states) if _above_zero(name, positive)]
    if network.carried:
        possible.append(f"y1[at + 3] > {-NO_OIL!r}")
    with to.within(f"if not ({' and '.join(possible)})"):
        to.add(f"return {IMPOSSIBLE!r}")
    to.add("return worst")
    return function(
        "chamber__error(y0, y1, error, at, place, row, P)",
        ['"""Return the largest relative error of a chamber\'s states; huge for states that cannot be."""'],
        to.lines,
    )


def _above_zero(name: str, positive: dict[str, bool]) -> bool:
    return positive.get(name, name in ("T", "rho", "T_oil"))


def _error_size() -> str:
    """Return the text of a step's error; the place of the last stage is that of y1 all but for the error itself."""
    body = ["return chamber__error(y0, y1, error, 0, context.own, 0, context.P)"]
    return function("chamber__error_size(y0, y1, error, context)", body)


# ---- jumps and borders -----------------------------------------------------------------------------------------------


def _inject(network: Network) -> str:
    """Return the text that lets the oil in at the injection angle, and notes what is there (M9, M30, M104, M110)."""
    to, before = Statements(), "0.0"
    to.add("V = volume_at(P[P_INJECTION], P, TAB)", "m = chamber__gas(V, y, at, P)")
    to.add("p, _h, _c_v, _TpT, _exponent, _choke, _choked = gas_state(y[at], y[at + 1], P, TAB)")
    to.add("R[R_TRAPPED] = m", "R[R_PRESSURE] = p")
    if network.pumped:
        to.add("P[P_TRAPPED] = m")
    if network.carried:
        before = "y[at + 3] * m"
    if network.ported:
        to.add("R[R_RATIO] = y[at + 3]", f"R[R_OIL_BEFORE] = {before}")
    elif network.supplied:
        to.add("offered = injected_oil(p, m, P)", f"before = {before}", "R[R_OIL_BEFORE] = before")
        to.add("injected = max(0.0, offered - before) if P[P_TO_RATIO] > 0.0 else offered", "R[R_INJECTED] = injected")
        to.add("total = before + injected", "R[R_RATIO] = total / m")
        if network.roomed:
            to.add("oil_displacement__displaced(y, at, m, V, before, injected, P, TAB, R)", "y[at + 3] = total / m")
        elif network.carried:
            with to.within("if total > 0.0"):
                to.add("y[at + 2] = (before * y[at + 2] + injected * P[P_T_OIL]) / total")
            to.add("y[at + 3] = total / m")
        elif network.heated:
            to.add("y[at + 2] = P[P_T_OIL]")
    return function(
        "chamber__inject(y, at, P, TAB, R)",
        ['"""Let the oil in at the injection angle, and note trapped gas, its pressure, and the oil."""'],
        to.lines,
    )


def _at_breakpoint(network: Network) -> str:
    """Return the text of the jumps at breakpoints of a chamber's life: oil is injected at its angle."""
    to = Statements()
    with to.within("if abs(phi - P[P_INJECTION]) < 1e-9"):
        to.add("chamber__inject(y, 0, P, TAB, R)")
    if network.stops:
        with to.within("if phi == 0.0"):
            to.add("impacts__begin(y, own, R, P, TAB)")
    return function("chamber__at_breakpoint(phi, y, context)", [CONTEXT], to.lines)


def _share_in_phase(network: Network) -> str:
    """Return the text of the share of a step that holds: to a switch, an impact or a border of the phases."""
    to, n = Statements(), len(network.ports)
    to.add("share = 1.0")
    for port in network.ports:
        if port.one_way:
            line = f"R[{port.number} * PLACE + PRESSURE]"
            to.add(f"held = own[OPENING + {n + port.index}]")
            ends = f"{port.one_way}, {line}, {port.width}, held, share"
            to.add(f"share = borders__share_before_switch({ends}, y, y1, u, P, TAB)")
    tests = ["impacts__share_before_event(y, y1, u, rtol, own, R, P, TAB)"] if network.stops else []
    if network.phases:
        steep = "own[TPT] / own[PRESSURE]"
        tests.append(f"borders__share_before_border(own[PLACE], y, y1, u, 0, {steep}, rtol, P, TAB)")
    for test in tests:
        with to.within("if share == 1.0"):
            to.add(f"share = {test}")
    to.add("return share")
    return function("chamber__share_in_phase(y, y1, u, rtol, context)", [CONTEXT], to.lines)


def _jump(network: Network) -> str:
    """Return the text of what happens between two steps; it tells whether the integration may go on."""
    body = "impacts__take_event(y, rtol, own, R, P, TAB)" if network.stops else "True"
    return function("chamber__jump(y, rtol, context)", [CONTEXT, f"return {body}"])


# ---- the mass balance ------------------------------------------------------------------------------------------------


def _into(network: Network) -> str:
    """Return the text that adds a stream of the state of a place to the sums of its category (M1–M13)."""
    to = Statements()
    terms = stream_terms(to, network, "m", Place(*(f"source[s + {at}]" for at in NUMBERS.values())))
    to.add(*(f"sums[at + {k}] += {term}" for k, term in enumerate(terms.values())))
    return function("chamber__into(sums, at, m, source, s)", to.lines)


def _conserve(network: Network) -> str:
    """Return the text that closes a step's mass balance: by the flow through the widest open port, else by the density.

    A wide port holds p to the plenum's by a tiny Δp, whose quadrature carries the error of the whole state; the change
    of ρV over the step does not. Where no port is open the flows are smooth, and it is ρV that follows them.
    """
    to, cell, width = Statements(), Cell(network), len(network.quantities)
    opened = [port for port in network.ports if port.opening]
    if opened:
        _held_shares(to, network, "y", "share")
        _held_shares(to, network, "y1", "next")
    to.add("widest = 0.0", "line = 0")
    for port in network.ports:
        if port.wide:
            at = f"[E_AREAS + {port.index}]"
            shares = (f" * share_{port.index}", f" * next_{port.index}") if port in opened else ("", "")
            to.add(f"area = E{at}{shares[0]} + E_next{at}{shares[1]}")
            with to.within("if area > widest"):
                to.add("widest = area", f"line = {port.number}")
    if network.stops:
        to.add("impacts__put_within(y1, own)")
    to.add("defect = chamber__gas(E_next[E_VOLUME], y1, 0, P) - chamber__gas(E[E_VOLUME], y, 0, P)")
    first = len(heads(network))
    to.add(*(f"defect -= dq[{first + c * width}]" for c in range(len(cell.sums))))
    with to.within("if widest == 0.0"):
        if network.roomed:
            to.add("m = chamber__gas(E_next[E_VOLUME], y1, 0, P) - defect")
            to.add("y1[1] = oil_displacement__density_of(m, E_next[E_VOLUME], y1[3], P)")
        else:
            to.add("y1[1] -= defect / E_next[E_VOLUME]")
        to.add("return")
    to.add(f"at = {first} + 2 * line * {width}")
    with to.within(f"if dq[at] + dq[at + {width}] >= 0.0"):
        to.add("chamber__into(dq, at, defect, R, line * PLACE)")
    with to.within("else"):
        to.add("chamber__place(own[PLACE], y1, 0, P, TAB, own, 0)")
        to.add(f"chamber__into(dq, at + {width}, defect, own, 0)")
    head = "chamber__conserve(y, y1, E, E_next, context, dq)"
    return function(head, ['"""Close the mass balance of a step."""', CONTEXT], to.lines)


def _held_shares(to: Statements, network: Network, y: str, name: str) -> None:
    """Set how far each port whose opening hangs on the state is open to a chamber of state y, whose place is filled."""
    to.add(f"chamber__place(own[PLACE], {y}, 0, P, TAB, own, 0)")
    for port in network.ports:
        if port.opening and port.wide:
            drop = f"R[{port.number} * PLACE + PRESSURE] - own[PRESSURE]"
            held = f"own[OPENING + {len(network.ports) + port.index}]"
            call = f"path_opening({port.index}, {drop}, {port.width}, {held}, {y}, 0, P)"
            to.add(f"{name}_{port.index} = {call}")
