"""Slider-crank machines: their settings (typed, SI units), checks, and the cylinder as a chamber of one turn's life."""

import math
from dataclasses import dataclass
from operator import attrgetter

from screwsim.inputs.declare import choice, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import (
    BORE,
    CYLINDER,
    PISTON,
    MachineGeometry,
    MachineKind,
    MachineSettings,
    Measure,
    Size,
    Speed,
    VolumeKernels,
)
from screwsim.machine.slider_crank import kinematics


@dataclass(frozen=True)
class SliderCrank(MachineSettings):
    """One cylinder: a piston on an offset slider-crank; its chamber lives one turn of the crank."""

    symbol_names = ("bore", "stroke", "piston_area", "crank_radius", "rod_length", "clearance")
    kind: str = choice("kind of machine", ("slider_crank",), "slider_crank")  # pyrefly: ignore[bad-override] - frozen
    mode: str = choice("a cylinder is a compressor", ("compressor",), "compressor")  # pyrefly: ignore[bad-override]
    bore: float = quantity("length", "bore of the cylinder", gt=0.0, hardly=(0.005, 1.5))
    crank_radius: float = quantity("length", "radius r of the crank", gt=0.0)
    rod_length: float = quantity("length", "length l of the connecting rod, between its pins", gt=0.0)
    offset: float = quantity("length", "offset e of the cylinder's axis from the crankshaft's", 0.0)
    clearance: float = quantity("volume", "volume left at top dead centre", gt=0.0)

    @property
    def piston_area(self) -> float:
        """Area of the piston [m²]."""
        return 0.25 * math.pi * self.bore**2

    @property
    def top(self) -> float:
        """Crank angle of the top dead centre [rad] (S4)."""
        return kinematics.top_angle(self.crank_radius, self.rod_length, self.offset)

    @property
    def bottom(self) -> float:
        """Crank angle of the bottom dead centre [rad] (S4)."""
        return kinematics.bottom_angle(self.crank_radius, self.rod_length, self.offset)

    @property
    def stroke(self) -> float:
        """Distance of the piston between its dead centres [m] (S4)."""
        return kinematics.stroke(self.crank_radius, self.rod_length, self.offset)

    @property
    def swept_volume(self) -> float:
        """Volume that the piston sweeps [m³]."""
        return self.piston_area * self.stroke

    @property
    def clearance_ratio(self) -> float:
        """Clearance over swept volume, c."""
        return self.clearance / self.swept_volume

    def surface_speed(self, omega: float) -> float:
        """Return the mean piston speed [m/s] at a crank speed [rad/s]: two strokes a turn."""
        return self.stroke * omega / math.pi

    def numbers(self) -> dict[str, float]:
        """Return the arguments of `kinematics.volume` and `kinematics.volume_slope` beside the angle."""
        lengths = {"crank": self.crank_radius, "rod": self.rod_length, "offset": self.offset}
        return {"V_c": self.clearance, "A_piston": self.piston_area, **lengths}


def check_slider_crank(machine: SliderCrank) -> list[Fault]:
    """Return the faults of a cylinder: a rod too short for the crank to turn, too large an offset."""
    r, rod, e = machine.crank_radius, machine.rod_length, abs(machine.offset)
    if rod > r + e:
        return []
    if rod <= r:
        what = f"{1e3 * rod:.6g} mm is not longer than the crank's radius of {1e3 * r:.6g} mm: the crank cannot turn"
        return [Fault("machine.rod_length", f"{what} (choose a longer rod; 3 to 6 radii are usual)")]
    what = f"{1e3 * e:.6g} mm and the crank's radius of {1e3 * r:.6g} mm together are not below the rod length of "
    remedy = f"choose an offset below {1e3 * (rod - r):.6g} mm, or a longer rod"
    return [Fault("machine.offset", f"{what}{1e3 * rod:.6g} mm: the crank cannot turn ({remedy})")]


TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Cylinder(MachineGeometry):
    """One chamber without neighbours, from top dead centre to top dead centre (S5)."""

    settings: SliderCrank  # pyrefly: ignore[bad-override] - frozen

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
        """Return the volume law (S5): dV/dφ changes sign at the bottom dead centre, the law is smooth everywhere."""
        laws = kinematics.volume, kinematics.volume_slope
        return VolumeKernels(*laws, self.settings.numbers(), (self.injection_angle,))


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
    stated=check_slider_crank,  # without a stroke no size can be compared
    sizes=_SIZES,
    scales={BORE: Measure(_bore, _BORE), PISTON: Measure(_piston, "of the piston's area")},
    speed=Speed("moves the piston at a mean speed of", 300.0, 25.0, "those of racing engines move at 25 m/s"),
    called=("piston", "reciprocating"),
    chamber="a cylinder",
    dead_volume=lambda machine: ("machine.clearance", machine.clearance),
)
