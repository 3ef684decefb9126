"""The tables of a refrigeration machine's sheet: figures over both temperatures, part load, envelope."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from screwsim.figures.engineering import quantity
from screwsim.scene import Scene
from screwsim.scene.operation import CONDENSING
from screwsim.study.datasheet.bounds import beyond
from screwsim.study.datasheet.refrigeration import Axis, Rating, celsius
from screwsim.study.datasheet.sheet import Table
from screwsim.study.inputs import shown_value

CAPACITY, FLOW, DISCHARGE, DUTY = "cooling_capacity", "gas_mass_flow", "discharge_temperature", "oil_cooler_duty"
SHAFT, ELECTRICAL = ("shaft_power", "cop"), ("electrical_power", "electrical_cop")
KW, HOUR = 1e-3, 3600.0
KILOWATTS = 1e5  # a capacity, where the scene's own point has none
NONE, BLANK, MARK = "–", "\u00a0", "*"


def own_point(rated: Rating) -> str:
    operation = rated.asked.scene.operation
    evaporating = f"{celsius(operation.evaporating_temperature or 0.0):.4g} °C"
    cooler = operation.gas_cooler
    if cooler is not None:
        outlet = celsius(cooler.outlet_temperature)
        return f"{evaporating} and a gas cooler at {quantity('Pa', cooler.pressure)} that leaves {outlet:.4g} °C"
    return f"{evaporating} / {celsius(operation.condensing_temperature or 0.0):.4g} °C"


def place_of(rated: Rating, i: int, j: int) -> str:
    asked = rated.asked
    first, second = (
        shown_at(axis, axis.values[k]) for axis, k in zip((asked.evaporating, asked.condensing), (i, j), strict=True)
    )
    return f"{first.removesuffix(' °C')}/{second}" if second.endswith("°C") else f"{first}, {second}"


# ---- what is said of a figure ----------------------------------------------------------------------------------


def columns_of(rated: Rating) -> tuple[tuple[str, str, float, int], ...]:
    """Return (figure, title, factor, decimals) of each table; temperatures in °C."""
    scene, own = rated.asked.scene, rated.own.performance
    kw, flow = _decimals(KW * (own.get(CAPACITY) or KILOWATTS)), _decimals(HOUR * (own.get(FLOW) or 1.0))
    power, cop = ELECTRICAL if "motor" in scene.effects else SHAFT
    word = "Electrical power" if power in ELECTRICAL else "Shaft power"
    duty = ((DUTY, "Oil cooler duty [kW]", KW, kw),) if cooled(scene) else ()
    return (
        (CAPACITY, "Cooling capacity [kW]", KW, kw),
        (power, f"{word} [kW]", KW, kw),
        (cop, f"COP of the {word.lower()}", 1.0, 2),
        (FLOW, "Mass flow [kg/h]", HOUR, flow),
        (DISCHARGE, "Discharge temperature [°C]", 1.0, 1),
        *duty,
    )


def _decimals(size: float) -> int:
    """Return the decimals of a column by the size of its value at the scene's own point."""
    return next((decimals for decimals, least in enumerate((1000.0, 20.0, 2.0)) if size >= least), 3)


def cooled(scene: Scene) -> bool:
    """Tell whether oil is taken heat from: by a cooler, or by what states its temperature."""
    separator = scene.effects.get("separator")
    supply = scene.oil_supply
    stated = supply is not None and supply.temperature is not None
    return separator is not None and (stated or separator.parameters.cooler is not None)


def cell_of(found: Mapping[str, Any], figure: str, factor: float, decimals: int) -> str:
    value = found.get(figure)
    if value is None:
        return NONE
    number = celsius(value) if figure == DISCHARGE else factor * value
    return f"{number + 0.0:.{decimals}f}"


def shown_at(axis: Axis, value: float) -> str:
    """Return a value of an axis in words: °C, or bar of a gas cooler."""
    return f"{celsius(value):.4g} °C" if axis.path.endswith("temperature") else quantity("Pa", value)


# ---- tables ------------------------------------------------------------------------------------------------------


def tables_of(rated: Rating) -> Iterator[Table]:
    asked = rated.asked
    side = "condensing" if asked.condensing.path == CONDENSING else "gas cooler"
    across = (shown_at(asked.evaporating, value) for value in asked.evaporating.values)
    heads = [side, *(value.replace(" ", BLANK) for value in across)]
    for figure, title, factor, decimals in columns_of(rated):
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
                cells.append(cell_of(result.performance, figure, factor, decimals) + (MARK if out else BLANK))
            rows.append([shown_at(asked.condensing, value), *cells])
        if not marked:
            rows = [[cell.rstrip(BLANK) for cell in row] for row in rows]
        yield Table(title, heads, rows, f"{MARK} beyond a limit" if marked else "")


def part_loads(rated: Rating) -> Iterator[Table]:
    scene, columns = rated.asked.scene, columns_of(rated)
    capacity, power, cop = columns[:3]
    heads = ("control", "load %", "setting", "capacity kW", f"{power[1].split()[0].lower()} kW", "COP", "discharge °C")
    heads += ("best Vi", "COP there") if rated.asked.ratios else ()
    rows = []
    for each in rated.loads:
        for k, step in enumerate(each.steps):
            found = step.result.performance
            cells = [cell_of(found, column[0], *column[2:]) for column in (capacity, power)]
            cells += [cell_of(found, cop[0], 1.0, 2), cell_of(found, DISCHARGE, 1.0, 1)]
            setting = shown_value(scene, each.control.path, step.setting, 4)
            if rated.asked.ratios:
                better = step.best.performance if step.best is not None else {}
                cells += [NONE if step.ratio is None else f"{step.ratio:.2f}", cell_of(better, cop[0], 1.0, 2)]
            rows.append([each.control.name if k == 0 else "", f"{100.0 * step.load:.0f}", setting, *cells])
    if rows:
        note = f"load: cooling capacity over that of the scene as it stands, at {own_point(rated)}"
        if rated.asked.ratios:
            low, high = rated.asked.ratios[0], rated.asked.ratios[-1]
            note += (
                f"; best Vi: machine.built_in_volume_ratio of the best COP at that load, within {low:.3g} … {high:.3g}"
            )
        yield Table("Part load at equal loads", heads, rows, note, left=1, across=True)


def envelope_table(rated: Rating) -> Iterator[Table]:
    asked = rated.asked
    if not rated.reach:
        return
    rows = []
    for each in rated.reach:
        ends = (_end(asked.condensing, at) for at in (each.low, each.high))
        rows.append([shown_at(asked.evaporating, each.evaporating), *ends, each.below, each.above])
    heads = ("evaporating", "from", "to", "lower end", "upper end")
    side = "condensing temperature" if asked.condensing.path == CONDENSING else "pressure of the gas cooler"
    yield Table(f"Envelope: {side} within all limits", heads, rows)


def _end(axis: Axis, value: float) -> str:
    return f"{celsius(value):.1f} °C" if axis.path == CONDENSING else quantity("Pa", value)
