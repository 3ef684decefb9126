"""The ways to estimate the errors of a scene's figures: which finer solutions are tried, one after the other.

A new way is an entry here, with its implementation as an estimate in `solve.estimate`.
"""

from typing import NamedTuple


class ErrorOption(NamedTuple):
    """An option of `numerics.error`: the estimates that it tries (`solve.estimate.ESTIMATES`), and its description."""

    by: tuple[str, ...]
    text: str


ESTIMATE, NONE = "estimate", "none"  # as scenes call them
TOGETHER, LIVES, AGAIN = "chambers together", "finer lives", "closed again"
ERRORS = {
    ESTIMATE: ErrorOption(
        (TOGETHER, LIVES, AGAIN),
        "the numerical error of each figure is estimated, and the cycle closed again until it is within the accuracy",
    ),
    NONE: ErrorOption((), "no estimate, which is faster"),
}
