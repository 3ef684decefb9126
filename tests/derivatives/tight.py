"""Cycles closed tightly with the regularisation of their scene: what derivatives are held against."""

from dataclasses import replace

import numpy as np

from screwsim.build import Temperatures, open_temperatures, with_temperatures
from screwsim.cycle.close import close
from screwsim.cycle.feedback import set_lines, set_unknowns, unknowns
from screwsim.cycle.problem import ClosingTask, Series, problem_of
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.effects.base import PressureLosses
from screwsim.evaluate.evaluation import Evaluation
from screwsim.solve.surroundings import KPA, implied_surroundings, unknowns_of

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
    cycle = close_together(ClosingTask(problem, machinery, wanted), chambers_at_pitches(machinery), most=MOST)
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
        self.loses = problem.scene.losses is not None  # pressures, in what lies around it
        lost = (2, 3) if self.loses else ()
        self.open = [*(i for i, each in enumerate(open_temperatures(problem.scene)) if each), *lost]
        self.x, self.begun, self.inverse = unknowns_of(problem), None, None
        base = self._closed(problem.scene, self.x)
        self.begun = base.life
        if self.open:
            off = self._off(base)
            columns = []
            for i in self.open:
                x = self.x.copy()
                x[i] += AROUND
                columns.append((self._off(self._closed(problem.scene, x)) - off) / AROUND)
            self.inverse = np.linalg.inv(np.array(columns).T)
        self.base = self.of(problem.scene) if self.open else base
        self.begun, self.x = self.base.life, unknowns_of(self.base.problem)

    def of(self, scene):
        """Return the evaluation of a scene near by."""
        x = self.x.copy()
        found = self._closed(scene, x)
        for _ in range(TURNS if self.open else 0):
            off = self._off(found)
            if np.abs(off).max() < AGREED:
                break
            x[self.open] -= self.inverse @ off
            found = self._closed(scene, x)
        return found

    def _off(self, of):
        asked = implied_surroundings(of)
        if asked is None:
            raise NotTight("gas and oil do not part")
        return asked.off[self.open]

    def _closed(self, scene, x):
        if any(open_temperatures(scene)):
            self.series.surroundings.temperatures = Temperatures(*x[:2].tolist())
            scene = with_temperatures(scene, self.series.surroundings.temperatures)
        if self.loses:
            self.series.surroundings.losses = PressureLosses(*(KPA * x[2:4]).tolist())
            scene = replace(scene, losses=self.series.surroundings.losses)
        problem = problem_of(scene, self.series)
        widths = tuple(a * b for a, b in zip(self.tightened, problem.criteria.widths, strict=True))
        return closed_tightly(problem, self.machinery, self.begun, *self.how, widths)
