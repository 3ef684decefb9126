"""Air package: filter, valves, separator element, aftercooler and fan around the machine, rated by ISO 1217.

What: the lines stated in the scene are those of the package: suction is its inlet, discharge its outlet. Each part that
is named causes a pressure loss in proportion to the square of the free air delivered (M340, M341), so that the machine
sucks in below and discharges above the stated pressures (M342); flow and losses are solved for together (M343). A
minimum-pressure valve keeps the pressure upstream of it at its setting. Input power is that of motor, inverter and fan
(M345); specific power and isentropic efficiency are those of ISO 1217 (M346, M347). The heat that leaves the package
follows from the first law (M348), that of the aftercooler from its approach (M344); with `coolant`, so does the flow of
the air or water that carries it away, or by how much that warms up. Unloaded, the inlet valve leaves a
stated pressure to the machine, the separator is blown down to another, and nothing is delivered. Humid air includes the
water that condenses on its way (M360), which is drained where it falls out (M361); the aftercooler takes its heat too
(M362).
Source: ISO 1217:2009 with amendment 1:2016 (terms; isentropic power with the exponent 1.4 of air); turbulent loss
(textbook). The parts have no default losses: the scene states them.
Assumptions: losses do not depend on density, so they belong to one pressure level; nothing leaks, and nothing but
condensate drains, between the machine and the outlet; what cools the aftercooler is as warm as the inlet unless another
temperature is stated; the fan's power heats the cooling air.
Other figures, and the ledger, are those of the machine, from the inlet to the pressure to which it discharges.
Parameters: rated_flow; inlet_filter, inlet_valve, separator_element, minimum_pressure_valve, aftercooler, fan, coolant;
state, unloaded.
"""

from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, Given, LosesPressure, PressureLosses, Reading, SuctionChange
from screwsim.effects.parts import coolant as cooling
from screwsim.effects.parts.lines import BLOWN_OFF
from screwsim.effects.parts.rating import isentropic_power
from screwsim.fluid.settings import AIR
from screwsim.inputs.declare import choice, quantity
from screwsim.inputs.faults import Fault, QuantityNotFound
from screwsim.outputs import (
    AFTERCOOLED,
    CHANGED,
    CONDENSED,
    HUMID,
    NET_FLOW,
    Figure,
    efficiency,
    names_of,
    over,
    power_figure,
)

NAME = "air_package"
SEPARATED = ("effects.separator",)
BEFORE = "inlet_filter", "inlet_valve"
STEP = 10.0  # [K] over which the heat capacity of the room's air is taken
MOST = 0.5  # largest share of the suction pressure that filter and valve may lose at rated flow
NO_AIR = "ISO 1217 defines the isentropic power for air, and the gas is {fluid}"
NONE_DELIVERED = "no net gas is delivered"
UNLOADED = "unloaded"
OF_HEAT = "package_discharge_temperature", "aftercooler_duty", "package_heat"
NO_POWER = "the package's input power is not positive"

FREE_AIR, INPUT_POWER = "free_air_delivered", "package_input_power"
FIGURES = (
    Figure(
        FREE_AIR,
        "m3 s-1",
        "flow delivered at the package's outlet, as volume at inlet conditions",
        NET_FLOW,
        by_flow=True,
        shown="m3 min-1",
    ),
    power_figure(INPUT_POWER, "electrical power of motor, inverter and fan"),
    Figure("package_specific_power", "W s m-3", "input power over free air delivered", NET_FLOW, by_flow=True),
    efficiency("package_isentropic_efficiency", "isentropic power of ISO 1217 over input power", by_flow=True),
    Figure("package_discharge_pressure", "Pa", "pressure at the package's outlet"),
    Figure("package_pressure_loss", "Pa", "pressure loss of the package after the machine", over("discharge_pressure")),
    Figure(
        "intake_pressure_loss",
        "Pa",
        "pressure loss of filter and valve before the machine",
        over("suction_pressure"),
        (".inlet_filter", ".inlet_valve", ".state: unloaded"),
    ),
    power_figure("fan_power", "power of the fan", needs=(".fan",)),
    Figure("package_discharge_temperature", "K", "temperature of the air at the package's outlet", needs=SEPARATED),
    power_figure("aftercooler_duty", "heat removed by the aftercooler", needs=(".aftercooler",)),
    power_figure("package_heat", "heat that leaves the package by other ways than its air", needs=SEPARATED),
    *cooling.FIGURES,
)
OF_WATER = (  # computed with the package's water balance (M361)
    Figure(
        "package_vapour_flow",
        "kg s-1",
        "water that leaves as vapour at the package's outlet",
        CONDENSED,
        HUMID,
        shown="kg h-1",
    ),
    Figure("package_dew_point", "K", "dew point of the air at the package's outlet", needs=HUMID),
)


