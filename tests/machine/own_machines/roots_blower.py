"""Roots blower: two rotors of two or three lobes carry pockets along the housing; gas flows back where they open.

A chamber is the pocket between two neighbouring lobes of one rotor, from the mesh over suction, housing and discharge
back to the mesh: one turn of the rotor. φ is the angle of the pocket's middle from the mesh. Each rotor lies against
half a turn of housing, φ = 90° to 270°. The pocket's trailing tip reaches it at φ = 90° + 180°/z, where suction
closes; the leading one leaves it at 270° − 180°/z, where discharge opens. Between them the volume is constant, and
nothing compresses the gas but what flows back. Pockets of both rotors follow each other every 180°/z.

Source: geometry of straight lobes (textbook). How V rises and falls along the ports does not change the work where the
ports are wide: a cycloid, V/V_p = x − sin(2πx)/2π, is taken.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from screwsim.effects.parts.gap import ramp
from screwsim.inputs.declare import choice, count, quantity, word
from screwsim.inputs.faults import Fault
from screwsim.machine.profile_law import Interface, Table
from screwsim.machine.protocol import (
    CONTACT_GAP,
    END_GAP,
    PORTS,
    TIP_GAP,
    AreaLaw,
    MachineGeometry,
    MachineKind,
    MachineSettings,
    Size,
    Speed,
    VolumeKernels,
)
from screwsim.numerics.kernel import kernel

TURN = 2.0 * math.pi
RAMP = math.radians(8.0)  # of ports and gaps


@dataclass(frozen=True)
class RootsBlower(MachineSettings):
    """A Roots blower of two straight rotors."""

    kind: str = word("kind of machine")
    mode: str = choice("a blower compresses", ("compressor",), "compressor")
    lobes: int = count("number of lobes of each rotor", 3, ge=2, le=3)
    rotor_diameter: float = quantity("length", "outer diameter of the rotors", gt=0.0)
    rotor_length: float = quantity("length", "length of the rotors", gt=0.0)
    pocket: float = quantity("volume", "volume that one pocket carries", gt=0.0)
    dead: float = quantity("volume", "volume left of a pocket in the mesh", gt=0.0)
    suction_area: float = quantity("area", "area of the suction port to one pocket", gt=0.0)
    discharge_area: float = quantity("area", "area of the discharge port to one pocket", gt=0.0)
    finds_gaps = "machine.kind: own_machines.roots_blower"

    def symbols(self) -> dict[str, float]:
        return {"rotor_diameter": self.rotor_diameter, "rotor_length": self.rotor_length}

    def surface_speed(self, omega: float) -> float:
        return 0.5 * self.rotor_diameter * omega


@kernel
def rise(x):
    """Return the share of a pocket that is open at the share x of its filling, 0 to 1."""
    if x <= 0.0:
        return 0.0
    if x >= 1.0:
        return 1.0
    return x - math.sin(2.0 * math.pi * x) / (2.0 * math.pi)


@kernel
def rise_slope(x):
    """Return d(rise)/dx."""
    if x <= 0.0 or x >= 1.0:
        return 0.0
    return 1.0 - math.cos(2.0 * math.pi * x)


@kernel
def pocket_volume(phi, dead, pocket, closes, life):
    """Return the volume of a pocket [m³] at phi [rad]: symmetric about half its life."""
    return dead + pocket * rise(min(phi, life - phi) / closes)


@kernel
def pocket_volume_slope(phi, pocket, closes, life):
    """Return dV/dφ [m³/rad]."""
    if phi > 0.5 * life:
        return -pocket / closes * rise_slope((life - phi) / closes)
    return pocket / closes * rise_slope(phi / closes)


@kernel
def port_area(phi, size, opens, shuts, width):
    """Return the area [m²] of a port that a pocket faces between two angles [rad]."""
    return size * ramp(phi, opens, opens + width, shuts - width, shuts)


@dataclass(frozen=True)
class Pockets(MachineGeometry):
    """The pockets of both rotors, youngest first."""

    settings: RootsBlower

    @property
    def pitch(self) -> float:
        return 0.5 * TURN / self.settings.lobes

    @property
    def life(self) -> float:
        return TURN

    @property
    def closes(self) -> float:
        """Angle at which suction closes [rad]."""
        return 0.25 * TURN + self.pitch

    @property
    def injection_angle(self) -> float:
        """The middle of the housing [rad]: the pocket is shut there, or just about to open."""
        return 0.5 * TURN

    @property
    def discharge_opens(self) -> float:
        return TURN - self.closes

    @property
    def swept_volume(self) -> float:
        return self.settings.pocket

    def volume_law(self) -> VolumeKernels:
        values = {"dead": self.settings.dead, "pocket": self.settings.pocket, "closes": self.closes, "life": TURN}
        return VolumeKernels(pocket_volume, pocket_volume_slope, values, (self.closes, self.discharge_opens))

    def suction_law(self) -> AreaLaw:
        return _port(self.settings.suction_area, 0.0, self.closes)

    def discharge_law(self) -> AreaLaw:
        return _port(self.settings.discharge_area, self.discharge_opens, TURN)

    def interfaces(self, gap: str) -> tuple[Interface, ...]:
        """Return the gaps: over tip and ends of a lobe to the pocket ahead on its rotor, between the rotors.

        Angles are those of the trailing pocket, whose leading tip lies against the housing from 90° to 270°. In the
        mesh a pocket that is being pushed out leads to one that is just born, and each pitch another pair does.
        """
        length, housing = self.settings.rotor_length, (0.25 * TURN - self.pitch, 0.75 * TURN - self.pitch)
        if gap == CONTACT_GAP:
            return (Interface(2 * self.settings.lobes - 1, _window(0.0, self.pitch, length)),)
        return (Interface(2, _window(*housing, length if gap == TIP_GAP else self.settings.rotor_diameter)),)


def _port(area: float, opens: float, shuts: float) -> AreaLaw:
    values = {"size": area, "opens": opens, "shuts": shuts, "width": RAMP}
    breakpoints = opens, opens + RAMP, shuts - RAMP, shuts
    return AreaLaw(port_area, values, breakpoints, (breakpoints, (0.0, area, area, 0.0)))


def _window(first: float, last: float, length: float) -> Table:
    """Return a length [m] between two angles [rad], with smooth ramps."""
    angle = np.array([first, first + RAMP, last - RAMP, last, last + RAMP])
    value = np.array([0.0, length, length, 0.0, 0.0])
    return Table(angle, value, np.zeros((4, 2)), tuple(angle[:4].tolist()))


def check(machine: RootsBlower) -> list[Fault]:
    """Return the faults of a blower: pockets that its housing cannot hold."""
    room = 0.5 * math.pi * machine.rotor_diameter**2 * machine.rotor_length / (2 * machine.lobes)
    if machine.pocket + machine.dead <= room:
        return []
    what = f"and machine.dead are more than the {room:.4g} m^3 that a pocket can have of both bores"
    return [Fault("machine.pocket", f"{what} (choose a smaller one, or larger rotors)")]


MACHINE = MachineKind(
    settings=RootsBlower,
    geometry=Pockets,
    offers=frozenset({PORTS, TIP_GAP, CONTACT_GAP, END_GAP}),
    check=check,
    sizes=(Size("effects.tip_leakage.gap", lambda blower: blower.rotor_diameter, "rotor diameters", 0.1, (0.0, 0.01)),),
    speed=Speed("moves the rotors' tips at", 200.0, 60.0, "blowers run at 20 to 50 m/s"),
    chamber="a pocket",
)
