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
from screwsim.cycle.guess import begin
from screwsim.cycle.problem import Problem
from screwsim.cycle.relaxation import relax
from screwsim.cycle.solution import CycleSolution, Hope, Start
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.figures.errors import relative_errors, worst
from screwsim.model.run import Machinery
from screwsim.solve.accurately import Accurate

DRY = 0.01  # factor on the oil of the first guess in a dry start
SLOW = 50_000  # evaluations of a closing up to which a single cycle is assumed
APART = 10.0  # wanted accuracies by which figures differ, at least, if the cycles count as two
LEAST_APART = 0.01  # and relative difference, at least, after a dry start
BESIDE = 3.0  # wanted accuracies: largest last change of turns that had all but closed ...
AWAY = 10.0  # ... if the closed cycle is away from them by this many of those changes and ...
LEAST_AWAY = 5.0  # ... by this many wanted accuracies: farther than they would still have moved
FINER = 0.1  # factor on the wanted tolerance of a step when turns are continued from there
SHOWN = {"volumetric_efficiency": "a volumetric efficiency of {:.4g}", "gas_mass_flow": "{:.4g} kg/s of gas"}


def warnings(of: Evaluation, machinery: Machinery, accurate: Accurate) -> Iterator[str]:
    """Yield a warning where a closed cycle is not the only one; the machinery's last history is then arbitrary.

    The second closing is by waveform relaxation, within its usual bound on evaluations.
    """
    problem, figures, beside = of.problem, of.figures, stood_beside(of.problem, accurate.cycle)
    if beside is not None:
        machinery.put(beside.trajectory)
        start = Start(beside.y.copy(), Hope(beside.seen, beside.change))
        other = relax(problem, machinery, replace(problem.wanted, rtol=FINER * problem.wanted.rtol), start, last=False)
        begun = "from the state that the turns of single chambers had reached"
    elif _asked(problem, machinery.evaluations_of(accurate.counts)):
        other = relax(problem, machinery, accurate.wanted, Start(begin(problem, machinery, DRY)), last=False)
        begun = ""
    else:
        return
    if other is None or not other.closed:
        return
    found = evaluate(problem, other).figures
    errors = relative_errors(figures, found, *of.least)
    least = 0.0 if begun else LEAST_APART
    if worst(errors)[1] <= max(APART * problem.scene.numerics.accuracy, least):
        return
    name = next(name for name in SHOWN if figures.get(name) is not None and found.get(name) is not None)
    here, there = (SHOWN[name].format(each[name]) for each in (figures, found))
    if begun:
        why = f"closed {begun}, it stays at {there}, not at {here}"
    else:
        why = f"started with little oil in its chambers, it stays at {there}, not at {here}, as its gaps then pass gas "
        why += "instead of oil"
    yield f"the machine has another cycle: {why}; which one it runs on depends on how it got there"


def stood_beside(problem: Problem, cycle: CycleSolution) -> CycleSolution | None:
    """Return the all but closed cycle that relaxation was at, away from that which simultaneous closing found.

    Else None.
    """
    left, accuracy = cycle.left_at, problem.scene.numerics.accuracy
    if left is None or problem.parts.shaft is not None or left.change > BESIDE * accuracy:
        return None
    least_work = LEAST_WORK * cycle.seen[0] * problem.pv
    away = change(cycle.seen, left.seen, least_work)
    return left if away > max(AWAY * left.change, LEAST_AWAY * accuracy) else None


def _asked(problem: Problem, evaluations: int) -> bool:
    """Return whether to try a dry start: a slow closing among gaps that pass oil or gas, without a drive."""
    parts = problem.parts
    return any(parts.films) and problem.composition.carried and evaluations > SLOW and parts.shaft is None
