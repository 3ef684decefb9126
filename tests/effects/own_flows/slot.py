"""A slot between neighbours, and one to the suction line, through which the flow is laminar."""

from dataclasses import dataclass

from own_flows.viscous import slot_flux

from screwsim.effects.base import Effect, FlowPath, Law
from screwsim.inputs.declare import quantity
from screwsim.numerics.kernel import kernel


@dataclass(frozen=True)
class Parameters:
    """The slot."""

    height: float = quantity("length", "height of the slot", 50e-6, gt=0.0)
    length: float = quantity("length", "length of the slot along the flow", 20e-3, gt=0.0)
    width: float = quantity("length", "width of the slot across the flow", 0.1, gt=0.0)


@kernel
def cross_section(phi, size):
    """Return the cross-section [m²], the same at all angles."""
    return size


def build(parameters, machine):
    """Return both paths."""
    values = {"size": parameters.height * parameters.width, "height": parameters.height, "length": parameters.length}
    values["viscosity"] = 2e-5
    ends = ("neighbour", 1), ("suction", 0)
    return [FlowPath(to, cross_section, values, flow=Law(slot_flux), offset=offset) for to, offset in ends]


EFFECT = Effect("slot", "laminar slots", (), "a test", Parameters, build)
