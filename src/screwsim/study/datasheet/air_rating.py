"""Rating of an air package: its points from full to lowest flow, unloaded, and by 10 CFR 431.345 (M349).

A scene that sweeps operation.speed is one of variable speed, and its speeds are the points; else the speed is fixed. A
package with a fan is air-cooled, one without is liquid-cooled. At variable speed full flow is at the highest speed of
the sweep, or at the highest that the motor carries, where that is lower.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from screwsim.effects.air_package import UNLOADED, Unloaded
from screwsim.effects.parts.rating import STANDARDS, WEIGHTS, outside_scope, part_load_efficiency
from screwsim.inputs.faults import UsageError
from screwsim.numerics.pchip import Pchip
from screwsim.scene import Scene, with_values
from screwsim.scene.lines import Lines, lines
from screwsim.scene.operation import P_D, SPEED
from screwsim.study.asked.goals import Bound
from screwsim.study.datasheet.air_points import EFFICIENCY, Point, points_at
from screwsim.study.datasheet.air_pressures import AtPressure, at_pressures, read_pressures
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.carried import carried_point
from screwsim.study.datasheet.hottest_room import Room, hottest_rooms
from screwsim.study.datasheet.load_unload import PATH, LoadUnload, Receiver, check_receiver
from screwsim.study.datasheet.rated import base_of, swept_values
from screwsim.study.datasheet.units import METRIC, Units
from screwsim.study.pool.progress import Progress

STATE = "effects.air_package.state"
LOAD_TOLERANCE = 0.01  # of full flow, tolerance within which a load is met
REFERENCE_INLET = 1e5, 293.15  # Pa, K
ELSEWHERE = "rated at an inlet other than the 1 bar and 20 °C at which data sheets are compared"


@dataclass(frozen=True)
class Regulation:
    """Compliance of a package with 10 CFR 431.345.

    `efficiency` is the one that is judged, computed from the `loads` (share of full flow, efficiency); `why` says why
    there is none, or why the regulation does not cover the package.
    """

    speed: str
    coolant: str
    least: float
    efficiency: float | None
    loads: Sequence[tuple[float, float]]
    why: str = ""
    covered: bool = True

    @property
    def met(self) -> bool | None:
        """Whether the least efficiency is met; None where the question does not apply."""
        return None if self.efficiency is None or not self.covered else self.efficiency >= self.least


@dataclass(frozen=True)
class Rating:
    """Points from full to lowest flow, the unloaded one where the scene defines it, and the regulation.

    `overloaded` is the point at the highest speed of the sweep, where the motor carries full flow only at a lower one.
    """

    points: Sequence[Point]
    unloaded: Point | None
    regulation: Regulation | None
    variable: bool
    coolant: str
    rooms: Sequence[Room] = ()
    units: Units = METRIC
    receiver: Receiver | None = None
    control: LoadUnload | None = None
    pressures: Sequence[AtPressure] = ()
    overloaded: Point | None = None

    @property
    def full(self) -> Point:
        """The point of full flow."""
        return self.points[0]


def rating(
    scene: Scene,
    progress: Progress | None = None,
    bounds: Sequence[Bound] = (),
    receiver: Receiver | None = None,
    pressures: str | None = None,
) -> Rating:
    """Return the rating of an air package, with the hottest room for each limit, and its control with a receiver.

    `pressures` states other outlet pressures at which it is rated as well; without them those of the sweep are.
    Raises UsageError where a scene leaves open what is rated.
    """
    base = base_of(scene, {SPEED, P_D}, f"the values of sweep.{SPEED} and sweep.{P_D} of an air package")
    outlets = read_pressures(base, lines(base).p_s, pressures, swept_values(scene, P_D))
    package = scene.effects["air_package"].parameters
    if package.state == UNLOADED:
        raise UsageError(f"datasheet: {STATE} is unloaded, but an unloaded package delivers nothing (write loaded)")
    variable, coolant = SPEED in scene.sweep, "liquid" if package.fan is None else "air"
    speeds = sorted(scene.sweep.get(SPEED, (scene.operation.speed,)), reverse=True)
    progress, idle, shut = progress or Progress(), None, None
    vents = receiver is not None and package.unloaded is not None
    if receiver is not None:
        check_receiver(receiver, lines(base).p_s, lines(base).p_d, package.unloaded)
    overloaded = None
    progress.start(len(speeds) + (package.unloaded is not None) + vents + len(bounds) + 2 * len(outlets), 0)
    try:
        points = points_at(base, speeds, progress)
        carried = carried_point(base, points[0], points[-1] if len(points) > 1 else None) if variable else None
        if carried is not None:
            overloaded = points[0]
            points = [carried, *(point for point in points if point.speed < carried.speed)]
        if package.unloaded is not None:
            idle = points_at(with_values(base, {STATE: UNLOADED}), speeds[-1:], progress)[0]
        if vents:
            full = with_values(base, {STATE: UNLOADED, f"{PATH}.separator_pressure": lines(base).p_d})
            shut = points_at(full, speeds[-1:], progress)[0]
        regulation = _regulation(base, points, variable, coolant, progress) if points[0].flow > 0.0 else None
        rooms = []
        for room in hottest_rooms(with_values(base, {SPEED: points[0].speed}), bounds, points[0].result):
            rooms.append(room)
            progress.advance(1, room.temperature is None)
        others = at_pressures(base, outlets, speeds, points[0], variable, progress)
    finally:
        progress.stop()
    control = None if receiver is None else control_of(receiver, lines(base), points, package.unloaded, shut, idle)
    return Rating(
        *(points, idle, regulation, variable, coolant, rooms),
        receiver=receiver,
        control=control,
        pressures=others,
        overloaded=overloaded,
    )


def control_of(
    receiver: Receiver,
    at: Lines,
    points: Sequence[Point],
    unloaded: Unloaded | None = None,
    shut: Point | None = None,
    idle: Point | None = None,
) -> LoadUnload | None:
    """Return how a package loads and unloads, or stops, at its lowest flow (M471); None where a point is not known.

    `shut` and `idle` are points off load, before and after the separator is vented; without them it stops.
    """
    good = [point for point in points if point.flow > 0.0]
    if not good:
        return None
    least = min(good, key=lambda point: point.flow)
    if unloaded is None or shut is None or idle is None:
        return LoadUnload(least.flow, least.power, receiver.free_air(at.p_s))
    if not (shut.ok and idle.ok):
        return None
    return LoadUnload.vents(receiver, at, least.result.performance, unloaded, shut.power, idle.power)


def _regulation(base: Scene, points: Sequence[Point], variable: bool, coolant: str, progress: Progress) -> Regulation:
    full, at = points[0], lines(base)
    speed = "variable" if variable else "fixed"
    least = STANDARDS[speed, coolant].least(full.flow)
    outside = outside_scope(full.flow, at.p_d - at.p_s, motor_of(base).rated_power)
    if elsewhere(base):
        return Regulation(speed, coolant, least, None, (), outside or ELSEWHERE, not outside)
    loads, why = _loads(base, points, progress) if variable else ([(1.0, _efficiency(full))], "")
    known = {load: value for load, value in loads if value is not None}
    if not why and len(known) < len(loads):
        why = full.result.notes.get(EFFICIENCY, "one of the loads has no package isentropic efficiency")
    found = None if why else part_load_efficiency(known) if variable else known[1.0]
    return Regulation(speed, coolant, least, found, tuple(known.items()), outside or why, not outside)


def elsewhere(scene: Scene) -> bool:
    """Return whether the inlet of a package is another than that of data sheets."""
    at = lines(scene)
    return abs(at.p_s - REFERENCE_INLET[0]) > 1e-3 * REFERENCE_INLET[0] or abs(at.T_s - REFERENCE_INLET[1]) > 0.1


def _efficiency(point: Point) -> float | None:
    return point.result.performance.get(EFFICIENCY) if point.ok else None


def _loads(base: Scene, points: Sequence[Point], progress: Progress) -> tuple[list[tuple[float, float | None]], str]:
    """Return the efficiency at each load at which variable speed is rated, or why there is none.

    The speeds for these flows are interpolated among the points, and solved.
    """
    good = sorted((point.flow, point.speed) for point in points if point.flow > 0.0)
    full = points[0].flow
    if len(good) < 2 or good[0][0] > min(WEIGHTS) * full:
        share, lowest = 100.0 * good[0][0] / full, 100.0 * min(WEIGHTS)
        return [], f"its lowest flow is {share:.0f} % of full flow, but the rating also needs {lowest:.0f} %"
    flows, speeds = (np.array(column) for column in zip(*good, strict=True))
    lower = [load for load in sorted(WEIGHTS, reverse=True) if load < 1.0]
    progress.more(len(lower))
    found = points_at(base, [float(Pchip(flows, speeds)(load * full)) for load in lower], progress)
    for load, point in zip(lower, found, strict=True):
        if abs(point.flow - load * full) > LOAD_TOLERANCE * full:
            return [], f"no speed was found that gives {load:.0%} of full flow (more speeds in the sweep)"
    return [(1.0, _efficiency(points[0])), *zip(lower, map(_efficiency, found), strict=True)], ""
