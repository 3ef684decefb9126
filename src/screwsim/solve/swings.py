"""Errors of swings, which figures read at the two extreme angles of a curve: how far the curves of two lives are apart.

Source: docs/model.md M41; docs/explanation/errors.md.
"""

import math
from collections.abc import Mapping

import numpy as np

from screwsim.effects.base import Reading
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import error_of
from screwsim.outputs import Figures

Curves = Mapping[str, np.ndarray]  # by figure: the curve over a pitch, at even angles, whose swing it is


def curves_of(of: Evaluation) -> Curves:
    """Return the curves of a life whose swings its scene calls for; empty where it calls for none."""
    about, parts = of.figures.about, of.problem.parts
    found: dict[str, np.ndarray] = {}
    for _, part in parts.all(Reading):
        swings = {name: about[name].swing_of for name in part.figures if name in about and about[name].swing_of}
        if swings and part.traces is not None:
            traces = part.traces(of.known if parts.shaft is None else of.complete)
            found |= {name: traces[trace] for name, trace in swings.items() if trace in traces}
    return found


def swing_errors(figures: Figures, found: Curves, better: Curves) -> Figures:
    """Return by how much swings differ whose curves are as far apart as these, over what their errors are relative to.

    At their extreme angles two curves may agree by chance. At two angles of any phase their differences are apart by
    the root of twice their variance, in which every harmonic counts with its amplitude and its phase.
    """
    sizes: dict[str, float] = {}
    for name in found.keys() & better.keys():
        swing, value = float(np.ptp(found[name])), figures.get(name)
        if value is not None and swing > 0.0:
            apart = math.sqrt(2.0) * float(np.std(found[name] - better[name]))
            sizes[name] = error_of(name, apart / swing * abs(value), figures)  # half a swing, or one over a mean
    return Figures(sizes)
