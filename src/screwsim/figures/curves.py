"""Curves of a cycle: their declarations, and each at an angle as a figure, `pressure_at_600_deg`.

A fit reads such a figure beside flow and power. The program reads it from the stored cycle only where a fit asks for
it: no other result has it. Every declared curve can be read so, also those of effects, of one's own too.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from screwsim.effects import catalogue, imported
from screwsim.effects.base import Effect
from screwsim.outputs import Figure, Result, over
from screwsim.outputs.declared import ITSELF, Variable
from screwsim.outputs.variables import CYCLE, cycle_variable

_AT_ANGLE = re.compile(r"(\w+)_at_(\d+(?:\.\d+)?)_deg")


class Reading(NamedTuple):
    """A curve of the cycle, and the angle [degree] at which it is read."""

    curve: str
    angle: float

    @property
    def figure(self) -> str:
        """Name of the reading as a figure; the angle is rounded to a millionth."""
        return f"{self.curve}_at_{np.format_float_positional(round(self.angle, 6) + 0.0, trim='-')}_deg"


@cache
def known_traces() -> dict[str, Variable]:
    """Return the curves of a cycle that the core and the effects of the catalogue declare."""
    return CYCLE | _traces(catalogue())


def trace_variable(name: str) -> Variable:
    """Return unit and meaning of a curve of a cycle; without a declaration, those of a plain number."""
    return declared_trace(name) or cycle_variable(name)


def declared_trace(name: str) -> Variable | None:
    """Return unit and meaning of a curve of a cycle; None where nothing declares it."""
    return known_traces().get(name) or _traces(imported()).get(name)


def effects_with_trace(name: str) -> list[str]:
    """Return the effects that declare a curve of a cycle; none where every machine has it."""
    every = () if name in CYCLE else (catalogue() | imported()).items()
    return [effect for effect, declares in every if any(each.name == name for each in declares.traces)]


def _traces(effects: Mapping[str, Effect]) -> dict[str, Variable]:
    every = (each for effect in effects.values() for each in effect.traces)
    return {each.name: Variable(each.units, each.long_name) for each in every}


def reading_of(figure: str) -> Reading | None:
    """Return the curve and angle of a figure that is a curve at an angle; None for any other name."""
    found = _AT_ANGLE.fullmatch(figure)
    if found is None or found[1] == "angle" or declared_trace(found[1]) is None:
        return None
    return Reading(found[1], float(found[2]))


def reading_figure(name: str) -> Figure | None:
    """Return the declaration of a curve at an angle; None for any other name."""
    reading = reading_of(name)
    about = None if reading is None or name != reading.figure else declared_trace(reading.curve)
    if reading is None or about is None:
        return None
    scale = over("peak_pressure", alone=True) if about.units == "Pa" else ITSELF
    return Figure(name, about.units, f"{about.long_name} at {reading.angle:g} degrees", scale)


def with_readings(result: Result, names: Iterable[str]) -> Result:
    """Return a result with those of its figures that are curves at angles, read from its cycle.

    They are linear between the samples of the cycle, a degree apart. One of a curve that the cycle does not have, or
    beyond the life of the chamber, is null, with its reason among the notes.
    """
    asked = {name: reading for name in names if (reading := reading_of(name)) is not None}
    if not asked or "angle" not in result.cycle:
        return result
    angles = result.cycle["angle"]
    first, last = float(angles[0]), float(angles[-1])
    figures, notes = result.performance.copy(), dict(result.notes)
    for name, (curve, angle) in asked.items():
        figures[name] = None
        if curve not in result.cycle:
            notes[name] = f"the cycle has no {curve}"
        elif not first <= angle <= last:
            notes[name] = f"{angle:g} deg is outside the cycle's {first:g} to {last:g} deg"
        elif np.isfinite(value := float(np.interp(angle, angles, result.cycle[curve]))):
            figures[name] = value
        else:
            notes[name] = f"{curve} has no value at {angle:g} deg"
    return replace(result, performance=figures, notes=notes)
