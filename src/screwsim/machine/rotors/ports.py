"""Ports that belong to a built-in volume ratio: axial (on the end faces) and radial (on the bores).

The edges of a port are the flanks and tip helices of the chamber at the angle at which it opens (discharge) or closes
(suction); the port reaches up to the contact line, to the cusp, and over the whole bore. Source:
docs/reference/rotors.md. φ and ψ as in `leakage`; areas in m², lengths in m, angles in rad; h = L/τ [m/rad].
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from screwsim.machine.rotors.flanks import Flanks, female_flanks, male_flanks
from screwsim.machine.rotors.leakage import TURN, Helix, female_tip, male_tip
from screwsim.machine.rotors.pair import Array, Chain, Pair
from screwsim.machine.rotors.sections import Sections
from screwsim.numerics.roots import brentq

APART = math.radians(0.5)  # of angles at which the opening of a port on the end face is searched: a row of its curve


@dataclass(frozen=True, eq=False)
class UncoveredArea:
    """Area of one chamber's grooves on an end face that an edge uncovers, over the angle Δ since it was passed."""

    k: float
    male: Flanks
    female: Flanks
    scale: float  # factor to A01 + A02, which the flanks at discrete radii give to 1e-5 only

    def area(self, delta: Array) -> Array:
        """Return ∫ρ min(Δ, w_M) dρ + ∫ρ min(kΔ, w_F) dρ [m²]; w are the angular widths of the grooves."""
        total = np.zeros_like(delta)
        for flanks, width, ratio in ((self.male, self.male.outer, 1.0), (self.female, self.female.inner, self.k)):
            reach = np.clip(ratio * delta, 0.0, width.max())
            part = (reach > 0.0) & (reach < width.max())
            arc = np.minimum(reach[part, None], width)
            total += np.where(reach > 0.0, float(np.trapezoid(flanks.radii * width, flanks.radii)), 0.0)
            total[part] += np.trapezoid(flanks.radii * (arc - width), flanks.radii, axis=1)
        return self.scale * total


def uncovered_area(pair: Pair, chain: Chain, cut: Sections) -> UncoveredArea:
    """Return the grooves of a pair for `axial_discharge` and `axial_suction`."""
    rough = UncoveredArea(pair.k, male_flanks(pair, chain), female_flanks(pair, chain), 1.0)
    return replace(rough, scale=cut.grooves / float(rough.area(np.array([TURN]))[0]))


def axial_discharge(grooves: UncoveredArea, cut: Sections, phi: Array, wrap: float, phi_dis: float) -> Array:
    """Return the open area [m²] of the discharge port on the end face: uncovered, less what the mesh has taken."""
    return np.maximum(_left_on_face(grooves, cut, phi, wrap, phi_dis), 0.0)


def axial_opening(grooves: UncoveredArea, cut: Sections, wrap: float, phi_dis: float) -> float:
    """Return the angle [rad] at which the discharge port on the end face opens; its edge is passed at `phi_dis`.

    A port that is cut late opens later, for until then the mesh has taken more than the edge has uncovered. It counts
    as opening at its edge where it opens less than `APART` later.
    """
    phi = np.arange(phi_dis + APART, wrap, APART)
    left = _left_on_face(grooves, cut, phi, wrap, phi_dis)
    begins = int(np.argmax(left > 0.0))
    if begins == 0:  # at once, or never
        return phi_dis

    def left_at(angle: float) -> float:
        return float(_left_on_face(grooves, cut, np.array([angle]), wrap, phi_dis)[0])

    return brentq(left_at, float(phi[begins - 1]), float(phi[begins]), xtol=1e-9)


def _left_on_face(grooves: UncoveredArea, cut: Sections, phi: Array, wrap: float, phi_dis: float) -> Array:
    """Return what an edge has uncovered of the grooves, less what the mesh has taken; negative where that is more."""
    psi = phi - wrap
    taken = np.where(psi > -0.75 * TURN, cut.grooves - cut.area_at(psi), 0.0)
    return grooves.area(phi - phi_dis) - taken


def axial_suction(grooves: UncoveredArea, cut: Sections, phi: Array, phi_close: float) -> Array:
    """Return the open area [m²] of the suction port on the end face: still uncovered, less what is not yet gained."""
    middle = 0.5 * (cut.psi[0] + cut.psi[-1])
    lacking = np.where(phi < middle, cut.grooves - cut.area_at(phi), 0.0)
    return np.where(phi < phi_close, np.maximum(grooves.area(phi_close - phi) - lacking, 0.0), 0.0)


def _half_square(x: Array, top: float) -> Array:
    return 0.5 * np.clip(x, 0.0, max(top, 0.0)) ** 2


def radial_discharge(
    pair: Pair, chain: Chain, phi: Array, wrap: float, h: float, phi_dis: float
) -> tuple[Array, Array]:
    """Return the open areas [m²] of the discharge port on the male and the female bore.

    The port lies ahead of the chamber's leading tip as it stands at φ_dis, up to cusp and end face.
    """
    areas = []
    for tip, width, radius in groove_tips(pair, chain, h):
        whole = wrap - phi_dis - width + tip.end
        left = whole - (phi - phi_dis)
        area = radius * h * (_half_square(left + width, whole) - _half_square(left, whole))
        areas.append(np.where(phi > phi_dis, area, 0.0))
    return areas[0], areas[1]


def radial_suction(
    pair: Pair, chain: Chain, phi: Array, wrap: float, h: float, phi_close: float
) -> tuple[Array, Array]:
    """Return the open areas [m²] of the suction port on the male and the female bore.

    The port lies behind the chamber's trailing tip as it stands at φ_close, from the suction cusp on. The female groove
    is the one that will be compressed: it passes the suction cusp before the chamber's own life begins (`curves`).
    """
    areas = []
    for tip, width, radius in groove_tips(pair, chain, h):
        far = np.minimum(phi + width, phi_close)
        near = np.minimum(phi, phi_close)
        # a helix lies on the bore from where it enters it, at the tip's start, to the end of the wrap
        areas.append(radius * h * (length_below(far - tip.start, wrap) - length_below(near - tip.start, wrap)))
    return areas[0], areas[1]


def length_below(x: Array, span: float) -> Array:
    """Return ∫ up to x of the length of [0, span] that lies below it."""
    return 0.5 * np.maximum(x, 0.0) ** 2 - 0.5 * np.maximum(x - span, 0.0) ** 2


class GrooveTip(NamedTuple):
    """A groove on its bore: its trailing tip, its width in male radians, the bore's length per male radian [m]."""

    tip: Helix
    width: float
    radius: float


def groove_tips(pair: Pair, chain: Chain, h: float) -> tuple[GrooveTip, GrooveTip]:
    """Return the grooves of the male and of the female rotor on their bores."""
    groove = chain.land_start - chain.land_end
    return (
        GrooveTip(male_tip(pair, h), pair.pitch, pair.male_radius),
        GrooveTip(female_tip(pair, chain, h), groove, pair.k * pair.female_radius),
    )
