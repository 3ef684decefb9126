"""The built-in volume ratio of a machine: what its ports make of a chamber's volume, whatever the pressures are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from screwsim.machine.geometry import Geometry
from screwsim.machine.settings import DischargePort
from screwsim.machine.slider_crank.cylinder import Cylinder
from screwsim.numerics.spline import read_curve


def built_in_volume_ratio(geometry: Geometry | Cylinder, volume_at: Callable[[float], float]) -> float | None:
    """Return the chamber's volume where suction closes over that where the discharge port opens.

    As stated where the port follows from it; None of a machine without a port that opens at an angle. `volume_at`
    returns the volume [m³] at an angle [rad] of the chamber.
    """
    if isinstance(geometry, Cylinder) or geometry.settings.discharge_port is None:
        return None
    machine, port = geometry.settings, geometry.settings.discharge_port
    if port.law == "profile":
        return machine.built_in_volume_ratio
    opens = _opens(port)
    if opens is None:
        return None
    return volume_at(geometry.injection_angle) / volume_at(geometry.life - opens if geometry.expands else opens)


def _opens(port: DischargePort) -> float | None:
    """Return the angle of a compressor at which its port opens [rad]; None where it is never shut before."""
    if port.law == "paper":
        return port.opens
    angles, areas = read_curve(str(port.file), "area_m2")
    shut = np.flatnonzero(areas[: int(np.argmax(areas))] == 0.0)
    return float(angles[shut[-1]]) if len(shut) else None
