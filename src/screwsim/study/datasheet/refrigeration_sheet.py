"""The rating of a refrigeration machine as a sheet: its text, drawings and document.

A scene that sweeps these temperatures is rated at their values, another one at steps around its own point. Where a gas
cooler replaces the condenser, its pressure replaces the condensing temperature.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from screwsim.figures.engineering import shown_name
from screwsim.fluid.composition import is_blend
from screwsim.outputs.customary import ZERO_CELSIUS, with_printed_units
from screwsim.scene import Scene, conventions, value_at
from screwsim.scene.lines import lines
from screwsim.scene.operation import CONDENSING, EVAPORATING, GAS_COOLER_P
from screwsim.study.datasheet import machine_lines, tables
from screwsim.study.datasheet import rated as rating
from screwsim.study.datasheet.bearing_lives import LIFE_FIGURES, lives_table
from screwsim.study.datasheet.bounds import Limit
from screwsim.study.datasheet.columns import MIXTURE, NONE, Column, measured, outlet_temperatures, temperatures
from screwsim.study.datasheet.machine_lines import DUTY
from screwsim.study.datasheet.rated import Axis, Rating, RatingRequest, SceneRating, SceneRequest
from screwsim.study.datasheet.sheet import Curve, Drawing, Sheet, Table, disclaimer
from screwsim.study.datasheet.units import METRIC, Units
from screwsim.study.part_load import CONTROL_ENDS, RATIO_PATH, REFRIGERATION, controls, ratios
from screwsim.study.part_load import HEATING as BY_HEATING

CAPACITY, FLOW, DISCHARGE = "cooling_capacity", "gas_mass_flow", "discharge_temperature"
HEATING, HEATING_COPS = "heating_capacity", ("heating_cop", "electrical_heating_cop")
ECONOMIZER_FLOW, ECONOMIZER_T, ECONOMIZER_P = "economizer_mass_flow", "economizer_temperature", "economizer_pressure"
ECONOMIZER_GAIN = "economizer_capacity_gain"
SHAFT, ELECTRICAL = ("shaft_power", "cop"), ("electrical_power", "electrical_cop")
DEFAULT_CAPACITY = 1e5  # a capacity, where the scene's own point has none
TEMPERATURE_STEP = 5.0  # [K] between temperatures of a table
BELOW, ABOVE = 15.0, 10.0  # [K] around the scene's own temperatures: default range of a table
PRESSURE_SHARES = (0.85, 0.9, 0.95, 1.0, 1.05, 1.1)  # of a gas cooler's pressure
MOST_VALUES = 12  # values per axis of a table
DOCUMENT_FIGURES = (
    CAPACITY, *SHAFT, *ELECTRICAL, HEATING, *HEATING_COPS, FLOW, MIXTURE, DISCHARGE,
    "suction_pressure", "discharge_pressure", "volumetric_efficiency",
    "isentropic_efficiency", "peak_pressure", DUTY, "oil_flow_volume", "oil_supply_temperature", "oil_flow_ratio",
    "separator_temperature", ECONOMIZER_FLOW, ECONOMIZER_T, ECONOMIZER_P, ECONOMIZER_GAIN, *LIFE_FIGURES,
)  # fmt: skip
PEAK_FIGURES = MIXTURE, DISCHARGE, "discharge_pressure", "shaft_power"
DISCLAIMER = disclaimer("EN 12900 or AHRI 540")


def refrigeration_sheet(rated: SceneRating, heating: bool = False) -> Sheet:
    """Return the sheet of a rating; for a heat pump with the heat of its condenser."""
    scene = rated.asked.scene
    hot = "condensing temperature" if scene.operation.gas_cooler is None else "gas-cooler pressure"
    evaporating = "evaporating" if scene.operation.gas_cooler is None else "evaporating temperature"
    return Sheet(
        heading=f"Refrigeration compressor, rating by {evaporating} and {hot}",
        title=with_printed_units(scene.title),
        lines=list(_lines(rated, heating)),
        tables=list(tables_of(rated, heating)),
        notes=[*convention_notes(rated.asked), *tables.notes_of(rated, own_point(rated.asked), DISCLAIMER)],
        drawings=list(_drawings(rated)),
        document={
            "kind": "refrigeration",
            "title": scene.title,
            "refrigerant": scene.gas.name,
            "superheat": scene.operation.superheat,
            "subcooling": scene.operation.subcooling,
            **tables.document_of(rated, DOCUMENT_FIGURES, own_point(rated.in_metric.asked)),
        },
        ok=rated.ok,
    )


def _lines(rated: SceneRating, heating: bool) -> Iterator[tuple[str, str]]:
    scene, units = rated.asked.scene, rated.asked.units
    found = rated.own.performance if rated.own.status == "ok" else {}
    yield from machine_lines.machine_line(scene, found, units)
    yield refrigerant_line(rated.asked)
    yield "point", f"{own_point(rated.asked)}: {tables.point_in_words(rated, columns_of(rated))}"
    if heating and found:
        yield heating_line(rated)
    yield from _economizer_line(rated, found)
    yield from machine_lines.power_lines(scene, found, units)
    yield from machine_lines.oil_line(scene, found, units)
    yield from pressure_line(rated)
    yield from tables.limit_lines(rated, PEAK_FIGURES)
    yield from tables.control_line(rated)


def _economizer_line(rated: SceneRating, found: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield what an economizer's port draws at the scene's own point, and what it adds to the capacity."""
    if all(found.get(name) is not None for name in (ECONOMIZER_FLOW, ECONOMIZER_T, ECONOMIZER_P, ECONOMIZER_GAIN)):
        flow, temperature = economizer_columns(rated)
        at = f"{temperature.cell(found)} {temperature.unit}, {rated.asked.units.quantity('Pa', found[ECONOMIZER_P])}"
        gain = f"{100.0 * found[ECONOMIZER_GAIN]:.1f} % of the capacity without it"
        yield "economizer", f"{flow.cell(found)} {flow.unit} at {at}; it adds {gain}"


