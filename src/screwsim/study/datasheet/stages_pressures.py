"""Two stages of air at other outlet pressures: their full flow at each, and at variable speed their lowest.

The speeds are those of the sheet, or at variable speed the highest that both motors carry; the pressure between both
stages is found anew.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from screwsim.outputs.customary import RPM
from screwsim.scene.lines import lines
from screwsim.scene.operation import P_D
from screwsim.study.datasheet.air_points import SHARE, Point, heads_of, point_row
from screwsim.study.datasheet.air_pressures import (
    AS_STATED,
    FULL,
    LOWEST,
    AtPressure,
    over_inlet,
    pressures_document,
)
from screwsim.study.datasheet.bounds import limits_of, motor_of
from screwsim.study.datasheet.columns import BAR, Column, in_units
from screwsim.study.datasheet.marks import marks_of
from screwsim.study.datasheet.rated import Part, answers_of
from screwsim.study.datasheet.sheet import Table
from screwsim.study.datasheet.stages_carried import SPEEDS, Pair, carried_stages
from screwsim.study.datasheet.units import METRIC, US, Units
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED
from screwsim.study.stages import ChainResult
from screwsim.study.stages.axes import STAGE_NAMES
from screwsim.study.stages.chain import StageChain
from screwsim.study.sweep.stages import solved_with

OUTLET = f"{STAGE_NAMES[1]}.{P_D}"
BETWEEN = Column("intermediate_pressure", "between bar", BAR, 3)


class StagesAtPressure(NamedTuple):
    """Two stages at an outlet pressure, and the speeds [rad/s] of both at full flow there."""

    at: AtPressure
    speeds: Pair


def stages_at_pressures(
    chain: StageChain,
    pressures: Sequence[float],
    speeds: Sequence[Pair],
    jobs: int | None,
    progress: Progress | None,
) -> list[StagesAtPressure]:
    """Return two stages without a sweep at outlet pressures [Pa]; `speeds` [rad/s] begin with those of full flow."""
    if not pressures:
        return []
    dead = Point(speeds[0][0], ChainResult("failed", WORKER_DIED).as_result())
    parts = [
        Part(partial(_at_pressure, chain, speeds, each), StagesAtPressure(AtPressure(each, dead), speeds[0]))
        for each in pressures
    ]
    return answers_of(parts, jobs, progress)


def _at_pressure(chain: StageChain, speeds: Sequence[Pair], pressure: float) -> StagesAtPressure:
    """Return full flow at a pressure [Pa], at speeds that both motors carry, and at variable speed the lowest flow."""
    at, ends = {OUTLET: pressure}, (speeds[0], speeds[-1])
    results = [solved_with(chain, {**dict(zip(SPEEDS, each, strict=True)), **at}) for each in ends[: len(speeds)]]
    full, *others = (Point(each[0], found.as_result()) for each, found in zip(ends, results, strict=False))
    lowest = others[0] if others else None
    carried = carried_stages(chain, at, ends, (results[0], results[1])) if others else None
    if carried is None:
        return StagesAtPressure(AtPressure(pressure, full, lowest), speeds[0])
    both, found = carried
    return StagesAtPressure(AtPressure(pressure, Point(both[0], found.as_result()), lowest, bounded=True), both)


def stages_pressures_table(
    chain: StageChain, pressures: Sequence[StagesAtPressure], speeds: Sequence[Pair], units: Units
) -> Table:
    """Return the table of full flow over the outlet pressure; `speeds` [rad/s] are those of the sheet's points."""
    limits, found = limits_of(chain, ()), [each.at for each in pressures]
    results = [each.full.result if each.full.ok else None for each in found]
    marks, inlet, between = marks_of(limits, results), lines(chain.first).p_s, in_units(BETWEEN, units)
    heads = [*(["bar over inlet", "psi"] if units == METRIC else ["psi over inlet"]), "rpm", *heads_of(units)[1:]]
    heads.remove(SHARE)
    heads += [between.title, "motors %"]
    lowest = [each.lowest for each in found if each.lowest is not None]
    rows = []
    for (each, both), mark in zip(pressures, marks.column(results), strict=True):
        cells = point_row(each.full, each.full, units)[1:]
        del cells[heads_of(units).index(SHARE) - 1]
        over = [f"{over_inlet(each.pressure, inlet, units)}{mark}"]
        over += [over_inlet(each.pressure, inlet, US)] if units == METRIC else []
        stages = [between.cell(each.full.result.performance), _motors(chain, each.full)] if each.full.ok else ["", ""]
        rows.append([*over, _speeds(both), *cells, *stages])
    notes = [marks.note(results, units)]
    if any(each.bounded for each in found):
        notes.append("the speeds of full flow are at most those at which both motors carry their loads")
    if lowest:
        notes.append(f"lowest flow at {' and '.join(f'{each / RPM:.0f}' for each in speeds[-1])} rpm")
    if lowest:
        heads.append(f"lowest {heads_of(units)[1]}")
        rows = [[*row, point_row(point, point, units)[1]] for row, point in zip(rows, lowest, strict=True)]
    return Table(
        "Full flow over the outlet pressure", heads, rows, "; ".join([*filter(None, notes), AS_STATED]), across=True
    )


def _speeds(both: Pair) -> str:
    """Return the speeds of both stages in rpm, once where they are equal."""
    return "/".join(dict.fromkeys(f"{speed / RPM:.0f}" for speed in both))


def _motors(chain: StageChain, point: Point) -> str:
    """Return the loads of both motors, that of the first stage first, in percent of their rated powers."""
    found = point.result.performance
    loads = (found[f"{name}_shaft_power"] / motor_of(scene).rated_power for name, scene in chain.by_stage.items())
    return "/".join(f"{100.0 * load:.0f}" for load in loads)


def stages_pressures_document(
    pressures: Sequence[StagesAtPressure],
    speeds: Sequence[Pair],
    figures: Callable[[Point], Mapping[str, Any]],
) -> list[dict[str, Any]]:
    """Return the points at outlet pressures for programs (SI units); `speeds` are those of the sheet's points."""
    documents = pressures_document([each.at for each in pressures], figures)
    for each, (_, full) in zip(documents, pressures, strict=True):
        both = {FULL: full, LOWEST: speeds[-1]}
        for name in both.keys() & each.keys():
            first, second = both[name]
            each[name] = {"first_speed": first, "second_speed": second, **each[name]}
    return documents
