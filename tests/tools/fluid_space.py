"""A third space of random scenes: blends, fluids near and inside their dome, a gas cooler above the critical point.

Of the structures inside the dome the suction gas is wet, and oil may be so cold that gas condenses on it.

The machines and their numbers are those of `fuzz_space.py`; its lines are stated here by temperatures. A third of the
dry scenes suck saturated vapour, and a third gas within a millionth to a kelvin of it. `tests/tools/fuzz.py --space
fluid_space` solves them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import fuzz_space
import numpy as np
from scenes import DROP

BLENDS = {
    "R454B": {"gas.fluid": "R454B"},
    "R407C": {"gas.fluid": "R407C.mix"},
    "own blend": {"gas.fluid": ["R32", "R1234ze(E)"], "gas.mass_fractions": [0.4, 0.6]},
}
REAL = {"oil.transport": "carried", "gas.model": "real"}
WET = {"gas.two_phase": "equilibrium"}
WET_BLENDS = ("wet R454B", "wet R407C")
STRUCTURES: dict[str, dict[str, Any]] = {
    **{name: {**REAL, **gas} for name, gas in BLENDS.items()},
    "near dew": {**REAL, "gas.fluid": "R32"},
    "wet ammonia": {**REAL, **WET, "gas.fluid": "Ammonia"},
    "wet R454B": {**REAL, **WET, "gas.fluid": "R454B"},
    "wet R407C": {**REAL, **WET, "gas.fluid": "R407C.mix"},
    "gas cooler": {**REAL, "gas.fluid": "CO2"},
}
RANGES = {  # low, high, logarithmic
    "evaporating": (250.0, 285.0, False),  # K
    "lift": (3.0, 60.0, False),  # of the condensing temperature over it, K
    "which": (0.0, 1.0, False),  # saturated vapour below SATURATED, next to it below NEAR
    "nearness": (1e-6, 1.0, True),  # K
    "superheat": (1.0, 40.0, False),  # K
    "quality": (0.6, 1.0, False),
    "colder": (-60.0, 40.0, False),  # of the oil of wet blends, than the condensing temperature, K
    "pressure": (74.0, 130.0, True),  # of the gas cooler, bar
    "outlet": (290.0, 325.0, False),  # K
}
SATURATED, NEAR = 1.0 / 3.0, 2.0 / 3.0
HOTTEST = 400.0  # [K] of oil


def drawn(seed: int, index: int) -> tuple[str, list[float]]:
    """Return structure and shares of one scene of a seed."""
    random = np.random.default_rng((seed, index))
    structure = list(STRUCTURES)[random.integers(len(STRUCTURES))]
    return structure, random.random(len(fuzz_space.RANGES) + len(RANGES)).tolist()


def _values(shares: Sequence[float]) -> dict[str, float]:
    """Return the numbers of the lines from one in [0, 1] each."""
    return {
        name: low * (high / low) ** share if logarithmic else low + (high - low) * share
        for (name, (low, high, logarithmic)), share in zip(RANGES.items(), shares, strict=True)
    }


def changes(structure: str, shares: Sequence[float]) -> dict[str, Any]:
    """Return the changes of the base scene."""
    machine, own = shares[: len(fuzz_space.RANGES)], _values(shares[len(fuzz_space.RANGES) :])
    numbers = fuzz_space.values("real", machine)
    found = fuzz_space.changes("real", machine)
    found |= {"operation.suction": DROP, "operation.discharge": DROP, **STRUCTURES[structure]}
    found["operation.evaporating_temperature"] = f"{own['evaporating']:.8g} K"
    T = own["evaporating"] + own["lift"]
    if structure == "gas cooler":
        found.pop("operation.condensing_temperature", None)
        cooler = {"pressure": f"{own['pressure']:.8g} bar", "outlet_temperature": f"{own['outlet']:.8g} K"}
        found["operation.gas_cooler"] = cooler
        T = max(own["outlet"], 304.2)
    else:
        found["operation.condensing_temperature"] = f"{T:.8g} K"
    found["oil_supply.temperature"] = f"{min(T + numbers['warmer'], HOTTEST):.8g} K"
    if "gas.two_phase" in STRUCTURES[structure]:
        found.pop("operation.superheat", None)
        if structure in WET_BLENDS:
            found["oil_supply.temperature"] = f"{T - own['colder']:.8g} K"
        return found | {"operation.suction": {"quality": round(own["quality"], 8)}}
    near = own["nearness"] if own["which"] < NEAR else own["superheat"]
    return found | {"operation.superheat": f"{0.0 if own['which'] < SATURATED else near:.8g} K"}