def refrigerant_line(asked: RatingRequest) -> tuple[str, str]:
    """Return the refrigerant, its state at the inlet, and its subcooling behind the last machine."""
    cold, hot, name = asked.scenes[0].operation, asked.scenes[-1].operation, asked.scenes[0].gas.name
    quality, T = cold.suction.quality, cold.suction.temperature
    superheat = cold.superheat if cold.suction.superheat is None else cold.suction.superheat
    suction = f"superheat {asked.units.difference(superheat or 0.0)}"
    if quality is not None or T is not None:
        suction = f"suction gas of {asked.units.degrees(T)}" if T is not None else f"suction quality {quality:.4g}"
    below = f", subcooling {asked.units.difference(hot.subcooling or 0.0)}" if hot.gas_cooler is None else ""
    points = "; temperatures are dew points" if is_blend(name) else ""
    points = "; condensing temperatures are bubble points" if convention_notes(asked) else points
    return "refrigerant", f"{name}, {suction}{below}{points}"


def convention_notes(asked: RatingRequest) -> list[str]:
    """Return that the condensing temperatures are not those of EN 12900 and AHRI 540; nothing where they are."""
    other = conventions.of_scene(asked.scenes[-1])
    return [other] if other else []


def heating_line(rated: Rating[Any]) -> tuple[str, str]:
    """Return the heat of the condenser at the own point, and its COP."""
    heat, cop = heating_columns(rated)
    capacity, cop = f"{heat.cell(rated.own.performance)} {heat.unit}", cop.cell(rated.own.performance)
    coolers = ", without the oil cooler" if len(rated.asked.scenes) == 1 else ", without the oil coolers"
    oiled = any(scene.oil_supply is not None for scene in rated.asked.scenes)
    where = "condenser" if rated.asked.scenes[-1].operation.gas_cooler is None else "gas cooler"
    return "heating", f"{capacity} from the {where}{coolers if oiled else ''}; COP {cop}"


def _drawings(rated: SceneRating) -> Iterator[Drawing]:
    asked, columns = rated.asked, columns_of(rated)
    yield from tables.drawings_over_across(rated, (columns[0], columns[2]))
    best = heating_columns(rated)[1] if rated.asked.aim == BY_HEATING else columns[2]
    yield from tables.part_load_drawing(rated, best, f"Part load: {best.title}")
    if len(rated.reach) > 1 and asked.down.path == CONDENSING:
        corners = [(each.at, each.low) for each in rated.reach]
        corners += [(each.at, each.high) for each in reversed(rated.reach)] + corners[:1]
        units = asked.units
        x, y = ([units.temperature(corner[k]) for corner in corners] for k in (0, 1))
        title = f"Envelope: condensing temperature [{units.degree}]"
        yield Drawing(title, f"evaporating temperature [{units.degree}]", title, [Curve(x, y)])


