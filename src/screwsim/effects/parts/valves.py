"""What cylinder valves share: their sides, and the work lost to pressures beyond the lines'.

Source: ours; docs/reference/slider-crank.md S24.
"""

from collections.abc import Mapping

import numpy as np

from screwsim.effects.base import DISCHARGE, SUCTION, Faults, Reading
from screwsim.inputs.faults import Fault
from screwsim.numerics.kernel import kernel
from screwsim.outputs import names_of, power_figure

SIDES = {SUCTION: 1.0, DISCHARGE: -1.0}  # sign of the pressure difference into the chamber that opens a valve
VALVE_LOSSES = (
    power_figure("suction_valve_power", "power lost because cylinder pressure is below that of the suction line"),
    power_figure("discharge_valve_power", "power lost because cylinder pressure is above that of the discharge line"),
)


@kernel
def port_area(phi, area):
    """Return the area [m²] of a valve's port, which does not depend on the angle."""
    return area


def stated_once(own: str, other: str, facts) -> Faults:
    """Yield a fault where effects of both names are in the scene: each is of the same valves."""
    if other in facts.effects:
        yield Fault(f"effects.{own}", f"are simulated together with {other}, the same valves twice (remove one)")


def valve_works(pitch) -> tuple[float, float]:
    """Return the work [J] per turn lost to pressure below suction, and to pressure above discharge (S24)."""
    within = pitch.within()
    under = np.maximum(pitch.low_pressure - within.pressure, 0.0) * np.maximum(within.slope, 0.0)
    over = np.maximum(within.pressure - pitch.high_pressure, 0.0) * np.maximum(-within.slope, 0.0)
    return 2.0 * np.pi * within.mean(under.sum(axis=1)), 2.0 * np.pi * within.mean(over.sum(axis=1))


def valve_losses() -> Reading:
    """Return the reading of both valves' losses."""
    names = names_of(VALVE_LOSSES)

    def read(figures) -> Mapping[str, float | None]:
        """Return the power [W] that each valve costs (S24)."""
        turns = figures.omega / (2.0 * np.pi)
        return {name: turns * work for name, work in zip(names, valve_works(figures.pitch()), strict=True)}

    return Reading(names, read)
