"""Moist air: water vapour in dry air and, where it saturates, liquid in equilibrium (M320, M324–M327).

Each kilogram of the mixture contains `share` of water, vapour and liquid together: condensate stays with its gas. The
Helmholtz energy per volume is the sum of that of dry air (ideal, or by its equation of state), that of dilute vapour,
and for a real gas the second virial terms of vapour with air and with itself; everything else is derived from it, so it
is consistent with and without liquid. The liquid has no volume, and the chemical potential of vapour that saturates
without air. It implements the protocol `fluid.gas`. `dry` is an `IdealGas` or the `RealGas` of air.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, Self, TypeVar

from screwsim.codegen.modules import load
from screwsim.fluid import moist_states as states
from screwsim.fluid import water
from screwsim.fluid.gas import CompiledGas
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.limits import Outside
from screwsim.fluid.real_gas import RealGas
from screwsim.inputs.faults import UsageError
from screwsim.numerics.kept_text import flat_module
from screwsim.numerics.kernel import Kernel
from screwsim.numerics.roots import brentq
from screwsim.outputs.customary import in_bar, in_celsius

Gas = TypeVar("Gas")
T_LOW, T_HIGH = 100.0, 2000.0  # [K] range in which a state is searched
DRIEST = 150.0  # [K] lowest dew point that is reported
TYPICAL = 300.0  # [K] temperature of the representative heat capacities


@dataclass(frozen=True)
class MoistAir(CompiledGas):
    """Dry air with a `share` of water [kg per kg of both]; `c_water` is c_v [J/(kg K)] of ideal vapour, None if real.

    All specific properties are per kilogram of the mixture.
    """

    dry: IdealGas | RealGas
    share: float
    c_water: float | None = None
    varies = True  # exponent and choking vary with the condensate
    _called = "moist air"

    # ---- kernels ---------------------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """The model of the gas."""
        return self.dry.name

    @property
    def equations(self) -> tuple[str, ...]:
        """Numbers of its equations in docs/model.md."""
        return (*self.dry.equations, "M320", "M321", "M322", "M323", "M324", "M325", "M326")

    @property
    def _text(self) -> Mapping[str, Kernel]:
        return states.kernels(self.dry.state, self.dry.specific_entropy, self.c_water is None)

    @cached_property
    def values(self) -> Mapping[str, float]:
        """Values of the kernels' arguments; liquid water at 273.16 K has zero enthalpy and entropy."""
        own = {} if self.c_water is None else {"c_water": self.c_water}
        _rho, h, s, _c = self._text["liquid"](water.T_TRIPLE, *own.values())
        return {**self.dry.values, "y_water": self.share, "u_water": -h, "s_water": -s, **own}

    @cached_property
    def _kernels(self) -> Mapping[str, Callable[..., Any]]:
        """The compiled kernels by name, of their arguments but the gas's values, which are appended."""
        module, values = _module(self.dry.state, self.dry.specific_entropy, self.c_water is None), self.values

        def bound(kernel: Kernel) -> Callable[..., Any]:
            function, rest = getattr(module, kernel.flat_name), [values[x] for x in kernel.arguments if x in values]
            return lambda *given: function(*given, *rest)

        return {name: bound(kernel) for name, kernel in self._text.items()}

    # ---- constants -------------------------------------------------------------------------------------------

    @property
    def humidity_ratio(self) -> float:
        """Water per dry air [kg/kg]."""
        return self.share / (1.0 - self.share)

    @property
    def R(self) -> float:
        """Specific gas constant [J/(kg K)], with all water as vapour."""
        return (1.0 - self.share) * self.dry.R + self.share * water.R_WATER

    @property
    def c_v(self) -> float:
        """Heat capacity at constant volume [J/(kg K)] of the dilute gas, for first guesses."""
        own = water.energy(TYPICAL)[0] if self.c_water is None else self.c_water
        return (1.0 - self.share) * self.dry.c_v + self.share * own

    # ---- states ----------------------------------------------------------------------------------------------

    def density(self, p: float, T: float) -> float:
        """Return density [kg/m³] of the mixture, condensate included, at p [Pa], T [K]."""
        return float(self._kernels["density"](p, T, self.R))

    def enthalpy(self, p: float, T: float) -> float:
        """Return specific enthalpy [J/kg] at p [Pa], T [K]."""
        return float(self._kernels["state"](T, self.density(p, T))[1])

    def entropy(self, p: float, T: float) -> float:
        """Return specific entropy [J/(kg K)] at p [Pa], T [K]."""
        return float(self._kernels["specific_entropy"](T, self.density(p, T)))

    def _found(self, p: float, wanted: float, entropy: bool) -> tuple[float, float]:
        return self._kernels["at_pressure"](p, wanted, entropy, T_LOW, T_HIGH, self.R)

    # ---- water -----------------------------------------------------------------------------------------------

    def liquid_share(self, T: float, rho: float) -> float:
        """Return the share of the mixture that is liquid at T [K], ρ [kg/m³] (M325)."""
        if self._kernels["phase"](T, rho) == 0:
            return 0.0
        return max(self.share - float(self._kernels["saturated_density"](T, (1.0 - self.share) * rho)) / rho, 0.0)

    def condensed(self, p: float, T: float) -> float:
        """Return the share of the mixture that is liquid at p [Pa], T [K] (M325)."""
        return self.liquid_share(T, self.density(p, T))

    def drained(self, p: float, T: float) -> tuple[float, Self]:
        """Return the share of the mixture that remains at p [Pa], T [K] without its liquid, and that gas (M361)."""
        liquid = self.condensed(p, T)
        return 1.0 - liquid, replace(self, share=(self.share - liquid) / (1.0 - liquid)) if liquid > 0.0 else self

    def dew_point(self, p: float) -> float | None:
        """Return the temperature [K] below which water condenses at p [Pa]; over supercooled water below 273.16 K.

        None outside `DRIEST` to `water.T_MOST`: for nearly dry air, or for steam beyond the model's range.
        """

        def beyond(T: float) -> float:
            return math.log(saturated_ratio(self, p, T) / self.humidity_ratio)

        ends = DRIEST, water.T_MOST - 1e-6
        return float(brentq(beyond, *ends)) if beyond(ends[0]) < 0.0 < beyond(ends[1]) else None

    # ---- limits ----------------------------------------------------------------------------------------------

    def why_outside(self, T: float, rho: float) -> Outside | None:
        """Return which limit of its dry air a state violates; None where it violates none."""
        return self.dry.why_outside(T, (1.0 - self.share) * rho)


