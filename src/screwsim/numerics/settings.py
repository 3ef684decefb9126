"""What a scene says of the numerical solution."""

from __future__ import annotations

from dataclasses import dataclass

from screwsim.inputs.declare import choice, number
from screwsim.numerics.closings import AUTO, CLOSINGS
from screwsim.numerics.integrators import DEFAULT, INTEGRATORS

ESTIMATE = "estimate"  # what `numerics.error` says


@dataclass(frozen=True)
class NumericsSettings:
    """Wanted accuracy, integrator and the way in which the cycle is closed."""

    accuracy: float = number("wanted relative accuracy of the performance figures", 3e-4, gt=1e-12, lt=0.1)
    integrator: str = choice(
        "rodas4, or one of scipy's as an independent check", tuple(INTEGRATORS), DEFAULT, own="INTEGRATOR"
    )
    closing: str = choice(
        "auto: histories as long as they cost no more than coupled chambers would",
        tuple(CLOSINGS),
        AUTO,
    )
    rtol: float | None = number("relative tolerance of a step (expert; default: from accuracy)", None, gt=1e-14, lt=0.1)
    error: str = choice(
        "estimate: the numerical error of each figure, and closing again until it is within the accuracy; none: faster",
        (ESTIMATE, "none"),
        ESTIMATE,
    )

    @property
    def estimates(self) -> bool:
        """Tell whether the error of each figure is estimated."""
        return self.error == ESTIMATE
