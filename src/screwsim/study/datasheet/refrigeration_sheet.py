"""The rating of a refrigeration machine as a sheet: what it says, draws and gives to programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from screwsim.figures.engineering import quantity, shown_name
from screwsim.fluid.composition import is_blend
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.operation import CONDENSING
from screwsim.study.datasheet.bounds import beyond, shown
from screwsim.study.datasheet.refrigeration import Rating, celsius
from screwsim.study.datasheet.refrigeration_tables import (
    CAPACITY,
    DISCHARGE,
    DUTY,
    ELECTRICAL,
    FLOW,
    KW,
    SHAFT,
    cell_of,
    columns_of,
    cooled,
    envelope_table,
    own_point,
    part_loads,
    place_of,
    shown_at,
    tables_of,
)
from screwsim.study.datasheet.sheet import Curve, Drawing, Sheet, told
from screwsim.study.inputs import shown_value
from screwsim.study.part_load import PartLoad, Step

KEPT = (
    CAPACITY, *SHAFT, *ELECTRICAL, FLOW, DISCHARGE, "suction_pressure", "discharge_pressure", "volumetric_efficiency",
    "isentropic_efficiency", "peak_pressure", DUTY, "oil_flow_volume", "oil_supply_temperature", "oil_flow_ratio",
    "separator_temperature",
)  # fmt: skip
HIGHEST = DISCHARGE, "discharge_pressure", "shaft_power"
MEANT = "computed, not measured: no tolerance of EN 12900 or AHRI 540 is applied, and nobody verified it"


def refrigeration_sheet(rated: Rating) -> Sheet:
    """Return the sheet of a rating."""
    scene = rated.asked.scene
    tables = [*tables_of(rated), *envelope_table(rated), *part_loads(rated)]
    return Sheet(
        heading="Refrigeration compressor, rating by evaporating and condensing temperature",
        title=scene.title,
        lines=list(_lines(rated)),
        tables=tables,
        verdict=None,
        notes=list(_notes(rated)),
        drawings=list(_drawings(rated)),
        document=_document(rated),
        ok=rated.ok,
    )


# ---- lines -------------------------------------------------------------------------------------------------------


def _lines(rated: Rating) -> Iterator[tuple[str, str]]:
    scene, found = rated.asked.scene, rated.own.performance if rated.own.status == "ok" else {}
    operation = scene.operation
    speed = shown_value(scene, "operation.speed", operation.speed)
    if found:
        yield "machine", f"{quantity('m3 s-1', found['displacement_flow'])} swept at {speed}"
    yield "refrigerant", _refrigerant(scene)
    yield "point", f"{own_point(rated)}: {_point(rated, found)}"
    motor = scene.effects.get("motor")
    if motor is not None:
        load = 100.0 * found["shaft_power"] / motor.parameters.rated_power if found else 0.0
        share = f", {load:.0f} % of it at the point" if found else ""
        yield "motor", f"{quantity('W', motor.parameters.rated_power)} rated at the shaft{share}"
    if scene.oil_supply is not None:
        yield "oil", _oil(scene, found)
    stated = ", ".join(f"{bound.words} ({bound.source})" for bound in rated.asked.bounds)
    yield "limits", stated or "none stated (--limit 'discharge_temperature<110 degC')"
    highest = [f"{shown_name(name)} {_highest(rated, name)}" for name in HIGHEST if _highest(rated, name)]
    if highest:
        yield "highest", f"over the table: {', '.join(highest)}"
    kinds = ", ".join(control.name for control in rated.asked.controls) or "none that the scene names"
    yield "control", kinds


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
    columns = columns_of(rated)
    capacity, power = (f"{cell_of(found, column[0], *column[2:])} kW" for column in columns[:2])
    cop = cell_of(found, columns[2][0], 1.0, 2)
    return f"{capacity} of cooling, {power} of {columns[1][1].split(' [')[0].lower()}, COP {cop}"


def _oil(scene: Scene, found: Mapping[str, Any]) -> str:
    supply = scene.oil_supply
    assert supply is not None
    text = "from a pump" if supply.kind == "pump" else "displaced by the discharge pressure"
    if found.get("oil_flow_volume") is not None:
        text += f", {quantity('L min-1', found['oil_flow_volume'])}"
    temperature = found.get("oil_supply_temperature", supply.temperature)
    if temperature is not None:
        text += f" at {celsius(temperature):.1f} °C"
    duty = found.get(DUTY)
    if duty is None:
        return f"{text}; the duty of its cooler is not simulated (effects.separator)"
    return f"{text}; its cooler takes {KW * duty:.1f} kW" if cooled(scene) else f"{text}; no cooler"


def _highest(rated: Rating, figure: str) -> str:
    every = [(result.performance.get(figure), at) for at, result in rated.points.items() if result.status == "ok"]
    known = [(value, at) for value, at in every if value is not None]
    if not known:
        return ""
    value, (i, j) = max(known)
    return f"{shown(figure, value)} at {place_of(rated, i, j)}"


# ---- notes and drawings ------------------------------------------------------------------------------------------


def _notes(rated: Rating) -> Iterator[str]:
    every = [(own_point(rated), rated.own)]
    every += [(place_of(rated, i, j), result) for (i, j), result in rated.points.items()]
    for each in rated.loads:
        every += [(f"{each.control.name} at {100.0 * step.load:.0f} %", step.result) for step in each.steps[1:]]
    yield from told([(where, [result.told]) for where, result in every if result.status != "ok"])
    for each in rated.loads:
        if each.why:
            yield f"{each.control.name}: no part load below {100.0 * each.least:.0f} %: {each.why}"
    yield from told([(where, result.warnings) for where, result in every if result.status == "ok"])
    if "operation.speed" in {control.path for control in rated.asked.controls}:
        motor = rated.asked.scene.effects.get("motor")
        if motor is None or motor.parameters.drive_efficiency == 1.0:
            yield "part load by speed is without the losses of an inverter (effects.motor.drive_efficiency)"
    yield MEANT


def _drawings(rated: Rating) -> Iterator[Drawing]:
    asked = rated.asked
    columns = columns_of(rated)
    by = "condensing" if asked.condensing.path == CONDENSING else "gas cooler"
    for figure, title, factor, _ in (columns[0], columns[2]):
        curves = []
        for j, value in enumerate(asked.condensing.values):
            column = [(i, rated.points.get((i, j))) for i in range(len(asked.evaporating.values))]
            good = [(i, one.performance[figure]) for i, one in column if one is not None and _has(one, figure)]
            if len(good) > 1:
                x = [celsius(asked.evaporating.values[i]) for i, _ in good]
                name = shown_at(asked.condensing, value)
                curves.append(Curve(x, [factor * y for _, y in good], name if curves else f"{by} {name}"))
        if curves:
            yield Drawing(title, "evaporating temperature [°C]", title, curves)
    parts = [each for each in rated.loads if len(each.curve) > 1]
    if parts:
        title = f"Part load: {columns[2][1]}"
        yield Drawing(title, "load [%]", title, [_load_curve(each, columns[2][0]) for each in parts])
    if len(rated.reach) > 1 and asked.condensing.path == CONDENSING:
        yield _outline(rated)


def _load_curve(each: PartLoad, figure: str) -> Curve:
    steps = sorted({step.load: step for step in (*each.curve, *each.steps) if _has(step.result, figure)}.items())
    y = [step.result.performance[figure] for _, step in steps]
    return Curve([100.0 * load for load, _ in steps], y, each.control.name)


def _outline(rated: Rating) -> Drawing:
    corners = [(each.evaporating, each.low) for each in rated.reach]
    corners += [(each.evaporating, each.high) for each in reversed(rated.reach)] + corners[:1]
    x, y = ([celsius(corner[k]) for corner in corners] for k in (0, 1))
    title = "Envelope: condensing temperature [°C]"
    return Drawing(title, "evaporating temperature [°C]", title, [Curve(x, y)])


def _has(result: Result, figure: str) -> bool:
    return result.status == "ok" and result.performance.get(figure) is not None


# ---- for programs ------------------------------------------------------------------------------------------------


def _figures(result: Result) -> dict[str, Any]:
    found = {name: result.performance[name] for name in KEPT if name in result.performance}
    said = {"status": result.status, "message": result.message, "warnings": list(result.warnings)}
    return {**said, **found}


def _document(rated: Rating) -> dict[str, Any]:
    asked = rated.asked
    first, second = (axis.path.removeprefix("operation.").replace(".", "_") for axis in asked[1:3])
    points = []
    for (i, j), result in rated.points.items():
        out = [bound.figure for bound in beyond(result.performance, asked.bounds)] if result.status == "ok" else []
        at = {first: asked.evaporating.values[i], second: asked.condensing.values[j]}
        points.append({**at, **_figures(result), "beyond": out})
    every = (rated.own, *rated.points.values(), *(step.result for each in rated.loads for step in each.steps))
    return {
        "kind": "refrigeration",
        "title": asked.scene.title,
        "refrigerant": asked.scene.gas.name,
        "superheat": asked.scene.operation.superheat,
        "subcooling": asked.scene.operation.subcooling,
        "own_point": _figures(rated.own),
        "points": points,
        "limits": [
            {"figure": bound.figure, "below": bound.sign > 0, "value": bound.value, "from": bound.source}
            for bound in asked.bounds
        ],
        "envelope": [
            {first: each.evaporating, second: [each.low, each.high], "ends": [each.below, each.above]}
            for each in rated.reach
        ],
        "part_load": [_control(each) for each in rated.loads],
        "warnings": list(dict.fromkeys(text for result in every for text in result.warnings)),
    }


def _control(each: PartLoad) -> dict[str, Any]:
    steps = [
        {"load": step.load, "setting": step.setting, **_figures(step.result), **_best(step)} for step in each.steps
    ]
    about = {"control": each.control.name, "path": each.control.path, "least_load": each.least, "message": each.why}
    return {**about, "loads": steps}


def _best(step: Step) -> dict[str, Any]:
    """Return the built-in volume ratio of the best COP at a part load, and the figures there."""
    return {} if step.best is None else {"best_volume_ratio": {"ratio": step.ratio, **_figures(step.best)}}
