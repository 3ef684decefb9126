"""Errors of swings and mean squares of curves: how far the curves of two lives are apart, not what they agree on.

Source: docs/model.md M41; docs/explanation/errors.md.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from screwsim.effects.base import Reading
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import error_of
from screwsim.outputs import Figures

Curves = Mapping[str, np.ndarray]  # by figure: the curve over a pitch, at even angles, whose swing or mean square it is


class Solution(NamedTuple):
    """The figures of a closed cycle, or of a life near it, and the curves of those that are swings or mean squares."""

    figures: Figures
    curves: Curves


def solution_of(of: Evaluation) -> Solution:
    """Return the figures of an evaluation, and the curves of the swings and squares that its scene calls for."""
    about, parts = of.figures.about, of.problem.parts
    found: dict[str, np.ndarray] = {}
    for _, part in parts.all(Reading):
        read = {name: (about[name].swing_of, about[name].square_of) for name in part.figures if name in about}
        if part.traces is None or not any(swing or squared for swing, squared in read.values()):
            continue
        traces = part.traces(of.known if parts.shaft is None else of.complete)
        for name, (swing, squared) in read.items():
            if swing in traces:
                found[name] = traces[swing]
            elif squared and set(squared) <= traces.keys():
                found[name] = traces[squared[0]] - traces[squared[1]]
    return Solution(of.figures, found)


def swing_errors(figures: Figures, found: Curves, better: Curves) -> Figures:
    """Return the relative errors of swings and of means of squares, from the whole curves that they are read from.

    The extremes of two curves may agree by chance (and so may means of squares, `_of_square`). Of the difference of the
    curves, values at two angles of any phase lie √2 times its standard deviation apart, in which every harmonic counts.
    """
    about, sizes = getattr(figures, "about", {}), {}
    for name in found.keys() & better.keys():
        curve, value = found[name], figures.get(name)
        swing = float(np.ptp(curve))
        if value is None or not swing > 0.0:
            continue
        if name in about and about[name].square_of:
            apart = _of_square(curve, better[name] - curve)
        else:
            apart = math.sqrt(2.0) * float(np.std(curve - better[name])) / swing  # half a swing, or one over a mean
        sizes[name] = error_of(name, apart * abs(value), figures)
    return Figures(sizes)


def _of_square(curve: np.ndarray, apart: np.ndarray) -> float:
    """Return the relative change of a curve's mean square by an addition whose harmonics have any phase.

    It is the root of that change's variance.
    """
    own, more = np.abs(np.fft.rfft(curve)), np.abs(np.fft.rfft(apart))
    weights = np.where(np.arange(len(own)) > 0, 2.0, 1.0)  # Parseval: harmonics count twice, the mean once
    return 2.0 * math.sqrt(float(weights @ (own * more) ** 2)) / max(float(weights @ own**2), 1e-300)
