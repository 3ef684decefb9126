"""How a scene may have its cycle closed: which ways are tried, one after the other.

Another one is an entry here, and what it does as a way of `cycle.ways`.
"""

from typing import NamedTuple


class Closing(NamedTuple):
    """A word of `numerics.closing`: the ways that it tries (`cycle.ways`), whether fallbacks follow, how it is told."""

    ways: tuple[str, ...]
    text: str
    fallbacks: bool = True


WAVEFORMS, TOGETHER = "histories", "coupled"  # as scenes and results call them
AUTO = "auto"
CLOSINGS = {
    AUTO: Closing((WAVEFORMS, TOGETHER), "turn by turn as long as that costs no more than all chambers at once would"),
    WAVEFORMS: Closing((WAVEFORMS,), "one chamber, its neighbours read from its own last life", fallbacks=False),
    TOGETHER: Closing((TOGETHER,), "all chambers alive at once"),
}
