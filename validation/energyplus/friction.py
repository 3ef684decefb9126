"""Friction of new cylinders: what the ratings of the series 06D on R134a and R507A call for.

    python validation/energyplus/friction.py

Power at the shaft is (1 + f) P_ind + p_mf V̇ (M33, M461), so that the electrical efficiency of a simulated cylinder with
another f and p_mf follows from its powers. Least squares over all ratings and conditions, both fluids counting alike,
give the numbers of src/screwsim/template/reciprocating.py, rounded to 0.005 and 0.01 bar. All other series judge them
(compare.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from screwsim.study.validation import sibling

HERE = Path(__file__).parent
series = sibling(HERE / "series.py")


def differences(rated: Sequence[Any], friction: Sequence[float]) -> np.ndarray:
    """Return ours less theirs [points] at all conditions and machines with a share f and a pressure p_mf [bar]."""
    found = []
    for each in rated:
        own = each.figures
        shaft = (1.0 + friction[0]) * own.indicated_power + 1e5 * friction[1] * own.displacement_flow
        found.append(100.0 * own[series.FIGURE] * own.shaft_power / shaft - np.array(each.theirs))
    return np.concatenate(found)


def fitted() -> tuple[float, float, float]:
    """Return f, p_mf [bar] and the root mean square of the differences [points] that they leave."""
    each_fluid = [
        series.beside(one, table) for one, table in series.series_of(HERE).items() if one.name == series.FITTED
    ]

    def weighted(friction: np.ndarray) -> np.ndarray:
        off = [differences(rated, friction) for rated in each_fluid]
        return np.concatenate([each / np.sqrt(each.size) for each in off])

    found = least_squares(weighted, (0.1, 0.3))
    return *found.x, float(np.sqrt(np.sum(found.fun**2) / len(each_fluid)))


if __name__ == "__main__":
    print("f = {:.3f}, p_mf = {:.3f} bar, rms {:.1f} points".format(*fitted()))
