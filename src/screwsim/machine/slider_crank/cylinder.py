"""The cylinder of a slider-crank as model and effects ask for it: one chamber, whose life is one turn of the crank."""

import math
from dataclasses import dataclass

from screwsim.machine.protocol import MachineGeometry, VolumeKernels
from screwsim.machine.slider_crank import kinematics
from screwsim.machine.slider_crank.settings import SliderCrank

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
        return VolumeKernels(kinematics.volume, kinematics.volume_slope, self.settings.numbers(), breakpoints)