@dataclass(frozen=True)
class PressureLoss:
    """A part with a pressure loss."""

    pressure_loss: float = quantity(
        "pressure_difference", "pressure loss at rated_flow", ge=0.0, le=5e5, hardly=(None, 1e5)
    )


@dataclass(frozen=True)
class MinimumPressureValve(PressureLoss):
    """A valve that opens when the pressure upstream is high enough for oil to flow."""

    pressure: float | None = quantity(
        "pressure", "lowest absolute pressure that it maintains upstream", None, gt=0.0, le=1e8
    )


@dataclass(frozen=True)
class Aftercooler(PressureLoss):
    """A cooler of the delivered air, after the minimum-pressure valve."""

    approach: float = quantity(
        "temperature_difference",
        "temperature of the air leaving it, less that of its coolant",
        ge=0.0,
        hardly=(1.0, 30.0),
    )
    coolant_temperature: float | None = quantity(
        "temperature",
        "temperature of the water or air that cools it (absent: that of the package's inlet)",
        None,
        ge=200.0,
        le=500.0,
        hardly=(250.0, 330.0),
    )


@dataclass(frozen=True)
class Unloaded:
    """A package that runs but delivers nothing: its inlet valve is nearly shut, its separator blown down."""

    intake_pressure: float = quantity("pressure", "absolute pressure after the inlet valve", gt=0.0, le=1e8)
    separator_pressure: float = quantity("pressure", "absolute pressure to which the machine delivers", gt=0.0, le=1e8)
    venting_time: float | None = quantity(
        "time", "time in which the separator is blown down, for data sheets (M471)", None, gt=0.0, hardly=(1.0, 300.0)
    )
    separator_volume: float | None = quantity(
        "volume", "gas space of the separator, refilled on loading, for data sheets", None, gt=0.0, hardly=(1e-3, 10.0)
    )


@dataclass(frozen=True)
class Fan:
    """The fan of the coolers, supplied at the package's terminals."""

    power: float = quantity("power", "its electrical power at rated_flow", ge=0.0)
    control: str = choice("constant, or in proportion to the flow", ("constant", "flow"), "constant")


@dataclass(frozen=True)
class Parameters(LosesPressure):
    """What lies around the machine; what is not named takes nothing."""

    rated_flow: float = quantity("volume_flow", "V_r: free air delivered at which the losses are stated", gt=0.0)
    state: str = choice("loaded, or unloaded as section unloaded states", ("loaded", UNLOADED), "loaded")
    unloaded: Unloaded | None = None
    inlet_filter: PressureLoss | None = None
    inlet_valve: PressureLoss | None = None
    separator_element: PressureLoss | None = None
    minimum_pressure_valve: MinimumPressureValve | None = None
    aftercooler: Aftercooler | None = None
    fan: Fan | None = None
    coolant: cooling.Coolant | None = None

    @property
    def at_rated_flow(self) -> float:
        """Flow [m³/s] at the inlet with which the search for the losses begins."""
        return self.rated_flow

    @property
    def delivers(self) -> bool:
        """Whether the package delivers; unloaded, the gas that the machine moves is blown off."""
        return self.state != UNLOADED

    def cooled(self, T: float, inlet: float) -> float | None:
        """Return the temperature [K] behind the aftercooler of air that enters at T; `inlet` is the package's (M344).

        None where there is no aftercooler.
        """
        if self.aftercooler is None:
            return None
        return min(T, self.coolant_enters(inlet) + self.aftercooler.approach)

    def coolant_enters(self, inlet: float) -> float:
        """Return the temperature [K] of what cools the aftercooler: stated, or that of the package's `inlet`."""
        stated = None if self.aftercooler is None else self.aftercooler.coolant_temperature
        return inlet if stated is None else stated

    def rated(self, *names: str) -> float:
        """Return the pressure loss [Pa] of the named parts at rated flow."""
        parts = (getattr(self, name) for name in names)
        return sum(part.pressure_loss for part in parts if part is not None)

    def losses(self, flow: float, inlet: float, outlet: float) -> PressureLosses:
        """Return the pressure losses at a flow at the inlet [m³/s], given both pressures [Pa] (M341, M342)."""
        if self.state == UNLOADED and self.unloaded is not None:
            return PressureLosses(inlet - self.unloaded.intake_pressure, self.unloaded.separator_pressure - outlet)
        share, valve = (flow / self.rated_flow) ** 2, self.minimum_pressure_valve
        before_valve = outlet + share * self.rated("minimum_pressure_valve", "aftercooler")
        if valve is not None and valve.pressure is not None:
            before_valve = max(before_valve, valve.pressure)
        machine = before_valve + share * self.rated("separator_element")
        return PressureLosses(share * self.rated(*BEFORE), machine - outlet)


