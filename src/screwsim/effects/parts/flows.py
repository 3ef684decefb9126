"""Openings for gas and their scaling; states that chambers have beside the gas's; heat and walls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from screwsim.effects.parts.flow_kinds import NOZZLE, FlowKind
from screwsim.numerics.kernel import Kernel

LINES = SUCTION, DISCHARGE = "suction", "discharge"  # the machine's two lines, in the order of their numbers
NEIGHBOUR = "neighbour"  # where a gap leads: to another chamber


@dataclass(frozen=True)
class FlowPath:
    """An opening between a chamber and a plenum, or between two chambers `offset` lobe pitches apart.

    `to` is 'suction', 'discharge', the name of a `Plenum` that an effect of the scene declares, or 'neighbour'.

    `area` returns the cross-section [m²] over the angle `phi` [rad] of the chamber; for two chambers, of the trailing
    one: one area function per interface, so that both sides see the same opening. Behind the first chamber there is no
    interface, ahead of the last one lies the discharge plenum.

    `values` are the numbers [SI] of the kernel's arguments that are not symbols. `breakpoints` [rad] are the angles at
    which the area is not smooth; `own_breakpoints` are those that matter only to the chambers of this path, not to
    their neighbours; at `corners` [rad] the slope has a corner, but no step need end. `tables` hold curves as (angle
    [rad], area [m²]), or with slopes (`numerics.spline`). Where `mirror` [rad] is given, the area at `phi` is that of
    the kernel at mirror − phi (an expander, M150).

    `flow` is the kind of flow through the path: a nozzle's (M12), with a resistance, by a law of its own, or a kind
    that an effect brings along (`flow_kinds`).

    `opening` returns the open share of the area of a path to a plenum where that depends on the chamber's state (a
    valve). Its arguments are `drop` [Pa], the plenum's pressure less the chamber's; `width` [Pa], below which pressure
    differences may be smoothed; names of the chamber's states; `held`; and `values`. A `narrow` path never holds the
    chamber's pressure to its plenum's; of ports and valves, the widest open one may. A path that is `beside` the ports,
    such as a bore back to suction, does not count as a port: a machine without ports is still refused. A `port` is the
    machine's own: the chamber is open to its line only where the machine's law of that port says so.

    `one_way` (1: into the chamber, −1: out of it) makes the path a switch: the pressure difference at the start of a
    step decides whether it is open, `held` (1 or 0) passes that to the kernel, and the step ends where it changes.
    `held` is FREE where no step can hold it (scipy's integrators), LOOSE where a stored cycle is read (model.slots).
    """

    to: str
    area: Kernel
    values: Mapping[str, float]
    breakpoints: Sequence[float] = ()
    own_breakpoints: Sequence[float] = ()
    corners: Sequence[float] = ()
    offset: int = 0  # lobe pitches from the trailing to the leading chamber
    flow_coefficient: float = 1.0
    tables: Mapping[str, Any] = field(default_factory=dict)
    mirror: float | None = None
    flow: FlowKind = NOZZLE
    opening: Kernel | None = None
    narrow: bool = False
    one_way: int = 0
    beside: bool = False
    port: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.flow, FlowKind):
            what = f"flow of a path is a {type(self.flow).__name__}, not a kind of flow"
            raise TypeError(f"{what} (for a kernel that returns a flux, write flow=Law(kernel))")

    @property
    def between(self) -> bool:
        """Whether the path joins two chambers."""
        return self.to == NEIGHBOUR

    def checked(self, role: str) -> str:
        """Return the name of the function that calls a bounded kernel of the kind of flow by the path's number."""
        return f"{'gap' if self.between else 'port'}_{role}"

    def mirrored(self, life: float, pitch: float) -> FlowPath:
        """Return the path of the machine run backwards: angles reversed, suction and discharge exchanged (M150)."""
        mirror = life - self.offset * pitch
        to = {SUCTION: DISCHARGE, DISCHARGE: SUCTION}.get(self.to, self.to)
        names = "breakpoints", "own_breakpoints", "corners"
        turned = {name: tuple(mirror - at for at in getattr(self, name)) for name in names}
        return replace(self, to=to, mirror=mirror, **turned)


@dataclass(frozen=True)
class Scaled:
    """The areas of another effect's flow paths are multiplied by the number of a `Made` (M180).

    With `clearance` so is the `gap` that the path's flow model takes (M190).
    """

    effect: str
    by: str
    clearance: bool = False


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
