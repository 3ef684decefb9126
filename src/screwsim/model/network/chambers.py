"""All chambers alive at once, over one lobe pitch, as text: each gap is evaluated once and feeds both its chambers.

Source: docs/model.md M1–M13, M24. Chamber j is at s + j pitch; its states are y[j N …]. The flows between chambers are
summed first, then each chamber's balances use them. Derivatives of the balances are taken by the chamber's own states
and by what the others give it; the latter's derivatives follow from the states on both sides of each gap.

Where effects open chambers to suction beyond the injection angle, or to discharge before it, the gas that crosses that
angle includes those flows.
"""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any

from screwsim.model.network import balances
from screwsim.model.network.balances import between_texts
from screwsim.model.network.cell import CONSTANT, Cell
from screwsim.model.network.flows import PortState, port_state_of, read_port_state
from screwsim.model.network.layout import place_of_sum
from screwsim.model.network.network import Gap, Network
from screwsim.model.network.port_states import VARYING, port_state_texts
from screwsim.model.network.statements import Statements, Tangent, function
from screwsim.model.network.steps import step_texts
from screwsim.model.network.steps_together import BEFORE, HELD, step_texts_together
from screwsim.model.network.surroundings import lines_texts, surroundings_together_text
from screwsim.numerics.expressions import slope_name
from screwsim.numerics.kernel import Kernel

CONTEXT = "P, TAB, R, port_states, work = context.P, context.TAB, context.R, context.port_states, context.work"
GAS = {"p": "PRESSURE", "h": "ENTHALPY", "c_v": "C_V", "TpT": "TPT"}  # of a port state, with derivatives by T and rho
BOTH = ("T", "rho")
ANGLE = "COLUMNS - 1"  # the column of derivatives by the angle
BOTH_SIDES = ("", "j"), ("_ahead", "ahead")  # of a gap: suffix of names, index of the chamber


@lru_cache(maxsize=64)
def chambers_texts(key: tuple[Any, ...]) -> tuple[tuple[str, ...], tuple[Kernel, ...]]:
    """Return the functions of all chambers of a network, given by its key, and the kernels that they call."""
    network = Network(*key)
    chambers, exact = Chambers(network), Chambers(network, exact=True)
    of_one = [*port_state_texts(network), *between_texts(network), *step_texts(network)]
    of_one += [*lines_texts(network, "chambers"), surroundings_together_text(network)]
    jacobians = chambers.jacobian(), *((exact.jacobian(),) if _has_exact(network) else ())
    texts = chambers.rates(), *jacobians, *step_texts_together(network), *of_one
    return texts, (*network.kernels.values(), *chambers.tangents, *exact.tangents)


def _has_exact(network: Network) -> bool:
    """Return whether an exact Jacobian differs from the integrator's: for a gas that varies or has two phases."""
    return network.varies or network.phases


def room(network: Network) -> int:
    """Return the size of the working array of the functions of all chambers."""
    n, slopes = network.chambers, len(BOTH) * len(GAS | (VARYING if _has_exact(network) else {}))
    return n * (slopes + len(given(network)) * (n * len(network.states) + 2))


def work_constants(network: Network) -> dict[str, int]:
    """Return indices in the working array of what each chamber is given (`GIVEN_mass` …), and of slopes (`Chambers`).

    `BY_p_T` is the slope of the pressure by the temperature; the last of `COLUMNS` is that by the angle.
    """
    found = {"GIVEN": len(given(network)), "COLUMNS": network.chambers * len(network.states) + 1}
    found |= {f"GIVEN_{quantity}": k for k, quantity in enumerate(given(network))}
    found |= {f"BY_{name}_{seed}": i for i, (name, seed) in enumerate((a, b) for a in GAS | VARYING for b in BOTH)}
    found["GAS_SLOPES"] = network.chambers * found["GIVEN"]
    for ends, gas in (("", GAS), ("_EXACT", GAS | VARYING)):
        found[f"OF_GAS{ends}"] = len(gas) * len(BOTH)
        found[f"GIVEN_SLOPES{ends}"] = found["GAS_SLOPES"] + network.chambers * found[f"OF_GAS{ends}"]
    return found


