"""Whether a machine of one chamber stays on the cycle that was found for it.

A periodic state is a fixed point of the turn; what finds it need not care whether the machine's own turns lead to it.
Those of heavy reeds on soft springs may not: then several cycles exist, and none of them lasts.

Source: docs/reference/slider-crank.md S35.
"""

from __future__ import annotations

from screwsim.model import close as closing
from screwsim.solution import Solution

TURNS = 20
STRAYED = 0.01  # change of the work of a turn, over that of the cycle
EASY = 6.0  # turns in which a cycle closes that the machine's turns lead to anyway


def strayed(solution: Solution, closed: closing.Closed) -> float:
    """Return by how much the work of a turn strays from the closed cycle's over the next turns, as a share of it.

    0 where it is not asked: of machines without seats and stops, and where the cycle closed within `EASY` turns.
    """
    machinery, q = solution.machinery, closed.q
    composition = machinery.composition
    if not composition.stops or (closed.how == "histories" and closed.turns <= EASY):
        return 0.0
    R, kept, counts = machinery.R.copy(), machinery.kept.copy(), machinery.counts.copy()
    y, worst = closed.y.copy(), 0.0
    try:
        for _ in range(TURNS):
            status, _, _, turn = machinery.turn(y, solution.wanted.rtol, 1e-3)
            change = abs(float(turn[0] - q[0])) / max(abs(float(q[0])), solution.least(q)[1])
            worst = max(worst, change)
            if status != 0 or worst > STRAYED:
                break
    finally:
        machinery.R[:], machinery.kept[:], machinery.counts[:] = R, kept, counts
    return worst


def warnings(solution: Solution, closed: closing.Closed) -> tuple[str, ...]:
    """Return a warning where the machine does not stay on its cycle."""
    if closed.status != "ok" or strayed(solution, closed) <= STRAYED:
        return ()
    return (
        "the machine does not stay on this cycle: its own turns stray from it, and there may be others (lighter reeds, "
        "stiffer springs or a smaller restitution)",
    )
