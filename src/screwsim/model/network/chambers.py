"""All chambers alive at once, over one lobe pitch, as text: a gap is evaluated once, what leaves one enters another.

Source: docs/model.md M1–M13, M24. Chamber j stands at s + j pitch; its states are y[j N …]. What the chambers give each
other is summed first, then each closes its balances with it. The derivatives of these are made by the chamber's own
states and by what the others give it; that again follows from the states of both sides of each gap.

Where effects open chambers beyond the injection angle to suction, or others to discharge, what enters the chambers
before that angle from those beyond it is counted with what the lines' sums take for the other side's.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from screwsim.model.network import balances
from screwsim.model.network.between import between_texts
from screwsim.model.network.cell import CONSTANT, Cell
from screwsim.model.network.flows import Place, place_of, read_place
from screwsim.model.network.network import Gap, Network
from screwsim.model.network.places import place_texts
from screwsim.model.network.statements import Statements, Tangent, function
from screwsim.model.network.steps import step_texts
from screwsim.model.network.steps_together import SIDE, held_phase, step_texts_together
from screwsim.numerics.expressions import slope_name
from screwsim.numerics.kernel import Kernel

CONTEXT = "P, TAB, R, places, work = context.P, context.TAB, context.R, context.places, context.work"
GAS = {"p": "PRESSURE", "h": "ENTHALPY", "c_v": "C_V", "TpT": "TPT"}  # of a place, with derivatives by T and rho
NOZZLE = {"exponent": "EXPONENT", "choke": "CHOKE", "choked": "CHOKED"}
BOTH = ("T", "rho")
BOTH_SIDES = ("", "j"), ("_ahead", "ahead")  # of a gap: how names of its numbers end, and the number of the chamber


@lru_cache(maxsize=64)
def chambers_texts(key: tuple[Any, ...]) -> tuple[tuple[str, ...], tuple[Kernel, ...]]:
    """Return the functions of all chambers of a network, given by its key, and the kernels that they call."""
    network = Network(*key)
    chambers, exact = Chambers(network), Chambers(network, exact=True)
    of_one = [*place_texts(network), *between_texts(network), *step_texts(network)]
    jacobians = chambers.jacobian(), *((exact.jacobian(),) if network.varies else ())
    texts = chambers.rates(), *jacobians, *step_texts_together(network), *of_one
    return texts, (*network.kernels.values(), *chambers.tangents, *exact.tangents)


def room(network: Network) -> int:
    """Return how many numbers the functions of all chambers write into their working array."""
    n, slopes = network.chambers, len(BOTH) * len(GAS | (NOZZLE if network.varies else {}))
    return n * (slopes + len(given(network)) * (n * len(network.states) + 2))


def given(network: Network) -> tuple[str, ...]:
    """Return what a gap gives the chamber behind: of each quantity, taken from the one ahead, and to walls (M257)."""
    return (*network.quantities, *(("pushed",) if network.pushes else ()))


class Chambers(Cell):
    """The functions of all chambers; `work` takes what each is given, slopes of its gas, and of what it is given.

    The integrator's Jacobian takes a gas's exponent and choking for constant; an `exact` one follows them.
    """

    e = "e + "
    lines = "ALL_LINES"

    def __init__(self, network: Network, exact: bool = False) -> None:
        super().__init__(network)
        self.jacobian_name = "exact_jacobian" if exact else "jacobian"
        self.gas, self.constant = (GAS | NOZZLE, ()) if exact else (GAS, CONSTANT)  # what of a place has derivatives
        self.of_gas = [(name, seed) for name in self.gas for seed in BOTH]
        self.n, self.width = len(network.states), len(given(network))
        self.size = f"E_AREAS + {len(network.ports) + len(network.gaps)}"
        self.columns = network.chambers * self.n + 1
        self.kept = network.chambers * self.width  # where the slopes of the gas begin
        self.slopes = self.kept + network.chambers * len(self.of_gas)  # where those of what is given begin
        self.tangents: list[Kernel] = []

    # ---- gaps --------------------------------------------------------------------------------------------------

    def _read_own(self, to: Statements, slopes: bool) -> None:
        """Read a chamber's states, surroundings and gas."""
        to.add(f"e = j * ({self.size})", f"own = j * {self.n}", *self.states("own + "))
        to.add(*(f"{name} = places[j * PLACE + {at}]" for name, at in (GAS | NOZZLE).items()))
        if slopes:
            self._read_slopes(to, "", "j")

    def _read_slopes(self, to: Statements, of: str, j: str) -> None:
        """Read the derivatives of a chamber's gas by its temperature and density."""
        for i, (name, seed) in enumerate(self.of_gas):
            to.add(f"{slope_name(name + of, seed + of)} = work[{self.kept} + {j} * {len(self.of_gas)} + {i}]")

    def _other(self, of: str) -> Place:
        """Return the names of the numbers of another chamber's place."""
        names = (self.own.p, self.own.rho, self.own.h, *NOZZLE, self.own.oil_ratio, self.own.T_oil, self.own.held)
        return Place(*(name if name == "0.0" else name + of for name in names))

    def _read_other(self, to: Statements, slopes: bool) -> None:
        """Read states and gas of the chamber `ahead`."""
        states = [name for name in self.network.states if name not in self.network.own_states]
        to.add(*(f"{name}_ahead = y[ahead * {self.n} + {i}]" for i, name in enumerate(states)))
        asked = {"p": "PRESSURE", "h": "ENTHALPY"} | NOZZLE
        to.add(*(f"{name}_ahead = places[ahead * PLACE + {at}]" for name, at in asked.items()))
        if slopes:
            self._read_slopes(to, "_ahead", "ahead")

    def _given(self, gap: Gap) -> list[str]:
        """Return the statements of what a gap gives a chamber, from the states of both sides to the sums `…_given`."""
        to = Statements()
        balances.oil_room(to, self.network)
        balances.oil_room(to, self.network, "_ahead")
        self.begin(to, ["given"])
        if self.network.pushes:
            to.add("pushed = 0.0")
        self.gap(to, gap, "given", "given", self._other("_ahead"))
        if self.network.pushes:
            to.add("pushed_given = pushed")
        return to.lines

    def _between(self, slopes: bool) -> list[str]:
        """Return the statements that sum what the chambers give each other, and its derivatives."""
        network, to = self.network, Statements()
        end = self.slopes + network.chambers * self.width * self.columns
        for span in (f"{self.kept}", *([f"{self.slopes}, {end}"] if slopes else [])):
            with to.within(f"for i in range({span})"):
                to.add("work[i] = 0.0")
        if not network.gaps:
            return to.lines
        with to.within(f"for j in range({network.chambers})"):
            self._read_own(to, slopes)
            if network.slow and any(gap.drag for gap in network.gaps):
                to.add(f"slow = {network.slow}")
            for gap in network.gaps:
                to.add(f"ahead = j + {network.offsets[gap.side]}")
                with to.within(f"if ahead < {network.chambers}"):
                    at = f"{self.e}E_AREAS + {len(network.ports) + gap.index}"
                    with to.within(self.opened(to, f"{gap.effect} (M12)", at, slopes)):
                        self._read_other(to, slopes)
                        tangent = self._tangent(to, gap) if slopes else None
                        to.add(*(tangent.lines if tangent else self._given(gap)))
                        at = f"work[{{row}} * {self.width} + {{k}}]"
                        self._gives(to, at, lambda quantity: f"{quantity}_given")
                        if tangent:
                            self._give_slopes(to, tangent)
        return to.lines

    def _gives(self, to: Statements, at: str, text: Callable[[str], str]) -> None:
        """Add something of each quantity to what a chamber is given, and take it from the one ahead."""
        for k, quantity in enumerate(given(self.network)):
            found = text(quantity)
            if found != "0.0":
                to.add(f"{at.format(row='j', k=k)} += {found}")
                if quantity in self.network.quantities:
                    to.add(f"{at.format(row='ahead', k=k)} -= {found}")

    @property
    def _columns_by_seed(self) -> dict[str, str]:
        """Return the columns of the derivatives of what a gap gives: by the states of both sides, and by the angle."""
        states = [name for name in self.network.states if name not in self.network.own_states]
        found = {f"{name}{of}": f"{j} * {self.n} + {i}" for i, name in enumerate(states) for of, j in BOTH_SIDES}
        return found | {"phi": str(self.columns - 1)}

    def _tangent(self, to: Statements, gap: Gap) -> Tangent:
        """Return what a gap gives with its derivatives."""
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
        """Add the derivatives of what a gap gives."""
        for seed, column in self._columns_by_seed.items():
            at = f"work[{self.slopes} + ({{row}} * {self.width} + {{k}}) * {self.columns} + {column}]"
            self._gives(to, at, lambda quantity, seed=seed: tangent.slope(f"{quantity}_given", seed))

    # ---- chambers ----------------------------------------------------------------------------------------------

    def _body(self, slopes: bool) -> list[str]:
        """Return the statements of one of the chambers, from what it is given to rates and quadratures."""
        network, to = self.network, Statements()
        balances.oil_room(to, network)
        balances.gas_inside(to, network)
        self.begin(to, [each for each in self.sums if each != "between"])
        to.add(*(["pushed = pushed_between"] if network.pushes else []))
        for port in network.ports:
            self.port(to, port, slopes)
        discharge = network.cells[1]
        for gap in network.gaps:
            with to.within(
                f"if j + {network.offsets[gap.side]} >= {network.chambers}"
            ):  # beyond lies the discharge line
                at = f"{self.e}E_AREAS + {len(network.ports) + gap.index}"
                with to.within(self.opened(to, f"{gap.effect} (M12)", at, slopes)):
                    read_place(to, network, discharge, *self.line(1))
                    self.gap(to, gap, f"{discharge}_in", f"{discharge}_out", place_of(network, discharge))
        balances.oil_through_ports(to, network)
        self.finish(to)
        self._crossing(to)
        to.add(*(f"q_{way}_{side} = 0.0" for side in range(len(network.offsets)) for way in ("ahead", "behind")))
        return to.lines

    def _crossing(self, to: Statements) -> None:
        """Set the gas that enters a chamber before the injection angle from those beyond it (slots.py)."""
        suction, discharge, *others = [cell for cell in self.network.cells if cell]
        entering = ["mass_between", *(f"mass_{cell}_{way}" for cell in others for way in ("in", "out"))]
        leaving = ["0.0"]
        if self.network.across:
            entering += [f"mass_{discharge}_in", f"mass_{discharge}_out"]
            leaving = [f"mass_{suction}_in", f"mass_{suction}_out"]
        with to.within("if side == 0"):
            to.add(f"crossing = ({' + '.join(entering)}) * per_omega")
        with to.within("else"):
            to.add(f"crossing = -({' + '.join(leaving)}) * per_omega")

    def _taken(self, to: Statements) -> None:
        """Read what a chamber is given by the others, and on which side of the injection it stands."""
        for k, quantity in enumerate(given(self.network)):
            to.add(f"{quantity}_between = work[j * {self.width} + {k}]")
        to.add(f"side = {SIDE}")

    @property
    def _all(self) -> list[str]:
        """Return the quadratures of all chambers; what they give each other cancels."""
        return [*self.quadratures, "crossing"]

    def _summed(self, name: str) -> bool:
        """Tell whether a quadrature is summed over the chambers."""
        return not name.endswith("_between")

    def _stored(self, to: Statements) -> None:
        to.add(*(f"f[own + {i}] = f_{name}" for i, name in enumerate(self.network.states)))
        to.add(*(f"g[{i}] += {name}" for i, name in enumerate(self._all) if self._summed(name)))

    def rates(self) -> str:
        """Return the text of dy/dφ of all chambers, and of the rates of their quadratures."""
        network, to = self.network, Statements()
        with to.within(f"for j in range({network.chambers})"):
            phase = held_phase(network, "j")
            to.add(f"chamber__place({phase}, y, j * {self.n}, P, TAB, places, j * PLACE)")
        to.add(*self._between(False))
        with to.within(f"for i in range({len(self._all)})"):
            to.add("g[i] = 0.0")
        with to.within(f"for j in range({network.chambers})"):
            self._read_own(to, False)
            self._taken(to)
            to.add(*self._body(False))
            self._stored(to)
        text = '"""Fill f = dy/dphi of all chambers, and g: their quadrature rates, gas between both sides last."""'
        return function("chambers__rates(y, E, context, f, g)", [text, CONTEXT], to.lines)

    def _gas(self, to: Statements) -> None:
        """Fill the places of all chambers, and keep the derivatives of their gas."""
        network, body = self.network, Statements()
        balances.gas_state(body, network)
        tangent = Tangent(body.lines, BOTH, network.kernels, {}, self.constant)
        self.tangents += tangent.kernels
        with to.within(f"for j in range({network.chambers})"):
            to.add(f"T = y[j * {self.n}]", f"rho = y[j * {self.n} + 1]")
            phase = held_phase(network, "j")
            to.add(*(["phase = gas_phase(T, rho, P, TAB)", f"{phase} = phase"] if network.phases else ["phase = 0"]))
            to.add(*tangent.lines)
            to.add(*(f"places[j * PLACE + {at}] = {name}" for name, at in (GAS | NOZZLE).items()))
            for i, (name, seed) in enumerate(self.of_gas):
                to.add(f"work[{self.kept} + j * {len(self.of_gas)} + {i}] = {tangent.slope(name, seed)}")

    def jacobian(self) -> str:
        """Return the text of the rates of all chambers and their derivatives by the states and by the angle."""
        network, to = self.network, Statements()
        states, quantities = network.states, given(network)
        to.add("per_delta = 1.0 / delta")
        self._gas(to)
        to.add(*self._between(True))
        with to.within(f"for i in range({len(self._all)})"):
            to.add("g[i] = 0.0", "g_phi[i] = 0.0")
            with to.within(f"for k in range({self.columns - 1})"):
                to.add("Jq[i, k] = 0.0")
        with to.within(f"for j in range({network.chambers})"):
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
        at = f"work[{self.slopes} + (j * {self.width} + {{k}}) * {self.columns} + {{column}}]"

        def through(name: str, column: str) -> str:
            """Return what a derivative has through the sums between the chambers."""
            slopes = [tangent.slope(name, f"{quantity}_between") for quantity in quantities]
            terms = [f"{slope} * {at.format(k=k, column=column)}" for k, slope in enumerate(slopes) if slope != "0.0"]
            return " + ".join(terms) or "0.0"

        rows = {f"J[own + {i}, {{}}]": f"f_{name}" for i, name in enumerate(network.states)}
        crossing = [(i, name) for i, name in enumerate(self._all) if name in ("q_pushed", "crossing")]
        with to.within(f"for c in range({self.columns - 1})"):
            to.add(*(f"{row.format('c')} = {through(name, 'c')}" for row, name in rows.items()))
            to.add(*(f"Jq[{i}, c] += {through(name, 'c')}" for i, name in crossing))
        for k, state in enumerate(network.states):
            to.add(*(f"{row.format(f'own + {k}')} += {tangent.slope(name, state)}" for row, name in rows.items()))
            for i, name in enumerate(self._all):
                slope = tangent.slope(name, state)
                if self._summed(name) and slope != "0.0":
                    to.add(f"Jq[{i}, own + {k}] += {slope}")
        column = str(self.columns - 1)
        for i, state in enumerate(network.states):
            to.add(f"f_phi[own + {i}] = {tangent.slope(f'f_{state}', 'phi')} + {through(f'f_{state}', column)}")
        for i, name in enumerate(self._all):
            if self._summed(name):
                to.add(f"g_phi[{i}] += {tangent.slope(name, 'phi')}")
        to.add(*(f"g_phi[{i}] += {through(name, column)}" for i, name in crossing))
