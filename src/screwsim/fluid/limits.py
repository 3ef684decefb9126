"""The limits of a gas's equation, and where a history of states first leaves them; compiled, for many at once.

Source: the limits of the equation of state and of its vapour, as the kernel `margin` of the gas gives them.
"""

from enum import Enum, auto
from typing import Any, NamedTuple

from screwsim.numerics.kernel import Slot, kernel

margin: Any = Slot("margin")


class Limit(Enum):
    """Which limit of a gas's equation a state violates; what may help follows from it (`verdict.REMEDIES`)."""

    HOT = auto()
    COLD = auto()
    PRESSED = auto()
    WET = auto()
    GLIDING = auto()  # wet, where its two phases cannot be followed: they differ in composition
    CRITICAL = auto()  # wet, where they are followed no more, next to the critical point


class Outside(NamedTuple):
    """A state that a gas's equation does not cover: which limit it violates, and that in words."""

    limit: Limit
    what: str


@kernel
def first_outside(T, rho):
    """Return the index of the first state (T [K], ρ [kg/m³]) whose margin is not positive; −1 when there is none."""
    for i in range(T.shape[0]):
        if not (margin(T[i], rho[i]) > 0.0):
            return i
    return -1
