"""The flanks of both rotors as angles over the radius, and the widths of grooves and lobes that follow.

Lengths in m; angles in rad of the rotor itself, the male's counter-clockwise from the tip of lobe 0, the female's
clockwise from the middle of the groove that lobe 0 enters (both grow from the leading to the trailing side).
"""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from screwsim.machine.rotors.pair import Array, Chain, Pair

POINTS = 201  # radii of a flank
FEW = 4  # rotors whose flanks are cached: checks, ports and end faces of one pair use them in turn


@dataclass(frozen=True, eq=False)
class Flanks:
    """Angles of the leading and the trailing side of one chain, as arrays over radii from root to tip."""

    radii: Array
    lead: Array
    trail: Array
    turn: float  # angle of the rotor's pitch [rad]

    @cached_property
    def inner(self) -> Array:
        """Angular width between the two sides: of the male lobe, of the female groove [rad]."""
        return self.trail - self.lead

    @cached_property
    def outer(self) -> Array:
        """Angular width between two neighbours: of the male groove, of the female lobe [rad]."""
        return self.turn - self.inner


def spaced(low: float, high: float, points: int) -> Array:
    """Return radii from low to high, dense at both ends, where flanks merge into circles."""
    return low + 0.5 * (high - low) * (1.0 - np.cos(np.linspace(0.0, math.pi, points)))


def _over_radius(radii: Array, flank_radii: Array, angles: Array) -> Array:
    """Return the angle of a flank at given radii, interpolated in a variable that makes round tips and roots smooth."""
    low, high = radii[0], radii[-1]

    def smooth(r: Array) -> Array:
        return np.arccos(np.clip(1.0 - 2.0 * (r - low) / (high - low), -1.0, 1.0))

    at = smooth(flank_radii)
    order = slice(None) if at[-1] > at[0] else slice(None, None, -1)
    return np.interp(smooth(radii), np.maximum.accumulate(at[order]), angles[order])


@lru_cache(maxsize=FEW)
def male_flanks(pair: Pair, chain: Chain, points: int = POINTS) -> Flanks:
    """Return the flanks of male lobe 0."""
    x, y = chain.male
    rho, angle = chain.male_radii, np.arctan2(y, x)
    first, last = chain.edges
    radii = spaced(float(rho[first]), pair.male_radius, points)
    lead, trail = slice(first, chain.tip + 1), slice(chain.tip, last + 1)
    return Flanks(
        radii, _over_radius(radii, rho[lead], angle[lead]), _over_radius(radii, rho[trail], angle[trail]), pair.pitch
    )


@lru_cache(maxsize=FEW)
def female_flanks(pair: Pair, chain: Chain, points: int = POINTS) -> Flanks:
    """Return the flanks of female groove 0: ahead the land that left the male groove, behind the land that follows."""
    x, y = chain.female(pair)
    rho, angle = chain.female_radii(pair), np.arctan2(y, -x)
    first, last = chain.edges
    bottom = int(np.argmin(rho))
    radii = spaced(float(rho[bottom]), pair.female_radius, points)
    lead, trail = slice(first, bottom + 1), slice(bottom, last + 1)
    return Flanks(
        radii,
        _over_radius(radii, rho[lead], angle[lead]),
        _over_radius(radii, rho[trail], angle[trail]),
        2.0 * math.pi / pair.female_lobes,
    )
