"""The rates of all chambers and how they change along any change of what they take, as text: forward mode, one seed.

States, surroundings, parameters, tables and port states of lines have a change beside them, `y__along`, `E__along`,
`P__along`, `TAB__along`, `R__along`. So a number of the scene, `P[…]`, is a seed as a state is, alone or with all that
it moves. Figures have their derivatives by rates in lanes, which cost a tenth of this; it is the writer's seed for
parameters, by which tests hold the text's derivatives along every number, and with which exact ones of new kinds begin.

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
WORKED = ("port_states", "work")  # ... those in which numbers stand on the way ...
FOUND = ("f", "g")  # ... and those whose changes are found
NAME = "chambers__rates_along"


@lru_cache(maxsize=64)
def along_text(key: tuple[Any, ...]) -> tuple[str, tuple[Kernel, ...]]:
    """Return the function of a network, given by its key, and the kernels that it calls."""
    network = Network(*key)
    made = Along(network)
    text = made.written()
    return text, (*network.kernels.values(), *made.tangents)


class Along(Chambers):
    """The rates of all chambers with their change along one of all they take; phases stay as the states have them."""

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
