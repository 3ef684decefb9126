"""Separator: gas and oil meet behind the discharge port, part at one temperature, and a cooler sends the oil back.

What: gas, oil and the gas dissolved in the oil come from the chambers at temperatures of their own and mix
adiabatically at discharge pressure (M280, M281); the share of the losses that stays in them heats the mixture (M282).
The oil returns through a cooler, which is given by its outlet temperature, its duty, or a thermostat that keeps the
mixture's temperature, or without one (M283). A cooler of a stated conductance gives no more than its coolant takes, and
a temperature is kept as far as that suffices (M288). The temperatures of the oil supply and of the separator follow,
and are found together with the cycle (M284). Where oil_supply.temperature is stated, or cooler.outlet_temperature of a
cooler without bounds in its place, the duty follows.
Source: ours, from the first law; hydromechanical losses, drag and the pump heat the oil on which they act, where they
arise; that bearings give their heat to the oil that lubricates them is the usual layout of flooded screws.
Assumptions: gas and oil come to equilibrium before they part, dissolved gas too; neither carries any of the other
along; the cooler takes heat from the oil alone; its conductance depends neither on the oil's flow nor on its viscosity;
nothing is lost to the surroundings but `ambient_loss`, between discharge flange and cooler. Gas that flows back into
the chambers has not mixed yet (M27), nor has that of a bypass.
Parameters: cooler (outlet_temperature, duty, discharge_temperature, conductance, coolant_temperature), friction_share,
ambient_loss.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import exp, inf, isfinite, log1p

from screwsim.effects.base import CoolsOil, Effect, Faults, InSeparator, LosesPressure, Separator
from screwsim.effects.parts.usual import SEPARATOR
from screwsim.fluid.separator import Separated, SeparatorInflow, separated
from screwsim.fluid.settings import oil_temperature
from screwsim.inputs.declare import number, quantity
from screwsim.inputs.faults import Fault, given_twice
from screwsim.machine.protocol import OIL, ROTORS
from screwsim.outputs import Figure, Scale, power_figure
from screwsim.outputs.customary import ZERO_CELSIUS, in_celsius

NAME = "separator"
SUPPLY, SIZE = "oil_supply.temperature", "effects.separator.cooler.conductance"
OUTLET = "effects.separator.cooler.outlet_temperature"
HEATS = 1e-3  # heat from the cooler into the oil, over shaft power, above which is warned
MEASURED, DUTY, LOAD = "mixture_discharge_temperature", "oil_cooler_duty", "oil_cooler_load"
KEPT = "outlet_temperature", "duty", "discharge_temperature"  # what a cooler may keep, one of them
TOLD = 0.01  # [K] by which a thermostat's temperature is exceeded before it is told
FAR = 10.0  # [K] by which it is exceeded from which the cooler that would do is only roughly known
LEAST = 1e-6  # heat capacity of oil over that of gas below which the oil cannot cool
NO_OIL = (
    "hardly any oil flows, and its cooler can keep neither a duty nor a temperature (inject more oil, or remove the "
    "cooler)"
)
FIGURES = (
    Figure(MEASURED, "K", "temperature of the mixed gas and oil after the discharge port"),
    Figure("separator_temperature", "K", "temperature of gas and oil in the separator"),
    Figure("oil_supply_temperature", "K", "temperature of the injected oil"),
    power_figure(DUTY, "heat removed by the oil cooler"),
    Figure(
        LOAD,
        "1",
        "heat that the oil cooler is asked for over the most that its coolant would take",
        Scale(0.1),
        needs=(".cooler.conductance",),
    ),
    Figure(
        "oil_flow_volume",
        "m3 s-1",
        "volume flow of injected oil",
        Scale(1e-7, ("gas_mass_flow",)),
        by_oil=True,
        shown="L min-1",
    ),
    Figure(
        "oil_circuit_residual",
        "1",
        "residual of the energy balance of machine, separator and oil cooler, over shaft power",
        Scale(1.0, alone=True, unasked=True),
    ),
)


@dataclass(frozen=True)
class Cooler:
    """What the oil cooler keeps: its outlet temperature, its duty, or the temperature at discharge; and its size."""

    outlet_temperature: float | None = oil_temperature(
        "temperature of the oil after the cooler, in place of oil_supply.temperature"
    )
    duty: float | None = quantity("power", "heat that the cooler removes from the oil", None, ge=0.0)
    discharge_temperature: float | None = oil_temperature(
        "temperature of the mixture at discharge, kept by a thermostat that cools the oil"
    )
    conductance: float | None = quantity(
        "conductance", "heat transfer coefficient times area, which bounds its duty (absent: unbounded)", None, gt=0.0
    )
    coolant_temperature: float | None = oil_temperature(
        "temperature of the coolant that enters it (absent: the air at the inlet of effects.air_package)"
    )

    @property
    def stated(self) -> list[str]:
        """Names of the keys that state what is kept."""
        return [name for name in KEPT if getattr(self, name) is not None]

    def misses(self, T_mixture: float, T_supply: float) -> float | None:
        """Return what the temperature that a thermostat keeps lies above the present one [K]; None without one."""
        if self.discharge_temperature is not None:
            return self.discharge_temperature - T_mixture
        return None if self.outlet_temperature is None else self.outlet_temperature - T_supply

    def idle(self, found: Separated, T_supply: float) -> str:
        """Return what is told where the thermostat would have to heat."""
        (name,), (kept, where, what, T) = self.stated, self._thermostat(found, T_supply)
        return (
            f"the oil cooler's thermostat keeps {kept} {where}, and {what} reaches only {in_celsius(T)} without any "
            f"cooling; it would have to heat, so its duty is 0 (lower effects.separator.cooler.{name})"
        )

    def exhausted(self, found: Separated, T_supply: float, coolant: float, needed: tuple[float, float]) -> str:
        """Return what is told where the whole cooler does not suffice.

        `needed`: conductance [W/K], infinite where none would do, and coolant [K] either of which would, by the heat
        capacities at what is found; too far from what is to be kept they are too rough to be told.
        """
        kept, where, what, T = self._thermostat(found, T_supply)
        missed = -(self.misses(found.T_mixture, T_supply) or 0.0)
        larger, colder = f"a larger {SIZE}", f"a coolant colder than {in_celsius(coolant)}"
        if missed < FAR:
            larger = f"a {SIZE} of about {1e-3 * needed[0]:.3g} kW/K"
            colder = f"a coolant of about {needed[1] - ZERO_CELSIUS:.1f} degC"
        return (
            f"the oil cooler cannot keep {kept} {where}: all of its {1e-3 * (self.conductance or 0.0):.4g} kW/K remove "
            f"{1e-3 * max(found.duty, 0.0):.4g} kW, and {what} reaches {in_celsius(T)} "
            f"({f'{larger}, or ' if isfinite(needed[0]) else ''}{colder})"
        )

    def _thermostat(self, found: Separated, T_supply: float) -> tuple[str, str, str, float]:
        """Return what the thermostat keeps, where, of what, and what is reached [K]."""
        if self.discharge_temperature is not None:
            return in_celsius(self.discharge_temperature), "at discharge", "the mixture", found.T_mixture
        return in_celsius(self.outlet_temperature or 0.0), "behind it", "the oil", T_supply


@dataclass(frozen=True)
class Parameters(CoolsOil):
    """The cooler (absent: oil_supply.temperature states its outlet, or there is none), and what becomes of losses."""

    outlet_key, size_key = "cooler.outlet_temperature", "cooler.conductance"
    cooler: Cooler | None = None
    friction_share: float = number(
        "share of the friction of bearings, seals and gears that heats the oil", 1.0, ge=0.0, le=1.0
    )
    ambient_loss: float = quantity("power", "heat lost to the surroundings before the cooler", 0.0, ge=0.0)

    @property
    def outlet(self) -> float | None:
        """Temperature [K] of the oil behind the cooler; None where it is not prescribed, or may not be kept."""
        return None if self.cooler is None or self.bounded else self.cooler.outlet_temperature

    @property
    def bounded(self) -> bool:
        """Whether the cooler has a size, so that what it is to keep is not kept at any price."""
        return self.cooler is not None and self.cooler.conductance is not None

    @property
    def cooled_by_inlet(self) -> bool:
        """Whether the coolant is the air at the machine's inlet."""
        return self.cooler is not None and self.bounded and self.cooler.coolant_temperature is None

    @property
    def discharge(self) -> float | None:
        """Temperature [K] of gas and oil at discharge; None where it is not prescribed."""
        return None if self.cooler is None else self.cooler.discharge_temperature


