"""A blower that can be wrong in one way at a time, as a module of a user's may be."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from own_machines.roots_blower import MACHINE as BLOWER
from own_machines.roots_blower import Pockets, RootsBlower, pocket_volume, pocket_volume_slope, port_area
from screwsim.inputs.declare import word
from screwsim.machine.profile_law import Interface
from screwsim.machine.protocol import TIP_GAP, AreaLaw, VolumeKernels
from screwsim.numerics.kernel import kernel


@dataclass(frozen=True)
class Settings(RootsBlower):
    """The blower, and what is wrong of it."""

    flaw: str = word("what is wrong", "nothing")

    def surface_speed(self, omega: float) -> float:
        return math.nan if self.flaw == "speed" else super().surface_speed(omega)


@kernel
def steep(phi, pocket, closes, life):
    """Return a slope that is 1 % too steep."""
    return 1.01 * pocket_volume_slope(phi, pocket, closes, life)


@kernel
def thin(phi, dead, pocket, closes, life):
    """Return a volume that is less than nothing at both ends."""
    return pocket_volume(phi, dead, pocket, closes, life) - 2.0 * dead


NARROW_FROM, NARROW_TO = (
    math.radians(100.1),
    math.radians(100.4),
)  # between two of the angles that are looked at when a scene is loaded


@kernel
def pierced(phi, size, opens, shuts, width):
    """Return a port's area that is less than nothing between two angles."""
    if NARROW_FROM < phi < NARROW_TO:
        return -size
    return port_area(phi, size, opens, shuts, width)


class Wrong(Pockets):
    """Pockets with a flaw."""

    def interfaces(self, gap: str) -> tuple[Interface, ...]:
        gaps, flaw = super().interfaces(gap), self.settings.flaw
        if gap != TIP_GAP or flaw not in ("behind", "beyond", "short", "disorder"):
            return gaps
        table = gaps[0].table
        if flaw == "short":
            return (replace(gaps[0], table=replace(table, value=-table.value)),)
        if flaw == "disorder":
            return (replace(gaps[0], table=replace(table, angle=table.angle[[1, 0, 2, 3, 4]])),)
        return (replace(gaps[0], offset={"behind": 0, "beyond": 7}[flaw]),)

    @property
    def life(self) -> float:
        return super().life * (1.1 if self.settings.flaw == "life" else 1.0)

    @property
    def injection_angle(self) -> float:
        return super().injection_angle * (1.1 if self.settings.flaw == "injection" else 1.0)

    @property
    def swept_volume(self) -> float:
        return super().swept_volume * (2.0 if self.settings.flaw == "swept" else 1.0)

    def volume_law(self) -> VolumeKernels:
        law, flaw = super().volume_law(), self.settings.flaw
        if flaw == "raises":
            raise ZeroDivisionError("no\nlaw")
        changes = {"slope": {"slope": steep}, "thin": {"volume": thin}}
        return replace(law, **changes.get(flaw, {}))

    def suction_law(self) -> AreaLaw:
        law = super().suction_law()
        if self.settings.flaw == "pierced":
            return replace(law, area=pierced, breakpoints=(*law.breakpoints, NARROW_FROM, NARROW_TO))
        return replace(law, values={**law.values, "size": -1e-3}) if self.settings.flaw == "port" else law


MACHINE = replace(BLOWER, settings=Settings, geometry=Wrong)
