"""How far the tolerances of a scene's inputs move the values that meet goals.

At the solution the figures F(x, p) have their goals. Inputs p that are off move the values x by
dx = −(∂F/∂x)⁻¹ ∂F/∂p dp (implicit function), with exact derivatives where there are any. The tolerances of the values
sought are left aside.

Source: JCGM 100:2008 (GUM), section 5.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.study.asked.varied import Varied
from screwsim.study.uncertainty.point import slopes_by_inputs
from screwsim.study.uncertainty.spreads import FigureUncertainty, not_included, spreads_of, tolerances_of

LARGEST_CONDITION = 1e12  # of the slopes of figures, each times its value over theirs: beyond it the goals contradict


def uncertainties_by_inputs(
    of: Varied, result: Result | None, values: Mapping[str, float], figures: Sequence[str]
) -> tuple[dict[str, FigureUncertainty], str]:
    """Return the uncertainty of each value [SI] that was found, at the scene or stages with them; why there is none.

    It is also told which inputs have no part in it. Both are empty where no other input has a tolerance.
    """
    tolerances, sought = tolerances_of(of, list(values)), list(values)
    inputs = list(tolerances.uncertain)
    if not inputs:
        return {}, ""
    try:
        found = slopes_by_inputs(of, [*sought, *inputs], figures, result=result)
    except UsageError as error:
        return {}, f"no uncertainty from the inputs: {error}"
    if found.result.status != "ok":
        return {}, f"no uncertainty from the inputs: {found.result.told}"
    if lacking := next((name for name in figures if name not in found.derivatives), ""):
        return {}, f"no uncertainty from the inputs: {lacking} has no derivative"
    if lost := next((path for path in sought if path in found.left_out), ""):
        return {}, f"no uncertainty from the inputs: {lost}: {found.left_out[lost]}"
    inputs, told = [path for path in inputs if path in found.values], "; ".join(not_included(found.left_out))
    if not inputs:
        return {}, told
    slopes = np.array([[found.derivatives[name][path] for path in (*sought, *inputs)] for name in figures])
    by_value, by_input = slopes[:, : len(sought)], slopes[:, len(sought) :]
    sizes = [abs(found.result.performance[name]) or 1.0 for name in figures]
    scaled = by_value * [abs(value) or 1.0 for value in values.values()] / np.array(sizes)[:, None]
    if not np.linalg.cond(scaled) < LARGEST_CONDITION:
        return {}, "no uncertainty from the inputs: here the figures do not change with what varies"
    moved = -np.linalg.solve(by_value, by_input)
    by_path = {path: dict(zip(inputs, map(float, row), strict=True)) for path, row in zip(sought, moved, strict=True)}
    return spreads_of(tolerances, {path: found.values[path] for path in inputs}, by_path), told
