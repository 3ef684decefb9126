"""Feedback unknowns: numbers that a cycle determines and that act back on it, found together with its states.

A turn maps their present values to new ones. They are compared and mixed in coordinates: most as logarithms, like the
states, the others over a scale. Source: docs/explanation/closing.md, feedback unknowns.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Array = np.ndarray
LEAST = 1e-300  # least argument of a logarithm
FLOOR = 1e-4  # default of the least value to which a change is relative


@dataclass(frozen=True)
class FeedbackUnknown:
    """One feedback unknown.

    A positive one is represented by its logarithm, and its change is relative to its value, or to `floor` where it is
    smaller; one that only exceeds −`shift` is represented by the logarithm of value + shift. With `scale` the number
    may have either sign, and its change is relative to that scale. `of` names another entry, an amount, without which
    this one has no meaning: where that amount is at or below its floor, neither counts.
    """

    name: str
    floor: float = FLOOR
    scale: float | None = None
    of: str = ""
    shift: float = 0.0


class FeedbackUnknowns:
    """A vector of feedback unknowns, with the rules for comparing and mixing them."""

    def __init__(self, entries: Sequence[FeedbackUnknown]) -> None:
        self.entries = tuple(entries)
        self.names = tuple(entry.name for entry in entries)
        self.linear = np.array([entry.scale is not None for entry in entries], bool)
        self._mixed = bool(self.linear.any())  # else all are logarithms
        self.scales = np.array([1.0 if entry.scale is None else entry.scale for entry in entries])
        self.floors = np.array([entry.floor for entry in entries])
        self.shifts = np.array([entry.shift for entry in entries])
        self.carried = [(i, self.names.index(entry.of)) for i, entry in enumerate(entries) if entry.of]

    def __len__(self) -> int:
        return len(self.entries)

    def change(self, new: Array, old: Array) -> float:
        """Return the largest change, each relative to its own scale."""
        sizes = np.maximum(old + self.shifts, self.floors)
        with np.errstate(invalid="ignore"):  # a life that failed may leave infinite ones
            changes = np.abs(new - old) / (np.where(self.linear, self.scales, sizes) if self._mixed else sizes)
        for what, amount in self.carried:
            if max(new[amount], old[amount]) <= self.floors[amount]:
                changes[what] = 0.0  # such as the temperature of a negligible amount
        return float(changes.max())

    def coordinates(self, values: Array) -> Array:
        """Return the coordinates that are mixed: logarithms or scaled values; negligible amounts at their floor."""
        found = np.log(np.maximum(values + self.shifts, LEAST))
        if self._mixed:
            found = np.where(self.linear, values / self.scales, found)
        for what, amount in self.carried:
            if values[amount] <= self.floors[amount]:
                found[amount], found[what] = np.log(self.floors[amount]), 0.0
        return found

    def values(self, coordinates: Array, raw: Array) -> Array:
        """Return the values of coordinates; negligible amounts keep their raw values."""
        if self._mixed:
            powers = np.exp(np.where(self.linear, 0.0, coordinates)) - self.shifts
            found = np.where(self.linear, coordinates * self.scales, powers)
        else:
            found = np.exp(coordinates) - self.shifts
        for what, amount in self.carried:
            if raw[amount] <= self.floors[amount]:
                found[amount], found[what] = raw[amount], raw[what]
        return found

    def possible(self, values: Array) -> Array:
        """Return values in which none that is represented by a logarithm is below its lower bound."""
        found = np.maximum(values + self.shifts, LEAST) - self.shifts
        return np.where(self.linear, values, found) if self._mixed else found