def rating_request(
    scene: Scene,
    evaporating: str | None,
    condensing: str | None,
    bounds: Mapping[Limit, str],
    units: Units = METRIC,
    heating: bool = False,
) -> SceneRequest:
    """Return what is rated of a scene; raise UsageError where it varies something else, or a range is invalid.

    Part loads are shares of the cooling capacity, with `heating` of the heating capacity.
    """
    second = GAS_COOLER_P if scene.operation.gas_cooler is not None else CONDENSING
    over = f"{EVAPORATING}, {second} and controls of the capacity"
    base = rating.base_of(scene, {EVAPORATING, second, RATIO_PATH, *CONTROL_ENDS}, over)
    across = axis_values(base, EVAPORATING, evaporating, "--evaporating", rating.swept_values(scene, EVAPORATING))
    down = axis_values(base, second, condensing, "--condensing", rating.swept_values(scene, second))
    aim = BY_HEATING if heating else REFRIGERATION
    varied = {"controls": controls(scene), "ratios": ratios(scene), "units": units}
    return SceneRequest(scenes=(base,), across=across, down=down, bounds=bounds, aim=aim, **varied)


def axis_values(base: Scene, path: str, text: str | None, option: str, swept: tuple[float, ...]) -> Axis:
    """Return an axis: over a range or list, at swept values [SI], or around the scene's own one; raise UsageError."""
    if text is not None:
        example = "-10 degC..10 degC" if path != GAS_COOLER_P else "80 bar..110 bar"
        count = len(PRESSURE_SHARES) if path == GAS_COOLER_P else _count_of_range
        return Axis(path, rating.read_values(base, path, text, option, example, count))
    if swept:
        return Axis(path, swept)
    own = float(value_at(base, path))
    if path == GAS_COOLER_P:
        return Axis(path, tuple(own * share for share in PRESSURE_SHARES))
    middle = TEMPERATURE_STEP * round((own - ZERO_CELSIUS) / TEMPERATURE_STEP) + ZERO_CELSIUS
    steps = range(-round(BELOW / TEMPERATURE_STEP), round(ABOVE / TEMPERATURE_STEP) + 1)
    values = [middle + TEMPERATURE_STEP * i for i in steps]
    return Axis(path, tuple(value for value in values if not rating.faults_of(base, {path: value})) or (own,))


def _count_of_range(first: float, last: float) -> int:
    """Return how many temperatures a range [K] has."""
    return min(max(round((last - first) / TEMPERATURE_STEP) + 1, 2), MOST_VALUES)


def own_point(asked: RatingRequest) -> str:
    """Return the own point in words, of one machine or of two in series: both saturation temperatures, as stated."""
    cold, hot = asked.scenes[0].operation, asked.scenes[-1].operation
    units = asked.units
    inlet = tables.inlet_in_words(asked.scenes[0], units)
    if cold.evaporating_temperature is not None:
        inlet = units.degrees(cold.evaporating_temperature)
    if hot.gas_cooler is not None:
        cooler, leaves = hot.gas_cooler, units.degrees(hot.gas_cooler.outlet_temperature)
        return f"{inlet} and a gas cooler at {units.quantity('Pa', cooler.pressure)} that leaves {leaves}"
    if hot.condensing_temperature is not None:
        return f"{inlet} / {units.degrees(hot.condensing_temperature)}"
    return f"{inlet} to {units.quantity('Pa', lines(asked.scenes[-1]).p_d)}"


def columns_of(rated: SceneRating) -> tuple[Column, ...]:
    """Return the columns with a table each: capacity, power, COP, flow, discharge temperature, oil, economizer."""
    own, units = rated.own.performance, rated.asked.units
    size = own.get(CAPACITY) or DEFAULT_CAPACITY
    duty = (
        (measured(DUTY, "Oil cooler duty", units.heat, size),) if machine_lines.is_oil_cooled(rated.asked.scene) else ()
    )
    return (
        *main_columns(rated, size),
        measured(FLOW, "Mass flow", units.mass_flow, own.get(FLOW) or 1.0),
        outlet_temperatures(own, rated.asked.scene.oil_supply is not None, "Discharge", units)[0],
        *duty,
        *economizer_columns(rated),
    )


