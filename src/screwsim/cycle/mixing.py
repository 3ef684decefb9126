"""How simultaneous closing goes on from one pitch to the next: its acceleration, the tolerance of its steps.

Source: docs/explanation/closing.md, simultaneous closing.
"""

from typing import NamedTuple

import numpy as np

from screwsim.numerics.periodic import Anderson

Array = np.ndarray
PITCH_DEPTH = 10  # of Anderson's method for coupled chambers
THROWN = 0.5  # change of a pitch above which damped or plain closing goes back to its own rule
LEAST_GAP = 1e-4  # of the tolerance: below it a balance that is not closed shows the steps' error, not the change's
OF_NO_AVAIL = 0.25  # of the change of a pitch at which steps are refined, after a time that was of no avail
FINEST_RTOL = 1e-11  # of a step, below which it is rounding that keeps a balance from closing


class MixingRule(NamedTuple):
    """Depth of Anderson's method and share of the way to go; `FULL` where a pitch changes less than `near`."""

    depth: int
    damping: float = 1.0
    near: float = 0.0


FULL = MixingRule(PITCH_DEPTH)


class Mixing:
    """The next point of a fixed-point iteration by a rule; by the `FULL` one while a pitch changes less than `near`."""

    def __init__(self, rule: MixingRule) -> None:
        self.own = self.rule = rule
        self.accelerate = Anderson(rule.depth)

    def next(self, point: Array, image: Array, gap: float) -> Array:
        """Return the next point after `point` was mapped to `image`, which is `gap` away."""
        if self.rule is self.own and gap < self.own.near:
            self._follow(FULL)
        elif self.rule is not self.own and gap > THROWN:
            self._follow(self.own)
        _, mixed = self.accelerate.mix(point, image)
        if np.max(np.abs(mixed - image)) > 1.0:
            mixed = image
        if self.rule.damping < 1.0:
            mixed = point + self.rule.damping * (mixed - point)
        return mixed

    def restart(self) -> None:
        """Forget what was seen: the map is another one."""
        self.accelerate.restart()

    def _follow(self, rule: MixingRule) -> None:
        self.rule, self.accelerate = rule, Anderson(rule.depth)


class Refining:
    """The tolerance of a step, refined where a pitch changes too little to be what keeps a balance from closing."""

    def __init__(self, rtol: float, tolerance: float, bound: float) -> None:
        self.rtol, self.tolerance, self.bound = rtol, tolerance, bound
        self.hoped, self.share = np.inf, 1.0

    def consider(self, gap: float, residual: float) -> None:
        """Refine, or not; where the last time was of no avail, pitches must change less before the next."""
        explained = self.share * min(1.0, self.bound / max(residual, 1e-300))
        if gap > self.tolerance * max(LEAST_GAP, explained):
            return
        if residual > self.hoped:
            self.share *= OF_NO_AVAIL
        refined = finer(self.rtol, residual / self.bound)
        self.hoped, self.rtol = residual * (refined / self.rtol) ** 0.5, refined


def finer(rtol: float, residual: float) -> float:
    """Return the next tolerance where the cycle stands but its balances show the error of the integration.

    `residual` is the larger one over its bound.
    """
    return max(min(0.7, max(0.25, 0.5 / residual)) * rtol, min(rtol, FINEST_RTOL))
