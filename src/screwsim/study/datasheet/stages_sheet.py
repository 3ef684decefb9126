"""The sheet of two stages over two axes: refrigeration by both saturation temperatures, other gases by both pressures.

Tables, envelope, limits, part load, drawings and the document are those of `tables`. What is special to two stages is
the table of the intermediate pressure; and, as on sheets of air, a table of each stage's figures, the line between
them, and their motors.
"""

from collections.abc import Iterator, Sequence
from math import sqrt
from typing import Any

import numpy as np

from screwsim.figures import rotor_speed
from screwsim.figures.engineering import shown_name
from screwsim.numerics.parabola import summit
from screwsim.outputs import Result
from screwsim.outputs.customary import HOUR, MINUTE, RPM, with_printed_units
from screwsim.scene import Scene
from screwsim.scene.lines import lines
from screwsim.study.datasheet import gas_sheet, machine_lines, refrigeration_sheet, tables
from screwsim.study.datasheet.bearing_lives import LIFE_FIGURES, TITLE, lives_table
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.columns import BAR, KW, MIXTURE, NONE, PERCENT, Column, decimals_of, in_units
from screwsim.study.datasheet.machine_lines import DUTY, Lines
from screwsim.study.datasheet.marks import BLANK
from screwsim.study.datasheet.refrigeration_sheet import own_point
from screwsim.study.datasheet.sheet import Drawing, Sheet, Table
from screwsim.study.datasheet.stages_rating import ChainRating, refrigerates
from screwsim.study.datasheet.units import Units
from screwsim.study.stages import ChainResult
from screwsim.study.stages.axes import BATHES, COOLS, FLASHES, NOTHING, STAGE_NAMES
from screwsim.study.stages.chain import StageChain

CAPACITY, FLOW, INTERMEDIATE = "cooling_capacity", "gas_mass_flow", "intermediate_pressure"
DISCHARGES = "first_discharge_temperature", "discharge_temperature"
DUTIES = "first_oil_cooler_duty", "second_oil_cooler_duty"
DOCUMENT_FIGURES = (
    CAPACITY, "shaft_power", "cop", "electrical_power", "electrical_cop", "heating_capacity", "heating_cop",
    "electrical_heating_cop", FLOW, INTERMEDIATE, "intermediate_temperature", "second_suction_temperature",
    "intercooler_heat", "vapour_mass_flow", "first_shaft_power", "second_shaft_power", "first_pressure_ratio",
    "second_pressure_ratio", *DISCHARGES, "first_separator_temperature", "second_separator_temperature", *DUTIES,
    "isothermal_efficiency", "isentropic_efficiency", "free_air_delivered", "package_input_power",
    "package_specific_power", "package_isentropic_efficiency",
)  # fmt: skip
INTERMEDIATE_COLUMN = Column(INTERMEDIATE, "between bar", BAR, 3)  # its title is its head
PEAK_FIGURES = (*DISCHARGES, "first_shaft_power", "second_shaft_power")
EACH_STAGE = (  # figures of a stage, a row each
    Column("displacement_flow", "swept volume [m³/h]", HOUR, 1),
    Column("suction_pressure", "suction pressure [bar]", BAR, 3),
    Column("suction_temperature", "suction temperature [°C]", 1.0, 1, celsius=True),
    Column("discharge_pressure", "discharge pressure [bar]", BAR, 3),
    Column("pressure_ratio", "pressure ratio", 1.0, 2),
    Column("gas_mass_flow", "mass flow [kg/h]", HOUR, 0),
    Column("shaft_power", "shaft power [kW]", KW, 2),
    Column("electrical_power", "electrical power [kW]", KW, 2),
    Column("volumetric_efficiency", "volumetric efficiency [%]", PERCENT, 1),
    Column("isentropic_efficiency", "isentropic efficiency [%]", PERCENT, 1),
    Column(MIXTURE, "discharge of gas and oil [°C]", 1.0, 1, celsius=True),
    Column("discharge_temperature", "discharge of the gas alone [°C]", 1.0, 1, celsius=True),
    Column("separator_temperature", "separator temperature [°C]", 1.0, 1, celsius=True),
    Column("oil_flow_volume", "oil [L/min]", 1e3 * MINUTE, 1),
    Column("oil_supply_temperature", "oil temperature [°C]", 1.0, 1, celsius=True),
    Column(DUTY, "oil cooler duty [kW]", KW, 2),
)
BETWEEN = {
    NOTHING: "no cooler",
    COOLS: "a cooler",
    FLASHES: "a flash tank, whose vapour mixes in",
    BATHES: "a flash intercooler, which the gas leaves saturated",
}
STAGE_FIGURES = (*(column.figure for column in EACH_STAGE), *LIFE_FIGURES)