def build(parameters: Parameters, machine) -> list[Separator]:
    cooler = parameters.cooler or Cooler()

    def balance(outflow: SeparatorInflow, supply_open: bool) -> Separated:
        """Return the state in which gas and oil part and, for an open supply, how it has to change."""
        found = separated(outflow, parameters.friction_share, parameters.ambient_loss)
        return cooled(cooler, outflow, found) if supply_open else found

    return [Separator(balance)]


def cooled(cooler: Cooler, outflow: SeparatorInflow, found: Separated) -> Separated:
    """Return how the supply of oil has to change by its cooler, after gas and oil are `found` to part (M283, M284)."""
    T, T_supply, C = found.T_separator, outflow.T_supply, outflow.oil_capacity
    coolant = outflow.T_inlet if cooler.coolant_temperature is None else cooler.coolant_temperature
    of_gas = outflow.heat_of(T + 2.0) - outflow.heat_of(T + 1.0)  # heat capacity, beside T, which may be saturation
    if not C > LEAST * of_gas:
        supply = 0.0 if cooler.conductance is None or cooler.stated else coolant - T_supply
        return found._replace(supply=supply, why=found.why or (NO_OIL if cooler.stated else ""))
    share = C / (C + of_gas)

    def removing(duty: float, effectiveness: float = 0.0) -> Separated:
        """Return how the supply changes where the cooler removes a duty of that `effectiveness` at T."""
        left, open_ = 1.0 - effectiveness, found.duty - duty
        back = 1.0 - share * left
        return found._replace(supply=open_ / (C * back), open=open_, share=share, gain=left / back)

    uncooled, off = removing(cooler.duty or 0.0), cooler.misses(found.T_mixture, T_supply)
    effectiveness = 0.0 if cooler.conductance is None else 1.0 - exp(-cooler.conductance / C)
    whole = removing(effectiveness * C * (T - coolant), effectiveness)
    if off is None and cooler.conductance is None:
        return uncooled._replace(duty=cooler.duty or 0.0)
    if off is None:
        return whole._replace(load=1.0 if T > coolant else None)
    # a thermostat keeps a temperature, which oil without any cooling may not even reach ...
    kept = found._replace(supply=off, open=C * off, share=share, gain=0.0)
    if cooler.discharge_temperature is not None:
        kept = found._replace(supply=off / share, open=(C + of_gas) * off, share=share, gain=1.0 / share)
    if uncooled.supply <= kept.supply:
        return uncooled._replace(duty=0.0, load=0.0, told=cooler.idle(found, T_supply))
    if cooler.conductance is None:
        return kept
    # ... and which a cooler of a stated size may miss: what it is asked for at that temperature over its most there
    T_kept, asked = T + share * kept.supply, found.duty - C * (1.0 - share) * kept.supply
    most = effectiveness * C * (T_kept - coolant)
    kept = kept._replace(load=asked / most if most > 0.0 else None)
    coldest = min(whole, uncooled, key=lambda each: each.supply)
    if kept.supply >= coldest.supply:
        return kept
    told = ""
    if off < -TOLD:
        of_all = asked / (C * (T_kept - coolant)) if T_kept > coolant else inf  # effectiveness that would do
        needed = -C * log1p(-of_all) if of_all < 1.0 else inf, T_kept - asked / max(effectiveness * C, LEAST)
        told = cooler.exhausted(found, T_supply, coolant, needed)
    return coldest._replace(load=kept.load, told=told)


