"""Limits of a machine, FIGURE<VALUE or FIGURE>VALUE, and the envelope within which all of them hold."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, NamedTuple

from screwsim.figures import declared
from screwsim.figures.engineering import figure_text, shown_name
from screwsim.outputs.customary import RPM
from screwsim.scene import Scene
from screwsim.study.asked.goals import Bound, read_bounds
from screwsim.study.datasheet.assumed import SOURCE, Assumed, assumed_limits
from screwsim.study.datasheet.units import METRIC, Units
from screwsim.study.stages.chain import StageChain

MOTOR = "motor"
RATED = f"effects.{MOTOR}.rated_power"
FIELD = f"effects.{MOTOR}.inverter.full_field_speed"  # by which it carries more above its rated speed
TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Carried:
    """What a motor carries whose field stays above its rated speed: a power [W] that rises with the speed from there.

    `value` [W] is that at a speed `omega` [rad/s] of the rotors, which the sheet names.
    """

    figure: str
    motor: Any
    omega: float
    sign = "<"

    @property
    def value(self) -> float:
        """What it carries [W] at the speed that the sheet names."""
        return float(self.motor.carried(self.omega))

    def excess_in(self, found: Mapping[str, Any]) -> float:
        """Return by how much [W] a point's power exceeds what its speed allows; NaN for one without a power."""
        power = found.get(self.figure)
        if power is None:
            return math.nan
        omega = TURN * found["displacement_flow"] / found["displacement"]
        return float(power) - float(self.motor.carried(omega))

    def in_words(self, units: Units) -> str:
        """Return the limit at the speed that the sheet names."""
        power = limit_text(self.figure, self.value, units)
        return f"{shown_name(self.figure)} {self.sign} {power} at {self.omega / RPM:.0f} rpm, at others by the speed"


Limit = Bound | Assumed | Carried


def motor_of(scene: Scene) -> Any:
    """Return the settings of the motor that a scene names; None without one."""
    named = scene.effects.get(MOTOR)
    return None if named is None else named.parameters


def field_stays(motor: Any) -> bool:
    """Return whether a motor's field stays above its rated speed, so that it carries more there."""
    drive = motor.inverter
    return drive is not None and (drive.full_field_speed or drive.rated_speed) > drive.rated_speed


def excess_of(bound: Limit, found: Mapping[str, Any]) -> float:
    """Return by how much [SI] a limit is exceeded; negative within it, NaN for a figure without a value."""
    if isinstance(bound, Assumed | Carried):
        return bound.excess_in(found)
    value = found.get(bound.figure)
    return math.nan if value is None else bound.excess(float(value))


def bound_words(bound: Limit, units: Units) -> str:
    """Return a limit as people write it."""
    if isinstance(bound, Assumed | Carried):
        return bound.in_words(units)
    return f"{shown_name(bound.figure)} {bound.sign} {limit_text(bound.figure, bound.value, units)}"


def limits_document(bounds: Mapping[Limit, str]) -> list[dict[str, Any]]:
    """Return limits for programs (SI units); one that goes by the speed with the speed [rad/s] of its value."""
    return [
        {
            "figure": bound.figure,
            "below": bound.sign == "<",
            "value": bound.value,
            "from": source,
            **({"speed": bound.omega} if isinstance(bound, Carried) else {}),
        }
        for bound, source in bounds.items()
    ]


def limit_text(figure: str, value: float, units: Units) -> str:
    """Return a figure [SI] as text with its unit, four digits."""
    about = declared(figure)
    if about.units == "K":
        return units.degrees(value)
    if about.units == "kelvin":
        return units.difference(value)
    if about.units == "1":
        return figure_text(about, value)
    si = about.shown or about.units
    if about.units == "Pa" and not figure.endswith("pressure"):
        return units.pressure_difference(value, si)
    return units.quantity(si, value)


def limits_of(subject: Scene | StageChain, texts: Sequence[str]) -> dict[Limit, str]:
    """Return the limits stated in texts, what each motor of a scene or of two stages carries, and where each is.

    For one machine those that are assumed follow. Raises UsageError for a text that states none.
    """
    return with_limits_of(subject, read_bounds(subject, texts, "--limit"))