def stages_sheet(rated: ChainRating, heating: bool = False) -> Sheet:
    """Return the sheet of a rating; of a heat pump with the heat of its condenser."""
    chain, cold = rated.asked.chain, refrigerates(rated.asked.chain)
    kind = "Two-stage refrigeration compressors" if cold else "Two-stage gas compressors"
    disclaimer = refrigeration_sheet.DISCLAIMER if cold else gas_sheet.DISCLAIMER
    told = tables.notes_of(rated, own_point(rated.asked), disclaimer)
    notes = [*ignored_model_errors(chain), *refrigeration_sheet.convention_notes(rated.asked), *told]
    return Sheet(
        heading=f"{kind}, rating by {' and '.join(rated.asked.axes_in_words)}",
        title=with_printed_units(chain.title),
        lines=list(_lines(rated, heating)),
        tables=list(_tables(rated, heating)),
        notes=notes,
        drawings=list(_drawings(rated)),
        document=_document(rated),
        ok=rated.ok,
    )


def _lines(rated: ChainRating, heating: bool) -> Iterator[tuple[str, str]]:
    chain, units = rated.asked.chain, rated.asked.units
    yield from swept_line(rated.both, units)
    yield refrigeration_sheet.refrigerant_line(rated.asked) if refrigerates(chain) else ("gas", chain.first.gas.name)
    yield from between_line(chain, rated.own, units)
    yield "point", f"{own_point(rated.asked)}: {_point(rated)}"
    if heating and rated.own.status == "ok":
        yield refrigeration_sheet.heating_line(rated)
    yield from motor_lines(chain, rated.both, units)
    yield from tables.limit_lines(rated, PEAK_FIGURES)
    yield from tables.control_line(rated)


def _point(rated: ChainRating) -> str:
    columns, found = _columns(rated), rated.own.performance
    mass, unit = (column.unit for column in columns[:2])
    if refrigerates(rated.asked.chain) or rated.own.status != "ok":
        return tables.point_in_words(rated, columns)
    flow, power, best = (column.cell(found) for column in columns[:3])
    return f"{flow} {mass}, {power} {unit} of {tables.power_in_words(columns)}, η_s {best} %"


def _columns(rated: ChainRating) -> tuple[Column, ...]:
    """Return the columns with a table each; the first three are capacity (or flow), power, COP (or efficiency)."""
    own, cold, units = rated.own.performance, refrigerates(rated.asked.chain), rated.asked.units
    kw = decimals_of(KW * (own.get("shaft_power") or 1e5))
    mass = Column(FLOW, "Mass flow into the first stage [kg/h]", HOUR, decimals_of(HOUR * (own.get(FLOW) or 1.0)))
    capacity, power, cop = refrigeration_sheet.main_columns(rated, own.get("shaft_power") or 1e5)
    efficiency = Column("isentropic_efficiency", "Isentropic efficiency of the shaft power [%]", PERCENT, 1)
    mass = in_units(mass, units)
    head = (capacity, power, cop) if cold else (mass, power, efficiency)
    rest = [Column(INTERMEDIATE, "Intermediate pressure [bar]", BAR, 3)]
    rest += [mass] if cold else []
    for which in STAGE_NAMES:
        rest.append(Column(f"{which}_shaft_power", f"Shaft power of the {which} stage [kW]", KW, kw))
    for which, figure in zip(STAGE_NAMES, DISCHARGES, strict=True):
        rest.append(Column(figure, f"Discharge temperature of the {which} stage [°C]", 1.0, 1, celsius=True))
    cooled = zip(STAGE_NAMES, DUTIES, rated.asked.scenes, strict=True)
    for which, figure, scene in cooled:
        if machine_lines.is_oil_cooled(scene) or abs(own.get(figure) or 0.0) > 0.0:
            rest.append(Column(figure, f"Oil cooler duty of the {which} stage [kW]", KW, kw))
    return (*head, *(in_units(column, units) for column in rest))