def given(network: Network) -> tuple[str, ...]:
    """Return what a gap gives the chamber behind: each quantity, taken from the one ahead, and work on walls (M257)."""
    return (*network.quantities, *(("pushed",) if network.pushes else ()))


class Chambers(Cell):
    """The functions of all chambers.

    `work` holds what each is given, slopes of its gas, and slopes of what it is given. The integrator's Jacobian
    holds a gas's exponent and choking constant, and sets the phase from the states, which is held from then on; an
    `exact` one differentiates them, and uses the held phase.
    """

    e = "e + "
    together = True

    def __init__(self, network: Network, exact: bool = False) -> None:
        super().__init__(network)
        self.jacobian_name = "exact_jacobian" if exact else "jacobian"
        # the numbers of a port state that have derivatives
        self.gas, self.constant = (GAS | VARYING, ()) if exact else (GAS, CONSTANT)
        self.of_gas = [(name, seed) for name in self.gas for seed in BOTH]
        self.exact, self.ends = exact, "_EXACT" if exact else ""  # of the names of `work_constants`
        self.tangents: list[Kernel] = []

    # ---- gaps --------------------------------------------------------------------------------------------------

    def _read_own(self, to: Statements, slopes: bool) -> None:
        """Read a chamber's states, surroundings and gas."""
        to.add("e = j * E_CHAMBER", "own = j * N", *self.states("own + "))
        to.add(*(f"{name} = port_states[j * PORT_STATE + {at}]" for name, at in (GAS | VARYING).items()))
        if slopes:
            self._read_slopes(to, "", "j")

    def _read_slopes(self, to: Statements, of: str, j: str) -> None:
        """Read the derivatives of a chamber's gas by its temperature and density."""
        for name, seed in self.of_gas:
            to.add(f"{slope_name(name + of, seed + of)} = {self._gas_slope(j, name, seed)}")

    def _gas_slope(self, j: str, name: str, seed: str) -> str:
        """Return where the derivative of a number of chamber j's gas is."""
        return f"work[GAS_SLOPES + {j} * OF_GAS{self.ends} + BY_{name}_{seed}]"

    def _given_slope(self, row: str, quantity: str, column: str) -> str:
        """Return where the derivative of what chamber `row` is given is, by the state or angle of a column."""
        return f"work[GIVEN_SLOPES{self.ends} + ({row} * GIVEN + GIVEN_{quantity}) * COLUMNS + {column}]"

    def _read_other(self, to: Statements, slopes: bool) -> None:
        """Read states and gas of the chamber `ahead`."""
        states = [name for name in self.network.states if name not in self.network.own_states]
        to.add(*(f"{name}_ahead = y[ahead * N + S_{name}]" for name in states))
        asked = {"p": "PRESSURE", "h": "ENTHALPY"} | VARYING
        to.add(*(f"{name}_ahead = port_states[ahead * PORT_STATE + {at}]" for name, at in asked.items()))
        if slopes:
            self._read_slopes(to, "_ahead", "ahead")

    def _given(self, gap: Gap) -> list[str]:
        """Return the statements for what a gap gives a chamber, from the states of both sides to the sums `…_given`."""
        to = Statements()
        balances.oil_room(to, self.network)
        balances.oil_room(to, self.network, "_ahead")
        self.begin(to, ["given"])
        if self.network.pushes:
            to.add("pushed = 0.0")
        names = (self.own.p, self.own.rho, self.own.h, *VARYING, self.own.oil_ratio, self.own.T_oil, self.own.held)
        self.gap(to, gap, "given", "given", PortState(*(name if name == "0.0" else name + "_ahead" for name in names)))
        if self.network.pushes:
            to.add("pushed_given = pushed")
        return to.lines

    def _between(self, slopes: bool) -> list[str]:
        """Return the statements that sum the flows between chambers, and their derivatives."""
        network, to = self.network, Statements()
        first = f"GIVEN_SLOPES{self.ends}"
        for span in ("CHAMBERS * GIVEN", *([f"{first}, {first} + CHAMBERS * GIVEN * COLUMNS"] if slopes else [])):
            with to.within(f"for i in range({span})"):
                to.add("work[i] = 0.0")
        if not network.gaps:
            return to.lines
        to.add("# what chambers give each other: a gap is evaluated once, what leaves one enters another (M10–M13)")
        with to.within("for j in range(CHAMBERS)"):
            self._read_own(to, slopes)
            if network.slow and any(gap.drag for gap in network.gaps):
                to.add(f"slow = {network.slow}")
            for gap in network.gaps:
                to.add(f"ahead = j + {network.offsets[gap.side]}")
                with to.within("if ahead < CHAMBERS"):
                    at = f"{self.e}{self.layout.area(gap)}"
                    with to.within(self.opened(to, f"{gap.effect} (M12)", at, slopes)):
                        self._read_other(to, slopes)
                        tangent = self._tangent(to, gap) if slopes else None
                        to.add(*(tangent.lines if tangent else self._given(gap)))
                        self._gives(to, _is_given, lambda quantity: f"{quantity}_given")
                        if tangent:
                            self._give_slopes(to, tangent)
        return to.lines

    def _gives(self, to: Statements, at: Callable[[str, str], str], text: Callable[[str], str]) -> None:
        """Add a term for each quantity to what a chamber is given, and subtract it from the one ahead."""
        for quantity in given(self.network):
            found = text(quantity)
            if found != "0.0":
                to.add(f"{at('j', quantity)} += {found}")
                if quantity in self.network.quantities:
                    to.add(f"{at('ahead', quantity)} -= {found}")

    @property
    def _columns_by_seed(self) -> dict[str, str]:
        """The columns of the derivatives of what a gap gives: by the states of both sides, and by the angle."""
        states = [name for name in self.network.states if name not in self.network.own_states]
        found = {f"{name}{of}": f"{j} * N + S_{name}" for name in states for of, j in BOTH_SIDES}
        return found | {"phi": ANGLE}

    def _tangent(self, to: Statements, gap: Gap) -> Tangent:
        pairs = [(name + of, seed + of) for name, seed in self.of_gas for of, _ in BOTH_SIDES]
        slopes = {pair: slope_name(*pair) for pair in pairs} | {("area", "phi"): "(next_area - area) * per_delta"}
        if self.network.slow and gap.drag:
            slopes["slow", "phi"] = self.by_angle()["slow", "phi"]
        to.add(*(f"{slope_name(*pair)} = {slopes[pair]}" for pair in slopes if "phi" in pair))
        held = [f"{name}{of}" for name in self.constant for of, _ in BOTH_SIDES]
        found = Tangent(self._given(gap), tuple(self._columns_by_seed), self.network.kernels, slopes, held)
        self.tangents += found.kernels
        return found

    def _give_slopes(self, to: Statements, tangent: Tangent) -> None:
        for seed, column in self._columns_by_seed.items():
            at = partial(self._given_slope, column=column)
            self._gives(to, at, lambda quantity, seed=seed: tangent.slope(f"{quantity}_given", seed))

    # ---- chambers ----------------------------------------------------------------------------------------------

    def _body(self, slopes: bool) -> list[str]:
        """Return the statements of one of the chambers, from what it is given to rates and quadratures."""
        network, to = self.network, Statements()
        balances.oil_room(to, network)
        balances.gas_inside(to, network)
        to.add("# streams: mass, enthalpy, oil, in and out of lines and plenums (M10–M13)")
        self.begin(to, [each for each in self.sums if each != "between"])
        to.add(*(["pushed = pushed_between"] if network.pushes else []))
        for port in network.ports:
            self.port(to, port, slopes)
        discharge = network.lines[1]
        for gap in network.gaps:
            with to.within(f"if j + {network.offsets[gap.side]} >= CHAMBERS"):  # beyond lies the discharge line
                at = f"{self.e}{self.layout.area(gap)}"
                with to.within(self.opened(to, f"{gap.effect} (M12)", at, slopes)):
                    read_port_state(to, network, discharge, *self.line(discharge))
                    self.gap(to, gap, f"{discharge}_in", f"{discharge}_out", port_state_of(network, discharge))
        balances.oil_through_ports(to, network)
        self.finish(to)
        self._crossing(to)
        to.add(*(f"q_{each} = 0.0" for each in self.layout.met))
        return to.lines

    def _crossing(self, to: Statements) -> None:
        """Set the gas that passes from chambers beyond the injection angle to those before it (slots.py)."""
        suction, discharge, *others = [cell for cell in self.network.cells if cell]
        entering = ["mass_between", *(f"mass_{cell}_{way}" for cell in others for way in ("in", "out"))]
        leaving = ["0.0"]
        if self.network.across:
            entering += [f"mass_{discharge}_in", f"mass_{discharge}_out"]
            leaving = [f"mass_{suction}_in", f"mass_{suction}_out"]
        with to.within(f"if {BEFORE}"):
            to.add(f"q_crossing = ({' + '.join(entering)}) * per_omega")
        with to.within("else"):
            to.add(f"q_crossing = -({' + '.join(leaving)}) * per_omega")

    def _taken(self, to: Statements) -> None:
        """Read what a chamber is given by the others."""
        to.add(*(f"{quantity}_between = {_is_given('j', quantity)}" for quantity in given(self.network)))

    @property
    def _all(self) -> list[str]:
        """The quadratures of all chambers; flows between them cancel."""
        return [*self.quadratures, "q_crossing"]

    def _summed(self, name: str) -> bool:
        """Return whether a quadrature is summed over the chambers."""
        return not name.endswith("_between")

    def _stored(self, to: Statements) -> None:
        to.add(*(f"f[own + S_{name}] = f_{name}" for name in self.network.states))
        to.add(*(f"g[{place_of_sum(name)}] += {name}" for name in self._all if self._summed(name)))

    def rates(self) -> str:
        """Return the text of dy/dφ of all chambers, and of the rates of their quadratures."""
        to = Statements()
        with to.within("for j in range(CHAMBERS)"):
            to.add(f"chamber__port_state({HELD}, y, j * N, P, TAB, port_states, j * PORT_STATE)")
        to.add(*self._between(False))
        with to.within("for i in range(Q_crossing + 1)"):
            to.add("g[i] = 0.0")
        with to.within("for j in range(CHAMBERS)"):
            self._read_own(to, False)
            self._taken(to)
            to.add(*self._body(False))
            self._stored(to)
        text = '"""Fill f = dy/dphi of all chambers, and g: their quadrature rates, gas between both sides last."""'
        return function("chambers__rates(y, E, context, f, g)", [text, CONTEXT], to.lines)

    def _gas(self, to: Statements) -> None:
        """Fill the port states of all chambers, and store the derivatives of their gas."""
        network, body = self.network, Statements()
        balances.gas_state(body, network)
        tangent = Tangent(body.lines, BOTH, network.kernels, {}, self.constant)
        self.tangents += tangent.kernels
        with to.within("for j in range(CHAMBERS)"):
            to.add("T = y[j * N + S_T]", "rho = y[j * N + S_rho]")
            of_states = "phase = gas_phase(T, rho, P, TAB)"
            if self.exact and network.phases:
                to.add(f"{of_states} if {HELD} == FREE else int({HELD})")
            else:
                to.add(*([of_states, f"{HELD} = phase"] if network.phases else ["phase = 0"]))
            to.add(*tangent.lines)
            to.add(*(f"port_states[j * PORT_STATE + {at}] = {name}" for name, at in (GAS | VARYING).items()))
            for name, seed in self.of_gas:
                to.add(f"{self._gas_slope('j', name, seed)} = {tangent.slope(name, seed)}")

    def jacobian(self) -> str:
        """Return the text of the rates of all chambers and their derivatives by the states and by the angle."""
        network, to = self.network, Statements()
        states, quantities = network.states, given(network)
        to.add("per_delta = 1.0 / delta")
        self._gas(to)
        to.add(*self._between(True))
        with to.within("for i in range(Q_crossing + 1)"):
            to.add("g[i] = 0.0", "g_phi[i] = 0.0")
            with to.within("for k in range(COLUMNS - 1)"):
                to.add("Jq[i, k] = 0.0")
        with to.within("for j in range(CHAMBERS)"):
            self._read_own(to, True)
            self._taken(to)
            slopes = self.by_angle()
            to.add(*(f"{slope_name(name, 'phi')} = {slopes[name, 'phi']}" for name in ("V", "dV")))
            slopes |= {pair: slope_name(*pair) for pair in self.of_gas}
            seeds = (*states, "phi", *(f"{quantity}_between" for quantity in quantities))
            tangent = Tangent(self._body(True), seeds, network.kernels, slopes, self.constant)
            self.tangents += tangent.kernels
            to.add(*tangent.lines)
            self._stored(to)
            self._columns(to, tangent)
        text = '"""Fill f, g and their derivatives by y and by phi, for all chambers; E_next is E at phi + delta."""'
        head = f"chambers__{self.jacobian_name}(y, E, E_next, delta, context, f, g, J, Jq, f_phi, g_phi)"
        return function(head, [text, CONTEXT], to.lines)

    def _columns(self, to: Statements, tangent: Tangent) -> None:
        """Store the derivatives of a chamber's rates, by its own states and by what the others give it."""
        network, quantities = self.network, given(self.network)

        def through(name: str, column: str) -> str:
            """Return the part of a derivative through the sums between chambers."""
            slopes = {quantity: tangent.slope(name, f"{quantity}_between") for quantity in quantities}
            at = partial(self._given_slope, "j", column=column)
            terms = [f"{slope} * {at(quantity)}" for quantity, slope in slopes.items() if slope != "0.0"]
            return " + ".join(terms) or "0.0"

        rows = {f"J[own + S_{name}, {{}}]": f"f_{name}" for name in network.states}
        crossing = [(place_of_sum(name), name) for name in self._all if name in ("q_pushed", "q_crossing")]
        with to.within("for c in range(COLUMNS - 1)"):
            to.add(*(f"{row.format('c')} = {through(name, 'c')}" for row, name in rows.items()))
            to.add(*(f"Jq[{at}, c] += {through(name, 'c')}" for at, name in crossing))
        for state in network.states:
            at = f"own + S_{state}"
            to.add(*(f"{row.format(at)} += {tangent.slope(name, state)}" for row, name in rows.items()))
            for name in self._all:
                slope = tangent.slope(name, state)
                if self._summed(name) and slope != "0.0":
                    to.add(f"Jq[{place_of_sum(name)}, {at}] += {slope}")
        for state in network.states:
            to.add(f"f_phi[own + S_{state}] = {tangent.slope(f'f_{state}', 'phi')} + {through(f'f_{state}', ANGLE)}")
        for name in self._all:
            if self._summed(name):
                to.add(f"g_phi[{place_of_sum(name)}] += {tangent.slope(name, 'phi')}")
        to.add(*(f"g_phi[{at}] += {through(name, ANGLE)}" for at, name in crossing))


def _is_given(row: str, quantity: str) -> str:
    """Return where what chamber `row` is given is."""
    return f"work[{row} * GIVEN + GIVEN_{quantity}]"
