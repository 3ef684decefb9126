"""Parts common to all sheets over two quantities: points over both, the envelope, part load by each control.

The axes are evaporating temperature and condenser for refrigeration machines, both pressures for gas compressors, speed
and outlet for expanders.
"""

import itertools
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Generic, NamedTuple, TypeVar

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene, cross_check, with_values, without_sweep
from screwsim.scene.grid import Swept
from screwsim.scene.lines import lines
from screwsim.scene.operation import CONDENSING, EVAPORATING, GAS_COOLER_P, P_D, P_S, SPEED
from screwsim.scene.units import NUMBER
from screwsim.simulate import simulate_many
from screwsim.study.asked.inputs import ends_of, read_text, refuse_empty_range, shown_value, unit_behind
from screwsim.study.datasheet.bounds import EnvelopeRange, Limit, envelope, motor_of
from screwsim.study.datasheet.units import METRIC, Units
from screwsim.study.part_load import GAS, LOADS, REFRIGERATION, Control, LoadFigures, PartLoad, part_load
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED

DEAD = Result("failed", message=WORKER_DIED)
LEAST_LIFT = 10.0  # [K]
LEAST_RATIO = 1.2  # of pressures, below which no point is computed
OPTIONS = {
    EVAPORATING: "--evaporating",
    CONDENSING: "--condensing",
    GAS_COOLER_P: "--condensing",
    P_S: "--suction",
    P_D: "--discharge",
}
SIDES = {
    EVAPORATING: "evaporating",
    CONDENSING: "condensing",
    GAS_COOLER_P: "gas cooler",
    P_S: "suction",
    P_D: "discharge",
}
EXPANDER_SIDES = SIDES | {P_S: "inlet", P_D: "outlet", SPEED: "speed"}


class Axis(NamedTuple):
    """An axis of the table: its path and values [SI], ascending."""

    path: str
    values: tuple[float, ...]

    @property
    def kind(self) -> str:
        """Temperature, or else pressure."""
        return "temperature" if self.path.endswith("temperature") else "pressure"


@dataclass(frozen=True, kw_only=True)
class RatingRequest(ABC):
    """What is rated: scenes without a sweep, the axes across and down their tables, limits, controls.

    `scenes` are that of a machine, or those of both stages; `bounds` are the limits and where each is stated; `ratios`
    the built-in volume ratios from which the best is found at each part load.
    """

    scenes: tuple[Scene, ...]
    across: Axis
    down: Axis
    bounds: Mapping[Limit, str]
    controls: Sequence[Control]
    ratios: Sequence[float] = ()
    aim: LoadFigures = REFRIGERATION
    units: Units = METRIC

    @property
    def sides(self) -> tuple[str, str]:
        """The meaning of the axes across and down, in a word each."""
        words = EXPANDER_SIDES if self.scenes[0].machine.expands else SIDES
        return words[self.across.path], words[self.down.path]

    @property
    def axes_in_words(self) -> tuple[str, str]:
        """The meaning of both axes, in words."""
        across, down = (
            side if axis.path == SPEED else f"{side} {axis.kind}"
            for axis, side in zip((self.across, self.down), self.sides, strict=True)
        )
        return across, down

    @property
    def has_motors(self) -> bool:
        """Whether every scene names a motor."""
        return all(motor_of(scene) is not None for scene in self.scenes)

    @property
    def inverts(self) -> bool:
        """Whether the losses of all inverters are included at other speeds."""
        return all(motor is not None and motor.inverts for motor in map(motor_of, self.scenes))

    @property
    def by_lift(self) -> bool:
        """Whether both axes are temperatures of saturation, between which a refrigeration machine works."""
        return self.aim != GAS and (self.across.path, self.down.path) == (EVAPORATING, CONDENSING)

    def is_small(self, across: float, down: float) -> bool:
        """Return whether the axes alone show too small a lift or pressure ratio, which a scene may not allow."""
        if self.by_lift:
            return down - across < LEAST_LIFT
        if (self.across.path, self.down.path) != (P_S, P_D):
            return False
        return (across / down if self.scenes[0].machine.expands else down / across) < LEAST_RATIO

    @abstractmethod
    def shown(self, path: str, value: float, digits: int = 5) -> str:
        """Return a setting [SI] of a control in words."""

    @abstractmethod
    def column(self, across: float) -> list[Result | None]:
        """Return the results at a value across the table; None where no point is computed."""

    @abstractmethod
    def part_load(self, control: Control, full: float) -> PartLoad:
        """Return the results of a control; `full` is the capacity [SI] of load 1."""


