"""The space of scenes that is searched for failures: few structures, many numbers.

A scene is a structure and one number in [0, 1] for each of `RANGES`; most ranges are logarithmic, and their ends are
those of the hard cases. Real gases have narrower ones (`REAL`), since most of that space lies outside their equation.
Used by the tests and by `tests/tools/fuzz.py`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scenes import DROP

CARRIED = {"oil.transport": "carried"}
OILED = ("oil_heat", "oil_pump", "hydromechanical")
DRY = {"oil": DROP, "oil_supply": DROP} | {f"effects.{name}": DROP for name in OILED}
STRUCTURES: dict[str, dict[str, Any]] = {
    "paper": {},
    "carried": CARRIED,
    "ports alone": {**DRY, "effects": {"suction_port": {}, "discharge_port": {}}},
    "displacement": {**CARRIED, "oil_supply.kind": "displacement", "oil_supply.ratio": DROP, "effects.oil_pump": DROP},
    "dry, some leaks": {**DRY, "effects.interlobe_leakage": DROP, "effects.end_face_leakage": DROP},
    "oil, other leaks": {"effects.tip_leakage": DROP, "effects.blow_hole": DROP},
    "real": {**CARRIED, "gas.model": "real"},
    "two phases": {"gas.model": "real", "gas.two_phase": "equilibrium"},
}
WEIGHTS = {  # how often `drawn` takes a structure: the dear ones less
    "paper": 4,
    "carried": 3,
    "ports alone": 6,
    "displacement": 1,
    "dry, some leaks": 4,
    "oil, other leaks": 4,
    "real": 2,
    "two phases": 2,
}
FLUIDS = ("R134a", "R134a", "Nitrogen", "Hydrogen", "Helium", "SF6", "n-Dodecane")
REFRIGERANTS = ("R134a", "R134a", "Ammonia", "Propane", "SF6")
LOSSES = ("oil_pump", "hydromechanical", "mechanical")
RANGES = {  # low, high, logarithmic
    "speed": (10.0, 30_000.0, True),
    "p_s": (0.2, 10.0, True),  # bar
    "excess": (1e-4, 59.0, True),  # p_d/p_s − 1
    "T_s": (250.0, 400.0, False),
    "ratio": (1e-4, 50.0, True),
    "droplet": (0.3, 1000.0, True),  # um
    "alpha": (50.0, 5000.0, True),
    "warmer": (-80.0, 80.0, False),  # oil over suction, K
    "suction_port": (0.4, 4000.0, True),  # cm2
    "discharge_port": (0.12, 1200.0, True),
    "tip": (1.0, 1000.0, True),  # um
    "interlobe": (1.0, 1000.0, True),
    "end_face": (1.0, 1000.0, True),
    "blow_hole": (0.1, 100.0, True),  # mm2
    "bore": (0.3, 15.0, True),  # mm
    "dead": (6e-7, 60.0, True),  # cm3, of 600
    "phi_A": (0.1, 360.0, False),
    "phi_B": (0.1, 180.0, False),
    "opens": (361.0, 719.0, False),
    "phi_C": (1e-3, 1.0, False),  # share of its range
    "fluid": (0.0, 0.999, False),
    "own_k": (0.0, 1.0, False),  # an ideal gas of a given k above GIVEN
    "k": (1.02, 1.8, False),
    "by_temperatures": (0.0, 1.0, False),  # refrigeration conditions above GIVEN
    "evaporating": (230.0, 300.0, False),  # K
    "lift": (1.0, 90.0, False),  # of the condensing temperature over it, K
    "superheat": (0.0, 60.0, False),  # K
    "coupled": (0.0, 1.0, False),  # numerics.closing: coupled above COUPLED
    "own_accuracy": (0.0, 1.0, False),  # another than the default one above OWN_ACCURACY
    "accuracy": (1e-5, 1e-3, True),
    "losses": (0.0, 0.999, False),  # which of LOSSES are left out
}
GIVEN, COUPLED, OWN_ACCURACY, ACCURACY = 0.7, 0.85, 0.85, 3e-4
REAL = {
    "speed": (200.0, 10_000.0, True),
    "p_s": (0.5, 8.0, True),
    "excess": (0.05, 12.0, True),
    "warmer": (-10.0, 60.0, False),  # oil over saturation at p_d, K
    "suction_port": (4.0, 400.0, True),
    "discharge_port": (2.0, 120.0, True),
    "tip": (1.0, 300.0, True),
    "interlobe": (1.0, 300.0, True),
    "end_face": (1.0, 300.0, True),
    "dead": (6e-5, 60.0, True),
    "opens": (420.0, 700.0, False),
}


def drawn(seed: int, index: int) -> tuple[str, list[float]]:
    """Return structure and shares of one scene of a seed."""
    random = np.random.default_rng((seed, index))
    weights = np.array([WEIGHTS[name] for name in STRUCTURES], dtype=float)
    structure = list(STRUCTURES)[random.choice(len(weights), p=weights / weights.sum())]
    return structure, random.random(len(RANGES)).tolist()


def values(structure: str, shares: Sequence[float]) -> dict[str, float]:
    """Return the numbers of a scene from one in [0, 1] each."""
    found = {}
    ranges = RANGES | REAL if is_real(structure) else RANGES
    for (name, (low, high, logarithmic)), share in zip(ranges.items(), shares, strict=True):
        found[name] = low * (high / low) ** share if logarithmic else low + (high - low) * share
    return found


def is_real(structure: str) -> bool:
    """Tell whether the gas of a structure is real."""
    return "gas.model" in STRUCTURES[structure]


def boiling(p: float) -> float:
    """Return about the saturation temperature [K] of R134a at p [bar], from two points of its curve."""
    return 1.0 / (1.0 / 247.1 - math.log(p / 1.013) / 2701.0)


def _lines(structure: str, v: dict[str, float]) -> tuple[dict[str, Any], float]:
    """Return fluid and lines, and the temperature [K] over which the oil's is counted."""
    real, by_temperatures = is_real(structure), v["by_temperatures"] > GIVEN
    fluids = REFRIGERANTS if by_temperatures else FLUIDS
    found: dict[str, Any] = {"gas.fluid": "R134a" if real else fluids[int(v["fluid"] * len(fluids))]}
    if not real and v["own_k"] > GIVEN:
        found["gas.isentropic_exponent"] = round(v["k"], 6)
    if by_temperatures:
        found["operation.suction"] = found["operation.discharge"] = DROP
        T_c = v["evaporating"] + v["lift"]
        found["operation.evaporating_temperature"] = f"{v['evaporating']:.8g} K"
        found["operation.condensing_temperature"] = f"{T_c:.8g} K"
        found["operation.superheat"] = f"{v['superheat']:.8g} K"
        return found, T_c if real else v["evaporating"]
    p_d = v["p_s"] * (1.0 + v["excess"])
    state = {"superheat": f"{v['superheat']:.8g} K"} if real else {"temperature": f"{v['T_s']:.8g} K"}
    found["operation.suction"] = {"pressure": f"{v['p_s']:.8g} bar"} | state
    found["operation.discharge"] = {"pressure": f"{p_d:.10g} bar"}
    return found, min(boiling(p_d), 400.0) if real else v["T_s"]


