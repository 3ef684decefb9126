"""Look for a second cycle of the same machine.

Gaps that pass oil where the chamber behind them holds enough of it, and gas where it does not, can have two steady
states: tight machines keep their oil, leaky ones lose it. A cycle that closes slowly among such gaps is closed once
more from a dry start. A second case: waveform relaxation had all but closed when it was given up for its cost, and
simultaneous closing found a cycle elsewhere (behind check valves); relaxation is then continued from where it stood. If
either closes elsewhere, a warning says so.

Source: docs/explanation/closing.md, two cycles of one machine.
"""

from collections.abc import Iterator
from dataclasses import replace

from screwsim.cycle.balances import LEAST_WORK
from screwsim.cycle.coordinates import change
from screwsim.cycle.guess import install_first_guess
from screwsim.cycle.problem import ClosingTask, Problem
from screwsim.cycle.relaxation import relax
from screwsim.cycle.solution import CycleSolution, Expectation, Start
from screwsim.evaluate.evaluation import evaluate
from screwsim.figures.errors import relative_errors, worst
from screwsim.model.run import Machinery
from screwsim.solve.accurately import Accurate

DRY_FACTOR = 0.01  # factor on the oil of the first guess in a dry start
SLOW_CLOSING = 50_000  # evaluations of a closing up to which a single cycle is assumed
FIGURES_APART = 10.0  # wanted accuracies by which figures differ, at least, if the cycles count as two
LEAST_DIFFERENCE = 0.01  # and relative difference, at least, after a dry start
NEARLY_CLOSED = 3.0  # wanted accuracies: largest last change of turns that had all but closed ...
AWAY_BY_CHANGES = 10.0  # ... if the closed cycle is away from them by this many of those changes and ...
AWAY_BY_ACCURACIES = 5.0  # ... by this many wanted accuracies: farther than they would still have moved
FINER = 0.1  # factor on the wanted tolerance of a step when turns are continued from there
FIGURE_TEXTS = {"volumetric_efficiency": "a volumetric efficiency of {:.4g}", "gas_mass_flow": "{:.4g} kg/s of gas"}


def warnings(machinery: Machinery, accurate: Accurate) -> Iterator[str]:
    """Yield a warning where a closed cycle is not the only one; the machinery's last history is then arbitrary.

    The second closing is by waveform relaxation, within its usual bound on evaluations.
    """
    of, problem, figures = accurate.evaluation, accurate.evaluation.problem, accurate.evaluation.figures
    beside = nearly_closed_apart(problem, accurate.cycle)
    if beside is not None:
        machinery.put(beside.trajectory)
        start = Start(beside.y.copy(), Expectation(beside.seen, beside.change))
        criteria = replace(problem.criteria, rtol=FINER * problem.criteria.rtol)
        begun = "from the state that the turns of single chambers had reached"
    elif _dry_start_needed(problem, machinery.evaluations_of(accurate.cost.counts)):
        start, criteria = Start(install_first_guess(problem, machinery, DRY_FACTOR)), accurate.criteria
        begun = ""
    else:
        return
    other = relax(ClosingTask(problem, machinery, criteria), start, last=False)
    if other is None or not other.closed:
        return
    found = evaluate(problem, other).figures
    errors = relative_errors(figures, found, *of.least)
    least = 0.0 if begun else LEAST_DIFFERENCE
    if worst(errors)[1] <= max(FIGURES_APART * problem.scene.numerics.accuracy, least):
        return
    name = next(name for name in FIGURE_TEXTS if figures.get(name) is not None and found.get(name) is not None)
    here, there = (FIGURE_TEXTS[name].format(each[name]) for each in (figures, found))
    if begun:
        why = f"closed {begun}, it stays at {there}, not at {here}"
    else:
        why = f"started with little oil in its chambers, it stays at {there}, not at {here}, as its gaps then pass gas "
        why += "instead of oil"
    yield f"the machine has another cycle: {why}; which one it runs on depends on how it got there"


def nearly_closed_apart(problem: Problem, cycle: CycleSolution) -> CycleSolution | None:
    """Return relaxation's all but closed cycle apart from the one that simultaneous closing found; else None."""
    left, accuracy = cycle.abandoned_cycle, problem.scene.numerics.accuracy
    if left is None or problem.parts.shaft is not None or left.change > NEARLY_CLOSED * accuracy:
        return None
    least_work = LEAST_WORK * cycle.seen[0] * problem.pv
    away = change(cycle.seen, left.seen, least_work)
    return left if away > max(AWAY_BY_CHANGES * left.change, AWAY_BY_ACCURACIES * accuracy) else None


def _dry_start_needed(problem: Problem, evaluations: int) -> bool:
    """Return whether to try a dry start: a slow closing among gaps that pass oil or gas, without a drive."""
    parts = problem.parts
    return any(parts.films) and problem.composition.carried and evaluations > SLOW_CLOSING and parts.shaft is None
