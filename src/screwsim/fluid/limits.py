"""Where a history of states first leaves what a gas's equation covers; compiled, for many states at once.

Source: the limits of the equation of state and of its vapour, as the kernel `margin` of the gas gives them.
"""

from __future__ import annotations

from typing import Any

from screwsim.numerics.kernel import Slot, kernel

margin: Any = Slot("margin")


@kernel
def first_outside(T, rho):
    """Return the index of the first state (T [K], ρ [kg/m³]) whose margin is not positive; −1 when there is none."""
    for i in range(T.shape[0]):
        if not (margin(T[i], rho[i]) > 0.0):
            return i
    return -1
