"""Inputs whose part of an uncertainty is unknown: the sums leave them out, are too small, and are told to be."""

from collections.abc import Sequence

import numpy as np

from screwsim.results.group import OWN
from screwsim.results.read import Results

MOST_NAMED = 3  # inputs named one by one; of more the number is told


def parts_left_out(results: Results) -> np.ndarray:
    """Return which inputs (…, inputs) have no derivative in a case that has uncertainties; no column without any."""
    own = OWN["contributions"]
    if own not in results.contributions:
        return np.zeros((*results.shape, 0), bool)
    lost = np.zeros((*results.shape, len(results.contributions[own])), bool)
    for name in results.contributions:
        if name != own:
            unknown = np.isnan(results.contributions[name])
            lost |= unknown & ~unknown.all(axis=-1, keepdims=True)
    return lost


def short_label(label: str) -> str:
    """Return an input's name without the section in which all effects are."""
    return label.replace("effects.", "")


def left_out_words(labels: Sequence[str]) -> str:
    """Return what the sums leave out: `without tip_leakage.gap, whose part is unknown`; empty without any."""
    if not labels:
        return ""
    names = [short_label(label) for label in labels]
    told = ", ".join(names) if len(names) <= MOST_NAMED else f"{len(names)} inputs"
    return f"without {told}, whose part is unknown"