def fan_power(parameters: Parameters, flow: float) -> float:
    """Return the fan's power [W] at a flow at the inlet [m³/s] (M345)."""
    fan = parameters.fan
    if fan is None:
        return 0.0
    return fan.power * (max(flow, 0.0) / parameters.rated_flow if fan.control == "flow" else 1.0)


def read(parameters: Parameters, known) -> Given:
    """Return the figures of ISO 1217 and the package's balance of power and heat (M340, M345–M347)."""
    found, losses = known.found, known.package
    flow = found["gas_mass_flow"] / known.suction_density
    inlet, outlet = found["suction_pressure"], found["discharge_pressure"] - losses.behind
    blown = fan_power(parameters, flow)
    power = found["electrical_power"] + blown
    idle = BLOWN_OFF if parameters.state == UNLOADED else ""
    why = idle or (NONE_DELIVERED if flow <= 0.0 else "" if power > 0.0 else NO_POWER)
    of_air = "" if known.fluid.lower() == AIR else NO_AIR.format(fluid=known.fluid)
    heats = _heats(parameters, known, outlet, power)
    return {
        FREE_AIR: 0.0 if idle else flow,
        INPUT_POWER: power,
        "package_specific_power": why or power / flow,
        "package_isentropic_efficiency": why or of_air or isentropic_power(flow, inlet, outlet) / power,
        "package_discharge_pressure": outlet,
        "package_pressure_loss": idle or losses.behind,
        "intake_pressure_loss": losses.before,
        "fan_power": blown,
        **heats,
        **_cooled_by(parameters, known, heats),
    }


def _cooled_by(parameters: Parameters, known, heats: Given) -> Given:
    """Return flow and rise of what carries the heat away; air of the room is as warm as the inlet."""
    if parameters.coolant is None:
        return {}
    heat, duty, found = heats["package_heat"], heats["aftercooler_duty"], known.found
    if isinstance(duty, float) and parameters.coolant.medium == cooling.WATER:
        heat = (found.get("oil_cooler_duty") or 0.0) + duty
    p, T = found["suction_pressure"], found["suction_temperature"]
    c_p = (known.enthalpy(p, T + STEP) - known.enthalpy(p, T)) / STEP
    return parameters.coolant.figures(heat, known.suction_density * c_p)


def _judge(parameters: Parameters, known) -> tuple[str, tuple[str, ...]]:
    """Return no verdict, and a warning of a coolant that would leave warmer than what it cools."""
    found = known.found
    rise, hot, inlet = (found.get(name) for name in (cooling.RISE, "separator_temperature", "suction_temperature"))
    if parameters.coolant is None or rise is None or hot is None:
        return "", ()
    return "", parameters.coolant.told(rise, hot - parameters.coolant_enters(inlet))


def _heats(parameters: Parameters, known, outlet: float, power: float) -> Given:
    """Return outlet temperature [K], duty of the aftercooler and heat of the package [W] (M344, M348, M362).

    They follow from the separator's temperature; where no effect finds that, each is a text that says so.
    """
    found = known.found
    T, flow = found.get("separator_temperature"), found["gas_mass_flow"]
    if T is None:
        return dict.fromkeys(OF_HEAT, "the separator does not separate gas and oil")
    T_1 = found["suction_temperature"]
    h_1, h = known.enthalpy(found["suction_pressure"], T_1), known.enthalpy(found["discharge_pressure"], T)
    if parameters.state == UNLOADED:  # the gas that the machine moves is blown off at the separator's temperature
        return dict(zip(OF_HEAT, (BLOWN_OFF, 0.0, power - flow * (h - h_1)), strict=True))
    cooled = parameters.cooled(T, T_1)
    T_2 = T if cooled is None else cooled
    share, passed = known.drained(found["discharge_pressure"], T)  # water that has condensed before leaves at T
    try:
        h_2 = h - share * passed.enthalpy(found["discharge_pressure"], T) + share * passed.enthalpy(outlet, T_2)
    except QuantityNotFound as wrong:
        return dict.fromkeys(OF_HEAT, f"behind the aftercooler {wrong}")
    h_2 = min(h_2, h)  # a cooler never heats: uncooled air keeps its enthalpy
    return dict(zip(OF_HEAT, (T_2, flow * (h - h_2), power - flow * (h_2 - h_1)), strict=True))