def with_limits_of(subject: Scene | StageChain, stated: Sequence[Bound]) -> dict[Limit, str]:
    """Return stated limits, those of motors, and assumed ones; where one is stated, it replaces these."""
    found: dict[Limit, str] = dict.fromkeys(stated, "--limit")
    if isinstance(subject, Scene):
        powers = (("output_power" if subject.machine.expands else "shaft_power", subject, RATED),)
    else:
        stages = subject.by_stage.items()
        powers = tuple((f"{stage}_shaft_power", scene, f"{stage}.{RATED}") for stage, scene in stages)
    for power, scene, source in powers:
        motor = motor_of(scene)
        if motor is not None and not any(bound.figure == power for bound in found):
            found |= _motor_limit(subject, power, scene, source)
    if isinstance(subject, Scene):
        found |= dict.fromkeys(assumed_limits(subject, stated), SOURCE)
    return found


def _motor_limit(subject: Scene | StageChain, power: str, scene: Scene, source: str) -> dict[Limit, str]:
    """Return what a motor carries and where that is stated: one power, or of a field that stays one by the speed.

    Points of two stages do not tell the speeds; theirs is that at the scene's own speed.
    """
    motor, speed = motor_of(scene), scene.operation.speed
    if not field_stays(motor):
        return {Bound(power, "<", float(motor.rated_power)): source}
    source = source.replace(RATED, FIELD)
    if isinstance(subject, Scene):
        return {Carried(power, motor, speed): source}
    return {Bound(power, "<", float(motor.carried(speed))): source}


class EnvelopeRange(NamedTuple):
    """Range of the axis down at a value of the axis across [SI], and what ends it on both sides."""

    at: float
    low: float
    high: float
    below: Limit | str
    above: Limit | str

    def ends_in_words(self, units: Units = METRIC) -> tuple[str, str]:
        """Return what ends it, in words."""
        first, last = (end if isinstance(end, str) else bound_words(end, units) for end in (self.below, self.above))
        return first, last


def envelope(
    points: Mapping[tuple[int, int], Mapping[str, Any] | None],
    axes: tuple[Sequence[float], Sequence[float]],
    bounds: Iterable[Limit],
) -> Iterator[EnvelopeRange]:
    """Yield for each value across the longest run of points within all limits, with interpolated ends.

    `points` are figures by the indices on both axes, None where a point has none. Between a point within a limit and
    one beyond it the excess is taken as linear; next to a point without figures the run ends at the last one that has
    them.
    """
    for i, across in enumerate(axes[0]):
        column = [points[i, j] for j in range(len(axes[1]))]
        inside = [found is not None and not exceeded_bounds(found, bounds) for found in column]
        runs = list(_runs(inside))
        if not runs:
            continue
        first, last = max(runs, key=lambda run: run[1] - run[0])
        low, below = _run_end(column, axes[1], first, first - 1, bounds)
        high, above = _run_end(column, axes[1], last, last + 1, bounds)
        yield EnvelopeRange(across, low, high, below, above)


def exceeded_bounds(found: Mapping[str, Any], bounds: Iterable[Limit]) -> list[Limit]:
    """Return the limits that figures exceed, or for which they have no value."""
    return [bound for bound in bounds if not excess_of(bound, found) <= 0.0]


def _runs(inside: Sequence[bool]) -> Iterator[tuple[int, int]]:
    for good, run in groupby(range(len(inside)), key=lambda j: inside[j]):
        places = list(run)
        if good:
            yield places[0], places[-1]


def _run_end(
    column: Sequence[Mapping[str, Any] | None], values: Sequence[float], j: int, outside: int, bounds: Iterable[Limit]
) -> tuple[float, Limit | str]:
    """Return the end of a run whose last point is j, and its cause."""
    if not 0 <= outside < len(column):
        return values[j], "end of the table"
    here, there = column[j], column[outside]
    assert here is not None
    if there is None:
        return values[j], "no result beyond"
    shares = {}
    for bound in exceeded_bounds(there, bounds):
        a, b = excess_of(bound, here), excess_of(bound, there)
        shares[bound] = -a / (b - a) if math.isfinite(a) and math.isfinite(b) and b > a else 0.0
    first = min(shares, key=lambda each: shares[each])
    return values[j] + shares[first] * (values[outside] - values[j]), first
