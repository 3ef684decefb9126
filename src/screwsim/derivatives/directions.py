"""How a number of a scene moves what the rates take: parameters, tables, lines, breakpoints, the injected oil.

A scene with the number shifted is composed, not solved: that is a plain function, and its differences are exact but for
a millionth.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from screwsim.cycle.feedback import set_lines, set_unknowns, unknowns
from screwsim.cycle.problem import Problem
from screwsim.derivatives.closed import Closed
from screwsim.derivatives.linear import Change, Sources
from screwsim.derivatives.pitch import Numbers
from screwsim.derivatives.slices import moved
from screwsim.inputs.faults import UsageError
from screwsim.model.run import Machinery
from screwsim.model.slots import P_PITCH, R_RATIO, R_SIZE

Array = np.ndarray
ROOM = 8  # steps in the spare machinery, which integrates none
SAME = 1e-9  # rad by which a breakpoint that stays may move


class Structural(Exception):
    """A number decides on the structure: what is composed with it shifted is another model."""


class Direction(NamedTuple):
    """One number of a scene, shifted by `steps` (above, below), and what that moves per unit of it.

    `problems` are those above and below, `sides` their numbers as the cycle stands; `change` that of the rates, `start`
    and `cells` of what the injection does, `stated` of the unknowns that the scene states, in coordinates.
    """

    problems: tuple[Problem, Problem]
    sides: tuple[Numbers, Numbers]
    steps: tuple[float, float]
    change: Change
    start: Array
    cells: Array
    stated: Array


class Directions:
    """Makes directions of a collocated cycle; a spare machinery takes the numbers of shifted scenes."""

    def __init__(self, cycle: Closed) -> None:
        self.cycle, machinery = cycle, cycle.pitch.machinery
        self.spare = Machinery(machinery.composition, machinery.module, ROOM)
        base = cycle.pitch.problem.composition
        self.breakpoints = machinery.pitch_breakpoints()
        self.life = cycle.pitch.life(cycle.start, cycle.nodes)
        c = machinery.composition
        width = base.P[base.widths]
        self.tightened = np.where(width != 0.0, cycle.at.P[c.widths] / np.where(width != 0.0, width, 1.0), 1.0)

    def of(self, shifted: Callable[[float], Problem], step: float) -> Direction:
        """Return the direction of a number, from the problem posed with it shifted by so much.

        Where no scene can be posed on one side of it, it stays there; raise UsageError where neither can.
        """
        problems, steps = self._posed(shifted, step)
        text = self.cycle.pitch.machinery.composition.text
        if any(each.composition.text != text for each in problems):
            raise Structural("decides on the structure of the model")
        sides = [self.numbers(each, self.cycle.met) for each in problems]
        if any(each.TAB.shape != self.cycle.at.TAB.shape for each, _ in sides):
            raise Structural("changes the size of the model's tables")
        per = 1.0 / (steps[0] - steps[1])
        numbers = Numbers(*(per * (above - below) for above, below in zip(sides[0][0], sides[1][0], strict=True)))
        edges, one_sided = self._edges(problems, per)
        change = Change(numbers, edges, one_sided)
        start, cells = self._injected(numbers, step)
        return Direction(
            problems, (sides[0][0], sides[1][0]), steps, change, start, cells, per * (sides[0][1] - sides[1][1])
        )

    def _posed(
        self, shifted: Callable[[float], Problem], step: float
    ) -> tuple[tuple[Problem, Problem], tuple[float, float]]:
        """Return the problems above and below, and by how much they are shifted."""
        found, steps, wrong = [], [], None
        for by in (step, -step):
            try:
                found.append(shifted(by))
                steps.append(by)
            except UsageError as error:
                found.append(self.cycle.pitch.problem)
                steps.append(0.0)
                wrong = error
        if wrong is not None and not any(steps):
            raise wrong
        return (found[0], found[1]), (steps[0], steps[1])

    def numbers(self, problem: Problem, met: Array) -> tuple[Numbers, Array]:
        """Return the numbers of a problem that meets unknowns, and in coordinates what of these its scene states.

        Cells that the injection sets, and what the cycle makes, stay those of the cycle.
        """
        machinery, at, entries = self.spare, self.cycle.at, problem.entries
        machinery.begin(problem.composition)
        P, c = machinery.composition.P, machinery.composition
        P[c.widths] *= self.tightened
        set_lines(problem, machinery, float(self.cycle.start[0]), 0.0)
        given = entries.coordinates(unknowns(problem, machinery))
        set_unknowns(problem, machinery, met)
        noted = self.cycle.pitch.noted
        P[noted], machinery.R[R_RATIO:R_SIZE] = at.P[noted], at.R[R_RATIO:R_SIZE]
        return Numbers(P.copy(), c.TAB, machinery.R.copy()), given

    def _edges(self, problems: tuple[Problem, Problem], per: float) -> tuple[Array | None, tuple[float, float]]:
        """Return how the edges move with the breakpoints, None where they stay, and the sides to go to."""
        found = []
        for problem in problems:
            self.spare.begin(problem.composition)
            found.append(self.spare.pitch_breakpoints())
        above, below = found
        if len(above) == len(below) == len(self.breakpoints):
            rates = per * (above - below)
            if not rates.any():
                return None, (1.0, -1.0)
            return moved(self.cycle.pitch.slices, self.breakpoints, rates), (1.0, -1.0)
        pitch = float(self.cycle.at.P[P_PITCH])
        way = float(np.sign(self._ways(above, pitch) - self._ways(below, pitch)))
        return None, (way or 1.0, 0.0)

    def _ways(self, breakpoints: Array, pitch: float) -> float:
        """Return the sum of the distances of breakpoints from the nearest of the cycle's."""
        apart = (breakpoints[:, None] - self.breakpoints + 0.5 * pitch) % pitch - 0.5 * pitch
        nearest = apart[np.arange(len(apart)), np.abs(apart).argmin(axis=1)]
        return float(nearest[np.abs(nearest) > SAME].sum())

    def _injected(self, numbers: Numbers, step: float) -> tuple[Array, Array]:
        """Return by how much states behind the injection and the cells it sets change with numbers."""
        cycle, pitch = self.cycle, self.cycle.pitch
        if pitch.injected is None:
            return np.zeros(pitch.N), np.zeros(len(pitch.cells()))
        found = []
        for sign in (1.0, -1.0):
            pitch.put(cycle.at.plus(sign * step, numbers))
            found.append((pitch.begin(cycle.nodes), pitch.cells()))
        pitch.put(cycle.at)
        (y, cells), (y_below, cells_below) = found
        return (y - y_below) / (2.0 * step), (cells - cells_below) / (2.0 * step)


def sources_of(cycle: Closed, directions: list[Direction]) -> Sources:
    """Return the sources of directions, a column each."""
    found = cycle.linear.sources([each.change for each in directions])
    if not directions:
        return found
    start, cells = (np.stack([getattr(each, name) for each in directions], axis=-1) for name in ("start", "cells"))
    return found._replace(start=start, cells=cells)
