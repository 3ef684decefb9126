"""The estimated error of the figures against the true one, and that work rises with what is asked."""

import numpy as np
import pytest
from scenes import make, run

from screwsim.errors import relative_errors
from screwsim.estimate import estimated_errors, worst
from screwsim.simulate import simulate
from screwsim.solution import Solution

CASES = {
    "fast": {"operation.speed": "5000 rpm"},
    "paper": {"operation.speed": "1000 rpm"},
    "slow": {"operation.speed": "300 rpm"},
    "carried": {"operation.speed": "2000 rpm", "oil.transport": "carried"},
    "coupled": {"operation.speed": "1500 rpm", "numerics": {"closing": "coupled"}},
    "coupled among leaks": {
        "operation.speed": "300 rpm",
        "oil.transport": "carried",
        "numerics": {"closing": "coupled"},
    },
    "loose": {"operation.speed": "1500 rpm", "numerics": {"accuracy": 3e-3}},
}


@pytest.mark.parametrize("case", CASES)
def test_the_true_error_is_below_the_wanted_accuracy(case):
    assert worst(true_errors(case))[1] < make(CASES[case]).numerics.accuracy


@pytest.mark.parametrize("case", CASES)
def test_the_estimate_is_of_the_true_errors_size(case):
    estimated, true = worst(run(CASES[case]).error)[1], worst(true_errors(case))[1]
    # one turn sees neither how errors feed back through the neighbours nor the finer turn's own error
    assert true / 3.0 < estimated < 30.0 * true


def true_errors(case):
    numerics = {**CASES[case].get("numerics", {}), "accuracy": 1e-7, "closing": "coupled"}
    return relative_errors(run(CASES[case]).performance, run({**CASES[case], "numerics": numerics}).performance)


@pytest.mark.parametrize("speed", [1000, 3000])
def test_work_rises_with_the_accuracy_asked(speed):
    asked = [{"operation.speed": f"{speed} rpm", "numerics": {"accuracy": 10.0**n}} for n in (-2, -3, -4, -5, -6)]
    counts = [run(changes).numerics.rhs_evaluations for changes in asked]
    assert counts == sorted(counts)


def test_histories_keep_the_net_flow_where_much_is_asked():
    """Mass between chambers at nearly one pressure is lost where steps do not resolve the regularised root."""
    numerics = {"accuracy": 1e-5, "closing": "histories", "error": "none"}
    changes = {"operation.speed": "3000 rpm"}
    exact = run({**changes, "numerics": {"accuracy": 1e-7, "closing": "coupled"}}).performance.gas_mass_flow
    found = run({**changes, "numerics": numerics}).performance.gas_mass_flow
    assert abs(found / exact - 1.0) < 2e-6


def state_of(machinery):
    """Return copies of all that a reading of the last turn depends on."""
    times, dense, quads, steps = machinery.last()
    history = times[: steps + 1].copy(), dense[:steps].copy(), quads[:steps].copy()
    return *history, machinery.composition.P.copy(), machinery.R.copy(), machinery.kept.copy()


@pytest.mark.parametrize("case", CASES)  # one turn, two, all chambers together
def test_a_cycle_is_left_as_it_was_by_the_estimate(case):
    solution = Solution(make(CASES[case]))
    closed = solution.close()
    before, stamp, figures = state_of(solution.machinery), solution.machinery.stamp, solution.figures(closed.q)[0]
    estimated_errors(solution, closed)
    assert all(np.array_equal(a, b) for a, b in zip(before, state_of(solution.machinery), strict=True))
    assert solution.machinery.stamp is stamp
    assert solution._new_figures(closed.q)[0] == figures
    assert len({id(arrays[1]) for arrays in solution.machinery.histories}) == 2


def test_what_is_set_aside_stands_when_longer_turns_come_after_it():
    solution = Solution(make(CASES["paper"]))
    closed = solution.close()
    machinery = solution.machinery
    before = state_of(machinery)
    _, dense, quads, steps = machinery.last()
    longer = [np.repeat(part[:steps], 2 + machinery.max_steps // steps, axis=0) for part in (dense, quads)]
    longer_times = np.arange(len(longer[0]) + 1.0)
    with machinery.set_aside():
        machinery.install(longer_times, longer[0][:, :, : machinery.n], longer[1])
        assert machinery.last()[3] == len(longer[0])
    assert all(np.array_equal(a, b) for a, b in zip(before, state_of(machinery), strict=True))
    assert all(len(arrays[1]) >= machinery.max_steps for arrays in machinery.histories)
    again = solution.close()  # and turns go on from there
    assert again.status == closed.status
    assert solution.figures(again.q)[0].shaft_power == pytest.approx(
        solution.figures(closed.q)[0].shaft_power, rel=1e-4
    )


def test_an_estimate_above_the_accuracy_closes_again():
    """Where the first closing is too coarse, the next is four times as fine."""
    changes = {"operation.speed": "300 rpm", "numerics": {"accuracy": 3e-4}}
    one, none = run(changes), run({**changes, "numerics": {"accuracy": 3e-4, "error": "none"}})
    assert worst(one.error)[1] <= 3e-4
    assert one.numerics.rtol <= none.numerics.rtol


def test_no_estimate_is_made_where_none_is_wanted():
    result = run({"numerics": {"error": "none"}})
    assert result.error == {}
    assert result.numerics.estimating_time == 0.0


def test_an_estimate_that_cannot_be_made_is_said(monkeypatch):
    monkeypatch.setattr("screwsim.estimate._finer", lambda solution, closed, found: [])
    result = simulate(make({}))
    assert all(size is None for size in result.error.values())
    assert any("could not be estimated" in warning for warning in result.warnings)
