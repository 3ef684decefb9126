"""Port states as text: the numbers of a chamber, a neighbour or a line that flows and balances use.

Source: docs/model.md M5, M6, M10, M106–M108, M184. A port state is the row of numbers named in `slots` from PRESSURE
on. Those of neighbours are read from histories, whose columns beyond the states store results of the equation of state.
"""

from screwsim.model.network import balances
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, writes
from screwsim.model.port_states import gas_at_third, hold_to_line, jumps, make_cubic, row_of_third

STORED = {"p": "PRESSURE", "h": "ENTHALPY"}  # in the columns beyond the states, in this order
VARYING = {"exponent": "EXPONENT", "choke": "CHOKE", "choked": "CHOKED"}  # also these, of a real gas
OIL = {"x_oil": "OIL_RATIO", "w_gas": "DISSOLVED"}
KERNELS = (gas_at_third, hold_to_line, jumps, make_cubic, row_of_third)  # that the functions for port states call
LEAST = 1e-6  # of a neighbour's exponent and choking: a cubic across a phase border may dip below zero


def port_state_texts(network: Network) -> list[str]:
    """Return the functions that fill port states."""
    return [_of_chamber(network), _kept(network), _of_neighbour(network)]


def columns(network: Network) -> dict[str, str]:
    """Return what a history stores beyond the states, with the indices in a port state."""
    return STORED | (VARYING if network.varies else {})


@writes("chamber__port_state(held, y, at, P, TAB, port_state, row)")
def _of_chamber(to: Statements, network: Network) -> None:
    """Fill row `row` of `port_state` for a chamber whose state begins at y[at]."""
    to.add(*(f"{name} = y[at + S_{name}]" for name in network.states if name not in network.own_states))
    to.add("phase = gas_phase(T, rho, P, TAB) if held == FREE else int(held)" if network.phases else "phase = 0")
    balances.gas_state(to, network)
    _fill(to, network, {"p": "PRESSURE", "h": "ENTHALPY", "c_v": "C_V", "TpT": "TPT"} | VARYING, "port_state[row + {}]")


def _fill(to: Statements, network: Network, numbers: dict[str, str], port_state: str) -> None:
    """Store numbers of a port state, and those that flows use where oil takes room (M107, M108)."""
    balances.oil_room(to, network)
    felt = {"rho_felt": "DENSITY", "T_felt": "OIL_TEMPERATURE"} if network.roomed else {"rho": "DENSITY"}
    if network.heated and not network.roomed:
        felt["T_oil"] = "OIL_TEMPERATURE"
    oil = {name: at for name, at in OIL.items() if name in network.states}
    to.add(*(f"{port_state.format(at)} = {name}" for name, at in (numbers | felt | oil).items()))


@writes("chamber__keep_port_states(step, dense, context)", "P, TAB, R = context.P, context.TAB, context.R")
def _kept(to: Statements, network: Network) -> None:
    """Fill the columns of a step beyond the states: what neighbours need of the gas (M5, M10).

    Cubics through its values at 0, 1/3, 2/3 and 1 of the step: neighbours read them instead of asking the
    equation of state again and again.
    """
    asked = columns(network)
    to.add(f"fresh = {jumps.flat_name}(step, dense)")
    with to.within("for k in range(0 if fresh else 1, 4)"):
        to.add(f"T, rho = {gas_at_third.flat_name}(k, step, dense)", f"row = {row_of_third.flat_name}(k)")
        to.add("p, h, c_v, TpT, exponent, choke, choked = gas_state(T, rho, P, TAB)")
        to.add(*(f"dense[step, row, COLUMN_{name}] = {name}" for name in asked))
    with to.within("if not fresh"):
        to.add(*(f"dense[step, 0, COLUMN_{name}] = dense[step - 1, 1, COLUMN_{name}]" for name in asked))
    to.add(f"{hold_to_line.flat_name}(step, dense, COLUMN_p, P, R)")
    to.add(*(f"{make_cubic.flat_name}(step, dense, COLUMN_{name})" for name in asked))


@writes("chamber__neighbour(columns, P, R, E, at)")
def _of_neighbour(to: Statements, network: Network) -> None:
    """Fill the port state of a neighbour at E[at], and that it is none of a line."""
    asked = columns(network)
    to.add(*(f"{name} = columns[S_{name}]" for name in network.states if name in ("rho", "T_oil", "w_gas")))
    if network.carried:
        to.add("x_oil = max(0.0, columns[S_x_oil])")  # a cubic between two steps may dip below zero
    for name in asked:
        found = f"columns[COLUMN_{name}]"
        to.add(f"{name} = {found}" if name in STORED else f"{name} = max({LEAST!r}, {found})")
    if not network.varies:  # constants of an ideal gas, the same everywhere
        to.add(*(f"{name} = R[R_{network.lines[0]} + {at}]" for name, at in VARYING.items()))
    _fill(to, network, STORED | VARYING, "E[at + {}]")
    to.add("E[at + BEYOND] = 0.0")
