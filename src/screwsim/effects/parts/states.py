"""States of a chamber that an effect adds, their stops, and heat between gas, oil and walls."""

from collections.abc import Mapping
from dataclasses import dataclass

from screwsim.numerics.kernel import Kernel


@dataclass(frozen=True)
class ChamberState:
    """A state of its own that an effect gives every chamber, beside those of gas and oil.

    `rate` returns its change [1/s]; its arguments are names of states (`T`, `rho`, `T_oil`, `x_oil`, any effect's own),
    the gas mass `m`, `p`, `V`, `phi` of the chamber, the lines' pressures `p_suction` and `p_discharge`, and `values`.
    A state is measured in a scale of its own, so that 1 is large of it: its errors count against itself, or 0.01 where
    it is less. It begins the first turn at `start`. A `positive` one cannot pass zero.
    """

    name: str
    rate: Kernel
    values: Mapping[str, float]
    start: float = 0.0
    positive: bool = False


@dataclass(frozen=True)
class Stops:
    """Seat and stop of a chamber's state, at 0 and 1, which it meets with impacts and between which it moves.

    `position` and `speed` name states that the same effect declares, neither positive; the speed is the rate of the
    position over a frequency Ω. `push` returns the acceleration at rest over Ω² of the position; its arguments are `p`,
    `p_suction`, `p_discharge`, names of states beyond T and rho, and `values`. `restitution` is the speed after over
    that before an impact, of seat and stop. `remedy` is what to do where it hardly comes to rest.
    """

    position: str
    speed: str
    push: Kernel
    values: Mapping[str, float]
    restitution: tuple[float, float]
    remedy: str = ""


@dataclass(frozen=True)
class HeatRate:
    """Heat [W] from the oil to the gas; the kernel's arguments are symbols or `values`.

    `oil_factor` multiplies the heat that the oil gives away (1: energy is conserved).
    """

    kernel: Kernel
    values: Mapping[str, float]
    oil_factor: str = "one"  # 'one' | 'printed': the misprint of the paper's eq. (12)


@dataclass(frozen=True)
class Wall:
    """A wall that exchanges heat with the gas of the chambers, and not with the oil (M170).

    `conductance` returns α A [W/K] of one chamber; its arguments are symbols (`T`, `m`, `p`, `rho`, `V`, `phi`) or
    `values`. `temperature` [K] is the name of a `Made`, or a number. What the gas gives a wall over a cycle leaves it
    for the surroundings.
    """

    name: str
    conductance: Kernel
    values: Mapping[str, float]
    temperature: str | float
