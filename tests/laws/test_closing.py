"""Which way `auto` closes a cycle, and what that costs."""

import pytest
from scenes import make, run

from screwsim.cycle import relaxation
from screwsim.errors import relative_errors, worst
from screwsim.simulate import simulate

LEAKY = {"operation.speed": "50 rpm"}  # histories contract slowly


def solved(monkeypatch, dear, **changes):
    monkeypatch.setattr(relaxation, "DEAR", dear)
    return simulate(make({**LEAKY, **changes}))


def test_histories_give_way_when_they_have_cost_as_much_as_coupled_chambers(monkeypatch):
    patient, hasty = solved(monkeypatch, 1e9), solved(monkeypatch, 0)
    assert [result.numerics["closing"] for result in (patient, hasty)] == ["histories", "coupled"]
    assert worst(relative_errors(patient.performance, hasty.performance))[1] < 2 * make(LEAKY).numerics.accuracy


def test_the_two_ways_together_cost_little_more_than_twice_the_limit(monkeypatch):
    coupled = run({**LEAKY, "numerics": {"closing": "coupled", "error": "none"}}).numerics.rhs_evaluations
    both = solved(monkeypatch, coupled, numerics={"error": "none"}).numerics.rhs_evaluations
    hasty = solved(monkeypatch, 0.5 * coupled, numerics={"error": "none"}).numerics.rhs_evaluations
    assert max(both, hasty) < 2.2 * coupled


def test_histories_may_cost_as_much_more_as_finer_steps_do():
    """A method of order 4 needs ten times the steps for an error of a ten-thousandth."""
    assert relaxation.dear(1e-4 * relaxation.DEAR_RTOL) == pytest.approx(10.0 * relaxation.dear(relaxation.DEAR_RTOL))


def test_what_leaks_hide_of_an_error_is_counted():
    """Among chambers that live on what leaks an error is passed on for more turns than the estimate makes."""
    changes = {"operation.speed": "250 rpm", "oil_supply.ratio": 0.02}
    exact = run({**changes, "numerics": {"accuracy": 1e-5, "closing": "coupled"}})
    found = run(changes)
    assert found.numerics["closing"] == "histories" and found.performance["volumetric_efficiency"] < 0.5
    assert worst(relative_errors(found.performance, exact.performance))[1] < make(changes).numerics.accuracy
