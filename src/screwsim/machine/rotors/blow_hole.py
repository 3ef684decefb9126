"""The blow-holes at the cusps: the opening between the departure of one rotor's flank and the arrival of the other's.

In the plane through the cusp line and S, a point of the line H→S at distance s is open from ψ_m(s), when the male
trailing flank leaves it, to ψ_f(s), when the female flank arrives. The suction side is the mirror image (y → −y, ψ →
−ψ): S becomes S', the flanks are those ahead of the lobe. Source: docs/reference/rotors.md. Lengths in m, angles in
rad.
"""

import math
from dataclasses import dataclass

import numpy as np

from screwsim.machine.rotors.pair import Array, Chain, Pair

POINTS = 401  # points on the line H→S


@dataclass(frozen=True, eq=False)
class BlowHoleOpening:
    """Points of the line H→S, as arrays: distance s [m], open from ψ_m to ψ_f [rad], radii from both centres [m]."""

    s: Array
    psi_male: Array
    psi_female: Array
    rho1: Array
    rho2: Array

    def area(self, h: float) -> float:
        """Return the area of the whole blow-hole [m²]; h = L/τ [m/rad]."""
        return h * float(np.trapezoid(self.psi_female - self.psi_male, self.s))

    def area_at(self, phi: Array, wrap: float, h: float) -> Array:
        """Return the area of the part between the end faces [m²], for ψ ∈ [φ − τ, φ]."""
        first, last = self.psi_male.min(), self.psi_female.max()
        area = np.where((phi >= last) & (phi - wrap <= first), self.area(h), 0.0)
        part = ((phi > first) & (phi < last)) | ((phi - wrap > first) & (phi - wrap < last))
        low = np.maximum(self.psi_male, phi[part, None] - wrap)
        high = np.minimum(self.psi_female, phi[part, None])
        area[part] = h * np.trapezoid(np.maximum(high - low, 0.0), self.s, axis=1)
        return area


def mirrored(chain: Chain) -> Chain:
    """Return the chain with suction and discharge side exchanged."""
    last = len(chain.psi) - 1
    edges = last - chain.edges[1], last - chain.edges[0]
    return Chain(-chain.psi[::-1], chain.x[::-1], -chain.y[::-1], last - chain.trail, last - chain.lead, edges)


def blow_hole_opening(pair: Pair, chain: Chain, points: int = POINTS) -> BlowHoleOpening:
    """Return the open angles along the line from the cusp H to S, the end of the contact on the trailing flank."""
    H, S = pair.cusp, (float(chain.x[chain.trail]), float(chain.y[chain.trail]))
    part = np.linspace(0.0, 1.0, points) ** 2  # dense at H: flanks leave the outer circles as √s
    x, y = H[0] + part * (S[0] - H[0]), H[1] + part * (S[1] - H[1])
    rho1, rho2 = np.hypot(x, y), np.hypot(pair.centre_distance - x, y)
    mx, my = chain.male
    male = slice(chain.tip, None)  # the trailing flank
    alpha = _angle(rho1, pair.male_radius, chain.male_radii[male], np.arctan2(my, mx)[male])
    fx, fy = chain.female(pair)
    female = slice(chain.trail, None)
    eta = _angle(rho2, pair.female_radius, chain.female_radii(pair)[female], np.arctan2(fy, -fx)[female])
    psi_male = alpha - np.arctan2(y, x)
    psi_female = (eta - np.arctan2(y, pair.centre_distance - x)) / pair.k
    return BlowHoleOpening(part * math.hypot(S[0] - H[0], S[1] - H[1]), psi_male, psi_female, rho1, rho2)


def _angle(rho: Array, outer: float, radii: Array, angles: Array) -> Array:
    """Return the flank's angle at radii rho; it is smooth in √(outer − radius), since the tip is round."""
    depth = np.sqrt(np.maximum(outer - radii, 0.0))
    depth, angles = (depth, angles) if depth[0] < depth[-1] else (depth[::-1], angles[::-1])
    start = int(np.searchsorted(depth, 1e-7 * math.sqrt(outer), side="right"))  # the edge of a cylindrical land
    start = max(start - 1, 0)
    return np.interp(np.sqrt(np.maximum(outer - rho, 0.0)), depth[start:], angles[start:])


def crossing(pair: Pair, chain: Chain, o: BlowHoleOpening) -> tuple[Array, Array]:
    """Return the ramp R between chamber and blow-hole: its ends ψm, ψS [rad], and the area crossed by then [m²].

    The total area is exact (the area that each rotor sweeps at its end on the line H→S), one row per rotor, and sums to
    Δ; in between the ramp is taken as linear.
    """
    levels = pair.male_radius**2 - o.rho1**2, pair.k * (pair.female_radius**2 - o.rho2**2)
    crossed = [
        0.5 * float(np.trapezoid(level, psi)) for level, psi in zip(levels, (o.psi_male, o.psi_female), strict=True)
    ]
    return np.array([-pair.beta1, chain.psi[chain.trail]]), np.array([[0.0, area] for area in crossed])
