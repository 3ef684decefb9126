"""The space of scenes that is searched for failures: few structures, many numbers.

A scene is a structure and one number in [0, 1] for each of `RANGES`; most ranges are logarithmic, and their ends are
those of the hard cases. Used by the tests and by `scripts/fuzz.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from scenes import DROP

STRUCTURES: dict[str, dict[str, Any]] = {
    "paper": {},
    "carried": {"oil.transport": "carried"},
    "ports alone": {"effects": {"suction_port": {}, "discharge_port": {}}, "oil": DROP, "oil_supply": DROP},
}
FLUIDS = ("R134a", "R134a", "Nitrogen", "Hydrogen", "Helium", "SF6")
RANGES = (  # name, low, high, logarithmic
    ("speed", 10.0, 30_000.0, True),
    ("p_s", 0.2, 10.0, True),  # bar
    ("excess", 1e-4, 59.0, True),  # p_d/p_s − 1
    ("T_s", 250.0, 400.0, False),
    ("ratio", 1e-4, 50.0, True),
    ("droplet", 0.3, 1000.0, True),  # um
    ("alpha", 50.0, 5000.0, True),
    ("warmer", -80.0, 80.0, False),  # oil over suction, K
    ("suction_port", 0.4, 4000.0, True),  # cm2
    ("discharge_port", 0.12, 1200.0, True),
    ("tip", 1.0, 1000.0, True),  # um
    ("interlobe", 1.0, 1000.0, True),
    ("end_face", 1.0, 1000.0, True),
    ("blow_hole", 0.1, 100.0, True),  # mm2
    ("dead", 6e-7, 60.0, True),  # cm3, of 600
    ("phi_A", 0.1, 360.0, False),
    ("phi_B", 0.1, 180.0, False),
    ("opens", 361.0, 719.0, False),
    ("phi_C", 1e-3, 1.0, False),  # share of its range
    ("fluid", 0.0, 0.999, False),
)


def values(shares: Sequence[float]) -> dict[str, float]:
    """Return the numbers of a scene from one in [0, 1] each."""
    found = {}
    for (name, low, high, logarithmic), share in zip(RANGES, shares, strict=True):
        found[name] = low * (high / low) ** share if logarithmic else low + (high - low) * share
    return found


def changes(structure: str, shares: Sequence[float]) -> dict[str, Any]:
    """Return the changes of the base scene."""
    v = values(shares)
    middle = 0.5 * (v["opens"] + 720.0)
    found: dict[str, Any] = {
        **STRUCTURES[structure],
        "gas.fluid": FLUIDS[int(v["fluid"] * len(FLUIDS))],
        "operation.speed": f"{v['speed']:.8g} rpm",
        "operation.suction": {"pressure": f"{v['p_s']:.8g} bar", "temperature": f"{v['T_s']:.8g} K"},
        "operation.discharge": {"pressure": f"{v['p_s'] * (1.0 + v['excess']):.10g} bar"},
        "machine.volume.min": f"{v['dead']:.8g} cm^3",
        "machine.volume.phi_A": f"{v['phi_A']:.8g} deg",
        "machine.suction_port.area": f"{v['suction_port']:.8g} cm^2",
        "machine.suction_port.phi_B": f"{v['phi_B']:.8g} deg",
        "machine.discharge_port.area": f"{v['discharge_port']:.8g} cm^2",
        "machine.discharge_port.opens": f"{v['opens']:.8g} deg",
        "machine.discharge_port.phi_C": f"{v['opens'] + v['phi_C'] * (middle - v['opens']):.10g} deg",
    }
    if structure != "ports alone":
        found |= {
            "oil_supply.ratio": round(v["ratio"], 8),
            "oil_supply.temperature": f"{v['T_s'] + v['warmer']:.8g} K",
            "effects.oil_heat.droplet_radius": f"{v['droplet']:.8g} um",
            "effects.oil_heat.heat_transfer_coefficient": f"{v['alpha']:.8g} W/(m^2 K)",
            "effects.tip_leakage.gap": f"{v['tip']:.8g} um",
            "effects.interlobe_leakage.gap": f"{v['interlobe']:.8g} um",
            "effects.end_face_leakage.gap": f"{v['end_face']:.8g} um",
            "effects.blow_hole.area": f"{v['blow_hole']:.8g} mm^2",
        }
    return found
