"""Slider-crank machines: the cylinder is one chamber, whose life is one turn of the crank."""

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
from screwsim.machine.slider_crank import kinematics
from screwsim.machine.slider_crank.settings import SliderCrank, check_slider_crank

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
        """Angle of the bottom dead centre [rad], where suction ends and the trapped mass is taken."""
        return self.settings.bottom - self.settings.top

    @property
    def swept_volume(self) -> float:
        """Volume that the piston sweeps [m³]."""
        return self.settings.swept_volume

    def volume_law(self) -> VolumeKernels:
        """Return the volume law (S5)."""
        breakpoints = self.settings.breakpoints()
        return VolumeKernels(kinematics.volume, kinematics.volume_slope, self.settings.numbers(), breakpoints)


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
    speed=Speed("moves the piston at a mean speed of", 300.0, 25.0, "those of racing engines move at 25 m/s"),
    called=("piston", "reciprocating"),
    chamber="a cylinder",
    dead_volume=lambda machine: ("machine.clearance", machine.clearance),
)
