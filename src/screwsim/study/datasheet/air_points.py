"""Points of an air package's sheet: a speed and the result at it, and the row of the table that tells it."""

from collections.abc import Sequence
from typing import NamedTuple

from screwsim.effects.air_package import FREE_AIR, INPUT_POWER
from screwsim.figures import rotor_speed
from screwsim.outputs import Result
from screwsim.outputs.customary import MINUTE, RPM
from screwsim.outputs.us_units import CFM
from screwsim.scene import Scene, with_values
from screwsim.scene.operation import SPEED
from screwsim.simulate import simulate_many
from screwsim.study.datasheet.units import METRIC, Units
from screwsim.study.pool.progress import Progress

SPECIFIC, EFFICIENCY = "package_specific_power", "package_isentropic_efficiency"
KW, PER_HUNDRED = 1e3, 100.0 * CFM  # W; m³/s in 100 cfm
SHARE = "% of full"
HEADS = ("rpm", "m³/min", "acfm", SHARE, "kW", "kW/ (m³/min)", "kW/ 100 acfm", "isentropic %")
US_HEADS = ("rpm", "acfm", SHARE, "kW", "kW/ 100 acfm", "isentropic %")  # input is in kW on sheets there, too


class Point(NamedTuple):
    """A point of the sheet: speed [rad/s], as set, and result."""

    speed: float
    result: Result

    @property
    def rotor_speed(self) -> float:
        """Speed of the rotors [rad/s]: as set, or what a motor on the mains reaches."""
        return rotor_speed(self.result.performance, self.speed)

    @property
    def flow(self) -> float:
        """Free air delivered [m³/s]; zero where the point did not close."""
        return float(self.result.performance.get(FREE_AIR) or 0.0) if self.ok else 0.0

    @property
    def power(self) -> float:
        """Input power [W] of a point that closed."""
        return float(self.result.performance[INPUT_POWER])

    @property
    def ok(self) -> bool:
        """Whether the point closed."""
        return self.result.status == "ok"


def points_at(base: Scene, speeds: Sequence[float], progress: Progress) -> list[Point]:
    """Return the points of a scene without a sweep at speeds [rad/s]."""
    points = []
    results = simulate_many([with_values(base, {SPEED: float(speed)}) for speed in speeds], trace=False)
    for speed, result in zip(speeds, results, strict=True):
        points.append(Point(float(speed), result))
        progress.advance(1, not points[-1].ok)
    return points


def point_row(point: Point, full: Point, units: Units) -> list[str]:
    """Return the cells of a point of the sheet, under `HEADS` or `US_HEADS`."""
    speed = f"{point.rotor_speed / RPM:.0f}"
    if not point.flow > 0.0:
        return [speed, point.result.status.replace("_", " "), *[""] * (len(heads_of(units)) - 2)]
    found = point.result.performance
    share, specific = 100.0 * point.flow / full.flow if full.flow > 0.0 else 0.0, found[SPECIFIC]
    efficiency = found.get(EFFICIENCY)
    flow, part = f"{point.flow / CFM:.1f}", f"{share:.0f}" if share else ""
    power, per_hundred = f"{found[INPUT_POWER] / KW:.1f}", f"{PER_HUNDRED * specific / KW:.1f}"
    if units == METRIC:
        cells = [f"{MINUTE * point.flow:.2f}", flow, part, power, f"{specific / (KW * MINUTE):.2f}", per_hundred]
    else:
        cells = [flow, part, power, per_hundred]
    return [speed, *cells, "" if efficiency is None else f"{100.0 * efficiency:.1f}"]


def heads_of(units: Units) -> tuple[str, ...]:
    """Return the heads of the points."""
    return HEADS if units == METRIC else US_HEADS
