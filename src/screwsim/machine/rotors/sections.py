"""Areas of the transverse section, and the chamber's volume from them.

A rotating rigid curve sweeps ½ρ² a radian, so only the contact radii matter: dA = ½[(R1² − ρ1²) + k(R2² − ρ2²)] dψ
along the chain; over one pitch it sums to A01 + A02 exactly. Between the points of the chain the section area a(ψ) is
linear and its integral quadratic, so V and dV/dφ belong to each other exactly, whatever length and wrap.
Source: docs/rotors.md. Lengths in m, angles in rad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from screwsim.machine.rotors.blow_hole import crossing
from screwsim.machine.rotors.pair import Array, Chain, Pair

TURN = 2.0 * math.pi


def polygon_area(x: Array, y: Array) -> float:
    """Return the area of a closed polygon [m²], positive whatever its sense."""
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))


def sweep(pair: Pair, chain: Chain) -> tuple[Array, Array]:
    """Return the areas [m²] that the male and the female rotor displace from each contact point to the next."""
    male = pair.male_radius**2 - chain.male_radii() ** 2
    female = pair.female_radius**2 - chain.female_radii(pair) ** 2
    step = 0.25 * np.diff(chain.psi)
    return (male[1:] + male[:-1]) * step, pair.k * (female[1:] + female[:-1]) * step


@dataclass(frozen=True, eq=False)
class Sections:
    """Section area a(ψ) of one chamber on its nodes, and its integral: arrays; ψ [rad], a [m²], integral [m² rad]."""

    psi: Array
    a: Array
    integral: Array
    male_groove: float  # A01 [m²]
    female_groove: float  # A02 [m²]
    male_share: float  # of displacement work, hence of the gas torque
    crossing: float  # Δ: area that crosses the open blow-hole [m²]

    @property
    def grooves(self) -> float:
        """Area of both grooves, A01 + A02 [m²]."""
        return self.male_groove + self.female_groove

    @property
    def delay(self) -> float:
        """Angle φ̄ that meshing takes off the linear range: ∫(1 − a/(A01 + A02)) dψ up to 0 [rad]."""
        middle = 0.5 * (self.psi[0] + self.psi[-1])
        start = float(self.psi[np.searchsorted(self.psi, middle)])
        return -start - float(self.integral[-1] - self.integral_at(np.array([start]))[0]) / self.grooves

    def area_at(self, psi: Array) -> Array:
        """Return a(ψ) [m²]; zero outside the life of a section."""
        return np.interp(psi, self.psi, self.a, left=0.0, right=0.0)

    def integral_at(self, psi: Array) -> Array:
        """Return ∫a dψ [m² rad] from the beginning of a section's life."""
        inside = np.clip(psi, self.psi[0], self.psi[-1])
        i = np.clip(np.searchsorted(self.psi, inside, side="right") - 1, 0, len(self.psi) - 2)
        step = inside - self.psi[i]
        slope = (self.a[i + 1] - self.a[i]) / (self.psi[i + 1] - self.psi[i])
        return self.integral[i] + step * (self.a[i] + 0.5 * step * slope)

    def volume(self, phi: Array, wrap: float, length: float) -> Array:
        """Return V(φ) = (L/τ) ∫ a dψ over [φ − τ, φ] [m³]."""
        return length / wrap * (self.integral_at(phi) - self.integral_at(phi - wrap))

    def volume_slope(self, phi: Array, wrap: float, length: float) -> Array:
        """Return dV/dφ [m³/rad], the exact derivative of `volume`."""
        return length / wrap * (self.area_at(phi) - self.area_at(phi - wrap))


def mesh_functions(pair: Pair, chain: Chain) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return (ψ, cumulated area) along the rising branch S₋₁→S'₀ and along the falling one, S₀→S'₀ with its sign."""
    male, female = sweep(pair, chain)
    area = np.concatenate([[0.0], np.cumsum(male + female)])
    psi = np.concatenate([chain.psi[chain.trail :] - pair.pitch, chain.psi[1 : chain.lead + 1]])
    rising = np.concatenate([area[chain.trail :] - area[-1], area[1 : chain.lead + 1]])
    back = slice(chain.lead, chain.trail + 1)
    falling = (area[back] - area[chain.lead])[::-1]
    return (psi, rising - rising[0]), (chain.psi[back][::-1], falling - falling[0])


def _level(psi: Array, function: tuple[Array, Array]) -> Array:
    return np.interp(psi, *function)


def sections(pair: Pair, chain: Chain) -> Sections:
    """Return the section area over ψ: a = Gain(ψ + 2π) − Loss(ψ) − Δ [R(ψ + p) − R(ψ)]."""
    rising, falling = mesh_functions(pair, chain)
    crossed = crossing(pair, chain)
    total, p = float(crossed[1][-1]), pair.pitch
    nodes = np.concatenate(
        [rising[0] - TURN, falling[0] - TURN - p, rising[0], falling[0], crossed[0] - p, crossed[0]]
    )
    psi = np.unique(nodes)
    psi = psi[np.concatenate([[True], np.diff(psi) > 1e-12])]
    gain = _level(psi + TURN, rising) - _level(psi + TURN + p, falling)
    loss = _level(psi, rising) - _level(psi, falling)
    a = gain - loss - (_level(psi + p, crossed) - _level(psi, crossed))
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (a[1:] + a[:-1]) * np.diff(psi))])
    male, female = sweep(pair, chain)
    grooves = _grooves(pair, chain)
    return Sections(psi, a, integral, *grooves, float(male.sum() / (male.sum() + female.sum())), total)


def _grooves(pair: Pair, chain: Chain) -> tuple[float, float]:
    """Return A01 and A02 [m²]: what the outline of a rotor leaves of its outer circle, over the lobes."""
    from screwsim.machine.rotors.pair import outlines

    male, female = outlines(pair, chain)
    A01 = (math.pi * pair.male_radius**2 - polygon_area(*male)) / pair.male_lobes
    return A01, (math.pi * pair.female_radius**2 - polygon_area(*female)) / pair.female_lobes
