"""Whether anything can be simulated beyond the end of a range, at which a best value lies."""

from collections.abc import Callable
from typing import Protocol

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene.values import text_of
from screwsim.study.varied import Varied, leaf_of, read_value

STEP = 0.01  # of the range, beyond its end
LOWER, UPPER = "lower border", "upper border"


class Range(Protocol):
    """Values [SI] that a study searches, evenly or in the logarithm."""

    @property
    def low(self) -> float: ...

    @property
    def high(self) -> float: ...

    @property
    def logarithmic(self) -> bool: ...


def value_beyond(span: Range, border: str) -> float:
    """Return the value [SI] that lies a hundredth of a range beyond one of its borders."""
    end, step = (span.high, STEP) if border == UPPER else (span.low, -STEP)
    if span.logarithmic:
        return float(end * (span.high / span.low) ** step)
    return float(end + step * (span.high - span.low))


def refusal_beyond(scene: Varied, path: str, value: float, solved: Callable[[], Result]) -> str:
    """Return why there is no solution at a value [SI] beyond a range; '' where there is one.

    `solved` simulates the value; it is called only where the path may have it.
    """
    leaf = leaf_of(scene, path)
    try:
        read_value(scene, path, value if leaf.dimension is None else text_of(leaf, value))
    except UsageError as refused:
        return str(refused)
    result = solved()
    return "" if result.status == "ok" else result.told


def border_note(border: str, beyond: str, remedy: str = "") -> str:
    """Return what a best value at a border of its range means: nothing lies beyond, or the range is to be widened."""
    if beyond:
        return f"at the {border} of the range, beyond which there is no solution: {beyond}"
    return f"at the {border} of the range; a better value may lie beyond, so widen it{remedy}"
