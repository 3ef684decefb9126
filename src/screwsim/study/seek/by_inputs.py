"""How far the tolerances of a scene's inputs move the values that meet goals.

At the solution the figures F(x, p) have their goals. Inputs p that are off move the values x by
dx = −(∂F/∂x)⁻¹ ∂F/∂p dp (implicit function), with exact derivatives where there are any. The tolerances of the values
sought are left aside.

Source: JCGM 100:2008 (GUM), section 5.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.study.asked.varied import Varied
from screwsim.study.uncertainty.point import sensitivities
from screwsim.study.uncertainty.spreads import FigureUncertainty, Tolerances, spreads_of, tolerances_of

LARGEST_CONDITION = 1e12  # of the slopes of figures, each times its value over theirs: beyond it the goals contradict


def other_tolerances(of: Varied, sought: Sequence[str]) -> Tolerances:
    """Return the tolerances of a scene or two stages without those of the paths that are sought."""
    every = tolerances_of(of)
    groups = (tuple(path for path in group if path not in sought) for group in every.correlated)
    kept = {path: tolerance for path, tolerance in every.uncertain.items() if path not in sought}
    return Tolerances(kept, tuple(group for group in groups if len(group) > 1))


def uncertainties_by_inputs(
    of: Varied, result: Result | None, values: Mapping[str, float], figures: Sequence[str]
) -> tuple[dict[str, FigureUncertainty], str]:
    """Return the uncertainty of each value [SI] that was found, at the scene or stages with them; or why there is none.

    Both are empty where no other input has a tolerance.
    """
    tolerances, sought = other_tolerances(of, list(values)), list(values)
    inputs = list(tolerances.uncertain)
    if not inputs:
        return {}, ""
    known: dict[str, Any] = {"result": result} if isinstance(of, Scene) else {}
    try:
        found = sensitivities(of, [*sought, *inputs], figures, fine=False, progress=False, **known)
    except UsageError as error:
        return {}, f"no uncertainty from the inputs: {error}"
    if lost := next((path for path in (*sought, *inputs) if path not in found.values), ""):
        why = found.left_out.get(lost, found.result.told)
        return {}, f"no uncertainty from the inputs: {lost}: {why or 'it has no derivative'}"
    if lacking := next((name for name in figures if name not in found.derivatives), ""):
        return {}, f"no uncertainty from the inputs: {lacking} has no derivative"
    slopes = np.array([[found.derivatives[name].get(path, 0.0) for path in (*sought, *inputs)] for name in figures])
    by_value, by_input = slopes[:, : len(sought)], slopes[:, len(sought) :]
    sizes = [abs(found.result.performance[name]) or 1.0 for name in figures]
    scaled = by_value * [abs(value) or 1.0 for value in values.values()] / np.array(sizes)[:, None]
    if not np.linalg.cond(scaled) < LARGEST_CONDITION:
        return {}, "no uncertainty from the inputs: here the figures do not change with what varies"
    moved = -np.linalg.solve(by_value, by_input)
    by_path = {path: dict(zip(inputs, map(float, row), strict=True)) for path, row in zip(sought, moved, strict=True)}
    return spreads_of(tolerances, {path: found.values[path] for path in inputs}, by_path), ""
