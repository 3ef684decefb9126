"""Print what effects on shaft, droplets and capacity change on the paper's machine (docs/reference/effects-loads.md).

Each effect alone is added to configs/paper/point.yaml (1000 rpm, d = 3); the droplets replace its oil heat.

    scripts/effects_loads.py
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from screwsim import load
from screwsim.simulate import simulate

POINT = Path(__file__).parents[1] / "configs" / "paper" / "point.yaml"
SLIDE = "slot_area: 60 cm^2, closes: 640 deg, position: 0.5"
EFFECTS = {
    "oil_drag": ["effects.oil_drag={tip_gap: 0.1 mm, tip_land: 3 mm, end_gap: 0.1 mm, end_solidity: 0.6}"],
    "bearings, simple": [
        "effects.bearings={load: gas, radial_area: 60 cm^2, axial_area: 30 cm^2, "
        "friction_coefficient: 0.0018, bore: 60 mm}"
    ],
    "bearings, two_term": [
        "effects.bearings={friction: two_term, load: gas, radial_area: 60 cm^2, axial_area: 30 cm^2, "
        "mean_diameter: 85 mm, f_0: 2, f_1: 0.0004}"
    ],
    "motor": ["effects.motor={rated_power: 15 kW, efficiency: 0.921}"],
    "gas_torque": ["effects.gas_torque={male_share: 0.9}"],
    "droplets, 19 µm": ["effects.oil_heat=off", "effects.droplets={diameter: 19 um}"],
    "droplets, 19 µm, slip 0.1": ["effects.oil_heat=off", "effects.droplets={diameter: 19 um, slip: 0.1}"],
    "droplets, merrington_richardson": [
        "effects.oil_heat=off",
        "effects.droplets={size: merrington_richardson, orifice_diameter: 3 mm, jet_pressure: 5 bar}",
    ],
    "droplets, varde, slip 0.1": [
        "effects.oil_heat=off",
        "effects.droplets={size: varde, orifice_diameter: 3 mm, jet_pressure: 5 bar, "
        "surface_tension: 30 mN/m, slip: 0.1}",
    ],
    "suction_throttle, 0.7": ["effects.suction_throttle={pressure_ratio: 0.7}"],
    "bypass, 30 % of discharge": ["effects.bypass={share: 0.3}"],
    "bypass, 5 cm² at 400°": [
        "effects.bypass={source: chamber, area: 5 cm^2, opens: 400 deg, passage: 90 deg}",
    ],
    "slide_valve, half way": [f"effects.slide_valve={{{SLIDE}}}"],
}
OWN = (
    "droplet_diameter",
    "oil_drag_power",
    "bearing_power",
    "motor_loss",
    "gas_torque_peak_to_peak",
    "gas_torque_harmonic_1",
)


def own_figure(performance) -> str:
    """Return the first figure of the effect's own, in its SI unit."""
    units = {"droplet_diameter": "m", "oil_drag_power": "W", "bearing_power": "W", "motor_loss": "W"}
    found = [
        f"{name} {performance[name]:.4g} {units.get(name, 'N m')}" for name in OWN if performance[name] is not None
    ]
    return ", ".join(found)


def main() -> int:
    """Print a row an effect: changes of shaft power, net flow, efficiency and discharge temperature."""
    base = simulate(load(POINT)).performance
    print("| effect | ΔP_shaft [%] | Δṁ [%] | Δη_iso [points] | ΔT_d [K] | its own figures | residue of the ledger |")
    print("|---|---|---|---|---|---|---|")
    for name, overrides in EFFECTS.items():
        result = simulate(load(POINT, overrides=overrides))
        p = result.performance
        if result.status != "ok":
            raise SystemExit(f"{name}: {result.message}")
        power = 100.0 * (p.shaft_power / base.shaft_power - 1.0)
        flow = 100.0 * (p.gas_mass_flow / base.gas_mass_flow - 1.0)
        points = 100.0 * (p.isothermal_efficiency - base.isothermal_efficiency)
        warmer = p.discharge_temperature - base.discharge_temperature
        cells = [f"{power:+.2f}", f"{flow:+.2f}", f"{points:+.2f}", f"{warmer:+.1f}", own_figure(p)]
        row = " | ".join([name, *cells, f"{abs(result.ledger.relative_residue):.0e}"])
        print(re.sub(r"\| -(?=\d)", "| −", f"| {row} |"), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
