"""A flexible connecting rod: a beam clamped in the piston, with a rigid head on the crank pin.

z runs from the clamp in the piston [m] to the end of the beam at l; V is its deflection [m] across the cylinder's axis.
The axial load enters as q = −P/(E I) [1/m²], positive in compression: one family of functions, analytic in q, covers
compression, no load and tension, so that nothing jumps at P = 0. The rod's inertia is neglected, and deflections are
small (V below 0.15 l: the source measured an error of the stress below 5 %).
Source: T. A. Obolenskaya, A. S. Klochko, "The application of the crank-slider mechanism for small machines", 2014 (in
Russian), with its misprints corrected (docs/reference/slider-crank.md), of which one is a power in its force formula.
For fatigue and friction it refers to another book: here both are taken from textbooks.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import root_scalar

from screwsim.inputs.declare import number, quantity
from screwsim.inputs.faults import Fault

Array = np.ndarray
_SMALL = 0.05  # |x| below which the functions are summed as a series; eight terms leave an error below 1e-17
_TERMS = 8


def family(x: Array | float) -> tuple[Array, Array, Array, Array]:
    """Return c0, c1, c2, c3 of x = q z²: Σ (−x)^j/(2j + n)!, that is, cos, sin and their remainders (S11)."""
    x = np.asarray(x, dtype=float)
    near = np.abs(x) < _SMALL
    away = np.where(near, 1.0, x)
    root = np.sqrt(np.abs(away))
    press = away > 0.0
    c0 = np.where(press, np.cos(root), np.cosh(root))
    c1 = np.where(press, np.sin(root), np.sinh(root)) / root
    far = (c0, c1, (1.0 - c0) / away, (1.0 - c1) / away)
    series = (sum((-x) ** j / math.factorial(2 * j + n) for j in range(_TERMS)) for n in range(4))
    c = tuple(np.where(near, close, other) for close, other in zip(series, far, strict=True))
    return c[0], c[1], c[2], c[3]


class Fundamental(NamedTuple):
    """V3, V4 of the normal system and their first, second, third derivatives at a place z (V1 = 1, V2 = z)."""

    V3: tuple[Array, Array, Array, Array]
    V4: tuple[Array, Array, Array, Array]


def fundamental(q: Array | float, z: Array | float) -> Fundamental:
    """Return the fundamental functions [m², m³, …] of V'''' + q V'' = 0 (S11)."""
    q, z = np.asarray(q, dtype=float), np.asarray(z, dtype=float)
    c0, c1, c2, c3 = family(q * z * z)
    return Fundamental((z * z * c2, z * c1, c0, -q * z * c1), (z**3 * c3, z * z * c2, z * c1, c0))


@dataclass(frozen=True)
class FlexibleRod:
    """Sizes of a flexible rod of rectangular section and of its crank."""

    width: float = quantity("length", "b: along the crank's axis", gt=0.0)
    thickness: float = quantity("length", "h: in the plane of bending", gt=0.0)
    flexible: float = quantity("length", "l: from the piston to the head", gt=0.0)
    length: float = quantity("length", "L: from the piston to the crank pin", gt=0.0)
    crank_radius: float = quantity("length", "r", gt=0.0)
    modulus: float = quantity("pressure", "E of its material", gt=0.0)

    @property
    def section(self) -> float:
        """Area of the section F [m²]."""
        return self.width * self.thickness

    @property
    def inertia(self) -> float:
        """Second moment of the section I [m⁴]."""
        return self.width * self.thickness**3 / 12.0

    @property
    def stiffness(self) -> float:
        """E I [N m²]."""
        return self.modulus * self.inertia

    @property
    def head(self) -> float:
        """Length f of the rigid head [m]."""
        return self.length - self.flexible

    @property
    def beta(self) -> float:
        """Flexible share β = l/L."""
        return self.flexible / self.length

    def gamma(self, load: float) -> float:
        """Return γ = L √(|P|/(E I)) (S15)."""
        return self.length * math.sqrt(abs(load) / self.stiffness)


def check_rod(rod: FlexibleRod, compression: float = 0.0) -> list[Fault]:
    """Return the faults of a rod: sizes that do not fit, large deflections, a compressive load [N] that buckles it."""
    if rod.flexible > rod.length:
        return [Fault("rod.flexible", "is longer than the whole rod (choose at most rod.length)")]
    bearable = buckling_load(rod)
    large = "is above 0.15 of the rod: the deflection is not small (choose a longer rod)"
    buckles = f"lets the rod buckle at {bearable:.6g} N, below the load of {compression:.6g} N"
    faults = [Fault("rod.crank_radius", large)] if rod.crank_radius > 0.15 * rod.length else []
    if compression >= bearable:
        faults.append(Fault("rod.thickness", f"{buckles} (choose a thicker or a shorter rod)"))
    return faults


def determinant(beta: float, gamma: float) -> float:
    """Return the determinant of the end conditions in compression, up to a positive factor (S14)."""
    x = beta * gamma
    return math.sin(x) * (1.0 + gamma * gamma * (1.0 - beta)) - x * math.cos(x)


def critical_gamma(beta: float) -> float:
    """Return γ at which the rod buckles (S14): its smallest positive root; 4.4934 at β = 1."""
    if not 0.0 < beta <= 1.0:
        raise ValueError("beta must lie in (0, 1]")
    return root_scalar(lambda x: determinant(beta, x / beta), bracket=(math.pi, 4.5), xtol=1e-14).root / beta


def buckling_load(rod: FlexibleRod) -> float:
    """Return the compressive load [N] at which the rod buckles (S15)."""
    return rod.stiffness * (critical_gamma(rod.beta) / rod.length) ** 2


def largest_moment_place(rod: FlexibleRod, load: float) -> float:
    """Return z_M [m] where the bending moment is largest at a load P [N] (S16).

    The printed formula is negative at small compression: there, as in tension, it is the clamp.
    """
    if load >= 0.0:
        return 0.0
    gamma = rod.gamma(load)
    place = 1.0 - math.atan2(1.0, gamma * (1.0 - rod.beta)) / (rod.beta * gamma)
    return rod.flexible * max(place, 0.0)


class Bending(NamedTuple):
    """The beam at places z (last axis) and crank angles (first axis), SI; moment and shear as in the source (S17)."""

    alpha: Array
    load: Array
    z: Array
    deflection: Array
    slope: Array
    moment: Array
    shear: Array
    stress: Array  # the same with both faces as a further first axis: +h/2, −h/2
    side_force: Array  # H on the piston across the axis [N], by angle
    clamp_moment: Array  # E I V''(0) on the piston [N m], by angle


def bend(rod: FlexibleRod, alpha: Array, load: Array, points: int = 47) -> Bending:
    """Return deflection, moment, shear and stress of the beam at crank angles [rad] under axial loads P [N] (S12, S13).

    P is positive in tension. Compression must lie below `buckling_load`, which `check_rod` verifies.
    """
    f, EI = rod.head, rod.stiffness
    load = np.broadcast_to(np.asarray(load, dtype=float), np.shape(alpha))
    q = -load / EI
    end = fundamental(q, rod.flexible)
    a3, a4 = end.V3[0] + f * end.V3[1], end.V4[0] + f * end.V4[1]
    m3, m4 = end.V3[2] + f * end.V3[3], end.V4[2] + f * end.V4[3]
    scale = rod.crank_radius * np.sin(alpha) / (a3 * m4 - a4 * m3)
    C, D = scale * m4, -scale * m3
    z = np.linspace(0.0, rod.flexible, points)
    at = fundamental(q[:, None], z[None, :])
    V, dV, ddV, dddV = (C[:, None] * v3 + D[:, None] * v4 for v3, v4 in zip(at.V3, at.V4, strict=True))
    moment = -EI * ddV
    face = 0.5 * rod.thickness * np.array([1.0, -1.0])
    stress = moment[None] / rod.inertia * face[:, None, None] + (load / rod.section)[None, :, None]
    return Bending(np.asarray(alpha), load, z, V, dV, moment, -EI * dddV, stress, -EI * D, EI * C)


@dataclass(frozen=True)
class SchmidtLoad:
    """Pressure of an isothermal Stirling cycle on a piston, with the mean pressure behind it."""

    bore: float = quantity("length", "d: diameter of the piston", gt=0.0)
    p_min: float = quantity("pressure", "lowest pressure of the cycle", gt=0.0)
    delta: float = number("δ: relative swing of the pressure", gt=0.0, lt=1.0)
    theta: float = quantity("angle", "θ: phase of the pressure")

    def pressure(self, alpha: Array) -> Array:
        """Return the pressure [Pa] (S18)."""
        return self.p_min * (1.0 + self.delta) / (1.0 + self.delta * np.cos(np.asarray(alpha) + self.theta))

    @property
    def mean_pressure(self) -> float:
        """Mean of the pressure over a turn [Pa]: p_min √((1 + δ)/(1 − δ))."""
        return self.p_min * math.sqrt((1.0 + self.delta) / (1.0 - self.delta))

    def load(self, alpha: Array) -> Array:
        """Return the axial load P of the rod [N], positive in tension (S18)."""
        return pressure_load(self.pressure(alpha), self.mean_pressure, self.bore)

    def printed_force(self, alpha: Array) -> Array:
        """Return the force as the source prints it, with π d/4 for the area: in N/m, not N."""
        ratio = (1.0 + self.delta) / (1.0 + self.delta * np.cos(np.asarray(alpha) + self.theta))
        mean = math.sqrt((1.0 + self.delta) / (1.0 - self.delta))
        return self.p_min * math.pi * self.bore / 4.0 * (ratio - mean)


def pressure_load(pressure: Array, behind: float, bore: float) -> Array:
    """Return the rod's load P [N] from the pressures [Pa] in cylinder and behind the piston; negative if pressed."""
    return -0.25 * math.pi * bore**2 * (np.asarray(pressure) - behind)


@dataclass(frozen=True)
class Fatigue:
    """Fatigue of the rod's material; the source states none of it, the defaults are assumptions.

    A fatigue limit of half the tensile strength, at most 700 MPa, is that of steels (Budynas, Nisbett: Shigley's
    Mechanical Engineering Design, ch. 6); the factor covers notches, surface and size at the clamp.
    """

    limit: float = quantity("pressure", "fatigue limit in alternating bending, polished", 600e6, gt=0.0)
    concentration: float = number("notch, surface and size together, over the stress amplitude", 1.5, ge=1.0)
    sensitivity: float = number("ψ: weight of a mean tension", 0.2, ge=0.0)


class Safety(NamedTuple):
    """The least fatigue safety factor, where it is, and the stress there: amplitude and mean [Pa]."""

    factor: float
    z: float
    face: int  # 1: +h/2, −1: −h/2
    amplitude: float
    mean: float
    highest: float  # extremes of the stress over rod and turn
    lowest: float


def safety(bending: Bending, material: Fatigue) -> Safety:
    """Return the least n_σ over the rod (S19); a mean compression is not counted in its favour."""
    top, low = bending.stress.max(axis=1), bending.stress.min(axis=1)
    amplitude, mean = 0.5 * (top - low), 0.5 * (top + low)
    worst = material.concentration * amplitude + material.sensitivity * np.maximum(mean, 0.0)
    face, i = np.unravel_index(int(np.argmax(worst)), worst.shape)
    return Safety(
        factor=float(material.limit / worst[face, i]),
        z=float(bending.z[i]),
        face=1 - 2 * int(face),
        amplitude=float(amplitude[face, i]),
        mean=float(mean[face, i]),
        highest=float(top.max()),
        lowest=float(low.min()),
    )


def contact_force(side_force: Array, moment: Array, guide: float) -> Array:
    """Return ∫|contact| [N] between piston and cylinder over a guide [m] that carries a force and a moment (S20).

    The contact force varies linearly along the guide; where the moment is large both ends press, on opposite sides.
    """
    H, M = np.abs(side_force), np.abs(moment)
    turned = 6.0 * M > H * guide
    safe = np.where(turned, M, 1.0)
    return np.where(turned, 3.0 * M / guide + H**2 * guide / (12.0 * safe), H)


def friction_power(bending: Bending, guide: float, crank_radius: float, omega: float, friction: float) -> float:
    """Return the mean friction power of the piston [W] over evenly spaced angles of one turn, without its end (S20).

    Piston speed: r ω sin α, as of a long rod. The centre of the guide is at the clamp.
    """
    speed = np.abs(crank_radius * omega * np.sin(bending.alpha))
    return float(friction * np.mean(speed * contact_force(bending.side_force, bending.clamp_moment, guide)))
