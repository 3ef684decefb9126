"""What the surroundings of consecutive scenes were found to be, and where those of the next are expected.

Surroundings are the temperatures of the oil's circuit, a package's pressure losses and other open numbers of a scene,
which `solve.circuit` finds together with the cycle.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from screwsim.build import Temperatures
from screwsim.cycle.trend import DEPTH, DegreeRecord, extrapolation_weights
from screwsim.effects.base import PressureLosses

Array = np.ndarray
FIRST_OPEN = 20.0  # residual expected of a first guess, over the shaft power: its cycle need not close
NOTHING_LEARNT = (None, FIRST_OPEN)


@dataclass
class KnownSurroundings:
    """The last solution, what was learnt on the way to it, and the solutions of the points before."""

    temperatures: Temperatures | None = None  # of the oil
    losses: PressureLosses | None = None  # of a package
    sought: list[float] | None = None  # other open numbers (`screwsim.build.open_values`)
    slopes: Mapping[str, Array] = field(default_factory=dict)  # of the figures with these [SI/K, SI/kPa]
    around: tuple[Array | None, float] = NOTHING_LEARNT  # Jacobian of the unknowns, and the residual of their guess
    _unknowns: int = 0
    _points: list[tuple[Array, Array]] = field(default_factory=list)  # parameters, unknowns
    _stated: Array | bool = True  # which parameters do not depend on the unknowns
    _degrees: DegreeRecord = field(default_factory=DegreeRecord)

    def begin(self, unknowns: int) -> None:
        """Forget what was learnt with another number of unknowns."""
        if unknowns != self._unknowns:
            self.slopes, self.around, self._unknowns = {}, NOTHING_LEARNT, unknowns
            self._forget_points()

    def _forget_points(self) -> None:
        self._points, self._stated, self._degrees = [], True, DegreeRecord()

    def add(self, guess: Array, found: Array, unknowns: Array) -> None:
        """Record a solution: the parameters of its first guess and its own, and the unknowns [K, kPa]."""
        if self._points and len(self._points[0][0]) != len(found):
            self._forget_points()
        told = self._degrees.told
        if told:
            self._degrees.compare([float(np.max(np.abs(each - unknowns))) for each in told.values()])
        self._stated = self._stated & (guess == found)
        self._points = [*self._points, (found, unknowns)][-DEPTH:]

    def expected(self, parameters: Array) -> Array | None:
        """Return the unknowns that the points before let expect for these parameters; None where they show no trend."""
        self._degrees.told = {}
        if len(self._points) < 2 or len(self._points[0][0]) != len(parameters):
            return None
        stated = [each[self._stated] for each, _ in self._points]
        ways = extrapolation_weights(stated, parameters[self._stated])
        (weights, found), *_ = self._degrees.tell(ways, np.array([unknowns for _, unknowns in self._points]))
        return found if len(weights) > 1 else None
