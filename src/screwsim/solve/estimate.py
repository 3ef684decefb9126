"""How accurate the figures of a closed cycle are.

The estimate is one more life from the closed cycle with a finer tolerance and a narrower regularisation, or two, the
first led by Newton's correction to where all that follow would go: what they change in the figures (docs/model.md M41).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from screwsim.cycle.balances import left_late, mass_in, met_across, residuals, streams_of
from screwsim.cycle.close import again
from screwsim.cycle.coordinates import NEAR
from screwsim.cycle.fallbacks import MOST_OF_A_TRY
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.newton import Correction, Corrections, led
from screwsim.cycle.problem import Problem
from screwsim.cycle.relaxation import SLOW, along
from screwsim.cycle.search import SEARCH
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import CycleSolution, Led
from screwsim.cycle.wanted import Wanted
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.figures.errors import flow_errors, relative_errors, worst
from screwsim.model.exchange import station
from screwsim.model.run import Machinery
from screwsim.model.slices import INSIDE
from screwsim.model.slots import DISCHARGE_IN, DISCHARGE_OUT, OF_GAS, P_INJECTION, P_PITCH, R_TRAPPED, SUCTION_OUT
from screwsim.model.trajectory import Array
from screwsim.outputs import Figures

FINER = 0.25  # tolerance of a step in the turn that estimates the error
NARROWER = 0.25  # regularisation in that turn
WHOLE = 1.0 / (1.0 - NARROWER**0.5)  # the error over what that turn shows of it, where it is the regularisation's root
MUCH = 1e-4  # wanted accuracy from which on two turns estimate
TIGHT = 0.75  # volumetric efficiency below which leaks rule, and two turns estimate
LEAKY = 0.5  # volumetric efficiency below which an error of histories lives on for so many turns
HIDDEN = 1.5  # that it is as many times what two of them show
EMPTY = 2.0  # the same of a machine that delivers nothing: what leaks is all there is
QUICK = 0.7  # share of a life's change that the next one makes, below which two lives tell what all would
SLOWEST = 0.9  # the largest such share that is believed
SMALL = 0.05  # of the wanted accuracy: a change of the second life below which no more is asked
FAITHFUL = 0.15  # share that corrections missed when closing, below which where they lead is read without a life there
DELIVERS = 0.2  # volumetric efficiency above which that is: what leaks hide of an error is larger where less is left
LINEAR = 0.1  # share of such a correction that is taken to be wrong, at least
BARELY = 0.03  # volumetric efficiency below which what leaks hide of an error is told by chambers closed together alone
BY_CHANCE = 0.3  # of what the gas trapped errs by: what is delivered, a small part of it, errs by no less


class Finer(NamedTuple):
    """Figures of finer lives; `left`: of the first one's change, what Newton's correction left to the second.

    The last may be no life but what a correction makes of the one before: `flow` is what it changes of the net flow,
    `led` where the machinery stands then. `cycle` is the finer one that a search closed, on which it stands.
    """

    lives: Sequence[Figures]
    left: float | None = None
    flow: float = 0.0
    led: Led | None = None
    cycle: CycleSolution | None = None


NOTHING = Finer(())


def estimated_errors(
    of: Evaluation, machinery: Machinery, wanted: Wanted, cycle: CycleSolution
) -> tuple[Figures, Led | CycleSolution | None]:
    """Return the estimated relative error of every figure of a closed cycle, on which the machinery stands.

    And where it stands now, if that is where finer lives lead, or the finer cycle that a search closed.
    """
    found = of.figures
    station()
    narrower = replace(wanted, widths=tuple(NARROWER * width for width in wanted.widths))
    finer = _finer(of, machinery, narrower, cycle)
    if not finer.lives:
        return Figures(dict.fromkeys(found)), None
    station()
    errors = _shown(found, finer, of.least)
    c = of.problem.composition
    told = c.chambers == 1 or way_of(cycle).whole or finer.left is not None  # what comes back from other chambers
    among_leaks = not told and _filling(found) < LEAKY  # chambers live on what leaks
    whole = WHOLE * ((HIDDEN if _filling(found) > 0.0 else EMPTY) if among_leaks else 1.0)
    left = cycle.left if len(finer.lives) == 1 else 0.0  # more than one life shows it
    for name, size in errors.items():
        errors[name] = whole * size + left if size is not None else None
    lost_flow = {"by_flow": whole * finer.flow} if finer.flow else {}
    if _hidden(of, cycle) and _filling(found) > 0.0:
        lost_flow["by_flow"] = BY_CHANCE * (errors.get("trapped_mass") or 0.0) / _filling(found)
    for by, lost in [*lost_flow.items(), *_left_open(of, cycle.q).items()]:
        for name, size in flow_errors(found, lost, by).items():
            errors[name] = (errors[name] or 0.0) + (size or 0.0)
    return errors, finer.led or finer.cycle


def _left_open(of: Evaluation, q: Array) -> dict[str, float]:
    """Return what a life leaves open of gas and carried oil, over the flows whose figures err by that.

    What gaps between chambers that are open to the suction line err by, the line makes good. Neither the net flow nor
    the injected oil knows of it, where it is taken beyond; oil is injected before a slide's slot has closed.
    """
    problem, lost = of.problem, {}
    flow, oil = of.figures["gas_mass_flow"], of.figures.get("oil_mass_flow")
    if flow and not met_across(problem):
        lost["by_flow"] = abs(mass_in(problem.composition, q) * problem.rate / flow)
    if oil and problem.composition.carried and left_late(problem):
        left = of.left or residuals(problem, of.life.R, q)
        lost["by_oil"] = left.oil_left * problem.rate / abs(oil)
    return lost


def _shown(found: Figures, finer: Finer, least: tuple[float, float]) -> Figures:
    """Return what finer lives show of the error of each figure: the most they change, and what later ones yet would.

    Two lives may agree with the closed one by chance where each goes another way. The last life's change is followed by
    others, each as much smaller as that one was than the life's before it. A corrected life is where all would lead,
    but for what its correction left; what lies before it is on the way there.
    """
    lives, left = finer.lives, finer.left
    errors = relative_errors(found, lives[-1], *least)
    for each in lives[:-1] if left is None else ():
        for name, size in relative_errors(found, each, *least).items():
            if size is not None and errors[name] is not None:
                errors[name] = max(errors[name], size)
    if len(lives) > 1:
        steps = [relative_errors(old, new, *least) for old, new in pairwise([found, *lives])]
        again = min(_repeated(steps) if left is None else left, SLOWEST)
        for name, size in steps[-1].items():
            if size is not None and errors[name] is not None:
                errors[name] += size * again / (1.0 - again)
    return errors


def _repeated(steps: Sequence[Figures]) -> float:
    """Return the share of a life's change that the last life made once more."""
    before, last = (worst(step)[1] for step in steps[-2:])
    return last / before if before > 0.0 else 0.0


