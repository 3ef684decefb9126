"""A chamber that has no neighbours, at many angles, as text: its rates and their exact derivatives by the states.

What the integrator holds over a step (the phase of the gas, the switch of a valve, what rests on seat or stop) is held
as the memory behind the port state says, in the context of all chambers together (`model.trajectory.CoupledContext`).
"""

from functools import lru_cache
from typing import Any

from screwsim.model.network.chamber import Chamber
from screwsim.model.network.network import Network
from screwsim.model.network.surroundings import lines_texts, surroundings_text
from screwsim.numerics.kernel import Kernel


@lru_cache(maxsize=64)
def chamber_alone_texts(key: tuple[Any, ...]) -> tuple[tuple[str, ...], tuple[Kernel, ...]]:
    """Return the functions of the chamber of a network, given by its key, and the kernels that they call."""
    network = Network(*key)
    chamber = ChamberAlone(network)
    texts = chamber.rates(), chamber.jacobian(), *lines_texts(network, "chamber"), surroundings_text(network)
    return texts, (*network.kernels.values(), *chamber.tangents)


class ChamberAlone(Chamber):
    """The rates of one chamber and their exact derivatives."""

    context = "P, TAB, R, own = context.P, context.TAB, context.R, context.port_states"
    constant = ()
    jacobian_name = "exact_jacobian"
    exact = True
