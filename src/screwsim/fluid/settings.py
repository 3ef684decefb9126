"""The settings of gas and oil in a scene (typed, SI units)."""

from dataclasses import dataclass
from typing import Any, NamedTuple

from screwsim.fluid.composition import own_blend
from screwsim.fluid.oils import OILS
from screwsim.inputs.declare import choice, fluid, number, numbers, quantity

COLDEST, HOTTEST = 150.0, 700.0  # [K] range of oil temperatures that are accepted
REFUSE, EQUILIBRIUM = "refuse", "equilibrium"  # options of `gas.two_phase`
AIR = "air"
CARRIED = "carried"  # option of `oil.transport`, beside the paper's


def oil_temperature(doc: str) -> Any:
    """Declare a temperature of oil, or of gas and oil together, which may be left out."""
    return quantity("temperature", doc, None, ge=COLDEST, le=HOTTEST, hardly=(210.0, 450.0))


@dataclass(frozen=True)
class GasSettings:
    """The working gas: a pure fluid, a predefined blend, or a blend of your own with its composition."""

    fluid: str | tuple[str, ...] = fluid(
        "a pure fluid or a predefined blend of CoolProp (R454B, R407C.mix), or a list of a blend's components", "R134a"
    )
    mass_fractions: tuple[float, ...] | None = numbers(
        "mass fractions of the components of fluid: [NAME, NAME], in that order", None, gt=0.0, lt=1.0
    )
    mole_fractions: tuple[float, ...] | None = numbers(
        "mole fractions of the components, in place of mass_fractions", None, gt=0.0, lt=1.0
    )
    model: str = choice(
        "equation of state; real: the fluid's full Helmholtz equation", ("ideal", "real"), "ideal", own="GAS"
    )
    two_phase: str = choice(
        "for a real gas that condenses: refuse it, or follow both phases in equilibrium", (REFUSE, EQUILIBRIUM), REFUSE
    )
    isentropic_exponent: float | None = number(
        "k of the ideal gas (default: cp0/(cp0 - R) at suction temperature; always c_v = R/(k - 1))",
        None,
        ge=1.001,
        le=2.0,
        hardly=(1.01, 5.0 / 3.0),
    )
    relative_humidity: float | None = number(
        "relative humidity of the air in the suction line (M320): its vapour is part of the gas and may condense",
        None,
        ge=0.0,
        le=1.0,
    )
    dew_point_margin: float | None = quantity(
        "temperature_difference",
        "margin of the lowest safe oil temperature above the pressure dew point (default: 5 K; with relative_humidity)",
        None,
        ge=0.0,
        hardly=(0.0, 30.0),
    )

    @property
    def is_air(self) -> bool:
        """Whether the gas is air."""
        return self.name.lower() == AIR

    @property
    def equilibrium(self) -> bool:
        """Whether both phases are to be computed where the gas condenses."""
        return self.two_phase == EQUILIBRIUM

    @property
    def name(self) -> str:
        """The fluid's name; for a blend of the user's own it contains the composition."""
        if isinstance(self.fluid, str):
            return self.fluid
        return own_blend(self.fluid, self.mass_fractions or self.mole_fractions or (), self.mass_fractions is None)


class OilProperties(NamedTuple):
    """Properties of the oil at one temperature: ρ [kg/m³], c [J/(kg K)], μ [Pa s] if known."""

    density: float
    heat_capacity: float
    viscosity: float | None


@dataclass(frozen=True)
class OilSettings:
    """The oil: constant properties or the name of a stored oil, and how it travels with leaking gas."""

    name: str | None = choice(
        "a stored oil, with density, heat capacity and viscosity over temperature (M140), instead of numbers",
        tuple(OILS),
        None,
    )
    density: float | None = quantity("density", "density (needed without name)", None, ge=10.0, hardly=(600.0, 2000.0))
    heat_capacity: float | None = quantity(
        "heat_capacity", "specific heat capacity (needed without name)", None, ge=10.0, le=2e4, hardly=(1000.0, 5000.0)
    )
    viscosity: float | None = quantity(
        "viscosity", "dynamic viscosity (for losses and the injection orifice)", None, ge=1e-6, hardly=(2e-4, 20.0)
    )
    transport: str = choice(
        "paper: the ratio d is constant after 360 deg; carried: oil mass is a state from 0 deg, and leaks carry the "
        "upstream chamber's ratio",
        ("paper", CARRIED),
        CARRIED,
    )

    @property
    def carried(self) -> bool:
        """Whether the oil's mass is a state of every chamber, and leaks carry it along."""
        return self.transport == CARRIED

    @property
    def knows_viscosity(self) -> bool:
        """Whether the oil has a viscosity."""
        return self.name is not None or self.viscosity is not None

    def at(self, T: float) -> OilProperties:
        """Return the properties at T [K]; those stated as numbers do not depend on it."""
        if self.name is None:
            return OilProperties(self.density or 0.0, self.heat_capacity or 0.0, self.viscosity)
        oil = OILS[self.name]
        return OilProperties(oil.density_at(T), oil.heat_capacity_at(T), oil.viscosity_at(T))


@dataclass(frozen=True)
class OilLine:
    """Pressure loss of pipe, filter and cooler at one flow; it is proportional to the square of the flow."""

    pressure_loss: float = quantity(
        "pressure_difference", "pressure loss of pipe, filter and cooler at flow", ge=0.0, hardly=(None, 5e6)
    )
    flow: float = quantity("volume_flow", "oil flow through the line for which pressure_loss is stated", gt=0.0)
