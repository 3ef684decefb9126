"""Whether a machine stays on the cycle that was found for it.

A periodic state is a fixed point of the turn, or of the pitch; what finds it need not care whether the machine's own
turns lead to it. Those of heavy reeds on soft springs may not: then several cycles exist, and none of them lasts. Nor
do those of chambers whose gas can hardly get out: they heat, empty and fill in a swing. Nor do cycles of machines that
suck again most of what they have sucked, where a warmer line makes less flow and less flow a warmer line.

Source: docs/reference/slider-crank.md S35; docs/explanation/closing.md, cycles that a machine's own course leaves.
"""

from screwsim.cycle.feedback import next_pitch, unknowns
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import evaluate
from screwsim.model.run import Machinery
from screwsim.model.slots import Q_WORK

TURNS = 20
STRAYED = 0.01  # change of the work of a turn, over that of the cycle
EASY = 6.0  # turns in which a cycle closes that the machine's turns lead to anyway
GROWS = 1.05  # a small change over a pitch; the linearised pitch errs by some 3 %
LASTS = 0.99  # factor by which a change of the lines comes back, from which on the machine's own course is asked
PUSHED = 1e-2  # change of the lines, in coordinates, with which that begins
SETTLE, GO_ON = 2, 3  # lives after which the states have settled to a change, and over which it grows or not ...
AWAY = 1.01  # ... by more than this


def strayed(problem: Problem, machinery: Machinery, cycle: CycleSolution, rtol: float) -> float:
    """Return by how much the work of a turn strays from the closed cycle's over the next turns, as a share of it.

    0 where it is not asked: of machines without seats and stops, and where the cycle closed within `EASY` turns.
    """
    if not problem.composition.stops or (not way_of(cycle).whole and cycle.turns <= EASY):
        return 0.0
    machinery.put(cycle.trajectory)
    y, worst, work = cycle.y.copy(), 0.0, float(cycle.q[Q_WORK])
    least = evaluate(problem, cycle).least[1]
    for _ in range(TURNS):
        status, _, _, turn = machinery.turn(y, rtol, 1e-3)
        worst = max(worst, abs(float(turn[0] - work)) / max(abs(work), least))
        if status != 0 or worst > STRAYED:
            break
    return worst


def led_away(problem: Problem, machinery: Machinery, cycle: CycleSolution, rtol: float) -> float:
    """Return by which factor a small change of what the lines hold grows over `GO_ON` lives of the machine's course.

    It is the change that Newton's corrections tell to last longest. 1 where it is not asked: where that soon ends, and
    of cycles that no correction of all chambers together has closed.
    """
    lasting = cycle.lasting
    if lasting is None or lasting.factor <= LASTS or problem.parts.shaft is not None:
        return 1.0
    machinery.put(cycle.trajectory)
    y, met, entries = cycle.y.copy(), unknowns(problem, machinery), problem.entries
    here, seen, chambers = entries.coordinates(met), [], problem.composition.chambers
    met = entries.values(here + PUSHED * lasting.along, met)
    for lives in (SETTLE, GO_ON):
        for _ in range(lives * chambers):
            found = next_pitch(problem, machinery, y, met, rtol)
            if found is None:
                return 1.0
            y, met, _ = found
        seen.append(float(lasting.along @ (entries.coordinates(met) - here)))
    return max(1.0, seen[1] / seen[0]) if seen[0] != 0.0 else 1.0


def warnings(problem: Problem, machinery: Machinery, cycle: CycleSolution, rtol: float) -> tuple[str, ...]:
    """Return a warning where the machine does not stay on its cycle."""
    if cycle.closed and cycle.growth > GROWS:
        return (
            f"the machine does not stay on this cycle: a small change grows to {cycle.growth:.3g} times itself over a "
            "pitch, so that its own course leads away (larger ports or smaller gaps let the gas out)",
        )
    if not cycle.closed:
        return ()
    growth = led_away(problem, machinery, cycle, rtol)
    if growth > AWAY:
        return (
            f"the machine does not stay on this cycle: a small change of its lines grows to {growth:.3g} times itself "
            f"in {GO_ON} lives of a chamber, so that its own course leads away, to another cycle or to none (another "
            "numerics.closing may find that one; smaller gaps and leaks bring less back)",
        )
    if strayed(problem, machinery, cycle, rtol) <= STRAYED:
        return ()
    return (
        "the machine does not stay on this cycle: its own turns stray from it, and there may be others (lighter reeds, "
        "stiffer springs or a smaller restitution)",
    )
