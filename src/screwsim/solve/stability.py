"""Check whether a machine stays on the cycle that was found for it.

A periodic state is a fixed point of the turn or pitch, and may be found although the machine's own course leads away
from it. Heavy reeds on soft springs may have several cycles, none stable. Chambers whose gas can hardly get out heat,
empty and fill in a slow oscillation. Machines that suck again most of what they sucked may be unstable because a warmer
line reduces the flow and less flow warms the line.

Source: docs/reference/slider-crank.md S35; docs/explanation/closing.md, cycles that a machine's own course leaves.
"""

from screwsim.cycle.feedback import next_pitch, unknowns
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import evaluate
from screwsim.model.run import Machinery
from screwsim.model.slots import Q_WORK

TURNS = 20  # turns over which work is compared
LARGEST_WORK_CHANGE = 0.01  # relative change of a turn's work above which the machine has left the cycle
EASY_TURNS = 6.0  # turns of a closing up to which the cycle is assumed to be stable
UNSTABLE_GROWTH = 1.05  # growth over a pitch above which the cycle is unstable; the linearised pitch errs by some 3 %
LASTING_CHANGE = 0.99  # factor by which a change of the lines returns, above which the machine's own course is followed
DISTURBANCE = 1e-2  # change of the lines, in coordinates, with which that starts
SETTLING, GROWING = 2, 3  # lives in which the states settle to a change, and lives over which it then grows or not ...
UNSTABLE_LINES = 1.01  # ... and taken for instability above this


def largest_work_change(problem: Problem, machinery: Machinery, cycle: CycleSolution, rtol: float) -> float:
    """Return the largest relative change of a turn's work over the turns after the closed cycle.

    0 where it is not computed: for machines without seats and stops, and where the cycle closed within `EASY_TURNS`
    turns.
    """
    if not problem.composition.stops or (not way_of(cycle).whole and cycle.turns <= EASY_TURNS):
        return 0.0
    machinery.put(cycle.trajectory)
    y, worst, work = cycle.y.copy(), 0.0, float(cycle.q[Q_WORK])
    least = evaluate(problem, cycle).least[1]
    for _ in range(TURNS):
        status, _, turn = machinery.turn(y, rtol)
        worst = max(worst, abs(float(turn[0] - work)) / max(abs(work), least))
        if status != 0 or worst > LARGEST_WORK_CHANGE:
            break
    return worst


def line_growth(problem: Problem, machinery: Machinery, cycle: CycleSolution, rtol: float) -> float:
    """Return the growth of a small change of the lines over `GROWING` lives of the machine's own course.

    The change is the slowest-decaying one by Newton's corrections. 1 where it is not computed: where that decays
    fast, with a drive, and for cycles that were not closed by corrections of simultaneous closing.
    """
    lasting = cycle.lasting
    if lasting is None or lasting.factor <= LASTING_CHANGE or problem.parts.shaft is not None:
        return 1.0
    machinery.put(cycle.trajectory)
    y, met, entries = cycle.y.copy(), unknowns(problem, machinery), problem.entries
    here, seen, chambers = entries.coordinates(met), [], problem.composition.chambers
    met = entries.values(here + DISTURBANCE * lasting.along, met)
    for lives in (SETTLING, GROWING):
        for _ in range(lives * chambers):
            found = next_pitch(problem, machinery, y, met, rtol)
            if found is None:
                return 1.0
            y, met, _ = found
        seen.append(float(lasting.along @ (entries.coordinates(met) - here)))
    return max(1.0, seen[1] / seen[0]) if seen[0] != 0.0 else 1.0


def warnings(problem: Problem, machinery: Machinery, cycle: CycleSolution, rtol: float) -> tuple[str, ...]:
    """Return a warning where the machine does not stay on its cycle, else nothing."""
    if cycle.closed and cycle.growth > UNSTABLE_GROWTH:
        return (
            f"the machine does not stay on this cycle: a small change grows {cycle.growth:.3g}-fold over a pitch, so "
            "that it drifts away (larger ports or smaller gaps let the gas out)",
        )
    if not cycle.closed:
        return ()
    growth = line_growth(problem, machinery, cycle, rtol)
    if growth > UNSTABLE_LINES:
        return (
            f"the machine does not stay on this cycle: a small change of its lines grows {growth:.3g}-fold in "
            f"{GROWING} lives of a chamber, so that it drifts away, to another cycle or to none (another "
            "numerics.closing may find that other cycle; smaller gaps and leaks reduce the backflow)",
        )
    if largest_work_change(problem, machinery, cycle, rtol) <= LARGEST_WORK_CHANGE:
        return ()
    return (
        "the machine does not stay on this cycle: its turns drift away from it, and there may be other cycles (choose "
        "lighter reeds, stiffer springs or a smaller restitution)",
    )
