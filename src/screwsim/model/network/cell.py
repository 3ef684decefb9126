"""Statements for a chamber that all texts share: states, connections to lines and plenums, balances, quadratures.

Source: docs/model.md M1–M13. Streams are summed by the cell on the far side of a connection.
"""

from screwsim.model.network import balances, flows
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import QUANTITIES, Gap, Network, Port
from screwsim.model.network.statements import Statements

CONSTANT = ("exponent", "choke", "choked")  # numbers of the gas held constant in the derivatives of flows
RESERVED = {  # names that no state can have
    *("y", "E", "P", "TAB", "R", "own", "f", "g", "J", "Jq", "e", "j", "c", "i", "k", "s", "phi", "phase", "V", "dV"),
    *("oiled", "delta", "per_delta", "context", "side", "port_states", "work", "ahead"),
}
TAKEN = {  # names that the text of a stream may not set besides, since the text around it uses them
    *("p", "h", "c_v", "TpT", "exponent", "choke", "choked", "rho_felt", "T_felt", "share", "m", "m_oil", "omega"),
    *("slow", "area", "next_area", "flow", "pushed", "inflow", "films", "drags", "leaving", "discharged", "dt"),
}
BY_ANGLE = "(E_next[{at}] - E[{at}]) * per_delta"  # over the step from E to E_next


def taken(network: Network) -> set[str]:
    """Return the names that the text of a stream may not set."""
    around = {*filter(None, network.cells), *Layout(network).met, "ahead", "between", "port", "given"}
    ends = {f"{each}{way}" for each in around for way in ("", "_in", "_out")}
    heads = {*flows.NUMBERS, *QUANTITIES, *network.states, *TAKEN, "from", "beyond", "switch", "s"}
    return RESERVED | TAKEN | {*network.states} | {f"{head}_{end}" for head in heads for end in ends}


