"""Cycles closed tightly with the regularisation of their scene: what derivatives are held against."""

from dataclasses import replace

from screwsim.cycle.close import close
from screwsim.cycle.feedback import set_lines, set_unknowns, unknowns
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.evaluate.evaluation import Evaluation

RTOL, TOLERANCE = 1e-8, 1e-10  # of a step, of a change: differences over 1e-4 are good to 1e-5
BOUND = 1e-4  # on the balances, which such steps keep anyway


def closed_tightly(problem, machinery, begun=None, rtol=RTOL, tolerance=TOLERANCE):
    """Return the evaluation of a problem's cycle, of coupled chambers, begun from a life near by where one is given."""
    wanted = replace(problem.wanted, rtol=rtol, tolerance=tolerance, bound=BOUND, closing="coupled")
    machinery.begin(problem.composition)
    if begun is None:
        close(problem, machinery, problem.wanted)
    else:
        numbers = machinery.composition.P.copy()
        machinery.put(begun)
        met = unknowns(problem, machinery)
        machinery.composition.P[:] = numbers
        set_lines(problem, machinery, float(begun.ends[0][0]), 0.0)
        set_unknowns(problem, machinery, met)
    cycle = close_together(problem, machinery, wanted, chambers_at_pitches(machinery))
    assert cycle.status == "ok"
    return Evaluation(problem, cycle.trajectory, cycle.q)
