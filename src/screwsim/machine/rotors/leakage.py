"""Leakage paths of a chamber over the male angle: sealing line, tip helices, end faces, blow-holes at the cusps.

φ [rad] is zero when the tip of the chamber's trailing lobe lies on the centre line at the inlet plane; the section at z
is at ψ = φ − τ z/L. h = L/τ [m/rad]. A length times a clearance is an area.

On an end face the lengths are the radial extents of what separates two chambers, by lobe offset. At each radius a
lobe's arc lies between its two flanks. A length is the radial extent over which one flank bounds one chamber and the
other flank the other chamber; the contact points, at radii known from the chain, divide the flanks. Between the male
tip's departure from the cusp and the new contact at S the division moves linearly (as R does).

A blow-hole is open between the departure of one rotor's flank and the arrival of the other's. In the plane through the
cusp line and S, a point of the line H→S at distance s is open from ψ_m(s), when the male trailing flank leaves it, to
ψ_f(s), when the female flank arrives. The suction side is the mirror image (y → −y, ψ → −ψ): S becomes S', the flanks
are those ahead of the lobe.
Source: ours (docs/reference/rotors.md). Lengths in m, angles in rad.
"""

import math
from dataclasses import dataclass

import numpy as np

from screwsim.machine.rotors.flanks import female_flanks, male_flanks
from screwsim.machine.rotors.pair import Array, Chain, Pair, cumulated, rising_branch

Level = tuple[Array, Array]  # (ψ, radius of a contact)
TURN = 2.0 * math.pi


@dataclass(frozen=True, eq=False)
class SealingLine:
    """Length of the contact line [m] up to ψ on its two branches: (ψ nodes [rad], length [m])."""

    rising: tuple[Array, Array]  # S₋₁ → S'₀: to the chamber filling in the same grooves, z1 pitches behind
    falling: tuple[Array, Array]  # S'₀ → S₀, over the male tip: to the chamber z1 + 1 pitches behind

    def lengths_at(self, phi: Array, wrap: float) -> tuple[Array, Array]:
        """Return the lengths [m] of both branches between the end faces, ψ ∈ [φ − τ, φ]."""
        rising, falling = (
            np.interp(phi, *branch) - np.interp(phi - wrap, *branch, left=0.0) for branch in (self.rising, self.falling)
        )
        return rising, falling


def sealing_line(pair: Pair, chain: Chain, h: float) -> SealingLine:
    """Return the contact line with its length, dl² = dX² + dY² + (h dψ)²."""
    steps = np.sqrt(np.diff(chain.x) ** 2 + np.diff(chain.y) ** 2 + (h * np.diff(chain.psi)) ** 2)
    length, rising = rising_branch(pair, chain, steps)
    back = slice(chain.lead, chain.trail + 1)
    falling = (length[chain.trail] - length[back])[::-1]
    return SealingLine(rising, cumulated(_rising(chain.psi[back][::-1]), falling))


def _rising(psi: Array) -> Array:
    """Return ψ made strictly increasing: on the symmetric profile all points of the branch touch at once, at ψ = 0."""
    return psi - 1e-9 * np.arange(len(psi))[::-1] if psi[-1] - psi[0] < 1e-6 else psi


@dataclass(frozen=True)
class Helix:
    """A tip that seals on the bore while ψ lies in (start, end) [rad]; slope: its length per male radian [m/rad]."""

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


@dataclass(frozen=True, eq=False)
class Contacts:
    """Radii [m] over ψ [rad] at which the contacts of lobe 0 divide the flanks of one rotor.

    lead: on the side ahead of the lobe; tip: on the falling branch; trail: on the rising branch behind the lobe.
    """

    lead: Level
    tip: Level
    trail: Level


