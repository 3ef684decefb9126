"""A hole that is wide or narrow from an angle on: which table holds its area is chosen, as lanes cannot do.

What: nozzle flow (M12, M13, M100) to the suction line through an area that is linear between the entries of two tables.
Source: an example; no measurement behind it.
Assumptions: quasi-steady nozzle.
Parameters: opens, closes, area.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from screwsim.effects.base import Effect, FlowPath
from screwsim.inputs.declare import quantity
from screwsim.numerics.kernel import kernel

FIRST, LAST = np.array([0.0, 1.0]), np.array([1.0, 0.0])


@dataclass(frozen=True)
class Parameters:
    """Where the hole lies, and how large it is."""

    opens: float = quantity("angle", "angle at which it opens", 7.0)
    closes: float = quantity("angle", "angle at which it has closed", 9.4)
    area: float = quantity("area", "largest area", 2e-5, ge=0.0)


@kernel
def picked_area(phi, opens, closes, size):
    """Return the open area [m²] at an angle [rad]."""
    if phi <= opens or phi >= closes:
        return 0.0
    share = 2.0 * (phi - opens) / (closes - opens)
    row = FIRST if share < 1.0 else LAST
    return size * (row[0] + (row[1] - row[0]) * (share % 1.0))


def build(parameters: Parameters, machine) -> list[FlowPath]:
    opens, closes = parameters.opens, parameters.closes
    return [
        FlowPath(
            to="suction",
            area=picked_area,
            values={"opens": opens, "closes": closes, "size": parameters.area},
            breakpoints=(opens, 0.5 * (opens + closes), closes),
        )
    ]


EFFECT = Effect(
    name="picked",
    title="hole with two tables",
    equations=("M12", "M13", "M100"),
    source="example",
    parameters=Parameters,
    build=build,
)