def _tables(rated: ChainRating, heating: bool) -> Iterator[Table]:
    columns, own, units = _columns(rated), own_point(rated.asked), rated.asked.units
    yield from each_stage_table(rated.both, f"Each stage at {own}", units)
    yield from stage_lives_tables([(own, rated.both)], units)
    more = refrigeration_sheet.heating_columns(rated) if heating else ()
    yield from tables.tables_of(rated, (*columns, *more))
    yield from tables.envelope_table(rated)
    what = shown_name(rated.asked.aim.load).removeprefix("gas ")
    note = f"load: {what} relative to that at {own}; setting: share of the speeds of both stages"
    between = in_units(INTERMEDIATE_COLUMN, units)
    discharge = (f"discharge {units.degree}", Column(DISCHARGES[1], "", 1.0, 1, True, units))
    main = refrigeration_sheet.part_load_columns(rated, columns)
    yield from tables.part_load_table(rated, main, ((between.title, between), discharge), note)
    yield from _intermediate_table(rated, columns)


def _intermediate_table(rated: ChainRating, columns: tuple[Column, ...]) -> Iterator[Table]:
    """Yield how the intermediate pressure and the efficiency depend on the speed of the second stage."""
    speed = rated.asked.chain.second.operation.speed / RPM
    between = in_units(INTERMEDIATE_COLUMN, rated.asked.units)
    heads, shown = zip((between.title, between), *tables.main_heads(rated, columns), strict=True)
    rows = [
        [f"{speed * share:.0f}", f"{PERCENT * share:.0f}", *(column.cell(one.performance) for column in shown)]
        for share, one in rated.by_second
    ]
    if rows:
        title, note = "Intermediate pressure by the speed of the second stage", _best_note(rated, columns[2])
        yield Table(title, ("second stage rpm", "% of its speed", *heads), rows, note)


def _best_note(rated: ChainRating, best: Column) -> str:
    """Return where the best figure lies, from a parabola through the largest one and its neighbours."""
    found = best_intermediate(rated.by_second, best.figure)
    if found is None:
        return ""
    p, value, inside = found
    word, unit = ("COP", "") if refrigerates(rated.asked.chain) else ("η_s", " %")
    where = "at" if inside else "at the end of the table,"
    shown = f"{best.factor * value:.{best.decimals}f}{unit}"
    return f"best {word} {shown} {where} {rated.asked.units.quantity('Pa', p)} between the stages"


def best_intermediate(by_second: Any, figure: str) -> tuple[float, float, bool] | None:
    """Return intermediate pressure [Pa] and value of the largest figure, and whether it lies within what was tried.

    A parabola in ln p through the largest value and its neighbours; None with fewer than three points.
    """
    good = [one.performance for _, one in by_second if one.status == "ok" and one.performance.get(figure) is not None]
    good = sorted((float(np.log(each[INTERMEDIATE])), float(each[figure])) for each in good)
    if len(good) < 3:
        return None
    k = max(range(len(good)), key=lambda i: good[i][1])
    if k in (0, len(good) - 1):
        return float(np.exp(good[k][0])), good[k][1], False
    at, value = summit(*zip(*good[k - 1 : k + 2], strict=True))
    return float(np.exp(at)), value, True


def _drawings(rated: ChainRating) -> Iterator[Drawing]:
    columns = _columns(rated)
    yield from tables.drawings_over_across(rated, (columns[0], columns[2], columns[3]))
    yield from tables.part_load_drawing(rated, columns[2], f"Part load: {columns[2].title}")


def _document(rated: ChainRating) -> dict[str, Any]:
    chain = rated.asked.chain
    found = tables.document_of(rated, DOCUMENT_FIGURES, own_point(rated.in_metric.asked))
    by_second = [{"share": share, **tables.document_figures(one, DOCUMENT_FIGURES)} for share, one in rated.by_second]
    return {
        "kind": f"two_stage_{'refrigeration' if refrigerates(chain) else 'gas'}",
        "title": chain.title,
        "gas": chain.first.gas.name,
        **found,
        "own_point": own_document(rated.own),
        "stages": stage_documents(rated.both),
        "part_load_setting": "share of the speeds of both stages",
        "by_speed_of_second_stage": by_second,
    }


def each_stage_table(found: ChainResult, title: str, units: Units) -> Iterator[Table]:
    """Yield the table of both stages beside each other; nothing where they have no results."""
    if found.status != "ok":
        return
    figures = [each.performance for each in found.stages]
    shares = [_share_of_motor(scene, each) for scene, each in zip(found.scenes, found.stages, strict=True)]
    loads = ["" if share is None else f"{PERCENT * share:.0f}" for share in shares]
    speeds = (rotor_speed(each, scene.operation.speed) for each, scene in zip(figures, found.scenes, strict=True))
    rows = [["speed [rpm]", *(f"{speed / RPM:.0f}" for speed in speeds)]]
    for column in (in_units(each, units) for each in EACH_STAGE):
        if any(column.figure in each for each in figures):
            rows.append([column.title, *(column.cell(each) for each in figures)])
        if column.figure == "electrical_power" and any(loads):
            rows.append(["load of its motor [%]", *(load or NONE for load in loads)])
    yield Table(title, (BLANK, *(f"{name} stage" for name in STAGE_NAMES)), rows, left=1)


