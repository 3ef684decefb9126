"""Drawing of a machine on the page: the rotors of its profile, or a sketch where a law gives only the volume.

A sketch has circular rotors with the machine's lobes, diameter and length, twisted so that a chamber lives as long as
in its law; it shows which chamber is where, but no shape used in the simulation.
"""

import math
from typing import Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import TWIN_SCREW, kind_of, twin_screw
from screwsim.machine.profile_law import laid_curves
from screwsim.machine.rotors.closed_form import circular
from screwsim.machine.rotors.pair import Pair
from screwsim.machine.rotors.rotors import Rotors
from screwsim.machine.settings import TwinScrew
from screwsim.report.rotors_page import drawing

DEG = 180.0 / math.pi
WRAPS = math.radians(120.0), math.radians(350.0)  # range of a sketch's wrap angle
ARC = 0.8  # of half a pitch: radius of a sketched lobe
TIP = 0.08  # of the male lobe's height: radius of a sketched female tip


def document(settings: Any) -> dict[str, Any]:
    """Return the drawing: rotors in millimetres and degrees, or a cylinder; and the angles of a chamber's life."""
    geometry = kind_of(settings).geometry(settings)
    life, pitch = DEG * geometry.life, DEG * geometry.pitch
    backwards = getattr(settings, "mode", "") == "expander"  # an expander is the compressor run backwards
    common = {"life": life, "pitch": pitch, "chambers": max(1, round(life / pitch)), "backwards": backwards}
    if settings.kind != TWIN_SCREW:
        return {"kind": "cylinder", **common}
    machine = twin_screw(settings)
    if machine.volume.from_rotors:
        laid = laid_curves(machine)
        start = DEG * (laid.rotors.start - laid.born)
        return {"kind": "rotors", "sketch": False, **common, **drawing(laid.rotors), "start": start, **_sizes(machine)}
    rotors = _sketched(machine, geometry.life)
    if rotors is None:
        return {"kind": "none", **common}
    start = DEG * rotors.wrap - life  # its chambers end together with those of the law
    return {"kind": "rotors", "sketch": True, **common, **drawing(rotors), "start": start, **_sizes(machine)}


def _sizes(machine: TwinScrew) -> dict[str, Any]:
    return {"lobes": [machine.male_lobes, machine.female_lobes], "length": 1e3 * machine.rotor_length}


def _sketched(machine: TwinScrew, life: float) -> Rotors | None:
    """Return circular rotors with a machine's lobes and sizes; None where these numbers of lobes allow none."""
    if machine.male_lobes < 2 or machine.female_lobes < 2:
        return None
    radius, lobes = 0.5 * machine.rotor_diameter, machine.male_lobes
    share = ARC * math.pi / lobes
    height = radius * share / (1.0 + share)
    r1 = radius - height
    centres = r1 * (1.0 + machine.female_lobes / lobes)
    pair = Pair(lobes, machine.female_lobes, centres, radius, centres - r1)
    try:
        chain = circular(pair, TIP * height)
        untwisted = Rotors(pair, chain, machine.rotor_length, 1.0)
        wrap = min(max(life + untwisted.start, WRAPS[0]), WRAPS[1])
        rotors = Rotors(pair, chain, machine.rotor_length, wrap)
        return rotors if np.isfinite(chain.x).all() and np.isfinite(rotors.start) else None
    except (UsageError, ValueError, IndexError):
        return None
