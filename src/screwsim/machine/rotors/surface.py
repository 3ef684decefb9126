"""Assignment of chambers to rotor surfaces: surfaces of both rotors, and the angle of the chamber at each point.

A point of the profile meets the other rotor once per revolution, at its ψ on the chain (`machine.rotors.pair`). Before
that it lies in a chamber under compression, afterwards in one that fills. For male lobe 0 the leading flank bounds the
chamber ahead of it (whose trailing lobe is lobe 0, angle φ), the trailing flank the one behind it (φ − p). The side of
the tip between the tip and S changes from the chamber behind to that ahead when the tip leaves the bore at the cusp;
conversely, the flank of the female groove with the trailing branch of the contact changes from ahead to behind.

Angles [rad] have the origin of `machine.rotors.rotors`; lengths are in [m].
"""

import math
from dataclasses import dataclass

import numpy as np

from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.rotors import Rotors

TURN = 2.0 * math.pi
PROFILE = 120  # pieces of one pitch of the profile


@dataclass(frozen=True, eq=False)
class Surface:
    """One rotor: points of one pitch of its profile in its own frame, ψ of their contact, and how often they repeat.

    `turns` [rad of the rotor per rad of the male] and `pitch` [rad] have the sense of the rotor's outline; `region` of
    a piece between two points: 0 leading, 1 the side of the tip that changes chambers, 2 trailing.
    """

    x: Array
    y: Array
    psi: Array
    region: Array
    lobes: int
    pitch: float
    turns: float
    centre: float  # x of the axis [m]
    outward: float  # 1 for an outline that runs counter-clockwise, −1 for clockwise
    meets: float  # period of the male angle after which a point meets the other rotor again [rad]
    changes: Array  # ψ at which a piece of region 1 changes chambers [rad]


def surfaces(rotors: Rotors, pieces: int = PROFILE) -> tuple[Surface, Surface]:
    """Return the surfaces of male and female rotor."""
    pair, chain = rotors.pair, rotors.chain
    kept = _kept_points(rotors, pieces)
    psi, middles = chain.psi[kept], 0.5 * (kept[1:] + kept[:-1])
    tip = chain.tip
    male = np.select([middles <= tip, middles <= chain.trail], [0, 1], 2)
    female = np.select([middles <= chain.trail, middles <= chain.edges[1]], [0, 1], 2)
    male_changes, female_changes = _changes(rotors, kept)
    males = (pair.male_lobes, pair.pitch, -1.0, 0.0, 1.0, TURN, male_changes)
    females = (pair.female_lobes, -TURN / pair.female_lobes, pair.k, pair.centre_distance, -1.0, TURN / pair.k)
    (x, y), (u, v) = chain.male, chain.female(pair)
    one = Surface(x[kept], y[kept], psi, male, *males)
    return one, Surface(u[kept], v[kept], psi, female, *females, female_changes)


def _changes(rotors: Rotors, kept: Array) -> tuple[Array, Array]:
    """Return ψ [rad] at which pieces change chambers, of male and female rotor.

    It runs from the tip's leaving the bore to the first contact on its far side, point after point.
    """
    pair, chain = rotors.pair, rotors.chain
    middles = 0.5 * (kept[1:] + kept[:-1])
    first, last = -pair.beta1, float(chain.psi[chain.trail])
    male = np.interp(middles, [chain.tip, max(chain.trail, chain.tip + 1)], [first, last])
    female = np.interp(middles, [chain.trail, chain.edges[1]], [last, first])
    return male, female


def _kept_points(rotors: Rotors, pieces: int) -> Array:
    """Return the indices of chain points to keep: evenly spaced along both profiles together, plus the marked ones."""
    chain = rotors.chain
    steps = [np.hypot(np.diff(x), np.diff(y)) for x, y in (chain.male, chain.female(rotors.pair))]
    way = np.concatenate([[0.0], np.cumsum(np.sum(steps, axis=0))])
    even = np.searchsorted(way, np.linspace(0.0, way[-1], pieces + 1))
    marked = [0, len(way) - 1, chain.lead, chain.trail, chain.tip, *chain.edges, *chain.joints]
    return np.unique(np.clip(np.concatenate([even, marked]), 0, len(way) - 1))


def section_ages(surface: Surface, rotors: Rotors, phi: Array) -> Array:
    """Return φ [rad] of the chamber at each piece (lobes, profile, angles), in the section at the inlet.

    `phi` (angles,) are those of the tip of lobe 0. Below `rotors.start` the chamber is not born yet, and is open to
    suction. In a section at z the angle is that of the section at the inlet z/h before, and the chamber older by z/h.
    """
    pair, female = rotors.pair, surface.outward < 0.0
    contact = 0.5 * (surface.psi[1:] + surface.psi[:-1])[None, :, None]
    lobe = np.arange(surface.lobes)[:, None, None] * pair.pitch
    own = contact - np.mod(contact - (phi - lobe), surface.meets)  # the last one before the point's contact
    region, changes = surface.region[None, :, None], surface.changes[None, :, None]
    back = (region == 2) | ((region == 1) & ((own >= changes) if female else (own < changes)))
    return own - pair.pitch * back


def chamber_angles(surface: Surface, rotors: Rotors, phi: float, z: Array) -> Array:
    """Return φ [rad] of the chamber at each piece (lobes, profile, z), with the tip of lobe 0 at `phi` at the inlet."""
    behind = z / rotors.h
    return section_ages(surface, rotors, phi - behind) + behind


def turns_of(surface: Surface, phi: Array) -> tuple[Array, Array]:
    """Return cosine and sine of the angle by which each lobe (lobes, 1, angles) is turned in a section at `phi`."""
    turned = np.arange(surface.lobes)[:, None, None] * surface.pitch + surface.turns * phi
    return np.cos(turned), np.sin(turned)
