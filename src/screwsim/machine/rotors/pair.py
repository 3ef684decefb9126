"""A rotor pair and its contact points: the kinematics that all rotor geometry builds on (docs/reference/rotors.md).

Frame: O1 = (0, 0) male centre, O2 = (A, 0) female centre, P = (r1, 0) pitch point. The male turns clockwise by ψ, the
female counter-clockwise by kψ. At ψ = 0 the tip of lobe 0 lies on the centre line; lobes enter the mesh at Y > 0.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Pair:
    """Lobes, centre distance [m] and outer radii [m] of a pair: what all profiles have in common."""

    male_lobes: int
    female_lobes: int
    centre_distance: float
    male_radius: float
    female_radius: float

    @property
    def k(self) -> float:
        """Speed of the female rotor over that of the male, z1/z2."""
        return self.male_lobes / self.female_lobes

    @property
    def pitch(self) -> float:
        """Angle between male lobes [rad]."""
        return 2.0 * math.pi / self.male_lobes

    @property
    def r1(self) -> float:
        """Pitch radius of the male rotor [m]."""
        return self.centre_distance * self.male_lobes / (self.male_lobes + self.female_lobes)

    @property
    def r2(self) -> float:
        """Pitch radius of the female rotor [m]."""
        return self.centre_distance - self.r1

    @property
    def addendum(self) -> float:
        """Height ha of the male lobe over the pitch circle [m]."""
        return self.male_radius - self.r1

    @property
    def dedendum(self) -> float:
        """Height hf of the female lobe over its pitch circle [m], the depth of the male groove below its own."""
        return self.female_radius - self.r2

    @property
    def cusp(self) -> tuple[float, float]:
        """Point H where the two bores meet, at Y > 0 [m]."""
        A, R1, R2 = self.centre_distance, self.male_radius, self.female_radius
        x = (A * A + R1 * R1 - R2 * R2) / (2.0 * A)
        return x, math.sqrt(R1 * R1 - x * x)

    @property
    def beta1(self) -> float:
        """Angle of the cusp from the centre line, seen from the male centre [rad]."""
        x, y = self.cusp
        return math.atan2(y, x)

    @property
    def beta2(self) -> float:
        """Angle of the cusp from the centre line, seen from the female centre [rad]."""
        x, y = self.cusp
        return math.atan2(y, self.centre_distance - x)


@dataclass(frozen=True, eq=False)
class Chain:
    """Contact points in the frame, in order over one pitch: leading root → tip → trailing root of male lobe 0.

    psi [rad], x, y [m]: arrays; the chain ends at its first point, one pitch of ψ later. Indices: `lead` of S' (local
    maximum of ψ, where contact on the leading flank ends), `trail` of S (local minimum, where contact on the trailing
    flank begins), `edges` where the flat (female land on male root) ends and begins, `joints` of the ends of segments.
    `faired`: in words, how measured points were changed.
    """

    psi: Array
    x: Array
    y: Array
    lead: int
    trail: int
    edges: tuple[int, int]
    joints: tuple[int, ...] = ()
    faired: str = ""

    @cached_property
    def male(self) -> tuple[Array, Array]:
        """The contact points on the male rotor [m], in its own frame: Rot(+ψ) C."""
        c, s = np.cos(self.psi), np.sin(self.psi)
        return fixed(c * self.x - s * self.y), fixed(s * self.x + c * self.y)

    def female(self, pair: Pair) -> tuple[Array, Array]:
        """Return the contact points on the female rotor [m], in its own frame: Rot(−kψ)(C − O2)."""
        return self._of_pair(pair)[:2]

    @cached_property
    def male_radii(self) -> Array:
        """Distances of the contact points from the male centre [m]."""
        return fixed(np.hypot(self.x, self.y))

    def female_radii(self, pair: Pair) -> Array:
        """Return the distances of the contact points from the female centre [m]."""
        return self._of_pair(pair)[2]

    def _of_pair(self, pair: Pair) -> tuple[Array, Array, Array]:
        """Return the female rotor's contact points and their distances from its centre, cached for the last pair."""
        if pair not in self._known:
            self._known.clear()
            c, s = np.cos(pair.k * self.psi), np.sin(pair.k * self.psi)
            x = self.x - pair.centre_distance
            found = c * x + s * self.y, c * self.y - s * x, np.hypot(x, self.y)
            self._known[pair] = fixed(found[0]), fixed(found[1]), fixed(found[2])
        return self._known[pair]

    @cached_property
    def _known(self) -> dict[Pair, tuple[Array, Array, Array]]:
        return {}

    @cached_property
    def tip(self) -> int:
        """Index of the male tip: the contact point farthest from the male centre (the middle one of several)."""
        radii = self.male_radii
        return int(np.median(np.flatnonzero(radii >= radii.max() * (1.0 - 1e-12))))

    @property
    def land_start(self) -> float:
        """Angle ψe at which the leading edge of the female land behind lobe 0 lies on the centre line [rad]."""
        return float(self.psi[self.edges[1]])

    @property
    def land_end(self) -> float:
        """Angle at which the trailing edge of the female land ahead of lobe 0 lies on the centre line [rad]: −yL/r1."""
        return float(self.psi[self.edges[0]])


