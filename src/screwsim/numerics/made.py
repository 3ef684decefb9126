"""Feedback unknowns: numbers that a cycle makes and that act back on it. They are closed together with the states.

One turn maps them to the next. They are compared and mixed in coordinates: most of them as logarithms, as the states
are, the others over a scale. Source: docs/explanation/closing.md, feedback unknowns.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Array = np.ndarray
LEAST = 1e-300  # of what must be positive for its logarithm
FLOOR = 1e-4  # what a change counts against at the least, where an entry does not say


@dataclass(frozen=True)
class Entry:
    """One number that the cycle makes.

    A positive one goes in its logarithm and its change is relative, with `floor` the least that it counts against; one
    that exceeds −`shift` does so together with that. Where `scale` is given the number is any, and its change counts
    over that scale. `of` names the entry, an amount, without which this one has no meaning: where that is at its floor
    or below, neither counts.
    """

    name: str
    floor: float = FLOOR
    scale: float | None = None
    of: str = ""
    shift: float = 0.0


class Entries:
    """A vector of numbers that the cycle makes, and how they are compared and mixed."""

    def __init__(self, entries: Sequence[Entry]) -> None:
        self.entries = tuple(entries)
        self.names = tuple(entry.name for entry in entries)
        self.linear = np.array([entry.scale is not None for entry in entries], bool)
        self._mixed = bool(self.linear.any())  # or all in logarithms
        self.scales = np.array([1.0 if entry.scale is None else entry.scale for entry in entries])
        self.floors = np.array([entry.floor for entry in entries])
        self.shifts = np.array([entry.shift for entry in entries])
        self.carried = [(i, self.names.index(entry.of)) for i, entry in enumerate(entries) if entry.of]

    def __len__(self) -> int:
        return len(self.entries)

    def change(self, new: Array, old: Array) -> float:
        """Return the largest change, each over its own measure."""
        sizes = np.maximum(old + self.shifts, self.floors)
        changes = np.abs(new - old) / (np.where(self.linear, self.scales, sizes) if self._mixed else sizes)
        for what, amount in self.carried:
            if max(new[amount], old[amount]) <= self.floors[amount]:
                changes[what] = 0.0  # the temperature of next to nothing
        return float(changes.max())

    def coordinates(self, values: Array) -> Array:
        """Return what is mixed: logarithms, or values over their scale; an amount too small to count is its floor."""
        found = np.log(np.maximum(values + self.shifts, LEAST))
        if self._mixed:
            found = np.where(self.linear, values / self.scales, found)
        for what, amount in self.carried:
            if values[amount] <= self.floors[amount]:
                found[amount], found[what] = np.log(self.floors[amount]), 0.0
        return found

    def values(self, coordinates: Array, raw: Array) -> Array:
        """Return the values of coordinates; amounts too small to count keep their raw values."""
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
        """Return values of which none that goes in its logarithm is below nothing."""
        found = np.maximum(values + self.shifts, LEAST) - self.shifts
        return np.where(self.linear, values, found) if self._mixed else found
