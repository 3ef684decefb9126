"""Transport properties of gases outside the compiled cycle: CoolProp's, and for blends those of their components.

A dilute gas mixture follows from its components (M318). Viscosity: C. R. Wilke, J. Chem. Phys. 18 (1950) 517.
Conductivity: A. Wassiljewa, Phys. Z. 5 (1904) 737, with Wilke's weights (E. A. Mason, S. C. Saxena, Phys. Fluids 1
(1958) 361, whose factor of 1.065 is 1 here, as in B. E. Poling, J. M. Prausnitz, J. P. O'Connell, The Properties of
Gases and Liquids, 2001, ch. 9 and 10). CoolProp's pseudo-pure R404A, R507A, R410A and R407C at 300 to 400 K are met
within 5 % (viscosity) and 16 % (conductivity, Prandtl number). Pressure has no influence; in R32, R125, R134a and
propane, up to 20 bar at 350 K, it is 1 to 7 % of the viscosity, 8 to 18 % of the conductivity and 12 to 35 % of the
Prandtl number.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from math import sqrt
from typing import Any

from screwsim.fluid.blend_border import BlendBorder
from screwsim.fluid.constants import ask, blend_of, coolprop_state
from screwsim.fluid.description import describe
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import in_bar, in_celsius

DILUTE = 1e3  # [Pa] pressure at which the components of a blend are asked for


def transport(fluid: str, p: float, T: float) -> tuple[float, float, float]:
    """Return thermal conductivity [W/(m K)], viscosity [Pa s] and Prandtl number of the vapour at p [Pa] and T [K].

    Those of a blend are of the dilute gas at T, from its components' (M318). Raises UsageError where CoolProp has no
    transport properties of the fluid or of a component, or no such state.
    """
    made = blend_of(fluid)
    if made is not None:
        mu, conductivity = viscosity(fluid, p, T), _mixed(made, "conductivity", T)
        return conductivity, mu, made.ideal_heat_capacity(T) * mu / conductivity

    def question() -> list[float]:
        return _of_vapour(fluid, p, T, lambda state: [state.conductivity(), state.viscosity(), state.Prandtl()])

    conductivity, mu, prandtl = ask(f"{fluid} transport {p!r} {T!r}", question)
    if not min(conductivity, mu, prandtl) > 0.0:  # CoolProp's fits of cold vapours fall below zero
        raise _unknown(fluid, p, T)
    return conductivity, mu, prandtl


def viscosity(fluid: str, p: float, T: float) -> float:
    """Return the viscosity [Pa s] of the vapour at p [Pa] and T [K]; of a blend as `transport` does.

    Raises UsageError where CoolProp has none.
    """
    made = blend_of(fluid)
    if made is not None:
        return _mixed(made, "viscosity", T)

    def question() -> float:
        return _of_vapour(fluid, p, T, lambda state: [state.viscosity()])[0]

    return ask(f"{fluid} viscosity {p!r} {T!r}", question)


def saturated_liquid_viscosity(fluid: str, T: float) -> float:
    """Return the viscosity [Pa s] of saturated liquid at T [K]. Raises UsageError where CoolProp has none."""

    def question() -> float:
        state, coolprop = coolprop_state(fluid)
        try:
            state.update(coolprop.QT_INPUTS, 0.0, T)
            return state.viscosity()
        except ValueError:
            raise UsageError(f"CoolProp has no viscosity of liquid {fluid} at {in_celsius(T)}") from None

    return ask(f"{fluid} liquid viscosity {T!r}", question)


def _of_vapour(fluid: str, p: float, T: float, read: Callable[[Any], list[float]]) -> list[float]:
    """Return what `read` takes from CoolProp's state of a vapour at p [Pa] and T [K]. Raises UsageError."""
    state, coolprop = coolprop_state(fluid)
    try:
        for phase in (coolprop.iphase_not_imposed, coolprop.iphase_gas):  # the latter at saturation
            state.specify_phase(phase)
            with suppress(ValueError):
                state.update(coolprop.PT_INPUTS, p, T)
                return read(state)
    finally:
        state.unspecify_phase()
    raise _unknown(fluid, p, T)


def _unknown(fluid: str, p: float, T: float) -> UsageError:
    """Return the error for a vapour of which CoolProp has no transport properties."""
    return UsageError(f"CoolProp has no transport properties of {fluid} at {in_bar(p)}, {in_celsius(T)}")


def _mixed(made: BlendBorder, wanted: str, T: float) -> float:
    """Return viscosity [Pa s] or conductivity [W/(m K)] of a dilute blend at T [K] (M318)."""
    known = made.known
    viscosities = [_dilute(known.name, name, "viscosity", T) for name in known.components]
    phi = weights(viscosities, [describe(name).molar_mass for name in known.components])
    values = viscosities if wanted == "viscosity" else [_dilute(known.name, x, wanted, T) for x in known.components]
    return mixed(known.fractions, values, phi)


def _dilute(blend: str, component: str, wanted: str, T: float) -> float:
    """Return viscosity [Pa s] or conductivity [W/(m K)] of a component as a dilute gas at T [K]."""

    def question() -> float:
        state, coolprop = coolprop_state(component)
        state.specify_phase(coolprop.iphase_gas)
        try:
            state.update(coolprop.PT_INPUTS, DILUTE, T)
            return getattr(state, wanted)()
        except ValueError:
            raise UsageError(f"CoolProp has no {wanted} of {component}, a component of {blend}") from None
        finally:
            state.unspecify_phase()

    return ask(f"{component} dilute {wanted} {T!r}", question)


def weights(viscosities: Sequence[float], molar_masses: Sequence[float]) -> list[list[float]]:
    """Return Wilke's φ_ij of viscosities [Pa s] and molar masses [kg/mol]: how far molecules j hinder those of i."""
    found: list[list[float]] = []
    for mu_i, M_i in zip(viscosities, molar_masses, strict=True):
        pairs = zip(viscosities, molar_masses, strict=True)
        found.append(
            [
                (1.0 + sqrt(mu_i / mu_j) * (M_j / M_i) ** 0.25) ** 2 / sqrt(8.0 * (1.0 + M_i / M_j))
                for mu_j, M_j in pairs
            ]
        )
    return found


def mixed(fractions: Sequence[float], values: Sequence[float], phi: Sequence[Sequence[float]]) -> float:
    """Return Σ x_i Y_i / Σ_j x_j φ_ij: viscosity or conductivity Y of a mixture of mole fractions x."""
    hindered = (sum(x * each for x, each in zip(fractions, row, strict=True)) for row in phi)
    return sum(x * Y / sum_j for x, Y, sum_j in zip(fractions, values, hindered, strict=True))