def build(parameters: Parameters, machine) -> list[Reading | SuctionChange]:
    named = parameters.state == UNLOADED or any(getattr(parameters, name) is not None for name in BEFORE)
    reading = Reading(
        names_of(FIGURES), lambda known: read(parameters, known), judge=lambda known: _judge(parameters, known)
    )
    return [reading, *([SuctionChange(package=True)] if named else [])]


def check(parameters: Parameters, facts) -> Faults:
    path = f"effects.{NAME}"
    if "motor" not in facts.effects:
        what = "needs effects.motor, whose electrical power is the package's"
        yield Fault(path, f"{what} (add it, e.g. rated_power: 75 kW)")
    if parameters.aftercooler is not None and "separator" not in facts.effects:
        yield Fault(f"{path}.aftercooler", "needs effects.separator, which finds the temperature of the air (add it)")
    if parameters.aftercooler is not None and facts.operation.aftercooler_temperature is not None:
        what = f"{path}.aftercooler already states the temperature of the air, by its approach"
        yield Fault("operation.aftercooler_temperature", f"{what} (remove one of the two)")
    yield from _coolant_faults(parameters, facts, f"{path}.coolant")
    p_s, idle = facts.operation.suction.pressure, parameters.unloaded
    if idle is None and parameters.state == UNLOADED:
        remedy = "write e.g. {intake_pressure: 0.12 bar, separator_pressure: 2.5 bar}"
        yield Fault(f"{path}.{UNLOADED}", f"is missing, and state: unloaded needs it ({remedy})")
    if idle is not None and not idle.intake_pressure < idle.separator_pressure:
        yield Fault(f"{path}.{UNLOADED}.separator_pressure", "is not above intake_pressure (raise it)")
    if idle is not None and p_s is not None and idle.intake_pressure > p_s:
        what = f"lies above the {1e-5 * p_s:.4g} bar of the inlet, and a valve can only lower the pressure"
        yield Fault(f"{path}.{UNLOADED}.intake_pressure", f"{what} (lower it)")
    if p_s is not None and parameters.rated(*BEFORE) >= MOST * p_s:
        part = next(name for name in BEFORE if getattr(parameters, name) is not None)
        what = f"filter and valve would lose {1e-5 * parameters.rated(*BEFORE):.4g} bar of the {1e-5 * p_s:.4g} bar"
        yield Fault(f"{path}.{part}.pressure_loss", f"{what} before them at rated_flow (choose less than half)")


def _coolant_faults(parameters: Parameters, facts, path: str) -> Faults:
    """Yield what a coolant lacks, or states twice."""
    coolant = parameters.coolant
    if coolant is None:
        return
    if (coolant.temperature_rise is None) == (coolant.flow is None):
        what = "needs one of temperature_rise and flow, of which the other follows"
        yield Fault(path, f"{what} (write e.g. {{temperature_rise: 15 K}})")
    if "separator" not in facts.effects:
        yield Fault(path, "needs effects.separator, by which the heat of the package is known (add it)")
    p_s = facts.operation.suction.pressure
    if coolant.medium == cooling.AIR and p_s is not None and p_s > cooling.DENSEST_ROOM:
        what = f"is air of the inlet's state, and no room has {1e-5 * p_s:.4g} bar"
        yield Fault(f"{path}.medium", f"{what} (write medium: water, or state the coolant of the first stage)")


EFFECT = Effect(
    name=NAME,
    title="filter, valves, coolers and fan around the machine; ISO 1217",
    equations=tuple(f"M{number}" for number in (*range(340, 349), *range(360, 363))),
    source="ISO 1217",
    parameters=Parameters,
    build=build,
    check=check,
    figures=(*FIGURES, *OF_WATER),
    roles={AFTERCOOLED[1]: ".aftercooler", CHANGED[0]: ".inlet_filter"},
    in_expander="never",
)
