"""The rating of an air package as a sheet: in the trade's order, metric beside American units."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from screwsim.effects.air_package import FREE_AIR, INPUT_POWER
from screwsim.effects.parts.coolant import FLOW as COOLANT
from screwsim.effects.parts.coolant import RISE as COOLANT_RISE
from screwsim.effects.parts.rating import WEIGHTS
from screwsim.inputs.suggestions import counted
from screwsim.outputs import Result
from screwsim.outputs.customary import MINUTE, RPM, with_printed_units
from screwsim.outputs.us_units import CFM, PSI
from screwsim.scene import Scene, with_values, without_sweep
from screwsim.scene.lines import lines
from screwsim.scene.operation import SPEED
from screwsim.study.datasheet.air_points import (
    EFFICIENCY,
    KW,
    PER_HUNDRED,
    SPECIFIC,
    Point,
    heads_of,
    point_row,
)
from screwsim.study.datasheet.air_pressures import named, pressures_document, pressures_tables
from screwsim.study.datasheet.air_rating import ELSEWHERE, Rating, Regulation, elsewhere
from screwsim.study.datasheet.air_year import Demand, year, year_document, year_table
from screwsim.study.datasheet.bearing_lives import LIFE_FIGURES, lives_document, lives_table
from screwsim.study.datasheet.bounds import Limit, motor_of, with_limits_of
from screwsim.study.datasheet.columns import GAS_OUT, MIXTURE
from screwsim.study.datasheet.hottest_room import room_documents, room_lines
from screwsim.study.datasheet.machine_lines import limits_in_words, load_in_words
from screwsim.study.datasheet.marks import marks_of
from screwsim.study.datasheet.sheet import Curve, Drawing, Sheet, Table, disclaimer, warning_lines
from screwsim.study.datasheet.tables import document_figures
from screwsim.study.datasheet.units import METRIC, Units

MOTOR_INLET = 0.898e5, 313.25  # Pa at 1000 m (ISO 2533), K: what motors are rated for
BEYOND_MOTORS = "motors are rated for 1000 m (0.9 bar) and 40 °C at the most (IEC 60034-1): beyond, ask for their load"
THIN_AIR = "conductance, approach and fan power are as stated, though thin air cools less"
GRAINS = 7000.0  # in a pound
SEPARATED, COOLED, PACKAGE_VAPOUR = "condensate_flow", "aftercooler_condensate_flow", "package_vapour_flow"
DOCUMENT_FIGURES = (
    FREE_AIR, INPUT_POWER, SPECIFIC, EFFICIENCY, "shaft_power", "electrical_power", "fan_power", "discharge_pressure",
    "intake_pressure", "package_discharge_temperature", "package_heat", "oil_cooler_duty", "oil_cooler_load",
    "aftercooler_duty", COOLANT, COOLANT_RISE, "package_discharge_pressure", MIXTURE, GAS_OUT, "oil_supply_temperature",
    "humidity_ratio", "pressure_dew_point", "package_dew_point", "water_flow", SEPARATED, COOLED, PACKAGE_VAPOUR,
    *LIFE_FIGURES,
)  # fmt: skip
HUMID_FIGURES = (
    "rated with humid air: free air delivery includes the water that condensed on the way, as volume at inlet "
    "humidity; data sheets are compared for dry air"
)
DISCLAIMER = disclaimer("ISO 1217")


def air_sheet(scene: Scene, rated: Rating, demands: Sequence[Demand] = ()) -> Sheet:
    """Return the sheet of a rating, with the energy of demands."""
    shares = year(rated, demands) if demands else ()
    limits = with_limits_of(
        with_values(without_sweep(scene), {SPEED: rated.full.speed}), [room.bound for room in rated.rooms]
    )
    every = [*rated.points, *([] if rated.unloaded is None else [rated.unloaded])]
    others = list(named(rated.pressures, lines(scene).p_s, rated.units))
    return Sheet(
        heading="Air package, rating by ISO 1217",
        title=with_printed_units(scene.title),
        lines=[*_lines(scene, rated), *limits_in_words(limits, rated.units)],
        tables=[
            _points_table(rated, limits),
            *pressures_tables(scene, rated.pressures, limits, rated.units),
            *([year_table(rated, shares, [motor_of(scene)])] if shares else []),
            *lives_table(_named_points(rated), units=rated.units),
        ],
        verdict=_verdict(rated.regulation),
        notes=list(_notes(scene, every, others)),
        drawings=list(drawings_of(rated)),
        document={**_document(scene, rated), **({"profile": year_document(shares, rated.receiver)} if shares else {})},
        ok=all(point.ok for point in [*every, *(point for _, point in others)]),
    )


def _points_table(rated: Rating, limits: Mapping[Limit, str]) -> Table:
    """Return the table of the points, those beyond a limit marked."""
    results = [point.result if point.ok else None for point in rated.points]
    marks = marks_of(limits, results)
    rows = [point_row(point, rated.full, rated.units) for point in rated.points]
    signed = [[f"{speed}{sign}", *cells] for (speed, *cells), sign in zip(rows, marks.column(results), strict=True)]
    return Table("Points", heads_of(rated.units), signed, marks.note(results, rated.units))


def _named_points(rated: Rating) -> list[tuple[str, Result]]:
    """Return the results of all points with their names, that of full flow first."""
    named = [(f"{point.rotor_speed / RPM:.0f} rpm", point.result) for point in rated.points]
    return named if rated.unloaded is None else [*named, ("zero flow", rated.unloaded.result)]


def drawings_of(rated: Rating) -> Iterator[Drawing]:
    """Yield the specific power over the flow, if there are two points or more."""
    good = [point for point in rated.points if point.flow > 0.0]
    flow, specific = (MINUTE, "m³/min"), (1.0 / (KW * MINUTE), "kW/(m³/min)")
    if rated.units != METRIC:
        flow, specific = (1.0 / CFM, "acfm"), (PER_HUNDRED / KW, "kW/(100 acfm)")
    found = [point.result.performance[SPECIFIC] for point in good]
    curve = Curve([flow[0] * point.flow for point in good], [specific[0] * each for each in found])
    label = f"Package specific power [{specific[1]}]"
    if len(good) > 1:
        yield Drawing(label, f"free air delivered [{flow[1]}]", label, [curve], from_zero=True)


def _percent(share: float, digits: int = 0) -> str:
    return f"{100.0 * share:.{digits}f} %"


def discharge_line(p_d: float, p_s: float, units: Units) -> tuple[str, str]:
    """Return the line on the discharge pressure [Pa]: absolute, and over that of the inlet."""
    over = p_d - p_s
    gauge = f"{1e-5 * over:.4g} bar ({over / PSI:.0f} psi)" if units == METRIC else f"{over / PSI:.1f} psi"
    return "discharge", f"{units.quantity('Pa', p_d)}, {gauge} over the inlet"


def _lines(scene: Scene, rated: Rating) -> Iterator[tuple[str, str]]:
    at, effects, units = lines(scene), scene.effects, rated.units
    heat = units.heat
    package, motor, full = effects["air_package"].parameters, motor_of(scene), rated.full
    speed = "fixed speed" if not rated.variable else f"variable speed, {counted(len(rated.points), 'point')}"
    yield "package", f"rotary, lubricated, {rated.coolant}-cooled, {speed}"
    humid = f", relative humidity {_percent(scene.gas.relative_humidity)}" if scene.gas.relative_humidity else ""
    yield "inlet", f"{units.quantity('Pa', at.p_s)}, {units.degrees(at.T_s, '.1f')}, {scene.gas.name}{humid}"
    yield discharge_line(at.p_d, at.p_s, units)
    found = full.result.performance if full.ok else {}
    load = load_in_words(motor, found["shaft_power"], full.rotor_speed, "at full flow") if found else ""
    inverter = " with its inverter" if motor.inverts else ""
    eta = f", efficiency{inverter} {_percent(found['motor_efficiency'], 1)}" if found else ""
    yield "motor", f"{units.quantity('W', motor.rated_power)} rated{load}{eta}"
    if (beyond := rated.overloaded) is not None:
        yield "speed", _carried_speed(full, beyond, motor.rated_power, units)
    if package.fan is not None:
        yield "fan", f"{units.quantity('W', package.fan.power)}, {FAN_CONTROL[package.fan.control]}"
    if found:
        behind = f"{loss_in_words(found['package_pressure_loss'], units)} behind the machine"
        before = found.get("intake_pressure_loss")
        before = "" if before is None else f"{loss_in_words(before, units)} before and "
        yield "losses", f"{before}{behind}, at full flow"
        if found.get("package_heat") is not None:
            oil = f"{heat.factor * found['oil_cooler_duty']:.1f} {heat.unit} of it in the oil cooler"
            load = found.get("oil_cooler_load")
            oil += "" if load is None else f", which is loaded to {_percent(load)}"
            yield "heat", f"{heat.factor * found['package_heat']:.1f} {heat.unit} at full flow, {oil}"
            if (mixed := found.get(MIXTURE)) is not None:
                alone = f"the air alone at {units.degrees(found[GAS_OUT], '.1f')}"
                yield "mixture", f"air and oil at {units.degrees(mixed, '.1f')}, {alone}"
            if (flow := found.get(COOLANT)) is not None:
                shown = units.swept.factor * flow
                what = f"{shown:{'.0f' if shown > 100.0 else '.3g'}} {units.swept.unit} of {package.coolant.medium}"
                yield "coolant", f"{what}, warmed by {units.difference(found[COOLANT_RISE])}, at full flow"
            yield "outlet", f"air at {units.degrees(found['package_discharge_temperature'], '.1f')}"
        if humid:
            yield "water", _water(found, units)
    yield from room_lines(rated.rooms, units, bool(scene.gas.relative_humidity))
    yield "zero flow", _unloaded(rated)


def _carried_speed(full: Point, beyond: Point, rated: float, units: Units) -> str:
    """Return in words that the motor carries full flow only at a lower speed than the highest stated."""
    power = beyond.result.performance["shaft_power"]
    taken = f"{units.quantity('W', power)} ({_percent(power / rated)})"
    stated = f"{beyond.rotor_speed / RPM:.0f} rpm of the sweep"
    return (
        f"full flow at {full.rotor_speed / RPM:.0f} rpm, the highest that the motor carries: the {stated} take {taken}"
    )


def loss_in_words(pressure: float, units: Units) -> str:
    """Return a loss of pressure in words."""
    return f"{1e-2 * pressure:.0f} mbar" if units == METRIC else f"{pressure / PSI:.2f} psi"


def _water(found: Mapping[str, Any], units: Units) -> str:
    """Return in words where the water of humid air goes, at full flow."""
    factor, unit = units.mass_flow
    mass, whole = ("g", 1e3) if units == METRIC else ("grains", GRAINS)
    brought, ratio = factor * found["water_flow"], whole * found["humidity_ratio"]
    parts = {"the separator": found[SEPARATED], "the aftercooler": found.get(COOLED)}
    falls = " and ".join(f"{factor * flow:.1f} in {name}" for name, flow in parts.items() if flow is not None)
    where = f"pressure dew point {units.degrees(found['pressure_dew_point'], '.1f')} in the separator"
    end = f"{units.degrees(found['package_dew_point'], '.1f')} at the outlet"
    comes = f"{ratio:.1f} {mass} per {unit.removesuffix('/h')} of dry air, {brought:.1f} {unit} at full flow"
    return f"{comes}, of which condense {falls}; {where}, {end}"


FAN_CONTROL = {"constant": "at every flow", "flow": "at the rated flow, in proportion to the flow"}


def _unloaded(rated: Rating) -> str:
    idle = rated.unloaded
    if idle is None:
        return "not simulated (effects.air_package.unloaded says at which pressures)"
    if not idle.ok:
        return idle.result.told
    power = idle.power
    share = f", {_percent(power / rated.full.power)} of that at full flow" if rated.full.ok else ""
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


def _notes(scene: Scene, points: list[Point], others: Sequence[tuple[str, Point]]) -> Iterator[str]:
    yield from inlet_note(scene)
    if scene.gas.relative_humidity:
        yield HUMID_FIGURES
    yield from point_notes([*((f"{point.rotor_speed / RPM:.0f} rpm", point) for point in points), *others])
    yield DISCLAIMER


def inlet_note(scene: Scene) -> Iterator[str]:
    """Yield notes where the inlet of a package is another than that of data sheets, or than motors are rated for."""
    if elsewhere(scene):
        yield ELSEWHERE
    at = lines(scene)
    if at.p_s < MOTOR_INLET[0] or at.T_s > MOTOR_INLET[1]:
        yield BEYOND_MOTORS
    if at.p_s < MOTOR_INLET[0]:
        yield THIN_AIR


def point_notes(points: Sequence[tuple[str, Point]]) -> Iterator[str]:
    """Yield failures and warnings of points, each with its name."""
    yield from (f"{name}: {point.result.told}" for name, point in points if not point.ok)
    yield from warning_lines([(name, point.result.warnings) for name, point in points])


def _figures(point: Point) -> dict[str, Any]:
    return {"speed": point.rotor_speed, **document_figures(point.result, DOCUMENT_FIGURES)}


def _document(scene: Scene, rated: Rating) -> dict[str, Any]:
    at, regulation = lines(scene), rated.regulation
    return {
        "kind": "air_package",
        "title": scene.title,
        "speed": "variable" if rated.variable else "fixed",
        "coolant": rated.coolant,
        **({"bounded_by_motor": rated.overloaded is not None} if rated.variable else {}),
        "inlet_pressure": at.p_s,
        "inlet_temperature": at.T_s,
        **({} if scene.gas.relative_humidity is None else {"inlet_relative_humidity": scene.gas.relative_humidity}),
        "discharge_pressure": at.p_d,
        "points": [_figures(point) for point in rated.points],
        **({"pressures": pressures_document(rated.pressures, _figures)} if rated.pressures else {}),
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
