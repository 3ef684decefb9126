"""The sheet of two stages over two axes: refrigeration by both saturation temperatures, other gases by both pressures.

Tables, envelope, limits, part load, drawings and the document are those of `tables`; what is special to two stages is
the table of each stage, the line between them, and the table of the intermediate pressure.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from screwsim.figures.engineering import quantity
from screwsim.fluid.composition import is_blend
from screwsim.outputs import Result
from screwsim.outputs.customary import with_printed_units
from screwsim.scene.lines import lines
from screwsim.scene.operation import CONDENSING, EVAPORATING
from screwsim.study.datasheet import gas_sheet, refrigeration_sheet, tables
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.rated import celsius
from screwsim.study.datasheet.sheet import Drawing, Sheet, Table
from screwsim.study.datasheet.stages_rating import ChainRating, refrigerates
from screwsim.study.datasheet.stages_table import (
    BAR,
    RPM,
    between_line,
    each_stage_table,
    ignored_model_errors,
    motor_lines,
    own_document,
    stage_documents,
    swept_line,
)
from screwsim.study.datasheet.tables import HOUR, KW, PERCENT, Column

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
PEAK_FIGURES = (*DISCHARGES, "first_shaft_power", "second_shaft_power")


def stages_sheet(rated: ChainRating, heating: bool = False) -> Sheet:
    """Return the sheet of a rating; of a heat pump with the heat of its condenser."""
    chain, cold = rated.asked.chain, refrigerates(rated.asked.chain)
    kind = "Two-stage refrigeration compressors" if cold else "Two-stage gas compressors"
    disclaimer = refrigeration_sheet.DISCLAIMER if cold else gas_sheet.DISCLAIMER
    notes = [*ignored_model_errors(chain), *tables.notes_of(rated, _own_point(rated), disclaimer)]
    return Sheet(
        heading=f"{kind}, rating by {' and '.join(_axes_in_words(rated))}",
        title=with_printed_units(chain.title),
        lines=list(_lines(rated, heating)),
        tables=list(_tables(rated, heating)),
        verdict=None,
        notes=notes,
        drawings=list(_drawings(rated)),
        document=_document(rated),
        ok=rated.ok,
    )


def _axes_in_words(rated: ChainRating) -> Iterator[str]:
    for axis, word in zip((rated.asked.across, rated.asked.down), _sides(rated), strict=True):
        yield f"{word} {'temperature' if axis.path.endswith('temperature') else 'pressure'}"


def _sides(rated: ChainRating) -> tuple[str, str]:
    asked = rated.asked
    down = {CONDENSING: "condensing"}.get(asked.down.path, "gas cooler" if refrigerates(asked.chain) else "discharge")
    return "evaporating" if asked.across.path == EVAPORATING else "suction", down


def _own_point(rated: ChainRating) -> str:
    cold, hot = rated.asked.chain.first.operation, rated.asked.chain.second.operation
    low, high = lines(rated.asked.chain.first), lines(rated.asked.chain.second)
    inlet = f"{quantity('Pa', low.p_s)}, {celsius(low.T_s):.4g} °C"
    if cold.evaporating_temperature is not None:
        inlet = f"{celsius(cold.evaporating_temperature):.4g} °C"
    if hot.gas_cooler is not None:
        leaves = celsius(hot.gas_cooler.outlet_temperature)
        return f"{inlet} and a gas cooler at {quantity('Pa', high.p_d)} that leaves {leaves:.4g} °C"
    if hot.condensing_temperature is not None:
        return f"{inlet} / {celsius(hot.condensing_temperature):.4g} °C"
    return f"{inlet} to {quantity('Pa', high.p_d)}"


def _lines(rated: ChainRating, heating: bool) -> Iterator[tuple[str, str]]:
    chain = rated.asked.chain
    found = rated.own.performance if rated.own.status == "ok" else {}
    yield from swept_line(rated.both)
    yield ("refrigerant", _refrigerant(rated)) if refrigerates(chain) else ("gas", chain.first.gas.name)
    yield from between_line(chain, rated.own)
    yield "point", f"{_own_point(rated)}: {_point(rated, found)}"
    if heating and found:
        capacity, cop = _heating_columns(rated)
        yield "heating", f"{capacity.cell(found)} kW from the condenser, without the oil coolers; COP {cop.cell(found)}"
    yield from motor_lines(chain, rated.both)
    yield from tables.limit_lines(rated, PEAK_FIGURES)
    yield from tables.control_line(rated)


def _refrigerant(rated: ChainRating) -> str:
    cold, hot = rated.asked.chain.first.operation, rated.asked.chain.second.operation
    name, quality = rated.asked.chain.first.gas.name, cold.suction.quality
    suction = f"superheat {cold.superheat or 0.0:.4g} K" if quality is None else f"suction quality {quality:.4g}"
    below = f", subcooling {hot.subcooling or 0.0:.4g} K" if hot.gas_cooler is None else ""
    return f"{name}, {suction}{below}{'; temperatures are dew points' if is_blend(name) else ''}"


def _point(rated: ChainRating, found: Mapping[str, Any]) -> str:
    if not found:
        return rated.own.told
    main, power, best, *_ = _columns(rated)
    word = power.title.split(" [")[0].lower()
    if refrigerates(rated.asked.chain):
        return f"{main.cell(found)} kW of cooling, {power.cell(found)} kW of {word}, COP {best.cell(found)}"
    return f"{main.cell(found)} kg/h, {power.cell(found)} kW of {word}, η_s {best.cell(found)} %"


def _has_motors(rated: ChainRating) -> bool:
    return all(motor_of(scene) is not None for scene in rated.asked.scenes)


def _columns(rated: ChainRating) -> tuple[Column, ...]:
    """Return the columns with a table each; the first three are capacity (or flow), power, COP (or efficiency)."""
    own, cold, motors = rated.own.performance, refrigerates(rated.asked.chain), _has_motors(rated)
    kw = tables.decimals_of(KW * (own.get("shaft_power") or 1e5))
    mass = Column(
        FLOW, "Mass flow into the first stage [kg/h]", HOUR, tables.decimals_of(HOUR * (own.get(FLOW) or 1.0))
    )
    power = Column(
        *(("electrical_power", "Electrical power [kW]") if motors else ("shaft_power", "Shaft power [kW]")), KW, kw
    )
    if cold:
        capacity = Column(CAPACITY, "Cooling capacity [kW]", KW, tables.decimals_of(KW * (own.get(CAPACITY) or 1e5)))
        cop, word = ("electrical_cop", "electrical") if motors else ("cop", "shaft")
        head = (capacity, power, Column(cop, f"COP of the {word} power", 1.0, 2))
    else:
        head = (
            mass,
            power,
            Column("isentropic_efficiency", "Isentropic efficiency of the shaft power [%]", PERCENT, 1),
        )
    rest = [Column(INTERMEDIATE, "Intermediate pressure [bar]", BAR, 3)]
    rest += [mass] if cold else []
    for which in ("first", "second"):
        rest.append(Column(f"{which}_shaft_power", f"Shaft power of the {which} stage [kW]", KW, kw))
    for which, figure in zip(("first", "second"), DISCHARGES, strict=True):
        rest.append(Column(figure, f"Discharge temperature of the {which} stage [°C]", 1.0, 1, celsius=True))
    cooled = zip(("first", "second"), DUTIES, rated.asked.scenes, strict=True)
    for which, figure, scene in cooled:
        if tables.is_oil_cooled(scene) or abs(own.get(figure) or 0.0) > 0.0:
            rest.append(Column(figure, f"Oil cooler duty of the {which} stage [kW]", KW, kw))
    return (*head, *rest)


def _heating_columns(rated: ChainRating) -> tuple[Column, ...]:
    motors = _has_motors(rated)
    kw = tables.decimals_of(KW * (rated.own.performance.get("heating_capacity") or 1e5))
    cop, word = ("electrical_heating_cop", "electrical") if motors else ("heating_cop", "shaft")
    return (
        Column("heating_capacity", "Heating capacity [kW]", KW, kw),
        Column(cop, f"COP of heating, of the {word} power", 1.0, 2),
    )


def _tables(rated: ChainRating, heating: bool) -> Iterator[Table]:
    across, down = _sides(rated)
    columns = _columns(rated)
    yield from each_stage_table(rated.both, f"Each stage at {_own_point(rated)}")
    yield from tables.tables_of(rated, (*columns, *_heating_columns(rated)) if heating else columns, down)
    yield from tables.envelope_table(rated, across, list(_axes_in_words(rated))[1])
    main, power, best, *_ = columns
    cold = refrigerates(rated.asked.chain)
    what = "cooling capacity" if cold else "mass flow"
    note = f"load: {what} relative to that at {_own_point(rated)}; setting: share of the speeds of both stages"
    shown = (
        ("capacity kW" if cold else "flow kg/h", main),
        (f"{power.title.split()[0].lower()} kW", power),
        ("COP" if cold else "η_s %", best),
        ("between bar", Column(INTERMEDIATE, "", BAR, 3)),
        ("discharge °C", Column(DISCHARGES[1], "", 1.0, 1, celsius=True)),
    )
    yield from tables.part_load_table(rated, shown, ("", best), note)
    yield from _intermediate_table(rated, columns)


def _intermediate_table(rated: ChainRating, columns: tuple[Column, ...]) -> Iterator[Table]:
    """Yield how the intermediate pressure and the efficiency depend on the speed of the second stage."""
    main, power, best, *_ = columns
    speed = RPM * rated.asked.chain.second.operation.speed
    shown = (Column(INTERMEDIATE, "", BAR, 3), main, power, best)
    rows = [
        [f"{speed * share:.0f}", f"{PERCENT * share:.0f}", *(column.cell(one.performance) for column in shown)]
        for share, one in rated.by_second
    ]
    if rows:
        cold = refrigerates(rated.asked.chain)
        heads = ["second stage rpm", "% of its speed", "between bar", "capacity kW" if cold else "flow kg/h"]
        heads += [f"{power.title.split()[0].lower()} kW", "COP" if cold else "η_s %"]
        yield Table("Intermediate pressure by the speed of the second stage", heads, rows, _best_note(rated, best))


def _best_note(rated: ChainRating, best: Column) -> str:
    """Return where the best figure lies, from a parabola through the largest one and its neighbours."""
    found = best_intermediate(rated.by_second, best.figure)
    if found is None:
        return ""
    p, value, inside = found
    word = "COP" if refrigerates(rated.asked.chain) else "η_s"
    unit = "" if refrigerates(rated.asked.chain) else " %"
    shown = f"{best.factor * value:.{best.decimals}f}{unit}"
    if not inside:
        return f"best {word} {shown} at the end of the table, {quantity('Pa', p)} between the stages"
    return f"best {word} {shown} at {quantity('Pa', p)} between the stages"


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
    x, y = (np.array(column) for column in zip(*good[k - 1 : k + 2], strict=True))
    a, b, c = np.polyfit(x - x[1], y, 2)
    if not a < 0.0:
        return float(np.exp(x[1])), float(y[1]), True
    top = -0.5 * b / a
    return float(np.exp(x[1] + top)), float(c - 0.25 * b * b / a), True


def _drawings(rated: ChainRating) -> Iterator[Drawing]:
    asked, (across, down), columns = rated.asked, _sides(rated), _columns(rated)
    hot = asked.across.path.endswith("temperature")
    places = [(celsius(x) if hot else BAR * x, i) for i, x in enumerate(asked.across.values)]
    rows = [
        (tables.shown_at(asked.down, value), [(x, (i, j)) for x, i in places])
        for j, value in enumerate(asked.down.values)
    ]
    label = f"{across} {'temperature [°C]' if hot else 'pressure [bar]'}"
    for column in (columns[0], columns[2], columns[3]):
        yield from tables.drawing(rated, column, label, down, rows)
    yield from tables.part_load_drawing(rated, columns[2], f"Part load: {columns[2].title}")


def _document(rated: ChainRating) -> dict[str, Any]:
    chain = rated.asked.chain
    found = tables.document_of(rated, DOCUMENT_FIGURES)
    by_second = [{"share": share, **_point_document(one)} for share, one in rated.by_second]
    return {
        "kind": f"two_stage_{'refrigeration' if refrigerates(chain) else 'gas'}",
        "title": chain.title,
        "gas": chain.first.gas.name,
        **found,
        "own_point": own_document(rated.own, DOCUMENT_FIGURES),
        "stages": stage_documents(rated.both),
        "part_load_setting": "share of the speeds of both stages",
        "by_speed_of_second_stage": by_second,
    }


def _point_document(one: Result) -> dict[str, Any]:
    return tables.document_figures(one, DOCUMENT_FIGURES)
