"""How simultaneous closing proceeds from pitch to pitch: acceleration, and the tolerance of its steps.

Source: docs/explanation/closing.md, simultaneous closing.
"""

import math
from typing import NamedTuple

import numpy as np

from screwsim.numerics.anderson import Anderson

Array = np.ndarray
PITCH_DEPTH = 10  # of Anderson's method for coupled chambers
THROWN_BACK = 0.5  # change of a pitch above which damped or plain closing returns to its own rule
LEAST_GAP = 1e-4  # of the tolerance: below it an open balance is due to the steps' error, not to the change
INEFFECTIVE = 0.25  # factor on the change of a pitch at which steps are refined, after a refinement that did not help
FINEST_RTOL = 1e-11  # tolerance of a step below which rounding keeps a balance from closing


class MixingRule(NamedTuple):
    """Depth of Anderson's method and damping factor; `FULL_RULE` applies while a pitch changes less than `near`."""

    depth: int
    damping: float = 1.0
    near: float = 0.0


FULL_RULE = MixingRule(PITCH_DEPTH)


class Mixing:
    """The next point of a fixed-point iteration by a rule; by `FULL_RULE` while a pitch changes less than `near`."""

    def __init__(self, rule: MixingRule) -> None:
        self.own = self.rule = rule
        self.accelerate = Anderson(rule.depth)

    def next(self, point: Array, image: Array, gap: float) -> Array:
        """Return the next point after `point` was mapped to `image`; `gap` is their distance."""
        if self.rule is self.own and gap < self.own.near:
            self._follow(FULL_RULE)
        elif self.rule is not self.own and gap > THROWN_BACK:
            self._follow(self.own)
        if not math.isfinite(gap):  # nothing to mix; integrating the next pitch shows where it leads
            self.restart()
            return image
        _, mixed = self.accelerate.mix(point, image)
        if np.max(np.abs(mixed - image)) > 1.0:
            mixed = image
        if self.rule.damping < 1.0:
            mixed = point + self.rule.damping * (mixed - point)
        return mixed

    def restart(self) -> None:
        """Forget earlier points: the map has changed."""
        self.accelerate.restart()

    def _follow(self, rule: MixingRule) -> None:
        self.rule, self.accelerate = rule, Anderson(rule.depth)


class StepRefinement:
    """The tolerance of a step, refined where a pitch changes too little to explain an open balance."""

    def __init__(self, rtol: float, tolerance: float, bound: float) -> None:
        self.rtol, self.tolerance, self.bound = rtol, tolerance, bound
        self.hoped, self.share = np.inf, 1.0

    def consider(self, gap: float, residual: float) -> None:
        """Refine steps if the gap cannot explain the residual; after a vain refinement require a smaller gap."""
        explained = self.share * min(1.0, self.bound / max(residual, 1e-300))
        if gap > self.tolerance * max(LEAST_GAP, explained):
            return
        if residual > self.hoped:
            self.share *= INEFFECTIVE
        refined = refined_rtol(self.rtol, residual / self.bound)
        self.hoped, self.rtol = residual * (refined / self.rtol) ** 0.5, refined


def refined_rtol(rtol: float, residual: float) -> float:
    """Return the next tolerance of a step where the cycle has settled but the integration error keeps balances open.

    `residual` is the largest one over its bound.
    """
    return max(min(0.7, max(0.25, 0.5 / residual)) * rtol, min(rtol, FINEST_RTOL))
