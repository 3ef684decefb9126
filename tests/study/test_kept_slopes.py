"""A sweep keeps the derivatives of each point when its scene asks for them, and its figures are those without."""

import numpy as np
import pytest
from folders import POINT

import screwsim
from screwsim import cli
from screwsim.inputs.faults import SceneError
from screwsim.results.table import join, table_of
from screwsim.study.sweep.part_files import is_whole, read_part, write_part

GAP, POWER = "effects.tip_leakage.gap", "shaft_power"
ASKED = {"output.derivatives": "all"}
TIMES = ("wall_time", "estimating_time")


@pytest.fixture(scope="module")
def scene():
    """Return a sweep of which one case cannot be."""
    axes = {"sweep.operation.speed": ["2000 rpm", "3000 rpm"], "sweep.operation.suction.pressure": ["1 bar", "40 bar"]}
    return screwsim.load(POINT).with_(axes)


@pytest.fixture(scope="module")
def kept(scene, tmp_path_factory):
    """Return the results of the sweep with derivatives, by two processes."""
    path = tmp_path_factory.mktemp("kept") / "swept.h5"
    screwsim.run_sweep(scene.with_(ASKED), path, jobs=2)
    return screwsim.open_results(path)


def test_each_point_has_the_derivatives_of_itself_alone(kept):
    there = screwsim.load(POINT).with_({"operation.speed": "2000 rpm", "operation.suction.pressure": "1 bar"})
    alone = screwsim.sensitivities(there)
    paths = list(kept.derivatives["number"])
    for path, value in alone.values.items():
        place = paths.index(path)
        assert kept.derivatives["number_value"][0, 0, place] == value
        assert kept.derivatives["number_units"][0, 0, place] == alone.units[path]
        assert kept.derivatives["number_exact"][0, 0, place] == (alone.method[path] == "exact")
        assert kept.derivatives[POWER, path][0, 0] == pytest.approx(alone.derivatives[POWER][path], rel=1e-6)
    assert set(alone.derivatives) <= set(kept.derivatives)


def test_a_point_without_figures_has_no_derivatives(kept):
    assert (kept.status == "ok").tolist() == [[True, False], [True, False]]
    assert np.isfinite(kept.derivatives[POWER, GAP]).tolist() == [[True, False], [True, False]]


def test_derivatives_of_a_sweep_are_an_xarray_over_its_axes_and_the_numbers(kept):
    xarray = pytest.importorskip("xarray")
    data = kept.to_xarray("derivatives")
    assert isinstance(data, xarray.Dataset)
    assert data[POWER].dims == ("operation_speed", "operation_suction_pressure", "number")
    one = data[POWER].sel(number=GAP).values
    assert np.array_equal(one, kept.derivatives[POWER, GAP], equal_nan=True)


def test_the_figures_are_those_of_a_sweep_without_and_that_has_no_derivatives(scene, kept, tmp_path):
    screwsim.run_sweep(scene, tmp_path / "plain.h5", jobs=1)
    plain = screwsim.open_results(tmp_path / "plain.h5")
    assert not plain.derivatives
    for group in ("performance", "balance", "error", "numerics"):
        one, other = getattr(plain, group), getattr(kept, group)
        for name in set(one) - set(TIMES):
            assert np.asarray(one[name]).tobytes() == np.asarray(other[name]).tobytes(), name


def test_a_part_of_a_sweep_keeps_them_and_parts_that_know_other_numbers_are_joined(tmp_path):
    results = [screwsim.simulate(screwsim.load(POINT, without=names)) for names in ((), ("tip_leakage",))]
    for each in results:
        assert each.derivatives[POWER, "operation.speed"]  # found now
    first, second = (table_of([each], keep_cycle=False, keep_slopes=True) for each in results)
    write_part(tmp_path / "part", first)
    assert is_whole(tmp_path / "part", 1)
    again = join([second, read_part(tmp_path / "part")])
    assert list(again.numbers)[: len(second.numbers)] == list(second.numbers)
    place = list(again.numbers).index(GAP)
    assert np.isnan(again.slopes[POWER][0, place])
    assert again.slopes[POWER][1, place] == results[0].derivatives[POWER, GAP]


def test_a_run_keeps_them_too(tmp_path):
    out = tmp_path / "run.h5"
    assert cli.exit_code(["run", str(POINT), "--set", "output.derivatives=all", "-o", str(out)]) == 0
    there = screwsim.open_results(out).derivatives
    assert there[POWER, GAP] == pytest.approx(screwsim.simulate(POINT).derivatives[POWER, GAP], rel=1e-6)


def test_another_word_is_told_at_its_place():
    with pytest.raises(SceneError, match=r"output\.derivatives"):
        screwsim.load(POINT, ["output.derivatives=some"])


def test_points_side_by_side_have_the_derivatives_of_a_sweep_one_by_one(tmp_path):
    swept = screwsim.load(POINT).with_(ASKED | {"sweep.operation.speed": ["2000 rpm", "4000 rpm"]})
    for name, batch in (("single", False), ("batch", True)):
        screwsim.run_sweep(swept, tmp_path / f"{name}.h5", jobs=1, batch=batch)
    one, many = (screwsim.open_results(tmp_path / f"{name}.h5").derivatives for name in ("single", "batch"))
    assert list(one) == list(many)
    for path in one["number"]:
        assert np.isfinite(one[POWER, path]).all()
        # the cycles differ by rounding, and so does where slices end around a flow that turns round
        assert many[POWER, path] == pytest.approx(one[POWER, path], rel=1e-4, abs=1e-12)


def test_an_optimisation_keeps_the_derivatives_of_each_evaluation(tmp_path):
    asked = screwsim.load(POINT).with_(ASKED)
    vary = ["operation.speed=2000 rpm..4000 rpm"]
    screwsim.optimize(asked, vary, ["isothermal_efficiency"], evaluations=4, output=tmp_path / "best.h5", jobs=1)
    kept = screwsim.open_results(tmp_path / "best.h5")
    paths = list(kept.derivatives["number"])
    number = kept.derivatives["number_value"][:, paths.index("operation.speed")]
    alone = screwsim.sensitivities(asked.with_({"operation.speed": f"{number[2]:.17g} rad/s"}))
    assert kept.derivatives[POWER, GAP].shape == (len(number),)
    assert kept.derivatives[POWER, GAP][2] == pytest.approx(alone.derivatives[POWER][GAP], rel=1e-4)
