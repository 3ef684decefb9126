"""What a scene says of the numerical solution."""

from dataclasses import dataclass

from screwsim.inputs.declare import choice, number
from screwsim.numerics.closings import AUTO, CLOSINGS
from screwsim.numerics.estimates import ERRORS, ESTIMATE
from screwsim.numerics.integrators import DEFAULT, INTEGRATORS


@dataclass(frozen=True)
class NumericsSettings:
    """Wanted accuracy, integrator and the way in which the cycle is closed."""

    accuracy: float = number("wanted relative accuracy of the performance figures", 3e-4, gt=1e-12, lt=0.1)
    integrator: str = choice(
        "rodas4, or one of scipy's as an independent check", tuple(INTEGRATORS), DEFAULT, own="INTEGRATOR"
    )
    closing: str = choice(
        "auto: histories as long as they cost no more than coupled chambers would", tuple(CLOSINGS), AUTO
    )
    rtol: float | None = number("relative tolerance of a step (expert; default: from accuracy)", None, gt=1e-14, lt=0.1)
    error: str = choice("; ".join(f"{name}: {each.text}" for name, each in ERRORS.items()), tuple(ERRORS), ESTIMATE)

    @property
    def estimates(self) -> bool:
        """Tell whether the error of each figure is estimated."""
        return bool(ERRORS[self.error].by)
