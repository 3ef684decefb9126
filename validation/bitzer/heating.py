"""Print what warm walls and dissolved refrigerant add to the volumetric loss of the fitted machine over pressure ratio.

    python validation/bitzer/heating.py

The curves' loss 1 - λ grows about threefold from π = 2.45 to 8.18; that of the fitted machine does not. Here the
machine has, one at a time and together, walls that exchange heat with the gas, and oil with R134a dissolved in it;
nothing is fitted anew. Sizes of the walls and the separator's temperature are assumed.
"""

from __future__ import annotations

from pathlib import Path

from screwsim.scene import load
from screwsim.simulate import simulate

MACHINE = Path(__file__).parent / "fitted" / "scene.yaml"
EVAPORATING = (14.0909, -18.4533)  # [degC] at 45 degC condensing: π = 2.45 and 8.18, as in fit.csv
WALLS = "effects.wall_heat={rotor_area: 400 cm^2, housing_area: 150 cm^2, characteristic_length: 58 mm}"
INJECTION = "effects.oil_injection={opens: 365 deg, closes: 455 deg}"
DISSOLVED = "effects.refrigerant_solubility={separator_temperature: 338 K}"
MACHINES = {
    "as fitted": (),
    "with walls": (WALLS,),
    "with an injection port": (INJECTION,),
    "with dissolved refrigerant": (INJECTION, DISSOLVED),
    "with both": (WALLS, INJECTION, DISSOLVED),
}


def loss(changes: tuple[str, ...], evaporating: float) -> float:
    """Return 1 - λ [points] of the machine with changes, at an evaporating temperature [degC]."""
    conditions = (f"operation.evaporating_temperature={evaporating} degC", "operation.condensing_temperature=45 degC")
    result = simulate(load(str(MACHINE), (*conditions, *changes)), trace=False)
    assert result.status == "ok", result.message
    return 100.0 * (1.0 - result.performance.volumetric_efficiency)


def main() -> None:
    """Print the losses and their growth."""
    print(f"{'1 - λ, points':28}{'π = 2.45':>10}{'π = 8.18':>10}{'growth':>8}")
    for name, changes in MACHINES.items():
        low, high = (loss(changes, T) for T in EVAPORATING)
        print(f"{name:28}{low:10.2f}{high:10.2f}{high - low:8.2f}")


if __name__ == "__main__":
    main()
