"""One goal by one path: secant steps to a change of sign, then interpolation as in Brent's method; avoids failures."""

import itertools
import math
from collections.abc import Iterator

import numpy as np

from screwsim.study.seek.trials import Trial, Trials

MOST_SOLUTIONS = 40  # solutions of the walk, and of the narrowing
START_PLACES = (0.5, 0.25, 0.75, 0.1, 0.9, 0.0, 1.0)  # places to start from where the scene's own fails
WIDEST, LEAST = 0.35, 0.01  # longest and shortest step of the walk, in places
SCAN_PLACES = 7  # places over the whole range, where the walk ended without the goal
EXTREMUM_ACCURACY = 1e-3  # of the range: wanted accuracy of the edge of failures, or of the place nearest to a goal
JUMP_WIDTH = 1e-8  # width of a change of sign below which it is a jump ...
LEAST_JUMP = 1e-6  # ... if the figure changes there by more than this share of its size
FRACTIONS = (0.5, 0.25, 0.75, 0.125, 0.875)  # of a change of sign: places tried where a solution in it fails

Bracket = tuple[Trial, Trial]


def solve(trials: Trials) -> Trial | None:
    """Return the solution that meets the goal; None where there is none: `trials` then holds how near it came."""
    # start at the scene's own place, else at others until one has the figure
    if not any(trials.at(place).closed for place in (trials.spans[0].first, *START_PLACES)):
        return None
    _secant_walk(trials)
    best = trials.nearest
    if best is not None and trials.met(best):
        return best
    if nearest_bracket(trials) is None:
        _scan(trials)
    return _narrowed(trials)


def nearest_bracket(trials: Trials) -> Bracket | None:
    """Return the neighbours between which the figure passes its goal, those nearest to it; None without any."""
    row = sorted(trials.closed, key=lambda trial: trial.places)
    pairs = [pair for pair in itertools.pairwise(row) if pair[0].off[0] * pair[1].off[0] <= 0.0]
    return min(pairs, key=lambda pair: min(abs(each.off[0]) for each in pair), default=None)


def _secant_walk(trials: Trials) -> None:
    """Take secant steps until the figure passes its goal, or until an end of the range or a failure is met."""
    for _ in range(MOST_SOLUTIONS):
        best = trials.nearest
        if best is None or trials.met(best) or nearest_bracket(trials) is not None:
            return
        here = best.places[0]
        place = min(max(_secant_place(trials, best), 0.0), 1.0)
        for _ in range(4):  # back towards the last place by halves where a solution fails
            if (place,) in trials.known or trials.at(place).closed:
                break
            place = 0.5 * (place + here)
        new = trials.nearest
        # no nearer: the end of the range, or an extremum of the figure
        if new is best and nearest_bracket(trials) is None:
            return


def _secant_place(trials: Trials, best: Trial) -> float:
    """Return where a secant through the two best solutions meets the goal; at first, assuming proportionality."""
    here, off = best.places[0], best.off[0]
    others = sorted((each for each in trials.closed if each is not best), key=trials.far)
    if others:
        other = others[0]
        slope = (other.off[0] - off) / (other.places[0] - here)
        step = -off / slope if slope else math.copysign(WIDEST, 0.5 - here)
    else:
        span, goal = trials.spans[0], trials.goals[0]
        had, value = off + goal.value, span.value(here)
        wanted = value * goal.value / had if had * goal.value > 0.0 and value > 0.0 else value
        step = span.place(wanted) - here or math.copysign(0.1, 0.5 - here)
    return here + math.copysign(min(max(abs(step), LEAST if not others else 0.0), WIDEST), step)


def _scan(trials: Trials) -> None:
    """Scan the whole range; towards values that fail, or where the figure has an extremum, search more closely."""
    from scipy.optimize import minimize_scalar

    for place in np.linspace(0.0, 1.0, SCAN_PLACES):
        trials.at(float(place))
        if nearest_bracket(trials) is not None:
            return
    _to_the_edge(trials)
    if nearest_bracket(trials) is not None:
        return
    row = sorted(trials.closed, key=lambda trial: trial.places)
    number = min(range(len(row)), key=lambda i: abs(row[i].off[0]))
    if not 0 < number < len(row) - 1:
        return

    def off(place: float) -> float:
        if nearest_bracket(trials) is not None:  # a bracket is known
            return 0.0
        trial = trials.at(float(place))
        return abs(trial.off[0]) if trial.closed else max(abs(each.off[0]) for each in row)

    ends = row[number - 1].places[0], row[number + 1].places[0]
    minimize_scalar(off, bounds=ends, method="bounded", options={"xatol": EXTREMUM_ACCURACY})


def failing_beside(trials: Trials, best: Trial) -> list[Trial]:
    """Return the failed solutions that are the next ones below or above a closed one."""
    row = sorted(trials.known.values(), key=lambda trial: trial.places)
    number = row.index(best)
    return [each for each in row[max(number - 1, 0) : number + 2] if not each.closed]


def _to_the_edge(trials: Trials) -> None:
    """Halve the way from the nearest solution to those beside it that fail, until the figure passes its goal."""
    best = trials.nearest
    while best is not None and nearest_bracket(trials) is None:
        beside = [each.places[0] for each in failing_beside(trials, best)]
        wide = [place for place in beside if abs(place - best.places[0]) > EXTREMUM_ACCURACY]
        if not wide:
            return
        trials.at(0.5 * (wide[0] + best.places[0]))
        best = trials.nearest


def _narrowed(trials: Trials) -> Trial | None:
    """Return the solution at a change of sign; None without one, at a jump, or where all solutions within it fail."""
    narrowing = 0
    for _ in range(MOST_SOLUTIONS):
        best, ends = trials.nearest, nearest_bracket(trials)
        if best is not None and trials.met(best):
            return best
        if ends is None:
            return None
        width = ends[1].places[0] - ends[0].places[0]
        if width < JUMP_WIDTH:
            leap = abs(ends[1].off[0] - ends[0].off[0])
            return best if leap <= LEAST_JUMP * trials.sizes[0] else None
        for place in _places_within(trials, ends, narrowing > 2):
            if (place,) not in trials.known and trials.at(place).closed:
                break
        else:
            return None
        after = nearest_bracket(trials)
        left = width if after is None else after[1].places[0] - after[0].places[0]
        narrowing = narrowing + 1 if left > 0.5 * width else 0
    return None


def _places_within(trials: Trials, ends: Bracket, halve: bool) -> Iterator[float]:
    """Yield places within a change of sign: by inverse interpolation, else by the secant, then fractions of it."""
    low, high = ends[0].places[0], ends[1].places[0]
    if not halve:
        row = sorted(trials.closed, key=trials.far)[:3]
        guess = _inverse_interpolation([(each.off[0], each.places[0]) for each in row])
        if guess is None or not low < guess < high:
            a, b = ends[0].off[0], ends[1].off[0]
            guess = low - a * (high - low) / (b - a)
        margin = 1e-3 * (high - low)  # so that the other end moves, too
        yield min(max(guess, low + margin), high - margin)
    yield from (low + part * (high - low) for part in FRACTIONS)


def _inverse_interpolation(points: list[tuple[float, float]]) -> float | None:
    """Return the zero of the parabola of the places over the figure (off, place); None where there is none."""
    if len(points) < 3 or len({off for off, _ in points}) < 3:
        return None
    total = 0.0
    for off, place in points:
        others = [each for each, _ in points if each != off]
        total += place * math.prod(-other / (off - other) for other in others)
    return total
