"""The protocol of a gas: what a property back end provides to the rest of the program, one object per gas.

A new back end is a module with a class that has everything that `Gas` lists, and passes
tests/fluid/test_gas_protocol.py; it need not inherit from `Gas`. It has two halves, which the test checks against each
other:

*Kernels*, pasted into the compiled model (`model.writing.write_gas`). Their arguments are `T` [K], `rho` [kg/m³] and
names of `values`, numbers that go into the model's vector; they take and return scalars, allocate nothing, and are
smooth except at a phase border. `state` returns

    p [Pa], h [J/kg], c_v [J/(kg K)], T ∂p/∂T|ρ [Pa], 1/k, relative drop and ψ² at which a nozzle chokes (M13)

with k = ρ c²/p of isentropic flow. `specific_entropy` returns s [J/(kg K)] of the same equation, so that T ds = du + p
d(1/ρ): the entropy balance relies on it. A gas of two phases also gives `phased_state`: a kernel of the phase, a whole
number, and one of the state, which continues smoothly in a given phase (arguments: `phase`, then as `state`), so that a
step can end at the border. Where 1/k and choking are the same everywhere `varies` is False, and less is compiled.

*Plain Python*, called a few times a run: properties by pressure and temperature, or enthalpy, and ideal works. A state
that does not exist, such as a liquid where vapour is needed, raises UsageError in one line with the remedy.
`first_outside` and `why_outside` say which states of a cycle the equation does not cover, by a code of `limits.Limit`;
remedies follow from the code (`verdict.remedy_for`).

The settings of a gas in a scene are in `fluid.settings`; `build.build_gas` makes the gas from them. Effects that need
more than this, such as condensed liquid or saturation, check for `gas.model: real` themselves.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from math import log
from typing import Any, Protocol

import numpy as np

from screwsim.fluid.limits import Outside
from screwsim.fluid.reservoir import Reservoir
from screwsim.inputs.faults import QuantityNotFound
from screwsim.numerics.kernel import Kernel
from screwsim.outputs.customary import in_bar


class CommonGas(Protocol):
    """What follows from other members of `Gas`; a gas that differs overrides it."""

    @property
    def c_p(self: Any) -> float:
        """Heat capacity at constant pressure [J/(kg K)] of the dilute gas."""
        return self.c_v + self.R

    def vapour(self: Any, p: float, T: float) -> Reservoir:
        """Return a reservoir at p [Pa] and T [K]."""
        p, rho, h, exponent, choke, choked = self.port_state(p, T)
        return Reservoir(p, T, rho, h, self.entropy(p, T), exponent, choke, choked)

    def nearest_vapour(self, p: float, T: float) -> float:
        """Return T: there is gas at every temperature."""
        return T

    def isothermal_obstacle(self, p_1: float, p_2: float, T: float) -> str | None:
        """Return None: there is no obstacle; liquid that condenses on the way is in equilibrium."""
        return None

    def isothermal_work(self: Any, p_1: float, p_2: float, T: float) -> float | None:
        """Return the reversible isothermal work Δ(h − T s) [J/kg]; None where `isothermal_obstacle` says why."""
        if self.isothermal_obstacle(p_1, p_2, T) is not None:
            return None
        g_1, g_2 = (self.enthalpy(p, T) - T * self.entropy(p, T) for p in (p_1, p_2))
        return g_2 - g_1

    def ideal_isothermal_work(self: Any, p_1: float, p_2: float, T: float) -> float:
        """Return R T ln(p_2/p_1) [J/kg], the work of an ideal gas."""
        return self.R * T * log(p_2 / p_1)

    def first_outside(self: Any, T: np.ndarray, rho: np.ndarray) -> int | None:
        """Return the index of an extreme state to which `why_outside` objects; None where there is none."""
        extremes = sorted({int(T.argmin()), int(T.argmax()), int(rho.argmax()), int((rho * T).argmax())})
        return next((i for i in extremes if self.why_outside(float(T[i]), float(rho[i])) is not None), None)


class CompiledGas(CommonGas, Protocol):
    """A gas whose states are computed by compiled kernels, `_kernels` by name, and searched along isobars by `_found`.

    `_found(p, wanted, entropy)` returns (T, ρ) at an entropy, else enthalpy; ρ is not positive where there is none.
    `_text` holds the kernels for the model by name.
    """

    @property
    def state(self: Any) -> Kernel:
        """Kernel (T, rho, …) → p, h, c_v, T ∂p/∂T, 1/k, drop and ψ² of choking."""
        return self._text["state"]

    @property
    def phased_state(self: Any) -> tuple[Kernel, Kernel] | None:
        """Kernels (T, rho, …) → phase and (phase, T, rho, …) → state; None where there is one phase."""
        return (self._text["phase"], self._text["phased_state"]) if "phase" in self._text else None

    @property
    def specific_entropy(self: Any) -> Kernel:
        """Kernel (T, rho, …) → s [J/(kg K)]."""
        return self._text["specific_entropy"]

    def _at(self: Any, p: float, wanted: float, entropy: bool) -> tuple[float, float]:
        """Return (T, ρ) at p and an enthalpy or entropy. Raises QuantityNotFound below the equation's range."""
        T, rho = self._found(p, wanted, entropy)
        if not rho > 0.0:
            what = f"s = {wanted:.6g} J/(kg K)" if entropy else f"h = {wanted:.6g} J/kg"
            raise QuantityNotFound(
                f"{self._called} at {in_bar(p)}, {what} is below the range of the equation; use warmer gas or oil"
            )
        return T, rho

    def temperature(self: Any, p: float, h: float) -> float:
        """Return temperature [K] at p [Pa] and specific enthalpy h [J/kg]; T_sat within a pure fluid's dome."""
        return float(self._at(p, h, False)[0])

    def port_state(self: Any, p: float, T: float) -> tuple[float, ...]:
        """Return (p, ρ, h, 1/k, drop and ψ² of choking) of a plenum at p [Pa], T [K]."""
        return _port_state(self, p, T, self.density(p, T))

    def port_state_of_enthalpy(self: Any, p: float, h: float) -> tuple[float, ...]:
        """Return the same as `port_state`, at p [Pa] and specific enthalpy h [J/kg]; in equilibrium where that is wet.

        While a cycle is being closed a state may be wet for a time; `why_outside` says whether the closed cycle may be.
        """
        return _port_state(self, p, *self._at(p, h, False))

    def isentrope(self: Any, p: float, s: float) -> tuple[float, float, float]:
        """Return (T [K], ρ [kg/m³], h [J/kg]) at p [Pa] and specific entropy s [J/(kg K)]; wet states in equilibrium.

        Raises QuantityNotFound where there is no such state.
        """
        T, rho = self._at(p, s, True)
        return T, rho, float(self._kernels["state"](T, rho)[1])

    def isentropic_work(self: Any, p_1: float, p_2: float, T: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from (p_1, T) to p_2, with condensate in equilibrium."""
        return self.isentrope(p_2, self.entropy(p_1, T))[2] - self.enthalpy(p_1, T)

    def isentropic_work_of_enthalpy(self: Any, p_1: float, p_2: float, h: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from p_1 and specific enthalpy h, wet or not, to p_2."""
        return self.isentrope(p_2, float(self._kernels["specific_entropy"](*self._at(p_1, h, False))))[2] - h


@lru_cache(maxsize=64)  # those of the lines are asked for again and again
def _port_state(gas: Any, p: float, T: float, rho: float) -> tuple[float, ...]:
    _p, h, _c_v, _tpt, a, choke, choked = gas._kernels["state"](T, rho)
    return p, rho, h, a, choke, choked


class Gas(CommonGas, Protocol):
    """One gas; equal gases are equal objects, and none is mutable."""

    @property
    def equations(self) -> Sequence[str]:
        """Numbers of its equations in docs/model.md."""
        ...

    # ---- kernels ---------------------------------------------------------------------------------------------

    @property
    def varies(self) -> bool:
        """Whether exponent and choking vary with the state."""
        ...

    @property
    def values(self) -> Mapping[str, float]:
        """Values of the kernels' arguments beside T and rho."""
        ...

    @property
    def state(self) -> Kernel:
        """Kernel (T, rho, …) → the seven numbers."""
        ...

    @property
    def phased_state(self) -> tuple[Kernel, Kernel] | None:
        """Kernels (T, rho, …) → phase and (phase, T, rho, …) → state; None where there is one phase."""
        ...

    @property
    def specific_entropy(self) -> Kernel:
        """Kernel (T, rho, …) → s [J/(kg K)]."""
        ...

    # ---- constants -------------------------------------------------------------------------------------------

    @property
    def R(self) -> float:
        """Specific gas constant [J/(kg K)]."""
        ...

    @property
    def c_v(self) -> float:
        """Heat capacity at constant volume [J/(kg K)] of the dilute gas, for first guesses."""
        ...

    # ---- states ----------------------------------------------------------------------------------------------

    def density(self, p: float, T: float) -> float:
        """Return density [kg/m³] of the gas at p [Pa], T [K]."""
        ...

    def enthalpy(self, p: float, T: float) -> float:
        """Return specific enthalpy [J/kg] at p [Pa], T [K]."""
        ...

    def entropy(self, p: float, T: float) -> float:
        """Return specific entropy [J/(kg K)] at p [Pa], T [K]."""
        ...

    def temperature(self, p: float, h: float) -> float:
        """Return temperature [K] at p [Pa] and specific enthalpy h [J/kg]."""
        ...

    def port_state(self, p: float, T: float) -> tuple[float, ...]:
        """Return (p, ρ, h, 1/k, drop and ψ² of choking) of a plenum at p [Pa], T [K]."""
        ...

    def port_state_of_enthalpy(self, p: float, h: float) -> tuple[float, ...]:
        """Return the same as `port_state`, at p [Pa] and specific enthalpy h [J/kg]."""
        ...

    # ---- work ------------------------------------------------------------------------------------------------

    def isentropic_work(self, p_1: float, p_2: float, T: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from (p_1, T) to p_2."""
        ...

    def isentropic_work_of_enthalpy(self, p_1: float, p_2: float, h: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from p_1 and specific enthalpy h to p_2."""
        ...

    # ---- limits ----------------------------------------------------------------------------------------------

    def why_outside(self, T: float, rho: float) -> Outside | None:
        """Return which limit of its equation a state violates; None where it violates none."""
        ...


def kernel_value(gas: Gas, kernel: Kernel, T: float, rho: float) -> Any:
    """Return what a kernel of a gas gives at T [K] and ρ [kg/m³], in plain Python."""
    named = {"T": T, "rho": rho, **gas.values}
    return kernel(*(named[name] for name in kernel.arguments))