@dataclass(frozen=True, kw_only=True)
class SceneRequest(RatingRequest):
    """What is rated of one machine."""

    @property
    def scene(self) -> Scene:
        """The machine's scene."""
        return self.scenes[0]

    def shown(self, path: str, value: float, digits: int = 5) -> str:
        """Return a setting [SI] of a control in words."""
        return shown_value(self.scene, path, value, digits)

    def column(self, across: float) -> list[Result | None]:
        """Return the results at a value across the table; None where no point is computed."""
        cases = [case_scene(self, across, down) for down in self.down.values]
        solved = simulate_many([case for case in cases if isinstance(case, Scene)], trace=False)
        return [next(solved) if isinstance(case, Scene) else case for case in cases]

    def part_load(self, control: Control, full: float) -> PartLoad:
        """Return the results of a control; `full` is the capacity [SI] of load 1."""
        return part_load(self.scene, control, full, LOADS, self.ratios, self.aim)


Request = TypeVar("Request", bound=RatingRequest, covariant=True)


@dataclass(frozen=True)
class Rating(Generic[Request]):
    """Results: at the scenes' own point, by the indices on both axes, of each control; and the envelope."""

    asked: Request
    own: Result
    points: Mapping[tuple[int, int], Result]
    loads: Sequence[PartLoad]
    reach: Sequence[EnvelopeRange]

    @property
    def in_metric(self) -> "Rating[Request]":
        """The same to be told in metric units, as in the document."""
        return replace(self, asked=replace(self.asked, units=METRIC))

    @property
    def ok(self) -> bool:
        """Whether every possible point closed."""
        return self.own.status == "ok" and all(result.status == "ok" for result in self.points.values())


SceneRating = Rating[SceneRequest]


class Part(NamedTuple):
    """A part of a rating, which one worker computes, and what stands for it where that dies."""

    work: Callable[[], Any]
    lost: Any


def base_of(scene: Scene, known: Set[str], over: str) -> Scene:
    """Return a scene without its sweep; raise UsageError, naming `over`, where it varies paths other than `known`."""
    others = [path for path in scene.sweep if path not in known]
    if others or scene.joints:
        path = others[0] if others else scene.joints[0].paths[0]
        raise UsageError(
            f"datasheet: a sheet covers {over}, but the scene varies {path} in another way (remove that axis, and "
            f"rate one value at a time with --set {path}=VALUE)"
        )
    return without_sweep(scene)


def swept_values(scene: Swept, path: str) -> tuple[float, ...]:
    """Return the values [SI] of a sweep over a path, ascending; none where it is not swept."""
    return tuple(sorted(map(float, scene.sweep.get(path, ()))))


def faults_of(base: Scene, values: dict[str, float]) -> list[str]:
    """Return why values do not fit into a scene."""
    return [str(fault) for fault in cross_check(with_values(base, values))]


def read_values(
    base: Scene,
    path: str,
    text: str,
    option: str,
    example: str,
    count: int | Callable[[float, float], int],
) -> tuple[float, ...]:
    """Return the values [SI] of a path that a text states, ascending: 'A', a list 'A, B, C', or a range LOW..HIGH.

    A range has `count` values, which may follow from its ends; bare numbers of a list have the unit of its last value.
    Raises UsageError in one line.
    """
    both, listed = ends_of(text), [part.strip() for part in text.split(",")]
    if both is None and not all(listed):
        raise UsageError(
            f"{option} {text}: is neither LOW..HIGH nor one value or several (write e.g. {option} '{example}')"
        )
    unit = unit_behind(listed[-1])
    stated = both or [f"{part} {unit}".strip() if re.fullmatch(NUMBER, part) else part for part in listed]
    try:
        values = tuple(read_text(base, path, each) for each in stated)
    except UsageError as fault:
        raise UsageError(f"{option} {text}: {str(fault).removeprefix(path).removeprefix(': ')}") from None
    if both is None:
        if any(later <= earlier for earlier, later in itertools.pairwise(values)):
            raise UsageError(f"{option} {text}: does not rise from value to value (a decimal point is a dot)")
        return values
    first, last = values
    refuse_empty_range(base, path, first, last, f"{option} {text}")
    steps = (count if isinstance(count, int) else count(first, last)) - 1
    return tuple(first + (last - first) * i / steps for i in range(steps + 1))


