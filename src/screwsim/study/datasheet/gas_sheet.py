"""The rating of a gas compressor or an expander as a sheet: its axes, text, drawings and document.

The axes are suction and discharge pressure for a compressor, speed and outlet pressure for an expander. A scene that
sweeps these is rated at its values, another one at fixed shares of its own. An expander is rated over its inlet instead
of the speed where the scene sweeps that, or a range of it is requested.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from screwsim.fluid import constants
from screwsim.outputs.customary import quantity, with_printed_units
from screwsim.scene import Scene, value_at, with_values
from screwsim.scene.lines import lines
from screwsim.scene.operation import CONDENSING, EVAPORATING, P_D, P_S, SPEED
from screwsim.study.datasheet import machine_lines, tables
from screwsim.study.datasheet import rated as rating
from screwsim.study.datasheet.bearing_lives import LIFE_FIGURES, lives_table
from screwsim.study.datasheet.bounds import Limit
from screwsim.study.datasheet.columns import MIXTURE, PERCENT, Column, decimals_of, measured, outlet_temperatures
from screwsim.study.datasheet.machine_lines import DUTY
from screwsim.study.datasheet.rated import Axis, SceneRating, SceneRequest, pressure_ratio
from screwsim.study.datasheet.sheet import Drawing, Sheet, Table, disclaimer
from screwsim.study.datasheet.units import METRIC, Standard, Units
from screwsim.study.part_load import CONTROL_ENDS, GAS, RATIO_PATH, controls, ratios

FLOW, DISCHARGE = "gas_mass_flow", "discharge_temperature"
ISENTROPIC, FILLING = "isentropic_efficiency", "filling_factor"
ELECTRICAL_FIGURES = "electrical_power", "electrical_isentropic_efficiency"
DOCUMENT_FIGURES = (
    FLOW, "shaft_power", "output_power", *ELECTRICAL_FIGURES, ISENTROPIC, "volumetric_efficiency", FILLING, MIXTURE,
    DISCHARGE,
    "suction_pressure", "discharge_pressure", "pressure_ratio", "peak_pressure", DUTY, "oil_flow_volume",
    "oil_supply_temperature", "oil_flow_ratio", "separator_temperature", *LIFE_FIGURES,
)  # fmt: skip
PACKAGE_REMEDY = "a package with filter, cooler and fan is rated by ISO 1217 (name effects.air_package)"
WITHOUT_WATER = ", without the water of humid air"
DISCLAIMER = disclaimer("ISO 1217")
PRESSURE_SHARES = (0.8, 0.9, 1.0, 1.1, 1.2)  # of a compressor's own pressures
SPEED_SHARES = (0.4, 0.6, 0.8, 1.0, 1.2)  # of an expander's own speed
OUTLET_SHARES = (0.7, 0.85, 1.0, 1.2, 1.4)  # of its outlet pressure
INLET_SHARES = (0.7, 0.85, 1.0, 1.15)  # of its inlet pressure, where both pressures vary
EXAMPLES = {
    P_S: "4 bar..6 bar",
    P_D: "15 bar..25 bar",
    EVAPORATING: "80 degC..100 degC",
    CONDENSING: "30 degC..50 degC",
}
VALUES_PER_RANGE = 5  # values per range


def gas_sheet(rated: SceneRating) -> Sheet:
    """Return the sheet of a rating."""
    scene, expands = rated.asked.scene, _expands(rated)
    heading = f"{'Expander' if expands else 'Gas compressor'}, rating by {' and '.join(rated.asked.axes_in_words)}"
    meant = DISCLAIMER.replace("of ISO 1217 ", "") if expands else DISCLAIMER
    notes = [*tables.notes_of(rated, _own_point(rated), meant)]
    if not expands:
        standard = rated.asked.units.standard
        humid = WITHOUT_WATER if scene.gas.relative_humidity is not None else ""
        notes[-1:-1] = [
            f"{standard.flow.unit}: as an ideal gas at {standard.words}{humid}",
            *([PACKAGE_REMEDY] if scene.gas.is_air else []),
        ]
    return Sheet(
        heading=heading,
        title=with_printed_units(scene.title),
        lines=list(_lines(rated)),
        tables=list(_tables(rated)),
        notes=notes,
        drawings=list(_drawings(rated)),
        document=_document(rated),
        ok=rated.ok,
    )


def _expands(rated: SceneRating) -> bool:
    return rated.asked.scene.machine.expands


def standard_volume(scene: Scene, at: Standard) -> float:
    """Return the volume per mass [m³/kg] at standard conditions: R T/p of the ideal gas, of humid air without water."""
    return constants.gas_constant(scene.gas.name) * at.T / at.p


def dry_share(found: Mapping[str, Any]) -> float:
    """Return the share of the mass flow that is not water (M320); 1 but for humid air."""
    return 1.0 / (1.0 + (found.get("humidity_ratio") or 0.0))


class StandardFlow(Column):
    """A column of the standard volume flow of the gas without water; `factor` is that of a dry one."""

    def value(self, found: Mapping[str, Any]) -> float | None:
        """Return the flow among figures [SI], None where there is none."""
        wet = super().value(found)
        return None if wet is None else wet * dry_share(found)


def _own_point(rated: SceneRating) -> str:
    scene, units = rated.asked.scene, rated.asked.units
    what = f"{tables.inlet_in_words(scene, units)} to {units.quantity('Pa', lines(scene).p_d)}"
    return f"{what} at {quantity('rad s-1', scene.operation.speed)}" if _expands(rated) else what


def _lines(rated: SceneRating) -> Iterator[tuple[str, str]]:
    scene, units = rated.asked.scene, rated.asked.units
    found = rated.own.performance if rated.own.status == "ok" else {}
    yield from machine_lines.machine_line(scene, found, units)
    humidity = scene.gas.relative_humidity
    humid = "" if humidity is None else f", relative humidity {100.0 * humidity:.3g} %"
    yield "gas", f"{scene.gas.name}, {_temperature(scene, units)}{humid}"
    yield "point", f"{_own_point(rated)}: {_point(rated, found)}"
    yield from machine_lines.power_lines(scene, found, units, _expands(rated))
    yield from machine_lines.oil_line(scene, found, units)
    power = "output_power" if _expands(rated) else "shaft_power"
    yield from tables.limit_lines(rated, (power,) if _expands(rated) else (MIXTURE, DISCHARGE, power))
    if not _expands(rated):
        yield from tables.control_line(rated)


def _temperature(scene: Scene, units: Units) -> str:
    suction, superheat = scene.operation.suction, scene.operation.superheat
    superheat = suction.superheat if suction.superheat is not None else superheat
    if superheat is not None:
        return f"superheated by {units.difference(superheat)}"
    if suction.quality is not None:
        return f"vapour share {suction.quality:.4g} at the inlet"
    return f"{units.degrees(lines(scene).T_s)} at the inlet"


def _point(rated: SceneRating, found: Mapping[str, Any]) -> str:
    if not found:
        return rated.own.told
    flow, power, efficiency, filled, *_ = _columns(rated)
    words = [
        f"{flow.cell(found)} {flow.unit}",
        f"{power.cell(found)} {power.unit} {_power_words(rated)}",
        f"η_s {efficiency.cell(found)} %",
    ]
    if not _expands(rated):
        standard = _standard_flow(rated)
        words.insert(1, f"{standard.value(found):.5g} {standard.unit}")
        return ", ".join([*words, f"λ {filled.cell(found)} %"])
    return ", ".join([*words, f"filling factor {filled.cell(found)}"])


def _power_words(rated: SceneRating) -> str:
    electrical = rated.asked.has_motors
    if _expands(rated):
        return "of electrical power given" if electrical else "given at the shaft"
    return "of electrical power" if electrical else "at the shaft"


def _columns(rated: SceneRating) -> tuple[Column, ...]:
    """Return the columns with a table each; the first four are flow, power, efficiency and filling of the chambers."""
    scene, own, expands = rated.asked.scene, rated.own.performance, _expands(rated)
    electrical = rated.asked.has_motors
    units, size = rated.asked.units, abs(own.get("shaft_power") or 1e5)
    word = "electrical power" if electrical else "shaft power"
    what, sign = (f"{word} given" if expands else word), (-1.0 if expands else 1.0)
    power, efficiency = ELECTRICAL_FIGURES if electrical else ("shaft_power", ISENTROPIC)
    if expands:
        filled = Column(FILLING, "Filling factor", 1.0, 3)
    else:
        filled = Column("volumetric_efficiency", "Volumetric efficiency [%]", PERCENT, 1)
    columns = [
        measured(FLOW, "Mass flow", units.mass_flow, own.get(FLOW) or 1.0),
        measured(power, what.capitalize(), units.power._replace(factor=sign * units.power.factor), size),
        Column(efficiency, f"{'Electrical isentropic' if electrical else 'Isentropic'} efficiency [%]", PERCENT, 1),
        filled,
        *outlet_temperatures(own, scene.oil_supply is not None, "Outlet" if expands else "Discharge", units),
    ]
    if expands and "discharge_quality" in own:
        columns.append(Column("discharge_quality", "Outlet quality", 1.0, 3))
    if not expands:
        columns.append(_standard_flow(rated))
    if machine_lines.is_oil_cooled(scene):
        heat = units.heat._replace(factor=sign * units.heat.factor)  # an expander's oil is warmed
        columns.append(measured(DUTY, "Heat that warms the oil" if expands else "Oil cooler duty", heat, size))
    return tuple(columns)


def _standard_flow(rated: SceneRating) -> StandardFlow:
    """Return the column of the standard volume flow."""
    at, own = rated.asked.units.standard, rated.own.performance.get(FLOW) or 1.0
    factor = at.flow.factor * standard_volume(rated.asked.scene, at)
    return StandardFlow(FLOW, f"Flow [{at.flow.unit}]", factor, decimals_of(factor * own))


def _tables(rated: SceneRating) -> Iterator[Table]:
    columns = _columns(rated)
    yield from tables.tables_of(rated, columns)
    yield from tables.envelope_table(rated)
    yield from lives_table(*tables.points_within_limits(rated, _own_point(rated)), units=rated.asked.units)
    if _expands(rated):
        return
    load = f"mass flow relative to that of the scene itself, at {_own_point(rated)}"
    discharge = (f"discharge {columns[4].unit}", columns[4])
    note = tables.part_load_note(rated, load, "η_s")
    yield from tables.part_load_table(rated, columns, (discharge,), note, "η_s there")


def _drawings(rated: SceneRating) -> Iterator[Drawing]:
    asked = rated.asked
    columns = _columns(rated)
    below = list(enumerate(asked.down.values))
    rows = []
    for i, value in enumerate(asked.across.values):
        cases = ((with_values(asked.scene, {asked.across.path: value, asked.down.path: each}), j) for j, each in below)
        rows.append(
            (
                tables.shown_at(asked.across, value, asked.units),
                sorted((pressure_ratio(one), (i, j)) for one, j in cases),
            )
        )
    for column in (columns[1], columns[2]):
        yield from tables.drawing(rated, column, "pressure ratio", asked.sides[0], rows)
    title = columns[2].title
    yield from tables.part_load_drawing(rated, columns[2], f"Part load: {title[0].lower()}{title[1:]}")


def _document(rated: SceneRating) -> dict[str, Any]:
    scene = rated.asked.scene
    return {
        "kind": "expander" if _expands(rated) else "gas",
        "title": scene.title,
        "gas": scene.gas.name,
        "inlet_temperature": lines(scene).T_s,
        "pressure_ratio": pressure_ratio(scene),
        # m³ per kilogram at 0 °C and 1.01325 bar, as an ideal gas without water
        "normal_volume": standard_volume(scene, METRIC.standard) * dry_share(rated.own.performance),
        **tables.document_of(rated, DOCUMENT_FIGURES, _own_point(rated.in_metric)),
    }


def options_of(scene: Scene) -> dict[str, str]:
    """Return the options that state the range of a line's pressure or saturation temperature: option -> path."""
    if scene.operation.evaporating_temperature is not None:
        return {"--evaporating": EVAPORATING, "--condensing": CONDENSING}
    return {"--suction": P_S, "--discharge": P_D}


