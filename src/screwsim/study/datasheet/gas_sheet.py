"""The rating of a gas compressor or an expander as a sheet: its text, drawings and document."""

from collections.abc import Iterator, Mapping
from typing import Any

from screwsim.figures.engineering import quantity
from screwsim.fluid import constants
from screwsim.outputs.customary import with_printed_units
from screwsim.scene import Scene
from screwsim.scene.lines import lines
from screwsim.scene.operation import EVAPORATING
from screwsim.scene.types import STANDARD_ATMOSPHERE
from screwsim.scene.units import ZERO_CELSIUS
from screwsim.study.datasheet import tables
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.gas import ratio_at
from screwsim.study.datasheet.rated import Rating, celsius, pressure_ratio
from screwsim.study.datasheet.sheet import Drawing, Sheet, Table
from screwsim.study.datasheet.tables import DUTY, HOUR, KW, PERCENT, Column
from screwsim.study.part_load import SPEED_PATH

FLOW, DISCHARGE, ISENTROPIC, FILLING = (
    "gas_mass_flow",
    "discharge_temperature",
    "isentropic_efficiency",
    "filling_factor",
)
ELECTRICAL_FIGURES = "electrical_power", "electrical_isentropic_efficiency"
DOCUMENT_FIGURES = (
    FLOW, "shaft_power", "output_power", *ELECTRICAL_FIGURES, ISENTROPIC, "volumetric_efficiency", FILLING, DISCHARGE,
    "suction_pressure", "discharge_pressure", "pressure_ratio", "peak_pressure", DUTY, "oil_flow_volume",
    "oil_supply_temperature", "oil_flow_ratio", "separator_temperature",
)  # fmt: skip
PACKAGE_REMEDY = "a package with filter, cooler and fan is rated by ISO 1217 (name effects.air_package)"
NORMAL_CONDITIONS = "Nm³/h: as an ideal gas at 0 °C and 1.01325 bar"
DISCLAIMER = "computed, not measured: no tolerance of ISO 1217 applies, and no third party verified it"


def gas_sheet(rated: Rating) -> Sheet:
    """Return the sheet of a rating."""
    scene, expands = rated.asked.scene, _expands(rated)
    heading = f"{'Expander' if expands else 'Gas compressor'}, rating by {' and '.join(_axes_in_words(rated))}"
    meant = DISCLAIMER.replace("of ISO 1217 ", "") if expands else DISCLAIMER
    notes = [*tables.notes_of(rated, _own_point(rated), meant)]
    if not expands:
        notes[-1:-1] = [NORMAL_CONDITIONS, *([PACKAGE_REMEDY] if scene.gas.name.lower() == "air" else [])]
    return Sheet(
        heading=heading,
        title=with_printed_units(scene.title),
        lines=list(_lines(rated)),
        tables=list(_tables(rated)),
        verdict=None,
        notes=notes,
        drawings=list(_drawings(rated)),
        document=_document(rated),
        ok=rated.ok,
    )


def _expands(rated: Rating) -> bool:
    return rated.asked.scene.machine.expands


def normal_factor(scene: Scene) -> float:
    """Return the factor from a mass flow [kg/s] to Nm³/h: R T_n/p_n, for the ideal gas."""
    return HOUR * constants.gas_constant(scene.gas.name) * ZERO_CELSIUS / STANDARD_ATMOSPHERE


def _own_point(rated: Rating) -> str:
    at, speed = lines(rated.asked.scene), rated.asked.scene.operation.speed
    what = f"{quantity('Pa', at.p_s)}, {celsius(at.T_s):.4g} °C to {quantity('Pa', at.p_d)}"
    return f"{what} at {quantity('rad s-1', speed)}" if _expands(rated) else what


def _lines(rated: Rating) -> Iterator[tuple[str, str]]:
    scene, found = rated.asked.scene, rated.own.performance if rated.own.status == "ok" else {}
    yield from tables.machine_line(scene, found)
    yield "gas", f"{scene.gas.name}, {_temperature(scene)}"
    yield "point", f"{_own_point(rated)}: {_point(rated, found)}"
    yield from tables.power_lines(scene, found, _expands(rated))
    yield from tables.oil_line(scene, found)
    power = "output_power" if _expands(rated) else "shaft_power"
    yield from tables.limit_lines(rated, (power,) if _expands(rated) else (DISCHARGE, power))
    if not _expands(rated):
        yield from tables.control_line(rated)


def _temperature(scene: Scene) -> str:
    suction, superheat = scene.operation.suction, scene.operation.superheat
    superheat = suction.superheat if suction.superheat is not None else superheat
    if superheat is not None:
        return f"superheated by {superheat:.4g} K"
    if suction.quality is not None:
        return f"vapour share {suction.quality:.4g} at the inlet"
    return f"{celsius(lines(scene).T_s):.4g} °C at the inlet"


