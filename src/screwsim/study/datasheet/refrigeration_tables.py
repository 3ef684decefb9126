"""The tables of a refrigeration machine's sheet: figures over both temperatures, part load, envelope."""

from collections.abc import Iterator

from screwsim.figures.engineering import quantity
from screwsim.scene.operation import CONDENSING
from screwsim.study.datasheet import tables
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.rated import Rating, celsius
from screwsim.study.datasheet.sheet import Table
from screwsim.study.datasheet.tables import HOUR, KW, Column, decimals_of
from screwsim.study.datasheet.words import DUTY, cooled

CAPACITY, FLOW, DISCHARGE = "cooling_capacity", "gas_mass_flow", "discharge_temperature"
HEATING, HEATING_COPS = "heating_capacity", ("heating_cop", "electrical_heating_cop")
SHAFT, ELECTRICAL = ("shaft_power", "cop"), ("electrical_power", "electrical_cop")
KILOWATTS = 1e5  # a capacity, where the scene's own point has none


def own_point(rated: Rating) -> str:
    operation = rated.asked.scene.operation
    evaporating = f"{celsius(operation.evaporating_temperature or 0.0):.4g} °C"
    cooler = operation.gas_cooler
    if cooler is not None:
        outlet = celsius(cooler.outlet_temperature)
        return f"{evaporating} and a gas cooler at {quantity('Pa', cooler.pressure)} that leaves {outlet:.4g} °C"
    return f"{evaporating} / {celsius(operation.condensing_temperature or 0.0):.4g} °C"


def columns_of(rated: Rating) -> tuple[Column, ...]:
    """Return what each table is of: capacity, power, COP, flow, discharge temperature, duty of an oil cooler."""
    scene, own = rated.asked.scene, rated.own.performance
    kw, flow = decimals_of(KW * (own.get(CAPACITY) or KILOWATTS)), decimals_of(HOUR * (own.get(FLOW) or 1.0))
    power, cop = ELECTRICAL if motor_of(scene) is not None else SHAFT
    word = "Electrical power" if power in ELECTRICAL else "Shaft power"
    duty = (Column(DUTY, "Oil cooler duty [kW]", KW, kw),) if cooled(scene) else ()
    return (
        Column(CAPACITY, "Cooling capacity [kW]", KW, kw),
        Column(power, f"{word} [kW]", KW, kw),
        Column(cop, f"COP of the {word.lower()}", 1.0, 2),
        Column(FLOW, "Mass flow [kg/h]", HOUR, flow),
        Column(DISCHARGE, "Discharge temperature [°C]", 1.0, 1, celsius=True),
        *duty,
    )


def heating_columns(rated: Rating) -> tuple[Column, ...]:
    """Return what the tables of a heat pump have more: heating capacity, and its COP by the same power."""
    kw = decimals_of(KW * (rated.own.performance.get(HEATING) or KILOWATTS))
    motor = motor_of(rated.asked.scene) is not None
    word = "electrical" if motor else "shaft"
    return (
        Column(HEATING, "Heating capacity [kW]", KW, kw),
        Column(HEATING_COPS[motor], f"COP of heating, of the {word} power", 1.0, 2),
    )


def tables_of(rated: Rating, heating: bool) -> Iterator[Table]:
    """Yield all tables of the sheet, where asked for with those of heating."""
    condensing = rated.asked.down.path == CONDENSING
    columns = columns_of(rated)
    shown = (*columns, *heating_columns(rated)) if heating else columns
    yield from tables.tables_of(rated, shown, "condensing" if condensing else "gas cooler")
    side = "condensing temperature" if condensing else "pressure of the gas cooler"
    yield from tables.envelope_table(rated, "evaporating", side)
    load = f"cooling capacity over that of the scene as it stands, at {own_point(rated)}"
    note = tables.part_load_note(rated, load, "COP")
    capacity, power, cop, _, discharge, *_ = columns
    part = (
        ("capacity kW", capacity),
        (f"{power.title.split()[0].lower()} kW", power),
        ("COP", cop),
        ("discharge °C", discharge),
    )
    yield from tables.part_load_table(rated, part, ("COP there", cop), note)