def _fed_back(of: Evaluation) -> bool:
    """Tell whether one finer life is not enough for an estimate: errors come back through what it still meets.

    That is the coarser life of its neighbours; what the cycle makes beside the discharge line; the state at its own
    beginning, where much of it is kept: of one chamber alone, of reeds, of oil whose amount nothing but the flows tell,
    or that goes from chamber to chamber as films.
    """
    return of.problem.scene.numerics.accuracy <= MUCH or _filling(of.figures) < TIGHT or _keeps(of.problem)


def _keeps(problem: Problem) -> bool:
    """Tell whether a life begins with what the one before left in more than the states of gas and its oil."""
    parts, c = problem.parts, problem.composition
    if parts.made or parts.suction_line or any(parts.films):
        return True
    displaced = c.carried and parts.oil is not None and "ratio" not in parts.oil.supply
    kept = c.chambers == 1 or bool(c.own_states)
    return kept or displaced or c.ported or c.dissolves


def _filling(found: Figures) -> float:
    """Return the volumetric efficiency, 1 where it is not defined."""
    filling = found.get("volumetric_efficiency")
    return 1.0 if filling is None else filling


def _finer(of: Evaluation, machinery: Machinery, wanted: Wanted, cycle: CycleSolution) -> Finer:
    """Return finer solutions beside a closed cycle: lives, or another cycle; none where all stop.

    One life more shows the error of a cycle closed by waveforms, two where errors come back; where they come back
    slowly Newton's correction tells what they come to. With simultaneous closing, and where corrections are of no use,
    what shows it is the cycle closed again, finer.
    """
    if _hidden(of, cycle):
        together = _together(of.problem, machinery, wanted, cycle)
        if together is not None:
            return Finer([together])
        machinery.put(cycle.trajectory)
    finer = NOTHING if cycle.needed or way_of(cycle).whole else _finer_lives(of, machinery, wanted, cycle)
    if len(finer.lives) == 1 or _tells(of, finer):
        return finer
    closed = _finer_cycle(of.problem, machinery, wanted, cycle)
    if closed is None:
        return finer._replace(led=None)
    return Finer([evaluate(of.problem, closed).figures], cycle=closed if closed.needed == SEARCH else None)


