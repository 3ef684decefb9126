"""The answer to a goal seek: values with errors, figures, how near a failed search came; the next size up."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from screwsim.figures.engineering import figure_text, shown_name
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.display import About, Brief
from screwsim.scene.units import NUMBER
from screwsim.study.asked.goals import Goal
from screwsim.study.asked.inputs import read_text, shown_range, shown_value, unit_behind
from screwsim.study.asked.spans import LOWER, UPPER, Span
from screwsim.study.asked.varied import Varied
from screwsim.study.seek import one_goal, several_goals
from screwsim.study.seek.trials import Trial, Trials
from screwsim.study.uncertainty.spreads import FigureUncertainty

SAME_SIZE = 1e-9  # relative difference below which a size equals the value
BOUND_DISTANCE = 1e-6  # of a range: distance from its end that counts as at the end
CLEAR_ERRORS = 4.0  # errors of a figure from which on two solutions determine its slope


@dataclass(frozen=True)
class Size:
    """A size of a catalogue that meets the goal, and the figure there [SI]."""

    value: float
    figure: float
    result: Result


@dataclass(frozen=True, repr=False)
class GoalSeekAnswer(Brief):
    """What was found at one point of the scene's other axes (`at`), all in SI units.

    `status` is ok; none: nothing in the ranges meets the goals, `values` and `figures` are those of the nearest
    solution; failed: no solution has the figures. `uncertainties` are those of the values due to the figures' estimated
    numerical `errors` (absolute), `by_inputs` those due to the tolerances of the scene's other inputs; `borders` names
    the end of a range at which a value lies.
    """

    status: str  # ok | none | failed
    spans: tuple[Span, ...]
    goals: tuple[Goal, ...]
    message: str = ""
    at: Mapping[str, Any] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)
    uncertainties: Mapping[str, float | None] = field(default_factory=dict)
    by_inputs: Mapping[str, FigureUncertainty] = field(default_factory=dict)
    figures: Mapping[str, float] = field(default_factory=dict)
    errors: Mapping[str, float] = field(default_factory=dict)
    borders: Mapping[str, str] = field(default_factory=dict)
    size: Size | None = None
    solutions: int = 0
    failed: int = 0
    scene: Varied | None = None  # with the values found; for a catalogue, with the size
    result: Result | None = None
    searched: Varied | None = None  # the scene at this point, before the values were set

    def _about(self) -> About:
        rows = [("at", path, self._shown(path, value)) for path, value in self.at.items()]
        rows += [("value", path, self._shown(path, value)) for path, value in self.values.items()]
        rows += [("figure", name, figure_text(name, value)) for name, value in self.figures.items()]
        asked = ", ".join(f"{goal.figure} = {figure_text(goal.figure, goal.value)}" for goal in self.goals)
        due = "uncertain by the tolerances of other inputs, too (.by_inputs)" if self.by_inputs else ""
        notes = [text for text in (self.message, due) if text]
        return About(f"Found: {self.status}, for {asked}", notes, ("", "name", "is"), rows)

    def _shown(self, path: str, value: Any) -> str:
        return str(value) if self.searched is None else shown_value(self.searched, path, value)


def answer_of_trials(trials: Trials, met: Trial | None, at: Mapping[str, Any]) -> GoalSeekAnswer:
    """Return the answer of a search."""
    head: dict[str, Any] = {"spans": trials.spans, "goals": trials.goals, "at": at, "searched": trials.scene}
    count = trials.counts["solutions"]
    told = f"{len(trials.reasons)} of {count} solutions: {trials.reasons[0]}" if trials.reasons else ""
    best = met or trials.nearest
    if best is None:
        return GoalSeekAnswer("failed", **head, message=told, **trials.counts)
    names = [goal.figure for goal in trials.goals]
    head |= {
        "values": trials.values(best.places),
        "figures": {goal.figure: off + goal.value for goal, off in zip(trials.goals, best.off, strict=True)},
        "errors": dict(zip(names, best.errors, strict=True)),
        "borders": _active_bounds(trials, best),
        "result": best.result,
    }
    if met is None:
        why = why_missed(trials, best)
        return GoalSeekAnswer("none", **head, message=f"{why}; {told}" if told else why, **trials.counts)
    return GoalSeekAnswer("ok", **head, uncertainties=uncertainties(trials, met), message=told, **trials.counts)


def _active_bounds(trials: Trials, trial: Trial) -> dict[str, str]:
    pairs = zip(trials.spans, trial.places, strict=True)
    ended = ((span.path, place) for span, place in pairs if min(place, 1.0 - place) <= BOUND_DISTANCE)
    return {path: UPPER if place > 0.5 else LOWER for path, place in ended}


def uncertainties(trials: Trials, met: Trial) -> dict[str, float | None]:
    """Return the errors of the values [SI] due to those of the figures, over their slopes, in the worst combination."""
    slopes = _slope(trials, met) if len(trials.spans) == 1 else several_goals.jacobian(trials, met)
    if slopes is None or np.linalg.cond(slopes) > 1e12:
        return {span.path: None for span in trials.spans}
    errors = np.array(met.errors) / np.array(trials.sizes)
    off = np.abs(np.linalg.inv(slopes)) @ errors
    rows = zip(trials.spans, met.places, off, strict=True)
    return {span.path: float(abs(span.slope(place)) * each) for span, place, each in rows}


def _slope(trials: Trials, met: Trial) -> np.ndarray | None:
    """Return the slope of the one figure, over its size, from the nearest solution that clearly differs."""
    (size,) = trials.sizes
    for other in sorted(trials.closed, key=lambda trial: abs(trial.places[0] - met.places[0])):
        rise, run = other.off[0] - met.off[0], other.places[0] - met.places[0]
        if run and abs(rise) > CLEAR_ERRORS * (met.errors[0] + other.errors[0]):
            return np.array([[rise / size / run]])
    return None


def why_missed(trials: Trials, best: Trial) -> str:
    """Return why nothing meets the goals, and how near the search came, in one line."""
    scene, goals = trials.scene, trials.goals
    wanted = " and ".join(f"{shown_name(goal.figure)} {figure_text(goal.figure, goal.value)}" for goal in goals)
    ranges = ", ".join(f"{span.path} {shown_range(scene, span.path, span.low, span.high)}" for span in trials.spans)
    why = _jump_in_words(trials) or _flat_in_words(trials)
    if why:
        return f"nothing within {ranges} gives {wanted}: {why}"
    came = ", ".join(figure_text(goal.figure, off + goal.value) for goal, off in zip(goals, best.off, strict=True))
    borders = _active_bounds(trials, best)
    at = {path: f", its {border}" for path, border in borders.items()}
    values = trials.values(best.places).items()
    where = ", ".join(f"{path} {shown_value(scene, path, value)}{at.get(path, '')}" for path, value in values)
    ended = [span for span in trials.spans if span.path in borders]
    refusals = [trials.refusal_beyond(best, span, borders[span.path]) for span in ended]
    end = " (change what else limits it)"
    if len(trials.spans) == 1 and one_goal.failing_beside(trials, best):
        end = ", next to values that fail (change what else limits it)"
    if refusals:
        end = f", and beyond there is no solution: {refusals[0]}" if all(refusals) else " (widen the range)"
    return f"nothing within {ranges} gives {wanted}: the nearest is {came}, at {where}{_other_sign(trials) or end}"


def _other_sign(trials: Trials) -> str:
    """Return that a goal above zero is one of a figure that is below zero throughout; empty where it is not."""
    for number, goal in enumerate(trials.goals):
        found = [trial.off[number] + goal.value for trial in trials.closed]
        if goal.value > 0.0 and max(found, default=0.0) < 0.0:
            text = figure_text(goal.figure, -goal.value)
            return f" ({shown_name(goal.figure)} is below zero throughout: write e.g. {goal.figure}={text})"
    return ""


def _jump_in_words(trials: Trials) -> str:
    """Return how one figure jumps over its goal; empty where it does not."""
    ends = one_goal.nearest_bracket(trials) if len(trials.spans) == 1 else None
    if ends is None:
        return ""
    (span,), (goal,) = trials.spans, trials.goals
    low, high = (shown_value(trials.scene, span.path, span.value(end.places[0]), 7) for end in ends)
    a, b = (figure_text(goal.figure, end.off[0] + goal.value) for end in ends)
    why = f", where solutions fail: {trials.reasons[-1]}" if trials.reasons else ""
    return f"it jumps from {a} at {low} to {b} at {high}{why}"


def _flat_in_words(trials: Trials) -> str:
    """Return the message that the one figure does not change; empty where it does."""
    if len(trials.spans) > 1 or not _is_flat(trials):
        return ""
    (goal,) = trials.goals
    value = min(trial.off[0] for trial in trials.closed) + goal.value
    return f"it is {figure_text(goal.figure, value)} throughout (vary something it depends on)"


def _is_flat(trials: Trials) -> bool:
    """Tell whether the one figure differs between no two solutions by more than their errors."""
    off = [trial.off[0] for trial in trials.closed]
    return len(off) > 1 and max(off) - min(off) <= CLEAR_ERRORS * max(trial.errors[0] for trial in trials.closed)


def read_catalogue(scene: Varied, path: str, text: str) -> tuple[float, ...]:
    """Return the sizes [SI] of '140, 163, 204 mm', ascending; a unit holds for all earlier numbers without one."""
    parts = [part.strip() for part in text.split(",")]
    unit = unit_behind(parts[-1])
    whole = [f"{part} {unit}" if re.fullmatch(NUMBER, part) and unit else part for part in parts]
    try:
        sizes = [read_text(scene, path, part) for part in whole if part]
    except UsageError as error:
        raise UsageError(f"--catalogue {text}: {error}") from None
    if len(set(sizes)) < 2:
        raise UsageError(f"--catalogue {text}: names {len(set(sizes))} size (write e.g. 140,163,204,255,321 mm)")
    return tuple(sorted(set(sizes)))


def next_size(trials: Trials, met: Trial | None, sizes: Iterable[float]) -> Size | None:
    """Return the smallest size, from the value found on, that is at the goal or beyond it; None where none is.

    Beyond is the side towards which the figure moves as the size grows; of a figure that does not move, no size is.
    Where no value meets the goal because every size is beyond it, that is the smallest size.
    """
    if met is None and _is_flat(trials):
        return None
    sizes = list(sizes)
    row = sorted(trials.closed, key=lambda trial: trial.places)
    ends = [trial.off[0] for trial in row]
    span, direction = trials.spans[0], 1.0 if len(ends) < 2 or ends[-1] >= ends[0] else -1.0
    least = sizes[0] if met is None else span.value(met.places[0])
    for size in (each for each in sizes if each >= least * (1.0 - SAME_SIZE)):
        trial = trials.at(span.place(size))
        if not trial.closed or trial.result is None:
            continue
        if direction * trial.off[0] >= 0.0 or trials.met(trial):
            return Size(size, trial.off[0] + trials.goals[0].value, trial.result)
    return None
