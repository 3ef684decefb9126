"""A quadrature at an angle is read as numpy interpolates it, bit for bit, at the ends of steps and beyond them, too."""

from __future__ import annotations

from typing import Any

import numpy as np

from screwsim.model.trajectory import Trajectory

NOTHING: Any = None


def test_a_sum_at_an_angle_is_that_of_interpolation():
    rng = np.random.default_rng(5)
    steps = 40
    times, quads = np.sort(rng.uniform(0.0, 12.0, steps + 3)), rng.normal(size=(steps + 2, 3))  # with room behind
    life = Trajectory(NOTHING, NOTHING, NOTHING, times, NOTHING, quads, steps, NOTHING, NOTHING, {})
    angles = [-1.0, 20.0, *times[: steps + 1].tolist(), *rng.uniform(0.0, 12.0, 200).tolist()]
    for quadrature in range(3):
        sums = np.append(0.0, quads[:steps, quadrature])
        expected = [float(np.interp(angle, times[: steps + 1], sums)) for angle in angles]
        assert [life.sum_until(angle, quadrature) for angle in angles] == expected
