"""The rates of all chambers with their directional derivative, as text: forward mode with one seed.

States, surroundings, parameters, tables and port states of lines have their changes in `y__along`, `E__along`,
`P__along`, `TAB__along`, `R__along`. So a number of the scene, `P[…]`, is a seed like a state, alone or with everything
that it changes. Derivatives of figures use rates in lanes instead, at a tenth of the cost; this text serves the tests,
which compare derivatives along every number, and as the basis of further exact derivatives.

Source: docs/model.md M1–M13; docs/explanation/integrator.md, derivatives along a direction.
"""

from functools import lru_cache
from typing import Any

from screwsim.model.network import balances
from screwsim.model.network.chambers import CONTEXT, GAS, NOZZLE, Chambers
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, Tangent, function
from screwsim.model.network.steps_together import held_phase
from screwsim.numerics.expressions import ALONG, slope_name
from screwsim.numerics.kernel import Kernel

GIVEN = ("y", "E", "P", "TAB", "R")  # arrays whose changes are given ...
WORKED = ("port_states", "work")  # ... those with intermediate results ...
FOUND = ("f", "g")  # ... and those whose changes are results
NAME = "chambers__rates_along"


@lru_cache(maxsize=64)
def along_text(key: tuple[Any, ...]) -> tuple[str, tuple[Kernel, ...]]:
    """Return the function of a network, given by its key, and the kernels that it calls."""
    network = Network(*key)
    made = Along(network)
    text = made.written()
    return text, (*network.kernels.values(), *made.tangents)


class Along(Chambers):
    """The rates of all chambers with their change along a direction; phases are those of the states."""

    def __init__(self, network: Network) -> None:
        super().__init__(network, exact=True)

    def written(self) -> str:
        """Return the text."""
        network, to, body = self.network, Statements(), Statements()
        if network.phases:
            with to.within(f"for j in range({network.chambers})"):
                at = "j * N"
                to.add(f"{held_phase(network, 'j')} = gas_phase(y[{at} + S_T], y[{at} + S_rho], P, TAB)")
        with body.within(f"for j in range({network.chambers})"):
            body.add("T = y[j * N + S_T]", "rho = y[j * N + S_rho]")
            body.add(f"phase = int({held_phase(network, 'j')})" if network.phases else "phase = 0")
            balances.gas_state(body, network)
            body.add(*(f"port_states[j * PORT_STATE + {at}] = {name}" for name, at in (GAS | NOZZLE).items()))
        body.add(*self._between(False))
        with body.within(f"for i in range({len(self._all)})"):
            body.add("g[i] = 0.0")
        with body.within(f"for j in range({network.chambers})"):
            self._read_own(body, False)
            self._taken(body)
            body.add(*self._body(False))
            self._stored(body)
        arrays = (*GIVEN, *WORKED, *FOUND)
        tangent = Tangent(body.lines, (ALONG,), network.kernels, {}, arrays=arrays)
        self.tangents = tangent.kernels
        text = '"""Fill f and g as `chambers__rates` does, and their changes along one of all that they take."""'
        beside = ", ".join(slope_name(name, ALONG) for name in arrays)
        return function(f"{NAME}(y, E, context, f, g, {beside})", [text, CONTEXT], to.lines, tangent.lines)
