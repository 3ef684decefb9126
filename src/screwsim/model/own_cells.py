"""What a chamber keeps beside its states, in its array `own`: where each of it stands."""

from itertools import accumulate
from typing import NamedTuple

from screwsim.model.slots import PORT_STATE

# behind what moves between seat and stop: impacts of a turn, and the angles of the attempted step; then the oil [kg/s]
# that flows in at the start of a step and at its last stage
AFTER_STOPS = ("IMPACTS", "STEP_BEGIN", "STEP_END")
FED = ("FED_FIRST", "FED_LAST")


class OwnCells(NamedTuple):
    """The cells behind a chamber's own port state, as slices of `own`, and how many there are in all."""

    phase: slice  # in which its gas is held for a step: 0, 1, or FREE
    opened: slice  # open share of each port
    held: slice  # of each port, whether its switch is held open or shut, or FREE
    modes: slice  # of each that moves between seat and stop: where it rests, or that it moves
    due: slice  # of each of these, the event that the step ends with
    after_stops: slice  # AFTER_STOPS
    fed: slice  # FED
    size: int

    @property
    def impacts(self) -> int:
        """The cell with the impact events of a turn."""
        return self.after_stops.start + AFTER_STOPS.index("IMPACTS")

    @property
    def holding(self) -> slice:
        """All that a chamber is held in: from the phase to the modes."""
        return slice(self.phase.start, self.modes.stop)


def own_cells(ports: int, stops: int) -> OwnCells:
    """Return the cells of a chamber with so many ports, and so many parts between seat and stop."""
    counts = 1, ports, ports, stops, stops, len(AFTER_STOPS), len(FED)
    *starts, size = accumulate(counts, initial=PORT_STATE)
    return OwnCells(*(slice(at, at + count) for at, count in zip(starts, counts, strict=True)), size=size)