def fixed(values: Array) -> Array:
    """Return an array made read-only, since all callers share it."""
    values.flags.writeable = False
    return values


def cumulated(psi: Array, total: Array) -> tuple[Array, Array]:
    """Return (ψ, cumulated sum) of a quantity summed along a branch of the chain.

    Where ψ runs back (a rack root with r5 < hf) each monotone piece is cumulated by itself.
    """
    way = np.sign(np.diff(psi))
    turns = np.flatnonzero(way[1:] * way[:-1] < 0.0) + 1
    if len(turns) == 0:
        return psi, total - total[0]
    nodes = np.unique(psi)
    values = np.zeros(len(nodes))
    for first, last in zip([0, *turns], [*turns, len(psi) - 1], strict=True):
        piece, part = psi[first : last + 1], total[first : last + 1]
        back = piece[-1] < piece[0]
        if back:
            piece, part = piece[::-1], part[::-1]
        values += (-1.0 if back else 1.0) * (np.interp(nodes, piece, part) - part[0])
    return nodes, values


def outline(x: Array, y: Array, lobes: int, turn: float) -> tuple[Array, Array]:
    """Return the closed outline of a rotor [m] from one pitch of points, repeated `lobes` times by `turn` [rad]."""
    angle = turn * np.arange(lobes)[:, None]
    c, s = np.cos(angle), np.sin(angle)
    px, py = x[:-1], y[:-1]  # the last point of a pitch is the first of the next
    return (c * px - s * py).ravel(), (s * px + c * py).ravel()


def outlines(pair: Pair, chain: Chain) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return the closed outlines of male (counter-clockwise) and female (clockwise), each in its own frame [m]."""
    male = outline(*chain.male, pair.male_lobes, pair.pitch)
    female = outline(*chain.female(pair), pair.female_lobes, -2.0 * math.pi / pair.female_lobes)
    return male, female


def rising_branch(pair: Pair, chain: Chain, steps: Array) -> tuple[Array, tuple[Array, Array]]:
    """Return the sums of steps along the chain, and (ψ, sum) along its rising branch S₋₁→S'₀."""
    total = np.concatenate([[0.0], np.cumsum(steps)])
    psi = np.concatenate([chain.psi[chain.trail :] - pair.pitch, chain.psi[1 : chain.lead + 1]])
    return total, cumulated(psi, np.concatenate([total[chain.trail :] - total[-1], total[1 : chain.lead + 1]]))


def tangents(step: Array, chord: Array) -> Array:
    """Return the angle [rad] of the tangent at every point of a curve, by the lengths and angles of its chords.

    At an inner point it is that of the circle through the point and its neighbours.
    """
    inner = (chord[:-1] * step[1:] + chord[1:] * step[:-1]) / (step[1:] + step[:-1])
    return np.concatenate([[2.0 * chord[0] - inner[0]], inner, [2.0 * chord[-1] - inner[-1]]])