def _point(rated: Rating, found: Mapping[str, Any]) -> str:
    if not found:
        return rated.own.told
    flow, power, efficiency, filled, *_ = _columns(rated)
    words = [
        f"{flow.cell(found)} kg/h",
        f"{power.cell(found)} kW {_power_words(rated)}",
        f"η_s {efficiency.cell(found)} %",
    ]
    if not _expands(rated):
        words.insert(1, f"{normal_factor(rated.asked.scene) * found[FLOW]:.5g} Nm³/h")
        return ", ".join([*words, f"λ {filled.cell(found)} %"])
    return ", ".join([*words, f"filling factor {filled.cell(found)}"])


def _power_words(rated: Rating) -> str:
    electrical = motor_of(rated.asked.scene) is not None
    if _expands(rated):
        return "of electrical power given" if electrical else "given at the shaft"
    return "of electrical power" if electrical else "at the shaft"


def _columns(rated: Rating) -> tuple[Column, ...]:
    """Return the columns with a table each; the first four are flow, power, efficiency and filling of the chambers."""
    scene, own, expands = rated.asked.scene, rated.own.performance, _expands(rated)
    electrical = motor_of(scene) is not None
    flow = HOUR * (own.get(FLOW) or 1.0)
    kw = tables.decimals_of(KW * abs(own.get("shaft_power") or 1e5))
    word = "electrical power" if electrical else "shaft power"
    what, sign = (f"{word} given" if expands else word), (-1.0 if expands else 1.0)
    power, efficiency = ELECTRICAL_FIGURES if electrical else ("shaft_power", ISENTROPIC)
    if expands:
        filled = Column(FILLING, "Filling factor", 1.0, 3)
    else:
        filled = Column("volumetric_efficiency", "Volumetric efficiency [%]", PERCENT, 1)
    columns = [
        Column(FLOW, "Mass flow [kg/h]", HOUR, tables.decimals_of(flow)),
        Column(power, f"{what.capitalize()} [kW]", sign * KW, kw),
        Column(efficiency, f"{'Electrical isentropic' if electrical else 'Isentropic'} efficiency [%]", PERCENT, 1),
        filled,
        Column(DISCHARGE, f"{'Outlet' if expands else 'Discharge'} temperature [°C]", 1.0, 1, celsius=True),
    ]
    if not expands:
        normal = normal_factor(scene)
        columns.append(Column(FLOW, "Flow [Nm³/h]", normal, tables.decimals_of(normal * flow / HOUR)))
    if tables.is_oil_cooled(scene):
        columns.append(Column(DUTY, "Oil cooler duty [kW]", KW, kw))
    return tuple(columns)


def _sides(rated: Rating) -> tuple[str, str]:
    asked, expands = rated.asked, _expands(rated)
    across = "speed" if asked.across.path == SPEED_PATH else "inlet" if expands else "suction"
    if asked.across.path == EVAPORATING:
        across = "evaporating"
    down = "outlet" if expands else "discharge"
    return across, "condensing" if asked.down.path.endswith("temperature") else down


def _axes_in_words(rated: Rating) -> Iterator[str]:
    """Yield the meaning of both axes, in words."""
    for axis, side in zip((rated.asked.across, rated.asked.down), _sides(rated), strict=True):
        kind = "temperature" if axis.path.endswith("temperature") else "pressure"
        yield side if axis.path == SPEED_PATH else f"{side} {kind}"


def _tables(rated: Rating) -> Iterator[Table]:
    across, down = _sides(rated)
    columns = _columns(rated)
    yield from tables.tables_of(rated, columns, down)
    yield from tables.envelope_table(rated, across, list(_axes_in_words(rated))[1])
    if _expands(rated):
        return
    note = tables.part_load_note(
        rated, f"mass flow relative to that of the scene itself, at {_own_point(rated)}", "η_s"
    )
    flow, power, efficiency, _, discharge, *_ = columns
    word = power.title.split()[0].lower()
    shown = ("flow kg/h", flow), (f"{word} kW", power), ("η_s %", efficiency), ("discharge °C", discharge)
    yield from tables.part_load_table(rated, shown, ("η_s there", efficiency), note)


def _drawings(rated: Rating) -> Iterator[Drawing]:
    asked = rated.asked
    across, _ = _sides(rated)
    columns = _columns(rated)
    rows = [
        (
            tables.shown_at(asked.across, value),
            sorted((ratio_at(asked, value, below), (i, j)) for j, below in enumerate(asked.down.values)),
        )
        for i, value in enumerate(asked.across.values)
    ]
    for column in (columns[1], columns[2]):
        yield from tables.drawing(rated, column, "pressure ratio", across, rows)
    title = columns[2].title
    yield from tables.part_load_drawing(rated, columns[2], f"Part load: {title[0].lower()}{title[1:]}")


def _document(rated: Rating) -> dict[str, Any]:
    scene = rated.asked.scene
    return {
        "kind": "expander" if _expands(rated) else "gas",
        "title": scene.title,
        "gas": scene.gas.name,
        "inlet_temperature": lines(scene).T_s,
        "pressure_ratio": pressure_ratio(scene),
        "normal_volume": normal_factor(scene) / HOUR,  # m³ per kilogram at 0 °C and 1.01325 bar, as an ideal gas
        **tables.document_of(rated, DOCUMENT_FIGURES),
    }
