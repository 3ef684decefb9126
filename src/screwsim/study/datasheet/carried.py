"""The highest speed that the motor of an air package carries, where it would be overloaded at a higher one."""

import math
from collections.abc import Callable

from screwsim.numerics.roots import brentq
from screwsim.outputs.customary import RPM
from screwsim.scene import Scene
from screwsim.scene.operation import SPEED
from screwsim.study.asked.goals import Goal
from screwsim.study.asked.spans import Span
from screwsim.study.datasheet.air_points import Point, points_at
from screwsim.study.datasheet.bounds import field_stays, motor_of
from screwsim.study.pool.progress import Progress
from screwsim.study.seek import GoalSeekAnswer, Question, find_each

SLOWEST = 0.4  # of a package's only speed, above which one is sought that its motor carries
NEAR = 0.2 * RPM  # [rad/s] to which a speed is sought where the motor carries more at a higher one
STEPS = 3  # of a revolution per minute by which the speed found is lowered while the motor is loaded beyond its rating


def shaft_power(point: Point) -> float:
    """Return the shaft power [W] of a point that closed."""
    return float(point.result.performance["shaft_power"])


def carried_point(scene: Scene, fast: Point, slow: Point | None) -> Point | None:
    """Return the point at the highest whole number of revolutions per minute that the motor carries.

    `fast` and `slow` are points of a scene without a sweep; without a slow one, the speed is sought above `SLOWEST` of
    the fast one's. None where the motor carries the fast one, or not even the slow one, where one of them did not
    close, and where no such speed is found or its point does not close.
    """
    if not fast.ok or _load(scene, fast) <= 1.0:
        return None
    if slow is None:
        (slow,) = points_at(scene, (SLOWEST * fast.speed,), Progress())
    if not slow.ok or _load(scene, slow) >= 1.0:
        return None
    if field_stays(motor_of(scene)):
        speed = _carried_by_speed(scene, slow, fast)
    else:
        speed = speed_in(speed_search(scene, motor_of(scene).rated_power, (slow.speed, fast.speed)))
    if speed is None:
        return None
    for lower in range(STEPS):  # the search and the point agree to the accuracy asked for
        at = max(RPM * (math.floor(speed / RPM) - lower), slow.speed)
        (point,) = points_at(scene, (at,), Progress())
        if point.ok and _load(scene, point) <= 1.0:
            return point
    return None


def _carried_by_speed(scene: Scene, slow: Point, fast: Point) -> float | None:
    """Return the speed [rad/s] at which a motor whose field stays has the load that it carries there; None without one.

    `slow` loads it less, `fast` more.
    """
    known = {slow.speed: slow, fast.speed: fast}

    def load(speed: float) -> float:
        if speed not in known:
            (known[speed],) = points_at(scene, (speed,), Progress())
        return _load(scene, known[speed]) if known[speed].ok else math.inf

    return fully_loaded(load, (slow.speed, fast.speed), NEAR)


def fully_loaded(load: Callable[[float], float], ends: tuple[float, float], near: float) -> float | None:
    """Return where between two ends a load is that which is carried: where it is 1, to `near`.

    `load` is below 1 at the first end and above at the other, and infinite where a point does not close. None where a
    point that the search asks for does not: it ends where points begin to close then, not at a load.
    """
    asked: list[float] = []

    def excess(at: float) -> float:
        asked.append(load(at))
        return asked[-1] - 1.0

    found = brentq(excess, *ends, xtol=near)
    return found if all(map(math.isfinite, asked)) else None


def _load(scene: Scene, point: Point) -> float:
    """Return the shaft power of a point that closed, over what the motor carries at its speed."""
    return shaft_power(point) / motor_of(scene).carried(point.rotor_speed)


def speed_search(scene: Scene, power: float, ends: tuple[float, float]) -> GoalSeekAnswer:
    """Return the search for the speed between two others [rad/s] at which a shaft takes a power [W]."""
    (answer,) = find_each(scene, Question((Span(SPEED, *ends),), (Goal("shaft_power", power),)), jobs=1)
    return answer


def speed_in(answer: GoalSeekAnswer) -> float | None:
    """Return the speed [rad/s] that a search has found; None where none takes that power, only one near it."""
    return answer.values.get(SPEED) if answer.status == "ok" else None
