"""What comes of two stages together."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

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
