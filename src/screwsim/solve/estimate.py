"""Estimate the errors of the figures of a closed cycle (docs/model.md M41).

The errors follow from the changes of the figures in finer solutions (`solve.estimate_protocol`): one more life after
the closed cycle, with a finer tolerance and a narrower regularisation; two lives, the first moved by Newton's
correction to the limit of all that follow; or the cycle closed again, finer. A further estimate is a function as
`solve.estimate_protocol.Estimate` says, an entry in `ESTIMATES`, and one in `numerics.settings`. Errors due to open
balances of a closed life are added (`solve.open_balances`).
Source: docs/explanation/errors.md.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

from screwsim.cycle.linear_pitch import Tangents
from screwsim.cycle.solution import ClosingCriteria, CorrectedState, CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import flow_errors, relative_errors
from screwsim.model.run import Machinery
from screwsim.model.trajectory import Trajectory
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics.settings import AGAIN, CHAMBERS, ERRORS, LIVES
from screwsim.outputs import Figures
from screwsim.solve.estimate_protocol import (
    BARELY_DELIVERS,
    NARROWER,
    NO_SOLUTIONS,
    Estimate,
    EstimateRequest,
    FinerSolutions,
)
from screwsim.solve.finer_solutions import (
    LEAST_DELIVERY,
    chambers_together,
    closed_again,
    finer_lives,
    repeated_share,
)
from screwsim.solve.misread_intake import misread_by_all, misread_intake, misread_intake_errors
from screwsim.solve.missed_neighbours import missed_neighbour_errors
from screwsim.solve.open_balances import later_warming_errors, open_balance_errors
from screwsim.solve.sums_met_twice import sums_met_twice
from screwsim.solve.swings import Solution, solution_of, swing_errors

WHOLE = 1.0 / (1.0 - NARROWER**0.5)  # error over the change, where the error is the regularisation's, going as ε^½
LEAKY_BELOW = 0.5  # volumetric efficiency below which an error of waveform relaxation persists for many turns
LEAKY_FACTOR = 1.5  # factor by which it then exceeds what two turns show
NO_DELIVERY_FACTOR = 2.0  # the same for a machine that delivers nothing: its chambers hold only leaks
LARGEST_RATIO = 0.9  # largest ratio of successive lives' changes that is extrapolated
LEAST_DELIVERY_ERROR = 0.3  # of the trapped gas's error: least error of a small delivered amount
ESTIMATES: dict[str, Estimate] = {CHAMBERS: chambers_together, LIVES: finer_lives, AGAIN: closed_again}


class EstimatedErrors(NamedTuple):
    """The estimated relative error of every figure of a closed cycle.

    `on` is where finer lives have led, if the machinery now stands there, or the finer cycle that a search closed;
    otherwise None. `tangents` is the linearisation by which lives were moved to their limit (None: none was).
    """

    errors: Figures
    on: CorrectedState | CycleSolution | None = None
    tangents: Tangents | None = None


def estimated_errors(
    of: Evaluation,
    machinery: Machinery,
    criteria: ClosingCriteria,
    cycle: CycleSolution,
    lent: Tangents | None = None,
) -> EstimatedErrors:
    """Return the estimated errors of a closed cycle, which the machinery holds.

    `lent` is the linearisation that the estimate of a nearby cycle used.
    """
    here = solution_of(of)
    found = here.figures
    reach_station()
    narrower = replace(criteria, widths=tuple(NARROWER * width for width in criteria.widths))
    request = EstimateRequest(of, machinery, narrower, cycle, lent)
    finer = _finer_solutions(request)
    if not finer.solutions:
        return EstimatedErrors(Figures(dict.fromkeys(found)))
    reach_station()
    finer_life, whole = machinery.trajectory, _whole_over_shown(request, finer)
    errors = _errors_shown(of, here, finer, hides_flow=request.filling < LEAST_DELIVERY)
    left = cycle.left if len(finer.solutions) == 1 else finer.to_come  # a second life shows what the cycle left
    flows = {name for name, about in found.about.items() if about.by_flow}  # of which a corrected life shows nothing
    for name, size in errors.items():
        if size is not None:
            errors[name] = whole * size + (left if size > 0.0 or name in flows else 0.0)
    unpaced = cycle.contraction >= 1.0 and len(finer.solutions) == 1
    further = [
        *_lost_flow(request, finer, errors, whole),
        *open_balance_errors(of, cycle),
        *([later_warming_errors(of, cycle)] if unpaced else []),
        *_misread(request, finer_life, finer, errors),
    ]
    for each in further:
        for name, size in each.items():
            errors[name] = (errors[name] or 0.0) + (size or 0.0)
    of_squares(found, errors)
    return EstimatedErrors(errors, finer.corrected_state or finer.cycle, finer.tangents)


def _whole_over_shown(request: EstimateRequest, finer: FinerSolutions) -> float:
    """Return the factor from the change to finer solutions to the error that the closed cycle has.

    Where leaks dominate, errors of waveform relaxation pass from turn to turn: simultaneous closing, or a correction,
    shows that feedback through other chambers.
    """
    chambers = request.problem.composition.chambers
    told = chambers == 1 or way_of(request.cycle).whole or finer.left is not None
    if told or request.filling >= LEAKY_BELOW:
        return WHOLE
    return WHOLE * (LEAKY_FACTOR if request.filling > 0.0 else NO_DELIVERY_FACTOR)


def _lost_flow(request: EstimateRequest, finer: FinerSolutions, shown: Figures, whole: float) -> Iterator[Figures]:
    """Yield the errors of what goes with the net flow, of which lives that finer solutions leave out show nothing."""
    lost = whole * finer.flow if finer.flow else None
    if request.hidden and request.filling > 0.0:
        lost = LEAST_DELIVERY_ERROR * (shown.get("trapped_mass") or 0.0) / request.filling
    if _closed_on_noise(request):
        lost = max(lost or 0.0, request.cycle.change / abs(request.filling))
    if lost is not None:
        yield flow_errors(request.of.figures, lost)


def _misread(request: EstimateRequest, life: Trajectory, finer: FinerSolutions, known: Figures) -> Iterator[Figures]:
    """Yield the errors that finer solutions have as well, of which the last one's life is given.

    Errors that are `known` are those that they show. Where little is delivered, what flows back and in again replaces
    the gas of a chamber many times, and what steps misread of it does not last.
    """
    delivers = request.filling > LEAST_DELIVERY
    of, problem = request.of, request.problem
    if not problem.composition.offsets or request.hidden:
        return
    if finer.q is not None:
        yield from misread_intake_errors(of, misread_by_all(problem, life, finer.q)) if delivers else ()
    elif not way_of(request.cycle).whole:  # the finer life met others at its own steps
        met = sums_met_twice(problem, life)
        yield missed_neighbour_errors(of, life, met, known)
        yield from misread_intake_errors(of, misread_intake(problem, life, met)) if delivers else ()


def _closed_on_noise(request: EstimateRequest) -> bool:
    """Return whether pitches of a machine that barely delivers still changed by more than asked when they stalled.

    What they change of the gas in the chambers is much of the little that is delivered, in finer pitches as well.
    """
    barely = way_of(request.cycle).whole and 0.0 < abs(request.filling) < BARELY_DELIVERS
    return barely and request.cycle.change > request.criteria.tolerance


def of_squares(found: Figures, errors: Figures) -> None:
    """Raise the errors of figures that go with the square of swings to twice the largest error of these."""
    for name, about in found.about.items():
        if about.curve and errors.get(name) is not None:
            errors[name] = max(errors[name] or 0.0, *(2.0 * (errors[each] or 0.0) for each in about.curve))


def _finer_solutions(request: EstimateRequest) -> FinerSolutions:
    """Return the finer solutions of the first estimate that suffices, else of the last that found any.

    In the latter case they are not a place to continue from.
    """
    found = NO_SOLUTIONS
    for name in ERRORS[request.problem.scene.numerics.error].by:
        finer = ESTIMATES[name](request)
        if not finer.changes:
            finer = finer._replace(changes=_changes(request.of, finer.solutions))
        if finer.enough:
            return finer
        found = finer if finer.solutions else found
    return found._replace(corrected_state=None)


def _changes(of: Evaluation, finer: Sequence[Solution]) -> list[Figures]:
    """Return the relative changes of the figures to each solution from the one before, first the closed cycle."""
    figures = [of.figures, *(each.figures for each in finer)]
    return [relative_errors(old, new, *of.least) for old, new in pairwise(figures)]


def _errors_shown(of: Evaluation, here: Solution, finer: FinerSolutions, hides_flow: bool) -> Figures:
    """Return the error of each figure as finer solutions show it.

    It is the change to the last life, and what later lives would add: a geometric series with the ratio of the last two
    changes. The change to any earlier life counts, too, since two lives may agree by chance; but not where the last one
    is corrected and so at the limit of all lives (up to what its correction left), which earlier ones only approach.
    Where leaks hide the net flow (`hides_flow`), that flow is a small difference which scatters from life to life: for
    it, and all figures that go with it, the largest change counts even then.
    """
    lives, left, steps = finer.solutions, finer.left, finer.changes
    first = _with_swings(steps[0], here, lives[0])
    errors = first if len(lives) == 1 else _distances(of, here, lives[-1])
    with_flow = {name for name, about in of.figures.about.items() if hides_flow and about.by_flow}
    for each in lives[:-1] if left is None or hides_flow else ():
        for name, size in (first if each is lives[0] else _distances(of, here, each)).items():
            if (left is None or name in with_flow) and size is not None and errors[name] is not None:
                errors[name] = max(errors[name], size)
    if len(lives) > 1:
        again = min(repeated_share(steps) if left is None else left, LARGEST_RATIO)
        for name, size in _with_swings(steps[-1], *lives[-2:]).items():
            if size is not None and errors[name] is not None:
                errors[name] += size * again / (1.0 - again)
    return errors


def _distances(of: Evaluation, found: Solution, better: Solution) -> Figures:
    """Return the relative errors of the figures beside better ones; those of swings are no less than their curves'."""
    return _with_swings(relative_errors(found.figures, better.figures, *of.least), found, better)


def _with_swings(apart: Figures, found: Solution, better: Solution) -> Figures:
    """Return how far the figures of two solutions are apart, those of swings no less than their curves."""
    sizes = Figures(apart)
    for name, size in swing_errors(*found, better.curves).items():
        if sizes.get(name) is not None:
            sizes[name] = max(sizes[name], size)
    return sizes
