"""Steps of Broyden's method to surroundings x that agree with what their cycle implies: off(x) = 0 (M284, M343).

Cycles are not closed exactly, so that what they imply is uncertain. Of a move d between cycles uncertain by a and b
only the share d²/(d² + a² + b²) of what it shows is learnt. An update that would reverse the response of the circuit is
not learnt. Source: ours, around `numerics.broyden`.
"""

from dataclasses import dataclass

import numpy as np

from screwsim.numerics import broyden
from screwsim.solve.surroundings import ImpliedSurroundings

Array = np.ndarray
LEAST_DECAY = 0.05  # smallest −(real part of an eigenvalue) of a Jacobian that is accepted
LONGEST_STEP = 40.0  # [K, kPa], longest step
STAYS = 3  # cycles that held an unknown at an end of its range, from which on it does not leave with the others' steps


@dataclass
class BroydenSteps:
    """The iteration: the Jacobian of `off` [K, kPa] by the unknowns [K, kPa], and the last cycle."""

    jacobian: Array | None = None
    _last: tuple[Array, Array, float] | None = None  # unknowns, what they were off by, the error of that [K, kPa]
    _held: Array | None = None  # how many cycles have held each unknown at an end of its range

    def step(self, x: Array, asked: ImpliedSurroundings, wrong: float) -> Array:
        """Return the next change of the unknowns [K, kPa] from x, where what is asked errs by `wrong` [K, kPa]."""
        off = asked.off
        if self.jacobian is None:
            self.jacobian = started_jacobian(asked)
        elif self._last is not None and np.any(x != self._last[0]):
            before, off_before, wrong_before = self._last
            moved = x - before
            weight = trusted_share(moved, wrong, wrong_before)
            self.jacobian = learnt(self.jacobian, off - off_before, moved, weight)
        self._last = x, off, wrong
        self._held = ~asked.free + (0 if self._held is None else self._held)
        free, found = asked.free | (self._held < STAYS), np.zeros(len(off))
        found[free] = -np.linalg.solve(self.jacobian[np.ix_(free, free)], off[free])
        largest = float(np.max(np.abs(found)))
        return found * min(1.0, LONGEST_STEP / largest) if largest > 0.0 else found


def started_jacobian(asked: ImpliedSurroundings) -> Array:
    """Return the Jacobian with which a search begins: what a cycle asks for is what it then has."""
    found = -np.eye(len(asked.off))
    found[1, 0] = asked.share
    return found


def trusted_share(moved: Array, *wrong: float) -> float:
    """Return the share to be learnt of what a move of the unknowns shows, by what was wrong at its ends [K, kPa]."""
    length = float(moved @ moved)
    return length / (length + sum(each * each for each in wrong))


def learnt(jacobian: Array, change: Array, moved: Array, weight: float) -> Array:
    """Return a Jacobian by Broyden's update, or the old one where that would reverse the circuit's response."""
    found = broyden.updated(jacobian, change, moved, weight)
    return found if np.all(np.linalg.eigvals(found).real < -LEAST_DECAY) else jacobian
