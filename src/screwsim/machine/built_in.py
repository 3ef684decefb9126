"""The built-in volume ratio of a machine: what its ports make of a chamber's volume, whatever the pressures are."""

from __future__ import annotations

from collections.abc import Callable

from screwsim.machine.geometry import Geometry
from screwsim.machine.slider_crank.cylinder import Cylinder


def built_in_volume_ratio(geometry: Geometry | Cylinder, volume_at: Callable[[float], float]) -> float | None:
    """Return the chamber's volume where suction closes over that where the discharge port opens.

    As stated where the port follows from it; None of a machine without a port that opens at an angle. `volume_at`
    returns the volume [m³] at an angle [rad] of the chamber.
    """
    if isinstance(geometry, Cylinder) or geometry.settings.discharge_port is None:
        return None
    if geometry.settings.discharge_port.law == "profile":
        return geometry.settings.built_in_volume_ratio
    opens = geometry.discharge_opens
    return None if opens is None else volume_at(geometry.injection_angle) / volume_at(opens)
