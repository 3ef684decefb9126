"""Scroll: a pocket is sucked in over one turn of the shaft and closed in over the turns that follow.

φ is the angle of the shaft since a pocket began to open. V rises over the first turn as a cycloid and falls in
proportion to φ over the others, as that of circle involutes does; the discharge opens where the scene says. A pocket
follows the one before after a turn and leaks into the next younger one: over the flanks between two wraps, and over
their tips.

Source: geometry of circle involutes (textbook), their last turn before the centre left as the others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from screwsim.effects.parts.gap import ramp
from screwsim.inputs.declare import choice, count, quantity, word
from screwsim.machine.profile_law import Interface, Table
from screwsim.machine.protocol import (
    CONTACT_GAP,
    PORTS,
    TIP_GAP,
    AreaLaw,
    MachineGeometry,
    MachineKind,
    MachineSettings,
    VolumeKernels,
)
from screwsim.numerics.kernel import kernel

TURN = 2.0 * math.pi
RAMP = math.radians(4.0)  # of ports and gaps
WRAP = 8.0  # length of a wrap's tip between two pockets over the height


@dataclass(frozen=True)
class Scroll(MachineSettings):
    """A scroll compressor."""

    kind: str = word("kind of machine")
    mode: str = choice("a scroll compresses", ("compressor",), "compressor")
    turns: int = count("turns of the shaft that a pocket lives", 3, ge=2, le=6)
    volume: float = quantity("volume", "of a pocket where suction closes", gt=0.0)
    dead: float = quantity("volume", "left of it at the centre", gt=0.0)
    opens: float = quantity("angle", "at which a pocket opens to the discharge", gt=0.0)
    suction_area: float = quantity("area", "area of the suction port to one pocket", gt=0.0)
    discharge_area: float = quantity("area", "area of the discharge port to one pocket", gt=0.0)
    height: float = quantity("length", "height of the wraps", gt=0.0)
    finds_gaps = "machine.kind: own_machines.scroll"

    def symbols(self) -> dict[str, float]:
        return {}

    def surface_speed(self, omega: float) -> float:
        return 0.1 * self.height * omega


@kernel
def pocket_volume(phi, dead, volume, life, turn):
    """Return the volume of a pocket [m³] at phi [rad]."""
    if phi > turn:
        return volume - (volume - dead) * (phi - turn) / (life - turn)
    x = phi / turn
    return dead + (volume - dead) * (x - math.sin(2.0 * math.pi * x) / (2.0 * math.pi))


@kernel
def pocket_volume_slope(phi, dead, volume, life, turn):
    """Return dV/dφ [m³/rad]."""
    if phi > turn:
        return -(volume - dead) / (life - turn)
    return (volume - dead) / turn * (1.0 - math.cos(2.0 * math.pi * phi / turn))


@kernel
def port_area(phi, size, opens, shuts, width):
    """Return the area [m²] of a port that a pocket faces between two angles [rad]."""
    return size * ramp(phi, opens, opens + width, shuts - width, shuts)


@dataclass(frozen=True)
class Pockets(MachineGeometry):
    """The pockets between the wraps, youngest first."""

    settings: Scroll

    @property
    def pitch(self) -> float:
        return TURN

    @property
    def life(self) -> float:
        return TURN * self.settings.turns

    @property
    def injection_angle(self) -> float:
        return TURN

    @property
    def discharge_opens(self) -> float:
        return self.settings.opens

    @property
    def swept_volume(self) -> float:
        return self.settings.volume - self.settings.dead

    def volume_law(self) -> VolumeKernels:
        values = {"dead": self.settings.dead, "volume": self.settings.volume, "life": self.life, "turn": TURN}
        return VolumeKernels(pocket_volume, pocket_volume_slope, values, (TURN,))

    def suction_law(self) -> AreaLaw:
        return _port(self.settings.suction_area, 0.0, TURN)

    def discharge_law(self) -> AreaLaw:
        return _port(self.settings.discharge_area, self.settings.opens, self.life)

    def interfaces(self, gap: str) -> tuple[Interface, ...]:
        """Return the gaps to the pocket ahead, a turn older, while there is one."""
        height = self.settings.height
        length = height if gap == CONTACT_GAP else WRAP * height
        last = self.life - TURN
        angle = np.array([0.0, RAMP, last - RAMP, last, last + RAMP])
        value = np.array([0.0, length, length, 0.0, 0.0])
        return (Interface(1, Table(angle, value, np.zeros((4, 2)), tuple(angle[:4].tolist()))),)


def _port(area: float, opens: float, shuts: float) -> AreaLaw:
    values = {"size": area, "opens": opens, "shuts": shuts, "width": RAMP}
    breakpoints = opens, opens + RAMP, shuts - RAMP, shuts
    return AreaLaw(port_area, values, breakpoints, (breakpoints, (0.0, area, area, 0.0)))


MACHINE = MachineKind(
    settings=Scroll,
    geometry=Pockets,
    offers=frozenset({PORTS, TIP_GAP, CONTACT_GAP}),
    chamber="a pocket",
)