def stage_lives_tables(points: Sequence[tuple[str, ChainResult]], units: Units) -> Iterator[Table]:
    """Yield the table of the bearings of each stage over points (name, result), of which the first is the own one."""
    if points[0][1].status != "ok":
        return
    closed = [(where, found.stages) for where, found in points if found.status == "ok"]
    for k, name in enumerate(STAGE_NAMES):
        title = f"{TITLE} of the {name} stage"
        yield from lives_table([(where, stages[k]) for where, stages in closed], title=title, units=units)


def _share_of_motor(scene: Scene, found: Result) -> float | None:
    motor = motor_of(scene)
    return None if motor is None else found.performance.shaft_power / motor.rated_power


def between_line(chain: StageChain, found: Result, units: Units) -> Lines:
    """Yield what lies between both stages, and the pressure there beside the geometric mean of both ends."""
    between, p = chain.intercooler, found.performance.get("intermediate_pressure")
    words = BETWEEN[between.kind]
    if between.outlet_temperature is not None:
        words += f" to {units.degrees(between.outlet_temperature)}"
    if between.pressure_drop > 0.0:
        words += f", pressure drop {units.pressure_difference(between.pressure_drop)}"
    if p is not None:
        T = found.performance.get("intermediate_temperature")
        at = "" if T is None else f" ({units.degrees(T, '.1f')})"
        mean = sqrt(lines(chain.first).p_s * lines(chain.second).p_d)
        words += f"; {units.quantity('Pa', p)}{at}, geometric mean of both ends {units.quantity('Pa', mean)}"
        heat = found.performance.get("intercooler_heat")
        factor, unit = units.heat
        words += f"; the cooler takes {factor * heat:.1f} {unit}" if between.cools and heat is not None else ""
    yield "between", words


def motor_lines(chain: StageChain, found: ChainResult, units: Units) -> Lines:
    """Yield the rating of each motor, and its load at the own point."""
    solved = [(scene, each.performance) for scene, each in zip(found.scenes, found.stages, strict=False)]
    parts = []
    for number, (name, scene) in enumerate(chain.by_stage.items()):
        motor = motor_of(scene)
        if motor is not None:
            load = machine_lines.load_at_point(*solved[number]) if number < len(solved) else ""
            parts.append(f"{name} stage {units.quantity('W', motor.rated_power)} rated at the shaft{load}")
    if parts:
        yield "motors", "; ".join(parts)


def swept_line(found: ChainResult, units: Units) -> Lines:
    """Yield the swept volume and the speed of each stage."""
    if len(found.scenes) == len(found.stages) and found.stages:
        swept = (units.quantity("m3 s-1", each.performance["displacement_flow"]) for each in found.stages)
        pairs = zip(found.stages, found.scenes, strict=True)
        speeds = (rotor_speed(each.performance, scene.operation.speed) for each, scene in pairs)
        parts = zip(STAGE_NAMES, swept, (f"{speed / RPM:.4g} rpm" for speed in speeds), strict=True)
        yield "stages", ", ".join(f"{name} {volume} swept at {speed}" for name, volume, speed in parts)


def stage_documents(found: ChainResult) -> list[dict[str, Any]]:
    """Return the figures of each stage [SI] for programs, with their estimated errors."""
    return [own_document(each, STAGE_FIGURES) for each in found.stages]


def own_document(found: Result, names: Sequence[str] = DOCUMENT_FIGURES) -> dict[str, Any]:
    """Return figures [SI] at the own point for programs, by default those of the whole, with their estimated errors."""
    errors = {name: found.error[name] for name in names if found.error.get(name) is not None}
    return {**tables.document_figures(found, names), "error": errors}


def ignored_model_errors(chain: StageChain) -> Iterator[str]:
    """Yield a note where a scene names the validation of its model, which does not hold for two stages together."""
    for name, scene in chain.by_stage.items():
        if scene.model_error:
            yield f"the model error of the {name} scene is ignored (screwsim run of that scene shows it)"
