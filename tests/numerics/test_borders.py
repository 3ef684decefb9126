"""A right-hand side that changes its form at a border of the state, as a gas's does at saturation."""

import math

import numpy as np
import pytest
from flat import Problem, integrate

from screwsim.numerics import rodas

STEEP, FLAT = 200.0, 4.0  # rates of decay to 1 above and below the border
BORDER = 1.5
START = 2.0


def held() -> Problem:
    """y' = -k (y - 1), k = STEEP above BORDER and FLAT below it; the form is held during a step."""
    form = [0]

    def k():
        return STEEP if form[0] == 0 else FLAT

    def rates(phi, y):
        return (-k() * (y[0] - 1.0),), (y[0],)

    def slopes(phi, y):
        form[0] = int(y[0] < BORDER)
        return ((-k(),),), ((1.0,),)

    def share(y, y1, u, rtol):
        if int(y1[0] < BORDER) == form[0]:
            return 1.0
        thetas = np.linspace(0.0, 1.0, 100_001)
        path = rodas.dense_value(thetas, y[0], y1[0], *rodas.dense_coefficients(u, 0))
        first = int(np.argmax((path < BORDER) != form[0]))
        beyond = abs(path[first] - y1[0]) / y1[0]
        return 1.0 if beyond <= rtol else min(float(thetas[first]) + 0.3 * rtol, 1.0 - 1e-12)

    return Problem(rates, slopes, share=share)


def exact(phi: float) -> float:
    crossing = math.log((START - 1.0) / (BORDER - 1.0)) / STEEP
    return 1.0 + (BORDER - 1.0) * math.exp(-FLAT * (phi - crossing))


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-7])
def test_a_step_ends_at_the_border_and_the_error_follows_the_tolerance(rtol):
    path = integrate(held(), (0.0, 0.5), (START,), rtol=rtol, h=0.1)
    assert path.status == rodas.OK
    assert abs(path.y[0] - exact(0.5)) < 20 * rtol  # errors of some tens of steps, and of passing the border
    values = path.dense[:, :, 0]
    crossed = [(a, b) for a, b in zip(values[:, 0], values[:, 1], strict=True) if a >= BORDER > b]
    assert len(crossed) == 1
    assert crossed[0][1] >= BORDER * (1.0 - 2.0 * rtol)


def test_the_border_costs_few_steps():
    with_border = integrate(held(), (0.0, 0.5), (START,), rtol=1e-6, h=0.1)
    assert with_border.counts[0] + with_border.counts[1] < 150  # a method that feels its way over it needs more