def check(parameters: Parameters, facts) -> Faults:
    path, cooler = f"effects.{NAME}", parameters.cooler or Cooler()
    stated = cooler.stated
    for name in stated[1:]:
        what = f"is given as well as {stated[0]} (state one of them, and null for the other)"
        yield Fault(f"{path}.cooler.{name}", what)
    yield from _bounds(cooler, f"{path}.cooler", facts)
    if cooler.conductance is not None:
        stated = stated or ["conductance"]
    if stated and facts.oil_supply.temperature is not None:
        finds = "it states too" if stated[0] == "outlet_temperature" else "follows from it"
        yield given_twice(f"{path}.cooler.{stated[0]}", f"{SUPPLY}, which {finds}")
    for name, active in facts.effects.items():
        asks = active.parameters
        if isinstance(asks, InSeparator) and asks.separator_temperature is not None:
            what = f"is given as well as effects.{NAME}, which finds it (remove it; null drops a base's value)"
            yield Fault(f"effects.{name}.separator_temperature", what)


def _bounds(cooler: Cooler, path: str, facts) -> Faults:
    """Yield faults of a cooler's size: half of it stated, or beside a duty."""
    packed = any(isinstance(active.parameters, LosesPressure) for active in facts.effects.values())
    if cooler.conductance is None and cooler.coolant_temperature is not None:
        what = "is missing, and coolant_temperature needs it (write e.g. conductance: 0.5 kW/K)"
        yield Fault(f"{path}.conductance", what)
    elif cooler.conductance is not None and cooler.coolant_temperature is None and not packed:
        what = "is missing, and conductance needs it (write e.g. coolant_temperature: 30 degC)"
        yield Fault(f"{path}.coolant_temperature", what)
    if cooler.conductance is not None and cooler.duty is not None:
        yield Fault(f"{path}.conductance", "is given as well as duty, which follows from it (remove one of the two)")


def warnings(found) -> Iterator[str]:
    """Yield a warning where a stated supply temperature requires the cooler to heat, or its coolant does.

    Not for an expander, whose oil is to be warmed.
    """
    duty, power = found.get(DUTY), found.get("shaft_power")
    if duty is not None and duty < -HEATS * abs(power or 0.0) and "output_power" not in found:
        T, supply = found["separator_temperature"], found["oil_supply_temperature"]
        heats, remedy = f"would have to heat it by {-1e-3 * duty:.4g} kW", f"lower {SUPPLY} or {OUTLET}"
        if LOAD in found:  # a cooler of a stated size
            heats, remedy = f"heats it by {-1e-3 * duty:.4g} kW", "choose a colder coolant"
        yield (
            f"the oil comes back at {in_celsius(supply)}, warmer than the {in_celsius(T)} of the separator: its cooler "
            f"{heats} ({remedy})"
        )


EFFECT = Effect(
    name=NAME,
    title="gas and oil separate at one temperature, and the oil returns through a cooler",
    equations=("M280", "M281", "M282", "M283", "M284", "M285", "M286", "M288"),
    source="energy balance; ours",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    check=check,
    needs=frozenset({OIL}),
    figures=FIGURES,
    warnings=warnings,
    usual={ROTORS: SEPARATOR},
)
