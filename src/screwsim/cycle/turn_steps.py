"""The tolerance of the steps of a turn of waveform relaxation (docs/explanation/closing.md)."""

import math

from screwsim.cycle.mixing import refined_rtol

FIRST_RTOL = 2e-3  # tolerance of a step in the first turn; later ones follow the gap
GOOD_GUESS = 0.1  # gap of a guess up to which a loose first turn would do more harm than it saves
TIGHTENING = 0.3  # largest ratio of a turn's tolerance to that of the turn before
RTOL_OF_GAP = 0.015  # tolerance of a turn over the gap of the one before
AFTER_CORRECTION = 1e-3  # tolerance of a turn over the change that the correction before it made
STALL = 2  # turns near the end without progress, after which steps are refined
PROGRESS = 0.5  # ratio to the smallest gap before, below which a gap is progress (NOISE_RATIO without corrections)
NOISE_RATIO = 0.9  # ratio of a turn's change to that of the turn before, above which it is noise of the steps
REFINEMENT = 0.4  # factor on the tolerance of the steps then


class StepTolerance:
    """The tolerance of a turn's steps: loose at first, then after the gap, never below the `finest`.

    The finest is the wanted tolerance, until the error of the steps is all that is left.
    """

    def __init__(self, finest: float, gap: float) -> None:
        """`gap` is that expected of the guess."""
        self.finest = self.now = finest
        self._next = finest if gap <= GOOD_GUESS else FIRST_RTOL
        self.least_gap, self.stalled = math.inf, 0  # smallest gap near the end, and turns since without progress

    def begin(self) -> float:
        """Return the tolerance of the turn that begins."""
        self.now = max(self.finest, self._next)
        return self.now

    @property
    def fine(self) -> bool:
        """Whether the last turn had the finest steps."""
        return self.now <= self.finest

    def follow(self, gap: float) -> None:
        """Set the tolerance of the next turn after one that was not corrected."""
        self._next = min(TIGHTENING * self.now, RTOL_OF_GAP * gap)

    def follow_correction(self, left: float) -> None:
        """Set the tolerance of the next turn after a correction, by the change still to come."""
        self._next = AFTER_CORRECTION * left

    def refine(self, residual: float) -> None:
        """Refine the steps where their error keeps balances open; `residual` is the largest one over its bound."""
        self.finest = refined_rtol(self.finest, residual)

    def watch(self, gap: float, corrected: bool) -> None:
        """Note a turn near the end; refine the steps where `STALL` turns have made no progress."""
        if gap < (PROGRESS if corrected else NOISE_RATIO) * self.least_gap:
            self.least_gap, self.stalled = gap, 0
            return
        self.stalled += 1
        if self.stalled > STALL:
            self.finest, self.least_gap, self.stalled = REFINEMENT * self.finest, math.inf, 0

    def swings(self, gap: float) -> bool:
        """Return whether corrected turns near the end go back and forth: this one is hardly nearer than another was."""
        return self.stalled > 0 and gap > PROGRESS * self.least_gap