def _hidden(of: Evaluation, cycle: CycleSolution) -> bool:
    """Tell whether lives among the closed cycle's would repeat its error: turns that had to be corrected close it.

    Where nothing is delivered all that a chamber holds comes from the others, whose errors a correction leaves alone.
    """
    return not way_of(cycle).whole and cycle.tangents is not None and _filling(of.figures) < BARELY


def _tells(of: Evaluation, finer: Finer) -> bool:
    """Tell whether lives show what all later ones would make."""
    if len(finer.lives) < 2:
        return False
    steps = [relative_errors(old, new, *of.least) for old, new in pairwise([of.figures, *finer.lives])]
    small = worst(steps[-1])[1] < SMALL * of.problem.scene.numerics.accuracy
    return small or (_repeated(steps) if finer.left is None else finer.left) < QUICK


def _finer_lives(of: Evaluation, machinery: Machinery, wanted: Wanted, cycle: CycleSolution) -> Finer:
    """Return one life more, or two, finer than the closed one's; none where one stopped.

    Where two are asked for the first is corrected by the tangents that closed the cycle; where there are none and they
    repeat themselves, the second by new ones, for a third.
    """
    if not _fed_back(of):
        return _finer_life(of.problem, machinery, wanted, cycle)
    lives = _Lives(of, machinery, wanted, cycle)
    if not lives.next():
        return NOTHING
    corrected = cycle.tangents is not None and lives.correct()
    if lives.correction is not None and _foretold(of, cycle):
        return lives.foretold(lives.correction, max(LINEAR, cycle.missed))
    if not lives.next():
        return NOTHING
    if not corrected and lives.repeated() > SLOW and lives.correct():
        corrected = lives.next()
        if not corrected:
            return NOTHING
    return Finer(lives.figures, lives.left() if corrected else None)


def _foretold(of: Evaluation, cycle: CycleSolution) -> bool:
    """Tell whether what a correction makes of a life is as good as another life, as those that closed were."""
    problem = of.problem
    if problem.scene.numerics.accuracy <= MUCH or _filling(of.figures) <= DELIVERS:
        return False
    plain = met_across(problem) and not _keeps(problem) and not problem.composition.pulsating
    return plain and cycle.missed < FAITHFUL


def _finer_life(problem: Problem, machinery: Machinery, wanted: Wanted, cycle: CycleSolution) -> Finer:
    """Return one life that follows a closed cycle; nothing where it stops."""
    machinery.composition.P[machinery.composition.widths] = wanted.widths
    status, _, _, q = machinery.turn(cycle.y.copy(), FINER * cycle.rtol, 1e-3)
    if status != 0:
        return NOTHING
    machinery.swap()
    station()
    return Finer([Evaluation(problem, machinery.trajectory, q).figures])


