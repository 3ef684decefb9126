"""What the scenes of a series leave to the next: what was built, what was composed, the cycles that closed."""

from __future__ import annotations

from screwsim.build import Stock
from screwsim.cycle.continuation import Course
from screwsim.model.compose import Composer


class Series:
    """Scenes that are solved one after the other; any number of series live side by side."""

    def __init__(self) -> None:
        self.stock, self.composer, self.course = Stock(), Composer(), Course()
