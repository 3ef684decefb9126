"""A user's effect: a narrow hole to the suction line that a chamber passes quickly; states its angles or not."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from screwsim.effects.base import Effect, FlowPath
from screwsim.inputs.declare import number, quantity
from screwsim.numerics.kernel import kernel


@dataclass(frozen=True)
class Parameters:
    """The hole, where it lies, how wide it is, and whether the law's angles are stated."""

    area: float = quantity("area", "of the hole", gt=0.0)
    at: float = quantity("angle", "angle of the chamber at which it is widest", ge=0.0, lt=4.0 * pi)
    width: float = quantity("angle", "from first to last contact", gt=0.0)
    stated: float = number("1: its angles are breakpoints; 0: they are not", 0.0, ge=0.0, le=1.0)


@kernel
def area(phi, size, at, width):
    """Return the open area [m²] of the hole for a chamber at phi [rad]: a bump without corners."""
    x = 2.0 * (phi - at) / width
    if x * x >= 1.0:
        return 0.0
    return size * (1.0 - x * x) * (1.0 - x * x)


def build(parameters: Parameters, machine) -> list[FlowPath]:
    values = {"size": parameters.area, "at": parameters.at, "width": parameters.width}
    ends = parameters.at - 0.5 * parameters.width, parameters.at + 0.5 * parameters.width
    return [FlowPath("suction", area, values, breakpoints=ends if parameters.stated >= 0.5 else ())]


EFFECT = Effect(
    name="spike",
    title="narrow hole in the housing, to the suction line",
    equations=("M12",),
    source="a test",
    parameters=Parameters,
    build=build,
)
