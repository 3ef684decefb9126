"""Economizer: vapour from an intermediate pressure enters the closed chamber through a port (superfeed).

What: nozzle flow (M12, M100) between the chamber and a plenum of vapour at the economizer's saturation temperature; the
vapour comes from the liquid of the condenser, which it subcools in a heat exchanger, or from a flash tank (M102).
Source: port: ours; cycle: textbook (two-stage expansion with one compressor).
Assumptions: the plenum keeps its state, however much the port draws. The vapour that the port draws and the vapour that
the liquid makes need not agree: economizer_draw_ratio is their ratio, and it is 1 at the temperature at which a real
economizer settles. Gas that is pushed back into the plenum is cooled to the plenum's state; its heat leaves the machine
or evaporates liquid (M440).
Parameters: temperature (saturation) or pressure, superheat, opens, closes, area, flow_coefficient, kind, approach,
backflow.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from screwsim.effects.base import Drawn, Effect, Faults, FlowPath, Given, Plenum, Site, Sought, Span
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
from screwsim.fluid.reservoir import Reservoir
from screwsim.inputs.declare import FoundWithCycle, choice, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import HOLES, SHELL, WIDEST
from screwsim.outputs import BESIDE, BESIDE_RATIO, NEEDS_CONDENSER, Figure, Scale, power_figure
from screwsim.outputs.customary import celsius, in_bar, in_celsius

NAME = "economizer"
HEAT_EXCHANGER, FLASH_TANK = "heat_exchanger", "flash_tank"
GIVEN_AWAY, EVAPORATES = "given_away", "evaporates"
GAIN = "economizer_capacity_gain"
DRAW = "economizer_draw_ratio"
HEAT_LOSS = "economizer_heat_loss"
LACKING = "economizer_heat_lacking"
DRAWN_TOO_MUCH = 0.02  # relative excess of the drawn vapour over that which the liquid makes, above which is warned
PER_FOLD = 8.0  # [K] approximate error of the temperature when the port draws e times the vapour there is
SETTLED = 2e-3  # largest relative difference of vapour drawn and given off with which a temperature counts as found
APART = 0.5  # [K] least distance of a temperature that is found from both lines' and from the liquid's
# the error of a draw ratio is relative to 1 (all vapour that the liquid makes) at least
OF_VAPOUR = Scale(1.0, times="filling")
_over_each_other = partial(Figure, by_flow=True, by_port=True)  # ratio of two flows: its error follows both
FIGURES = (
    Figure("economizer_temperature", "K", "saturation temperature in the economizer"),
    Figure("economizer_pressure", "Pa", "pressure in the economizer"),
    Figure("economizer_mass_flow", "kg s-1", "net mass flow from the economizer", BESIDE, by_port=True),
    _over_each_other("economizer_flow_ratio", "1", "economizer flow over net suction flow", BESIDE_RATIO),
    _over_each_other(
        DRAW, "1", "vapour drawn by its port, over the vapour that the liquid gives off", OF_VAPOUR, NEEDS_CONDENSER
    ),
    _over_each_other(
        GAIN, "1", "cooling capacity that the economizer adds, at the same suction flow", BESIDE_RATIO, NEEDS_CONDENSER
    ),
    power_figure(HEAT_LOSS, "heat that gas pushed back into the economizer loses there"),
    power_figure(
        LACKING,
        "heat for the vapour drawn beyond what the liquid gives off, taken from the condenser's",
        needs=NEEDS_CONDENSER,
    ),
)


@dataclass(frozen=True)
class Parameters(WindowParameters, Sought):
    """The port, and the economizer behind it."""

    area: float = quantity("area", "area of the port", gt=0.0)
    flow_coefficient: float = flow_coefficient("the port", 1.0)
    temperature: float | None = quantity(
        "temperature",
        "saturation temperature in the economizer; auto: the one at which its port draws as much vapour as the liquid "
        "gives off (M371)",
        None,
        gt=0.0,
        auto=True,
    )
    pressure: float | None = quantity(
        "pressure", "pressure of the vapour, in place of temperature; auto: as for temperature", None, gt=0.0, auto=True
    )
    superheat: float = quantity(
        "temperature_difference", "superheat of the vapour, above temperature", 0.0, ge=0.0, hardly=(None, 60.0)
    )
    kind: str = choice(
        "heat_exchanger: the liquid is subcooled at its own pressure; flash_tank: it flashes to the economizer's "
        "pressure",
        (HEAT_EXCHANGER, FLASH_TANK),
        HEAT_EXCHANGER,
    )
    approach: float = quantity(
        "temperature_difference", "temperature of the subcooled liquid, less temperature (heat_exchanger)", 5.0, ge=0.0
    )
    backflow: str = choice(
        "heat of gas that is pushed back; given_away: it leaves the machine; evaporates: it evaporates liquid (M440)",
        (GIVEN_AWAY, EVAPORATES),
        GIVEN_AWAY,
    )

    def __post_init__(self):
        """Where the pressure is to be found (`auto`), find the temperature in its place: they are one state."""
        if isinstance(self.pressure, FoundWithCycle) and self.temperature is None:
            object.__setattr__(self, "temperature", FoundWithCycle(self.pressure))
            object.__setattr__(self, "pressure", None)

    @property
    def boils(self) -> bool:
        """Whether the liquid boils down to the economizer's pressure (flash tank)."""
        return self.kind == FLASH_TANK

    @property
    def nearest(self) -> float:
        """Least difference [K] between the cooled liquid and the saturation temperature."""
        return 0.0 if self.boils else self.approach

    # ---- a temperature that is found (M371) ----------------------------------------------------------------------

    @property
    def is_open(self) -> bool:
        """Whether the temperature is to be found with the cycle."""
        return isinstance(self.temperature, FoundWithCycle)

    @property
    def stands(self) -> float | None:
        """Current value of the temperature [K]; None where it has none yet."""
        T = self.temperature
        return float(T) if T is not None and T > 0.0 else None

    def span(self, facts: Any, suction_pressure: Callable[[], float]) -> Span:
        """Return the range of temperatures between evaporation and the liquid that an economizer can cool."""
        operation, fluid = facts.operation, facts.gas.name
        low = operation.evaporating_temperature or constants.saturation_temperature(fluid, suction_pressure())
        liquid, limits = _liquid(facts) or 0.0, constants.limits(fluid)
        warmest = operation.condensing_temperature or liquid
        if operation.gas_cooler is not None and limits is not None:
            warmest = limits.T_critical - 1.0
        return Span(low + APART, max(min(liquid - self.nearest, warmest) - APART, low + APART))

    def first(self, span: Span) -> float:
        """Return a first guess of the temperature [K]."""
        return span.low + 0.4 * (span.high - span.low)

    def cautious(self, span: Span) -> float:
        """Return the temperature [K] at which the port lets in least: more may leave no room for suction gas."""
        return span.low

    def placed(self, x: float) -> dict[str, Any]:
        """Return the parameter that a coordinate stands for: the temperature."""
        return {"temperature": FoundWithCycle(x)}

    def off(self, figures: Mapping[str, Any], oil_follows: bool) -> tuple[float, float] | None:
        """Return the approximate error of the temperature [K] and its scale `PER_FOLD`; None without a draw ratio.

        The port draws more from a warmer economizer, whose liquid gives off less, so the error is about proportional to
        the logarithm of the draw ratio.
        """
        ratio = figures.get(DRAW)
        return None if ratio is None else (-PER_FOLD * math.log(max(ratio, 1e-2)), PER_FOLD)

    def idle(self, figures: Mapping[str, Any], x: float, lowest: bool) -> str:
        """Return a text that says that at no temperature the port draws as much vapour as the liquid gives off."""
        ratio = figures.get(DRAW)
        if ratio is None:
            return ""
        what = "at no economizer temperature does the port draw as much vapour as the liquid gives off"
        end = f"at {celsius(x)}, the {'lowest' if lowest else 'highest'}"
        remedy = "a larger port, or one that opens earlier"
        if ratio > 1.0:
            remedy = "a smaller port, or one that opens later"
        elif ratio < 0.0:
            remedy = "open it earlier, or leave it out here: the chambers' pressure is above its own"
        return f"{what}: {end}, it draws {ratio:.3g} times that ({remedy})"


