"""Separator: gas and oil meet behind the discharge port, part at one temperature, and a cooler sends the oil back.

What: gas, oil and the gas dissolved in the oil come from the chambers at temperatures of their own and mix
adiabatically at discharge pressure (M280, M281); the share of the losses that stays in them heats the mixture (M282).
The oil returns through a cooler, which is given by its outlet temperature, its duty, or a thermostat that keeps the
mixture's temperature, or without one (M283). The temperatures of the oil supply and of the separator follow, and are
found together with the cycle (M284). Where oil_supply.temperature is stated, or cooler.outlet_temperature in its place,
the duty follows.
Source: ours, from the first law; hydromechanical losses, drag and the pump heat the oil on which they act, where they
arise; that bearings give their heat to the oil that lubricates them is the usual layout of flooded screws.
Assumptions: gas and oil come to equilibrium before they part, dissolved gas too; neither carries any of the other
along; the cooler takes heat from the oil alone; nothing is lost to the surroundings but `ambient_loss`, between
discharge flange and cooler. Gas that flows back into the chambers has not mixed yet (M27), nor has that of a bypass.
Parameters: cooler (outlet_temperature, duty, discharge_temperature), friction_share, ambient_loss.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from screwsim.effects.base import Cooler, CoolsOil, Effect, Faults, InSeparator, Separator
from screwsim.effects.parts.usual import SEPARATOR
from screwsim.fluid.separator import Separated, SeparatorInflow, separated
from screwsim.inputs.declare import number, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import OIL, ROTORS
from screwsim.outputs import Figure, Scale, power_figure
from screwsim.outputs.customary import in_celsius

NAME = "separator"
SUPPLY = "oil_supply.temperature"
HEATS = 1e-3  # heat from the cooler into the oil, over shaft power, above which is warned
MEASURED, DUTY = "mixture_discharge_temperature", "oil_cooler_duty"
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
class Parameters(CoolsOil):
    """The cooler (absent: oil_supply.temperature states its outlet, or there is none), and what becomes of losses."""

    friction_share: float = number(
        "share of the friction of bearings, seals and gears that heats the oil", 1.0, ge=0.0, le=1.0
    )
    ambient_loss: float = quantity("power", "heat lost to the surroundings before the cooler", 0.0, ge=0.0)


def build(parameters: Parameters, machine) -> list[Separator]:
    cooler = parameters.cooler or Cooler()
    losses = parameters.friction_share, parameters.ambient_loss

    def balance(outflow: SeparatorInflow, supply_open: bool) -> Separated:
        """Return the state in which gas and oil part and, for an open supply, how it has to change (M283, M284)."""
        found = separated(outflow, *losses)
        if not supply_open:
            return found
        T, C = found.T_separator, outflow.oil_capacity
        rise = outflow.heat_of(T + 2.0) - outflow.heat_of(T + 1.0)  # beside T, which may be saturation
        if not C > LEAST * rise:
            return found._replace(why=found.why or (NO_OIL if cooler.stated else ""))
        share = C / (C + rise)
        open_ = found.duty - (cooler.duty or 0.0)
        uncooled = open_ / (C * (1.0 - share))
        if cooler.discharge_temperature is None:
            gain = 1.0 / (1.0 - share)
            return found._replace(duty=cooler.duty or 0.0, supply=uncooled, open=open_, share=share, gain=gain)
        off = cooler.discharge_temperature - found.T_mixture
        if uncooled <= off / share:
            idle = (
                f"the oil cooler's thermostat keeps {in_celsius(cooler.discharge_temperature)} at discharge, and the "
                f"mixture reaches only {in_celsius(found.T_mixture)} without any cooling; it would have to heat, so "
                "its duty is 0 (lower effects.separator.cooler.discharge_temperature)"
            )
            return found._replace(
                duty=0.0, supply=uncooled, open=open_, share=share, gain=1.0 / (1.0 - share), told=idle
            )
        return found._replace(supply=off / share, open=(C + rise) * off, share=share, gain=1.0 / share)

    return [Separator(balance)]


def check(parameters: Parameters, facts) -> Faults:
    path, stated = f"effects.{NAME}", [] if parameters.cooler is None else parameters.cooler.stated
    for name in stated[1:]:
        what = f"is given as well as {stated[0]} (state one of them, and null for the other)"
        yield Fault(f"{path}.cooler.{name}", what)
    if stated and facts.oil_supply.temperature is not None:
        finds = "it states too" if stated[0] == "outlet_temperature" else "follows from it"
        remedy = "remove one of the two; null drops a base's value"
        yield Fault(f"{path}.cooler.{stated[0]}", f"is given as well as {SUPPLY}, which {finds} ({remedy})")
    for name, active in facts.effects.items():
        asks = active.parameters
        if isinstance(asks, InSeparator) and asks.separator_temperature is not None:
            what = f"is given as well as effects.{NAME}, which finds it (remove it; null drops a base's value)"
            yield Fault(f"effects.{name}.separator_temperature", what)


def warnings(found) -> Iterator[str]:
    """Yield a warning where a stated supply temperature requires the cooler to heat."""
    duty, power = found.get(DUTY), found.get("shaft_power")
    if duty is not None and duty < -HEATS * abs(power or 0.0):
        T, supply = found["separator_temperature"], found["oil_supply_temperature"]
        yield (
            f"the oil comes back at {in_celsius(supply)}, warmer than the {in_celsius(T)} of the separator: its cooler "
            f"would have to heat it by {-1e-3 * duty:.4g} kW (lower {SUPPLY})"
        )


EFFECT = Effect(
    name=NAME,
    title="gas and oil separate at one temperature, and the oil returns through a cooler",
    equations=("M280", "M281", "M282", "M283", "M284", "M285", "M286"),
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
