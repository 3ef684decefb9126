"""The rating of an air package as a sheet: in the trade's order, metric beside American units."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from screwsim.effects.air_package import FREE_AIR
from screwsim.effects.parts.rating import CFM, PSI, WEIGHTS
from screwsim.outputs import Result
from screwsim.outputs.customary import quantity, with_printed_units
from screwsim.scene import Scene
from screwsim.scene.lines import lines
from screwsim.scene.units import ZERO_CELSIUS
from screwsim.study.datasheet.air_rating import EFFICIENCY, Point, Rating, Regulation
from screwsim.study.datasheet.air_year import Demand, year, year_document, year_table
from screwsim.study.datasheet.bearing_lives import LIFE_FIGURES, lives_document, lives_table
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.hottest_room import room_documents, room_lines
from screwsim.study.datasheet.sheet import Curve, Drawing, Sheet, Table, warning_lines
from screwsim.study.datasheet.tables import document_figures

REFERENCE_INLET = 1e5, 293.15  # Pa, K
KW, MINUTE, HOUR, RPM = 1e3, 60.0, 3600.0, 0.10471975511965977  # W, s, s, rad/s
POWER, SPECIFIC = "package_input_power", "package_specific_power"
SEPARATED, COOLED, PACKAGE_VAPOUR = "condensate_flow", "aftercooler_condensate_flow", "package_vapour_flow"
HEADS = ("rpm", "m³/min", "acfm", "% of full", "kW", "kW/ (m³/min)", "kW/ 100 acfm", "isentropic %")
DOCUMENT_FIGURES = (
    FREE_AIR, POWER, SPECIFIC, EFFICIENCY, "shaft_power", "electrical_power", "fan_power", "discharge_pressure",
    "intake_pressure", "package_discharge_temperature", "package_heat", "oil_cooler_duty", "oil_cooler_load",
    "aftercooler_duty", "mixture_discharge_temperature", "oil_supply_temperature",
    "humidity_ratio", "pressure_dew_point", "package_dew_point", "water_flow", SEPARATED, COOLED, PACKAGE_VAPOUR,
    *LIFE_FIGURES,
)  # fmt: skip
HUMID_FIGURES = (
    "rated with humid air: free air delivery includes the water that condensed on the way, as volume at inlet "
    "humidity; data sheets are compared for dry air"
)
DISCLAIMER = "computed, not measured: no tolerance of ISO 1217 applies, and no third party verified it"


def air_sheet(scene: Scene, rated: Rating, demands: Sequence[Demand] = ()) -> Sheet:
    """Return the sheet of a rating, with the energy of demands."""
    shares = year(rated, demands) if demands else ()
    rows = [point_row(point, rated.full) for point in rated.points]
    every = [*rated.points, *([] if rated.unloaded is None else [rated.unloaded])]
    return Sheet(
        heading="Air package, rating by ISO 1217",
        title=with_printed_units(scene.title),
        lines=list(_lines(scene, rated)),
        tables=[
            Table("Points", HEADS, rows),
            *([year_table(rated, shares)] if shares else []),
            *lives_table(_named_points(rated)),
        ],
        verdict=_verdict(rated.regulation),
        notes=list(_notes(scene, every)),
        drawings=list(drawings_of(rated)),
        document={**_document(scene, rated), **({"profile": year_document(shares)} if shares else {})},
        ok=all(point.ok for point in every),
    )


def _named_points(rated: Rating) -> list[tuple[str, Result]]:
    """Return the results of all points with their names, that of full flow first."""
    named = [(f"{point.speed / RPM:.0f} rpm", point.result) for point in rated.points]
    return named if rated.unloaded is None else [*named, ("zero flow", rated.unloaded.result)]


def drawings_of(rated: Rating) -> Iterator[Drawing]:
    """Yield the specific power over the flow, if there are two points or more."""
    good = [point for point in rated.points if point.flow > 0.0]
    curve = Curve([MINUTE * point.flow for point in good], [specific_power(point) for point in good])
    label = "Package specific power [kW/(m³/min)]"
    if len(good) > 1:
        yield Drawing(label, "free air delivered [m³/min]", label, [curve], from_zero=True)


def _percent(share: float, digits: int = 0) -> str:
    return f"{100.0 * share:.{digits}f} %"


def specific_power(point: Point) -> float:
    """Return the specific power of a point [kW/(m³/min)]."""
    return point.result.performance[SPECIFIC] / (KW * MINUTE)


def point_row(point: Point, full: Point) -> list[str]:
    """Return the cells of a point of the sheet, under `HEADS`."""
    speed = f"{point.speed / RPM:.0f}"
    if not point.flow > 0.0:
        return [speed, point.result.status.replace("_", " "), *[""] * (len(HEADS) - 2)]
    found = point.result.performance
    share, specific = 100.0 * point.flow / full.flow if full.flow > 0.0 else 0.0, specific_power(point)
    efficiency = found.get(EFFICIENCY)
    cells = [speed, f"{MINUTE * point.flow:.2f}", f"{point.flow / CFM:.1f}", f"{share:.0f}" if share else ""]
    cells += [f"{found[POWER] / KW:.1f}", f"{specific:.2f}", f"{specific * 100.0 * CFM * MINUTE:.1f}"]
    return [*cells, "" if efficiency is None else f"{100.0 * efficiency:.1f}"]


def _lines(scene: Scene, rated: Rating) -> Iterator[tuple[str, str]]:
    at, effects = lines(scene), scene.effects
    package, motor, full = effects["air_package"].parameters, motor_of(scene), rated.full
    speed = "fixed speed" if not rated.variable else f"variable speed, {len(rated.points)} points"
    yield "package", f"rotary, lubricated, {rated.coolant}-cooled, {speed}"
    humid = f", relative humidity {_percent(scene.gas.relative_humidity)}" if scene.gas.relative_humidity else ""
    yield "inlet", f"{quantity('Pa', at.p_s)}, {at.T_s - ZERO_CELSIUS:.1f} °C, {scene.gas.name}{humid}"
    gauge = at.p_d - at.p_s
    yield "discharge", f"{quantity('Pa', at.p_d)}, {1e-5 * gauge:.4g} bar ({gauge / PSI:.0f} psi) over the inlet"
    found = full.result.performance if full.ok else {}
    load = f", {_percent(found['shaft_power'] / motor.rated_power)} of it at full flow" if found else ""
    inverter = " with its inverter" if motor.inverts else ""
    eta = f", efficiency{inverter} {_percent(found['motor_efficiency'], 1)}" if found else ""
    yield "motor", f"{quantity('W', motor.rated_power)} rated{load}{eta}"
    if package.fan is not None:
        yield "fan", f"{quantity('W', package.fan.power)}, {FAN_CONTROL[package.fan.control]}"
    if found:
        behind = f"{1e-2 * found['package_pressure_loss']:.0f} mbar behind the machine"
        before = found.get("intake_pressure_loss")
        before = "" if before is None else f"{1e-2 * before:.0f} mbar before and "
        yield "losses", f"{before}{behind}, at full flow"
        if found.get("package_heat") is not None:
            oil = f"{found['oil_cooler_duty'] / KW:.1f} kW of it in the oil cooler"
            load = found.get("oil_cooler_load")
            oil += "" if load is None else f", which is loaded to {_percent(load)}"
            yield "heat", f"{found['package_heat'] / KW:.1f} kW at full flow, {oil}"
            outlet = found["package_discharge_temperature"] - ZERO_CELSIUS
            yield "outlet", f"air at {outlet:.1f} °C"
        if humid:
            yield "water", _water(found)
    yield from room_lines(rated.rooms)
    yield "zero flow", _unloaded(rated)


def _water(found: Mapping[str, Any]) -> str:
    """Return in words where the water of humid air goes, at full flow."""
    brought, ratio = HOUR * found["water_flow"], 1e3 * found["humidity_ratio"]
    parts = {"the separator": found[SEPARATED], "the aftercooler": found.get(COOLED)}
    falls = " and ".join(f"{HOUR * flow:.1f} in {name}" for name, flow in parts.items() if flow is not None)
    where = f"pressure dew point {_celsius(found['pressure_dew_point'])} in the separator"
    end = f"{_celsius(found['package_dew_point'])} at the outlet"
    comes = f"{ratio:.1f} g per kg of dry air, {brought:.1f} kg/h at full flow"
    return f"{comes}, of which condense {falls}; {where}, {end}"


def _celsius(T: float) -> str:
    return f"{T - ZERO_CELSIUS:.1f} °C"


FAN_CONTROL = {"constant": "at every flow", "flow": "at the rated flow, in proportion to the flow"}


def _unloaded(rated: Rating) -> str:
    idle = rated.unloaded
    if idle is None:
        return "not simulated (effects.air_package.unloaded says at which pressures)"
    if not idle.ok:
        return idle.result.told
    power = idle.result.performance[POWER]
    share = f", {_percent(power / rated.full.result.performance[POWER])} of that at full flow" if rated.full.ok else ""
    return f"{power / KW:.1f} kW unloaded{share}"


def _verdict(found: Regulation | None) -> tuple[str, str, bool | None] | None:
    if found is None:
        return None
    what = f"10 CFR 431.345, {found.coolant}-cooled, {found.speed} speed"
    asked = f"required: a package isentropic efficiency of at least {_percent(found.least, 1)}"
    if found.efficiency is None:
        return what, f"{asked}; no verdict: {found.why}", None
    if found.speed == "variable":
        loads = ", ".join(
            f"{_percent(value, 1)} at {_percent(load)} of full flow with the weight {WEIGHTS[load]:g}"
            for load, value in found.loads
        )
        text = f"part load {_percent(found.efficiency, 1)}: {loads}"
    else:
        text = f"full load {_percent(found.efficiency, 1)}"
    if not found.covered:
        return what, f"{text}; not covered: {found.why}", None
    return what, f"{text}; {asked}: {'met' if found.met else 'not met'}", found.met


def _notes(scene: Scene, points: list[Point]) -> Iterator[str]:
    yield from inlet_note(scene)
    if scene.gas.relative_humidity:
        yield HUMID_FIGURES
    yield from point_notes([(f"{point.speed / RPM:.0f} rpm", point) for point in points])
    yield DISCLAIMER


def inlet_note(scene: Scene) -> Iterator[str]:
    """Yield a note where the inlet of a package is another than that of data sheets."""
    at = lines(scene)
    if abs(at.p_s - REFERENCE_INLET[0]) > 1e-3 * REFERENCE_INLET[0] or abs(at.T_s - REFERENCE_INLET[1]) > 0.1:
        yield "rated at an inlet other than the 1 bar and 20 °C at which data sheets are compared"


def point_notes(points: Sequence[tuple[str, Point]]) -> Iterator[str]:
    """Yield failures and warnings of points, each with its name."""
    yield from (f"{name}: {point.result.told}" for name, point in points if not point.ok)
    yield from warning_lines([(name, point.result.warnings) for name, point in points])


def _figures(point: Point) -> dict[str, Any]:
    return {"speed": point.speed, **document_figures(point.result, DOCUMENT_FIGURES)}


def _document(scene: Scene, rated: Rating) -> dict[str, Any]:
    at, regulation = lines(scene), rated.regulation
    return {
        "kind": "air_package",
        "title": scene.title,
        "speed": "variable" if rated.variable else "fixed",
        "coolant": rated.coolant,
        "inlet_pressure": at.p_s,
        "inlet_temperature": at.T_s,
        **({} if scene.gas.relative_humidity is None else {"inlet_relative_humidity": scene.gas.relative_humidity}),
        "discharge_pressure": at.p_d,
        "points": [_figures(point) for point in rated.points],
        "unloaded": None if rated.unloaded is None else _figures(rated.unloaded),
        **lives_document(_named_points(rated)),
        **({"hottest_room": room_documents(rated.rooms)} if rated.rooms else {}),
        "regulation": None
        if regulation is None
        else {
            "name": "10 CFR 431.345",
            "least_efficiency": regulation.least,
            "efficiency": regulation.efficiency,
            "loads": [{"share": load, EFFICIENCY: value} for load, value in regulation.loads],
            "covered": regulation.covered,
            "met": regulation.met,
            "message": regulation.why,
        },
        "warnings": list(dict.fromkeys(warning for point in rated.points for warning in point.result.warnings)),
    }
