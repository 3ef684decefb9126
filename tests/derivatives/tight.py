"""Cycles closed tightly with the regularisation of their scene: what derivatives are held against."""

from dataclasses import replace

import numpy as np

from screwsim.cycle.close import close
from screwsim.cycle.feedback import set_lines, set_unknowns, unknowns
from screwsim.cycle.problem import ClosingTask, Series, problem_of
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.derivatives.around import coordinates, implied_changes, open_coordinates, problem_at, speed_follows
from screwsim.evaluate.evaluation import Evaluation
from screwsim.solve.drive import close_with_drive
from screwsim.solve.surroundings import implied_surroundings

RTOL, TOLERANCE = 1e-8, 1e-10  # of a step, of a change: differences over 1e-4 are good to 1e-5
BOUND = 1e-4  # on the balances, which such steps keep anyway
MOST = 10**9  # evaluations: as many as it takes
AROUND = 1e-3  # [K, kPa] over which what the surroundings make of themselves is differenced ...
AGREED = 1e-9  # ... and up to which they are left open
TURNS = 12  # of the surroundings


class NotTight(Exception):
    """A cycle does not close as tightly as a reference must."""


def closed_tightly(problem, machinery, begun=None, rtol=RTOL, tolerance=TOLERANCE, widths=None):
    """Return the evaluation of a problem's cycle, of coupled chambers, begun from a life near by where one is given.

    `widths` [Pa] of the regularisation are those of the problem where none are given.
    """
    wanted = replace(problem.criteria, rtol=rtol, tolerance=tolerance, bound=BOUND, closing="coupled")
    wanted = wanted if widths is None else replace(wanted, widths=widths)
    machinery.begin(problem.composition)
    if begun is None:
        close(ClosingTask(problem, machinery, problem.criteria))
    else:
        numbers = machinery.composition.P.copy()
        machinery.put(begun)
        met = unknowns(problem, machinery)
        machinery.composition.P[:] = numbers
        set_lines(problem, machinery, float(begun.ends[0][0]), 0.0)
        set_unknowns(problem, machinery, met)
    task = ClosingTask(problem, machinery, wanted)
    cycle = close_with_drive(task, close_together(task, chambers_at_pitches(machinery), most=MOST))
    if cycle.status != "ok":
        raise NotTight(f"a cycle is {cycle.status} at {rtol:g} a step")
    return Evaluation(problem, cycle.trajectory, cycle.q)


class Tight:
    """Tightly closed cycles around one scene, what lies around the machine closed with each of them."""

    def __init__(self, problem, machinery, widths=None, rtol=RTOL, tolerance=TOLERANCE):
        """`problem` stands at what lies around it, as a solution found that, with `widths` of the regularisation."""
        self.machinery, self.series, self.how = machinery, Series(), (rtol, tolerance)
        own = problem.criteria.widths  # which follow the pressures of the lines, as those of a solution do
        self.tightened = [a / b if b else 1.0 for a, b in zip(widths or own, own, strict=True)]
        self.open, self.x, self.begun, self.inverse = open_coordinates(problem), coordinates(problem), None, None
        self.problem = problem
        base = self._closed(problem, self.x)
        self.begun = base.life
        if self.open:
            off = self._off(base)
            columns = []
            for i in self.open:
                x = self.x.copy()
                x[i] += AROUND
                columns.append((self._off(self._closed(problem, x)) - off) / AROUND)
            self.inverse = np.linalg.inv(np.array(columns).T)
        self.base = self._settled(problem) if self.open else base
        self.begun, self.x = self.base.life, coordinates(self.base.problem)

    def of(self, scene):
        """Return the evaluation of a scene near by."""
        stated = scene.operation.speed if speed_follows(self.problem) else None
        return self._settled(problem_of(scene, self.series, stated))

    def _settled(self, problem):
        x = self.x.copy()
        found = self._closed(problem, x)
        for _ in range(TURNS if self.open else 0):
            off = self._off(found)
            if np.abs(off).max() < AGREED:
                break
            x[self.open] -= self.inverse @ off
            found = self._closed(problem, x)
        return found

    def _off(self, of):
        if implied_surroundings(of) is None:
            raise NotTight("gas and oil do not part")
        return implied_changes(of)[self.open]

    def _closed(self, problem, x):
        problem = problem_at(problem, self.series, x)
        widths = tuple(a * b for a, b in zip(self.tightened, problem.criteria.widths, strict=True))
        return closed_tightly(problem, self.machinery, self.begun, *self.how, widths)
