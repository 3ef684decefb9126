"""A scene's gas, oil and lines in words."""

import math
from collections.abc import Iterator

from screwsim.build import open_temperatures, package_of
from screwsim.effects.parts.oil import oil_in_chambers
from screwsim.explain.parameters import parameters_text, row
from screwsim.fluid import constants
from screwsim.fluid.composition import is_blend
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.moist_air import DRIEST, MoistAir
from screwsim.inputs.declare import KINDS
from screwsim.model.parts import Parts
from screwsim.outputs.customary import in_bar, in_celsius
from screwsim.scene.lines import lines
from screwsim.scene.types import Scene
from screwsim.scene.units import Gauge, readable_quantity

TRANSPORT = {
    "paper": "paper: the ratio d stays constant after {at} (M9); leaking gas makes oil appear and vanish",
    "carried": "carried: oil mass is a state, and leaks carry oil from the donor chamber (M8, M9)",
}


def gas_rows(scene: Scene, parts: Parts) -> Iterator[str]:
    """Yield the rows on the gas, its lines, and what cools it."""
    gas = parts.gas
    equations = f" ({', '.join(gas.equations)})" if gas.equations else ""
    model = f"gas of {scene.gas.model}" if "." in scene.gas.model else f"{scene.gas.model} gas"
    yield row(scene.gas.name, f"{model}{equations}")
    dry = gas.dry if isinstance(gas, MoistAir) else gas
    if isinstance(dry, IdealGas):
        given = "given" if scene.gas.isentropic_exponent is not None else "cp0/(cp0 - R) at suction temperature"
        yield row("", f"R = {dry.R:.6g} J/(kg K), k = {dry.k:.6g} ({given})")
    if isinstance(gas, MoistAir):
        yield from _water_rows(scene, gas)
    known = constants.limits(scene.gas.name) if is_blend(scene.gas.name) else None
    if known is not None and known.gas_only:
        yield row("", f"known as a gas only, from {in_celsius(known.T_critical)} on (M317)")
    yield from _line_rows(scene)
    yield from _cooling_rows(scene)


def _water_rows(scene: Scene, gas: MoistAir) -> Iterator[str]:
    humid = f"relative humidity {scene.gas.relative_humidity:g} of the suction line"
    yield row("water", f"{gas.humidity_ratio:.5g} per mass of dry air ({humid}, M320)")
    where = "discharge pressure" if package_of(scene) is None else "the outlet's pressure, for the intake air"
    dew = gas.dew_point(lines(scene).p_d)
    yield row("dew point", f"{f'below {in_celsius(DRIEST)}' if dew is None else in_celsius(dew)} at {where} (M327)")


def _line_rows(scene: Scene) -> Iterator[str]:
    """Yield the rows on the suction line, the surroundings, the discharge line, and a package around them."""
    at, operation = lines(scene), scene.operation
    condensing = "dew" if is_blend(scene.gas.name) else "bubble"
    suction = _saturation_remark(operation.evaporating_temperature, "dew")
    discharge = _saturation_remark(operation.condensing_temperature, condensing)
    suction = suction or _gauge_remark(scene, operation.suction.pressure)
    discharge = discharge or _gauge_remark(scene, operation.discharge.pressure)
    yield row("suction line", f"{in_bar(at.p_s)}{suction}, {in_celsius(at.T_s)}")
    yield row(
        "surroundings", f"{in_celsius(operation.ambient_temperature)}, the reference of the ledger's exergy (M59)"
    )
    T_d = operation.discharge.temperature
    back = "the mean temperature of the outflow (M27)" if T_d is None else readable_quantity(KINDS["temperature"], T_d)
    yield row("discharge line", f"{in_bar(at.p_d)}{discharge}; backflow has {back}")
    if package_of(scene) is not None:
        yield row(
            "package", "both lines are the package's; its losses up to the machine are found with the cycle (M341-M343)"
        )


def _cooling_rows(scene: Scene) -> Iterator[str]:
    operation, cooler = scene.operation, scene.operation.gas_cooler
    if operation.condensing_temperature is not None:
        subcooling = readable_quantity(KINDS["temperature_difference"], operation.subcooling or 0.0)
        yield row("cooling", f"liquid subcooled by {subcooling}; enthalpies of the real fluid (M43)")
    if cooler is not None:
        T = readable_quantity(KINDS["temperature"], cooler.outlet_temperature)
        yield row("cooling", f"leaves the gas cooler at {T}; enthalpies of the real fluid (M330)")


def _gauge_remark(scene: Scene, p: float | None) -> str:
    """Return the remark on a pressure that was stated as a gauge pressure."""
    ambient = readable_quantity(KINDS["pressure"], scene.operation.ambient_pressure)
    return f" ({p.written} above ambient {ambient})" if isinstance(p, Gauge) else ""


def _saturation_remark(T: float | None, point: str) -> str:
    """Return the remark on a line whose pressure is that of saturation at T [K] (M42)."""
    return "" if T is None else f" ({point} point at {in_celsius(T)}, M42)"


def oil_rows(scene: Scene, parts: Parts) -> Iterator[str]:
    oil, supply = scene.oil, scene.oil_supply
    if oil is None or supply is None:
        yield row("none", "no oil is injected")
        return
    yield row("oil", parameters_text(oil, skip=("transport",)))
    port = parts.oil_port
    at = f"{math.degrees(parts.geometry.injection_angle):g} deg"
    if port is not None:
        at = f"a port up to {math.degrees(port.closes):g} deg"
    behind = "" if supply.line is None else ", after its line (M392)"
    equation = f"its ratio d at {at} is given" if supply.pumped else f"set by the orifice (M30){behind}"
    equation = "it comes in with the gas, in the ratio d (M490)" if parts.geometry.expands else equation
    equation = equation if supply.discharge_temperature is None else f"its ratio d at {at} is found (M370)"
    equation = equation if supply.flow is None else f"its ratio d at {at} is found (M393)"
    foreign = ("kind", "orifice_count") if supply.pumped else ("kind", "source")
    yield row("supply", f"{supply.kind}: {equation}; {parameters_text(supply, skip=foreign)}")
    if supply.temperature is None:
        outlet = "that of the cooler's outlet (M283)"
        found = "found with the cycle (M284)" if open_temperatures(scene).supply else outlet
        yield row("temperature", found)
    if parts.oil_room:
        work = "contains its flow work (M491)" if parts.geometry.expands else "raises it to discharge pressure"
        yield row("room", f"the oil displaces gas in the chambers (M106); the indicated work {work}")
    heated = oil_in_chambers(scene.effects)
    text = TRANSPORT.get(oil.transport, oil.transport).format(at=at)
    yield row("transport", text if heated else "oil exchanges no heat and is not in the balances (no oil_heat)")
