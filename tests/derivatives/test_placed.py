"""A life that is installed where it is read tells what an installed one tells, and costs nothing before."""

import numpy as np
import pytest
from closed_points import closed_point
from near_arrays import assert_near

from screwsim.derivatives.collocation import QUICK
from screwsim.derivatives.peak import peak
from screwsim.derivatives.shifted_life import PeakPlace, ShiftedLife, in_step

STEP, SHARE = 70, 0.37  # of a life: any
ROUNDING = 1e-12


@pytest.fixture(scope="module", params=["paper", "r134a"])
def cycle(request):
    """Return the collocated cycle of a scene, its history installed."""
    found = closed_point(request.param, QUICK)
    found.pitch.put(found.at)
    found.pitch.install(found.start, found.nodes)
    return found


def test_the_pressure_where_it_turns_is_that_of_the_history_and_asks_for_none(cycle):
    pitch, asked = cycle.pitch, []
    states = in_step(pitch, cycle.start, cycle.nodes.__getitem__, pitch.after(cycle.nodes), STEP)
    turning = PeakPlace(STEP, SHARE, states)
    life = ShiftedLife.of(pitch, lambda: asked.append("a history"), turning)
    times = pitch.machinery.trajectory.times
    angle = (1.0 - SHARE) * times[STEP] + SHARE * times[STEP + 1]
    there = pitch.machinery.trajectory.pressures_at(np.array([angle]))[0]
    assert life.peak_pressure(0.0) == pytest.approx(there, rel=ROUNDING)
    assert asked == []


def test_what_is_read_of_a_history_has_it_installed_once(cycle):
    pitch, asked = cycle.pitch, []

    def fill():
        asked.append("a history")
        pitch.install(cycle.start, cycle.nodes)

    life, geometry = ShiftedLife.of(pitch, fill), pitch.problem.parts.geometry
    angles = np.array([0.5, 1.0, 2.0])
    assert_near(life.states_at(angles), pitch.machinery.trajectory.states_at(angles), rel=ROUNDING)
    assert peak(life, geometry) == pytest.approx(peak(pitch.machinery.trajectory, geometry), rel=ROUNDING)
    assert life.volume(1.0) == pitch.machinery.trajectory.volume(1.0)
    assert asked == ["a history"]


def test_a_life_of_many_columns_is_that_of_each(cycle):
    pitch, draw = cycle.pitch, np.random.default_rng(1)
    start, nodes = draw.normal(size=(pitch.N, 3)), draw.normal(size=(*cycle.nodes.shape, 3))
    found = pitch.life(start, nodes, pitch.after(nodes))
    assert found.shape == (3, pitch.count * (pitch.N // pitch.n), 4, pitch.n)
    for j in range(3):
        assert_near(found[j], pitch.life(start[:, j], nodes[..., j], pitch.after(nodes)), rel=ROUNDING)
    at = draw.integers(0, pitch.count)
    end = found[:, at, 1]  # of the first chamber's slices
    assert_near(end, nodes[at, -1, : pitch.n].T, rel=ROUNDING)
