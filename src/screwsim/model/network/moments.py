"""What every stream and heat of one chamber moves and generates at a moment, as text: the terms of the ledger.

Source: docs/model.md M50–M57, M105, M109, M171, M197, M233, M254, M258. An outflow generates nothing in its donor:
streams between chambers count where they arrive.
"""

from functools import lru_cache
from typing import Any

from screwsim.model.network import balances
from screwsim.model.network.chamber import Chamber
from screwsim.model.network.flows import PortState, port_state_of, read_port_state
from screwsim.model.network.layout import WAYS
from screwsim.model.network.network import SYMBOLS, Gap, Network, Port
from screwsim.model.network.statements import Statements, function
from screwsim.model.network.steps import CONTEXT

ENTROPIES = tuple(f"s_{line}" for line in SYMBOLS)  # of the lines, names of arguments [J/(kg K)]


@lru_cache(maxsize=64)
def moment_text(key: tuple[Any, ...]) -> str:
    """Return the function that adds a moment of a network, given by its key, to the sums of the ledger."""
    return Moments(Network(*key)).moment()


class Moments(Chamber):
    """The ledger's terms of one chamber; sums of paths, heats and oil are rows of model.ledger."""

    def moment(self) -> str:
        """Return the text that adds a moment, weighted with the time dt [s] that it represents."""
        network, to = self.network, Statements()
        to.add("c_oil = P[P_C_OIL]", "p = own[PRESSURE]", "h = own[ENTHALPY]")
        if network.roomed:
            to.add("T_felt = own[OIL_TEMPERATURE]")
        to.add("s = gas_entropy(T, rho, P, TAB)")
        balances.gas_inside(to, network)
        to.add(f"leaving = {'x_oil' if network.carried else 'oiled * R[R_RATIO]' if network.heated else '0.0'}")
        if network.dissolves:
            to.add("s_held, all_held = solution_entropy(w_gas, P, TAB)")
        to.add("discharged = 0.0")
        for port in network.ports:
            self._through_port(to, port)
        for side in range(len(network.offsets)):
            for way in WAYS:
                self._entropy(to, side, way)
        for gap, way in self.sides:
            self._through_gap(to, gap, way)
        self._heats(to)
        self._oil(to)
        films = []
        if network.oily:
            films = [f"{each} = np.empty(N_FILMS)" for each in ("films", "drags")]
            films += ["chamber__film_flows(y, E, context, films, drags)"]
        head = (
            f"ledger__add_moment(phi, y, mass_rate, E, context, flows, {', '.join(ENTROPIES)}, dt, paths, heats, oil)"
        )
        text = '"""Add a moment of the cycle, which stands for the time dt [s], to the sums of the ledger."""'
        states = [line for line in self.states() if not line.startswith("phi =")]
        return function(head, [text, CONTEXT], [*states, *films, *to.lines])

    # ---- streams -----------------------------------------------------------------------------------------------

    def _through_port(self, to: Statements, port: Port) -> None:
        """Enter the flow through a port: an arrival in the chamber, or a departure to the line or plenum."""
        network, row = self.network, f"paths[PATH_{self.layout.label(port)}, {{}}]"
        beyond, own = port_state_of(network, port.cell), f"R[R_{port.cell} + PLENUM_ENTROPY]"
        s = dict(zip(network.lines, ENTROPIES, strict=True)).get(port.cell, own)
        to.add(f"flow = flows[{self.layout.flow(port)}]")
        with to.within("if flow >= 0.0"):
            read_port_state(to, network, port.cell, *self.line(port.cell))
            self._press(to, beyond, f"R[R_{port.cell} + PRESSURE]")
            self._arrival(to, row, beyond, s)
        with to.within("else"):
            with_oil = network.heated and (port.cell == network.lines[1] or network.carried)
            self._departure(to, row, "leaving" if with_oil else "0.0")
            if with_oil:
                to.add("discharged -= leaving * flow")
        if port.oily:
            self._oil_beside(to, port, row, beyond)

    def _oil_beside(self, to: Statements, port: Port, row: str, beyond: PortState) -> None:
        """Enter the oil that passes a port beside the gas."""
        with to.within(f"if E[{self.layout.area(port)}] > 0.0"):
            read_port_state(to, self.network, port.cell, *self.line(port.cell))
            self._press(to, beyond, f"R[R_{port.cell} + PRESSURE]")
            if port.film:
                to.add(f"film = films[{self.layout.film(port)}]")
                self._film(to, row, beyond, "True")
            if port.drag:
                self._drag(to, row, beyond, f"drags[{self.layout.film(port)}]")

    def _through_gap(self, to: Statements, gap: Gap, way: str) -> None:
        """Enter the flow through a gap where it arrives; beyond the last chamber also departures to discharge."""
        network, cell = self.network, self.layout.neighbour(gap.side, way)
        row, beyond = f"paths[PATH_{self.layout.label(gap)}, {{}}]", port_state_of(network, cell)
        discharge = f"R[R_{network.lines[1]} + PRESSURE]"
        area, port_state = self._side(gap, way)
        to.add(f"flow = flows[{self.layout.flow(gap, way)}]")
        if gap.film:
            to.add(f"film = films[{self.layout.film(gap, way)}]")
        with to.within(f"if E[{area}] > 0.0"):
            read_port_state(to, network, cell, "E", port_state)
            line = f"E[{port_state} + BEYOND] > 0.0"
            self._press(to, beyond, f"{discharge} if {line} else {beyond.p}" if way == "ahead" else beyond.p)
            with to.within("if flow > 0.0"):
                self._arrival(to, row, beyond, f"s_{cell}")
            if way == "ahead":
                with to.within(f"elif flow < 0.0 and E[{port_state} + BEYOND] > 0.0"):
                    self._departure(to, row, "leaving" if network.heated else "0.0")
                    to.add("discharged -= leaving * flow")
            if gap.film:
                self._film(to, row, beyond, f"E[{port_state} + BEYOND] > 0.0" if way == "ahead" else "")
            if gap.drag and way == "ahead":
                self._drag(to, row, beyond, f"drags[{self.layout.film(gap, way)}]")

    def _entropy(self, to: Statements, side: int, way: str) -> None:
        """Set the specific entropy of a neighbour that gas comes from, at the place that `surroundings` found."""
        network, cell = self.network, self.layout.neighbour(side, way)
        gaps = [gap for gap in network.gaps if gap.side == side]
        coming = " or ".join(f"flows[{self.layout.flow(gap, way)}] > 0.0" for gap in gaps)
        _, port_state = self._side(gaps[0], way)
        shift = network.offsets[side] * (1 if way == "ahead" else -1)
        to.add(f"s_{cell} = {ENTROPIES[1]}")
        with to.within(f"if ({coming}) and not (E[{port_state} + BEYOND] > 0.0)"):
            to.add(f"i = context.hints[HINT_{cell}]", f"there = phi + {shift} * P[P_PITCH]")
            to.add("theta = (there - context.t_old[i]) / (context.t_old[i + 1] - context.t_old[i])")
            for name in ("T", "rho"):
                pieces = ", ".join(f"context.d_old[i, {piece}, S_{name}]" for piece in range(4))
                to.add(f"{name}_there = rodas__dense_value(theta, {pieces})")
            rho = "rho_there" if network.roomed else f"E[{port_state} + DENSITY]"
            to.add(f"s_{cell} = gas_entropy(T_there, {rho}, P, TAB)")

    def _press(self, to: Statements, beyond: PortState, pulsating: str) -> None:
        """Set the pressure at which oil that takes room has the enthalpy of the port state beyond (M109).

        For a pulsating line that is the line's own: its oil does not take part in the plenum's compression
        (M186).
        """
        if self.network.roomed:
            to.add(f"pressed = {pulsating if self.network.pulsating else beyond.p}")

    def _oil_arrival(self, stream: str, beyond: PortState) -> str:
        """Return a call for the entropy generated by oil that mixes with the chamber's (M51, M109)."""
        if self.network.roomed:
            return f"ledger__pressed_oil_arriving({stream}, {beyond.T_oil}, pressed, T_felt, p, T_oil)"
        return f"ledger__oil_arriving({stream}, {beyond.T_oil}, T_oil)"

    def _held_arrival(self, stream: str, held: str) -> str:
        """Return a call for the entropy generated by the gas dissolved in such oil (M233)."""
        return f"ledger__held_arriving({stream}, {held}, w_gas, s_held, all_held, P, TAB)"

    def _arrival(self, to: Statements, row: str, beyond: PortState, s: str) -> None:
        """Add what an inflow moves, and generates in the chamber."""
        to.add(f"{row.format('MOVED')} += dt * flow", f"{row.format('CARRIES')} += dt * flow * {beyond.h}")
        generated = row.format("GENERATED")
        to.add(f"{generated} += dt * ledger__arriving(flow, {beyond.h}, {s}, h, s, T)")
        if self.network.carried:
            with to.within(f"if {beyond.oil_ratio} > 0.0"):
                to.add(f"mixed = flow * {beyond.oil_ratio}")
                to.add(f"{generated} += dt * c_oil * {self._oil_arrival('mixed', beyond)}")
                if self.network.dissolves:
                    to.add(f"{generated} += dt * {self._held_arrival('mixed', beyond.held)}")

    def _departure(self, to: Statements, row: str, ratio: str) -> None:
        """Add what an outflow takes to a line, with `ratio` oil per gas."""
        to.add(f"{row.format('MOVED')} -= dt * flow", f"{row.format('CARRIES')} -= dt * flow * h")
        to.add(f"{row.format('OUT_MASS')} -= dt * flow", f"{row.format('OUT_ENTHALPY')} -= dt * flow * h")
        to.add(f"{row.format('OUT_ENTROPY')} -= dt * flow * s")
        if ratio != "0.0":
            with to.within(f"if {ratio} > 0.0 and T_oil > 0.0"):
                self._oil_out(to, row, f"flow * {ratio}")

    def _oil_out(self, to: Statements, row: str, oil: str) -> None:
        """Add oil that leaves (a negative stream) and its dissolved gas."""
        T = "T_felt" if self.network.roomed else "T_oil"
        to.add(f"{row.format('OUT_OIL')} -= dt * {oil}", f"{row.format('OUT_OIL_T')} -= dt * {oil} * {T}")
        to.add(f"{row.format('OUT_OIL_LOG')} -= dt * {oil} * math.log(T_oil)")
        if self.network.dissolves:
            to.add(f"{row.format('OUT_HELD')} -= dt * {oil} * w_gas")
            to.add(f"{row.format('OUT_HELD_ENTROPY')} -= dt * {oil} * all_held")

    def _film(self, to: Statements, row: str, beyond: PortState, line: str) -> None:
        """Add what an oil film generates in the chamber, or takes to the line beyond it (M254)."""
        generated = row.format("GENERATED")
        with to.within("if film > 0.0"):
            to.add(f"{generated} += dt * c_oil * {self._oil_arrival('film', beyond)}")
            if self.network.dissolves:
                to.add(f"{generated} += dt * {self._held_arrival('film', beyond.held)}")
        if line:
            with to.within(f"elif film < 0.0 and {line} and T_oil > 0.0"):
                self._oil_out(to, row, "film")

    def _drag(self, to: Statements, row: str, ahead: PortState, drag: str) -> None:
        """Add what oil generates that a wall drags into the chamber; it arrives at the chamber's pressure (M258)."""
        generated, call = row.format("GENERATED"), self._oil_arrival(drag, ahead)
        if self.network.roomed:  # without the work on the wall
            felt = f"{ahead.T_oil} - to_wall * P[P_ROOM] / c_oil"
            call = f"ledger__pressed_oil_arriving({drag}, {felt}, pressed - to_wall, T_felt, p, T_oil)"
        with to.within(f"if {drag} > 0.0"):
            to.add(*([f"to_wall = {ahead.p} - p"] if self.network.roomed else []))
            to.add(f"{generated} += dt * c_oil * {call}")
            if self.network.dissolves:
                to.add(f"{generated} += dt * {self._held_arrival(drag, ahead.held)}")

    # ---- heats and oil -----------------------------------------------------------------------------------------

    def _heats(self, to: Statements) -> None:
        """Add the heats of oil and walls, and the entropy they generate (M52, M171)."""
        network = self.network
        if network.heated:
            to.add("d = R[R_RATIO]")
        for label, each in zip(self.layout.heats[: len(network.heats)], network.heats, strict=True):
            row = f"heats[HEAT_{label}"
            to.add(f"heat = {each.call}", f"beyond = {each.factor}heat - heat", f"{row}, HEAT] += dt * heat")
            to.add(f"{row}, HEAT_GENERATED] += dt * heat * (1.0 / T - 1.0 / T_oil)")
            to.add("oil[LOST] += dt * beyond", "oil[LOST_OVER_T] += dt * beyond / T_oil")
        if network.heated and not network.carried:
            with to.within("if oiled > 0.0"):
                to.add("made = dt * (R[R_RATIO] * mass_rate + discharged)", "oil[MADE] += made")
                to.add("oil[MADE_T] += made * T_oil", "oil[MADE_LOG] += made * math.log(T_oil)")
        for label, wall in zip(self.layout.walls, network.walls, strict=True):
            row = f"heats[HEAT_{label}"
            to.add(f"warmth = {wall.temperature}", f"heat = dt * {wall.call} * (warmth - T)")
            to.add(f"{row}, HEAT] += heat", f"{row}, HEAT_GENERATED] += heat * (1.0 / T - 1.0 / warmth)")

    def _oil(self, to: Statements) -> None:
        """Add the oil that enters through ports (M105, M109), and the gas that oil releases (M197, M233)."""
        network, inflow = self.network, self.network.inflow
        flash, solution = network.flash, network.solution
        if inflow is None:
            return
        T = "T_felt" if network.roomed else "T_oil"
        to.add("width = P[P_DISCHARGE_WIDTH]", f"inflow = {inflow.call}")
        to.add("oil[PORT_MASS] += dt * inflow", "oil[PORT_PRESSURE] += dt * inflow * p")
        with to.within("if T_oil > 0.0"):
            to.add(f"rise = ({balances.port_oil_enthalpy(network)} - {T}) / T_oil")
            to.add("oil[PORT_GENERATED] += dt * inflow * c_oil * (rise - math.log(P[P_T_OIL] / T_oil))")
        if flash is not None:
            entropy = f"R[R_{flash.cell} + PLENUM_ENTROPY]"
            to.add(f"gas = inflow * max(0.0, {flash.share})", "oil[FLASH_MASS] += dt * gas")
            with to.within("if gas > 0.0"):
                to.add(f"oil[FLASH_GENERATED] += dt * ledger__arriving(gas, {flash.enthalpy}, {entropy}, h, s, T)")
                to.add(f"oil[FLASH_GENERATED] += dt * gas * {flash.heat} * c_oil * (1.0 / P[P_T_OIL] - 1.0 / T_oil)")
        if solution is not None:
            to.add(f"gas, enthalpy, warmth = {solution.release}", "warmth = warmth * c_oil")
            to.add("oil[FLASH_MASS] += dt * gas", "oil[RELEASED] += dt * warmth")
            to.add("oil[FLASH_GENERATED] += dt * (gas * (s - s_held) - warmth / T_oil)")
            to.add(f"oil[FLASH_GENERATED] += dt * {self._held_arrival('inflow', solution.in_supply)}")
