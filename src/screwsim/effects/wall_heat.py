"""Wall heat: housing and rotors exchange heat with the gas, each a lump with a temperature of its own.

What: α A (T_w − T) into the gas (M170) with Nu = 0.023 Re^0.8 (M172) and a wetted area that follows the chamber's
volume (M173); a lump's temperature is that at which its net heat over a cycle balances its outside cooling (M174).
Source: N. Stosic, I. K. Smith, A. Kovacevic, Screw Compressors: Mathematical Modelling and Performance Calculation,
Springer 2005, ch. 2 (coefficient, length); that a rotor has one temperature: N. Stosic, I. K. Smith, A. Kovacevic,
Numerical investigation of heat transfer on screw compressor rotors, Mecánica Computacional XXIV (2005).
Assumptions: one temperature per lump, although a housing is warmer where it discharges; no oil film on the walls; no
heat from rotor to housing; the gas passes all walls at one share of the tip speed. λ and μ of the gas are constant.
Parameters: rotor_area, housing_area, characteristic_length, speed_ratio, nusselt_factor; rotor_cooling,
housing_cooling; rotor_temperature, housing_temperature; reference state or λ, μ.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from screwsim.effects.base import Around, Effect, Faults, FeedbackUnknown, Made, Reading, Site, Turn, Wall
from screwsim.effects.parts.gas_transport import (
    declared_gas_conductivity,
    declared_gas_viscosity,
    gas_faults,
    gas_numbers,
)
from screwsim.effects.parts.usual import Sized
from screwsim.inputs.declare import number, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import DIAMETER, ROTORS, SHELL
from screwsim.numerics.kernel import kernel
from screwsim.outputs import WALLED, Figure, names_of, power_figure

NAME = "wall_heat"
LUMPS = ("rotor", "housing")
FIGURES = (
    Figure("rotor_temperature", "K", "temperature of the rotors"),
    Figure("housing_temperature", "K", "temperature of the housing"),
    power_figure("wall_heat_power", "net heat from walls to gas: external cooling of the walls, with a negative sign"),
)
GAS = ("gas_conductivity", "gas_viscosity")
COLDEST = 100.0  # [K] lower bound; a lump that reaches it is cooled by more than the gas can supply


def fixed_temperature(default: str) -> Any:
    """Declare the temperature of a lump; in words what it is by default."""
    what = f"fixed temperature (default: {default})"
    return quantity("temperature", what, None, ge=50.0, le=2500.0, hardly=(150.0, 800.0))


@dataclass(frozen=True)
class Parameters:
    """The walls of one chamber, the gas that passes them, and what cools them from outside."""

    rotor_area: float = quantity(
        "area", "area of both rotors in contact with one chamber at its largest volume", ge=0.0
    )
    housing_area: float = quantity(
        "area", "area of the housing in contact with one chamber at its largest volume", ge=0.0
    )
    characteristic_length: float = quantity(
        "length", "length in Nu and Re: outer minus inner diameter of the male rotor", gt=0.0
    )
    speed_ratio: float = number(
        "speed of the gas along the walls, over the male tip speed", 1.0, ge=0.0, le=1e3, hardly=(None, 10.0)
    )
    nusselt_factor: float = number("C in Nu = C Re^0.8", 0.023, ge=0.0, le=1e4, hardly=(None, 1.0))
    rotor_cooling: float = quantity("power", "heat removed from the rotors outside the chambers", 0.0, ge=0.0)
    housing_cooling: float = quantity("power", "heat removed from the housing at its outside", 0.0, ge=0.0)
    rotor_temperature: float | None = fixed_temperature("found from its heat balance")
    housing_temperature: float | None = fixed_temperature("found from its heat balance")
    reference_pressure: float | None = optional("pressure", "pressure at which lambda, mu of the gas are evaluated")
    reference_temperature: float | None = optional("temperature", "temperature at which they are evaluated")
    gas_conductivity: float | None = declared_gas_conductivity()
    gas_viscosity: float | None = declared_gas_viscosity()


@kernel
def coefficient(rho, speed, characteristic_length, nusselt_factor, gas_conductivity, gas_viscosity):
    """Return α [W/(m² K)] between a wall and gas that passes it at `speed` [m/s] (M172)."""
    reynolds = rho * speed * characteristic_length / gas_viscosity
    return nusselt_factor * reynolds**0.8 * gas_conductivity / characteristic_length


@kernel
def conductance(
    V,
    rho,
    wall_area,
    largest_volume,
    speed_ratio,
    tip_speed,
    characteristic_length,
    nusselt_factor,
    gas_conductivity,
    gas_viscosity,
):
    """Return α A [W/K] of a chamber of volume V [m³] that wets `wall_area` [m²] at its largest volume (M172, M173)."""
    speed = speed_ratio * tip_speed
    alpha = coefficient(rho, speed, characteristic_length, nusselt_factor, gas_conductivity, gas_viscosity)
    return alpha * wall_area * V / largest_volume


def numbers(parameters: Parameters, around: Around) -> Mapping[str, float]:
    """Return λ [W/(m K)] and μ [Pa s] of the gas for the kernel. Raises UsageError."""
    return gas_numbers(parameters, around, GAS)


def settled(lump: str, cooling: float, stated: float | None, turn: Turn) -> float:
    """Return the temperature [K] at which this turn's gas would balance the cooling of a lump (M174)."""
    T, conductance = turn.made[f"{lump}_temperature"], turn.conductance[lump]
    if stated is not None or conductance == 0.0:
        return T
    return T - (turn.heat[lump] + cooling) / conductance


