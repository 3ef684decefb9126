"""Parts common to all sheets over two quantities: points over both, the envelope, part load by each control.

The axes are evaporating temperature and condenser for refrigeration machines, both pressures for gas compressors, speed
and outlet for expanders.
"""

import itertools
import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple, Protocol

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene, cross_check, with_values
from screwsim.scene.lines import lines
from screwsim.scene.operation import CONDENSING, EVAPORATING, GAS_COOLER_P, P_D, P_S
from screwsim.scene.units import ZERO_CELSIUS
from screwsim.simulate import simulate_many
from screwsim.study.datasheet.bounds import Bound, EnvelopeRange, envelope, motor_of
from screwsim.study.inputs import ends_of, read_text, shown_value
from screwsim.study.parallel import parallel_map
from screwsim.study.part_load import LOADS, REFRIGERATION, Control, LoadFigures, PartLoad, part_load
from screwsim.study.progress import Progress
from screwsim.study.workers import WORKER_DIED

LEAST_LIFT = 10.0  # [K]
LEAST_RATIO = 1.2  # of pressures, below which no point is computed
OPTIONS = {
    EVAPORATING: "--evaporating",
    CONDENSING: "--condensing",
    GAS_COOLER_P: "--condensing",
    P_S: "--suction",
    P_D: "--discharge",
}


class Axis(NamedTuple):
    """An axis of the table: its path and values [SI], ascending."""

    path: str
    values: tuple[float, ...]


class Asked(Protocol):
    """What is rated over two axes: a scene, or two of them in series."""

    @property
    def across(self) -> Axis:
        """The axis across the tables."""
        ...

    @property
    def down(self) -> Axis:
        """The axis down the tables."""
        ...

    @property
    def bounds(self) -> Sequence[Bound]:
        """The limits."""
        ...

    @property
    def controls(self) -> Sequence[Control]:
        """The controls of the capacity."""
        ...

    @property
    def ratios(self) -> Sequence[float]:
        """The built-in volume ratios from which the best is found at each part load."""
        ...

    @property
    def inverts(self) -> bool:
        """Whether the losses of inverters are included at other speeds."""
        ...

    def shown(self, path: str, value: float, digits: int = 5) -> str:
        """Return a setting [SI] of a control in words."""
        ...


class Rated(Protocol):
    """What was found of it: results at its own point, over both axes, of each control, and the envelope."""

    @property
    def asked(self) -> Asked:
        """What is rated."""
        ...

    @property
    def own(self) -> Result:
        """The result at its own point."""
        ...

    @property
    def points(self) -> Mapping[tuple[int, int], Result]:
        """The results by the indices on both axes."""
        ...

    @property
    def loads(self) -> Sequence[PartLoad]:
        """The results of each control."""
        ...

    @property
    def reach(self) -> Sequence[EnvelopeRange]:
        """The envelope."""
        ...


class RatingRequest(NamedTuple):
    """What is rated: a scene without a sweep, the axes across and down its tables, limits, controls."""

    scene: Scene
    across: Axis
    down: Axis
    bounds: tuple[Bound, ...]
    controls: tuple[Control, ...]
    ratios: tuple[float, ...] = ()  # built-in volume ratios from which the best is found at each part load
    aim: LoadFigures = REFRIGERATION

    @property
    def inverts(self) -> bool:
        """Whether the losses of an inverter are included at other speeds."""
        motor = motor_of(self.scene)
        return motor is not None and motor.inverts

    def shown(self, path: str, value: float, digits: int = 5) -> str:
        """Return a setting [SI] of a control in words."""
        return shown_value(self.scene, path, value, digits)


@dataclass(frozen=True)
class Rating:
    """Results: at the scene's own point, by the indices on both axes, of each control; and the envelope."""

    asked: RatingRequest
    own: Result
    points: dict[tuple[int, int], Result]
    loads: Sequence[PartLoad]
    reach: Sequence[EnvelopeRange]

    @property
    def ok(self) -> bool:
        """Whether every possible point closed."""
        return self.own.status == "ok" and all(result.status == "ok" for result in self.points.values())


def without_sweep(scene: Scene, known: Set[str], over: str) -> Scene:
    """Return a scene without its sweep; raise UsageError, naming `over`, where it varies paths other than `known`."""
    others = [path for path in scene.sweep if path not in known]
    if others or scene.joints:
        path = others[0] if others else scene.joints[0].paths[0]
        raise UsageError(
            f"datasheet: a sheet covers {over}, but the scene varies {path} in another way (remove that axis, and "
            f"rate one value at a time with --set {path}=VALUE)"
        )
    return replace(scene, sweep={}, joints=())


def swept_values(scene: Scene, path: str) -> tuple[float, ...]:
    """Return the values [SI] of a sweep over a path, ascending; none where it is not swept."""
    return tuple(sorted(map(float, scene.sweep.get(path, ()))))


def faults_of(base: Scene, values: dict[str, float]) -> list[str]:
    """Return why values do not fit into a scene."""
    return [str(fault) for fault in cross_check(with_values(base, values))]


