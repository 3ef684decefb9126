"""What a gas brings: the contract between a property back end and the rest of the program, one gas an object.

A new back end is one module with a class that has what `Gas` lists, and passes tests/fluid/test_gas_protocol.py; it
need not inherit from `Gas`. Two halves belong together, and the test holds them against each other:

*Kernels*, pasted into the compiled model (`model.writing.write_gas`). Their arguments are `T` [K], `rho` [kg/m³] and
names of `values`, numbers that go into the model's vector; they take and return scalars, allocate nothing, and are
smooth but for the border of a phase. `state` returns

    p [Pa], h [J/kg], c_v [J/(kg K)], T ∂p/∂T|ρ [Pa], 1/k, relative drop and ψ² at which a nozzle chokes (M13)

with k = ρ c²/p of isentropic flow. `specific_entropy` returns s [J/(kg K)] of the same equation, so that T ds =
du + p d(1/ρ): the balance of entropy is made of it. A gas of two phases gives `phased_state`, too: kernels of the
phase, a whole number, and of the state that goes on smoothly in a stated phase (`phase`, then as `state`), so that a
step can end at the border. Where 1/k and choking are the same everywhere `varies` is False, and less is compiled.

*Plain Python*, asked a few times a run: what belongs to pressure and temperature, or enthalpy, and ideal works. A
state that there is not, say a liquid where vapour is asked for, raises UsageError in one line with the remedy.
`first_outside` and `why_outside` say which states of a cycle the equation does not cover, by a code of `limits.Limit`;
what may help follows from the code (`verdict.REMEDIES`).

What a scene says of a gas is in `fluid.settings`; `build.build_gas` makes the gas of it. Effects that ask for more than
this, a condensed liquid or a saturation, check for `gas.model: real` themselves.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from screwsim.fluid.limits import Outside
from screwsim.fluid.reservoir import Reservoir
from screwsim.numerics.kernel import Kernel


class Gas(Protocol):
    """One gas; equal ones are equal objects, and none changes."""

    @property
    def equations(self) -> Sequence[str]:
        """Numbers of its equations in docs/model.md."""
        ...

    # ---- kernels ---------------------------------------------------------------------------------------------

    @property
    def varies(self) -> bool:
        """Do exponent and choking vary with the state?"""
        ...

    @property
    def values(self) -> Mapping[str, float]:
        """Numbers behind the kernels' argument names."""
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
        """Heat capacity at constant volume [J/(kg K)], of the dilute gas: for first guesses."""
        ...

    @property
    def c_p(self) -> float:
        """Heat capacity at constant pressure [J/(kg K)], of the dilute gas: for first guesses."""
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
        """Return what `port_state` does, at p [Pa] and specific enthalpy h [J/kg]."""
        ...

    def vapour(self, p: float, T: float) -> Reservoir:
        """Return a reservoir at p [Pa] and T [K]."""
        ...

    def nearest_vapour(self, p: float, T: float) -> float:
        """Return T [K], or the nearest temperature at which there is gas at p [Pa]: for first guesses."""
        ...

    # ---- work ------------------------------------------------------------------------------------------------

    def isentropic_work(self, p_1: float, p_2: float, T: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from (p_1, T) to p_2."""
        ...

    def isentropic_work_of_enthalpy(self, p_1: float, p_2: float, h: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from p_1 and specific enthalpy h to p_2."""
        ...

    def isothermal_obstacle(self, p_1: float, p_2: float, T: float) -> str | None:
        """Return why there is no isothermal compression from p_1 to p_2 at T, or None."""
        ...

    def isothermal_work(self, p_1: float, p_2: float, T: float) -> float | None:
        """Return the reversible isothermal work Δ(h − T s) [J/kg]; None where `isothermal_obstacle` says why."""
        ...

    def ideal_isothermal_work(self, p_1: float, p_2: float, T: float) -> float:
        """Return R T ln(p_2/p_1) [J/kg]."""
        ...

    # ---- limits ----------------------------------------------------------------------------------------------

    def first_outside(self, T: Any, rho: Any) -> int | None:
        """Return the index of a first of the states (arrays) that `why_outside` complains of, or None."""
        ...

    def why_outside(self, T: float, rho: float) -> Outside | None:
        """Return which limit of its equation a state violates, or None."""
        ...
