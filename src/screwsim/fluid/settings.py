"""What a scene says of the gas and of the oil (typed, SI units)."""

from __future__ import annotations

from dataclasses import dataclass

from screwsim.declare import choice, number, quantity, word


@dataclass(frozen=True)
class GasSettings:
    """The working gas."""

    fluid: str = word("a pure fluid of CoolProp", "R134a")
    model: str = choice("equation of state; real: the fluid's full Helmholtz equation", ("ideal", "real"), "ideal")
    two_phase: str = choice(
        "a real gas that condenses: refuse it, or follow both phases in equilibrium",
        ("refuse", "equilibrium"),
        "refuse",
    )
    isentropic_exponent: float | None = number(
        "k of the ideal gas (default: cp0/(cp0 - R) at suction temperature; always c_v = R/(k - 1))", None, gt=1.0
    )


@dataclass(frozen=True)
class OilSettings:
    """The oil: constant properties, and how it travels with leaking gas."""

    density: float = quantity("density", "density", gt=0.0)
    heat_capacity: float = quantity("heat_capacity", "specific heat capacity", gt=0.0)
    viscosity: float | None = quantity(
        "viscosity", "dynamic viscosity (for losses and the injection orifice)", None, gt=0.0
    )
    transport: str = choice(
        "paper: ratio d constant after 360 deg; carried: oil mass is a state from 0 deg, leaks carry the donor's ratio",
        ("paper", "carried"),
        "carried",
    )
