"""Best value of one path for each point of the scene's other axes: searched for, not read off a grid."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene, case_count, case_values
from screwsim.study.asked.figures import figure_of
from screwsim.study.asked.inputs import (
    check_continuous,
    ends_of,
    over_other_axes,
    read_text,
    shown_range,
    usual_efficiency,
)
from screwsim.study.asked.spans import LOWER, UPPER, Span, refusal_beyond
from screwsim.study.asked.varied import Varied, accuracy_of, case, with_accuracy, with_values
from screwsim.study.best.search import COARSE_POINTS, Maximum, SearchPoint, find_maximum
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.solving import Simulate, absolute_error, simulated_if_valid, simulator
from screwsim.study.pool.workers import WORKER_DIED

OIL_RATIO, OIL_RANGE = "oil_supply.ratio", (0.1, 10.0)  # range where nothing states one
FROM, TO = "--from", "--to"
INSENSITIVE_SHARE = 0.9  # of the range: where the figure is the same over more than this, the path hardly affects it
CERTAIN = 0.01  # of the range: wanted certainty of the place, each way
NEAR = 2e-4  # of the range: distance from its end that counts as at the end
TIGHTER, TIGHTEST = 0.1, 1e-6  # of numerics.accuracy, and least accuracy, where errors leave the place less certain


@dataclass(frozen=True, kw_only=True)
class Question(Span):
    """The question: the best `figure` over a path between two values [SI].

    `ends` are the words by which the command is told the ends of the range.
    """

    figure: str
    minimum: bool = False
    ends: tuple[str, str] = (FROM, TO)


@dataclass(frozen=True)
class Best:
    """Best value at one point of the other axes; all in SI units.

    `place` is inside, or the border of the range at which the best value lies: a better one may lie beyond it;
    'anywhere' where the path hardly affects the figure. Between `low` and `high` the figure is within its estimated
    `error` (absolute) of the best. `accuracy` is the one asked of the last solutions, `failed` the number of
    `solutions` that failed or did not close; `warnings` are those of the best solution. `beyond` says why there is no
    solution next to the best value, where it lies at the edge of those that can be solved.
    """

    values: Mapping[str, Any]
    status: str  # ok | failed
    message: str = ""
    place: str | None = None  # inside | lower border | upper border | anywhere
    value: float | None = None
    figure: float | None = None
    error: float | None = None
    low: float | None = None
    high: float | None = None
    others: tuple[tuple[float, float], ...] = ()  # (value, figure) of further local optima
    accuracy: float | None = None
    solutions: int = 0
    failed: int = 0
    warnings: tuple[str, ...] = ()
    beyond: str = ""
    beside: Mapping[str, float | None] = field(default_factory=dict)  # of two stages: figures of the best solution


def question(
    scene: Varied,
    path: str = OIL_RATIO,
    figure: str | None = None,
    *,
    minimum: bool = False,
    first: str | None = None,
    last: str | None = None,
) -> Question:
    """Return the question, with the range as given, else that of the scene's axis, else the usual one of the oil ratio.

    The range may follow the path: `oil_supply.ratio=0.5..4`. The default figure is `usual_efficiency`.
    """
    words = ("LOW", "HIGH") if "=" in path else (FROM, TO)
    path, first, last = _with_range(path, first, last)
    if path == OIL_RATIO and not isinstance(scene, Scene):
        example = "--path 'second.operation.speed=1000 rpm..2000 rpm'"
        raise UsageError(f"--path {path}: is in both stages (write that of one, e.g. {example})")
    if path == OIL_RATIO and isinstance(scene, Scene) and not scene.oil_supply:
        other = "--path 'operation.speed=1000 rpm..3000 rpm'"
        raise UsageError(f"{path}: the scene has no oil supply (vary another path, e.g. {other})")
    if path == OIL_RATIO and isinstance(scene, Scene) and scene.oil_supply and not scene.oil_supply.pumped:
        other = "--path 'oil_supply.orifice_diameter=2 mm..10 mm'"
        raise UsageError(f"{path}: follows from the orifice of displaced oil (vary another path, e.g. {other})")
    figure = figure_of(scene, usual_efficiency(scene) if figure is None else figure)
    check_continuous(scene, path)
    axis = scene.sweep.get(path, OIL_RANGE if path == OIL_RATIO else ())
    if len(axis) < 2 and (first is None or last is None):
        raise UsageError(f"{path}: has no range (write {path}=LOW..HIGH, or an axis of it under sweep:)")
    texts = ((first, min), (last, max))
    ends = [choose(axis) if text is None else read_text(scene, path, text) for text, choose in texts]
    if not ends[0] < ends[1]:
        lower = f"{words[0]} must be below {words[1]}"
        raise UsageError(f"{path}: the range {shown_range(scene, path, *ends)} is empty ({lower})")
    return Question(path, *ends, figure=figure, minimum=minimum, ends=words)


def _with_range(text: str, first: str | None, last: str | None) -> tuple[str, str | None, str | None]:
    """Return a path, and the ends of its range as they follow it (PATH=LOW..HIGH) or are given on their own."""
    path, equals, ends = (part.strip() for part in text.partition("="))
    if not equals:
        return path, first, last
    both = ends_of(ends)
    if both is None:
        raise UsageError(f"{text}: is not PATH=LOW..HIGH (write e.g. 'oil_supply.ratio=0.5..4')")
    if first is not None or last is not None:
        raise UsageError(f"{text}: states its range (remove {FROM} and {TO})")
    return path, *both


def optimum(
    scene: Varied,
    asked: Question,
    *,
    jobs: int | None = None,
    simulate: Simulate | None = None,
    progress: Progress | None = None,
) -> list[Best]:
    """Return the best value for each point of the scene's axes other than the path (one point without axes)."""
    middle = {asked.path: asked.value(0.5)}
    rest = over_other_axes(scene, middle)
    count = case_count(rest)
    simulate = simulate or simulator(with_values(case(rest, 0), middle) if count > 1 else None)
    return parallel_map(
        partial(_best, rest, asked, simulate),
        count,
        died=lambda number: Best(case_values(rest, number), "failed", WORKER_DIED),
        jobs=jobs,
        progress=progress,
    )


