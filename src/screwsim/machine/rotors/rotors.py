"""A pair of rotors with length and wrap: its volume, coefficients and angles.

φ as in `leakage`: zero when the tip of the chamber's trailing lobe lies on the centre line at the inlet plane; the
volume ends at φ = τ. A chamber's own angle counts from the beginning of its life. Units SI.
"""

import hashlib
import math
import os
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from screwsim.inputs.faults import Fault, UsageError
from screwsim.machine.rotors import closed_form, fairing, imported
from screwsim.machine.rotors.checks import check_blow_holes, check_pair, check_profile, check_size, check_swept
from screwsim.machine.rotors.leakage import BlowHoleOpening, blow_hole_opening, mirrored
from screwsim.machine.rotors.pair import Array, Chain, Pair
from screwsim.machine.rotors.sections import TURN, Sections, sections, sweep
from screwsim.machine.rotors.settings import CIRCULAR, POINTS, RACK, Profile, check_settings
from screwsim.numerics.roots import bisected

SAME = 1e-9  # relative difference below which a chamber's volume does not change: rounding
MOST_CACHED = 64  # rotors that a process caches, with their curves; a study of profiles makes ever new ones


@dataclass(frozen=True, eq=False)
class Rotors:
    """Profile (as contact points), length [m] and male wrap τ [rad] of a pair of rotors."""

    pair: Pair
    chain: Chain
    length: float
    wrap: float

    @property
    def h(self) -> float:
        """Length over wrap, L/τ [m/rad]."""
        return self.length / self.wrap

    @cached_property
    def sections(self) -> Sections:
        """Section area of a chamber over ψ."""
        return sections(self.pair, self.chain, self.blow_hole)

    @cached_property
    def blow_hole(self) -> BlowHoleOpening:
        """The blow-hole at the high-pressure cusp."""
        return blow_hole_opening(self.pair, self.chain)

    @cached_property
    def suction_blow_hole(self) -> BlowHoleOpening:
        """The blow-hole at the suction cusp; its angles are those of the mirror image, −ψ − 2π."""
        return blow_hole_opening(self.pair, mirrored(self.chain))

    @cached_property
    def start(self) -> float:
        """φ at which a chamber's life begins [rad]."""
        return float(self.sections.psi[0])

    @property
    def life(self) -> float:
        """Angle from the first to the last volume of a chamber [rad]: 2π + p − ψS + τ."""
        return self.wrap - self.start

    def volume(self, phi: Array) -> Array:
        """Return V(φ) = (L/τ) ∫ a dψ over [φ − τ, φ] [m³]."""
        return self.h * (self.sections.integral_at(phi) - self.sections.integral_at(phi - self.wrap))

    def volume_slope(self, phi: Array) -> Array:
        """Return dV/dφ [m³/rad], the exact derivative of `volume`."""
        return self.h * (self.sections.area_at(phi) - self.sections.area_at(phi - self.wrap))

    def male_slope(self, phi: Array) -> Array:
        """Return ∂V/∂φ of the male rotor alone [m³/rad]; times pressure it is the gas torque on it.

        The rest of `volume_slope` is the female rotor's; divided by k it refers to the female shaft.
        """
        psi, area = self.sections.psi, self.sections.a_male
        now, behind = (np.interp(x, psi, area, left=0.0, right=0.0) for x in (phi, phi - self.wrap))
        return self.h * (now - behind)

    @cached_property
    def largest(self) -> tuple[float, float]:
        """φ of the largest volume [rad], and that volume [m³]; the last φ where it stays for a while (a short wrap)."""
        grid = np.linspace(self.start, self.wrap, 721)
        volume = self.volume(grid)
        full = np.flatnonzero(volume >= (1.0 - SAME) * volume.max())
        i, least = int(full[-1]), 0.0 if len(full) == 1 else -SAME * self.h * self.sections.grooves
        low, high = float(grid[max(i - 1, 0)]), float(grid[min(i + 1, 720)])
        low, high = bisected(lambda phi: float(self.volume_slope(np.array(phi))) > least, low, high)
        angle = 0.5 * (low + high)
        return angle, float(self.volume(np.array(angle)))

    def discharge_angle(self, volume_ratio: float, name: str = "built_in_volume_ratio") -> float:
        """Return φ_dis [rad] at which the volume is the largest one over the built-in ratio.

        Raise UsageError in one line where that is less than 10° before the end of discharge.
        """
        grid = np.linspace(self.largest[0], self.wrap, 2001)
        volume = self.volume(grid)
        wanted = float(self.largest[1] / volume_ratio)
        i = int(np.searchsorted(-volume, -wanted))
        low, high = float(grid[max(i - 1, 0)]), float(grid[min(i, len(grid) - 1)])
        low, high = bisected(lambda phi: float(self.volume(np.array(phi))) > wanted, low, high)
        if self.wrap - high < math.radians(10.0):
            raise UsageError(
                f"machine.{name}: {volume_ratio:.4g} leaves the port 10 deg before the end of discharge "
                "(choose a smaller ratio)"
            )
        return 0.5 * (low + high)

    def coefficients(self) -> dict[str, tuple[float, str, str]]:
        """Return {name: (value, unit, meaning)} of the pair."""
        cut, pair = self.sections, self.pair
        angle, largest = self.largest
        D = 2.0 * pair.male_radius
        return {
            "male_groove_area": (cut.male_groove, "m^2", "of one male groove (A01)"),
            "female_groove_area": (cut.female_groove, "m^2", "of one female groove (A02)"),
            "area_coefficient": (cut.grooves * pair.male_lobes / D**2, "1", "Cn = (A01 + A02) z1/D²"),
            "wrap_coefficient": (largest / (self.length * cut.grooves), "1", "Cφ = V_max/(L (A01 + A02))"),
            "largest_volume": (largest, "m^3", "V_max of one chamber"),
            "displacement": (largest * pair.male_lobes, "m^3", "V_max z1 of one male revolution"),
            "angle_of_largest_volume": (angle - self.start, "rad", "of a chamber's life"),
            "life": (self.life, "rad", "of a chamber"),
            "male_share": (cut.male_share, "1", "share of the male rotor in the displacement work"),
            "blow_hole_area": (self.blow_hole.area(self.h), "m^2", "at the high-pressure cusp"),
            "suction_blow_hole_area": (self.suction_blow_hole.area(self.h), "m^2", "at the suction cusp"),
        }


