"""Goal seek: the values of paths at which figures have their wanted values, and machines sized that way."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from screwsim.inputs.arguments import NUMBER, NUMBERS, TEXTS, as_list, checked_arguments
from screwsim.inputs.arguments import shown as shown_argument
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.scene import SceneLike, case_count, case_values, without_sweep
from screwsim.scene.units import gauge_pressures_over
from screwsim.study.asked.figures import figure_of
from screwsim.study.asked.goals import Goal, of_ambient, read_figure, read_goals
from screwsim.study.asked.inputs import over_other_axes, read_text, shown_value
from screwsim.study.asked.spans import Span, read_spans
from screwsim.study.asked.varied import Varied, case, with_text, with_values
from screwsim.study.pool.parallel import WarmSimulation, parallel_map
from screwsim.study.pool.progress import Progress, progress_of
from screwsim.study.pool.solving import Simulate, simulator
from screwsim.study.pool.workers import WORKER_DIED
from screwsim.study.seek import one_goal, several_goals
from screwsim.study.seek.answer import GoalSeekAnswer, answer_of_trials, next_size, read_catalogue
from screwsim.study.seek.by_inputs import uncertainties_by_inputs
from screwsim.study.seek.trials import ReportedSimulation, Trial, Trials
from screwsim.study.stages import scene_or_stages

__all__ = ["GoalSeekAnswer", "Question", "find", "find_each", "question"]

EXPECTED_SOLUTIONS = 10  # solutions per path that the progress expects
VALUE_DIGITS = 7  # of a found value: far below its error
VaryArgument = Iterable[str] | Mapping[str, tuple[float, float] | None]
GoalsArgument = Iterable[str] | Mapping[str, float | str]


@dataclass(frozen=True)
class Question:
    """The question: as many paths as goals, and for one path the sizes [SI] that a maker offers."""

    spans: tuple[Span, ...]
    goals: tuple[Goal, ...]
    sizes: tuple[float, ...] = ()


def question(
    scene: Varied, vary: VaryArgument, goals: GoalsArgument, catalogue: str | Sequence[float] = ()
) -> Question:
    """Return the question; raise UsageError, in one line, where it makes no sense.

    `vary` are texts 'PATH' or 'PATH=LOW..HIGH', or {path: (low, high) [SI], None for the range that the scene or the
    schema gives}; `goals` texts 'FIGURE=VALUE', or {figure: value [SI], or a text as '500 kW'}; `catalogue` a text or
    sizes [SI].
    """
    vary = vary if isinstance(vary, Mapping) else as_list(vary)
    wanted, catalogue = _goals(scene, goals), catalogue if isinstance(catalogue, str) else tuple(catalogue)
    if catalogue and len(vary) != 1:
        raise UsageError("--catalogue: applies to a single path (give one --vary with it)")
    path = next((str(each).partition("=")[0].strip() for each in vary), "")
    sizes = read_catalogue(scene, path, catalogue) if isinstance(catalogue, str) and catalogue else catalogue
    sizes = tuple(sorted(map(float, sizes)))
    spans = read_spans(scene, vary, ranged=False, sizes=sizes)
    count = counted(len(wanted), "goal")
    if len(spans) > len(wanted):
        more, remedy = f"{len(spans)} paths vary for {count}", "screwsim optimize finds the best solution"
        raise UsageError(f"--vary: {more} (vary as many as there are --for; {remedy}, --subject-to the goals)")
    if len(spans) < len(wanted):
        less, remedy = f"{count} for {len(spans)} varied paths", "screwsim calibrate fits more figures"
        raise UsageError(f"--for: {less} (vary as many paths as there are goals; {remedy})")
    return Question(spans, wanted, sizes)


def _goals(scene: Varied, goals: GoalsArgument) -> tuple[Goal, ...]:
    if not isinstance(goals, Mapping) or not goals:
        return read_goals(scene, as_list(goals) if goals else ())
    named = {figure_of(scene, name, "goal"): value for name, value in goals.items()}
    with gauge_pressures_over(of_ambient(scene)):
        return tuple(Goal(figure, _wanted(figure, value)) for figure, value in named.items())


def _wanted(figure: str, value: Any) -> float:
    """Return the value [SI] wanted of a figure: given as a number, or as a text as on the command line."""
    if isinstance(value, str):
        return read_figure(figure, value, f"goal {figure}")
    if not NUMBER.holds(value):
        raise UsageError(f"goal {figure}: {shown_argument(value)} is neither a number [SI] nor a text such as '500 kW'")
    return float(value)


@checked_arguments(vary=TEXTS, goals=TEXTS, catalogue=NUMBERS)
def find(
    scene: SceneLike,
    vary: VaryArgument,
    goals: GoalsArgument,
    *,
    catalogue: str | Sequence[float] = (),
    simulate: Simulate | None = None,
    progress: Progress | bool | None = None,
) -> GoalSeekAnswer:
    """Return the values of paths at which figures have the values wanted (a scene's sweep is left aside).

        found = screwsim.find("x.yaml", ["operation.speed"], ["cooling_capacity=500 kW"])
        found.values["operation.speed"], found.scene, found.result.performance

    The scene is what `load` returns, the path of a file (also of two stages), YAML text, or a dict laid out as the file
    is. Paths and goals are written as in `question`. If nothing within the ranges meets the goals, `status` is 'none'
    and `message` says how close the search came. `progress` counts solutions against the expected number: True shows a
    bar or a line on stderr, None a bar in a notebook, False nothing.
    """
    given = scene_or_stages(scene)
    asked = question(given, vary, goals, catalogue)
    alone = case(without_sweep(given), 0)
    simulate, expected = simulate or WarmSimulation(), EXPECTED_SOLUTIONS * len(asked.spans)
    with ReportedSimulation(simulate, progress_of("find", progress), expected) as told:
        return find_each(alone, asked, jobs=1, simulate=told)[0]


def find_each(
    scene: Varied,
    asked: Question,
    *,
    jobs: int | None,
    simulate: Simulate | None = None,
    progress: Progress | None = None,
) -> list[GoalSeekAnswer]:
    """Return the answer at each point of the scene's axes other than the varied paths (one point without axes)."""
    varied = {span.path: span.value(span.first) for span in asked.spans}
    rest = over_other_axes(scene, varied)
    count = case_count(rest)
    first = with_values(case(rest, 0), varied)
    if simulate is None and count > 1 and jobs != 1:
        simulator(first)  # compiled before the fork
    return parallel_map(
        partial(_answer_at_point, rest, asked, simulate),
        count,
        died=lambda number: GoalSeekAnswer(
            "failed", asked.spans, asked.goals, WORKER_DIED, case_values(rest, number), searched=case(rest, number)
        ),
        jobs=jobs,
        progress=progress,
    )


def _answer_at_point(rest: Varied, asked: Question, simulate: Simulate | None, number: int) -> GoalSeekAnswer:
    """Return the answer at one point of the other axes."""
    trials = Trials(case(rest, number), asked.spans, asked.goals, simulate or WarmSimulation())
    met = (one_goal if len(asked.spans) == 1 else several_goals).solve(trials)
    at: dict[str, Any] = case_values(rest, number)
    found = answer_of_trials(trials, met, at)
    if met is not None:
        values = rounded(trials.scene, found.values)
        found = replace(found, values=values, scene=with_text(with_values(trials.scene, values)))
        found = _with_uncertainties_by_inputs(found, [goal.figure for goal in asked.goals])
    return _with_catalogue_size(trials, found, met, asked) if asked.sizes and found.status != "failed" else found


def _with_uncertainties_by_inputs(found: GoalSeekAnswer, figures: Sequence[str]) -> GoalSeekAnswer:
    """Return an answer with the uncertainties of its values by the tolerances of other inputs."""
    assert found.scene is not None
    spreads, why = uncertainties_by_inputs(found.scene, found.result, found.values, figures)
    return replace(found, by_inputs=spreads, message="; ".join(filter(None, (found.message, why))))


def _with_catalogue_size(trials: Trials, found: GoalSeekAnswer, met: Trial | None, asked: Question) -> GoalSeekAnswer:
    """Return an answer with the next size of the catalogue."""
    size, path = next_size(trials, met, asked.sizes), asked.spans[0].path
    if size is None:
        largest = shown_value(trials.scene, path, asked.sizes[-1])
        why = "; ".join(filter(None, (f"no size in the catalogue, up to {largest}, meets the goal", found.message)))
        return replace(found, status="none", message=why, scene=None, **trials.counts)
    scene = with_text(with_values(trials.scene, {path: size.value}))
    message = "" if found.status == "none" else found.message
    return replace(found, status="ok", message=message, size=size, scene=scene, result=size.result, **trials.counts)


def rounded(scene: Varied, values: Mapping[str, float]) -> dict[str, float]:
    """Return values [SI] as they are written: with `VALUE_DIGITS` digits in the customary unit."""
    written = {path: shown_value(scene, path, value, VALUE_DIGITS) for path, value in values.items()}
    return {path: read_text(scene, path, text) for path, text in written.items()}
