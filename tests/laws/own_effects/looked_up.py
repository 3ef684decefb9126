"""A user's effect: heat from the oil by a conductance that a table holds for every bar of the chamber's pressure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from screwsim.effects.base import Effect, HeatRate
from screwsim.inputs.declare import count
from screwsim.numerics.kernel import kernel

SIZES = np.linspace(2e-3, 15e-3, 100)


@dataclass(frozen=True)
class Parameters:
    """Where in the table the lowest pressures are."""

    first: int = count("place of the pressures below 1 bar", 0)


@kernel
def size_at(p, first):
    """Return the conductance [W/K] at a pressure [Pa]."""
    return SIZES[int(p * 1e-5) + int(first)]


@kernel
def heat(p, T, T_oil, first):
    """Return the heat rate [W] from the oil; the conductance is at most 0.01 W/K."""
    return min(size_at(p, first), 0.01) * (T_oil - T)


def build(parameters: Parameters, machine) -> list[HeatRate]:
    return [HeatRate(heat, {"first": float(parameters.first)})]


EFFECT = Effect(
    name="looked_up",
    title="heat by a table",
    equations=(),
    source="a test",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    states=("T_oil",),
)