def rating_request(
    scene: Scene, ranges: Mapping[str, str | None], bounds: Mapping[Limit, str], units: Units = METRIC
) -> SceneRequest:
    """Return what is rated of a scene, given ranges of its lines' options; raise UsageError."""
    (first, inlet), (second, outlet) = options_of(scene).items()
    expands = scene.machine.expands
    beside = {SPEED, RATIO_PATH} if expands else {RATIO_PATH, *CONTROL_ENDS}
    over = f"{SPEED}, {inlet} and {outlet}" if expands else f"{inlet}, {outlet} and controls of the flow"
    base = rating.base_of(scene, {inlet, outlet, *beside}, over)
    if expands and ranges.get(first) is None and inlet not in scene.sweep:
        speeds = rating.swept_values(scene, SPEED) or tuple(share * base.operation.speed for share in SPEED_SHARES)
        across = Axis(SPEED, speeds)
    else:
        across = axis_values(base, inlet, ranges.get(first), first, rating.swept_values(scene, inlet))
    down = axis_values(base, outlet, ranges.get(second), second, rating.swept_values(scene, outlet))
    asked = SceneRequest(scenes=(base,), across=across, down=down, bounds=bounds, controls=(), aim=GAS, units=units)
    return asked if expands else replace(asked, controls=controls(scene), ratios=ratios(scene))


def axis_values(base: Scene, path: str, text: str | None, option: str, swept: tuple[float, ...]) -> Axis:
    """Return an axis: over a range or list, at swept values [SI], or around the scene's own one; raise UsageError."""
    if text is not None:
        return Axis(path, rating.read_values(base, path, text, option, EXAMPLES[path], VALUES_PER_RANGE))
    if swept:
        return Axis(path, swept)
    own = float(value_at(base, path))
    shares = PRESSURE_SHARES if not base.machine.expands else INLET_SHARES if path == P_S else OUTLET_SHARES
    every = [share * own for share in shares]
    if path in (EVAPORATING, CONDENSING):
        every = [own + 5.0 * step for step in (-2, -1, 0, 1, 2)]
    kept = tuple(value for value in every if not rating.faults_of(base, {path: value}))
    return Axis(path, kept or (own,))