def _of_points(pair: Pair, profile: Profile) -> Chain:
    """Return the contact points of a profile given by a file, faired within the stated tolerance."""
    x, y = imported.in_order(*imported.read_profile(str(profile.file)), profile.curve)
    make = imported.from_male if profile.curve == "male" else imported.from_rack
    if not profile.tolerance > 0.0:
        return make(pair, x, y, profile.smoothing)
    curve = fairing.faired_curve(x, y, profile.tolerance, pair.r1)
    return replace(make(pair, curve.x, curve.y, profile.smoothing), faired=curve.words(len(x)))


def _circular(pair: Pair, profile: Profile) -> Chain:
    return closed_form.circular(pair, profile.female_tip_radius or 0.0)


def _rack(pair: Pair, profile: Profile) -> Chain:
    r3, r4 = profile.male_tip_radius or 0.0, profile.female_tip_radius or 0.0
    rho, alpha, r5 = profile.flank_radius or 0.0, profile.pressure_angle or 0.0, profile.root_radius or 0.0
    return closed_form.rack(pair, r3, r4, rho, alpha, r5)


CHAINS = {POINTS: _of_points, CIRCULAR: _circular, RACK: _rack}


def make_rotors(
    profile: Profile, male_lobes: int, female_lobes: int, male_diameter: float, length: float, check: bool = True
) -> Rotors:
    """Return the rotors of a profile; raise UsageError with one line per fault."""
    pair = Pair(male_lobes, female_lobes, profile.centre_distance, 0.5 * male_diameter, 0.5 * profile.female_diameter)
    _refuse(check_settings(profile) + check_pair(pair))
    if profile.wrap_angle > TURN:
        _refuse(
            [Fault("machine.profile.wrap_angle", "is above 360 deg: chambers would overlap themselves (choose less)")]
        )
    chain = _checked_chain(pair, replace(profile, wrap_angle=1.0), check, _digest(profile.file))
    rotors = _rotors(pair, chain, length, profile.wrap_angle)
    if check and profile.measured:
        holes = check_blow_holes(rotors.blow_hole.area(rotors.h), rotors.suction_blow_hole.area(rotors.h))
        swept = sum(float(step.sum()) for step in sweep(pair, chain))
        _refuse(holes + check_swept(swept, rotors.sections.grooves))
    return rotors


@lru_cache(maxsize=MOST_CACHED)
def _rotors(pair: Pair, chain: Chain, length: float, wrap: float) -> Rotors:
    """Return the rotors, cached by chain, so that their computed properties are kept."""
    return Rotors(pair, chain, length, wrap)


@lru_cache(maxsize=MOST_CACHED)
def _checked_chain(pair: Pair, profile: Profile, check: bool, digest: str) -> Chain:
    """Return the contact points of a profile, which do not depend on length and wrap. `digest` is that of its file."""
    chain = CHAINS[profile.kind](pair, profile)
    if check:
        _refuse(check_size(pair, chain) if profile.measured else [])
        _refuse(check_profile(pair, chain, profile.measured, profile.tolerance if profile.measured else None))
    return chain


def _digest(file: str | None) -> str:
    """Return the digest of a file's content, since its date may stay the same when it changes."""
    return hashlib.sha256(Path(file).read_bytes()).hexdigest() if file is not None and os.path.isfile(file) else ""


def _refuse(faults: list[Fault]) -> None:
    if faults:
        raise UsageError("\n".join(map(str, faults)))
