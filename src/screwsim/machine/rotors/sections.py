"""Areas of the transverse section, and the chamber volume that follows.

A rotating rigid curve sweeps ½ρ² per radian, so only the contact radii matter: dA = ½[(R1² − ρ1²) + k(R2² − ρ2²)] dψ
along the chain; over one pitch it sums to A01 + A02 exactly. Between the points of the chain the section area a(ψ) is
linear and its integral quadratic, so V and dV/dφ are exactly consistent, whatever length and wrap.
Source: docs/reference/rotors.md. Lengths in m, angles in rad.
"""

import math
from dataclasses import dataclass

import numpy as np

from screwsim.machine.rotors.leakage import BlowHoleOpening, blow_hole_opening, crossing
from screwsim.machine.rotors.pair import Array, Chain, Pair, cumulated, outlines, rising_branch

TURN = 2.0 * math.pi


def polygon_area(x: Array, y: Array) -> float:
    """Return the area of a closed polygon [m²], positive whatever its orientation."""
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


def sweep(pair: Pair, chain: Chain) -> tuple[Array, Array]:
    """Return the areas [m²] that the male and the female rotor displace from each contact point to the next."""
    male = pair.male_radius**2 - chain.male_radii**2
    female = pair.female_radius**2 - chain.female_radii(pair) ** 2
    step = 0.25 * np.diff(chain.psi)
    return (male[1:] + male[:-1]) * step, pair.k * (female[1:] + female[:-1]) * step


@dataclass(frozen=True, eq=False)
class Sections:
    """Section area a(ψ) of one chamber on its nodes, and its integral: arrays; ψ [rad], a [m²], integral [m² rad].

    Convention: a chamber is a male groove and the female groove that meets it at the high-pressure cusp; while it
    fills, the female groove that leaves the mesh with it. R is linear. Both choices matter by 0.1–1.2 % of V_max while
    the chamber fills, and not at all later.
    """

    psi: Array
    a: Array
    a_male: Array  # its part that the male rotor displaces [m²]
    integral: Array
    male_groove: float  # A01 [m²]
    female_groove: float  # A02 [m²]
    male_share: float  # share of the displacement work, hence of the gas torque

    @property
    def grooves(self) -> float:
        """Area of both grooves, A01 + A02 [m²]."""
        return self.male_groove + self.female_groove

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


Branches = tuple[tuple[Array, Array], tuple[Array, Array]]


def mesh_functions(pair: Pair, chain: Chain, area: Array) -> Branches:
    """Return (ψ, cumulated area) along the rising branch S₋₁→S'₀ and along the falling one, S₀→S'₀, signed.

    area: of each step along the chain [m²], of one rotor or of both.
    """
    total, rising = rising_branch(pair, chain, area)
    back = slice(chain.lead, chain.trail + 1)
    return rising, cumulated(chain.psi[back][::-1], (total[back] - total[chain.lead])[::-1])


def _chamber(pair: Pair, psi: Array, branches: Branches, crossed: tuple[Array, Array]) -> Array:
    """Return Gain(ψ + 2π) − Loss(ψ) − Δ [R(ψ + p) − R(ψ)] [m²]."""
    rising, falling = branches
    p = pair.pitch
    gain = np.interp(psi + TURN, *rising) - np.interp(psi + TURN + p, *falling)
    loss = np.interp(psi, *rising) - np.interp(psi, *falling)
    return gain - loss - (np.interp(psi + p, *crossed) - np.interp(psi, *crossed))


def sections(pair: Pair, chain: Chain, hole: BlowHoleOpening | None = None) -> Sections:
    """Return the section area of a chamber over ψ, and the part of it that the male rotor displaces.

    hole: the blow-hole at the high-pressure cusp, where it is known.
    """
    steps, p = sweep(pair, chain), pair.pitch
    ramp, delta = crossing(pair, chain, hole or blow_hole_opening(pair, chain))
    meshes = [mesh_functions(pair, chain, step) for step in steps]
    rising, falling = meshes[0]
    nodes = [rising[0] - TURN, falling[0] - TURN - p, rising[0], falling[0], ramp - p, ramp]
    psi = np.unique(np.concatenate(nodes))
    psi = psi[np.concatenate([[True], np.diff(psi) > 1e-12])]
    parts = [_chamber(pair, psi, mesh, (ramp, crossed)) for mesh, crossed in zip(meshes, delta, strict=True)]
    a = parts[0] + parts[1]
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (a[1:] + a[:-1]) * np.diff(psi))])
    share = float(steps[0].sum() / (steps[0].sum() + steps[1].sum()))
    male, female = outlines(pair, chain)  # of the outer circle the grooves are what the outline leaves
    A01 = (math.pi * pair.male_radius**2 - polygon_area(*male)) / pair.male_lobes
    A02 = (math.pi * pair.female_radius**2 - polygon_area(*female)) / pair.female_lobes
    return Sections(psi, a, parts[0], integral, A01, A02, share)
