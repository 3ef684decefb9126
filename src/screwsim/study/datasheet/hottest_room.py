"""The hottest room of an air package: where a temperature of its machine reaches a limit, at full flow.

In a hotter room its oil cooler of a stated size takes less (M288). Where the coolant has a temperature of its own, as
water has, the warmest coolant is sought instead.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from screwsim.figures import declared
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.lines import lines
from screwsim.study.asked.goals import Bound, Goal, read_bounds
from screwsim.study.asked.spans import Span
from screwsim.study.datasheet.bounds import bound_words, limit_text
from screwsim.study.datasheet.units import METRIC, Units
from screwsim.study.pool.solving import results_at
from screwsim.study.seek import Question, find_each

INLET, COOLANT = "operation.suction.temperature", "effects.separator.cooler.coolant_temperature"
LEAST_SPAN = 40.0  # K by which the search goes beyond the temperature as stated, at least
CONDUCTANCE = "effects.separator.cooler.conductance"


class Room(NamedTuple):
    """The temperature [K] of a path at which a limit is reached, its numerical error; `why` says why there is none.

    Where there is none, `reached` is the limited temperature as stated, which exceeds the limit already, or `beyond`
    the end of the search, below which nothing reaches it.
    """

    bound: Bound
    path: str
    temperature: float | None
    error: float | None = None
    why: str = ""
    reached: float | None = None
    beyond: float | None = None

    def none_in_words(self, units: Units = METRIC) -> str:
        """Return why there is none."""
        if self.beyond is not None:
            return f"{units.degrees(self.beyond, '.1f')} at least"
        if self.reached is None:
            return f"none, {self.why},"
        return f"none, since it is {limit_text(self.bound.figure, self.reached, units)} as stated,"


def room_limits(scene: Scene, texts: Sequence[str]) -> tuple[Bound, ...]:
    """Return the limits FIGURE<VALUE of a package's temperatures; raise UsageError for others, or without a cooler."""
    bounds = read_bounds(scene, texts, "--limit")
    for bound in bounds:
        if bound.sign != "<" or declared(bound.figure).units != "K":
            what = "is no upper limit of a temperature, as the hottest room of an air package needs it"
            remedy = "write e.g. --limit 'mixture_discharge_temperature<110 degC'"
            raise UsageError(f"--limit {bound.figure}: {what} ({remedy})")
    if bounds and _cooler(scene) is None:
        what = "needs an oil cooler of a size, since one without cools the oil alike in any room"
        raise UsageError(f"--limit {bounds[0].figure}: {what} (state {CONDUCTANCE})")
    return bounds


def hottest_rooms(scene: Scene, bounds: Sequence[Bound], full: Result) -> Iterator[Room]:
    """Yield for each limit the hottest room of a scene without a sweep; `full` is its result as stated."""
    cooler = _cooler(scene)
    if cooler is None:
        return
    path, at = INLET, lines(scene).T_s
    if cooler.coolant_temperature is not None:
        path, at = COOLANT, cooler.coolant_temperature
    for bound in bounds:
        lacks = full.why_not([bound.figure])
        if lacks:
            yield Room(bound, path, None, why=lacks)
        elif full.performance[bound.figure] >= bound.value:
            yield Room(bound, path, None, reached=full.performance[bound.figure])
        else:
            yield _found(scene, bound, Span(path, at, max(bound.value, at + LEAST_SPAN), at))


def _found(scene: Scene, bound: Bound, span: Span) -> Room:
    (last,) = results_at(scene, [{span.path: span.high}], jobs=1)
    if last.status == "ok" and last.performance[bound.figure] < bound.value:
        return Room(bound, span.path, None, beyond=span.high)
    (answer,) = find_each(scene, Question((span,), (Goal(bound.figure, bound.value),)), jobs=1)
    if answer.status != "ok":
        return Room(bound, span.path, None, why=answer.message)
    return Room(bound, span.path, answer.values[span.path], answer.uncertainties.get(span.path))


def room_lines(rooms: Sequence[Room], units: Units, humid: bool) -> Iterator[tuple[str, str]]:
    """Yield the hottest room of each limit, or the warmest coolant, in one line; `humid` air keeps its humidity."""
    parts = []
    for room in rooms:
        found = room.none_in_words(units) if room.temperature is None else units.degrees(room.temperature, ".1f")
        parts.append(f"{found} for {bound_words(room.bound, units)}")
    if rooms:
        of_room = rooms[0].path == INLET
        at = "full flow and this relative humidity" if humid and of_room else "full flow"
        yield ("hottest room" if of_room else "coolant up to"), f"{'; '.join(parts)}, at {at}"


def room_documents(rooms: Sequence[Room]) -> list[dict[str, Any]]:
    """Return the hottest rooms for programs (SI units)."""
    return [
        {
            "figure": room.bound.figure,
            "limit": room.bound.value,
            "path": room.path,
            "temperature": room.temperature,
            "error": room.error,
            "message": room.none_in_words().strip(",") if room.temperature is None else "",
        }
        for room in rooms
    ]


def _cooler(scene: Scene) -> Any:
    """Return the oil cooler of a stated size; None without one."""
    separator = scene.effects.get("separator")
    cooler = None if separator is None else separator.parameters.cooler
    return cooler if cooler is not None and cooler.conductance is not None else None
