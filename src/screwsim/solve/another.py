"""Whether a machine has another cycle beside the one that was found.

Gaps that pass oil where the chamber behind them holds enough of it, and gas where it does not, make two machines of
one: tight ones keep their oil, and leaky ones blow it away. A cycle that closes slowly among such gaps is closed once
more from a dry start. So is one that turns stood beside, when they had cost too much and all chambers together closed
it elsewhere (behind check valves): from where the turns stood. Where that ends elsewhere, and closes there, a warning
tells it.

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

DRY = 0.01  # of the oil in the other first guess
SLOW = 50_000  # evaluations of a closing, below which turns lead to the cycle from afar
APART = 10.0  # wanted accuracies between figures of cycles that are two
LEAST_APART = 0.01  # and so much at least, after a dry start
BESIDE = 3.0  # wanted accuracies: the last change of turns that all but closed ...
AWAY = 10.0  # ... of whose last change, and ...
LEAST_AWAY = 5.0  # ... of wanted accuracies the closed cycle is farther away than they would have gone yet
FINER = 0.1  # of the wanted tolerance of a step, with which turns go on from there
SHOWN = {"volumetric_efficiency": "a volumetric efficiency of {:.4g}", "gas_mass_flow": "{:.4g} kg/s of gas"}


def warnings(of: Evaluation, machinery: Machinery, accurate: Accurate) -> Iterator[str]:
    """Yield a warning where a closed cycle is not the only one; the machinery is left anywhere.

    The other start is one of waveforms, which may cost no more than they may otherwise.
    """
    problem, figures, beside = of.problem, of.figures, stood_beside(of.problem, accurate.cycle)
    if beside is not None:
        machinery.put(beside.trajectory)
        start = Start(beside.y.copy(), Hope(beside.seen, beside.change))
        other = relax(problem, machinery, replace(problem.wanted, rtol=FINER * problem.wanted.rtol), start, last=False)
        begun = "from where turns of one chamber after the other stood"
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
        why = f"closed {begun} it stays at {there}, not at {here}"
    else:
        why = f"begun with little oil in its chambers it stays at {there}, not at {here}, as its gaps then pass gas "
        why += "where they passed oil"
    yield f"the machine has another cycle: {why}; which one it runs on depends on how it came there"


def stood_beside(problem: Problem, cycle: CycleSolution) -> CycleSolution | None:
    """Return where turns stood, all but closed, beside the cycle that all chambers together closed; None elsewhere."""
    left, accuracy = cycle.left_at, problem.scene.numerics.accuracy
    if left is None or problem.parts.shaft is not None or left.change > BESIDE * accuracy:
        return None
    least_work = LEAST_WORK * cycle.seen[0] * problem.pv
    away = change(cycle.seen, left.seen, least_work)
    return left if away > max(AWAY * left.change, LEAST_AWAY * accuracy) else None


def _asked(problem: Problem, evaluations: int) -> bool:
    """Tell whether the scene has gaps that pass oil or gas, and closed slowly; not where a drive moves the shaft."""
    parts = problem.parts
    return any(parts.films) and problem.composition.carried and evaluations > SLOW and parts.shaft is None
