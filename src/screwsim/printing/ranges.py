"""How uncertain the figures of a sweep are by the tolerances of its scene: from the least to the most, and by what."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from screwsim.figures import declared
from screwsim.figures.engineering import figure_unit, shown_name
from screwsim.results.read import Results
from screwsim.scene.types import COVERAGE

TOLD = ("isothermal_efficiency", "isentropic_efficiency", "gas_mass_flow", "shaft_power")
MOST_FIGURES = 3
EFFICIENCY = "efficiency"


def uncertainty_ranges(results: Results) -> dict[str, Any]:
    """Return what `sweep --json` says: of each figure the least and the largest half of a 95 % interval [SI].

    With them the share that each input has of the variance, in the mean over the cases.
    """
    figures = {}
    for name in results.uncertainty:
        expanded = COVERAGE * results.uncertainty[name]
        there = np.isfinite(expanded)
        if not there.any() or not np.nanmax(expanded):
            continue
        square = np.square(np.nan_to_num(results.contributions[name][there]))
        total = square.sum(axis=-1)
        shares = (square[total > 0.0] / total[total > 0.0, None]).mean(axis=0)
        figures[name] = {
            "least": float(np.nanmin(expanded)),
            "largest": float(np.nanmax(expanded)),
            "shares": dict(zip(results.contributions["contributor"].tolist(), shares.tolist(), strict=True)),
        }
    return {"coverage_factor": COVERAGE, "figures": figures}


def ranges_text(found: Mapping[str, Any]) -> str:
    """Return in words how uncertain the first figures are, and by which input the most."""
    parts = []
    for name in [name for name in TOLD if name in found["figures"]][:MOST_FIGURES]:
        each = found["figures"][name]
        factor, unit = figure_unit(declared(name), each["largest"])
        unit = "points" if unit == "%" and name.endswith(EFFICIENCY) else unit
        low, high = (f"{factor * each[end]:.2g}" for end in ("least", "largest"))
        reach = f"± {low}" if low == high else f"± {low} to {high}"
        parts.append(f"{shown_name(name)} {reach} {unit}".strip())
    if not parts:
        return "none of the usual figures (all are in the file, group uncertainty)"
    shares = next(found["figures"][name]["shares"] for name in TOLD if name in found["figures"])
    path, share = max(shares.items(), key=lambda item: item[1])
    most = f"{path.replace('effects.', '')} makes {share:.0%} of the first's variance"
    return f"{'; '.join(parts)} (95 %, linear; {most}; all in the file)"