def contacts(pair: Pair, chain: Chain, radii: Array, outer: float) -> Contacts:
    """Return the contacts of one rotor, given the radii of its contact points and its outer radius.

    Beyond S' the whole flank ahead of the lobe is on the suction side, and beyond the male tip so is the one behind.
    """
    first, last = chain.edges
    past = np.array([1e-9])
    start, top, end = np.array([-pair.beta1]), np.array([outer]), radii[[chain.tip]]
    lead, tip = slice(first, chain.lead + 1), slice(chain.tip, chain.trail + 1)
    trail = slice(chain.trail, last + 1)
    return Contacts(
        (
            np.concatenate([np.maximum.accumulate(chain.psi[lead]) - past, chain.psi[[chain.lead]]]),
            np.concatenate([radii[lead], end]),
        ),
        (
            np.concatenate([start, chain.psi[tip][::-1] - past, chain.psi[[chain.tip]]]),
            np.concatenate([top, radii[tip][::-1], end]),
        ),
        (np.concatenate([start, chain.psi[trail]]), np.concatenate([top, radii[trail]])),
    )


def _at(level: Level, where: Array) -> Array:
    return np.interp(where, *level)


def male_lengths(pair: Pair, chain: Chain, psi: Array) -> dict[int, Array]:
    """Return {offset: length [m]} across the male lobes, over the angle of the leading chamber at the face."""
    c = contacts(pair, chain, chain.male_radii, pair.male_radius)
    root = float(chain.male_radii.min())
    z1, before, ahead = pair.male_lobes, psi + TURN, psi + pair.pitch
    lead, tip, trail = _at(c.lead, psi), _at(c.tip, psi), _at(c.trail, psi)
    top = np.minimum(np.minimum(_at(c.lead, before), trail), _at(c.tip, before))
    neighbour = top - np.maximum(lead, _at(c.trail, before))
    over = tip - np.maximum(trail, lead)
    under = np.minimum(_at(c.lead, ahead), _at(c.trail, ahead)) - root
    return {offset: np.maximum(length, 0.0) for offset, length in ((1, neighbour), (z1 - 1, under), (z1 + 1, over))}


def female_lengths(pair: Pair, chain: Chain, psi: Array) -> dict[int, Array]:
    """Return {offset: length [m]} across the female lobes, over the angle of the leading chamber at the face."""
    c = contacts(pair, chain, chain.female_radii(pair), pair.female_radius)
    outer, p = pair.female_radius, pair.pitch
    before = psi + TURN / pair.k  # the same groove, one turn of the female rotor earlier
    top = np.minimum(np.minimum(_at(c.tip, psi), _at(c.lead, psi - p)), _at(c.trail, before))
    neighbour = top - np.maximum(_at(c.tip, before), _at(c.lead, before - p))
    own, low, high = _at(c.lead, psi), _at(c.tip, psi + p), _at(c.trail, psi + p)
    facing = np.minimum(high, own) - low  # the filling groove against the chamber's own
    edge = outer - np.maximum(high, own)  # the chamber, behind the contact, against the groove that fills
    across = np.maximum(facing, 0.0) + np.maximum(edge, 0.0)
    return {1: np.maximum(neighbour, 0.0), pair.male_lobes: across}


def mean_widths(pair: Pair, chain: Chain) -> tuple[float, float]:
    """Return the mean thickness of the male and the female lobe on the face [m], the length of the leak's passage."""
    male, female = male_flanks(pair, chain), female_flanks(pair, chain)
    one, two = (
        float(np.trapezoid(f.radii * width, f.radii) / (f.radii[-1] - f.radii[0]))
        for f, width in ((male, male.inner), (female, female.outer))
    )
    return one, two


def face_lengths(pair: Pair, chain: Chain, psi: Array) -> dict[int, Array]:
    """Return {offset: length [m]} across both rotors' lobes at one end face."""
    total: dict[int, Array] = {}
    for part in (male_lengths(pair, chain, psi), female_lengths(pair, chain, psi)):
        for offset, length in part.items():
            total[offset] = total.get(offset, np.zeros_like(length)) + length
    return dict(sorted(total.items()))


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


def blow_hole_opening(pair: Pair, chain: Chain) -> BlowHoleOpening:
    """Return the open angles along the line from the cusp H to S, the end of the contact on the trailing flank."""
    H, S = pair.cusp, (float(chain.x[chain.trail]), float(chain.y[chain.trail]))
    part = np.linspace(0.0, 1.0, POINTS) ** 2  # dense at H: flanks leave the outer circles as √s
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
