"""Load, fatigue and friction of a flexible connecting rod over a turn (docs/reference/slider-crank.md).

Source: T. A. Obolenskaya, A. S. Klochko, 2014 (in Russian); a power is missing in its force formula. For fatigue and
friction it refers to another book: here both are taken from textbooks.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from screwsim.inputs.declare import number, quantity
from screwsim.machine.slider_crank.rod import Array, Bending


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
