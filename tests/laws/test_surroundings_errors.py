"""Figures err with the surroundings that were found: by their slopes, and by what these unknowns err."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from screwsim.cycle.continuation import Course
from screwsim.cycle.problem import Series, problem_of
from screwsim.figures.errors import relative_errors
from screwsim.scene import load
from screwsim.simulate import simulate
from screwsim.solve.circuit import SurroundingsSearch, steady_state
from screwsim.solve.surroundings import implied_surroundings
from screwsim.solve.surroundings_errors import BEHIND, KPA, SUPPLY
from screwsim.solve.surroundings_steps import learnt, trusted_share

PACKAGE = Path(__file__).parents[2] / "configs" / "air" / "fixed_speed_10.yaml"
MOIST = PACKAGE.with_name("moist.yaml")
SLOWER = "operation.speed=2398.5 rpm"


def test_of_a_change_that_errors_could_make_hardly_anything_is_learnt():
    slopes, moved, change = np.array([[-1.0]]), np.array([0.1]), np.array([0.4])
    sure, unsure = (learnt(slopes, change, moved, trusted_share(moved, 0.0, wrong)) for wrong in (0.0, 2.0))
    assert sure == slopes  # it would reverse the response
    assert unsure == pytest.approx(slopes, rel=0.02)
    half = learnt(slopes, np.array([-0.05]), moved, trusted_share(moved, 0.1))
    assert half == pytest.approx(np.array([[-0.75]]))


def test_what_enters_the_chambers_tells_the_oil_s_temperature_before_the_cycle_is_closed():
    """What leaves them, with the oil, is off by 2.4 K."""
    series = Series()
    problem, _ = steady_state(problem_of(load(MOIST), series), series)
    search = SurroundingsSearch(Series(), problem.scene.operation.speed)
    rough = search.closed(problem, Course())
    assert rough is not None and search.cycle is None
    assert abs(implied_surroundings(rough).off[SUPPLY]) < 0.5
    circuit = rough.circuit
    assert abs(circuit.parted.gain * circuit.unclosed) > 2.0


def test_figures_that_state_an_unknown_go_with_it_alone_whatever_steps_were_made():
    series = Series()
    _, search = steady_state(problem_of(load(PACKAGE), series), series)
    assert len(search.learnt.seen) > 1
    for name, unknown, unit in (("discharge_pressure", BEHIND, KPA), ("oil_supply_temperature", SUPPLY, 1.0)):
        slope = series.surroundings.slopes[name]
        assert slope == pytest.approx(unit * np.eye(len(slope))[unknown], abs=1e-6 * unit), name


def test_a_supply_temperature_that_is_not_exact_is_told():
    scene = load(PACKAGE, [SLOWER])
    found = simulate(scene, trace=False)
    finer = replace(scene.numerics, accuracy=scene.numerics.accuracy / 300.0, error="none")
    true = relative_errors(found.performance, simulate(replace(scene, numerics=finer), trace=False).performance)
    assert 0.0 < true["oil_supply_temperature"] <= found.error["oil_supply_temperature"]