class _Lives:
    """Lives that follow a closed cycle, one among the other, with finer steps and what else is wanted."""

    def __init__(self, of: Evaluation, machinery: Machinery, wanted: Wanted, cycle: CycleSolution) -> None:
        self.of, self.machinery, self.rtol, self.y = of, machinery, FINER * cycle.rtol, cycle.y.copy()
        machinery.composition.P[machinery.composition.widths] = wanted.widths
        self.corrections = Corrections(of.problem, machinery, cycle.tangents)
        self.met = self.made = unknowns(of.problem, machinery)
        self.figures: list[Figures] = []
        self.correction: Correction | None = None  # of the last life
        self.changes: list[float] = []  # of the states and unknowns that each life met

    def next(self) -> bool:
        """Integrate one more; tell whether it came to its end."""
        problem, machinery = self.of.problem, self.machinery
        if self.figures:
            self.met = self.made
            set_unknowns(problem, machinery, self.met)
        self.start, self.steps = along(machinery, self.y), int(machinery.kept[1])
        status, _, _, self.q = machinery.turn(self.y, self.rtol, 1e-3)
        if status != 0:
            return False
        machinery.swap()
        life = Evaluation(problem, machinery.trajectory, self.q)
        self.figures.append(life.figures)
        self.made = problem.entries.possible(life.image)
        self.end = along(machinery, self.y)
        moved = NEAR * float(np.max(np.abs(self.end - self.start)))
        self.changes.append(max(moved, problem.entries.change(self.made, self.met)))
        return True

    def correct(self) -> bool:
        """Lead the last life to where all that follow would go; tell whether a correction was to be had."""
        pulsating = self.of.problem.composition.pulsating  # new tangents cost as much as some lives there
        if not self.corrections.able or (pulsating and not self.corrections.begun):
            return False
        n = self.machinery.n
        found = self.corrections.of_turn(self.steps, self.end[:n] - self.start[:n], self.q, self.met, self.made)
        if found is None:
            return False
        self.made, self.correction = led(self.of.problem, found, self.end[:n], self.y, self.made), found
        return True

    def foretold(self, by: Correction, wrong: float) -> Finer:
        """Return the lives and what the last correction makes of them, read from the history that it moved.

        But for the net flow: what a port gives and what crosses an angle change by far more than their sum.
        """
        problem, machinery, c = self.of.problem, self.machinery, self.of.problem.composition
        sums = by.sums.copy()
        streams = streams_of(c, sums)
        out = streams[DISCHARGE_IN : DISCHARGE_OUT + 1, OF_GAS].sum()
        passed = abs(out / max(float(machinery.R[R_TRAPPED]), 1e-300))
        streams[: SUCTION_OUT + 1, OF_GAS] = 0.0
        set_unknowns(problem, machinery, self.made)
        at, n = float(c.P[P_INJECTION]), machinery.n
        y = np.zeros(c.chambers * n)
        index = round(at / c.P[P_PITCH])
        y[index * n : index * n + n] = machinery.states_at(np.array([at - INSIDE]))[0]
        machinery.inject(y)
        life = Evaluation(problem, machinery.trajectory, self.q + sums)
        led = Led(self.y, (float(machinery.R[R_TRAPPED]), float(life.q[0])))
        return Finer([*self.figures, life.figures], wrong, max(abs(by.mass), passed), led)

    def repeated(self) -> float:
        """Return the share of its change that the last life made once more."""
        all_figures = [self.of.figures, *self.figures]
        return _repeated([relative_errors(old, new, *self.of.least) for old, new in pairwise(all_figures)])

    def left(self) -> float:
        """Return the share that a correction left of the change before it; none where that is hardly any."""
        before, last = self.changes[-2:]
        return 0.0 if last < SMALL * self.of.problem.scene.numerics.accuracy else last / max(before, 1e-300)


def _together(problem: Problem, machinery: Machinery, wanted: Wanted, cycle: CycleSolution) -> Figures | None:
    """Return the figures of all chambers closed together from a closed cycle, with finer steps; None where none do."""
    wanted = replace(wanted, rtol=FINER * cycle.rtol)
    finer = close_together(problem, machinery, wanted, chambers_at_pitches(machinery))
    return evaluate(problem, finer).figures if finer.status == "ok" else None


def _finer_cycle(problem: Problem, machinery: Machinery, wanted: Wanted, cycle: CycleSolution) -> CycleSolution | None:
    """Return the cycle that closes with finer steps from the closed one; None where none does.

    A cycle that only a fallback closed draws its neighbourhood in slowly, or not at all: what the steps of one life are
    off by is far less than what the cycle is off by. It goes the way that closed it and may cost as much as a fallback.
    """
    wanted = replace(wanted, rtol=FINER * cycle.rtol, tolerance=FINER * wanted.tolerance)
    if cycle.needed:
        finer = again(problem, machinery, wanted, cycle)
    else:
        finer = way_of(cycle).finer(problem, machinery, wanted, cycle, MOST_OF_A_TRY)
    return finer if finer is not None and finer.status == "ok" else None
