"""Two stages of air as a package, rated by ISO 1217: its points, and the sheet in the form of single packages.

A two-stage file that sweeps the speed of one stage, or of both together (`zip`), is rated at these speeds, from full to
lowest flow; another one has fixed speed. Free air, input and specific power are those of M203.
"""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from screwsim.build import package_of
from screwsim.figures import rotor_speed
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.customary import RPM, with_printed_units
from screwsim.scene import grid
from screwsim.scene.lines import lines
from screwsim.scene.operation import SPEED
from screwsim.study.datasheet import air_sheet, stages_sheet
from screwsim.study.datasheet.air_points import Point, heads_of, point_row
from screwsim.study.datasheet.air_pressures import named, read_pressures
from screwsim.study.datasheet.air_rating import Rating, control_of
from screwsim.study.datasheet.air_year import Demand, year, year_document, year_table
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.columns import BAR, KW, NONE, Column, in_units
from screwsim.study.datasheet.load_unload import Receiver, check_receiver
from screwsim.study.datasheet.rated import Part, answers_of
from screwsim.study.datasheet.sheet import Sheet, Table
from screwsim.study.datasheet.stages_carried import SPEEDS, Pair, carried_stages
from screwsim.study.datasheet.stages_pressures import (
    stages_at_pressures,
    stages_pressures_document,
    stages_pressures_table,
)
from screwsim.study.datasheet.units import Units
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED
from screwsim.study.stages import ChainResult
from screwsim.study.stages.axes import STAGE_NAMES
from screwsim.study.stages.chain import StageChain
from screwsim.study.sweep.stages import solved_with

STAGE_HEADS = (
    Column("intermediate_pressure", "between bar", BAR, 3),
    Column("first_shaft_power", "first kW", KW, 1),
    Column("second_shaft_power", "second kW", KW, 1),
    Column("first_discharge_temperature", "first °C", 1.0, 1, celsius=True),
    Column("discharge_temperature", "second °C", 1.0, 1, celsius=True),
    Column("first_oil_cooler_duty", "first oil kW", KW, 1),
    Column("second_oil_cooler_duty", "second oil kW", KW, 1),
)
NO_VERDICT = "10 CFR 431.345 is not applied to two stages, and zero flow is not simulated for them"


def is_air_package(chain: StageChain) -> bool:
    """Return whether two stages compress air, and both state a motor."""
    return chain.first.gas.is_air and all(map(motor_of, chain.by_stage.values()))


def air_stages_sheet(
    chain: StageChain,
    demands: Sequence[Demand],
    receiver: Receiver | None,
    jobs: int | None,
    progress: Progress | None,
    units: Units,
    pressures: str | None = None,
) -> Sheet:
    """Return the sheet of two stages of air, with the energy of demands met from a receiver.

    `pressures` states other outlet pressures at which they are rated as well.
    Raises UsageError for axes other than speeds.
    """
    if receiver is not None:
        check_receiver(receiver, lines(chain.first).p_s, lines(chain.second).p_d)
    outlets = read_pressures(chain.second, lines(chain.first).p_s, pressures)
    own, found = _rated(chain, jobs, progress)
    others = stages_at_pressures(grid.without_sweep(chain), outlets, own, jobs, progress)
    own, found, beyond = _bounded(chain, own, found)
    speeds = [_reached(each, result) for each, result in zip(own, found, strict=True)]
    points = [Point(both[0], each.as_result()) for both, each in zip(speeds, found, strict=True)]
    control = None if receiver is None else control_of(receiver, lines(chain.first), points)
    rated = Rating(points, None, None, len(points) > 1, "", units=units, receiver=receiver, control=control)
    shares = year(rated, demands) if demands else ()
    heads = ("first rpm", "second rpm", *heads_of(units)[1:])
    rows = [
        [*(f"{speed / RPM:.0f}" for speed in both), *point_row(point, rated.full, units)[1:]]
        for both, point in zip(speeds, points, strict=True)
    ]
    beside = list(named([each.at for each in others], lines(chain.first).p_s, units))
    at_others = {"pressures": stages_pressures_document(others, speeds, _figures)} if others else {}
    profile = {"profile": year_document(shares, receiver)} if shares else {}
    at_pressures = [stages_pressures_table(chain, others, speeds, units)] if others else []
    tables = [Table("Points", heads, rows, across=True), *at_pressures, *_stage_tables(speeds, points, found, units)]
    return Sheet(
        heading="Two-stage air package, rating by ISO 1217",
        title=with_printed_units(chain.title),
        lines=list(_lines(chain, rated, found[0], beyond)),
        tables=[*tables, *([year_table(rated, shares, [*map(motor_of, chain.by_stage.values())])] if shares else [])],
        notes=list(_notes(chain, [*zip(_names(speeds), points, strict=True), *beside])),
        drawings=list(air_sheet.drawings_of(rated)),
        document={**_document(chain, speeds, rated, found, beyond is not None), **at_others, **profile},
        ok=all(point.ok for point in [*points, *(point for _, point in beside)]),
    )


