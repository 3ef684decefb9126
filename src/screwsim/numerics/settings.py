"""The settings of the numerical solution in a scene, and what each option tries in turn to close or estimate.

A new option is an entry here, with its implementation as a way of `cycle.ways` or an estimate in `solve.estimate`.
"""

from dataclasses import dataclass
from typing import NamedTuple

from screwsim.inputs.declare import choice, number
from screwsim.numerics.integrators import DEFAULT, INTEGRATORS


class ErrorOption(NamedTuple):
    """An option of `numerics.error`: the estimates that it tries (`solve.estimate.ESTIMATES`), and its description."""

    by: tuple[str, ...]
    text: str


ESTIMATE, NONE = "estimate", "none"  # as scenes call them
CHAMBERS, LIVES, AGAIN = "chambers together", "finer lives", "closed again"
ERRORS = {
    ESTIMATE: ErrorOption(
        (CHAMBERS, LIVES, AGAIN),
        "the numerical error of each figure is estimated, and the cycle closed again until it is within the accuracy",
    ),
    NONE: ErrorOption((), "no estimate, which is faster"),
}


class Closing(NamedTuple):
    """An option of `numerics.closing`: the ways that it tries (`cycle.ways`), its text, whether fallbacks follow."""

    ways: tuple[str, ...]
    text: str
    fallbacks: bool = True


WAVEFORMS, TOGETHER = "histories", "coupled"  # as scenes and results call them
AUTO = "auto"
CLOSINGS = {
    AUTO: Closing((WAVEFORMS, TOGETHER), "turn by turn, as long as that costs no more than all chambers at once"),
    WAVEFORMS: Closing((WAVEFORMS,), "one chamber, with neighbours read from its own previous life", fallbacks=False),
    TOGETHER: Closing((TOGETHER,), "all chambers alive at once"),
}


@dataclass(frozen=True)
class NumericsSettings:
    """Wanted accuracy, integrator and the method by which the cycle is closed."""

    accuracy: float = number("wanted relative accuracy of the performance figures", 3e-4, gt=1e-12, lt=0.1)
    integrator: str = choice(
        "rodas4, or one of scipy's as an independent check", tuple(INTEGRATORS), DEFAULT, own="INTEGRATOR"
    )
    closing: str = choice("auto: histories, as long as that costs no more than coupled chambers", tuple(CLOSINGS), AUTO)
    rtol: float | None = number(
        "relative tolerance of a step (for experts; default: from accuracy)", None, gt=1e-14, lt=0.1
    )
    error: str = choice("; ".join(f"{name}: {each.text}" for name, each in ERRORS.items()), tuple(ERRORS), ESTIMATE)

    @property
    def estimates(self) -> bool:
        """Whether the error of each figure is estimated."""
        return bool(ERRORS[self.error].by)
