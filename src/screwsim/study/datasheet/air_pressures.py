"""An air package at other outlet pressures, as makers list one package: its full flow at each.

At variable speed the highest speed is lowered where it would take more than the rated power of the motor, to the
highest whole number of revolutions per minute that it carries, and the lowest flow is given as well. At fixed speed the
same machine is also geared for each pressure, so that its motor has the load of the scene's own point.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.customary import RPM, in_bar
from screwsim.outputs.us_units import PSI
from screwsim.scene import Scene, with_values
from screwsim.scene.lines import lines
from screwsim.scene.operation import P_D
from screwsim.study.datasheet.air_points import SHARE, Point, heads_of, point_row, points_at
from screwsim.study.datasheet.bounds import Limit, field_stays, motor_of
from screwsim.study.datasheet.carried import carried_point, shaft_power, speed_in, speed_search
from screwsim.study.datasheet.marks import marks_of
from screwsim.study.datasheet.rated import faults_of, read_values
from screwsim.study.datasheet.sheet import Table
from screwsim.study.datasheet.units import METRIC, US, Units
from screwsim.study.pool.progress import Progress

OPTION, EXAMPLE = "--discharge", "8 bar, 9.5 bar, 11 bar"
VALUES_PER_RANGE = 5
FULL, LOWEST = "full_flow", "lowest_flow"  # in documents
GEARED = 0.4, 1.6  # of the scene's speed, between which gears for another pressure are sought
AS_STATED = "built-in volume ratio and losses of parts as the scene states them, at every pressure"


class AtPressure(NamedTuple):
    """A package at an outlet pressure [Pa]: its full flow; at variable speed its lowest flow, at fixed speed geared.

    `bounded` means that full flow is at a lower speed than the highest, which the motor carries. `geared` is at the
    speed at which the motor has the load of the scene's own point.
    """

    pressure: float
    full: Point
    lowest: Point | None = None
    bounded: bool = False
    geared: Point | None = None

    @property
    def points(self) -> Iterator[Point]:
        """The points that were simulated, that of full flow first."""
        yield from filter(None, (self.full, self.lowest, self.geared))


def read_pressures(outlet: Scene, inlet: float, text: str | None, swept: Sequence[float] = ()) -> tuple[float, ...]:
    """Return the outlet pressures [Pa] that are asked for: those of the option's text, or else the swept ones.

    `outlet` is the scene with the outlet's line, `inlet` the pressure [Pa] at the package's inlet. Raises UsageError in
    one line.
    """
    if text is None:
        return tuple(swept)
    pressures = read_values(outlet, P_D, text, OPTION, EXAMPLE, VALUES_PER_RANGE)
    for pressure in pressures:
        if pressure <= inlet:
            what = f"{in_bar(pressure)} is not above the {in_bar(inlet)} of the inlet (choose a higher one)"
            raise UsageError(f"{OPTION} {text}: {what}")
        if faults := faults_of(outlet, {P_D: pressure}):
            raise UsageError(f"{OPTION} {text}: {faults[0]}")
    return pressures


def at_pressures(
    base: Scene, pressures: Sequence[float], speeds: Sequence[float], own: Point, variable: bool, progress: Progress
) -> list[AtPressure]:
    """Return a package at outlet pressures [Pa], at variable speed at the highest and the lowest of its speeds [rad/s].

    `own` is its point of full flow at its own outlet pressure, whose load of the motor others are geared to at fixed
    speed.
    """
    scenes = [(pressure, with_values(base, {P_D: float(pressure)})) for pressure in pressures]
    if variable:
        return [_at_variable_speed(pressure, scene, speeds, progress) for pressure, scene in scenes]
    return [_at_fixed_speed(pressure, scene, speeds[0], own, progress) for pressure, scene in scenes]


def _at_variable_speed(pressure: float, scene: Scene, speeds: Sequence[float], progress: Progress) -> AtPressure:
    """Return full flow, at a speed that the motor carries, and where there are several speeds the lowest flow."""
    full, *others = points_at(scene, (speeds[0], *speeds[1:][-1:]), progress)
    lowest = others[0] if others else None
    carried = carried_point(scene, full, lowest)
    return AtPressure(pressure, carried or full, lowest, bounded=carried is not None)


def _at_fixed_speed(pressure: float, scene: Scene, speed: float, own: Point, progress: Progress) -> AtPressure:
    (full,) = points_at(scene, (speed,), progress)
    if not own.ok:
        progress.advance(1, 1)
        return AtPressure(pressure, full)
    answer = speed_search(scene, shaft_power(own), (speed * GEARED[0], speed * GEARED[1]))
    found = speed_in(answer)
    if found is None:
        geared = Point(
            speed, Result("failed", message=f"no speed loads the motor as at its own point: {answer.message}")
        )
    else:
        (geared,) = points_at(scene, (RPM * round(found / RPM),), Progress())
    progress.advance(1, not geared.ok)
    return AtPressure(pressure, full, geared=geared)


def over_inlet(pressure: float, inlet: float, units: Units) -> str:
    """Return how far a pressure [Pa] is over that of the inlet [Pa], as a number: in bar, in psi of US units."""
    return f"{1e-5 * (pressure - inlet):.4g}" if units == METRIC else f"{(pressure - inlet) / PSI:.0f}"


def named(pressures: Sequence[AtPressure], inlet: float, units: Units) -> Iterator[tuple[str, Point]]:
    """Yield all points with their names, by pressure over that of the inlet [Pa] and by speed."""
    unit = "bar" if units == METRIC else "psi"
    for each in pressures:
        over = f"{over_inlet(each.pressure, inlet, units)} {unit} over the inlet"
        yield from ((f"{over}, {point.rotor_speed / RPM:.0f} rpm", point) for point in each.points)


def pressures_tables(
    scene: Scene, pressures: Sequence[AtPressure], limits: Mapping[Limit, str], units: Units
) -> Iterator[Table]:
    """Yield the tables over the outlet pressure: of full flow, and geared for each; none without any.

    `limits` mark the points beyond them.
    """
    if not pressures:
        return
    lowest = [each.lowest for each in pressures if each.lowest is not None]
    full = [(each.pressure, each.full) for each in pressures]
    notes = []
    if any(each.bounded for each in pressures):
        motor = motor_of(scene)
        its = "what it carries there" if field_stays(motor) else f"its {units.quantity('W', motor.rated_power)}"
        notes.append(f"the speed of full flow is at most the one that loads the motor with {its}")
    if lowest:
        notes.append(f"lowest flow at {lowest[0].rotor_speed / RPM:.0f} rpm")
    table = _table("Full flow over the outlet pressure", scene, full, limits, units, (*notes, AS_STATED))
    if lowest:
        flow = heads_of(units)[1]
        cells = [point_row(point, point, units)[1] for point in lowest]
        rows = [[*row, cell] for row, cell in zip(table.rows, cells, strict=True)]
        table = replace(table, heads=[*table.heads, f"lowest {flow}"], rows=rows)
    yield table
    geared = [(each.pressure, each.geared) for each in pressures if each.geared is not None]
    if geared:
        note = "at the speed that loads the motor as at the scene's own point, to a whole number of rpm"
        yield _table("The same machine geared for each outlet pressure", scene, geared, limits, units, (note,))


def _table(
    title: str,
    scene: Scene,
    points: Sequence[tuple[float, Point]],
    limits: Mapping[Limit, str],
    units: Units,
    notes: Sequence[str],
) -> Table:
    """Return the table of points at outlet pressures [Pa], those beyond a limit marked."""
    results = [point.result if point.ok else None for _, point in points]
    marks, inlet = marks_of(limits, results), lines(scene).p_s
    over = ["bar over inlet", "psi"] if units == METRIC else ["psi over inlet"]
    left_out = heads_of(units).index(SHARE)
    rows = []
    for (pressure, point), mark in zip(points, marks.column(results), strict=True):
        cells = point_row(point, point, units)
        del cells[left_out]
        first = [f"{over_inlet(pressure, inlet, units)}{mark}"]
        first += [over_inlet(pressure, inlet, US)] if units == METRIC else []
        rows.append([*first, *cells, _share_of_motor(point, scene)])
    heads = [*over, *(head for head in heads_of(units) if head != SHARE), "motor %"]
    return Table(title, heads, rows, "; ".join(filter(None, (marks.note(results, units), *notes))), across=True)


def _share_of_motor(point: Point, scene: Scene) -> str:
    """Return the load of the motor in percent of its rated power; '' for a point that did not close."""
    return f"{100.0 * shaft_power(point) / motor_of(scene).rated_power:.0f}" if point.ok else ""


def pressures_document(
    pressures: Sequence[AtPressure], figures: Callable[[Point], Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Return the points at outlet pressures for programs (SI units); `figures` are those of a point."""
    return [
        {
            "outlet_pressure": each.pressure,
            "bounded_by_motor": each.bounded,
            FULL: figures(each.full),
            **({} if each.lowest is None else {LOWEST: figures(each.lowest)}),
            **({} if each.geared is None else {"geared": figures(each.geared)}),
        }
        for each in pressures
    ]
