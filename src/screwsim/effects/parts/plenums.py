"""Reservoirs beside the two lines: the data that their state follows from, and the flows that they gave."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from screwsim.effects.parts.readings import Given
from screwsim.fluid.reservoir import Reservoir
from screwsim.fluid.settings import OilProperties


@dataclass(frozen=True)
class Site:
    """The data from which the state of a plenum can be computed (SI units).

    `gas` is the gas model (`screwsim.fluid.real_gas`, `ideal_gas`), `fluid` its CoolProp name. `liquid_enthalpy` is
    that of the real fluid's liquid behind the condenser, `refrigerating_effect` the enthalpy rise of the fluid in the
    evaporator (M43): None where the scene does not state evaporating and condensing temperature. `T_oil` is that of the
    oil's supply, `oil` has its properties there.
    """

    gas: Any
    fluid: str
    p_s: float
    T_s: float
    p_d: float
    liquid_enthalpy: float | None
    refrigerating_effect: float | None
    T_oil: float | None = None
    oil: OilProperties | None = None


@dataclass(frozen=True)
class Drawn:
    """What a plenum gave during the closed cycle: net mass flows [kg/s] from it and from the suction line.

    `brought` [W] is the enthalpy flow of gas that was pushed back into it, above the enthalpy of the plenum's state.
    """

    flow: float
    suction_flow: float
    reservoir: Reservoir
    site: Site
    brought: float = 0.0

    @property
    def ratio(self) -> float | None:
        """Flow from the plenum over suction flow; None where nothing is sucked in."""
        return self.flow / self.suction_flow if self.suction_flow > 0.0 else None


@dataclass(frozen=True)
class Plenum:
    """A reservoir of the working fluid beside the two lines; its state is held constant.

    `state` computes that state, `figures` the effect's own figures of the closed cycle (a text in place of a value says
    why there is none), both in plain Python, once a run. `gain` names the figure by which the cooling capacity grows.
    """

    name: str
    state: Callable[[Site], Reservoir]
    figures: Callable[[Drawn], Given] | None = None
    gain: str = ""
    product: bool = True  # whether its gas counts as gas that the machine compresses (M101)
    evaporates: bool = False  # whether it is liquid, which cools the gas by evaporating