@lru_cache(maxsize=8)
def _module(dry: Kernel, dry_entropy: Kernel, real: bool) -> Any:
    return load(flat_module(tuple(states.kernels(dry, dry_entropy, real).values())), "fluid")


def after_draining(gas: Gas, p: float, T: float) -> tuple[float, Gas | MoistAir]:
    """Return the share of any gas that remains at p [Pa], T [K] once condensed water is drained, and that gas."""
    return gas.drained(p, T) if isinstance(gas, MoistAir) else (1.0, gas)


def saturated_ratio(gas: MoistAir, p: float, T: float) -> float:
    """Return vapour per dry air [kg/kg] at saturation at p [Pa], T [K]; infinite where water boils (M325)."""
    if T >= water.T_MOST or p <= water.saturation(T)[0]:
        return math.inf
    return float(gas._kernels["saturated_ratio"](p, T))


def moist_air(dry: IdealGas | RealGas, p: float, T: float, humidity: float) -> IdealGas | RealGas | MoistAir:
    """Return air of a relative humidity at p [Pa], T [K]: mole fraction of its vapour over the saturated one (M320).

    Without humidity that is the dry air itself. Raises UsageError where water boils at that state.
    """
    if humidity == 0.0:
        return dry
    c_water = None if isinstance(dry, RealGas) else water.energy(T)[0]
    ratio = saturated_ratio(MoistAir(dry, 0.5, c_water), p, T)
    if not math.isfinite(ratio):
        raise UsageError(f"water boils at {in_bar(p)}, {in_celsius(T)}: air has no relative humidity there")
    moles = ratio * water.R_WATER / dry.R  # vapour per dry air
    fraction = humidity * moles / (1.0 + moles)
    ratio = fraction / (1.0 - fraction) * dry.R / water.R_WATER
    return MoistAir(dry, ratio / (1.0 + ratio), c_water)