def main_columns(rated: Rating[Any], size: float) -> tuple[Column, Column, Column]:
    """Return the columns of capacity, power (of a `size` [W]) and COP, of the motors' power where all have one."""
    units, own = rated.asked.units, rated.own.performance.get(CAPACITY) or DEFAULT_CAPACITY
    power, cop = ELECTRICAL if rated.asked.has_motors else SHAFT
    word = "Electrical power" if power in ELECTRICAL else "Shaft power"
    capacity = measured(CAPACITY, "Cooling capacity", units.cooling, own)
    return capacity, measured(power, word, units.power, size), Column(cop, f"COP of the {word.lower()}", 1.0, 2)


def economizer_columns(rated: SceneRating) -> tuple[Column, ...]:
    """Return the additional columns of a machine with an economizer: what its port draws, and at which temperature."""
    own = rated.own.performance
    if own.get(ECONOMIZER_FLOW) is None:
        return ()
    units = rated.asked.units
    flow = measured(ECONOMIZER_FLOW, "Economizer mass flow", units.mass_flow, own[ECONOMIZER_FLOW])
    return flow, temperatures(ECONOMIZER_T, "Economizer temperature", units)


def heating_columns(rated: Rating[Any]) -> tuple[Column, Column]:
    """Return the additional columns of a heat pump: heating capacity, and its COP on the same power."""
    own = rated.own.performance.get(HEATING) or DEFAULT_CAPACITY
    motors = rated.asked.has_motors
    cop = f"COP of heating, of the {'electrical' if motors else 'shaft'} power"
    return measured(HEATING, "Heating capacity", rated.asked.units.heat, own), Column(HEATING_COPS[motors], cop, 1.0, 2)


def tables_of(rated: SceneRating, heating: bool) -> Iterator[Table]:
    """Yield all tables of the sheet, with those of heating where requested."""
    columns = columns_of(rated)
    yield from tables.tables_of(rated, (*columns, *heating_columns(rated)) if heating else columns)
    cooled = rated.asked.down.path == GAS_COOLER_P
    yield from tables.envelope_table(rated, "pressure of the gas cooler" if cooled else "")
    yield from lives_table(*tables.points_within_limits(rated, own_point(rated.asked)), units=rated.asked.units)
    load = f"{shown_name(rated.asked.aim.load)} relative to that of the scene itself, at {own_point(rated.asked)}"
    discharge = (f"discharge {columns[4].unit}", columns[4])
    main = part_load_columns(rated, columns)
    note = tables.part_load_note(rated, load, "COP")
    yield from tables.part_load_table(rated, main, (discharge,), note, "COP there")


def pressure_line(rated: SceneRating) -> Iterator[tuple[str, str]]:
    """Yield both lines' absolute pressures over the axes, as points that closed tell them."""
    asked, unit = rated.asked, rated.asked.units.pressure
    sides = [("suction", asked.across, 0)]
    sides += [("discharge", asked.down, 1)] if asked.down.path != GAS_COOLER_P else []
    words = []
    for side, axis, place in sides:
        found = [_told_at(rated, place, k, f"{side}_pressure") for k in range(len(axis.values))]
        values = ", ".join(NONE if p is None else f"{unit.factor * p:#.4g}" for p in found)
        words.append(f"{side} {values} {unit.unit}")
    yield "pressures", f"{'; '.join(words)}: absolute, in the order of the tables"


def _told_at(rated: SceneRating, place: int, k: int, figure: str) -> float | None:
    """Return a figure of the first point that closed at value k of an axis (`place` 0: across, 1: down)."""
    closed = (each.performance for at, each in rated.points.items() if at[place] == k and each.status == "ok")
    return next((found.get(figure) for found in closed), None)


def part_load_columns(rated: Rating[Any], columns: Sequence[Column]) -> tuple[Column, Column, Column]:
    """Return the main columns at part load: capacity, power and COP, of heating where loads are those of heating."""
    capacity, power, cop = columns[:3]
    if rated.asked.aim != BY_HEATING:
        return capacity, power, cop
    heat, heating_cop = heating_columns(rated)
    return heat, power, heating_cop
