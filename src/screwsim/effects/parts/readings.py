"""What effects read of a scene and of a closed cycle, their power losses and shaft, reservoirs beside the two lines."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from screwsim.fluid.reservoir import Reservoir
from screwsim.fluid.settings import OilProperties

Given = Mapping[str, float | str | None]  # figures by name; a text in place of a value says why there is none


@dataclass(frozen=True)
class PowerLoss:
    """Power [W] beside the gas work, computed from figures of the closed cycle (plain Python, once a run).

    `kept` is the part of it that stays in the oil as pressure; the rest is dissipated at ambient temperature. With a
    separator all of it heats the outflow, except that of a loss with `friction` (bearings, seals, gears) only the share
    that the separator states does.
    """

    figure: str
    power: Callable[[Any], float]
    kept: Callable[[Any], float] | None = None
    friction: bool = False


@dataclass(frozen=True)
class Reading:
    """Figures and traces [SI] read from a closed cycle and its powers, which they do not change (plain Python).

    `read` returns the values of `figures`, with all losses known, or a text that says why there is none. `traces`
    returns curves over the points of one pitch (`cycle.pitch.POINTS`), which repeat every pitch. `judge` returns a text
    that says why the point has failed (empty: it has not), and warnings.
    """

    figures: tuple[str, ...]
    read: Callable[[Any], Given]
    traces: Callable[[Any], Mapping[str, Any]] | None = None
    judge: Callable[[Any], tuple[str, tuple[str, ...]]] | None = None


@dataclass(frozen=True)
class Shaft:
    """A speed that varies over a pitch (M210–M217).

    `respond` returns the periodic motion of the drive (`machine.drive.response.Response`) under the torque of a closed
    cycle, or raises `NoMotion`. `judge` returns a text that says why that motion is ruled out (empty: it is not),
    warnings, and the relative residual of its powers.
    """

    train: Callable[[float], Any]  # of the speed [rad/s] that the scene states
    respond: Callable[[Any], Any]
    judge: Callable[[Any], tuple[str, tuple[str, ...], float]]


@dataclass(frozen=True)
class Around:
    """What an effect can learn about a scene before it is composed (SI units).

    `fluid` is the gas's CoolProp name, `tip_speed` that of the male rotor, or the mean piston speed. `T_oil` is that of
    the oil's supply, `oil` has its properties there.
    """

    fluid: str
    p_s: float
    T_s: float
    p_d: float
    tip_speed: float
    T_oil: float | None = None
    oil: OilProperties | None = None


@dataclass(frozen=True, kw_only=True)
class Site(Around):
    """The data from which the state of a plenum can be computed (SI units).

    `gas` is the gas model (`screwsim.fluid.real_gas`, `ideal_gas`). `liquid_enthalpy` is that of the real fluid's
    liquid behind the condenser, `refrigerating_effect` the enthalpy rise of the fluid in the evaporator (M43): None
    where the scene does not state evaporating and condensing temperature.
    """

    gas: Any
    liquid_enthalpy: float | None
    refrigerating_effect: float | None


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
    why there is none), both in plain Python, once a run. `gain` names the figure by which the cooling capacity grows,
    `lacking` that of a heat [W] by which the heating capacity falls.
    """

    name: str
    state: Callable[[Site], Reservoir]
    figures: Callable[[Drawn], Given] | None = None
    gain: str = ""
    lacking: str = ""
    product: bool = True  # whether its gas counts as gas that the machine compresses (M101)
    evaporates: bool = False  # whether it is liquid, which cools the gas by evaporating
