"""The life of a cycle that a number has shifted; its history is installed only when somebody reads it.

Most figures follow from quadratures and numbers, while a history costs the gas's properties at the ends of all steps.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, Self

import numpy as np

from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.sweeps import compiled as sweeps
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.identity_cache import once
from screwsim.numerics.rodas import dense_value

Array = np.ndarray


class PeakPlace(NamedTuple):
    """The highest pressure inside a step of a life: the step and the share of it where it lies.

    `states` (4, n) are those at the start and the nodes of the step.
    """

    step: int
    share: float
    states: Array


def in_step(pitch: CollocatedPitch, y: Array, inside: Callable[[slice], Array], after: Array, step: int) -> Array:
    """Return states at the start and the nodes (4, n) of a step of a life, or changes of these.

    `inside` returns those at the nodes of a range of slices (slices, NODES, N); `after` (events, N) are behind events.
    """
    chamber, k = divmod(step, pitch.count)
    rows = slice(chamber * pitch.n, (chamber + 1) * pitch.n)
    if k - 1 in pitch.passed:
        before = after[list(pitch.passed).index(k - 1), rows]
    else:
        before = y[rows] if k == 0 else inside(slice(k - 1, k))[0, -1, rows]
    return np.concatenate([before[None], inside(slice(k, k + 1))[0, :, rows]])


def between(states: Array, share: float) -> Array:
    """Return the states (n,) at a share of a step, from those at its start and its nodes (`CollocatedPitch.life`)."""
    found = np.empty((1, 1, states.size))
    nodes = np.ascontiguousarray(states[1:, :, None])
    sweeps().sweeps__lives(np.ascontiguousarray(states[0, :, None]), nodes, states.shape[1], found)
    y0, y1, c3, c4 = found.reshape(states.shape)
    return dense_value(share, y0, y1, c3, c4)


class ShiftedLife(Trajectory):
    """A life that is installed in its machinery as the last history on first use; its quadratures cover the whole life.

    With a `turning` its highest pressure is read there. It must be read before the machinery is used for anything
    else.
    """

    fill: Callable[[], Trajectory]
    turning: PeakPlace | None

    @classmethod
    def of(cls, pitch: CollocatedPitch, fill: Callable[[], None], turning: PeakPlace | None = None) -> Self:
        """Return the life of a pitch; `fill` installs it as the last history."""
        machinery = pitch.machinery
        nothing: Any = None
        c, module, R = machinery.composition, machinery.module, machinery.R
        found = cls(c, module, R, nothing, nothing, nothing, nothing, nothing, machinery._reading, machinery.line_flows)
        found.turning = turning

        def read() -> Trajectory:
            fill()
            return machinery.trajectory

        found.fill = read
        return found

    @once
    def _there(self) -> Trajectory:
        """The installed history."""
        return self.fill()

    @once
    def _worked(self) -> Trajectory:
        """The installed history with its work integrated."""
        there = self._there
        there.module.trace__work_along(there.times, there.dense, there.quads, there.steps, there.context)
        return there

    @property
    def times(self) -> Array:  # pyrefly: ignore[bad-override]
        """Edges of the steps [rad]."""
        return self._there.times

    @property
    def dense(self) -> Array:  # pyrefly: ignore[bad-override]
        """Polynomials of the steps."""
        return self._there.dense

    @property
    def quads(self) -> Array:  # pyrefly: ignore[bad-override]
        """The work only, for traces."""
        return self._worked.quads

    @property
    def steps(self) -> int:  # pyrefly: ignore[bad-override]
        """The number of steps."""
        return self._there.steps

    @property
    def context(self) -> Any:  # pyrefly: ignore[bad-override]
        """The context for kernels that read a life."""
        return self._there.context

    def denser(self, share: float) -> Trajectory:
        """Return the installed history with a density that is larger by a share of itself."""
        return self._there.denser(share)

    def sum_until(self, angle: float, quadrature: int) -> float:
        """Return 0: partial quadratures of this life are not known."""
        return 0.0

    def peak_pressure(self, limit: float) -> float:
        """Return the highest pressure [Pa] from injection up to an angle [rad]: that at the turning, if known."""
        if self.turning is None:
            return super().peak_pressure(limit)
        c, found = self.composition, np.empty(1)
        self.module.trace__pressures(between(self.turning.states, self.turning.share)[None], c.P, c.TAB, found)
        return float(found[0])