def _best(rest: Varied, asked: Question, simulate: Simulate, number: int) -> Best:
    """Return the best value at one point of the other axes; solved more accurately where errors leave it uncertain."""
    trials = _Trials(case(rest, number), asked, simulate)
    top = find_maximum(trials.point, 0.0, 1.0)
    while top is not None and max(top.high - top.point.x, top.point.x - top.low) > CERTAIN and trials.tighten():
        margin = 0.25 * (top.bracket[1] - top.bracket[0])
        bracket = max(top.bracket[0] - margin, 0.0), min(top.bracket[1] + margin, 1.0)
        finer = find_maximum(trials.point, *bracket, count=1 + COARSE_POINTS // 2)
        if finer is None:
            break
        # the earlier end of the equally good interval where the finer bracket does not contain one
        low = top.low if finer.low <= bracket[0] else finer.low
        top = replace(finer, others=top.others, low=low, high=top.high if finer.high >= bracket[1] else finer.high)
    return _best_of_trials(case_values(rest, number), asked, trials, top)


@dataclass
class _Trials:
    """Solutions of one search by their places, of several there the last, and why others failed."""

    scene: Varied
    asked: Question
    simulate: Simulate
    count: int = 0
    known: dict[float, Result] = field(default_factory=dict)
    reasons: dict[float, str] = field(default_factory=dict)  # why solutions failed or did not close

    def solved(self, value: float) -> Result:
        """Return the result at a value [SI]."""
        self.count += 1
        return simulated_if_valid(with_values(self.scene, {self.asked.path: value}), self.simulate)

    def point(self, x: float) -> SearchPoint:
        """Return the figure at a place, negated for a minimum; NaN without a closed solution."""
        name = self.asked.figure
        result = self.solved(self.asked.value(x))
        if result.status != "ok":
            self.reasons[x] = result.told
            return SearchPoint(x, math.nan)
        self.known[x] = result
        value = result.performance.get(name)
        if value is None:
            return SearchPoint(x, math.nan)
        self.reasons.pop(x, None)  # less accurately it had failed
        return SearchPoint(x, -value if self.asked.minimum else value, absolute_error(result, name, self.scene))

    def beside(self, x: float, within: float) -> str:
        """Return why the nearest solution within a distance of a place failed; '' where none did."""
        near = [(abs(at - x), reason) for at, reason in self.reasons.items() if abs(at - x) <= within]
        return min(near)[1] if near else ""

    def tighten(self) -> bool:
        """Make all further solutions more accurate; return False when that is not possible."""
        accuracy = accuracy_of(self.scene)
        finer = None if accuracy <= TIGHTEST else with_accuracy(self.scene, max(TIGHTER * accuracy, TIGHTEST))
        self.scene = finer or self.scene
        return finer is not None


def _best_of_trials(values: Mapping[str, Any], asked: Question, trials: _Trials, top: Maximum | None) -> Best:
    reasons = list(trials.reasons.values())
    counts = {"solutions": trials.count, "failed": len(reasons), "accuracy": accuracy_of(trials.scene)}
    some = f"{len(reasons)} of {trials.count} solutions: {reasons[0]}" if reasons else ""
    if top is None:
        lacks = [why for result in trials.known.values() for why in result.lacks([asked.figure])]
        missing = f"{lacks[0]} (choose another --figure)" if lacks else ""
        return Best(values, "failed", some or missing, **counts)
    sign = -1.0 if asked.minimum else 1.0
    place = LOWER if top.point.x < NEAR else UPPER if top.point.x > 1.0 - NEAR else "inside"
    beyond = ""
    if top.high - top.low > INSENSITIVE_SHARE:  # the best place is one by chance
        place = "anywhere"
    elif place == "inside":
        beyond = trials.beside(top.point.x, NEAR)
    else:
        beyond = refusal_beyond(trials.scene, asked, place, trials.solved)
        counts["solutions"] = trials.count
    best, scene = trials.known[top.point.x], trials.scene
    names = () if isinstance(scene, Scene) else (each for each in scene.beside if each != asked.figure)
    return Best(
        values,
        "ok",
        some,
        place,
        asked.value(top.point.x),
        sign * top.point.y,
        top.point.error,
        asked.value(top.low),
        asked.value(top.high),
        tuple((asked.value(point.x), sign * point.y) for point in top.others),
        **counts,
        beyond=beyond,
        warnings=best.warnings,
        beside={each: best.performance.get(each) for each in names},
    )
