"""What the sums of a life misread of the heat of the oil that flows out: beside other readings of the same life."""

import numpy as np
import pytest
from scenes import CARRIED, SOLUBLE_RATE, closed, make

from screwsim.cycle.balances import streams_of
from screwsim.evaluate.evaluation import evaluate
from screwsim.model import slots
from screwsim.solve.outflow_heat import misread_of_oil


def misread(problem, life):
    """Return the error of the temperature [K] of the oil that flows out."""
    return misread_of_oil(problem, life).temperature


@pytest.fixture(scope="module")
def life():
    problem, _, cycle = closed(make(CARRIED))
    return problem, cycle


def test_sums_of_a_usual_machine_misread_next_to_nothing(life):
    problem, cycle = life
    T = evaluate(problem, cycle).figures.oil_discharge_temperature
    assert 0.0 < misread(problem, cycle.trajectory) < 0.05 * problem.scene.numerics.accuracy * T


def test_heat_that_is_put_into_the_sums_is_found_over_the_oil_that_is_delivered(life):
    """A kelvin more of what leaves in all steps shows as more of what is delivered, as some of it flows back."""
    problem, cycle = life
    c, told = problem.composition, cycle.trajectory
    quads = told.quads[: told.steps].copy()
    column = c.stream(slots.DISCHARGE_OUT)
    quads[:, column + slots.OF_OIL_HEAT] += quads[:, column + slots.OF_OIL]
    oil = streams_of(c, cycle.q)[:, slots.OF_OIL]
    out, back = -oil[slots.DISCHARGE_OUT], oil[slots.DISCHARGE_IN]
    assert out > 0.0
    wrong = misread(problem, told._replace(quads=quads))
    assert wrong == pytest.approx(out / (out - back), abs=2.0 * misread(problem, told))  # both readings err


def test_the_states_within_steps_give_the_heat_that_a_far_finer_life_sums():
    """Both ways of reading it agree the better the shorter the steps are."""
    at = [closed(make({**CARRIED, "numerics.rtol": rtol})) for rtol in (1e-4, 1e-6)]
    coarse, fine = (misread(problem, cycle.trajectory) for problem, _, cycle in at)
    assert fine < 0.3 * coarse
    assert np.isfinite(coarse)


def test_dissolved_gas_that_is_put_into_the_sums_is_found_likewise():
    problem, _, cycle = closed(make(SOLUBLE_RATE))
    c, told, more = problem.composition, cycle.trajectory, 0.01
    quads = told.quads[: told.steps].copy()
    column = c.stream(slots.DISCHARGE_OUT)
    quads[:, column + slots.OF_HELD] += more * quads[:, column + slots.OF_OIL]
    oil = streams_of(c, cycle.q)[:, slots.OF_OIL]
    out, back = -oil[slots.DISCHARGE_OUT], oil[slots.DISCHARGE_IN]
    right = misread_of_oil(problem, told).held
    assert 0.0 < right < 0.01 * more
    assert misread_of_oil(problem, told._replace(quads=quads)).held == pytest.approx(
        more * out / (out - back), abs=2.0 * right
    )


def test_oil_that_holds_no_gas_misreads_none(life):
    problem, cycle = life
    assert misread_of_oil(problem, cycle.trajectory).held == 0.0
