"""Where flows turn round is kept from round to round; quick derivatives are near exact ones and cost less."""

import pytest
from folders import POINT

import screwsim
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import Series, problem_of
from screwsim.derivatives.collocation import FINE, QUICK, _with_vanished, collocated
from screwsim.derivatives.mesh import Crossing
from screwsim.solve.circuit import solve_with_surroundings, steady_state
from screwsim.study.uncertainty.point import sensitivities

NEAR = 1e-3  # of the largest slope by a number: what quick derivatives are good to


@pytest.mark.parametrize("left", [(0.1,), (0.1 + 3e-6,), ()])
def test_of_two_turnings_side_by_side_both_stay_where_one_is_found(left):
    pair = [Crossing(0.1, 2e-6), Crossing(0.1 + 4e-6, 2e-6)]
    found = _with_vanished([Crossing(angle, 2e-6) for angle in left], pair)
    assert len(found) == 2
    assert found == sorted(found)


def test_a_turning_that_moves_is_not_kept_where_it_was():
    assert _with_vanished([Crossing(0.1 + 1e-6, 2e-6)], [Crossing(0.1, 2e-6)]) == [Crossing(0.1 + 1e-6, 2e-6)]


def test_a_turning_far_from_all_before_is_one_more():
    assert len(_with_vanished([Crossing(0.2, 2e-6)], [Crossing(0.1, 2e-6)])) == 2


def test_quick_derivatives_take_fewer_slices():
    series = Series()
    problem, search = steady_state(problem_of(screwsim.load(POINT), series), series)
    machinery = lease_for(problem)
    of = solve_with_surroundings(problem, machinery, None, search).evaluation
    quick, fine = (collocated(of.problem, machinery, of.life, each).pitch.count for each in (QUICK, FINE))
    assert quick < 0.9 * fine


def test_quick_derivatives_are_near_exact_ones():
    scene = screwsim.load(POINT)
    fine, quick = (sensitivities(scene, fine=each) for each in (True, False))
    assert set(fine.method.values()) == {"exact"} and set(quick.method.values()) == {"quick"}
    for path in fine.values:
        slopes = {name: fine.relative(name, path) or 0.0 for name in fine.derivatives}
        close = NEAR * max(1e-2, *map(abs, slopes.values()))
        assert {name: quick.relative(name, path) or 0.0 for name in slopes} == pytest.approx(slopes, abs=close), path
    assert quick.derivatives != fine.derivatives
