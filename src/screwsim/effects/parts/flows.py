"""Openings through which gas flows, what holds it back in a gap, and what scales their areas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from screwsim.numerics.kernel import Kernel

LINES = SUCTION, DISCHARGE = "suction", "discharge"  # between which a machine works, in the order of their numbers
NEIGHBOUR = "neighbour"  # to which a gap leads: another chamber


@dataclass(frozen=True)
class Resistance:
    """What holds back the nozzle's flow in a gap between chambers (M190).

    `share` returns the share that passes, 0 to 1, of the nozzle's mass flux `flux` [kg/(m² s)]; it may ask for the
    upstream port state's `oil_ratio` and `density` [kg/m³], for numbers of `values`, and for symbols. It must be
    smooth, and flux times share must grow with the flux. `title` says what it is.

    `film`, where given, returns the mass flux of oil [kg/(m² s)] over the gap's area that flows beside the gas's stream
    and the oil in that (M252), at the pressure difference `drop` ≥ 0 [Pa] from the upstream to the downstream port
    state; it may ask for the upstream `oil_ratio` and the like, must be smooth, and nothing at no drop and at no oil.

    `drag`, where given, returns the mass flux of oil [kg/(m² s)] that a moving wall takes along, from the leading port
    state to the trailing chamber whatever their pressures (M256); it may ask for the leading port state's `oil_ratio`,
    and is nothing at no oil. It is that at the mean speed of the rotors, and follows the speed.
    """

    share: Kernel
    values: Mapping[str, float]
    title: str
    film: Kernel | None = None
    drag: Kernel | None = None


@dataclass(frozen=True)
class FlowPath:
    """An opening between a chamber and a plenum, or between two chambers `offset` lobe pitches apart.

    `to` is 'suction', 'discharge', the name of a `Plenum` that an effect of the scene declares, or 'neighbour'.

    `area` returns the cross-section [m²] over the angle `phi` [rad] of the chamber; for two chambers, of the
    trailing one: one area function an interface, so that both sides see the same opening. Beyond the first
    chamber there is no interface, beyond the last one lies the discharge plenum.

    `values` are the numbers [SI] behind the kernel's argument names that are not symbols; `breakpoints` [rad] are the
    angles at which the area is not smooth; `own_breakpoints` those of them that only the chambers of this path feel,
    and not their neighbours; `corners` [rad] are those at which its slope has a corner, where no step need end;
    `tables` hold curves as (angle [rad], area [m²]), or with slopes (`numerics.spline`).
    Where `mirror` [rad] is given, the area at `phi` is that of the kernel at mirror − phi (an expander, M150). Only a
    gap ('neighbour') may have a `resistance`.

    `opening` returns the open share of the area of a path to a plenum where that depends on the chamber's state (a
    valve): its arguments are `drop` [Pa], the plenum's pressure less the chamber's, `width` [Pa], below which pressure
    differences may be smoothed, names of the chamber's states, `held` and `values`. A path that is `narrow` never holds
    the chamber's pressure to its plenum's; of ports and valves the widest open one may. One that is `beside` the ports,
    as a bore back to suction, takes the place of none: a machine without ports is told so all the same. A `port` is the
    machine's own, open to its line only where the machine's law of that port is.

    `one_way` (1: into the chamber, −1: out of it) makes it a switch: the pressure difference tells at the start of a
    step whether it is open, `held` 1 or 0 tells the kernel so, and the step ends where that changes. `held` is FREE
    where no step is held (scipy's integrators), LOOSE where a stored cycle is read (model.slots).

    `law`, where given, is the flow in place of the nozzle's (M12): it returns the mass flux [kg/(m² s)] over the area
    into the chamber, from the numbers of the chamber's own port state, `p_1` [Pa], `rho_1` [kg/m³], `h_1` [J/kg],
    `exponent_1` (1/k), `oil_ratio_1` (0 without carried oil), and of the port state beyond, `p_2` …; with `width`,
    `values` and symbols. It must be smooth, nothing at equal pressures, and have the sign of p_2 − p_1. Its stream
    brings what the port state that it comes from has. `law_title` says what it is, for `screwsim explain`.
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
    resistance: Resistance | None = None
    opening: Kernel | None = None
    narrow: bool = False
    one_way: int = 0
    beside: bool = False
    port: bool = False
    law: Kernel | None = None
    law_title: str = ""

    @property
    def between(self) -> bool:
        """Does it join two chambers?"""
        return self.to == NEIGHBOUR

    def mirrored(self, life: float, pitch: float) -> FlowPath:
        """Return the path of the machine run backwards: angles turned round, both lines exchanged (M150)."""
        mirror = life - self.offset * pitch
        to = {SUCTION: DISCHARGE, DISCHARGE: SUCTION}.get(self.to, self.to)
        names = "breakpoints", "own_breakpoints", "corners"
        turned = {name: tuple(mirror - at for at in getattr(self, name)) for name in names}
        return replace(self, to=to, mirror=mirror, **turned)


@dataclass(frozen=True)
class Scaled:
    """The areas of the flow paths of another effect are multiplied by the number of a `Made` (M180).

    Of a `clearance` so is the `gap` that the flow model of the path asks for (M190).
    """

    effect: str
    by: str
    clearance: bool = False
