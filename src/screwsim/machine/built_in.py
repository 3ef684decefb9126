"""The built-in volume ratio of a machine: a ratio of chamber volumes set by its ports, whatever the pressures are."""

from collections.abc import Callable

from screwsim.machine.protocol import MachineGeometry


def built_in_volume_ratio(geometry: MachineGeometry, volume_at: Callable[[float], float]) -> float | None:
    """Return the chamber's volume where suction closes over that where the discharge port opens.

    It is the stated value where the port follows from that; None for a machine without a port that opens at an angle.
    `volume_at` returns the volume [m³] at an angle [rad] of the chamber.
    """
    stated, opens = geometry.stated_volume_ratio, geometry.discharge_opens
    return stated if stated or opens is None else volume_at(geometry.injection_angle) / volume_at(opens)
