"""Chamber states that an effect adds, their mechanical stops, and heat between gas, oil and walls."""

from collections.abc import Mapping
from dataclasses import dataclass

from screwsim.numerics.kernel import Kernel


@dataclass(frozen=True)
class ChamberState:
    """A state that an effect adds to every chamber, beside those of gas and oil.

    `rate` returns its time derivative [1/s]; its arguments are names of states (`T`, `rho`, `T_oil`, `x_oil`, any
    effect's own), the gas mass `m`, `p`, `V`, `phi` of the chamber, the lines' pressures `p_suction` and `p_discharge`,
    and `values`. A state has a scale of its own in which 1 is large: its error is relative to its value, or to 0.01
    where the value is smaller. In the first turn it starts at `start`. A `positive` state cannot cross zero.
    """

    name: str
    rate: Kernel
    values: Mapping[str, float]
    start: float = 0.0
    positive: bool = False


@dataclass(frozen=True)
class Stops:
    """Seat and stop of a chamber's state, at 0 and 1, between which it moves and at which it rebounds.

    `position` and `speed` name states that the same effect declares, neither of them positive; the speed is the rate of
    the position over a frequency Ω. `push` returns the acceleration of the position at rest over Ω²; its arguments are
    `p`, `p_suction`, `p_discharge`, names of states other than T and rho, and `values`. `restitution` is the ratio of
    speeds after and before an impact, for seat and stop. `remedy` says what to do where the state hardly comes to rest.
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

    `oil_factor` names the factor on the heat that the oil loses ('one': energy is conserved).
    """

    kernel: Kernel
    values: Mapping[str, float]
    oil_factor: str = "one"  # 'one' | 'printed': the misprint of the paper's eq. (12)


@dataclass(frozen=True)
class Wall:
    """A wall that exchanges heat with the gas of the chambers, but not with the oil (M170).

    `conductance` returns α A [W/K] of one chamber; its arguments are symbols (`T`, `m`, `p`, `rho`, `V`, `phi`) or
    `values`. `temperature` [K] is the name of a `Made`, or a number. The net heat from the gas to a wall over a cycle
    goes to the surroundings.
    """

    name: str
    conductance: Kernel
    values: Mapping[str, float]
    temperature: str | float
