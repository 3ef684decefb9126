"""A sweep with its blocks side by side: the same cases, statuses and messages, in whatever chunks, after any stop."""

from pathlib import Path

import numpy as np
import pytest
import simulated_device
from sweep_fakes import StopAfter

from screwsim.batch import driver, tasks
from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.results import open_results
from screwsim.scene import load
from screwsim.study.pool.limit import clocks_running
from screwsim.study.pool.workers import Chunks
from screwsim.study.sweep.run import no_warm_up, run_sweep

POINT = str(Path(__file__).parents[2] / "configs" / "paper" / "point.yaml")
SWEEP = [
    "numerics.accuracy=1e-3",
    "sweep.operation.discharge.pressure=[6 bar, 8 bar, 0.4 bar]",  # the last one is below the suction's, and failed
    "sweep.operation.speed={from: 2000 rpm, to: 4000 rpm, count: 20}",
]


@pytest.fixture(scope="module")
def scene():
    return load(POINT, SWEEP)


@pytest.fixture(scope="module")
def batch(scene, tmp_path_factory):
    output = tmp_path_factory.mktemp("batch") / "batch.h5"
    run_sweep(scene, output, jobs=1, batch=True)
    return output


def assert_same(one, other):
    """Assert that all of two files is the same bits, but times."""
    first, second = open_results(one), open_results(other)
    np.testing.assert_array_equal(first.status, second.status)
    assert first.messages.tolist() == second.messages.tolist()
    for group in ("performance", "balance", "error", "numerics"):
        left, right = getattr(first, group), getattr(second, group)
        assert list(left) == list(right)
        for name in left:
            if "time" not in name:
                np.testing.assert_array_equal(left[name], right[name], err_msg=f"{group}.{name}")


def test_cases_side_by_side_are_those_of_a_sweep_one_by_one(scene, batch, tmp_path):
    run_sweep(scene, tmp_path / "single.h5", jobs=1)
    one, many = open_results(tmp_path / "single.h5"), open_results(batch)
    assert {*np.unique(one.status)} == {"ok", "failed"}
    np.testing.assert_array_equal(one.status, many.status)
    assert one.messages.tolist() == many.messages.tolist()
    for name in ("shaft_power", "gas_mass_flow", "isothermal_efficiency", "discharge_temperature"):
        np.testing.assert_allclose(one.performance[name], many.performance[name], rtol=1e-9)  # rounding


def test_two_workers_give_the_same_bits(scene, batch, tmp_path):
    run_sweep(scene, tmp_path / "two.h5", jobs=2, batch=True, warm_up=no_warm_up)
    assert_same(batch, tmp_path / "two.h5")


def test_an_interrupted_sweep_goes_on_and_comes_to_the_same_bits(scene, batch, tmp_path, monkeypatch):
    monkeypatch.setattr("screwsim.study.sweep.run.SIDE_BY_SIDE", 2)  # more than one chunk
    with pytest.raises(KeyboardInterrupt):
        run_sweep(scene, tmp_path / "again.h5", jobs=1, batch=True, progress=StopAfter(1))
    summary = run_sweep(scene, tmp_path / "again.h5", jobs=1, batch=True)
    assert 0 < summary.reused < summary.cases
    assert_same(batch, tmp_path / "again.h5")


def test_the_command_has_the_option(tmp_path, capsys):
    asked = ["sweep", POINT, "--set", "sweep.operation.speed=[2900 rpm, 3000 rpm]", "--batch", "--jobs", "1"]
    assert exit_code([*asked, "-o", str(tmp_path / "out.h5")]) == 0
    assert "2 cases: 2 ok" in capsys.readouterr().out


def test_a_sweep_on_a_gpu_has_the_cases_of_one_in_lanes(scene, batch, tmp_path, monkeypatch):
    monkeypatch.setattr(tasks, "look_for_driver", lambda: None)
    monkeypatch.setattr(tasks, "device", simulated_device.Simulated)
    monkeypatch.setattr(tasks, "_on_device", {})
    run_sweep(scene, tmp_path / "gpu.h5", jobs=1, gpu=True)
    assert tasks._on_device
    one, many = open_results(batch), open_results(tmp_path / "gpu.h5")
    np.testing.assert_array_equal(one.status, many.status)
    assert one.messages.tolist() == many.messages.tolist()
    for name in ("shaft_power", "gas_mass_flow", "isothermal_efficiency", "discharge_temperature"):
        np.testing.assert_allclose(one.performance[name], many.performance[name], rtol=1e-9)


def test_a_sweep_on_a_gpu_that_is_not_there_is_told_before_a_case_is_solved(scene, tmp_path, capsys):
    try:
        driver.look_for_driver()
    except UsageError:
        asked = ["sweep", POINT, "--set", "sweep.operation.speed=[2900 rpm, 3000 rpm]", "--gpu"]
        assert exit_code([*asked, "-o", str(tmp_path / "out.h5")]) == 2
        told = capsys.readouterr().err.strip().splitlines()
        assert len(told) == 1 and "GPU" in told[0]
        assert not list(tmp_path.iterdir())
        return
    pytest.skip("there is a GPU")


def test_lanes_and_a_gpu_are_two_ways(tmp_path, capsys):
    asked = ["sweep", POINT, "--set", "sweep.operation.speed=[2900 rpm, 3000 rpm]", "--gpu", "--batch"]
    assert exit_code([*asked, "-o", str(tmp_path / "out.h5")]) == 2
    assert "choose one of the two" in capsys.readouterr().err


def test_chunks_have_as_many_blocks_as_there_are_lanes_where_all_workers_have_some():
    def sizes(blocks, jobs):
        chunks, found = Chunks([range(blocks)], 100, lambda: jobs, 8), []
        while (taken := chunks.take()) is not None:
            found.append(len(taken))
            chunks.learn(len(taken), 0.1 * len(taken))
        return found

    assert sizes(32, 2) == [8, 8, 8, 8]
    assert sizes(6, 2) == [3, 3]
    assert sum(sizes(37, 3)) == 37


def test_the_time_of_a_case_stands_still_while_others_run():
    from screwsim.study.pool import limit

    with limit.TimeLimit(1000.0):
        with clocks_running([]):
            assert not limit._deadlines
            left = dict(limit._seconds_left)
            with clocks_running(list(left)):
                assert limit._deadlines.keys() == left.keys()
        assert list(limit._deadlines.values()) and not limit._seconds_left
    assert not limit._deadlines


def test_a_case_that_is_ended_while_it_waits_for_others_leaves_no_time():
    from greenlet import getcurrent, greenlet

    from screwsim.study.pool import limit

    own = getcurrent()

    def waits():
        with limit.TimeLimit(1000.0):
            limit.clock_handed_on(getcurrent(), own)
            own.switch()

    task = greenlet(waits)
    task.switch()
    assert task in limit._seconds_left
    task.throw()
    assert task.dead
    assert task not in limit._seconds_left
    assert task not in limit._deadlines