def first(stated: float | None, site: Site) -> float:
    """Return the initial temperature [K] of a lump: as stated, or half way to that of isentropic compression."""
    if stated is not None:
        return stated
    return site.T_s + 0.5 * site.gas.isentropic_work(site.p_s, site.p_d, site.T_s) / site.gas.c_p


def build(parameters: Parameters, machine) -> list[Made | Wall | Reading]:
    parts: list[Made | Wall | Reading] = []
    for lump in LUMPS:
        stated, cooling = (getattr(parameters, f"{lump}_{what}") for what in ("temperature", "cooling"))
        name = f"{lump}_temperature"
        values = {
            "wall_area": getattr(parameters, f"{lump}_area"),
            "largest_volume": machine.swept_volume,
            "speed_ratio": parameters.speed_ratio,
            "characteristic_length": parameters.characteristic_length,
            "nusselt_factor": parameters.nusselt_factor,
        }
        beyond = (
            f"the {lump} loses more heat to cooling than the gas gives it (choose a smaller "
            f"effects.{NAME}.{lump}_cooling)"
        )
        parts += [
            Made(
                FeedbackUnknown(name), partial(first, stated), partial(settled, lump, cooling, stated), COLDEST, beyond
            ),
            Wall(lump, conductance, values, name),
        ]

    def read(figures) -> dict[str, float | None]:
        """Return the lumps' temperatures [K] and the total heat [W] from walls to gas."""
        turn = figures.turn
        found: dict[str, float | None] = {f"{lump}_temperature": turn.made[f"{lump}_temperature"] for lump in LUMPS}
        return found | {"wall_heat_power": turn.heat["rotor"] + turn.heat["housing"]}

    return [*parts, Reading(names_of(FIGURES), read)]


def check(parameters: Parameters, facts) -> Faults:
    path = f"effects.{NAME}"
    for lump in LUMPS:
        cooling, stated = (getattr(parameters, f"{lump}_{what}") for what in ("cooling", "temperature"))
        if cooling > 0.0 and stated is not None:
            yield Fault(f"{path}.{lump}_cooling", f"is given as well as {lump}_temperature (remove one of the two)")
        if cooling > 0.0 and getattr(parameters, f"{lump}_area") * parameters.nusselt_factor == 0.0:
            yield Fault(f"{path}.{lump}_cooling", "cools a wall that no gas warms (remove it)")
    yield from gas_faults(path, parameters, facts.gas.name, GAS)


EFFECT = Effect(
    name=NAME,
    title="housing and rotors exchange heat with the gas",
    equations=("M170", "M171", "M172", "M173", "M174"),
    source="Stosic, Smith, Kovacevic 2005",
    parameters=Parameters,
    build=build,
    check=check,
    numbers=numbers,
    needs=frozenset({ROTORS}),
    figures=FIGURES,
    sizes=(
        Sized("rotor_area", SHELL, 100.0, (0.0, 2.0)),
        Sized("housing_area", SHELL, 100.0, (0.0, 2.0)),
        Sized("characteristic_length", DIAMETER, 30.0, (0.0, 1.0)),
    ),
    roles={WALLED[0]: ""},
)
