"""Solutions of one search for goals: figures minus their goals over places 0 … 1, and what went wrong."""

from dataclasses import dataclass, field
from typing import Any, Self

from screwsim.figures import declared
from screwsim.outputs import Result
from screwsim.study.asked.goals import Bound, Goal
from screwsim.study.asked.spans import Span, refusal_beyond
from screwsim.study.asked.varied import Varied, with_values
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.solving import Simulate, absolute_error, simulated_if_valid

MET_TOLERANCE = 0.5  # of the estimated errors of the figures: distance within which a goal is met
GOAL_ROUNDING = 1e-9  # of a goal


@dataclass(frozen=True)
class Trial:
    """One solution: its places, each figure [SI] minus its goal, its estimated errors; without `off` it failed."""

    places: tuple[float, ...]
    off: tuple[float, ...] = ()
    errors: tuple[float, ...] = ()
    result: Result | None = None

    @property
    def closed(self) -> bool:
        return bool(self.off)


@dataclass
class Trials:
    """The goals of a search, and every solution so far; a place is solved once."""

    scene: Varied
    spans: tuple[Span, ...]
    goals: tuple[Goal, ...]
    simulate: Simulate
    tolerance: float = 0.0  # relative, of the goals: also met within it where it exceeds the errors
    reasons: list[str] = field(default_factory=list)  # of solutions that failed, did not close, or lack a figure
    known: dict[tuple[float, ...], Trial] = field(default_factory=dict)
    beyond: int = 0  # solutions beyond a range, to learn whether there are any

    def at(self, *places: float) -> Trial:
        """Return the solution at places, clipped to the spans."""
        places = tuple(min(max(float(place), 0.0), 1.0) for place in places)
        if places not in self.known:
            self.known[places] = self._solved(places)
        return self.known[places]

    def scene_at(self, places: tuple[float, ...]) -> Varied:
        """Return the scene at places."""
        return with_values(self.scene, self.values(places))

    def values(self, places: tuple[float, ...]) -> dict[str, float]:
        """Return the values [SI] at places."""
        return {span.path: span.value(place) for span, place in zip(self.spans, places, strict=True)}

    @property
    def counts(self) -> dict[str, Any]:
        """Number of all solutions, and of those that failed."""
        return {"solutions": len(self.known) + self.beyond, "failed": len(self.reasons)}

    def refusal_beyond(self, trial: Trial, span: Span, border: str) -> str:
        """Return why there is no solution beyond the border of a range at which a trial lies; '' where there is one."""

        def solved(value: float) -> Result:
            self.beyond += 1
            return simulated_if_valid(with_values(self.scene_at(trial.places), {span.path: value}), self.simulate)

        return refusal_beyond(self.scene, span, border, solved)

    def _solved(self, places: tuple[float, ...]) -> Trial:
        scene, names = self.scene_at(places), [goal.figure for goal in self.goals]
        result = simulated_if_valid(scene, self.simulate)
        if why := result.why_not(names):
            self.reasons.append(why)
            return Trial(places, result=result)
        off = tuple(float(result.performance[goal.figure]) - goal.value for goal in self.goals)
        return Trial(places, off, tuple(absolute_error(result, name, scene) for name in names), result)

    @property
    def closed(self) -> list[Trial]:
        """Return the solutions that have their figures."""
        return [trial for trial in self.known.values() if trial.closed]

    def met(self, trial: Trial) -> bool:
        """Return whether a solution meets its goals within their estimated errors, or the tolerance."""
        least = max(self.tolerance, GOAL_ROUNDING)
        return trial.closed and all(
            abs(off) <= max(MET_TOLERANCE * error, least * abs(goal.value))
            for off, error, goal in zip(trial.off, trial.errors, self.goals, strict=True)
        )

    def far(self, trial: Trial) -> float:
        """Return the distance of a solution from its goals: the sum of squares over the sizes of the goals."""
        if not trial.closed:
            return float("inf")
        return sum((off / size) ** 2 for off, size in zip(trial.off, self.sizes, strict=True))

    @property
    def sizes(self) -> tuple[float, ...]:
        """Scale of each figure's differences; ten kelvins for a temperature."""
        return tuple(size_of(goal) for goal in self.goals)

    @property
    def nearest(self) -> Trial | None:
        """Return the solution that is nearest to its goals."""
        return min(self.closed, key=self.far, default=None)


def size_of(goal: Goal | Bound) -> float:
    """Return the scale of differences from a goal or a bound [SI]: its size, for a temperature ten kelvins."""
    return 10.0 if declared(goal.figure).units == "K" else max(abs(goal.value), 1e-12)


class ReportedSimulation:
    """Simulation that reports progress; within `with` it expects `expected` solutions, then as many again."""

    def __init__(self, simulate: Simulate, progress: Progress, expected: int) -> None:
        self._simulate = simulate
        self._progress = progress
        self._expected = self._left = expected

    def __enter__(self) -> Self:
        self._progress.start(self._expected, 0)
        return self

    def __call__(self, scene: Varied) -> Result:
        result = self._simulate(scene)
        if not self._left:
            self._progress.more(self._expected)
            self._left = self._expected
        self._left -= 1
        self._progress.advance(1, int(result.status != "ok"))
        return result

    def __exit__(self, *error: object) -> None:
        self._progress.more(-self._left)
        self._progress.stop()
