"""The rating of a refrigeration machine as a sheet: tables over both temperatures, part load, envelope, oil."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from screwsim.engineering import quantity, shown_name
from screwsim.fluid.composition import is_blend
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.operation import CONDENSING
from screwsim.study.datasheet.bounds import beyond, shown
from screwsim.study.datasheet.refrigeration import Axis, Rating, celsius
from screwsim.study.datasheet.sheet import Curve, Drawing, Sheet, Table, told
from screwsim.study.inputs import shown_value
from screwsim.study.part_load import PartLoad

CAPACITY, FLOW, DISCHARGE, DUTY = "cooling_capacity", "gas_mass_flow", "discharge_temperature", "oil_cooler_duty"
SHAFT, ELECTRICAL = ("shaft_power", "cop"), ("electrical_power", "electrical_cop")
KEPT = (
    CAPACITY, *SHAFT, *ELECTRICAL, FLOW, DISCHARGE, "suction_pressure", "discharge_pressure", "volumetric_efficiency",
    "isentropic_efficiency", "peak_pressure", DUTY, "oil_flow_volume", "oil_supply_temperature", "oil_flow_ratio",
    "separator_temperature",
)  # fmt: skip
KW, HOUR = 1e-3, 3600.0
HIGHEST = DISCHARGE, "discharge_pressure", "shaft_power"
NONE, BLANK, MARK = "–", "\u00a0", "*"
MEANT = "computed, not measured: no tolerance of EN 12900 or AHRI 540 is applied, and nobody verified it"


def refrigeration_sheet(rated: Rating) -> Sheet:
    """Return the sheet of a rating."""
    scene = rated.asked.scene
    tables = [*_tables(rated), *_envelope(rated), *_part_loads(rated)]
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


# ---- what is said of a figure ----------------------------------------------------------------------------------


def _columns(scene: Scene) -> tuple[tuple[str, str, float, int], ...]:
    """Return (figure, title, factor, decimals) of each table; temperatures in °C."""
    power, cop = ELECTRICAL if "motor" in scene.effects else SHAFT
    word = "Electrical power" if power in ELECTRICAL else "Shaft power"
    duty = ((DUTY, "Oil cooler duty [kW]", KW, 1),) if _cooled(scene) else ()
    return (
        (CAPACITY, "Cooling capacity [kW]", KW, 1),
        (power, f"{word} [kW]", KW, 1),
        (cop, f"COP of the {word.lower()}", 1.0, 2),
        (FLOW, "Mass flow [kg/h]", HOUR, 0),
        (DISCHARGE, "Discharge temperature [°C]", 1.0, 1),
        *duty,
    )


def _cooled(scene: Scene) -> bool:
    """Tell whether oil is taken heat from: by a cooler, or by what states its temperature."""
    separator = scene.effects.get("separator")
    supply = scene.oil_supply
    stated = supply is not None and supply.temperature is not None
    return separator is not None and (stated or separator.parameters.cooler is not None)


def _cell(found: Mapping[str, Any], figure: str, factor: float, decimals: int) -> str:
    value = found.get(figure)
    if value is None:
        return NONE
    number = celsius(value) if figure == DISCHARGE else factor * value
    return f"{number + 0.0:.{decimals}f}"


def _at(axis: Axis, value: float) -> str:
    """Return a value of an axis in words: °C, or bar of a gas cooler."""
    return f"{celsius(value):.4g} °C" if axis.path.endswith("temperature") else quantity("Pa", value)


# ---- tables ------------------------------------------------------------------------------------------------------


def _tables(rated: Rating) -> Iterator[Table]:
    asked = rated.asked
    side = "condensing" if asked.condensing.path == CONDENSING else "gas cooler"
    across = (_at(asked.evaporating, value) for value in asked.evaporating.values)
    heads = [side, *(value.replace(" ", BLANK) for value in across)]
    for figure, title, factor, decimals in _columns(asked.scene):
        rows, marked = [], False
        for j, value in enumerate(asked.condensing.values):
            cells = []
            for i in range(len(asked.evaporating.values)):
                result = rated.points.get((i, j))
                if result is None or result.status != "ok":
                    cells.append("" if result is None else NONE)
                    continue
                out = bool(beyond(result.performance, asked.bounds))
                marked = marked or out
                cells.append(_cell(result.performance, figure, factor, decimals) + (MARK if out else BLANK))
            rows.append([_at(asked.condensing, value), *cells])
        if not marked:
            rows = [[cell.rstrip(BLANK) for cell in row] for row in rows]
        yield Table(title, heads, rows, f"{MARK} beyond a limit" if marked else "")


def _part_loads(rated: Rating) -> Iterator[Table]:
    scene, columns = rated.asked.scene, _columns(rated.asked.scene)
    power, cop = columns[1], columns[2]
    heads = ("control", "load %", "setting", "capacity kW", f"{power[1].split()[0].lower()} kW", "COP", "discharge °C")
    rows = []
    for each in rated.loads:
        for k, step in enumerate(each.steps):
            found = step.result.performance
            cells = [_cell(found, *column) for column in ((CAPACITY, KW, 1), (power[0], *power[2:]))]
            cells += [_cell(found, cop[0], 1.0, 2), _cell(found, DISCHARGE, 1.0, 1)]
            setting = shown_value(scene, each.control.path, step.setting, 4)
            rows.append([each.control.name if k == 0 else "", f"{100.0 * step.load:.0f}", setting, *cells])
    if rows:
        note = f"load: cooling capacity over that of the scene as it stands, at {_own(rated)}"
        yield Table("Part load at equal loads", heads, rows, note, left=1)


def _envelope(rated: Rating) -> Iterator[Table]:
    asked = rated.asked
    if not rated.reach:
        return
    rows = []
    for each in rated.reach:
        ends = (_end(asked.condensing, at) for at in (each.low, each.high))
        rows.append([_at(asked.evaporating, each.evaporating), *ends, each.below, each.above])
    heads = ("evaporating", "from", "to", "lower end", "upper end")
    side = "condensing temperature" if asked.condensing.path == CONDENSING else "pressure of the gas cooler"
    yield Table(f"Envelope: {side} within all limits", heads, rows)


def _end(axis: Axis, value: float) -> str:
    return f"{celsius(value):.1f} °C" if axis.path == CONDENSING else quantity("Pa", value)


# ---- lines -------------------------------------------------------------------------------------------------------


def _own(rated: Rating) -> str:
    operation = rated.asked.scene.operation
    evaporating = f"{celsius(operation.evaporating_temperature or 0.0):.4g} °C"
    cooler = operation.gas_cooler
    if cooler is not None:
        outlet = celsius(cooler.outlet_temperature)
        return f"{evaporating} and a gas cooler at {quantity('Pa', cooler.pressure)} that leaves {outlet:.4g} °C"
    return f"{evaporating} / {celsius(operation.condensing_temperature or 0.0):.4g} °C"


def _lines(rated: Rating) -> Iterator[tuple[str, str]]:
    scene, found = rated.asked.scene, rated.own.performance if rated.own.status == "ok" else {}
    operation = scene.operation
    speed = shown_value(scene, "operation.speed", operation.speed)
    if found:
        yield "machine", f"{quantity('m3 s-1', found['displacement_flow'])} swept at {speed}"
    yield "refrigerant", _refrigerant(scene)
    yield "point", f"{_own(rated)}: {_point(rated, found)}"
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
    columns = _columns(rated.asked.scene)
    capacity, power = (f"{_cell(found, column[0], column[2], 1)} kW" for column in columns[:2])
    cop = _cell(found, columns[2][0], 1.0, 2)
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
    return f"{text}; its cooler takes {KW * duty:.1f} kW" if _cooled(scene) else f"{text}; no cooler"


def _highest(rated: Rating, figure: str) -> str:
    every = [(result.performance.get(figure), at) for at, result in rated.points.items() if result.status == "ok"]
    known = [(value, at) for value, at in every if value is not None]
    if not known:
        return ""
    value, (i, j) = max(known)
    return f"{shown(figure, value)} at {_place(rated, i, j)}"


def _place(rated: Rating, i: int, j: int) -> str:
    asked = rated.asked
    first, second = (
        _at(axis, axis.values[k]) for axis, k in zip((asked.evaporating, asked.condensing), (i, j), strict=True)
    )
    return f"{first.removesuffix(' °C')}/{second}" if second.endswith("°C") else f"{first}, {second}"


# ---- notes and drawings ------------------------------------------------------------------------------------------


def _notes(rated: Rating) -> Iterator[str]:
    every = [(_own(rated), rated.own)]
    every += [(_place(rated, i, j), result) for (i, j), result in rated.points.items()]
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
    columns = _columns(asked.scene)
    by = "condensing temperature" if asked.condensing.path == CONDENSING else "pressure of the gas cooler"
    for figure, title, factor, _ in (columns[0], columns[2]):
        curves = []
        for j, value in enumerate(asked.condensing.values):
            column = [(i, rated.points.get((i, j))) for i in range(len(asked.evaporating.values))]
            good = [(i, one.performance[figure]) for i, one in column if one is not None and _has(one, figure)]
            if len(good) > 1:
                x = [celsius(asked.evaporating.values[i]) for i, _ in good]
                curves.append(Curve(x, [factor * y for _, y in good], _at(asked.condensing, value)))
        if curves:
            yield Drawing(title, f"evaporating temperature [°C], a curve a {by}", title, curves)
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
    steps = [{"load": step.load, "setting": step.setting, **_figures(step.result)} for step in each.steps]
    about = {"control": each.control.name, "path": each.control.path, "least_load": each.least, "message": each.why}
    return {**about, "loads": steps}