def _rated(
    chain: StageChain, jobs: int | None, progress: Progress | None
) -> tuple[list[tuple[float, float]], list[ChainResult]]:
    """Return the speeds [rad/s] of both stages at each point, from the highest on, and the results there."""
    others = [name for name in chain.sweep if name not in SPEEDS]
    if others or len(grid.dimensions(chain)) > 1:
        name = others[0] if others else " and ".join(chain.sweep)
        raise UsageError(
            f"datasheet: two stages of air are rated at values of {' or '.join(SPEEDS)}, or of both in one group of "
            f"zip, but the file varies {name} (remove that axis, or compute its points with screwsim sweep)"
        )
    own = {f"{name}.{SPEED}": scene.operation.speed for name, scene in chain.by_stage.items()}
    cases = [{**own, **grid.case_values(chain, i)} for i in range(grid.case_count(chain))]
    cases.sort(key=lambda case: [-case[name] for name in SPEEDS])
    base, dead = grid.without_sweep(chain), ChainResult("failed", WORKER_DIED)
    found = answers_of([Part(partial(solved_with, base, case), dead) for case in cases], jobs, progress)
    return [(float(case[SPEEDS[0]]), float(case[SPEEDS[1]])) for case in cases], found


def _bounded(
    chain: StageChain, speeds: list[Pair], found: list[ChainResult]
) -> tuple[list[Pair], list[ChainResult], Pair | None]:
    """Return speeds and results from those on that both motors carry, and the highest of the sweep that they do not."""
    if len(speeds) < 2:
        return speeds, found, None
    ends, results = (speeds[0], speeds[-1]), (found[0], found[-1])
    carried = carried_stages(grid.without_sweep(chain), {}, ends, results)
    if carried is None:
        return speeds, found, None
    both, result = carried
    slower = [i for i, each in enumerate(speeds) if each < both]
    return [both, *(speeds[i] for i in slower)], [result, *(found[i] for i in slower)], speeds[0]


def _reached(own: tuple[float, float], found: ChainResult) -> tuple[float, float]:
    """Return the speeds [rad/s] of both stages' rotors: as set, or what a motor on the mains reaches."""
    reached = [rotor_speed(each.performance, speed) for each, speed in zip(found.stages, own, strict=False)]
    first, second = (*reached, *own[len(reached) :])
    return first, second


def _stage_tables(
    speeds: Sequence[tuple[float, float]], points: Sequence[Point], found: Sequence[ChainResult], units: Units
) -> Iterator[Table]:
    """Yield the table of both stages at full flow, and at variable speed their figures at each point."""
    yield from stages_sheet.each_stage_table(found[0], "Each stage at full flow", units)
    yield from stages_sheet.stage_lives_tables(list(zip(_names(speeds), found, strict=True)), units)
    if len(points) > 1:
        columns = [
            in_units(column, units) for column in STAGE_HEADS if any(column.figure in one.performance for one in found)
        ]
        rows = []
        for own, point in zip(speeds, points, strict=True):
            cells = [column.cell(point.result.performance) if point.ok else NONE for column in columns]
            rows.append([*(f"{speed / RPM:.0f}" for speed in own), *cells])
        heads = ("first rpm", "second rpm", *(column.title for column in columns))
        note = "powers at the shafts, temperatures at discharge, heat in the oil coolers"
        yield Table("Both stages at each point", heads, rows, note, across=True)


