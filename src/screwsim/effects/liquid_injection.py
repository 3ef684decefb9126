"""Liquid injection: condensate enters the closed chamber through a bore and cools the gas by evaporating.

What: flow of liquid (M12 with the liquid's stiffness, which is √(2 ρ Δp); M100) from the condenser's liquid line into
the chamber; it mixes with the chamber's gas into equilibrium at once (M103). The liquid has the condenser's enthalpy,
and the condenser's pressure less the loss of the line. With `discharge_temperature` a thermostatic valve opens just so
far that the discharge has that temperature (M391).
Source: ours; orifice coefficient 0.61 of a sharp edge: textbook.
Assumptions: the liquid does not flash inside the bore; in the chamber it evaporates without delay. With gas.two_phase:
refuse the chamber has to stay dry, else the result is `failed` and names the angle; with equilibrium a wet chamber is
simulated. Valve and bore act as one orifice, steady over a turn, without a check valve: gas of a chamber above the
line's pressure is pushed back into it and condenses there; its heat leaves the machine.
Parameters: opens, closes, area, flow_coefficient, pressure_loss, discharge_temperature or opening.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from screwsim.effects.base import Drawn, Effect, Faults, FlowPath, Plenum, Site, Sought, Span
from screwsim.effects.oil_injection import discharge_pressure
from screwsim.effects.parts.gap import flow_coefficient
from screwsim.effects.parts.port_window import (
    CheckWithin,
    WindowParameters,
    check_window,
    lost_by_backflow,
    window_path,
)
from screwsim.effects.parts.usual import Sized
from screwsim.fluid import constants
from screwsim.fluid.models import condenses
from screwsim.fluid.reservoir import Reservoir
from screwsim.inputs.declare import FoundWithCycle, number, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import HOLES, SHELL, WIDEST
from screwsim.outputs import BESIDE, BESIDE_RATIO, Figure, power_figure
from screwsim.outputs.customary import celsius, in_bar, in_celsius

NAME, RATIO, HEAT_LOSS = "liquid_injection", "liquid_injection_flow_ratio", "liquid_injection_heat_loss"
DISCHARGE, MIXTURE = "discharge_temperature", "mixture_discharge_temperature"
SHARP_EDGE = 0.61
VALVE = 10.0  # [K] of the search coordinate for a factor e of the valve's opening
SHUT, FIRST_OPENING = 1e-4, 0.2  # least opening of the valve, and first guess of it
LATENT = 200.0  # [K] by which liquid of the same mass as the gas would roughly cool it
WARMS = 2.0  # approximate heat capacity of oil over that of gas
FIGURES = (
    Figure("liquid_injection_mass_flow", "kg s-1", "net flow of injected liquid", BESIDE, by_port=True),
    Figure(RATIO, "1", "injected liquid over net suction flow", BESIDE_RATIO, by_flow=True, by_port=True),
    Figure(
        "liquid_injection_opening",
        "1",
        "share of the bore's area that the thermostatic valve leaves open",
        needs=(".discharge_temperature",),
    ),
    power_figure(HEAT_LOSS, "heat of gas that is pushed back into the liquid line and condenses there"),
)


@dataclass(frozen=True)
class Parameters(WindowParameters, Sought):
    """The bore."""

    area: float = quantity("area", "area of the bore", gt=0.0)
    flow_coefficient: float = flow_coefficient("the bore (sharp edge: 0.61)", SHARP_EDGE)
    pressure_loss: float = quantity(
        "pressure_difference",
        "pressure loss of the liquid line from the condenser to the bore",
        0.0,
        ge=0.0,
        hardly=(None, 5e6),
    )
    discharge_temperature: float | None = optional(
        "temperature", "discharge temperature kept by a thermostatic valve, in place of opening (M391)"
    )
    opening: float | None = number("share of area that the valve leaves open", None, gt=0.0, le=1.0)

    # ---- an opening that is found (M391) -------------------------------------------------------------------------

    @property
    def is_open(self) -> bool:
        """Whether the valve's opening is to be found with the cycle."""
        return self.discharge_temperature is not None

    @property
    def stands(self) -> float | None:
        """Current search coordinate, `VALVE` times the logarithm of the opening [K]; None where it has none yet."""
        return VALVE * math.log(self.opening) if self.opening else None

    def span(self, facts: Any, suction_pressure: Callable[[], float]) -> Span:
        """Return the range of the coordinate: from all but shut to wide open."""
        return Span(VALVE * math.log(SHUT), 0.0)

    def first(self, span: Span) -> float:
        """Return a first guess of the coordinate."""
        return VALVE * math.log(FIRST_OPENING)

    def placed(self, x: float) -> dict[str, Any]:
        """Return the parameter that a coordinate stands for: the opening."""
        return {"opening": FoundWithCycle(math.exp(x / VALVE))}

    def off(self, figures: Mapping[str, Any], oil_follows: bool) -> tuple[float, float] | None:
        """Return the approximate error of the coordinate [K], by how much the liquid cools, and its scale `VALVE`.

        None where a figure that it needs has no value.
        """
        wanted, T, ratio = self.discharge_temperature or 0.0, _at_discharge(figures), figures.get(RATIO)
        if T is None or ratio is None:
            return None
        oil = 0.0 if oil_follows else figures.get("oil_ratio") or 0.0
        cools = max(ratio, 1e-6) * LATENT / (1.0 + WARMS * oil)
        return VALVE * math.log(max(1.0 + (T - wanted) / cools, 1e-3)), VALVE

    def idle(self, figures: Mapping[str, Any], x: float, lowest: bool) -> str:
        """Return a text that says that the valve stays shut, or is wide open, with actual and wanted temperature."""
        T = _at_discharge(figures)
        if T is None:
            return ""
        comes, wanted = map(celsius, (T, self.discharge_temperature or 0.0))
        if lowest:
            what = f"the liquid injection valve stays shut: without liquid the discharge is at {comes}"
            return f"{what}, not at {wanted} (lower effects.{NAME}.discharge_temperature, or remove it)"
        what = f"no flow of injected liquid brings the discharge to {wanted}: with the valve wide open it is at {comes}"
        return f"{what} (choose a larger effects.{NAME}.area, or a bore that opens earlier)"


