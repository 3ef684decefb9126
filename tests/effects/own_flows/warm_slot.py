"""The same slots by a law that takes the enthalpies of the gas."""

from dataclasses import replace

from own_flows import slot
from own_flows.viscous import flux_of_warm_gas

from screwsim.effects.base import Law


def build(parameters, machine):
    """Return both paths."""
    return [replace(path, flow=Law(flux_of_warm_gas)) for path in slot.build(parameters, machine)]


EFFECT = replace(slot.EFFECT, name="warm_slot", build=build)
