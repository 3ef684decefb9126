"""The rating of a refrigeration machine as a sheet: what it says, draws and gives to programs."""

from collections.abc import Iterator, Mapping
from typing import Any

from screwsim.fluid.composition import is_blend
from screwsim.scene import Scene
from screwsim.scene.operation import CONDENSING
from screwsim.study.datasheet.rated import Rating, celsius
from screwsim.study.datasheet.refrigeration_tables import (
    CAPACITY,
    DISCHARGE,
    ELECTRICAL,
    FLOW,
    HEATING,
    HEATING_COPS,
    SHAFT,
    columns_of,
    heating_columns,
    own_point,
    tables_of,
)
from screwsim.study.datasheet.sheet import Curve, Drawing, Sheet
from screwsim.study.datasheet.tables import document_of, has, part_load_drawing, shown_at
from screwsim.study.datasheet.words import (
    DUTY,
    control_line,
    limit_lines,
    machine_line,
    notes_of,
    oil_line,
    power_lines,
)

KEPT = (
    CAPACITY, *SHAFT, *ELECTRICAL, HEATING, *HEATING_COPS, FLOW, DISCHARGE, "suction_pressure", "discharge_pressure",
    "volumetric_efficiency",
    "isentropic_efficiency", "peak_pressure", DUTY, "oil_flow_volume", "oil_supply_temperature", "oil_flow_ratio",
    "separator_temperature",
)  # fmt: skip
HIGHEST = DISCHARGE, "discharge_pressure", "shaft_power"
MEANT = "computed, not measured: no tolerance of EN 12900 or AHRI 540 is applied, and nobody verified it"


def refrigeration_sheet(rated: Rating, heating: bool = False) -> Sheet:
    """Return the sheet of a rating, of a heat pump with what its condenser gives."""
    return Sheet(
        heading="Refrigeration compressor, rating by evaporating and condensing temperature",
        title=rated.asked.scene.title,
        lines=list(_lines(rated, heating)),
        tables=list(tables_of(rated, heating)),
        verdict=None,
        notes=list(notes_of(rated, own_point(rated), MEANT)),
        drawings=list(_drawings(rated)),
        document=_document(rated),
        ok=rated.ok,
    )


def _lines(rated: Rating, heating: bool) -> Iterator[tuple[str, str]]:
    scene, found = rated.asked.scene, rated.own.performance if rated.own.status == "ok" else {}
    yield from machine_line(scene, found)
    yield "refrigerant", _refrigerant(scene)
    yield "point", f"{own_point(rated)}: {_point(rated, found)}"
    if heating and found:
        capacity, cop = heating_columns(rated)
        yield "heating", f"{capacity.cell(found)} kW in the condenser, without the oil cooler; COP {cop.cell(found)}"
    yield from power_lines(scene, found)
    yield from oil_line(scene, found)
    yield from limit_lines(rated, HIGHEST)
    yield from control_line(rated)


def _refrigerant(scene: Scene) -> str:
    operation = scene.operation
    name = scene.gas.name
    quality = operation.suction.quality
    suction = f"superheat {operation.superheat or 0.0:.4g} K" if quality is None else f"suction quality {quality:.4g}"
    below = f", subcooling {operation.subcooling or 0.0:.4g} K" if operation.gas_cooler is None else ""
    dew = "; temperatures are dew points" if is_blend(name) else ""
    return f"{name}, {suction}{below}{dew}"


def _point(rated: Rating, found: Mapping[str, Any]) -> str:
    if not found:
        return rated.own.told
    capacity, power, cop, *_ = columns_of(rated)
    word = power.title.split(" [")[0].lower()
    return f"{capacity.cell(found)} kW of cooling, {power.cell(found)} kW of {word}, COP {cop.cell(found)}"


def _drawings(rated: Rating) -> Iterator[Drawing]:
    asked = rated.asked
    columns = columns_of(rated)
    by = "condensing" if asked.down.path == CONDENSING else "gas cooler"
    for column in (columns[0], columns[2]):
        curves = []
        for j, value in enumerate(asked.down.values):
            row = [(i, rated.points.get((i, j))) for i in range(len(asked.across.values))]
            good = [(i, column.value(one.performance) or 0.0) for i, one in row if one is not None and has(one, column)]
            if len(good) > 1:
                x = [celsius(asked.across.values[i]) for i, _ in good]
                name = shown_at(asked.down, value)
                curves.append(Curve(x, [y for _, y in good], name if curves else f"{by} {name}"))
        if curves:
            yield Drawing(column.title, "evaporating temperature [°C]", column.title, curves)
    yield from part_load_drawing(rated, columns[2], f"Part load: {columns[2].title}")
    if len(rated.reach) > 1 and asked.down.path == CONDENSING:
        yield _outline(rated)


def _outline(rated: Rating) -> Drawing:
    corners = [(each.at, each.low) for each in rated.reach]
    corners += [(each.at, each.high) for each in reversed(rated.reach)] + corners[:1]
    x, y = ([celsius(corner[k]) for corner in corners] for k in (0, 1))
    title = "Envelope: condensing temperature [°C]"
    return Drawing(title, "evaporating temperature [°C]", title, [Curve(x, y)])


def _document(rated: Rating) -> dict[str, Any]:
    scene = rated.asked.scene
    return {
        "kind": "refrigeration",
        "title": scene.title,
        "refrigerant": scene.gas.name,
        "superheat": scene.operation.superheat,
        "subcooling": scene.operation.subcooling,
        **document_of(rated, KEPT),
    }