class Cell:
    """A chamber whose surroundings are in E from `e` on; where lines pulsate, their port states follow."""

    e = ""
    together = False
    exact = False  # whether derivatives include what the integrator holds, and hold what a step holds

    def __init__(self, network: Network) -> None:
        self.network, self.layout = network, Layout(network)
        rho, T_oil = ("rho_felt", "T_felt") if network.roomed else ("rho", "T_oil")
        oil = ("x_oil", T_oil) if network.carried else ("0.0", "0.0")
        held = "w_gas" if network.dissolves else "0.0"
        self.own = flows.PortState("p", rho, "h", "exponent", "choke", "choked", *oil, held)
        # sums of streams in the order of the categories (slots.py)
        self.sums = [f"{cell}_{way}" for cell in network.cells if cell for way in ("in", "out")]
        self.sums[4:4] = ["between", "port"] if network.ported or len(network.cells) > 3 else ["between"]

    def states(self, at: str = "") -> list[str]:
        """Return lines that read the states, and the surroundings other than flows."""
        names = [f"{name} = y[{at}S_{name}]" for name in self.network.states]
        around = {"phi": "E_ANGLE", "V": "E_VOLUME", "dV": "E_SLOPE"}
        around |= {"oiled": "E_OILED"} if self.network.heated and not self.network.carried else {}
        return [*names, *(f"{name} = E[{self.e}{number}]" for name, number in around.items())]

    def line(self, cell: str) -> tuple[str, str]:
        """Return array and index of the port state of a line or plenum; in E where lines pulsate (M184)."""
        return self.layout.line(cell, self.together)

    def opened(self, to: Statements, what: str, at: str, slopes: bool) -> str:
        """Set the area of an opening, and return the test for it being open or opening."""
        if slopes:
            to.add(f"next_area = E_next[{at}]")
        to.add(f"area = E[{at}]  # {what}")
        return "if area > 0.0 or next_area > 0.0" if slopes else "if area > 0.0"

    def port(self, to: Statements, port: Port, slopes: bool) -> None:
        """Add the stream through a port."""
        if port.opening:
            to.add(f"switch_{self.layout.label(port)} = {self.layout.share(port, 'HELD')}")
        beyond = flows.port_state_of(self.network, port.cell)
        with to.within(self.opened(to, f"{port.effect} (M12)", f"{self.e}{self.layout.area(port)}", slopes)):
            flows.read_port_state(to, self.network, port.cell, *self.line(port.cell))
            if slopes and port.one_way and not self.exact:
                way = ">" if port.one_way > 0 else "<"
                to.add(f"switch_{self.layout.label(port)} = 1.0 if {beyond.p} {way} p else 0.0")
            around = flows.around_port(self.network, port, self.own, beyond)
            flows.gas_flux(to, port, around, self.layout.label(port))
            self._streams_of(to, port, f"{port.cell}_in", f"{port.cell}_out", around)

    def gap(
        self, to: Statements, gap: Gap, inward: str, outward: str, beyond: flows.PortState, way: str = "ahead"
    ) -> None:
        """Add the streams through a gap to the port state on side `way` of the chamber."""
        around = flows.around_gap(self.network, self.own, beyond, way)
        flows.gas_flux(to, gap, around)
        self._streams_of(to, gap, inward, outward, around)

    def _streams_of(self, to: Statements, opening: Port | Gap, inward: str, outward: str, around: flows.Around) -> None:
        """Add the streams through an opening with the port states of their sources; `flux` is that of the gas."""
        network, own, beyond = self.network, self.own, around.beyond
        to.add("flow = area * flux")
        with to.within("if flux >= 0.0"):
            flows.add_flow(to, network, inward, beyond)
        with to.within("else"):
            flows.add_flow(to, network, outward, own)
        if film := opening.film:
            to.add(*around.lines(film), f"film = area * {around.flux(film)}")
            with to.within("if film >= 0.0"):
                flows.add_film(to, network, inward, beyond)
            with to.within("else"):
                flows.add_film(to, network, outward, own)
        if drag := opening.drag:
            enters = around.leading is beyond
            to.add(*around.lines(drag), f"film = {'' if enters else '-'}area * {around.flux(drag)}")
            flows.add_film(to, network, inward if enters else outward, around.leading)
            if enters and network.pushes:
                to.add(f"pushed += film * ({beyond.p} - p) * P[P_ROOM]")

    def begin(self, to: Statements, sums: list[str]) -> None:
        """Set sums to zero."""
        for each in sums:
            to.add(*(f"{quantity}_{each} = 0.0" for quantity in self.network.quantities))

    def finish(self, to: Statements) -> None:
        """Set rates and quadratures from the sums of all streams."""
        balances.totals(to, self.network, self.sums)
        balances.rates(to, self.network)
        to.add("# what the ledger of the lines takes, over the angle", "per_omega = 1.0 / omega")
        for each in self.sums:
            to.add(*(f"q_{quantity}_{each} = {quantity}_{each} * per_omega" for quantity in self.network.quantities))

    @property
    def quadratures(self) -> list[str]:
        """Return the names of all quadratures, in their order (slots.Q_WORK …)."""
        walls = [f"q_{what}_{label}" for label in self.layout.walls for what in ("wall", "conductance")]
        heads = ["q_work", "q_heat", *walls, *(f"q_{each}" for each in self.layout.met)]
        heads += ["q_pushed"] if self.network.pushes else []
        return heads + [f"q_{quantity}_{each}" for each in self.sums for quantity in self.network.quantities]

    def by_angle(self) -> dict[tuple[str, str], str]:
        """Return the derivatives by the angle of the numbers in E."""
        network = self.network
        found = {"V": "dV", "dV": BY_ANGLE.format(at=f"{self.e}E_SLOPE")}
        found["area"] = "(next_area - area) * per_delta"
        if network.pulsating:
            for cell in filter(None, network.cells):
                _, port_state = self.line(cell)
                changing = {name: at for name, at in flows.needed(network).items() if name not in CONSTANT}
                found |= {f"{name}_{cell}": BY_ANGLE.format(at=f"{port_state} + {at}") for name, at in changing.items()}
        there = f"(E_next[{self.e}E_ANGLE],"
        slow = network.slow.replace("(phi,", there)
        if network.inflow is not None:
            inflow = network.inflow.call.replace("slow * ", f"{slow} * ").replace("(phi,", there)
            found["inflow"] = f"({inflow} - inflow) * per_delta"
        if network.slow:
            found["slow"] = f"({slow} - slow) * per_delta"
        return {(name, "phi"): text for name, text in found.items()}
