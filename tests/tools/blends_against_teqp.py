"""Dew and bubble points of every blend against teqp: tests/fluid/blends_teqp.json. Run: blends_against_teqp.py [NAME].

At 0.7, 0.8 and 0.9 of the highest two-phase temperature, or at the lowest known one: relative differences between
teqp's pressures of the liquid and the vapour that we find, between its fugacities of each component in both, and
between the pressure in our tables of the dew and bubble line and teqp's for that vapour. (teqp's own iterations fail
for blends with a wide glide.) An interrupted run continues where it was.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "tests" / "fluid" / "blends_teqp.json"
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("fluid",)]
from blend_references import R, phases, teqp_model, traced  # noqa: E402

from screwsim.fluid import constants  # noqa: E402
from screwsim.numerics.store import write_atomically  # noqa: E402

SHARES = (0.7, 0.8, 0.9)


def pressure(model: Any, T: float, rho: np.ndarray) -> float:
    """Return teqp's pressure [Pa] at T [K] and moles per volume [mol/m³]."""
    return float(rho.sum() * R * T * (1.0 + model.get_Ar01(T, rho.sum(), rho / rho.sum())))


def row(fluid: str) -> dict[str, Any]:
    """Return the largest differences of a blend."""
    model, around = teqp_model(fluid), traced(fluid)
    worst: dict[str, list[float]] = {"pressures": [], "fugacities": [], "p": []}
    coldest = 0.1 * around.T_m + 0.9 * around.T_low
    for T in (max(share * around.T_m, coldest) for share in SHARES):
        for side, ours in ((-1, constants.dew_pressure), (1, constants.bubble_pressure)):
            both = phases(fluid, T, side)
            p = [pressure(model, T, x) for x in both]
            share = [np.array(model.get_fugacity_coefficients(T, x)) * x / x.sum() for x in both]
            worst["pressures"].append(abs(p[0] / p[1] - 1.0))
            worst["fugacities"].append(float(np.max(np.abs(share[0] * p[0] / (share[1] * p[1]) - 1.0))))
            worst["p"].append(abs(ours(fluid, T) / p[1] - 1.0))
    return {name: max(values) for name, values in worst.items()}


def main() -> None:
    """Write the rows of blends that are not stored yet, or of those named."""
    sys.path.append(str(ROOT / "tests" / "tools"))
    from closed_blends import known

    rows = json.loads(STORED.read_text(encoding="utf-8")) if STORED.exists() else {}
    for name in sys.argv[1:] or [each for each in known() if each not in rows]:
        rows[name] = row(name)
        print(name, rows[name], flush=True)
        text = ",\n".join(f" {json.dumps(each)}: {json.dumps(rows[each])}" for each in sorted(rows))
        write_atomically(STORED, f"{{\n{text}\n}}\n".encode())


if __name__ == "__main__":
    main()
