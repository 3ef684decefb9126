"""A user's effect: a wall of constant conductance, at the temperature where a cycle neither warms nor cools it."""

from __future__ import annotations

from dataclasses import dataclass

from screwsim.effects.base import Effect, FeedbackUnknown, Made, Scaled, Turn, Wall
from screwsim.inputs.declare import number
from screwsim.numerics.kernel import kernel


@dataclass(frozen=True)
class Parameters:
    """The conductance, and how much a blow-hole widens with the wall."""

    conductance: float = number("between the gas of one chamber and the wall [W/K]", gt=0.0)
    widening: float = number("of the blow-hole per K above 280 K", 0.0)


@kernel
def conductance(size, V, m):
    """Return the conductance [W/K]: constant, whatever volume and mass are."""
    return size * (V + m) / (V + m)


def build(parameters: Parameters, machine) -> list[Made | Wall | Scaled]:
    def settled(turn: Turn) -> float:
        """Return the temperature [K] at which the turn's heat would have been none."""
        return turn.made["wall_temperature"] - turn.heat["wall"] / turn.conductance["wall"]

    def wider(turn: Turn) -> float:
        return 1.0 + parameters.widening * (turn.made["wall_temperature"] - 280.0)

    return [
        Made(FeedbackUnknown("wall_temperature"), lambda site: site.T_s, settled),
        Made(FeedbackUnknown("blow_hole_scale", scale=1.0), lambda site: 1.0, wider),
        Wall("wall", conductance, {"size": parameters.conductance}, "wall_temperature"),
        Scaled("blow_hole", "blow_hole_scale"),
    ]


EFFECT = Effect(
    name="warm_wall",
    title="wall of constant conductance",
    equations=("M170",),
    source="a test",
    parameters=Parameters,
    build=build,
)
