"""What the sums of a life misread of the heat of the gas that flows out, where most of it flows back."""

import pytest
from scenes import closed, make

from screwsim.cycle.balances import outflow_of, streams_of
from screwsim.model import slots
from screwsim.solve.outflow_heat import misread_of_gas as misread

IDLE = {"oil.transport": "carried", "operation.speed": "250 rpm", "oil_supply.ratio": 0.09}  # leaks take all
FLOODED = {"oil.transport": "carried"}


def of_scene(changes):
    """Return problem, life and quadratures of a closed scene."""
    problem, _, cycle = closed(make(changes))
    return problem, cycle.trajectory, cycle.q


@pytest.fixture(scope="module")
def idle():
    return of_scene({**IDLE, "numerics.closing": "coupled"})


def test_heat_that_is_put_into_the_sum_of_what_flows_out_is_found(idle):
    problem, life, q = idle
    c, more = problem.composition, q.copy()
    row = c.stream(slots.DISCHARGE_OUT)
    more[row + slots.OF_ENERGY] += 1e4 * more[row + slots.OF_GAS]  # each kilogram leaves with 10 kJ more
    assert misread(problem, life, more) == pytest.approx(1e4, abs=2.0 * misread(problem, life, q))


def test_gas_that_leaves_through_gaps_beyond_the_last_chamber_is_read(idle):
    """It is 3 % of what flows out; without it the heat seemed to be off by as much, however fine the steps."""
    problem, life, q = idle
    mean = outflow_of(streams_of(problem.composition, q))
    assert misread(problem, life, q) < 1e-4 * mean.enthalpy


def test_it_falls_with_the_steps():
    coarse, fine = (misread(*of_scene({**IDLE, "numerics.rtol": rtol})) for rtol in (1e-4, 1e-6))
    assert 0.0 < fine < 0.3 * coarse


def test_nothing_is_read_where_the_gas_is_delivered():
    assert misread(*of_scene(FLOODED)) == 0.0
