"""A kind of flow that the package does not have, and the effect that uses it: gas and oil in layers of one slot.

Oil covers a share of the slot's height, as much as the chamber has oil where the pressure is higher; above it flows the
gas. Both flow laminar. A wall may wipe oil along, from the chamber ahead or the line.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from screwsim.effects.base import GAS, OIL, Bounds, Effect, FlowKind, FlowPath, PathStream
from screwsim.inputs.declare import number, quantity
from screwsim.numerics.kernel import Kernel, kernel

COVERED_AT = 8.0  # kg of oil per kg of gas: the slot is full


@kernel
def covered(ratio):
    """Return the share of the height that oil covers, C1."""
    u = min(max(ratio, 0.0) / COVERED_AT, 1.0)
    return u * u * (3.0 - 2.0 * u)


@kernel
def gas_layer(rise, mean, ratio, height, length, viscosity):
    """Return the flux [kg/(m² s)] of the gas: plane Poiseuille flow in the height that oil leaves."""
    left = height * (1.0 - covered(ratio))
    return left * left * left / height * mean * rise / (12.0 * viscosity * length)


@kernel
def oil_layer(rise, ratio, height, length, of_oil, oil_density):
    """Return the flux [kg/(m² s)] of the oil: plane Poiseuille flow in the height that it covers."""
    full = height * covered(ratio)
    return full * full * full / height * oil_density * rise / (12.0 * of_oil * length)


@kernel
def wiped_oil(oil_ratio, wiped, oil_density, tip_speed):
    """Return the flux [kg/(m² s)] of the oil that a wall takes along."""
    return wiped * covered(oil_ratio) * oil_density * tip_speed


@dataclass(frozen=True)
class Layers(FlowKind):
    """Gas and oil in layers of one slot, each by its own law, and oil that a wall wipes along."""

    gas: Kernel = gas_layer
    oil: Kernel = oil_layer
    wiping: Kernel | None = None

    roles = MappingProxyType({"gas": ("rise", "mean", "ratio"), "oil": ("rise", "ratio"), "wiping": ("oil_ratio",)})
    bounds = MappingProxyType({"wiping": Bounds("wiped oil", "kg/(m² s)", 0.0)})

    def streams(self, calls: Mapping[str, str]) -> Sequence[PathStream]:
        """Return both layers, and what a wall wipes along."""
        source = ["rise = {beyond.p} - {own.p}", "ratio = {beyond.oil_ratio} if rise >= 0.0 else {own.oil_ratio}"]
        found = [
            PathStream(GAS, [*source, "mean = 0.5 * ({own.rho} + {beyond.rho})"], calls["gas"]),
            PathStream(OIL, source, calls["oil"]),
        ]
        if self.wiping is not None:
            along = ["oil_ratio = {leading.oil_ratio}", f"moved = {calls['wiping']}{{per_slow}}"]
            found.append(PathStream(OIL, along, "moved", driven=True))
        return found


@dataclass(frozen=True)
class Parameters:
    """The slots, one to the chamber ahead and one to the suction line."""

    height: float = quantity("length", "height of the slot", 60e-6, gt=0.0)
    length: float = quantity("length", "length of the slot along the flow", 20e-3, gt=0.0)
    width: float = quantity("length", "width of the slot across the flow", 0.1, gt=0.0)
    wiped: float = number("speed of the wall over the tip speed", 0.0)


@kernel
def cross_section(phi, size):
    """Return the cross-section [m²], the same at all angles."""
    return size


def build(parameters, machine):
    """Return both paths."""
    size = parameters.height * parameters.width
    slot = {"height": parameters.height, "length": parameters.length, "viscosity": 2e-5, "of_oil": 0.005}
    wiping = wiped_oil if parameters.wiped else None

    def path(to, offset):
        """Return a path with numbers of its own: scenes that differ in them alone share a text."""
        kind = Layers(wiping=wiping, values={**slot, "wiped": parameters.wiped}, title="gas and oil in layers")
        return FlowPath(to, cross_section, {"size": size}, flow=kind, offset=offset)

    return [path("neighbour", 1), path("suction", 0)]


EFFECT = Effect("layers", "slots with gas and oil in layers", (), "a test", Parameters, build)
