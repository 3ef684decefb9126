"""What flows back to a suction line is what the chamber's gas loses beyond what other paths bring."""

import pytest
from scenes import closed, make
from test_suction_line import LINE, SOLUBLE_RATE

from screwsim.cycle.balances import streams_of
from screwsim.model.slots import OF_GAS, SUCTION_IN, SUCTION_OUT
from screwsim.solve.misread_intake import misread_return

SLOW, COARSE, FINE = {"operation.speed": "600 rpm"}, 3e-4, 3e-6
MORE = 1e-3  # of what flows back


def cycle_of(accuracy, **more):
    """Return a machine whose slide returns gas, closed to an accuracy, and what flows back [kg/life]."""
    problem, _, cycle = closed(make({**LINE, **SLOW, **more, "numerics": {"accuracy": accuracy}}))
    return problem, cycle, -float(streams_of(problem.composition, cycle.q)[SUCTION_OUT, OF_GAS])


def test_long_steps_misread_what_flows_back_and_short_ones_do_not():
    problem, cycle, back = cycle_of(COARSE)
    assert misread_return(problem, cycle.trajectory, cycle.q) > 0.5 * COARSE * back
    problem, cycle, back = cycle_of(FINE)
    assert misread_return(problem, cycle.trajectory, cycle.q) < 0.02 * COARSE * back


def test_gas_that_seems_to_pass_both_ways_is_found_whatever_the_balance_says():
    problem, cycle, back = cycle_of(FINE)
    q = cycle.q.copy()
    for stream, sign in ((SUCTION_IN, 1.0), (SUCTION_OUT, -1.0)):
        streams_of(problem.composition, q)[stream, OF_GAS] += sign * MORE * back
    assert misread_return(problem, cycle.trajectory, q) == pytest.approx(MORE * back, rel=0.01)


def test_nothing_is_read_where_oil_gives_off_gas():
    problem, cycle, _ = cycle_of(COARSE, **SOLUBLE_RATE)
    assert misread_return(problem, cycle.trajectory, cycle.q) == 0.0
