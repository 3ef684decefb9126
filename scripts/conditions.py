"""Print the R134a scenes beside Bitzer's published mean at the same conditions.

Run: .venv/bin/python scripts/conditions.py. The machine of configs/r134a has plausible clearances and is fitted to
nothing; the published curve is a mean over machines and refrigerants, so this shows nearness, not a validation.
"""

from __future__ import annotations

import csv
from pathlib import Path

from screwsim.scene import load
from screwsim.simulate import simulate

ROOT = Path(__file__).resolve().parent.parent
PUBLISHED = ROOT / "validation" / "bitzer" / "conditions.csv"


def scene_of(evaporating: str, condensing: str) -> Path:
    """Return the scene of a condition [degC]."""
    special = "point" if (evaporating, condensing) == ("2", "45") else f"te{evaporating}_tc{condensing}"
    return ROOT / "configs" / "r134a" / f"{special}.yaml"


def main() -> None:
    """Print one line a condition."""
    with PUBLISHED.open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    print("R134a, 50 Hz, 10 K superheat; published: mean of Bitzer's compact screws (motor apart)")
    print(f"{'To/Tc':>8} {'pi':>6} {'lambda':>16} {'eta_s':>16} {'T_discharge':>12} {'COP':>6}")
    print(f"{'degC':>8} {'':>6} {'ours  published':>16} {'ours  published':>16} {'degC':>12}")
    for row in rows:
        result = simulate(load(scene_of(row["evaporating_degC"], row["condensing_degC"])), trace=False)
        found = result.performance
        ratio = found.discharge_pressure / found.suction_pressure
        print(
            f"{row['evaporating_degC'] + '/' + row['condensing_degC']:>8} {ratio:>6.3f} "
            f"{found.volumetric_efficiency:>8.3f} {float(row['volumetric_efficiency']):>7.3f} "
            f"{found.isentropic_efficiency:>8.3f} {float(row['isentropic_efficiency']):>7.3f} "
            f"{found.discharge_temperature - 273.15:>12.1f} {found.cop:>6.2f}   {result.status}"
        )


if __name__ == "__main__":
    main()
