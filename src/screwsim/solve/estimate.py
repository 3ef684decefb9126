"""How accurate the figures of a closed cycle are.

Finer solutions beside it (`solve.finer`) show its errors by what they change in the figures: one more life from the
closed cycle with a finer tolerance and a narrower regularisation, or two, the first led by Newton's correction to where
all that follow would go; or the cycle closed again, finer (docs/model.md M41). Another estimate is a function as
`solve.finer.Estimate` says, an entry in `ESTIMATES`, and one in `numerics.estimates`.
"""

import math
from dataclasses import replace

from screwsim.cycle.solution import CycleSolution, Led, Wanted
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import flow_errors, relative_errors
from screwsim.model.exchange import station
from screwsim.model.run import Machinery
from screwsim.numerics.estimates import AGAIN, ERRORS, LIVES, TOGETHER
from screwsim.outputs import Figures
from screwsim.solve.finer import NARROWER, NOTHING, Asked, Estimate, Finer
from screwsim.solve.finer_lives import chambers_together, changes, closed_again, finer_lives, repeated
from screwsim.solve.left_open import left_open

WHOLE = 1.0 / (1.0 - NARROWER**0.5)  # the error over what that turn shows of it, where it is the regularisation's root
LEAKY = 0.5  # volumetric efficiency below which an error of histories lives on for so many turns
HIDDEN = 1.5  # that it is as many times what two of them show
EMPTY = 2.0  # the same of a machine that delivers nothing: what leaks is all there is
SLOWEST = 0.9  # the largest share of a life's change that the next one makes, that is believed
BY_CHANCE = 0.3  # of what the gas trapped errs by: what is delivered, a small part of it, errs by no less
ESTIMATES: dict[str, Estimate] = {TOGETHER: chambers_together, LIVES: finer_lives, AGAIN: closed_again}


def estimated_errors(
    of: Evaluation, machinery: Machinery, wanted: Wanted, cycle: CycleSolution
) -> tuple[Figures, Led | CycleSolution | None]:
    """Return the estimated relative error of every figure of a closed cycle, on which the machinery stands.

    And where it stands now, if that is where finer lives lead, or the finer cycle that a search closed.
    """
    found = of.figures
    station()
    narrower = replace(wanted, widths=tuple(NARROWER * width for width in wanted.widths))
    asked = Asked(of, machinery, narrower, cycle)
    finer = _finer(asked)
    if not finer.figures:
        return Figures(dict.fromkeys(found)), None
    station()
    errors = _shown(of, finer)
    c = of.problem.composition
    told = c.chambers == 1 or way_of(cycle).whole or finer.left is not None  # what comes back from other chambers
    among_leaks = not told and asked.filling < LEAKY  # chambers live on what leaks
    whole = WHOLE * ((HIDDEN if asked.filling > 0.0 else EMPTY) if among_leaks else 1.0)
    left = cycle.left if len(finer.figures) == 1 else 0.0  # more than one life shows it
    for name, size in errors.items():
        errors[name] = whole * size + left if size is not None else None
    lost_flow = {"by_flow": whole * finer.flow} if finer.flow else {}
    if asked.hidden and asked.filling > 0.0:
        lost_flow["by_flow"] = BY_CHANCE * (errors.get("trapped_mass") or 0.0) / asked.filling
    lost_now = [flow_errors(found, lost, by) for by, lost in lost_flow.items()]
    for each in (*lost_now, *left_open(of, cycle)):
        for name, size in each.items():
            errors[name] = (errors[name] or 0.0) + (size or 0.0)
    of_curves(found, errors)
    return errors, finer.led or finer.cycle


def of_curves(found: Figures, errors: Figures) -> None:
    """Let what lies between two angles of a curve err by no less than its amplitudes' errors make of it.

    Two curves may agree at two angles by chance. An amplitude's error is one of two parts of a harmonic's, the other is
    that of its phase: at two angles, of any phases, they differ by the root of twice the sum of the squares.
    """
    for name, about in found.about.items():
        if about.curve and errors.get(name) is not None:
            of_curve = math.sqrt(2.0 * sum((errors[each] or 0.0) ** 2 for each in about.curve))
            errors[name] = max(errors[name] or 0.0, of_curve)


def _finer(asked: Asked) -> Finer:
    """Return finer solutions beside a closed cycle by the first estimate that finds enough, else what the last found.

    Where none does the cycle is not one to go on from.
    """
    found = NOTHING
    for name in ERRORS[asked.problem.scene.numerics.error].by:
        finer = ESTIMATES[name](asked)
        if finer.enough:
            return finer
        found = finer if finer.figures else found
    return found._replace(led=None)


def _shown(of: Evaluation, finer: Finer) -> Figures:
    """Return what finer solutions show of the error of each figure: the most they change, and what later ones would.

    Two lives may agree with the closed one by chance where each goes another way. The last life's change is followed by
    others, each as much smaller as that one was than the life's before it. A corrected life is where all would lead,
    but for what its correction left; what lies before it is on the way there.
    """
    found, least, lives, left = of.figures, of.least, finer.figures, finer.left
    errors = relative_errors(found, lives[-1], *least)
    for each in lives[:-1] if left is None else ():
        for name, size in relative_errors(found, each, *least).items():
            if size is not None and errors[name] is not None:
                errors[name] = max(errors[name], size)
    if len(lives) > 1:
        steps = changes(of, lives)
        again = min(repeated(steps) if left is None else left, SLOWEST)
        for name, size in steps[-1].items():
            if size is not None and errors[name] is not None:
                errors[name] += size * again / (1.0 - again)
    return errors
