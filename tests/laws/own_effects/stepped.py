"""A hole in the housing that widens in steps: its area is looked up by a loop that ends at a chamber's angle.

What: nozzle flow (M12, M13, M100) to the suction line through an area that is linear between the entries of a table;
the loop ends at the interval, whose number is read behind it.
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

OPEN = np.array([0.0, 0.1, 0.5, 0.6, 1.0, 0.3, 0.0])
STEPS = 6


@dataclass(frozen=True)
class Parameters:
    """Where the hole lies, and how large it is."""

    opens: float = quantity("angle", "angle at which it opens", 7.0)
    closes: float = quantity("angle", "angle at which it has closed", 9.4)
    area: float = quantity("area", "largest area", 2e-5, ge=0.0)


@kernel
def stepped_area(phi, opens, closes, size):
    """Return the open area [m²] at an angle [rad]."""
    if phi <= opens or phi >= closes:
        return 0.0
    width = (closes - opens) / STEPS
    for i in range(STEPS):
        if phi < opens + (i + 1) * width:
            break
    share = (phi - opens) / width - i
    return size * (OPEN[i] + (OPEN[i + 1] - OPEN[i]) * share)


def build(parameters: Parameters, machine) -> list[FlowPath]:
    opens, closes = parameters.opens, parameters.closes
    return [
        FlowPath(
            to="suction",
            area=stepped_area,
            values={"opens": opens, "closes": closes, "size": parameters.area},
            breakpoints=tuple(opens + (closes - opens) * i / STEPS for i in range(STEPS + 1)),
        )
    ]


EFFECT = Effect(
    name="stepped",
    title="hole that widens in steps",
    equations=("M12", "M13", "M100"),
    source="example",
    parameters=Parameters,
    build=build,
)