def saturation(parameters: Parameters, fluid: str) -> float:
    """Return the saturation temperature [K] in the economizer: as stated, or that of the stated pressure."""
    if parameters.temperature is not None:
        return parameters.temperature
    return constants.saturation_temperature(fluid, parameters.pressure or 0.0)


def build(parameters: Parameters, machine) -> list[FlowPath | Plenum]:
    def state(site: Site) -> Reservoir:
        """Return the vapour in the economizer; for an ideal gas it is at the real fluid's saturation pressure."""
        T = saturation(parameters, site.fluid)
        p = parameters.pressure or constants.dew_pressure(site.fluid, T)
        return site.gas.vapour(p, T + parameters.superheat)

    return [window_path(NAME, parameters), Plenum(NAME, state, partial(economizer_figures, parameters), GAIN, LACKING)]


def economizer_figures(parameters: Parameters, drawn: Drawn) -> Given:
    """Return the vapour drawn and its gain in cooling capacity (M102, M440)."""
    site, ratio, T = drawn.site, drawn.ratio, saturation(parameters, drawn.site.fluid)
    found: dict[str, float | str | None] = {
        "economizer_temperature": T,
        "economizer_pressure": drawn.reservoir.p,
        "economizer_mass_flow": drawn.flow,
        "economizer_flow_ratio": ratio,
        HEAT_LOSS: 0.0 if parameters.backflow == EVAPORATES else drawn.brought,
    }
    h_c, q_0 = site.liquid_enthalpy, site.refrigerating_effect
    if h_c is None or q_0 is None or ratio is None:
        return found
    if parameters.boils:
        wanted = h_c - constants.wet_enthalpy(site.fluid, drawn.reservoir.p, 0.0)
    else:
        wanted = h_c - constants.liquid_enthalpy(site.fluid, site.p_d, T + parameters.approach)
    vapour = constants.vapour_enthalpy(site.fluid, drawn.reservoir.p, T + parameters.superheat)
    evaporating = max(ratio, 0.0) * (vapour - h_c)
    if parameters.backflow == EVAPORATES:
        evaporating = evaporating - drawn.brought / drawn.suction_flow
        found[HEAT_LOSS] = max(-evaporating, 0.0) * drawn.suction_flow  # beyond what evaporates the drawn gas
    none = "the economizer cools no liquid"
    found[DRAW] = evaporating / wanted if wanted > 0.0 else none
    settled = parameters.is_open and abs(evaporating - wanted) <= SETTLED * wanted  # what is left open is not a loss
    found[LACKING] = 0.0 if settled else max(evaporating - max(wanted, 0.0), 0.0) * drawn.suction_flow
    condensing = max(-ratio, 0.0) * (vapour - h_c)  # gas that stays comes back from the evaporator as liquid
    found[GAIN] = ((wanted if settled else max(0.0, min(evaporating, wanted))) - condensing) / q_0
    return found


