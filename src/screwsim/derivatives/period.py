"""The map from the end of a pitch to the start of the next: each chamber moves on, and oil is injected into one.

The injection also sets run-time cells, on which rates may depend: the oil and gas that a chamber then holds. The
derivative of a pitch followed by this map is the monodromy matrix (`linear`).
"""

from collections.abc import Sequence

import numpy as np

from screwsim.cycle.linear_pitch import shifted
from screwsim.derivatives.events import Course
from screwsim.derivatives.mesh import Mesh
from screwsim.derivatives.rate_numbers import SMALL, RateNumbers
from screwsim.model.all_chambers import inject, moved_on
from screwsim.model.impacts import MOVES
from screwsim.model.numbers import oil_places
from screwsim.model.parts import Parts
from screwsim.model.run import Machinery
from screwsim.model.slots import P_INJECTION, P_PITCH, R_RATIO, R_SIZE

Array = np.ndarray
RUN_CELLS = R_SIZE - R_RATIO  # cells in R; further ones are in P


class Period:
    """The map of coupled chambers, with the numbers of a machinery on loan."""

    injected: int | None  # index of the chamber at the injection angle when a pitch starts; None where there is none
    at_rest: Sequence[int] = ()  # states that start with a value of their own, whatever they end with

    def __init__(self, machinery: Machinery, parts: Parts) -> None:
        self.machinery, c = machinery, machinery.composition
        index = round(float(c.P[P_INJECTION]) / float(c.P[P_PITCH]))
        self.injected = index if index < c.chambers else None
        # indices in P of the trapped gas that a pump uses (slots.P_TRAPPED), behind what `model.numbers` lays out
        self.noted = [oil_places(parts)["P_TRAPPED"]] if parts.pumped else []

    def start(self, Y: Array) -> Array:
        """Return the states at the pitch's start that follow from those at the nodes; set the run-time cells."""
        y = self.before_injection(Y)
        inject(self.machinery, y)
        return y

    def before_injection(self, Y: Array) -> Array:
        """Return the states before the injection, from those at the nodes."""
        return moved_on(self.machinery, np.ascontiguousarray(Y[-1, -1]))

    def change_before_injection(self, changes: Array) -> Array:
        """Return the changes of the states before the injection, from those at the nodes (slices, NODES, N, k)."""
        return shifted(changes[-1, -1], self.machinery.composition.chambers)

    def injects(self, y: Array, numbers: RateNumbers) -> tuple[Array, Array]:
        """Return states y after the injection with given numbers (which it overwrites), and the cells it sets."""
        states, (P, TAB, R) = y.copy(), numbers
        self.machinery.module.chamber__inject(states, (self.injected or 0) * self.machinery.n, P, TAB, R)
        return states, np.concatenate([R[R_RATIO:R_SIZE], P[self.noted]])

    def jacobian(self, Y: Array, step: float) -> tuple[Array, Array]:
        """Return the derivatives of states after the injection, and of the cells it sets, by the states before it.

        They are central differences over a relative `step`.
        """
        n, N = self.machinery.n, Y.shape[-1]
        states, cells = np.eye(N), np.zeros((len(self.cells()), N))
        if self.injected is None:
            return states, cells
        before = self.before_injection(Y)
        for i in range(self.injected * n, self.injected * n + n):
            size = max(abs(before[i]), SMALL)
            found = []
            for sign in (1.0, -1.0):
                y = before.copy()
                y[i] += sign * step * size
                found.append(self.injects(y, RateNumbers.of(self.machinery)))
            states[:, i] = (found[0][0] - found[1][0]) / (2.0 * step * size)
            cells[:, i] = (found[0][1] - found[1][1]) / (2.0 * step * size)
        states[list(self.at_rest)] = 0.0
        return states, cells

    # ---- cells -------------------------------------------------------------------------------------------------

    def cells(self) -> Array:
        """Return the run-time cells that the injection sets, and the parameters that it may set."""
        return np.concatenate([self.machinery.R[R_RATIO:R_SIZE], self.machinery.composition.P[self.noted]])

    def move_cells(self, by: float, change: Array) -> None:
        """Add a multiple of a change to the cells of the machinery."""
        self.machinery.R[R_RATIO:R_SIZE] += by * change[:RUN_CELLS]
        if self.noted:
            self.machinery.composition.P[self.noted] += by * change[RUN_CELLS:]

    def cells_as_numbers(self, change: Array) -> RateNumbers:
        """Return a change of the cells as a change of all numbers."""
        c, R = self.machinery.composition, np.zeros_like(self.machinery.R)
        R[R_RATIO:R_SIZE], P = change[:RUN_CELLS], np.zeros_like(c.P)
        P[self.noted] = change[RUN_CELLS:]
        return RateNumbers(P, np.zeros_like(c.TAB), R)


class TurnPeriod(Period):
    """The map of a single chamber: a turn starts with the states at its end, but what rests is at its seat or stop.

    Nothing is injected; cells that the injection angle sets are only read, at the end of the slice there.
    """

    def __init__(self, machinery: Machinery, parts: Parts, mesh: Mesh, course: Course) -> None:
        super().__init__(machinery, parts)
        self.injected = 0
        self.slice = int(np.abs(mesh.edges[1:] - float(machinery.composition.P[P_INJECTION])).argmin())
        pairs = zip(machinery.composition.stops, course.begins, strict=True)
        self._resting = [(*pair, 0.5 * (1.0 + mode)) for pair, mode in pairs if mode != MOVES]
        self.at_rest = [state for position, speed, _ in self._resting for state in (position, speed)]

    def start(self, Y: Array) -> Array:
        """Return the states at the turn's start that follow from those at the nodes; set the run-time cells."""
        P, TAB, R = self.machinery.composition.P, self.machinery.composition.TAB, self.machinery.R
        self.machinery.module.chamber__inject(self.before_injection(Y), 0, P, TAB, R)
        y = np.array(Y[-1, -1])
        for position, speed, end in self._resting:
            y[position], y[speed] = end, 0.0
        return y

    def before_injection(self, Y: Array) -> Array:
        """Return the states at the angle where cells are set."""
        return Y[self.slice, -1].copy()

    def change_before_injection(self, changes: Array) -> Array:
        """Return the changes of the states there, from those at the nodes (slices, NODES, N, k)."""
        return changes[self.slice, -1]


def period_of(machinery: Machinery, parts: Parts, mesh: Mesh, course: Course) -> Period:
    """Return the map of the chambers of a machinery."""
    return TurnPeriod(machinery, parts, mesh, course) if machinery.alone else Period(machinery, parts)
