"""A bore back to suction that opens until the machine delivers a wanted share of its displacement."""

import math
from dataclasses import dataclass

from screwsim.effects.base import Effect, Sought, Span
from screwsim.effects.bypass import window
from screwsim.inputs.declare import FoundWithCycle, number

FOLD = 10.0  # [K] of the coordinate for a factor e of the opening


@dataclass(frozen=True)
class Parameters(Sought):
    """The bore, and what is wanted."""

    delivered: float = number("share of the displacement that is to be delivered", gt=0.0)
    opening: float | None = number("share of the bore's area that is open", None, gt=0.0, le=1.0)

    @property
    def is_open(self):
        return True

    @property
    def stands(self):
        return FOLD * math.log(self.opening) if self.opening else None

    def span(self, facts, suction_pressure):
        return Span(FOLD * math.log(1e-4), 0.0)

    def first(self, span):
        return FOLD * math.log(0.1)

    def placed(self, x):
        return {"opening": FoundWithCycle(math.exp(x / FOLD))}

    def off(self, figures, oil_follows):
        share = figures.get("volumetric_efficiency")
        return None if not share or share <= 0.0 else (3.0 * FOLD * math.log(share / self.delivered), FOLD)

    def idle(self, figures, x, lowest):
        return f"the bore stands at its {'lowest' if lowest else 'highest'}"


def build(parameters, machine):
    """Return the bore."""
    return [window((parameters.opening or 1.0) * 5e-4, math.radians(400.0), math.radians(470.0), 0.7)]


EFFECT = Effect("metered", "a bore for a wanted delivery", (), "a test", Parameters, build)
