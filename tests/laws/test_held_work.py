"""Work at a held pressure is that pressure times the change of the volume, however long the steps are."""

from dataclasses import replace

import pytest
from cylinder_scenes import RPM, cylinder
from scenes import closed

from screwsim.cycle.held_work import DIFFERS, missed_work
from screwsim.model.slots import Q_WORK

EXACT = 1e-9  # tolerance of a step at which the sums are right to 1e-4 accuracies


def work_of(rpm, area, discharge, rtol=None):
    """Return the work of a life [J] as it is summed, what is to be added, and the wanted accuracy."""
    scene = cylinder(
        operation__speed=rpm * RPM,
        operation__discharge__pressure=discharge,
        effects__check_valves__suction_area=area,
        effects__check_valves__discharge_area=area,
    )
    problem, _, cycle = closed(replace(scene, numerics=replace(scene.numerics, rtol=rtol)))
    return float(cycle.q[Q_WORK]), missed_work(problem, cycle.trajectory), scene.numerics.accuracy


@pytest.mark.parametrize("rpm, area", [(1500.0, 8e-4), (300.0, 2e-4)])
def test_work_while_a_valve_holds_the_pressure_is_that_of_short_steps(rpm, area):
    """A low ratio of pressures: while wide valves are open, steps are as long as a sixth of a turn."""
    summed, missed, accuracy = work_of(rpm, area, 1.3e5)
    true, none, _ = work_of(rpm, area, 1.3e5, EXACT)
    assert none == 0.0
    assert abs(summed / true - 1.0) > 0.5 * accuracy
    assert abs((summed + missed) / true - 1.0) < 0.05 * accuracy


def test_sums_are_kept_where_they_are_right():
    summed, missed, accuracy = work_of(1500.0, 2e-4, 4e5)
    true, _, _ = work_of(1500.0, 2e-4, 4e5, EXACT)
    assert missed == 0.0
    assert abs(summed / true - 1.0) < 2.0 * DIFFERS * accuracy
