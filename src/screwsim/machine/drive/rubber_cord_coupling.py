"""The rubber-cord coupling: cords as spokes between two half-couplings, which pull and do not push.

In each of k layers cords run from the inner radius r_A to the outer r_B; those of direction + lean by β against the
radius at r_A, those of direction − by −β. The rubber carries no load; a cord deforms only by the motion of its ends. A
twist Θ > 0 turns the outer half towards + and stretches the cords +.
Source: V. A. Ilyichev, V. S. Korneev, S. A. Korneev, "Discrete mathematical model of a rubber-cord flat coupling", Omsk
Scientific Bulletin, 2015 (in Russian). Angles in rad, lengths in m, forces in N. Equations: docs/reference/coupling.md.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from screwsim.inputs.declare import count, number, quantity
from screwsim.inputs.faults import Fault, UsageError
from screwsim.numerics.kernel import kernel

LARGEST_TWIST = math.radians(45.0)  # bound for a coupling without a breaking strain: far outside the model's range


@kernel
def central_angle(lean, r_A, r_B):
    """Return the central angle Φ between the ends of an unloaded cord [rad] (K1); `lean` carries its sign."""
    return lean - math.asin(r_A / r_B * math.sin(lean))


@kernel
def cord_length(phi, r_A, r_B):
    """Return the length of a cord [m] whose ends are the central angle Φ apart (K2)."""
    half = math.sin(0.5 * phi)  # the form without cancellation
    return math.sqrt((r_B - r_A) * (r_B - r_A) + 4.0 * r_A * r_B * half * half)


@kernel
def strain(phi, phi_0, r_A, r_B):
    """Return the strain of a cord (K3)."""
    return cord_length(phi, r_A, r_B) / cord_length(phi_0, r_A, r_B) - 1.0


@kernel
def pull(eps, E, b):
    """Return the tension of a cord [N]: zero where it is slack (K4)."""
    return E * eps * (1.0 + b * eps) if eps > 0.0 else 0.0


@kernel
def lever(phi, r_A, r_B):
    """Return dl/dΘ of a cord [m/rad], r_A sin α_A (K5)."""
    return r_A * r_B * math.sin(phi) / cord_length(phi, r_A, r_B)


@kernel
def family_torque(theta, cords, r_A, r_B, lean, E, b):
    """Return the torque of all cords of one direction [N m] (K6)."""
    phi_0 = central_angle(lean, r_A, r_B)
    phi = phi_0 + theta
    return cords * pull(strain(phi, phi_0, r_A, r_B), E, b) * lever(phi, r_A, r_B)


@kernel
def family_stiffness(theta, cords, r_A, r_B, lean, E, b):
    """Return the derivative of `family_torque` [N m/rad] (K7); at Θ = 0 that of the stretched side."""
    phi_0 = central_angle(lean, r_A, r_B)
    phi = phi_0 + theta
    eps = strain(phi, phi_0, r_A, r_B)
    if eps < 0.0:
        return 0.0
    arm, length = lever(phi, r_A, r_B), cord_length(phi, r_A, r_B)
    turning = r_A * r_B * math.cos(phi) / length - arm * arm / length
    tangent = E * (1.0 + 2.0 * b * eps) * arm * arm / cord_length(phi_0, r_A, r_B)
    return cords * (tangent + pull(eps, E, b) * turning)


@kernel
def family_energy(theta, cords, r_A, r_B, lean, E, b):
    """Return the energy stored in all cords of one direction [J] (K8)."""
    phi_0 = central_angle(lean, r_A, r_B)
    eps = max(strain(phi_0 + theta, phi_0, r_A, r_B), 0.0)
    return cords * cord_length(phi_0, r_A, r_B) * E * eps * eps * (0.5 + b * eps / 3.0)


@kernel
def torque(theta, cords, r_A, r_B, lean_plus, lean_minus, E, b):
    """Return the coupling's torque [N m] at a twist (K6); `cords`: one direction's in all discs and layers."""
    plus = family_torque(theta, cords, r_A, r_B, lean_plus, E, b)
    return plus + family_torque(theta, cords, r_A, r_B, -lean_minus, E, b)


@kernel
def stiffness(theta, cords, r_A, r_B, lean_plus, lean_minus, E, b):
    """Return the tangent stiffness dM/dΘ of the coupling [N m/rad] (K7); at Θ = 0 from the side Θ > 0."""
    plus = family_stiffness(theta, cords, r_A, r_B, lean_plus, E, b)
    return plus if theta == 0.0 else plus + family_stiffness(theta, cords, r_A, r_B, -lean_minus, E, b)


@kernel
def energy(theta, cords, r_A, r_B, lean_plus, lean_minus, E, b):
    """Return the energy stored in the coupling [J] (K8)."""
    plus = family_energy(theta, cords, r_A, r_B, lean_plus, E, b)
    return plus + family_energy(theta, cords, r_A, r_B, -lean_minus, E, b)


@dataclass(frozen=True)
class RubberCordCoupling:
    """A coupling of rubber-cord discs; the defaults are those of the source (polyamide cord 23KNTS, model N-327)."""

    inner_radius: float = quantity("length", "r_A: radius at which the cords leave the inner half", 0.200, gt=0.0)
    outer_radius: float = quantity("length", "r_B: radius at which the cords reach the outer half", 0.280, gt=0.0)
    layers: int = count("k: number of cord layers of one direction in a disc", 5, ge=1)
    cords: int = count("N: number of cords in a layer", 944, ge=1)
    discs: int = count("number of discs side by side", 2, ge=1)
    lean_plus: float = quantity("angle", "β: lean of the cords stretched by Θ > 0", math.radians(30.8), gt=0.0)
    lean_minus: float = quantity("angle", "β: lean of the cords stretched by Θ < 0", math.radians(30.8), gt=0.0)
    cord_stiffness: float = number("E in P = E ε (1 + b ε) [N]", 303.6, gt=0.0)
    cord_stiffening: float = number("b in P = E ε (1 + b ε)", 6.684, ge=0.0)
    breaking_strain: float | None = number("ε_B: strain at which a cord breaks", None, gt=0.0)

    def numbers(self) -> tuple[float, ...]:
        """Return the arguments of `torque`, `stiffness` and `energy` after the twist."""
        cords = float(self.discs * self.layers * self.cords)
        law = (self.cord_stiffness, self.cord_stiffening)
        return (cords, self.inner_radius, self.outer_radius, self.lean_plus, self.lean_minus, *law)

    @property
    def pitch(self) -> float:
        """Angle Δφ between neighbouring cords of a layer [rad] (K9)."""
        return 2.0 * math.pi / self.cords

    def torque(self, theta: float) -> float:
        """Return the torque at a twist [N m] (K6)."""
        return torque(theta, *self.numbers())

    def stiffness(self, theta: float) -> float:
        """Return the tangent stiffness at a twist [N m/rad] (K7)."""
        return stiffness(theta, *self.numbers())

    def energy(self, theta: float) -> float:
        """Return the stored energy at a twist [J] (K8)."""
        return energy(theta, *self.numbers())

    def largest_strain(self, theta: float) -> float:
        """Return the strain of the stretched cords at a twist [rad] (K3)."""
        r_A, r_B = self.inner_radius, self.outer_radius
        starts = (central_angle(lean, r_A, r_B) for lean in (self.lean_plus, -self.lean_minus))
        return max(strain(start + theta, start, r_A, r_B) for start in starts)

    def twist_at_strain(self, eps: float, direction: int) -> float:
        """Return the twist [rad] at which the cords of a direction (1 or −1) reach a strain (K10)."""
        r_A, r_B = self.inner_radius, self.outer_radius
        start = central_angle(self.lean_plus if direction > 0 else self.lean_minus, r_A, r_B)
        longest = (1.0 + eps) * cord_length(start, r_A, r_B)
        cosine = (r_A * r_A + r_B * r_B - longest * longest) / (2.0 * r_A * r_B)
        return direction * (math.acos(max(cosine, -1.0)) - start)

    def twist(self, moment: float) -> float:
        """Return the twist [rad] at a torque [N m]; raise UsageError where the cords break before."""
        from scipy.optimize import root_scalar

        direction = 1 if moment >= 0.0 else -1
        far = self.strength_twist(direction)
        if abs(self.torque(far)) < abs(moment):
            limit = abs(self.torque(far))
            raise UsageError(
                f"the coupling carries at most {limit:.6g} N m, not {abs(moment):.6g} N m (choose more discs)"
            )
        return root_scalar(lambda theta: self.torque(theta) - moment, bracket=(0.0, far), xtol=1e-14).root

    def strength_twist(self, direction: int = 1) -> float:
        """Return the twist at which cords break [rad]; `LARGEST_TWIST` without a breaking strain (K10)."""
        if self.breaking_strain is None:
            return direction * LARGEST_TWIST
        return self.twist_at_strain(self.breaking_strain, direction)

    def state(self, theta: float) -> str:
        """Return 'sound', or why the coupling cannot bear a twist [rad], with the remedy."""
        eps = self.largest_strain(theta)
        if self.breaking_strain is None or eps <= self.breaking_strain:
            return "sound"
        return (
            f"the cords break: strain {eps:.3g} above {self.breaking_strain:.3g} at {math.degrees(theta):.3g} deg "
            "of twist (choose more discs or a softer start)"
        )


def check_coupling(coupling: RubberCordCoupling) -> list[Fault]:
    """Return the faults of a coupling: radii in the wrong order, cords that lean by 90° or more."""
    wrong = coupling.outer_radius <= coupling.inner_radius
    faults = [Fault("coupling.outer_radius", "is not above inner_radius (choose a larger one)")] if wrong else []
    return faults + [
        Fault(f"coupling.{name}", f"{math.degrees(lean):.6g} deg is not below 90 deg (choose a smaller angle)")
        for name, lean in (("lean_plus", coupling.lean_plus), ("lean_minus", coupling.lean_minus))
        if lean >= 0.5 * math.pi
    ]


class Crossings(NamedTuple):
    """Crossings of a cord with those of the other direction: ψ_max [rad], ψ_max over the pitch, least and most."""

    reach: float
    ratio: float
    least: int
    most: int


def crossings(lean: float, cords: int, r_A: float, r_B: float) -> Crossings:
    """Return the number of crossings of a cord with those of the other direction (K11, K12)."""
    reach = 2.0 * central_angle(lean, r_A, r_B)
    ratio = reach * cords / (2.0 * math.pi)
    return Crossings(reach, ratio, math.floor(ratio), math.floor(ratio) + 1)


def counted_crossings(lean: float, cords: int, r_A: float, r_B: float, shift: float) -> int:
    """Return the crossings of one cord + with the cords −, which start shifted by an angle [rad], by counting (K12).

    Cords that start at the same point of r_A do not count as crossing there: they meet in the clamp.
    """
    reach = crossings(lean, cords, r_A, r_B).reach
    starts = shift + 2.0 * math.pi / cords * np.arange(-1, cords)
    return int(np.sum((starts > 1e-12) & (starts <= reach)))


def crossing_angle(radius: float, lean: float, r_A: float) -> float:
    """Return the angle γ at which cords of both directions cross at a radius [rad] (K13)."""
    return 2.0 * math.asin(r_A / radius * math.sin(lean))


class TorqueBand(NamedTuple):
    """Torques [N m] at a twist for scattered leans of the cords: least, mean over evenly distributed leans, largest."""

    least: float
    mean: float
    largest: float


def torque_band(coupling: RubberCordCoupling, theta: float, low: float, high: float) -> TorqueBand:
    """Return the torques at a twist of couplings whose cords lean by angles between low and high [rad] (K14)."""
    values = [
        replace(coupling, lean_plus=float(lean), lean_minus=float(lean)).torque(theta)
        for lean in np.linspace(low, high, 21)
    ]
    return TorqueBand(min(values), float(np.mean(values)), max(values))
