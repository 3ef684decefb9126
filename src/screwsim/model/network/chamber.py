"""One chamber among neighbours with known histories, as text: its rates, their derivatives, its flows.

Source: docs/model.md M1–M13. `E` holds what depends on the angle alone: volume, areas, port states of the neighbours
(slots.py).
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

from screwsim.model.impacts import keep_at_rest, keep_rows_at_rest
from screwsim.model.network import balances, stops
from screwsim.model.network.balances import between_texts
from screwsim.model.network.cell import BY_ANGLE, CONSTANT, Cell
from screwsim.model.network.flows import (
    Around,
    around_gap,
    around_port,
    gas_flux,
    needed,
    port_state_of,
    read_port_state,
)
from screwsim.model.network.layout import place_of_sum
from screwsim.model.network.line_flow import line_flow_texts
from screwsim.model.network.network import Gap, Network, Port
from screwsim.model.network.port_states import port_state_texts
from screwsim.model.network.statements import Statements, Tangent, function
from screwsim.model.network.steps import CONTEXT, step_texts
from screwsim.model.network.surroundings import beyond_last_text, lines_texts, surroundings_text
from screwsim.numerics.expressions import slope_name
from screwsim.numerics.kernel import Kernel

HELD_PHASE = "phase = gas_phase(T, rho, P, TAB) if own[PHASE] == FREE else int(own[PHASE])"
KEPT = ["own[PRESSURE] = p", "own[TPT] = TpT"]


@lru_cache(maxsize=64)
def chamber_texts(key: tuple[Any, ...]) -> tuple[tuple[str, ...], tuple[Kernel, ...]]:
    """Return the functions of one chamber of a network, given by its key, and the kernels that they call."""
    network = Network(*key)
    chamber = Chamber(network)
    return tuple(chamber.written()), (*network.kernels.values(), *chamber.tangents)


class Chamber(Cell):
    """The functions of one chamber."""

    context = CONTEXT
    constant: tuple[str, ...] = CONSTANT
    jacobian_name = "jacobian"

    def __init__(self, network: Network) -> None:
        super().__init__(network)
        self.sides = self.layout.sides
        self.tangents: list[Kernel] = []  # that the texts call

    def written(self) -> list[str]:
        """Return the texts of all functions."""
        network = self.network
        films = [self.film_flows(), self.oil_films()] if network.oily else []
        between = [*port_state_texts(network), *between_texts(network), *step_texts(network)]
        around = [*lines_texts(network, "chamber"), beyond_last_text(network), surroundings_text(network)]
        own = [self.rates(), self.jacobian(), self.path_flows(), self.given_off(), *films]
        return [*own, *between, *around, *line_flow_texts(network)]

    def _side(self, gap: Gap, way: str) -> tuple[str, str]:
        """Return the index in E of the area of a gap's side, and that of the port state beyond it."""
        return self.layout.area(gap, way), f"E_{self.layout.neighbour(gap.side, way)}"

    def _streams(self, to: Statements, slopes: bool) -> None:
        """Add the streams of all connections to the sums of their cells.

        With `slopes` also set what derivatives need.
        """
        network, discharge = self.network, self.network.lines[1]
        met = [self.layout.neighbour(side, "ahead") for side in range(len(network.offsets))]
        ahead = [f"{there}_{way}" for there in met for way in ("in", "out")]
        to.add("# streams: mass, enthalpy, oil, in and out of what lies around the chamber (M10–M13)")
        self.begin(to, [*self.sums, *ahead])
        to.add(*(["pushed = 0.0"] if network.pushes else []))
        to.add(*(f"beyond_{there} = 0.0" for there in met), *(f"from_{there} = 0.0" for there in self.layout.met))
        for port in network.ports:
            self.port(to, port, slopes)
        for gap, way in self.sides:
            self._neighbour(to, gap, way, slopes)
        for there in met:
            to.add("# ahead of the last chamber lies the discharge line (M24)")
            with to.within(f"if beyond_{there} > 0.0"):
                for way in ("in", "out"):
                    to.add(*(f"{each}_{discharge}_{way} += {each}_{there}_{way}" for each in network.quantities))
                to.add(f"from_{there} = 0.0")
            with to.within("else"):
                for way in ("in", "out"):
                    to.add(*(f"{each}_between += {each}_{there}_{way}" for each in network.quantities))
        balances.oil_through_ports(to, network)

    def _neighbour(self, to: Statements, gap: Gap, way: str, slopes: bool) -> None:
        """Add the streams through a gap to the chamber ahead or behind."""
        area, port_state = self._side(gap, way)
        cell, network = self.layout.neighbour(gap.side, way), self.network
        instead = ("area == 0.0", "E_next") if slopes else ("", "")  # for a gap that opens
        with to.within(self.opened(to, f"{gap.effect}, {way} (M12)", area, slopes)):
            read_port_state(to, network, cell, "E", port_state, instead)
            if way == "ahead":
                line = f"E[{port_state} + BEYOND]"
                to.add(
                    f"beyond_{cell} = "
                    + (f"E_next[{port_state} + BEYOND] if area == 0.0 else {line}" if slopes else line)
                )
            sums = (f"{cell}_in", f"{cell}_out") if way == "ahead" else ("between", "between")
            self.gap(to, gap, *sums, port_state_of(network, cell), way)
            to.add(f"from_{cell} += flow")

    def _body(self, slopes: bool) -> list[str]:
        """Return the statements from the states to rates and quadratures."""
        to = Statements()
        balances.gas_state(to, self.network)
        balances.oil_room(to, self.network)
        balances.gas_inside(to, self.network)
        self._streams(to, slopes)
        self.finish(to)
        to.add(*(f"q_{each} = from_{each} * per_omega" for each in self.layout.met))
        return to.lines

    def _stored(self) -> list[str]:
        """Return lines that store rates and quadratures."""
        rates = [f"f[S_{name}] = f_{name}" for name in self.network.states]
        return [*rates, *(f"g[{place_of_sum(name)}] = {name}" for name in self.quadratures)]

    # ---- functions ---------------------------------------------------------------------------------------------

    def rates(self) -> str:
        """Return the text of dy/dφ of one chamber, and of the rates of its quadratures."""
        network = self.network
        return function(
            "chamber__rates(y, E, context, f, g)",
            ['"""Fill f = dy/dphi and the quadrature rates g of one chamber."""', self.context],
            [*self.states(), HELD_PHASE if network.phases else "phase = 0"],
            [*self._body(False), *KEPT, *self._stored()],
            [*stops.at_rest(network, keep_at_rest, "f"), "own[STEP_END] = E[E_ANGLE]"] if network.stops else [],
            ["own[FED_LAST] = inflow"] if network.flash is not None else [],
        )

    def jacobian(self) -> str:
        """Return the text of the rates and their derivatives by the states and by the angle."""
        network, states = self.network, self.network.states
        given = self._by_angle()
        tangent = Tangent(self._body(True), (*states, "phi"), network.kernels, given, self.constant)
        self.tangents = tangent.kernels
        stores = self._stored()
        rows = [("J", "f_phi", f"S_{name}", f"f_{name}") for name in states]
        rows += [("Jq", "g_phi", place_of_sum(name), name) for name in self.quadratures]
        for by_states, by_angle, row, name in rows:
            stores += [f"{by_states}[{row}, S_{state}] = {tangent.slope(name, state)}" for state in states]
            stores.append(f"{by_angle}[{row}] = {tangent.slope(name, 'phi')}")
        before, of_states = ["per_delta = 1.0 / delta"], ["phase = gas_phase(T, rho, P, TAB)", "own[PHASE] = phase"]
        before += ([HELD_PHASE] if self.exact else of_states) if network.phases else ["phase = 0"]
        before += [f"{slope_name(name, 'phi')} = {given[name, 'phi']}" for name in ("V", "dV")]
        valves = [port for port in network.ports if port.one_way]
        after = [f"{self.layout.share(port, 'HELD')} = switch_{self.layout.label(port)}" for port in valves]
        after += ["own[FED_FIRST] = inflow"] if network.flash is not None else []
        if network.stops:
            after += [line for array in ("f", "f_phi") for line in stops.at_rest(network, keep_at_rest, array)]
            after += [*stops.at_rest(network, keep_rows_at_rest, "J"), "own[STEP_BEGIN] = E[E_ANGLE]"]
        return function(
            f"chamber__{self.jacobian_name}(y, E, E_next, delta, context, f, g, J, Jq, f_phi, g_phi)",
            ['"""Fill f, g and their derivatives by y and by phi; E_next is E at phi + delta."""', self.context],
            [*self.states(), *before, *tangent.lines, *KEPT, *stores, *after],
        )

    def _by_angle(self) -> dict[tuple[str, str], str]:
        """Return the derivatives by the angle of the numbers in E, including the port states of neighbours."""
        found = self.by_angle()
        for gap, way in self.sides:
            _, port_state = self._side(gap, way)
            for name, at in needed(self.network).items():
                if name not in CONSTANT:
                    text = BY_ANGLE.format(at=f"{port_state} + {at}")
                    found[f"{name}_{self.layout.neighbour(gap.side, way)}", "phi"] = f"{text} if area > 0.0 else 0.0"
        return found

    def path_flows(self) -> str:
        """Return the text of the flow [kg/s] into the chamber through each path: ports, then both sides of each gap."""
        network, to = self.network, Statements()
        for port in network.ports:
            with self._read(to, port, "", f"out[{self.layout.flow(port)}]") as around:
                if port.opening:
                    to.add(f"switch_{self.layout.label(port)} = LOOSE")
                gas_flux(to, port, around, self.layout.label(port))
                to.add(f"out[{self.layout.flow(port)}] = area * flux")
                if port.opening:
                    to.add(f"{self.layout.share(port, 'OPENED')} = opened")
        for gap, way in self.sides:
            with self._read(to, gap, way, f"out[{self.layout.flow(gap, way)}]") as around:
                gas_flux(to, gap, around)
                to.add(f"out[{self.layout.flow(gap, way)}] = area * flux")
        return self._reading(
            "path_flows", "mass flow [kg/s] into the chamber: ports, then each gap ahead and behind", to
        )

    def film_flows(self) -> str:
        """Return the text of the oil [kg/s] that enters as films, and dragged (M252, M256)."""
        network, to = self.network, Statements()
        if network.slow:
            to.add(f"slow = {network.slow}")
        for opening, way in self.layout.oil_beside:
            at = self.layout.film(opening, way)
            for out, stream in ((f"out[{at}]", opening.film), (f"drags[{at}]", opening.drag)):
                if stream is None:
                    to.add(f"{out} = 0.0", f"area = E[{self.layout.area(opening, way)}]")
                    continue
                with self._read(to, opening, way, out) as around:
                    leaves = stream.driven and around.leading is self.own
                    to.add(*around.lines(stream), f"{out} = {'-' if leaves else ''}area * {around.flux(stream)}")
        what = "oil [kg/s] that comes as films, and `drags` with what walls drag along: each gap ahead and behind"
        return self._reading("film_flows", what, to, ", drags")

    def oil_films(self) -> str:
        """Return the text of the oil [kg/s] that passes gaps beside the gas, as films and dragged."""
        flows = [self.layout.film(*each) for each in self.layout.oil_beside]
        text = '"""Fill `out` with the oil [kg/s] beside the gas, films and dragged: each gap ahead and behind."""'
        call = "chamber__film_flows(y, E, context, out, drags)"
        lines = ["drags = np.empty(N_FILMS)", call, *(f"out[{each}] += drags[{each}]" for each in flows)]
        return function("chamber__oil_films(y, E, context, out)", [text], lines)

    def given_off(self) -> str:
        """Return the text of the gas that oil releases in the chamber, or that flashes as oil enters."""
        network, to = self.network, Statements()
        gas = "0.0"
        if network.flash is not None and network.inflow is not None:
            to.add("width = P[P_DISCHARGE_WIDTH]", "p = own[PRESSURE]")
            to.add(*([f"slow = {network.slow}"] if network.slow else []), f"inflow = {network.inflow.call}")
            gas = f"inflow * max(0.0, {network.flash.share})"
        if network.solution is not None:
            balances.gas_inside(to, network)
            to.add("h = own[ENTHALPY]", f"s = {network.entropy}")
            to.add(f"gas, _enthalpy, _warmth = {network.solution.release}")
            gas = "gas"
        states = [line for line in self.states() if not line.startswith("phi =")]
        return function(
            "chamber__given_off(y, phi, E, own, P, TAB)",
            ['"""Return the gas [kg/s] that comes from oil in a chamber (M231), or as oil enters (M196)."""'],
            [*(states if gas != "0.0" else []), *to.lines, f"return {gas}"],
        )

    @contextmanager
    def _read(self, to: Statements, opening: Port | Gap, way: str, out: str) -> Iterator[Around]:
        """Set `out` to zero; inside, where the opening is open, yield what its streams' text may name."""
        network = self.network
        if isinstance(opening, Port):
            cell, port_state = opening.cell, self.line(opening.cell)
            around = around_port(network, opening, self.own, port_state_of(network, cell))
        else:
            cell, port_state = self.layout.neighbour(opening.side, way), ("E", self._side(opening, way)[1])
            around = around_gap(network, self.own, port_state_of(network, cell), way)
        to.add(f"{out} = 0.0", f"area = E[{self.layout.area(opening, way)}]")
        with to.within("if area > 0.0"):
            read_port_state(to, network, cell, *port_state)
            yield around

    def _reading(self, name: str, what: str, to: Statements, more: str = "") -> str:
        """Return the text of a function that fills `out`, and the port state, for the state of a stored cycle."""
        asked = {"p": "PRESSURE", "exponent": "EXPONENT", "choke": "CHOKE", "choked": "CHOKED"}
        asked |= {"rho_felt": "DENSITY"} if self.network.roomed else {}
        openings = self.network.openings
        asked |= {"h": "ENTHALPY"} if any(each.asks("h") for each in openings) else {}
        of_oil = self.network.roomed and any(each.asks("T_oil") for each in openings)
        asked |= {"T_felt": "OIL_TEMPERATURE"} if of_oil else {}
        port_state = [
            "chamber__port_state(FREE, y, 0, P, TAB, own, 0)",
            *(f"{each} = own[{at}]" for each, at in asked.items()),
        ]
        return function(
            f"chamber__{name}(y, E, context, out{more})",
            [f'"""Fill `out` with the {what}."""', CONTEXT],
            [*self.states(), *port_state, *to.lines],
        )
