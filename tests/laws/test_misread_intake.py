"""A chamber that exchanges gas with its line by the stages of its steps, or misses a neighbour, holds too much gas."""

import pytest
from effects_space import scene_of
from scenes import closed, make

from screwsim.model.slots import R_TRAPPED
from screwsim.scene import with_values
from screwsim.solve.misread_intake import NOTHING, misread_by_all, misread_intake
from screwsim.solve.sums_met_twice import sums_met_twice

FINER = 50.0


def trapped_and_misread(scene, closing):
    """Return the trapped gas [kg] beyond that of a finer cycle, what is read of it, and the same of the finer one."""
    found = []
    for finer in (1.0, FINER):
        accuracy = scene.numerics.accuracy / finer
        problem, _, cycle = closed(with_values(scene, {"numerics.closing": closing, "numerics.accuracy": accuracy}))
        life = cycle.trajectory
        if closing == "coupled":
            misread = misread_by_all(problem, life, cycle.q)
        else:
            misread = misread_intake(problem, life, sums_met_twice(problem, life))
        found.append((float(life.R[R_TRAPPED]), misread.held))
    (trapped, misread), (true, of_finer) = found
    return (trapped - true) / true, misread / true, of_finer / true


@pytest.mark.parametrize("closing", ["histories", "coupled"])
def test_gas_that_stages_exchange_with_the_line_cools_the_chamber(closing):
    """A hot machine with walls: what flows back leaves at 1.3 times the temperature of the line."""
    more, misread, of_finer = trapped_and_misread(scene_of("walls", 713, 9), closing)
    assert 0.5 < misread / more < 1.5  # at the mean temperature of each step, or of what flows back
    assert abs(of_finer) < 0.1 * misread


def test_a_neighbour_that_opens_to_its_line_within_a_step_is_missed():
    """Within 37 degrees the fourth chamber ahead is filled from the discharge line; the step takes too much from it."""
    scene = scene_of("drive", 715, 0)
    scene = with_values(scene, {"operation.speed": 3.0 * scene.operation.speed})
    more, misread, of_finer = trapped_and_misread(scene, "histories")
    assert more < 0.0  # warm gas, in place of gas of the line
    assert 0.4 < misread / more < 1.5
    assert abs(of_finer) < 0.05 * abs(misread)


def test_an_expanders_port_makes_good_what_its_chamber_misses():
    """The one behind is filled within the first degrees of its life, which are one step of its neighbour."""
    problem, _, cycle = closed(scene_of("expander", 708, 20))
    life = cycle.trajectory
    drawn = misread_intake(problem, life, sums_met_twice(problem, life)).drawn / float(life.R[R_TRAPPED])
    assert 0.5 < drawn / problem.scene.numerics.accuracy < 1.5  # 0.81 is what it draws too much


def test_what_flows_back_after_the_chamber_has_left_the_line_is_no_exchange():
    """A hole of an own effect lets gas out to the line beyond the angle of injection; all chambers together."""
    scene = scene_of("own effect, carried", 743, 10)
    problem, _, cycle = closed(with_values(scene, {"numerics.closing": "coupled"}))
    life = cycle.trajectory
    assert abs(misread_by_all(problem, life, cycle.q).held) < 0.1 * scene.numerics.accuracy * float(life.R[R_TRAPPED])


def test_nothing_is_misread_by_short_steps():
    problem, _, cycle = closed(make({"numerics": {"accuracy": 1e-6}}))
    life = cycle.trajectory
    held = misread_intake(problem, life, sums_met_twice(problem, life)).held
    assert abs(held) <= 0.05 * 1e-6 * float(life.R[R_TRAPPED])


def test_nothing_is_read_of_oil_that_gives_off_gas():
    problem, _, cycle = closed(with_values(scene_of("solubility over time", 713, 0), {"numerics.closing": "coupled"}))
    assert misread_by_all(problem, cycle.trajectory, cycle.q) == NOTHING
