"""How the errors of a scene's figures may be estimated: by which finer solutions, one after the other.

Another one is an entry here, and what it does as an estimate of `solve.estimate`.
"""

from typing import NamedTuple


class Estimated(NamedTuple):
    """A word of `numerics.error`: the estimates that it tries (`solve.estimate.ESTIMATES`), and how it is told."""

    by: tuple[str, ...]
    text: str


ESTIMATE, NONE = "estimate", "none"  # as scenes call them
TOGETHER, LIVES, AGAIN = "chambers together", "finer lives", "closed again"
ERRORS = {
    ESTIMATE: Estimated(
        (TOGETHER, LIVES, AGAIN),
        "the numerical error of each figure, and closing again until it is within the accuracy",
    ),
    NONE: Estimated((), "faster"),
}