def read_range(base: Scene, path: str, text: str, option: str, example: str) -> tuple[float, float]:
    """Return both ends [SI] of a range LOW..HIGH of a path; raise UsageError in one line."""
    both = ends_of(text)
    if both is None:
        raise UsageError(f"{option} {text}: is not LOW..HIGH (write e.g. {option} '{example}')")
    try:
        first, last = (read_text(base, path, end) for end in both)
    except UsageError as fault:
        raise UsageError(f"{option} {text}: {str(fault).removeprefix(path).removeprefix(': ')}") from None
    if not first < last:
        ends = " … ".join(shown_value(base, path, end) for end in (first, last))
        raise UsageError(f"{option} {text}: the range {ends} is empty (LOW must be below HIGH)")
    return first, last


def evenly_spaced(first: float, last: float, count: int) -> tuple[float, ...]:
    """Return evenly spaced values from the first to the last."""
    return tuple(first + (last - first) * i / (count - 1) for i in range(count))


def rating(asked: RatingRequest, jobs: int | None = None, progress: Progress | None = None) -> Rating:
    """Return the rating; columns of the table and controls are computed by `jobs` workers.

    Raises UsageError, in one line, where no point of the table can be computed.
    """
    _check_table(asked)
    (own,) = simulate_many([asked.scene], trace=False)
    full = own.performance.get(asked.aim.load) if own.status == "ok" else None
    count, many = len(asked.across.values), len(asked.controls) if full else 0
    work = partial(_rating_part, asked, full)
    found = parallel_map(
        work, count + many, died=partial(_part_of_dead_worker, asked, count), jobs=jobs, progress=progress
    )
    points = {(i, j): result for i, column in enumerate(found[:count]) for j, result in enumerate(column) if result}
    axes = asked.across.values, asked.down.values
    closed = {place: result.performance for place, result in points.items() if result.status == "ok"}
    figures = {(i, j): closed.get((i, j)) for i in range(count) for j in range(len(axes[1]))}
    reach = tuple(envelope(figures, axes, asked.bounds))
    return Rating(asked, own, points, found[count:], reach)


def _rating_part(asked: RatingRequest, full: float | None, number: int) -> Any:
    """Return what one worker computes: the results of a column by its index, beyond these the part load of a control.

    A column has None where no point is computed.
    """
    count = len(asked.across.values)
    if number >= count:
        return part_load(asked.scene, asked.controls[number - count], full, LOADS, asked.ratios, asked.aim)
    across = asked.across.values[number]
    cases = [_case_scene(asked, across, down) for down in asked.down.values]
    solved = simulate_many([case for case in cases if isinstance(case, Scene)], trace=False)
    return [next(solved) if isinstance(case, Scene) else case for case in cases]


def _check_table(asked: RatingRequest) -> None:
    """Raise UsageError where no point of the table is one of the machine."""
    invalid = ""
    for across, down in itertools.product(asked.across.values, asked.down.values):
        case = _case_scene(asked, across, down)
        if isinstance(case, Scene):
            return
        invalid = invalid or (case.message if case is not None else "")
    small = f"lifts are below {LEAST_LIFT:g} K"
    if not _by_lift(asked):
        small = f"pressure ratios are below {LEAST_RATIO:g}"
    options = [OPTIONS[axis.path] for axis in (asked.across, asked.down) if axis.path in OPTIONS]
    raise UsageError(
        f"datasheet: no point of the table can be computed: {invalid or f'all {small}'} "
        f"(state other ranges with {' and '.join(options)})"
    )


def _by_lift(asked: RatingRequest) -> bool:
    return asked.aim == REFRIGERATION and asked.down.path == CONDENSING


def _is_small(asked: RatingRequest, across: float, down: float) -> bool:
    """Return whether the axes alone show too small a lift or pressure ratio, which a point's scene may not allow."""
    if (asked.across.path, asked.down.path) == (P_S, P_D) and asked.scene.machine.expands:
        across, down = down, across
    return is_small(asked.across, asked.down, across, down, _by_lift(asked))


def is_small(first: Axis, second: Axis, low: float, high: float, by_lift: bool) -> bool:
    """Return whether values of two axes differ too little: temperatures `by_lift`, else pressures of both lines."""
    if by_lift:
        return high - low < LEAST_LIFT
    return (first.path, second.path) == (P_S, P_D) and high / low < LEAST_RATIO


def _case_scene(asked: RatingRequest, across: float, down: float) -> Scene | Result | None:
    """Return the scene of a point; a failed result where it is invalid, None for too small a lift or pressure ratio."""
    values = {asked.across.path: across, asked.down.path: down}
    if _is_small(asked, across, down):
        return None
    faults = faults_of(asked.scene, values)
    if faults:
        return Result("failed", message=faults[0])
    scene = with_values(asked.scene, values)
    return scene if asked.aim == REFRIGERATION or pressure_ratio(scene) >= LEAST_RATIO else None


def pressure_ratio(scene: Scene) -> float:
    """Return the higher over the lower pressure of a scene's lines, in the direction that the machine is meant for."""
    at = lines(scene)
    return at.p_s / at.p_d if scene.machine.expands else at.p_d / at.p_s


def _part_of_dead_worker(asked: RatingRequest, count: int, number: int) -> Any:
    if number >= count:
        return PartLoad(asked.controls[number - count], (), (), WORKER_DIED)
    return [Result("failed", message=WORKER_DIED)] * len(asked.down.values)


def celsius(T: float) -> float:
    """Return a temperature [K] in °C, without the rounding of 273.15."""
    found = round(T - ZERO_CELSIUS, 6)
    return 0.0 if math.isclose(found, 0.0, abs_tol=1e-9) else found