def rating(asked: SceneRequest, jobs: int | None = None, progress: Progress | None = None) -> SceneRating:
    """Return the rating; columns of the table and controls are computed by `jobs` workers.

    Raises UsageError, in one line, where no point of the table can be computed.
    """
    _check_table(asked)
    (own,) = simulate_many([asked.scene], trace=False)
    return rating_around(asked, own, (), jobs, progress)[0]


def rating_around(
    asked: Request, own: Result, more: Sequence[Part], jobs: int | None, progress: Progress | None
) -> tuple[Rating[Request], list[Any]]:
    """Return a rating around the results at the scenes' own point, and the answers of `more` parts.

    Without a capacity at that point there is neither part load nor any of these.
    """
    full = own.performance.get(asked.aim.load) if own.status == "ok" else None
    across, down = asked.across.values, asked.down.values
    parts = [Part(partial(asked.column, value), [DEAD] * len(down)) for value in across]
    if full:
        for each in asked.controls:
            parts.append(Part(partial(asked.part_load, each, full), PartLoad(each, (), (), WORKER_DIED)))
        parts += more
    found = answers_of(parts, jobs, progress)
    columns = enumerate(found[: len(across)])
    points = {(i, j): result for i, column in columns for j, result in enumerate(column) if result}
    closed = {place: result.performance for place, result in points.items() if result.status == "ok"}
    figures = {place: closed.get(place) for place in itertools.product(range(len(across)), range(len(down)))}
    reach = tuple(envelope(figures, (across, down), asked.bounds))
    end = len(found) - len(more) if full else len(found)
    return Rating(asked, own, points, found[len(across) : end], reach), found[end:]


def answers_of(parts: Sequence[Part], jobs: int | None, progress: Progress | None) -> list[Any]:
    """Return the answers of parts, computed by `jobs` workers."""
    work = partial(_answer, [part.work for part in parts])
    return parallel_map(work, len(parts), died=lambda number: parts[number].lost, jobs=jobs, progress=progress)


def _answer(works: Sequence[Callable[[], Any]], number: int) -> Any:
    return works[number]()


def _check_table(asked: SceneRequest) -> None:
    """Raise UsageError where no point of the table is one of the machine."""
    invalid = ""
    for across, down in itertools.product(asked.across.values, asked.down.values):
        case = case_scene(asked, across, down)
        if isinstance(case, Scene):
            return
        invalid = invalid or (case.message if case is not None else "")
    small = f"lifts are below {LEAST_LIFT:g} K" if asked.by_lift else f"pressure ratios are below {LEAST_RATIO:g}"
    options = [OPTIONS[axis.path] for axis in (asked.across, asked.down) if axis.path in OPTIONS]
    raise UsageError(
        f"datasheet: no point of the table can be computed: {invalid or f'all {small}'} "
        f"(state other ranges with {' and '.join(options)})"
    )


def case_scene(asked: SceneRequest, across: float, down: float) -> Scene | Result | None:
    """Return the scene of a point; a failed result where it is invalid, None for too small a lift or pressure ratio."""
    values = {asked.across.path: across, asked.down.path: down}
    if asked.is_small(across, down):
        return None
    faults = faults_of(asked.scene, values)
    if faults:
        return Result("failed", message=faults[0])
    scene = with_values(asked.scene, values)
    return scene if asked.aim != GAS or pressure_ratio(scene) >= LEAST_RATIO else None


def pressure_ratio(scene: Scene) -> float:
    """Return the higher over the lower pressure of a scene's lines, in the direction that the machine is meant for."""
    at = lines(scene)
    return at.p_s / at.p_d if scene.machine.expands else at.p_d / at.p_s
