"""Warnings on valves with mass that shut late or bounce, so that gas flows back through them (S25, S26)."""

from collections.abc import Iterator

import numpy as np

from screwsim.effects.base import DISCHARGE, SUCTION, Stops
from screwsim.evaluate.evaluation import Evaluation
from screwsim.model.slots import DISCHARGE_IN, OF_GAS, SUCTION_IN, SUCTION_OUT

LATE = 0.05  # gas back through a valve, over the net gas, that deserves a warning; of valves that suit, below 0.02
ANGLES = 721  # of a turn, at which the flow through a valve is read


def warnings(of: Evaluation) -> Iterator[str]:
    """Yield a warning for each valve through which much of the gas flows back."""
    parts, gas = of.problem.parts, of.streams[:, OF_GAS]
    valves, net = [name for name, _ in parts.all(Stops)], float(gas[SUCTION_IN] + gas[SUCTION_OUT])
    if not valves or net <= 0.0:
        return
    for line, back in ((SUCTION, -gas[SUCTION_OUT]), (DISCHARGE, gas[DISCHARGE_IN])):
        if back < LATE * net:  # with what leaks beside the valve
            continue
        share = _share_back(of, valves[0], line)
        if share >= LATE:
            yield (
                f"{share:.0%} of the gas delivered has flowed back through the {line} valve, which shuts late or "
                f"bounces off its seat; between such states figures change abruptly (a lighter reed or a smaller stop: "
                f"effects.{valves[0]}.{line}_mass, {line}_stop)"
            )


def _share_back(of: Evaluation, valve: str, line: str) -> float:
    """Return the gas that flows back through one valve of a turn, over the net gas through it."""
    angles = np.linspace(0.0, of.problem.parts.geometry.life, ANGLES)
    _, flows = of.life.sample(angles)
    columns = [i for i, (name, path) in enumerate(of.problem.parts.ports) if name == valve and path.to == line]
    flow = flows[:, columns].sum(axis=1) * (1.0 if line == SUCTION else -1.0)  # in the valve's own direction
    net = float(np.trapezoid(flow, angles))
    return float(np.trapezoid(np.maximum(-flow, 0.0), angles)) / net if net > 0.0 else 0.0
