"""The effect of a number of a scene on the rates' arguments: parameters, tables, lines, breakpoints, injected oil.

The scene with the number shifted is composed, not solved, which makes it an explicit function. Differences are
one-sided, against the cycle's own numbers, which are shared by all directions: their relative error is below 1e-6.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from screwsim.cycle.feedback import set_lines, set_unknowns, unknowns
from screwsim.cycle.problem import Problem
from screwsim.derivatives.argument_changes import ArgumentChange
from screwsim.derivatives.collocated_cycle import CollocatedCycle
from screwsim.derivatives.line_flows import open_volumes
from screwsim.derivatives.linear import DirectEffects
from screwsim.derivatives.linear_cycle import LinearisedCycle, linearised
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.inputs.faults import UsageError
from screwsim.model import speed
from screwsim.model.all_chambers import pitch_breakpoints
from screwsim.model.run import Machinery
from screwsim.model.slots import P_PITCH, R_RATIO, R_SIZE
from screwsim.numerics.identity_cache import once

Array = np.ndarray
ROOM = 8  # steps in the spare machinery, which does not integrate
SAME = 1e-9  # rad: movement of a breakpoint up to which it counts as fixed


class Structural(Exception):
    """A number affects the structure: the scene composed with it shifted is another model."""


class Direction(NamedTuple):
    """One number of a scene, shifted by `step` (of either sign), and the effects per unit of it.

    `problem` is the shifted one, `side` its numbers at the cycle; `change` is the effect on the rates, `start` and
    `cells` that on the injection, `stated` that on unknowns that the scene states, in coordinates.
    `open_volumes` are those of the shifted problem, where the flows into pulsating lines are read from the nodes.
    """

    problem: Problem
    side: RateNumbers
    step: float
    change: ArgumentChange
    start: Array
    cells: Array
    stated: Array
    open_volumes: Array | None

    def with_parameters(self, at: slice, change: Array) -> "Direction":
        """Return the direction with a change of parameters per unit of it added, at places in P."""
        side, numbers = self.side, self.change.numbers
        there, moved = side.P.copy(), numbers.P.copy()
        there[at] += self.step * change
        moved[at] += change
        by = self.change._replace(numbers=numbers._replace(P=moved))
        return self._replace(side=side._replace(P=there), change=by)


class Directions:
    """Directions of a collocated cycle; a spare machinery holds the numbers of shifted scenes."""

    def __init__(self, cycle: CollocatedCycle) -> None:
        self.cycle, machinery = cycle, cycle.pitch.machinery
        self.spare = Machinery(machinery.composition, machinery.module, ROOM)
        base = cycle.pitch.problem.composition
        self.breakpoints = pitch_breakpoints(machinery)
        self._linear: LinearisedCycle | None = None
        self.life = cycle.pitch.life(cycle.start, cycle.nodes, cycle.pitch.after(cycle.nodes))
        c = machinery.composition
        width = base.P[base.widths]
        self.tightened = np.where(width != 0.0, cycle.at.P[c.widths] / np.where(width != 0.0, width, 1.0), 1.0)

    def of(self, shifted: Callable[[float], Problem], step: float) -> Direction:
        """Return the direction of a number, from a function that poses the problem with it shifted.

        Where no scene can be posed on one side, the other is used; raises UsageError where neither can, and
        Structural.
        """
        try:
            problem, by = shifted(step), step
        except UsageError:
            problem, by = shifted(-step), -step
        if problem.composition.text != self.cycle.pitch.machinery.composition.text:
            raise Structural("decides the structure of the model")
        unmoved = self.cycle.pitch.problem
        if problem.entries is not unmoved.entries:  # the zero of enthalpies may move with the suction gas
            problem = replace(problem, entries=unmoved.entries)
        problem.__dict__["called"] = unmoved.called  # the same structure, so the same figures
        own, own_given = self.own  # compute first: the spare machinery is overwritten below
        side, given = self.numbers(problem, self.cycle.unknowns_in)
        if side.TAB.shape != self.cycle.at.TAB.shape:
            raise Structural("changes the size of the model's tables")
        numbers = RateNumbers(*((there - here) / by for there, here in zip(side, own, strict=True)))
        change = self._change(problem, numbers, by)
        start, cells = self._injected(numbers, step)
        open_to_lines = None if self.cycle.into is None else open_volumes(problem, self.cycle.pitch)
        return Direction(problem, side, by, change, start, cells, (given - own_given) / by, open_to_lines)

    def numbers(self, problem: Problem, unknowns_in: Array) -> tuple[RateNumbers, Array]:
        """Return the numbers of a problem with `unknowns_in`, and the coordinates of unknowns that its scene states."""
        machinery, entries = self.spare, problem.entries
        machinery.begin(problem.composition)
        P, c = machinery.composition.P, machinery.composition
        P[c.widths] *= self.tightened
        P[speed.curve_places(c)] = self.cycle.at.P[speed.curve_places(c)]
        set_lines(problem, machinery, float(self.cycle.start[0]), 0.0)
        given = entries.coordinates(unknowns(problem, machinery))
        return self._with_unknowns(problem, unknowns_in, c.TAB), given

    def _with_unknowns(self, problem: Problem, unknowns_in: Array, TAB: Array) -> RateNumbers:
        """Return the spare machinery's numbers with unknowns; cells that the injection sets keep the cycle's values."""
        set_unknowns(problem, self.spare, unknowns_in)
        P, R, at, noted = self.spare.composition.P, self.spare.R, self.cycle.at, self.cycle.pitch.period.noted
        P[noted], R[R_RATIO:R_SIZE] = at.P[noted], at.R[R_RATIO:R_SIZE]
        return RateNumbers(P.copy(), TAB, R.copy())

    def meeting(self, direction: Direction, unknowns_in: Array) -> RateNumbers:
        """Return the numbers of a direction's problem with other unknowns than its cycle's."""
        self.spare.composition.P[:], self.spare.R[:] = direction.side.P, direction.side.R
        return self._with_unknowns(direction.problem, unknowns_in, direction.side.TAB)

    @once
    def shifted(self) -> Array:
        """The states before the injection."""
        return self.cycle.pitch.period.before_injection(self.cycle.nodes)

    @once
    def own(self) -> tuple[RateNumbers, Array]:
        """The result of `numbers` for the cycle's own problem."""
        return self.numbers(self.cycle.pitch.problem, self.cycle.unknowns_in)

    def _change(self, problem: Problem, numbers: RateNumbers, by: float) -> ArgumentChange:
        """Return the change of the rates: of numbers, and of edges, which move with the breakpoints; with its side."""
        stay = problem.composition.breakpoints is self.cycle.pitch.problem.composition.breakpoints
        if stay and not numbers.P[P_PITCH]:
            return ArgumentChange(numbers)
        there = pitch_breakpoints(self.spare)  # it holds this problem's numbers (`numbers`)
        if len(there) == len(self.breakpoints):
            rates = (there - self.breakpoints) / by
            edges = self.cycle.pitch.mesh.edges  # move as breakpoints do, interpolated between these
            return ArgumentChange(numbers, np.interp(edges, self.breakpoints, rates) if rates.any() else None)
        ways = np.sign(by) * self._ways(there, float(self.cycle.at.P[P_PITCH]))
        some = ways[ways != 0.0]
        if not len(some) or (some == some[0]).all():
            return ArgumentChange(numbers, None, float(some[0]) if len(some) else 1.0)
        return ArgumentChange(numbers, None, np.where(ways == 0.0, 1.0, ways))

    def _ways(self, breakpoints: Array, pitch: float) -> Array:
        """Return the sign of the movement of breakpoints away from the end of each slice; 0 where there is none."""
        apart = (breakpoints[:, None] - self.breakpoints + 0.5 * pitch) % pitch - 0.5 * pitch
        nearest = np.abs(apart).argmin(axis=1)
        ways = np.zeros(len(self.breakpoints))
        moves = apart[np.arange(len(apart)), nearest]
        np.add.at(ways, nearest, np.where(np.abs(moves) > SAME, moves, 0.0))
        ends, found = self.cycle.pitch.mesh.edges[1:], np.zeros(self.cycle.pitch.count)
        at = np.abs(ends[:, None] - self.breakpoints)
        on = at.min(axis=1) < SAME
        found[on] = np.sign(ways[at[on].argmin(axis=1)])
        return found

    def _injected(self, numbers: RateNumbers, step: float) -> tuple[Array, Array]:
        """Return the change of states after the injection, and of the cells it sets, with numbers."""
        cycle, pitch = self.cycle, self.cycle.pitch
        if pitch.period.injected is None or numbers.nothing:
            return np.zeros(pitch.N), np.zeros(len(pitch.period.cells()))
        sides = (pitch.period.injects(self.shifted, cycle.at.plus(by, numbers)) for by in (step, -step))
        (y, cells), (y_below, cells_below) = sides
        return (y - y_below) / (2.0 * step), (cells - cells_below) / (2.0 * step)

    def along(self, directions: Sequence[Direction]) -> LinearisedCycle:
        """Return the cycle linearised along directions, a column each; directions without effect are skipped."""
        felt = [
            j for j, each in enumerate(directions) if not each.change.nothing or each.start.any() or each.cells.any()
        ]
        some = [directions[j] for j in felt] or directions[:1]
        start, cells = (np.stack([getattr(each, name) for each in some], axis=-1) for name in ("start", "cells"))
        found = linearised(self.cycle, [each.change for each in some], DirectEffects(start, cells), self._linear)
        self._linear = found  # parts of it depend on the cycle alone
        if len(some) == len(directions):
            return found
        among = np.zeros((len(some), len(directions)))
        among[range(len(felt)), felt] = 1.0
        return found._replace(by_changes=found.by_changes.weighted(among))