def _effects(structure: str, v: dict[str, float]) -> dict[str, Any]:
    """Return the numbers of the effects that a structure has."""
    numbers = {
        "effects.tip_leakage.gap": f"{v['tip']:.8g} um",
        "effects.interlobe_leakage.gap": f"{v['interlobe']:.8g} um",
        "effects.end_face_leakage.gap": f"{v['end_face']:.8g} um",
        "effects.blow_hole.area": f"{v['blow_hole']:.8g} mm^2",
        "effects.oil_heat.droplet_radius": f"{v['droplet']:.8g} um",
        "effects.oil_heat.heat_transfer_coefficient": f"{v['alpha']:.8g} W/(m^2 K)",
    }
    own = STRUCTURES[structure]
    left_out = [path for path, value in own.items() if value is DROP] + (["effects"] if "effects" in own else [])
    chosen = {path: value for path, value in numbers.items() if not path.startswith(tuple(left_out))}
    bits = int(v["losses"] * 2 ** len(LOSSES))
    return chosen | {f"effects.{name}": DROP for i, name in enumerate(LOSSES) if bits >> i & 1}


def changes(structure: str, shares: Sequence[float]) -> dict[str, Any]:
    """Return the changes of the base scene."""
    v, own = values(structure, shares), STRUCTURES[structure]
    middle = 0.5 * (v["opens"] + 720.0)
    lines, T_reference = _lines(structure, v)
    found: dict[str, Any] = {
        **own,
        **lines,
        **_effects(structure, v),
        "operation.speed": f"{v['speed']:.8g} rpm",
        "machine.volume.min": f"{v['dead']:.8g} cm^3",
        "machine.volume.phi_A": f"{v['phi_A']:.8g} deg",
        "machine.suction_port.area": f"{v['suction_port']:.8g} cm^2",
        "machine.suction_port.phi_B": f"{v['phi_B']:.8g} deg",
        "machine.discharge_port.area": f"{v['discharge_port']:.8g} cm^2",
        "machine.discharge_port.opens": f"{v['opens']:.8g} deg",
        "machine.discharge_port.phi_C": f"{v['opens'] + v['phi_C'] * (middle - v['opens']):.10g} deg",
        "numerics.accuracy": float(f"{v['accuracy']:.6g}") if v["own_accuracy"] > OWN_ACCURACY else ACCURACY,
        "numerics.closing": "coupled" if v["coupled"] > COUPLED else "auto",
    }
    if own.get("oil_supply") is DROP:
        return found
    found["oil_supply.temperature"] = f"{T_reference + v['warmer']:.8g} K"
    if own.get("oil_supply.kind") == "displacement":
        return found | {"oil_supply.orifice_diameter": f"{v['bore']:.8g} mm"}
    return found | {"oil_supply.ratio": round(v["ratio"], 8)}