def _at_discharge(figures: Mapping[str, Any]) -> float | None:
    """Return the temperature [K] of a sensor at discharge: of gas and oil mixed where that is known, else the gas's."""
    T = figures.get(MIXTURE)
    return figures.get(DISCHARGE) if T is None else T


def build(parameters: Parameters, machine) -> list[FlowPath | Plenum]:
    def state(site: Site) -> Reservoir:
        """Return the liquid behind the condenser."""
        return site.gas.liquid(site.p_d - parameters.pressure_loss, site.liquid_enthalpy)

    def figures(drawn: Drawn) -> dict[str, float | None]:
        found = {"liquid_injection_mass_flow": drawn.flow, RATIO: drawn.ratio, HEAT_LOSS: drawn.brought}
        return found if parameters.discharge_temperature is None else {**found, "liquid_injection_opening": opening}

    opening = parameters.opening
    bore = parameters if opening is None else replace(parameters, area=opening * parameters.area)
    return [window_path(NAME, bore), Plenum(NAME, state, figures, evaporates=True)]


def warnings(found: Mapping[str, Any]) -> Iterator[str]:
    """Yield a warning of gas that is pushed back into the liquid line."""
    yield from lost_by_backflow(found, HEAT_LOSS, "the liquid line")


def check(parameters: Parameters, facts) -> Faults:
    yield from check_window(NAME, parameters)
    if not condenses(facts.gas):
        yield Fault(f"effects.{NAME}", "an ideal gas has no liquid (write gas.model: real, or remove it)")
    if facts.operation.condensing_temperature is None:
        what = "needs the liquid of a condenser (state a compressor's lines by evaporating and condensing temperature)"
        yield Fault(f"effects.{NAME}", what)
    elif condenses(facts.gas) and facts.operation.gas_cooler is None:
        yield from _loss(parameters.pressure_loss, facts)
        yield from _thermostat(parameters, facts)


def _loss(loss: float, facts) -> Faults:
    """Yield a fault where the liquid would boil in its line, and so reach the bore as a mixture."""
    operation, fluid, p_d = facts.operation, facts.gas.name, discharge_pressure(facts)
    T_c, limits = operation.condensing_temperature, constants.limits(fluid)
    if not loss > 0.0 or p_d is None or limits is None or not limits.T_triple < T_c < limits.T_critical:
        return
    T = constants.condensed(fluid, T_c) - (operation.subcooling or 0.0)
    boils = constants.bubble_pressure(fluid, T)
    if p_d - loss < boils:
        most = f"liquid of {in_celsius(T)} boils in its line once it has lost {in_bar(p_d - boils)}"
        what = f"{in_bar(loss)}: {most}"
        yield Fault(f"effects.{NAME}.pressure_loss", f"{what} (a smaller loss, or more operation.subcooling)")


def _thermostat(parameters: Parameters, facts) -> Faults:
    """Yield what contradicts an opening that is found for a discharge temperature."""
    wanted, path = parameters.discharge_temperature, f"effects.{NAME}.discharge_temperature"
    if wanted is None:
        return
    if parameters.opening is not None and not isinstance(parameters.opening, FoundWithCycle):
        yield Fault(f"effects.{NAME}.opening", f"is given as well as {path}, which finds it (remove one of the two)")
    if wanted <= facts.operation.condensing_temperature:
        what = f"{in_celsius(wanted)} is not above condensation, {in_celsius(facts.operation.condensing_temperature)}"
        yield Fault(path, f"{what}: some liquid would not evaporate (raise it)")
    if facts.oil_supply is not None and facts.oil_supply.discharge_temperature is not None:
        what = "is stated as well as oil_supply.discharge_temperature: either oil or liquid can keep it, not both"
        yield Fault(path, f"{what} (remove one of the two)")


EFFECT = Effect(
    name=NAME,
    title="condensate, through a bore into the closed chamber",
    equations=("M12", "M13", "M100", "M101", "M103", "M391"),
    source="ours",
    parameters=Parameters,
    build=build,
    check=check,
    check_geometry=CheckWithin(NAME),
    needs=frozenset({HOLES}),
    figures=FIGURES,
    warnings=warnings,
    sizes=(Sized("area", SHELL, WIDEST, (0.0, 0.05)),),
    in_expander="never",
)