def _lines(chain: StageChain, rated: Rating, own: ChainResult, beyond: Pair | None) -> Iterator[tuple[str, str]]:
    low, high, units = lines(chain.first), lines(chain.second), rated.units
    speed = "fixed speed" if not rated.variable else f"variable speed, {len(rated.points)} points"
    yield "package", f"rotary, lubricated, two stages, {speed}"
    yield "inlet", f"{units.quantity('Pa', low.p_s)}, {units.degrees(low.T_s, '.1f')}, {chain.first.gas.name}"
    yield air_sheet.discharge_line(high.p_d, low.p_s, units)
    yield from stages_sheet.swept_line(own, units)
    yield from stages_sheet.between_line(chain, rated.full.result, units)
    yield from stages_sheet.motor_lines(chain, own, units)
    if beyond is not None:
        stated = " and ".join(f"{each / RPM:.0f}" for each in beyond)
        yield "speed", f"full flow at the highest speeds that both motors carry: {stated} rpm of the sweep overload one"
    fans = ((name, getattr(package_of(scene), "fan", None)) for name, scene in chain.by_stage.items())
    stated = [(name, fan) for name, fan in fans if fan is not None]
    parts = [f"{units.quantity('W', fan.power)}, {air_sheet.FAN_CONTROL[fan.control]}" for _, fan in stated]
    if len(stated) > 1:
        parts = [f"{name} scene {part}" for (name, _), part in zip(stated, parts, strict=True)]
    yield "fan", "; ".join(parts) if parts else "none stated by the scenes"
    if own.status == "ok":
        losses = [_loss(each, units) for each in own.stages]
        told = [f"{name} stage {loss}" for name, loss in zip(STAGE_NAMES, losses, strict=True) if loss]
        yield "losses", f"{', '.join(told)}, at full flow" if told else "none stated by the scenes"
        yield from _heat(chain, own, units)


def _heat(chain: StageChain, own: ChainResult, units: Units) -> Iterator[tuple[str, str]]:
    """Yield the heat of both stages at full flow, and the temperature at the outlet, where they are known."""
    stages = [each.performance for each in own.stages]
    heats, oil = (
        [each[name] for each in stages if each.get(name) is not None] for name in ("package_heat", "oil_cooler_duty")
    )
    factor, unit = units.heat
    if len(heats) == len(oil) == len(stages):
        beside = " beside the intercooler's" if chain.intercooler.kind == "cooler" else ""
        whole = f"{factor * sum(heats):.1f} {unit}{beside} at full flow"
        yield "heat", f"{whole}, {factor * sum(oil):.1f} {unit} of it in the oil coolers"
    if (T := stages[1].get("package_discharge_temperature")) is not None:
        yield "outlet", f"air at {units.degrees(T, '.1f')}"


def _loss(found: Result, units: Units) -> str:
    """Return the pressure losses of a stage's parts in words; empty where its scene names none."""
    before, behind = (found.performance.get(name) for name in ("intake_pressure_loss", "package_pressure_loss"))
    parts = ((before, "before"), (behind, "behind"))
    return " and ".join(f"{air_sheet.loss_in_words(loss, units)} {where} its machine" for loss, where in parts if loss)


def _names(speeds: Sequence[tuple[float, float]]) -> list[str]:
    return [f"{own[0] / RPM:.0f} and {own[1] / RPM:.0f} rpm" for own in speeds]


def _notes(chain: StageChain, points: Sequence[tuple[str, Point]]) -> Iterator[str]:
    yield from air_sheet.inlet_note(chain.first)
    yield from stages_sheet.ignored_model_errors(chain)
    yield from air_sheet.point_notes(points)
    yield NO_VERDICT
    yield air_sheet.DISCLAIMER


def _figures(point: Point) -> dict[str, Any]:
    return stages_sheet.own_document(point.result)


def _document(
    chain: StageChain, speeds: Sequence[Pair], rated: Rating, found: Sequence[ChainResult], bounded: bool
) -> dict[str, Any]:
    low, high = lines(chain.first), lines(chain.second)
    points = [
        {"first_speed": own[0], "second_speed": own[1], **_figures(point)}
        for own, point in zip(speeds, rated.points, strict=True)
    ]
    return {
        "kind": "two_stage_air_package",
        "title": chain.title,
        "speed": "variable" if rated.variable else "fixed",
        **({"bounded_by_motor": bounded} if rated.variable else {}),
        "inlet_pressure": low.p_s,
        "inlet_temperature": low.T_s,
        "discharge_pressure": high.p_d,
        "points": points,
        "stages": [stages_sheet.stage_documents(each) for each in found],
        "warnings": list(dict.fromkeys(text for point in rated.points for text in point.result.warnings)),
    }
