"""One hard case, and the changes of the base scene that many of them share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from scenes import CARRIED, DROP


def below(path: str, **values: Any) -> dict[str, Any]:
    """Return the values of several keys below a path."""
    return {f"{path}.{key}": value for key, value in values.items()}


def saturated(evaporating: str, condensing: str, superheat: str) -> dict[str, Any]:
    """Return both lines stated by dew points."""
    temperatures = {"evaporating_temperature": evaporating, "condensing_temperature": condensing}
    return below("operation", suction=DROP, discharge=DROP, **temperatures, superheat=superheat)


WARM = {  # a real gas and oil above its saturation at the discharge pressure
    **CARRIED,
    "gas.model": "real",
    "oil_supply.temperature": "328 K",
    "operation.suction": {"pressure": "3.1462 bar", "superheat": "10 K"},
    "operation.discharge": {"pressure": "11.6 bar"},
}
DEW = {  # lines by dew points, oil above saturation
    **CARRIED,
    "gas.model": "real",
    "oil_supply.temperature": "330 K",
    **saturated("2 degC", "45 degC", superheat="10 K"),
}
CO2 = {
    **WARM,
    "gas.fluid": "CO2",
    "operation.suction": {"pressure": "30 bar", "temperature": "288 K"},
    "operation.discharge": {"pressure": "90 bar"},
    "oil_supply.temperature": "330 K",
}
WET = {
    "gas.model": "real",
    "gas.two_phase": "equilibrium",
    "effects.oil_heat": {"droplet_radius": "20 um", "heat_transfer_coefficient": "1000 W/(m^2 K)"},
    "operation.discharge.temperature": "330 K",
}
MOIST = {
    **CARRIED,
    "gas": {"fluid": "air", "model": "ideal", "relative_humidity": 1},
    "operation.suction": {"pressure": "1 bar", "temperature": "40 degC"},
    "operation.discharge": {"pressure": "9 bar"},
    "oil_supply.ratio": 6,
    "effects.oil_heat": {"droplet_radius": "25 um", "heat_transfer_coefficient": "1000 W/(m^2 K)"},
}
BARE = {"effects": {"suction_port": {}, "discharge_port": {}}, "oil": DROP, "oil_supply": DROP}
FINE = {"numerics.accuracy": 1e-6}


@dataclass(frozen=True)
class Case:
    """One row of the table; `most` bounds the evaluations of the right-hand side, Jacobians' included."""

    name: str
    changes: dict[str, Any]
    why: str
    status: str = "ok"  # ok | not_closed | failed | refused
    deserves: str = ""  # the status that physics would give it, where that is another
    most: int = 40_000
    says: tuple[str, ...] = field(default=())  # words of the message, warnings or fault
    radau: bool = False  # compared with a tight run of scipy's Radau
    slow: bool = False
    guess: tuple[float, float] | None = None  # factors on pressure and temperature of the first guess


def gaps(size: str) -> dict[str, Any]:
    """Return all clearances set to one size."""
    return {f"effects.{name}.gap": size for name in ("tip_leakage", "interlobe_leakage", "end_face_leakage")}


def leaks(blow_hole: str = "", **gaps: str) -> dict[str, Any]:
    """Return the clearances `tip`, `interlobe` and `end_face`, and the area of the blow-hole if stated."""
    found = {f"effects.{name}_leakage.gap": size for name, size in gaps.items()}
    return found | ({"effects.blow_hole.area": blow_hole} if blow_hole else {})


def ports(factor: float) -> dict[str, Any]:
    """Return both port areas times a factor."""
    return {
        "machine.suction_port.area": f"{40 * factor:g} cm^2",
        "machine.discharge_port.area": f"{12 * factor:g} cm^2",
    }


def lines(p_s: str, p_d: str, T_s: str = "283 K") -> dict[str, Any]:
    """Return both lines stated by pressures."""
    return {"operation.suction": {"pressure": p_s, "temperature": T_s}, "operation.discharge": {"pressure": p_d}}


def droplet(radius: str) -> dict[str, Any]:
    """Return another droplet radius."""
    return {"effects.oil_heat.droplet_radius": radius}


def speed(rpm: float) -> dict[str, Any]:
    """Return another speed."""
    return {"operation.speed": f"{rpm:g} rpm"}
