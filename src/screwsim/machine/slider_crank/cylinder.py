"""The cylinder of a slider-crank as model and effects ask for it: one chamber, whose life is one turn of the crank."""

from __future__ import annotations

import math
from dataclasses import dataclass

from screwsim.machine.geometry import VolumeKernels
from screwsim.machine.slider_crank import kinematics
from screwsim.machine.slider_crank.settings import SliderCrank

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Cylinder:
    """One chamber without neighbours, from top dead centre to top dead centre (S5)."""

    settings: SliderCrank

    pitch = TURN
    life = TURN
    chambers = 1
    expands = False
    discharge_opens = inlet_closes = None
    profile = None
    outcomes: tuple[float, ...] = ()

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
        knots = self.settings.knots()
        return VolumeKernels(kinematics.volume, kinematics.volume_slope, self.settings.numbers(), knots)

    def widest_discharge(self) -> float:
        """Return the angle up to which the highest pressure is looked for [rad]: the end of the turn."""
        return self.life
