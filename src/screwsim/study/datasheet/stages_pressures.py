"""Two stages of air at other outlet pressures: their full flow at each, and at variable speed their lowest.

The speeds are those of the sheet; the pressure between both stages is found anew.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from screwsim.outputs.customary import RPM
from screwsim.scene.lines import lines
from screwsim.scene.operation import P_D, SPEED
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
from screwsim.study.datasheet.units import METRIC, US, Units
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED
from screwsim.study.stages import ChainResult
from screwsim.study.stages.axes import STAGE_NAMES
from screwsim.study.stages.chain import StageChain
from screwsim.study.sweep.stages import solved_with

SPEEDS = tuple(f"{stage}.{SPEED}" for stage in STAGE_NAMES)
OUTLET = f"{STAGE_NAMES[1]}.{P_D}"
BETWEEN = Column("intermediate_pressure", "between bar", BAR, 3)


def stages_at_pressures(
    chain: StageChain,
    pressures: Sequence[float],
    speeds: Sequence[tuple[float, float]],
    jobs: int | None,
    progress: Progress | None,
) -> list[AtPressure]:
    """Return two stages without a sweep at outlet pressures [Pa]; `speeds` [rad/s] begin with those of full flow."""
    if not pressures:
        return []
    ends = [speeds[0], speeds[-1]] if len(speeds) > 1 else [speeds[0]]
    dead = ChainResult("failed", WORKER_DIED)
    every = [{**dict(zip(SPEEDS, both, strict=True)), OUTLET: pressure} for pressure in pressures for both in ends]
    found = answers_of([Part(partial(solved_with, chain, case), dead) for case in every], jobs, progress)
    points = [Point(case[SPEEDS[0]], each.as_result()) for case, each in zip(every, found, strict=True)]
    full, lowest = points[:: len(ends)], points[1::2] if len(ends) > 1 else [None] * len(pressures)
    return [AtPressure(*each) for each in zip(pressures, full, lowest, strict=True)]


def stages_pressures_table(
    chain: StageChain, found: Sequence[AtPressure], speeds: Sequence[tuple[float, float]], units: Units
) -> Table:
    """Return the table of full flow over the outlet pressure; `speeds` [rad/s] are those of the sheet's points."""
    limits = limits_of(chain, ())
    results = [each.full.result if each.full.ok else None for each in found]
    marks, inlet, between = marks_of(limits, results), lines(chain.first).p_s, in_units(BETWEEN, units)
    heads = [*(["bar over inlet", "psi"] if units == METRIC else ["psi over inlet"]), *heads_of(units)[1:]]
    heads.remove(SHARE)
    heads += [between.title, "motors %"]
    lowest = [each.lowest for each in found if each.lowest is not None]
    rows = []
    for each, mark in zip(found, marks.column(results), strict=True):
        cells = point_row(each.full, each.full, units)[1:]
        del cells[heads_of(units).index(SHARE) - 1]
        over = [f"{over_inlet(each.pressure, inlet, units)}{mark}"]
        over += [over_inlet(each.pressure, inlet, US)] if units == METRIC else []
        stages = [between.cell(each.full.result.performance), _motors(chain, each.full)] if each.full.ok else ["", ""]
        rows.append([*over, *cells, *stages])
    full, least = (" and ".join(f"{each / RPM:.0f}" for each in speeds[i]) for i in (0, -1))
    notes = [marks.note(results, units), f"full flow at {full} rpm{f', lowest flow at {least} rpm' if lowest else ''}"]
    if lowest:
        heads.append(f"lowest {heads_of(units)[1]}")
        rows = [[*row, point_row(point, point, units)[1]] for row, point in zip(rows, lowest, strict=True)]
    return Table(
        "Full flow over the outlet pressure", heads, rows, "; ".join([*filter(None, notes), AS_STATED]), across=True
    )


def _motors(chain: StageChain, point: Point) -> str:
    """Return the loads of both motors, that of the first stage first, in percent of their rated powers."""
    found = point.result.performance
    loads = (found[f"{name}_shaft_power"] / motor_of(scene).rated_power for name, scene in chain.by_stage.items())
    return "/".join(f"{100.0 * load:.0f}" for load in loads)


def stages_pressures_document(
    found: Sequence[AtPressure],
    speeds: Sequence[tuple[float, float]],
    figures: Callable[[Point], Mapping[str, Any]],
) -> list[dict[str, Any]]:
    """Return the points at outlet pressures for programs (SI units); `speeds` are those of the sheet's points."""
    both = {FULL: speeds[0], LOWEST: speeds[-1]}
    documents = pressures_document(found, figures)
    for each in documents:
        del each["bounded_by_motor"]
        for name in both.keys() & each.keys():
            first, second = both[name]
            each[name] = {"first_speed": first, "second_speed": second, **each[name]}
    return documents
