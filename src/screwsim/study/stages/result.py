"""What comes of two stages together: the record, capacities and their COP (docs/model.md M203, M410)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from screwsim.evaluate.performance import NO_POWER, heating
from screwsim.outputs import Figures, Result
from screwsim.scene import Scene


@dataclass(frozen=True)
class ChainResult:
    """Two stages together; `performance` has the names of M200–M203, `stages` the results of both."""

    status: str
    message: str = ""
    stages: tuple[Result, ...] = ()
    scenes: tuple[Scene, ...] = ()
    performance: Figures = field(default_factory=Figures)
    notes: Mapping[str, str] = field(default_factory=dict)  # why a figure is None
    error: Figures = field(default_factory=Figures)  # estimated, of each figure over its scale (M395)
    warnings: tuple[str, ...] = ()  # of the whole; those of a stage are in its result

    def as_json(self) -> dict[str, Any]:
        """Return what `run --json` prints of stages."""
        return {
            "status": self.status,
            "message": self.message,
            "warnings": list(self.warnings),
            "performance": dict(self.performance),
            "error": dict(self.error),
            "notes": dict(self.notes),
            "stages": [result.as_json() for result in self.stages],
        }


Given = tuple[dict[str, float | None], dict[str, str]]  # figures, and why some are None


def capacities(
    cooling: float, power: float, second: Mapping[str, Any], rejected: float | None, unparted: str = ""
) -> Given:
    """Return both capacities [W] and their COP on the power of both stages [W], or None with the reason.

    `second` has the figures of the second stage, whose gas goes to the condenser and gives off `rejected` [J/kg]
    there; None where gas and oil do not part, with the reason `unparted`.
    """
    cop = cooling / power if power > 0.0 else None
    warming, reasons = heating({"shaft_power": power}, second["gas_mass_flow"], rejected, unparted)
    notes = reasons if cop is not None else {"cop": NO_POWER, **reasons}
    return {"cooling_capacity": cooling, "cop": cop, **warming}, notes