def warnings(found: Mapping[str, Any]) -> Iterator[str]:
    """Yield warnings of a net flow back from the chambers, of more vapour drawn than there is, and of lost heat."""
    flow = found.get("economizer_mass_flow") or 0.0
    if flow < 0.0:
        what = f"{-flow:.3g} kg/s flow from the chambers back into the economizer, whose vapour is held at its pressure"
        yield f"{what} (close the port earlier, or raise effects.economizer.temperature or .pressure)"
    ratio = found.get(DRAW) or 0.0
    if ratio > 1.0 + DRAWN_TOO_MUCH:
        what = f"the economizer's port draws {ratio:.3g} times the vapour that the liquid gives off"
        yield f"{what}: its pressure would fall (lower effects.economizer.temperature, or make the port smaller)"
    keeps = f", or write effects.{NAME}.backflow: {EVAPORATES}, which keeps the heat that the liquid takes up"
    yield from lost_by_backflow(found, HEAT_LOSS, "the economizer", keeps if flow > 0.0 and ratio >= 0.0 else "")


def check(parameters: Parameters, facts) -> Faults:
    yield from check_window(NAME, parameters)
    p, T, fluid = parameters.pressure, parameters.temperature, facts.gas.name
    stated, limits = "temperature" if p is None else "pressure", constants.limits(fluid)
    found = isinstance(T, FoundWithCycle)
    if T is None and p is None:
        yield Fault(f"effects.{NAME}.temperature", "is missing (write e.g. temperature: 15 degC, or pressure: 5 bar)")
    elif T is not None and p is not None:
        yield Fault(f"effects.{NAME}.temperature", "is given as well as pressure (remove one of the two)")
    elif parameters.boils and constants.parts_on_boiling(fluid) and (found or limits is not None):
        what = f"the vapour that boils off {fluid}, a blend, has a different composition from the blend"
        yield Fault(f"effects.{NAME}.kind", f"{what} (write kind: {HEAT_EXCHANGER}, or name a pure fluid)")
    elif found:
        yield from _found(parameters, facts)
    elif limits is None:
        return
    elif p is not None and not limits.p_triple <= p < limits.p_critical:
        low, high = limits.p_triple / 1e5, limits.p_critical / 1e5
        what = f"{in_bar(p)}: {fluid} saturates between {low:.4g} bar and {high:.4g} bar"
        yield Fault(f"effects.{NAME}.pressure", f"{what} (choose another)")
    elif T is not None and not limits.T_triple <= T < limits.T_critical:
        what = f"{fluid} saturates between {in_celsius(limits.T_triple)} and {in_celsius(limits.T_critical)}"
        yield Fault(f"effects.{NAME}.temperature", f"{in_celsius(T)}: {what} (choose another)")
    else:
        T = saturation(parameters, fluid)
        yield from _between(parameters, T, facts, stated)
        remedy = f"choose a lower {stated}, a smaller approach or less subcooling"
        yield from _warm_enough(T + parameters.nearest, facts, f"it would be cooled ({remedy})")


