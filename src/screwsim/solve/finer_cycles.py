"""Errors estimated by a cycle that is closed once more, finer: all chambers together, or the way that closed it.

Source: docs/model.md M41; docs/explanation/numerics.md, hard-cases.md.
"""

from dataclasses import replace

from screwsim.cycle.close import again
from screwsim.cycle.fallbacks import MOST_OF_A_TRY
from screwsim.cycle.search import SEARCH
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import evaluate
from screwsim.solve.finer import FINER, NOTHING, Asked, Finer


def chambers_together(asked: Asked) -> Finer:
    """Return all chambers closed together from a closed cycle, where lives among its own would repeat its error."""
    if not asked.hidden:
        return NOTHING
    problem, machinery, cycle = asked.problem, asked.machinery, asked.cycle
    wanted = replace(asked.wanted, rtol=FINER * cycle.rtol)
    finer = close_together(problem, machinery, wanted, chambers_at_pitches(machinery))
    if finer.closed:
        return Finer([evaluate(problem, finer).figures])
    machinery.put(cycle.trajectory)
    return NOTHING


def closed_again(asked: Asked) -> Finer:
    """Return the cycle that closes with finer steps from the closed one.

    A cycle that only a fallback closed draws its neighbourhood in slowly, or not at all: what the steps of one life are
    off by is far less than what the cycle is off by. It goes the way that closed it and may cost as much as a fallback.
    """
    problem, machinery, cycle = asked.problem, asked.machinery, asked.cycle
    wanted = replace(asked.wanted, rtol=FINER * cycle.rtol, tolerance=FINER * asked.wanted.tolerance)
    if cycle.needed:
        finer = again(problem, machinery, wanted, cycle)
    else:
        finer = way_of(cycle).finer(problem, machinery, wanted, cycle, MOST_OF_A_TRY)
    if finer is None or not finer.closed:
        return NOTHING
    return Finer([evaluate(problem, finer).figures], cycle=finer if finer.needed == SEARCH else None)
