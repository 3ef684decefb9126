"""Cases that are meant by the values of their paths."""

import numpy as np
import pytest
from result_fakes import SCENE

import screwsim
from screwsim.results.chosen import case_in_words, cases_with, read_case
from screwsim.scene import loads
from screwsim.study.sweep import run_sweep


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    """Return a file over two numbers and a choice."""
    path = tmp_path_factory.mktemp("grid") / "grid.h5"
    sweep = {"sweep.operation.speed": ["1000 rpm", "3000 rpm"], "sweep.oil_supply.temperature": ["280 K", "300 K"]}
    run_sweep(loads(SCENE).with_(sweep), path, jobs=1)
    return screwsim.open_results(path)


def test_values_with_units_and_in_si_mean_the_same_cases(grid):
    by_text = cases_with(grid, {"operation.speed": "3000 rpm"})
    np.testing.assert_array_equal(by_text, [[False, False], [True, True]])
    np.testing.assert_array_equal(cases_with(grid, {"operation.speed": 3000 * np.pi / 30}), by_text)
    both = {"operation.speed": "3000 rpm", "oil_supply.temperature": "26.85 degC"}
    np.testing.assert_array_equal(cases_with(grid, both), [[False, False], [False, True]])


def test_a_value_as_it_is_printed_is_the_one_that_is_meant(grid):
    told = case_in_words(grid, (1, 0))
    assert told == "operation.speed = 3000 rpm, oil_supply.temperature = 6.85 degC"
    values = read_case(part for part in told.split(", "))
    np.testing.assert_array_equal(np.argwhere(cases_with(grid, values)), [[1, 0]])


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (
            {"operation.speed": "2900 rpm"},
            "operation.speed: there is no case at 2900 rpm (there are 1000 rpm, 3000 rpm)",
        ),
        ({"operation.sped": "1000 rpm"}, "operation.sped is not known; did you mean 'operation.speed'?"),
        ({"operation.speed": "3000"}, "operation.speed: '3000' has no unit (write e.g. '3000 rpm')"),
    ],
)
def test_what_no_case_has_is_told_with_what_there_is(grid, values, says):
    with pytest.raises(screwsim.UsageError) as refused:
        grid.showing(values)
    assert str(refused.value) == says


@pytest.mark.parametrize(
    ("texts", "says"),
    [
        (["speed"], "speed: is not PATH=VALUE (write e.g. operation.speed='2950 rpm')"),
        (["operation.speed=1 rpm", "operation.speed=2 rpm"], "operation.speed: is given twice (remove one)"),
    ],
)
def test_a_text_that_is_no_value_of_a_path_is_refused(texts, says):
    with pytest.raises(screwsim.UsageError) as refused:
        read_case(texts)
    assert str(refused.value) == says


def test_one_run_has_no_case_to_choose(tmp_path):
    from screwsim.results import save

    scene = loads(SCENE)
    save(tmp_path / "x.h5", scene, screwsim.simulate(scene))
    with pytest.raises(screwsim.UsageError, match=r"operation.speed: .*x.h5 has a single case \(leave it out\)"):
        screwsim.open_results(tmp_path / "x.h5").showing({"operation.speed": "3000 rpm"})
