"""Slider-crank machines: their cylinder is one chamber, whose life is one turn of the crank.

Motion of the piston of an offset slider-crank, and the chamber volume over the angle of its life.

x is counted from the crankshaft's axis towards the cylinder head, α from the direction of the cylinder, e from the
crankshaft's axis to the cylinder's. The chamber's angle φ begins at the top dead centre: V(0) is the clearance.
Source: loop of vectors; V. V. Solovyova, "Optimization of the transfer function of a piston compressor", 2019 (in
Russian), for x(α) and the signs. Needs rod > crank + |offset|. Equations: docs/reference/slider-crank.md.
"""

import math
from dataclasses import dataclass
from operator import attrgetter

from screwsim.machine.protocol import (
    BORE,
    CYLINDER,
    PISTON,
    MachineGeometry,
    MachineKind,
    Measure,
    Size,
    Speed,
    VolumeKernels,
)
from screwsim.machine.slider_crank.settings import SliderCrank, check_slider_crank
from screwsim.numerics.kernel import kernel

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Cylinder(MachineGeometry):
    """One chamber without neighbours, from top dead centre to top dead centre (S5)."""

    settings: SliderCrank

    @property
    def pitch(self) -> float:
        """One turn of the crank [rad]: there is one chamber."""
        return TURN

    @property
    def life(self) -> float:
        """One turn of the crank [rad]."""
        return TURN

    @property
    def injection_angle(self) -> float:
        """Angle of the bottom dead centre [rad]: suction ends there, the trapped mass is taken."""
        return self.settings.bottom - self.settings.top

    @property
    def swept_volume(self) -> float:
        """Volume that the piston sweeps [m³]."""
        return self.settings.swept_volume

    def volume_law(self) -> VolumeKernels:
        """Return the volume law (S5)."""
        breakpoints = self.settings.breakpoints()
        return VolumeKernels(volume, volume_slope, self.settings.numbers(), breakpoints)


_bore, _piston, _swept = (attrgetter(name) for name in ("bore", "piston_area", "swept_volume"))
_BORE = "of the bore"
_SIZES = (
    Size("machine.crank_radius", _bore, _BORE, 100.0, (0.05, 5.0)),
    Size("machine.rod_length", _bore, _BORE, 1000.0, (0.1, 30.0)),
    Size("machine.clearance", _swept, "of the swept volume", 100.0, (1e-4, 0.5)),
)

MACHINE = MachineKind(
    settings=SliderCrank,
    geometry=Cylinder,
    offers=frozenset({CYLINDER}),
    check=check_slider_crank,
    sizes=_SIZES,
    scales={BORE: Measure(_bore, _BORE), PISTON: Measure(_piston, "of the piston's area")},
    speed=Speed("moves the piston, in the mean, at", 300.0, 25.0, "those of engines for races move at 25 m/s"),
    called=("piston", "reciprocating"),
    chamber="a cylinder",
    dead_volume=lambda machine: ("machine.clearance", machine.clearance),
)


@kernel
def position(alpha, crank, rod, offset):
    """Return the piston's position x [m] (S1)."""
    u = crank * math.sin(alpha) - offset
    return crank * math.cos(alpha) + math.sqrt(rod * rod - u * u)


@kernel
def slope(alpha, crank, rod, offset):
    """Return dx/dα [m/rad] (S2)."""
    u = crank * math.sin(alpha) - offset
    return -crank * math.sin(alpha) - crank * math.cos(alpha) * u / math.sqrt(rod * rod - u * u)


@kernel
def second_slope(alpha, crank, rod, offset):
    """Return d²x/dα² [m/rad²] (S3)."""
    u = crank * math.sin(alpha) - offset
    du = crank * math.cos(alpha)
    height = math.sqrt(rod * rod - u * u)
    dheight = -u * du / height
    return -crank * math.cos(alpha) - (du * du - u * crank * math.sin(alpha) + dheight * dheight) / height


@kernel
def velocity(alpha, omega, crank, rod, offset):
    """Return the piston's speed dx/dt [m/s], positive towards the head (S3)."""
    return omega * slope(alpha, crank, rod, offset)


@kernel
def acceleration(alpha, omega, domega_dt, crank, rod, offset):
    """Return the piston's acceleration [m/s²] (S3)."""
    return omega * omega * second_slope(alpha, crank, rod, offset) + domega_dt * slope(alpha, crank, rod, offset)


@kernel
def top_angle(crank, rod, offset):
    """Return the crank angle of the top dead centre [rad] (S4)."""
    return math.asin(offset / (rod + crank))


@kernel
def bottom_angle(crank, rod, offset):
    """Return the crank angle of the bottom dead centre [rad] (S4)."""
    return math.pi + math.asin(offset / (rod - crank))


@kernel
def stroke(crank, rod, offset):
    """Return the way between the dead centres [m] (S4)."""
    far, near = rod + crank, rod - crank
    return math.sqrt(far * far - offset * offset) - math.sqrt(near * near - offset * offset)


@kernel
def volume(phi, V_c, A_piston, crank, rod, offset):
    """Return the chamber volume [m³] (S5)."""
    far = rod + crank
    top = math.sqrt(far * far - offset * offset)
    return V_c + A_piston * (top - position(phi + top_angle(crank, rod, offset), crank, rod, offset))


@kernel
def volume_slope(phi, A_piston, crank, rod, offset):
    """Return dV/dφ [m³/rad] (S5)."""
    return -A_piston * slope(phi + top_angle(crank, rod, offset), crank, rod, offset)
