"""A slide valve under both rotors: the positions of its ends, and the areas of a chamber that they uncover.

The slide lies in the cusp of the bores on the high-pressure side and moves along the axes. On each bore it is the strip
from the cusp back over its span. At full load its suction end rests on a stop; moved by s it uncovers the strip from
the stop to its end, which leads back to suction. Its discharge end carries the edge of the radial port, a helix, which
moves with it. The axial port is cut into the end face and stays.
Source: shape: N. Stosic, I. Smith, A. Kovacevic, Screw Compressors, Springer 2005; areas: docs/reference/rotors.md,
derived there. φ and ψ as in `leakage`, z from the inlet plane; lengths in m, angles in rad, spans in male radians.
"""

import math
from dataclasses import dataclass

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors.leakage import TURN
from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.ports import groove_tips, length_below
from screwsim.machine.rotors.rotors import Rotors
from screwsim.machine.rotors.settings import SlideValve
from screwsim.numerics.roots import brentq

PATH = "machine.slide_valve"
LEAST = 0.22  # closed volume over the largest one at the end of a slide's travel: about a quarter of the flow
NARROW = 40.0  # [degree] least span of a slide on a bore where its radial port needs less: assumed


@dataclass(frozen=True)
class PlacedSlide:
    """A slide at a position: z of the stop and distance from it [m], φ of the radial port's edge, spans on both bores.

    `closes` is the φ at which a chamber has passed the slot, None where the slot is shut.
    """

    stop: float
    moved: float
    edge: float
    spans: tuple[float, float]
    closes: float | None


def placed_slide(rotors: Rotors, slide: SlideValve, opens: float, face_opens: float) -> PlacedSlide:
    """Return the slide at its position; `opens` is φ of the radial port's edge at full load, `face_opens` the axial's.

    Raise UsageError in one line for a slide that is too narrow for the port, or whose travel is so long, or its length
    so short, that a chamber would be open to slot and discharge port at once.
    """
    h, (male, female) = rotors.h, groove_tips(rotors.pair, rotors.chain, rotors.h)
    apex = h * (opens + male.width - male.tip.end)  # of the radial port, at the cusp
    stop = 0.0 if slide.length is None else apex - slide.length
    spans = slide.male_span, slide.female_span / rotors.pair.k
    last = max(male.tip.end, female.tip.end)
    _refuse_spans(rotors, slide, opens)
    if stop / h + last >= opens:
        least = 1e3 * (apex - h * (opens - last))
        what = f"{1e3 * (slide.length or 0.0):.4g} mm lets the slot reach a chamber whose radial port is open"
        raise UsageError(f"{PATH}.length: {what} (choose more than {least:.4g} mm)")
    longest = h * (face_opens - last) - stop
    if slide.travel >= longest:
        what = f"{1e3 * slide.travel:.4g} mm brings the slot to chambers whose axial port is open"
        remedy = f"choose less than {1e3 * longest:.4g} mm" if longest > 0.0 else f"choose a longer {PATH}.length"
        raise UsageError(f"{PATH}.travel: {what} ({remedy})")
    moved = slide.position * slide.travel
    closes = (stop + moved) / h + last if moved > 0.0 and stop + moved > 0.0 else None
    return PlacedSlide(stop, moved, opens + moved / h, spans, closes)


def fitting_slide(rotors: Rotors, opens: float, face_opens: float) -> SlideValve:
    """Return a slide that begins at the inlet end, with spans and travel that fit.

    `opens` and `face_opens` as for `placed_slide`. Spans are whole degrees, those of the radial port or `NARROW`. At
    the end of the travel `LEAST` of the largest volume is closed in, unless that exceeds the permitted travel.
    """
    wide = (max(math.degrees(span), NARROW) for span in _port_spans(rotors, opens))
    male, female = (math.radians(math.ceil(span)) for span in wide)
    last = max(tip.end for tip, *_ in groove_tips(rotors.pair, rotors.chain, rotors.h))
    begins, largest = rotors.largest
    passed = brentq(lambda phi: float(rotors.volume(np.array([phi]))[0]) - LEAST * largest, begins, face_opens)
    travel = rotors.h * min(passed - last, 0.99 * (face_opens - last))
    return SlideValve(travel=travel, male_span=male, female_span=female)


def _port_spans(rotors: Rotors, opens: float) -> tuple[float, float]:
    """Return the angles [rad] that the radial port at full load spans from the cusp on the male and the female bore."""
    male, female = (
        ratio * (rotors.wrap - opens - width + tip.end)
        for (tip, width, _), ratio in zip(
            groove_tips(rotors.pair, rotors.chain, rotors.h), (1.0, rotors.pair.k), strict=True
        )
    )
    return male, female


def _refuse_spans(rotors: Rotors, slide: SlideValve, opens: float) -> None:
    """Raise UsageError for a slide narrower than the radial port at full load, or wider than a bore."""
    pair, wrong = rotors.pair, []
    for own, name in zip(_port_spans(rotors, opens), ("male", "female"), strict=True):
        given = getattr(slide, f"{name}_span")
        most = TURN - 2.0 * (pair.beta1 if name == "male" else pair.beta2)
        text = f"{PATH}.{name}_span: {np.degrees(given):.4g} deg"
        if given < own - 1e-9:
            port = f"the radial port at full load reaches {np.degrees(own):.4g} deg from the cusp"
            wrong.append(f"{text}: {port} (choose a wider slide, or a larger machine.built_in_volume_ratio)")
        elif given > most:
            wrong.append(f"{text} is more than the bore's {np.degrees(most):.4g} deg (choose less)")
    if wrong:
        raise UsageError("\n".join(wrong))


def slot_areas(rotors: Rotors, at: PlacedSlide, phi: Array) -> tuple[Array, Array]:
    """Return the open areas [m²] of the slot to suction on the male and the female bore.

    The slot is the strip 0 ≤ θ ≤ span, stop ≤ z ≤ stop + moved, within the rotors, as far as it lies between the
    chamber's tips: the trailing one at θ = z/h − φ + (ψ at which it leaves the bore), the leading one a groove width
    nearer the cusp.
    """
    low, high = (min(max(z, 0.0), rotors.length) for z in (at.stop, at.stop + at.moved))
    areas, h = [], rotors.h
    for (tip, width, radius), span in zip(groove_tips(rotors.pair, rotors.chain, h), at.spans, strict=True):
        first, last = (z / h - phi + tip.end for z in (low, high))
        whole = length_below(last, span) - length_below(first, span)
        ahead = length_below(last - width, span) - length_below(first - width, span)
        areas.append(radius * h * np.maximum(whole - ahead, 0.0))
    return areas[0], areas[1]


def slot_breakpoints(rotors: Rotors, at: PlacedSlide) -> list[float]:
    """Return the φ at which a tip reaches or leaves a corner of the slot [rad]."""
    found = []
    for (tip, width, _), span in zip(groove_tips(rotors.pair, rotors.chain, rotors.h), at.spans, strict=True):
        corners = [min(max(z, 0.0), rotors.length) / rotors.h for z in (at.stop, at.stop + at.moved)]
        found += [z + tip.end - w - back for z in corners for w in (0.0, width) for back in (0.0, span)]
    return found
