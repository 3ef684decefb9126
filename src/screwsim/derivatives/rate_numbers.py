"""Arguments of the rates besides states and angle: parameters, tables, run-time cells."""

from typing import NamedTuple, Self

import numpy as np

from screwsim.model.run import Machinery

Array = np.ndarray
SMALL = 1e-3  # least size of a state or a cell, for relative steps and residuals


class RateNumbers(NamedTuple):
    """Arguments of rates besides states and angle, or a change of these: parameters, tables and run-time cells."""

    P: Array
    TAB: Array
    R: Array

    @classmethod
    def of(cls, machinery: Machinery) -> Self:
        """Return a copy of those that a machinery holds."""
        c = machinery.composition
        return cls(c.P.copy(), c.TAB.copy(), machinery.R.copy())

    def put(self, machinery: Machinery) -> None:
        """Write these into a machinery, whose tables are a copy of its own."""
        c = machinery.composition
        c.P[:], c.TAB[:], machinery.R[:] = self
        machinery.line_flows.clear()  # they do not know of other tables

    def plus(self, by: float, change: Self) -> Self:
        """Return these plus a multiple of a change."""
        return self._make(one + by * more for one, more in zip(self, change, strict=True))

    def times(self, by: float) -> Self:
        """Return a multiple of these."""
        return self._make(by * one for one in self)

    @property
    def nothing(self) -> bool:
        """Whether this change is zero."""
        return not any(each.any() for each in self)
