"""Whether a machine has another cycle beside the one that was found.

Gaps that pass oil where the chamber behind them holds enough of it, and gas where it does not, make two machines of
one: tight ones keep their oil, and leaky ones blow it away. A cycle that closes slowly among such gaps is closed once
more from a dry start; where that ends elsewhere, and closes there, a warning tells it.

Source: docs/explanation/numerics.md, two cycles of one machine.
"""

from collections.abc import Iterator

from screwsim.cycle.guess import begin
from screwsim.cycle.problem import Problem
from screwsim.cycle.relaxation import relax
from screwsim.cycle.solution import Start
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.figures.errors import relative_errors, worst
from screwsim.model.run import Machinery
from screwsim.solve.accurately import Accurate

DRY = 0.01  # of the oil in the other first guess
SLOW = 50_000  # evaluations of a closing, below which turns lead to the cycle from afar
APART = 10.0  # wanted accuracies between figures of cycles that are two
LEAST_APART = 0.01  # and so much at least
SHOWN = {"volumetric_efficiency": "a volumetric efficiency of {:.3g}", "gas_mass_flow": "{:.3g} kg/s of gas"}


def warnings(of: Evaluation, machinery: Machinery, accurate: Accurate) -> Iterator[str]:
    """Yield a warning where a closed cycle is not the only one; the machinery is left anywhere.

    The other start is one of waveforms, which may cost no more than they may otherwise.
    """
    if not _asked(of.problem, machinery.evaluations_of(accurate.counts)):
        return
    problem, figures = of.problem, of.figures
    y = begin(problem, machinery, DRY)
    other = relax(problem, machinery, accurate.wanted, Start(y), last=False)
    if other is None or not other.closed:
        return
    found = evaluate(problem, other).figures
    errors = relative_errors(figures, found, *of.least)
    if worst(errors)[1] <= max(APART * problem.scene.numerics.accuracy, LEAST_APART):
        return
    name = next(name for name in SHOWN if figures.get(name) is not None and found.get(name) is not None)
    here, there = (SHOWN[name].format(each[name]) for each in (figures, found))
    yield (
        f"the machine has another cycle: begun with little oil in its chambers it stays at {there}, not at {here}, as "
        "its gaps then pass gas where they passed oil; which one it runs on depends on how it came there"
    )


def _asked(problem: Problem, evaluations: int) -> bool:
    """Tell whether the scene has gaps that pass oil or gas, and closed slowly; not where a drive moves the shaft."""
    parts = problem.parts
    return any(parts.films) and problem.composition.carried and evaluations > SLOW and parts.shaft is None
