"""Scenes of a Roots blower, a machine of the user's own."""

from __future__ import annotations

import json
from typing import Any

from screwsim.scene import Scene, loads

P_S, P_D, POCKET = 1e5, 1.6e5, 800e-6  # Pa, m³
GAPS = {
    "tip_leakage": {"gap": "0.2 mm"},
    "interlobe_leakage": {"gap": "0.2 mm"},
    "end_face_leakage": {"gap": "0.15 mm"},
}


def blower(
    area: float = 600.0,
    kind: str = "own_machines.roots_blower",
    effects: dict[str, Any] | None = None,
    accuracy: float = 3e-4,
    **machine: Any,
) -> Scene:
    """Return the scene of a blower whose ports have an area [cm²]."""
    sizes = {"rotor_diameter": "200 mm", "rotor_length": "200 mm", "pocket": "800 cm^3", "dead": "15 cm^3"}
    ports = {"suction_area": f"{area} cm^2", "discharge_area": f"{area} cm^2"}
    operation = {
        "speed": "1500 rpm",
        "suction": {"pressure": "1 bar", "temperature": "300 K"},
        "discharge": {"pressure": "1.6 bar"},
    }
    scene = {
        "machine": {"kind": kind, **sizes, **ports, **machine},
        "gas": {"fluid": "Nitrogen", "model": "ideal", "isentropic_exponent": 1.4},
        "operation": operation,
        "effects": {"suction_port": {}, "discharge_port": {}, **(effects or {})},
        "numerics": {"accuracy": accuracy},
    }
    return loads(json.dumps(scene), "blower.yaml")
