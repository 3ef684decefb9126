"""Places as text: the numbers by which flows and balances know a chamber, a neighbour or a line.

Source: docs/model.md M5, M6, M10, M106–M108, M184. A place is the row of numbers that `slots.PRESSURE` … name. Those of
neighbours are read from histories, whose columns beyond the states hold what the equation of state says of them.
"""

from __future__ import annotations

from screwsim.model.network import balances
from screwsim.model.network.cell import Cell
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, function

STORED = {"p": "PRESSURE", "h": "ENTHALPY"}  # in the columns beyond the states, in this order
VARYING = {"exponent": "EXPONENT", "choke": "CHOKE", "choked": "CHOKED"}  # of a real gas these, too
OIL = {"x_oil": "OIL_RATIO", "w_gas": "DISSOLVED"}
LEAST = 1e-6  # exponent and choking of a neighbour: a cubic across a border of the phases may dip below none
LINE = 1  # of the discharge, which lies ahead of the last chamber


def place_texts(network: Network) -> list[str]:
    """Return the functions that fill places."""
    return [_of_chamber(network), _stored(network), _of_neighbour(network), *_of_lines(network)]


def columns(network: Network) -> dict[str, str]:
    """Return what a history holds beyond the states, and where it stands in a place."""
    return STORED | (VARYING if network.varies else {})


def _of_chamber(network: Network) -> str:
    """Return the text of the place of a chamber whose states begin at y[at], in the phase that is held, or its own."""
    to = Statements()
    to.add(*(f"{name} = y[at + {i}]" for i, name in enumerate(network.states) if name not in network.own_states))
    to.add("phase = gas_phase(T, rho, P, TAB) if held == FREE else int(held)" if network.phases else "phase = 0")
    balances.gas_state(to, network)
    _fill(to, network, {"p": "PRESSURE", "h": "ENTHALPY", "c_v": "C_V", "TpT": "TPT"} | VARYING, "place[row + {}]")
    return function(
        "chamber__place(held, y, at, P, TAB, place, row)",
        ['"""Fill row `row` of `place` for a chamber whose state begins at y[at]."""'],
        to.lines,
    )


def _fill(to: Statements, network: Network, numbers: dict[str, str], place: str) -> None:
    """Store numbers of a place, and those that flows feel where oil takes room (M107, M108)."""
    balances.oil_room(to, network)
    felt = {"rho_felt": "DENSITY", "T_felt": "OIL_TEMPERATURE"} if network.roomed else {"rho": "DENSITY"}
    if network.heated and not network.roomed:
        felt["T_oil"] = "OIL_TEMPERATURE"
    oil = {name: at for name, at in OIL.items() if name in network.states}
    to.add(*(f"{place.format(at)} = {name}" for name, at in (numbers | felt | oil).items()))


def _stored(network: Network) -> str:
    """Return the text of what a history holds beyond the states."""
    asked = columns(network)
    return function(
        "chamber__stored(T, rho, P, TAB, out)",
        ['"""Fill `out` with the columns that a history holds beyond the states."""'],
        ["p, h, c_v, TpT, exponent, choke, choked = gas_state(T, rho, P, TAB)"],
        [f"out[{i}] = {name}" for i, name in enumerate(asked)],
    )


def _of_neighbour(network: Network) -> str:
    """Return the text of the place of a neighbour, from the columns of its history."""
    to, n, asked = Statements(), len(network.states), columns(network)
    to.add(*(f"{name} = columns[{i}]" for i, name in enumerate(network.states) if name in ("rho", "T_oil", "w_gas")))
    if network.carried:
        to.add("x_oil = max(0.0, columns[3])")  # a cubic between two steps may dip below none by its error
    for i, name in enumerate(asked):
        to.add(f"{name} = columns[{n + i}]" if name in STORED else f"{name} = max({LEAST!r}, columns[{n + i}])")
    if not network.varies:  # constants of an ideal gas, the same everywhere
        to.add(*(f"{name} = R[R_SUCTION + {at}]" for name, at in VARYING.items()))
    _fill(to, network, STORED | VARYING, "E[at + {}]")
    to.add("E[at + PLACE] = 0.0")
    return function(
        "chamber__neighbour(columns, P, R, E, at)",
        ['"""Fill the place of a neighbour at E[at], and that it is none of a line."""'],
        to.lines,
    )


def _of_lines(network: Network) -> list[str]:
    """Return the texts of the lines' places at an angle, and of that which lies ahead of the last chamber."""
    array, at = Cell(network).line(LINE)
    begin = {"chamber": "E_LINES", "chambers": "ALL_LINES"}
    filled = "pulsation__fill_lines(phi, P, R, E, {})" if network.pulsating else "pass"
    return [
        *(function(f"{whose}__lines(phi, P, R, E)", [filled.format(first)]) for whose, first in begin.items()),
        function(
            "chamber__beyond_last(R, E, at)",
            ['"""Fill the place of the discharge line, ahead of the last chamber, at E[at]."""'],
            ["for i in range(PLACE):", f"    E[at + i] = {array}[{at} + i]", "E[at + PLACE] = 1.0"],
        ),
    ]
