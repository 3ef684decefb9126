"""Hypotheses of what has changed in a machine: one parameter, two or none, and their probabilities by Bayes' rule."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from screwsim.study.calibration.residuals import Array

NO_CHANGE = ""  # path of the hypothesis that nothing changed
INTERVAL_LEVEL = 0.9  # probability of the intervals
LIKELY_PROBABILITY = 1e-3  # probability from which on a hypothesis counts
DISTINGUISHABLE = 2.0  # uncertainties: two changes whose residuals are nearer than this have the same effect
LEAST_CHANCE = 0.01  # probability of a misfit below which no hypothesis fits


class Change(NamedTuple):
    """Estimated value of a changed parameter, and its change, between `low` and `high` with `INTERVAL_LEVEL` [SI]."""

    path: str
    value: float
    change: float
    low: float
    high: float


@dataclass(frozen=True)
class Hypothesis:
    """A change of one parameter, of two at once, or none: its probability, and the remaining chi² of all points.

    `also` are other values [SI] of one parameter that fit nearly as well. `linear` says why the hypothesis was not
    solved again, '' where it was.
    """

    changes: tuple[Change, ...]
    probability: float
    log_evidence: float
    misfit: float
    freedom: int
    linear: str = ""
    also: tuple[float, ...] = ()

    @property
    def path(self) -> str:
        """Path of the changed parameter, or two joined by ' + '; '' for none."""
        return " + ".join(self.paths)

    @property
    def paths(self) -> tuple[str, ...]:
        return tuple(change.path for change in self.changes)

    def _only(self, name: str) -> float | None:
        return getattr(self.changes[0], name) if len(self.changes) == 1 else None

    @property
    def value(self) -> float | None:
        """Estimated present value of the one parameter [SI]."""
        return self._only("value")

    @property
    def change(self) -> float | None:
        """Change of the one parameter [SI]."""
        return self._only("change")

    @property
    def low(self) -> float | None:
        return self._only("low")

    @property
    def high(self) -> float | None:
        return self._only("high")


class IndistinguishablePair(NamedTuple):
    """Two hypotheses that the points cannot distinguish; `off`: their distance at all points, in uncertainties."""

    first: str
    second: str
    off: float


class PriorOdds(NamedTuple):
    """Prior probabilities, chi² of no change, and logarithms of the single changes' evidences: all but the pairs.

    `odds` are the prior odds of all pairs together against all single changes together.
    """

    unchanged: float
    odds: float
    none: float
    singles: tuple[float, ...]

    def probabilities(self, doubles: Sequence[float] = ()) -> Array:
        """Return the probabilities of no change, each single change and each pair, by the pairs' log evidences."""
        odds = self.odds if doubles else 0.0
        changed = (1.0 - self.unchanged) / (1.0 + odds)
        each_one, each_two = changed / max(len(self.singles), 1), changed * odds / max(len(doubles), 1)
        before = [self.unchanged, *[each_one] * len(self.singles), *[each_two] * len(doubles)]
        logs = np.log(before) + np.array([-0.5 * self.none, *self.singles, *doubles])
        weights = np.exp(logs - np.max(logs))
        return weights / weights.sum()


def indistinguishable_pairs(
    ranked: Sequence[Hypothesis], left: Mapping[tuple[str, ...], Array]
) -> tuple[IndistinguishablePair, ...]:
    """Return pairs of likely hypotheses that the points cannot distinguish; none where no change is most probable.

    Only hypotheses with as many changes as the most probable one count: a pair always fits as well as each of its two
    alone.
    """
    likely = [one for one in ranked if len(one.paths) == len(ranked[0].paths) and one.probability > LIKELY_PROBABILITY]
    if ranked[0].path == NO_CHANGE:
        return ()
    pairs = ((one.path, other.path, left[one.paths] - left[other.paths]) for one, other in combinations(likely, 2))
    found = (IndistinguishablePair(one, other, float(np.linalg.norm(apart))) for one, other, apart in pairs)
    return tuple(one for one in found if one.off < DISTINGUISHABLE)


def chance_of_misfit(misfit: float, freedom: int) -> float:
    """Return the probability of a misfit at least as large, by chance."""
    from scipy.stats import chi2

    return float(chi2.sf(misfit, max(freedom, 1)))
