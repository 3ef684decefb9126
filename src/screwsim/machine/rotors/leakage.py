"""Lengths of the leakage paths of a chamber over the male angle: sealing line and tip helices.

φ [rad] is zero when the tip of the chamber's trailing lobe lies on the centre line at the inlet plane; the section at
z stands at ψ = φ − τ z/L. h = L/τ [m/rad]. A length becomes an area with a clearance. Source: docs/reference/rotors.md.
"""

import math
from dataclasses import dataclass

import numpy as np

from screwsim.machine.rotors.pair import Array, Chain, Pair, cumulated

TURN = 2.0 * math.pi


@dataclass(frozen=True, eq=False)
class SealingLine:
    """Length of the contact line [m] up to ψ on its two branches: (ψ nodes [rad], length [m])."""

    rising: tuple[Array, Array]  # S₋₁ → S'₀: the chamber behind it fills in the same grooves, z1 pitches behind
    falling: tuple[Array, Array]  # S'₀ → S₀, over the male tip: z1 + 1 pitches behind

    def lengths_at(self, phi: Array, wrap: float) -> tuple[Array, Array]:
        """Return the lengths [m] of both branches between the end faces, ψ ∈ [φ − τ, φ]."""
        rising, falling = (
            np.interp(phi, *branch) - np.interp(phi - wrap, *branch, left=0.0) for branch in (self.rising, self.falling)
        )
        return rising, falling


def sealing_line(pair: Pair, chain: Chain, h: float) -> SealingLine:
    """Return the length of the contact line, dl² = dX² + dY² + (h dψ)²."""
    steps = np.sqrt(np.diff(chain.x) ** 2 + np.diff(chain.y) ** 2 + (h * np.diff(chain.psi)) ** 2)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    psi = np.concatenate([chain.psi[chain.trail :] - pair.pitch, chain.psi[1 : chain.lead + 1]])
    rising = np.concatenate([length[chain.trail :] - length[-1], length[1 : chain.lead + 1]])
    back = slice(chain.lead, chain.trail + 1)
    falling = (length[chain.trail] - length[back])[::-1]
    return SealingLine(cumulated(psi, rising), cumulated(_rising(chain.psi[back][::-1]), falling))


def _rising(psi: Array) -> Array:
    """Return ψ such that it rises: of the symmetric profile all points of the branch meet at once, at ψ = 0."""
    return psi - 1e-9 * np.arange(len(psi))[::-1] if psi[-1] - psi[0] < 1e-6 else psi


@dataclass(frozen=True)
class Helix:
    """A tip that seals on the bore while ψ lies in (start, end) [rad]; slope: its length a male radian [m/rad]."""

    start: float
    end: float
    slope: float

    def length_at(self, phi: Array, wrap: float) -> Array:
        """Return the length [m] that seals between the end faces."""
        return self.slope * np.maximum(np.minimum(phi, self.end) - np.maximum(phi - wrap, self.start), 0.0)


def male_tip(pair: Pair, h: float) -> Helix:
    """Return the trailing male tip of a chamber on its bore."""
    return Helix(-TURN + pair.beta1, -pair.beta1, math.hypot(pair.male_radius, h))


def female_tip(pair: Pair, chain: Chain, h: float) -> Helix:
    """Return the trailing female tip of a chamber on its bore: the leading edge of the land behind its groove."""
    end = chain.land_start - pair.beta2 / pair.k
    start = end - (TURN - 2.0 * pair.beta2) / pair.k
    return Helix(start, end, math.hypot(pair.k * pair.female_radius, h))
