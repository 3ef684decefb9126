"""Warnings of a sweep: stored of each case, counted by kind."""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from result_fakes import GRID, SCENE, fake_simulate, scene

from screwsim.outputs import Result
from screwsim.printing.sweep import MOST_WARNINGS, print_sweep, sweep_document
from screwsim.results import open_results, save
from screwsim.results.warning_kinds import WarningKind, cases_with_warnings, warning_kinds
from screwsim.scene import Scene, grid, with_values
from screwsim.study.sweep import run_sweep

OVER = "the estimated error of shaft_power, {:.2g}, is above the wanted accuracy 0.0003"


def warning(case: Scene) -> Result:
    """Warn of the error from 2000 rpm on, with a number of its own in each case, and of R134a at ratio 0."""
    ratio, speed = case.oil_supply.ratio, case.operation.speed
    told = [OVER.format(1e-3 * (1.0 + ratio) * speed)] if speed > 110.0 else []
    told += ["R134a is all liquid"] if ratio == 0.0 else []
    return replace(fake_simulate(case), warnings=tuple(told))


@pytest.fixture
def swept(tmp_path: Path) -> Path:
    run_sweep(scene(SCENE + GRID), tmp_path / "out.h5", jobs=1, simulate=warning)
    return tmp_path / "out.h5"


def test_python_gives_the_warnings_of_each_case(swept):
    results, whole = open_results(swept), scene(SCENE + GRID)
    assert results.warnings.shape == (3, 10)
    for number, text in enumerate(results.warnings.ravel()):
        case = with_values(whole, grid.case_values(whole, number))
        assert text == "\n".join(warning(case).warnings)


def test_the_dataset_of_a_sweep_has_them(swept):
    data = pytest.importorskip("xarray") and open_results(swept).to_xarray(None)
    np.testing.assert_array_equal(data.warnings.values, open_results(swept).warnings)
    assert data.warnings.dims == ("operation_speed", "oil_supply_ratio")


def test_they_are_stored_without_strings_of_variable_length(swept):
    with h5py.File(swept) as file:
        group = file["performance"]
        assert (group["warnings"].dtype, group["warnings_text"].dtype) == (np.dtype(np.int32), np.dtype("S1"))


def test_kinds_differ_by_more_than_numbers(swept):
    results = open_results(swept)
    assert cases_with_warnings(results).sum() == 2 * 10 + 1
    [over, liquid] = warning_kinds(results)
    assert (over.cases, over.first) == (20, 10) and over.text == OVER.format(1e-3 * 2000 * np.pi / 30.0)
    assert liquid == WarningKind(3, 0, "R134a is all liquid")


def test_a_run_has_its_own(tmp_path):
    save(tmp_path / "one.h5", scene(), fake_simulate(scene()))
    results = open_results(tmp_path / "one.h5")
    assert str(results.warnings) == "first warning\nη of 2"
    assert cases_with_warnings(results).sum() == 1
    assert warning_kinds(results) == (WarningKind(1, 0, "first warning"), WarningKind(1, 0, "η of 2"))


def test_a_sweep_without_warnings_has_none(tmp_path):
    run_sweep(scene(SCENE + GRID), tmp_path / "out.h5", jobs=1, simulate=silent)
    results = open_results(tmp_path / "out.h5")
    assert not cases_with_warnings(results).any() and warning_kinds(results) == ()


def silent(case: Scene) -> Result:
    return replace(fake_simulate(case), warnings=())


def many_kinds(case: Scene) -> Result:
    return replace(fake_simulate(case), warnings=(f"kind {'x' * int(case.oil_supply.ratio)}",))


def test_the_closing_line_of_a_sweep_tells_how_many_and_which(tmp_path, capsys):
    whole = scene(SCENE + GRID)
    document = sweep_document(whole, run_sweep(whole, tmp_path / "out.h5", jobs=1, simulate=warning))
    assert document["warned"] == 21 and [kind["cases"] for kind in document["warnings"]] == [20, 3]
    assert document["warnings"][0]["values"]["oil_supply.ratio"] == 0.0
    print_sweep(document, whole)
    out = " ".join(capsys.readouterr().out.split())
    each = ("24 ok (17 of them with warnings)", "3 not closed (2 of them with warnings)", "3 failed (2 of them with")
    assert f"30 cases: {', '.join(each)}" in out
    assert "warning in 20 cases, first at operation.speed = 2000 rpm, oil_supply.ratio = 0: the estimated" in out
    assert "warning in 3 cases, first at operation.speed = 1000 rpm, oil_supply.ratio = 0: R134a is all liquid" in out


def test_kinds_beyond_the_first_are_counted(tmp_path, capsys):
    whole = scene(SCENE + GRID)
    print_sweep(sweep_document(whole, run_sweep(whole, tmp_path / "out.h5", jobs=1, simulate=many_kinds)), whole)
    out = capsys.readouterr().out
    assert out.count("warning in 3 cases") == MOST_WARNINGS
    assert f"… and {10 - MOST_WARNINGS} other kinds of warnings (see the file)" in out


def alike(case: Scene) -> Result:
    return Result("failed", message="no machine" if case.operation.speed < 110.0 else "no oil")


def test_failures_with_the_same_words_are_told_once_at_a_place_with_its_unit(tmp_path, capsys):
    whole = scene(SCENE + GRID)
    print_sweep(sweep_document(whole, run_sweep(whole, tmp_path / "out.h5", jobs=1, simulate=alike)), whole)
    out = " ".join(capsys.readouterr().out.split())
    assert "failed at operation.speed = 1000 rpm, oil_supply.ratio = 0 and 9 more: no machine" in out
    assert out.count("no machine") == out.count("no oil") == 1
