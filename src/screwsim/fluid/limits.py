"""The limits of a gas's equation, and the first of many states that violates them, as a compiled kernel.

Source: the limits of the equation of state and of its vapour, as given by the gas's kernel `margin`.
"""

from enum import Enum, auto
from typing import Any, NamedTuple

from screwsim.numerics.kernel import Slot, kernel

margin: Any = Slot("margin")


class Limit(Enum):
    """A limit of a gas's equation that a state violates; remedies follow from it (`verdict.remedy_for`)."""

    HOT = auto()
    COLD = auto()
    PRESSED = auto()
    WET = auto()
    GLIDING = auto()  # wet, and the phases cannot be computed: they differ in composition
    CRITICAL = auto()  # wet, too close to the critical point for the phases to be computed


class Outside(NamedTuple):
    """A state that a gas's equation does not cover: the limit that it violates, and a text."""

    limit: Limit
    what: str


@kernel
def first_outside(T, rho):
    """Return the index of the first state (T [K], ρ [kg/m³]) whose margin is not positive; −1 where there is none."""
    for i in range(T.shape[0]):
        if not (margin(T[i], rho[i]) > 0.0):
            return i
    return -1