def _found(parameters: Parameters, facts) -> Faults:
    """Yield the faults of a temperature that is to be found: no liquid is known, or it is too cold to be cooled."""
    operation = facts.operation
    low, high = operation.evaporating_temperature, operation.condensing_temperature
    if low is None or (high is None and operation.gas_cooler is None) or facts.machine.expands:
        what = "auto needs the liquid of a condenser or gas cooler (state a compressor's lines by temperatures)"
        yield Fault(f"effects.{NAME}.temperature", f"{what}, or write a temperature")
    elif operation.gas_cooler is None and low < high:
        cooled = "it could be cooled (less subcooling, or a smaller approach)"
        yield from _warm_enough(low + parameters.nearest, facts, cooled, 1.0)


def _liquid(facts) -> float | None:
    """Return the temperature [K] of the liquid behind condenser or gas cooler; None where the scene states neither."""
    operation, T_c = facts.operation, facts.operation.condensing_temperature
    if operation.gas_cooler is not None:
        return operation.gas_cooler.outlet_temperature
    return None if T_c is None else constants.condensed(facts.gas.name, T_c) - (operation.subcooling or 0.0)


def _warm_enough(coldest: float, facts, cooled: str, apart: float = 0.0) -> Faults:
    """Yield a fault where the liquid behind the condenser is already colder than the economizer can make it [K]."""
    liquid = _liquid(facts)
    if liquid is not None and liquid <= coldest + apart:
        what = f"the liquid, {in_celsius(liquid)}, is not warmer than the {in_celsius(coldest)} to which"
        yield Fault(f"effects.{NAME}", f"{what} {cooled}")


def _between(parameters: Parameters, T: float, facts, stated: str) -> Faults:
    """Yield a fault where the economizer's pressure is not between those of the lines."""
    operation, what = facts.operation, ""
    low, high = operation.evaporating_temperature, operation.condensing_temperature
    if low is not None and high is not None and not low < T < high:
        what = f"{in_celsius(T)} is not between evaporation, {in_celsius(low)}, and condensation, {in_celsius(high)}"
    p_s, p_d = operation.suction.pressure, operation.discharge.pressure
    if operation.gas_cooler is not None and low is not None:
        p_s, p_d = constants.dew_pressure(facts.gas.name, low), operation.gas_cooler.pressure
    if p_s is not None and p_d is not None:
        p = parameters.pressure or constants.dew_pressure(facts.gas.name, T)
        if not min(p_s, p_d) < p < max(p_s, p_d):
            what = f"{in_celsius(T)} saturates at {in_bar(p)}, not between {in_bar(p_s)} and {in_bar(p_d)}"
    if what:
        yield Fault(f"effects.{NAME}.{stated}", f"{what} (choose a value between)")


EFFECT = Effect(
    name=NAME,
    title="vapour from an economizer, through a port into a closed chamber",
    equations=("M12", "M13", "M100", "M101", "M102", "M371", "M440"),
    source="ours; cycle: textbook",
    parameters=Parameters,
    build=build,
    check=check,
    check_geometry=CheckWithin(NAME),
    needs=frozenset({HOLES}),
    figures=FIGURES,
    warnings=warnings,
    sizes=(Sized("area", SHELL, WIDEST, (0.0, 0.2)),),
)
