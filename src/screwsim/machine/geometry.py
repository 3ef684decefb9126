"""From a machine's settings to its laws: kernels with their numbers, breakpoints and tables.

Of screw rotors also the speed at which the housing slides past the gaps at tips and end faces, seen from the rotors.

Source: docs/model.md M256; kinematics of helical rotors (textbook). The tips of both rotors are helices of one lead
angle each, the lobes' end faces lie between root and outer circle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import hypot, radians
from typing import TYPE_CHECKING

import numpy as np

from screwsim.machine import moved_port
from screwsim.machine.protocol import END_GAP, TIP_GAP, AreaLaw, MachineGeometry, VolumeKernels
from screwsim.machine.settings import LIFE, TURN, TwinScrew

if TYPE_CHECKING:
    from screwsim.machine.profile_law import Interface, LaidCurves

WRAP, CENTRES = radians(300.0), 0.8  # wrap angle, and axis distance over D, of the 4/6 pair of M20 and M21


@dataclass(frozen=True)
class Geometry(MachineGeometry):
    """A pair of screw rotors: laws of the paper, of tables, or of a rotor profile."""

    settings: TwinScrew  # pyrefly: ignore[bad-override] - frozen

    @property
    def lobes(self) -> int:
        """Number of male lobes z1: chambers per revolution."""
        return self.settings.male_lobes

    @property
    def pitch(self) -> float:
        """Angle between neighbouring chambers [rad]."""
        return self.settings.pitch

    def wall_speed(self, gap: str) -> float:
        """Return the mean speed at which the housing slides past tips or end faces, over the male tip speed (M256)."""
        return wall_speeds(self.settings).get(gap, 0.0)

    @cached_property  # read a thousand times a cycle
    def profile(self) -> LaidCurves | None:
        """The curves that the rotor profile gives by angle; None where the volume follows another law."""
        if not self.settings.volume.from_rotors:
            return None
        # here: rotors take long to import, and closed forms need none
        from screwsim.machine.profile_law import laid_curves

        return laid_curves(self.settings)

    @property
    def life(self) -> float:
        """Angle of a chamber's life [rad]."""
        return self.profile.life if self.profile is not None else self.settings.volume.life or LIFE

    @property
    def injection_angle(self) -> float:
        """Angle at which oil is injected and the trapped mass is taken [rad]; for an expander, mirrored (M150)."""
        own = self.profile.injection if self.profile is not None else self.settings.volume.injection_angle or TURN
        return self.life - own if self.expands else own

    @property
    def expands(self) -> bool:
        """Tell whether the machine runs backwards, as an expander (M150)."""
        return self.settings.expands

    @property
    def discharge_opens(self) -> float | None:
        """Angle of the chamber at which the discharge port opens, or an expander's inlet closes [rad].

        None without that port, or where the port is open from its first row to its widest.
        """
        opens = self.discharge_law().opens if self.settings.discharge_port is not None else None
        return self.life - opens if self.expands and opens is not None else opens

    @property
    def stated_volume_ratio(self) -> float | None:
        """Built-in volume ratio that the scene states, where the discharge port follows from it."""
        port = self.settings.discharge_port
        if self.profile is not None and self.profile.volume_ratio is not None:
            return self.profile.volume_ratio
        ratios = (self.settings.built_in_volume_ratio, self.settings.axial_volume_ratio)
        stated = [each for each in ratios if each is not None]
        return min(stated) if stated and port is not None and port.from_rotors else None

    @property
    def swept_volume(self) -> float:
        """Swept volume of one chamber [m³]."""
        return self.profile.swept if self.profile is not None else self.settings.volume.max or 0.0

    @property
    def outcomes(self) -> tuple[float, ...]:
        """Numbers that distinguish machines defined by tables: volume [m³], opening [rad], travel of a slide [m]."""
        port = self.settings.discharge_port
        tabled = port is not None and port.from_file and self.settings.built_in_volume_ratio is not None
        opens = (self.discharge_law().opens or 0.0,) if tabled else ()
        if self.profile is None:
            return opens
        slide = self.settings.slide_valve
        moved = () if slide is None else (slide.position * slide.travel,)
        return self.profile.swept, self.profile.opens, *moved, *opens

    def interfaces(self, gap: str) -> tuple[Interface, ...] | None:
        """Return the leakage paths of a kind from the profile; None where formulas of the effects define them."""
        return self.profile.interfaces[gap] if self.profile is not None else None

    def male_slope(self, angle: np.ndarray) -> np.ndarray | None:
        """Return the male rotor's part of dV/dφ [m³/rad] at angles [rad]; None without a profile."""
        if self.profile is None:
            return None
        turned, rotors = self.life - angle if self.expands else angle, self.profile.rotors
        slope = rotors.male_slope(turned - self.profile.born + rotors.start)
        return -slope if self.expands else slope

    def volume_law(self) -> VolumeKernels:
        """Return the volume law; for an expander, mirrored (M150)."""
        law = self.settings.volume.read_by.volume(self)
        if not self.expands:
            return law
        breakpoints, own = (tuple(self.life - at for at in each) for each in (law.breakpoints, law.own_breakpoints))
        return replace(law, mirror=self.life, breakpoints=breakpoints, own_breakpoints=own)

    def suction_law(self) -> AreaLaw:
        """Return the area law of the suction port, over the angle of a compressor."""
        law = self.settings.suction_port
        assert law is not None  # checked with the scene
        return law.read_by.suction(self, law)

    def discharge_law(self) -> AreaLaw:
        """Return the area law of the discharge port, over the angle of a compressor."""
        return self._discharge

    @cached_property
    def _discharge(self) -> AreaLaw:
        law = self.settings.discharge_port
        assert law is not None  # checked with the scene
        return law.read_by.discharge(self, law)

    def widest_discharge(self) -> float:
        """Return the angle at which the discharge port is widest [rad]; the end of the life without a port."""
        return self.life if self.settings.discharge_port is None else self.discharge_law().widest

    def opening_angle(self, ratio: float) -> float | None:
        """Return the angle [rad] at which a compressor's chamber has its largest volume over a ratio; None: never."""
        own = self.profile.injection if self.profile is not None else self.settings.volume.injection_angle or TURN
        return moved_port.opening_angle(self.settings.volume.read_by.volume(self), own, self.life, ratio)


def wall_speeds(machine: TwinScrew) -> dict[str, float]:
    """Return the mean wall speed across a gap's line over that of the male tips, by the kind of gap (M256).

    Without a profile the female rotor is taken as large as the male, and wrap and axis distance as those of a usual
    pair.
    """
    profile, male, ratio = machine.profile, 0.5 * machine.rotor_diameter, machine.male_lobes / machine.female_lobes
    female = 0.5 * profile.female_diameter if profile is not None else male
    wrap = profile.wrap_angle if profile is not None else WRAP
    centres = profile.centre_distance if profile is not None else CENTRES * machine.rotor_diameter
    lead = machine.rotor_length / wrap  # [m/rad] of the male rotor
    tips = male, ratio * female  # speeds over that of the male rotor [m]
    lines = sum(hypot(speed, lead) for speed in tips)
    faces = 0.5 * (male + centres - female), 0.5 * ratio * (female + centres - male)  # at the middle of the lobes
    return {TIP_GAP: lead * sum(tips) / (lines * male), END_GAP: 0.5 * sum(faces) / male}
