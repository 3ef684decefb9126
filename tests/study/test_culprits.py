"""Cases that kill their worker or never end: they alone are failed, and the rest is what it would be without them."""

import os
import signal
import threading
import time
from functools import partial

import numpy as np
import pytest
from result_fakes import fake_simulate
from sweep_fakes import (
    assert_same,
    chained,
    deadly,
    deadly_in_a_row,
    endless,
    grid_scene,
    mortal,
    start,
    torn,
    wait_for_parts,
)

from screwsim.results import open_results
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.sweep import run_sweep

pytestmark = [pytest.mark.around, pytest.mark.usefixtures("one_moment")]


def test_a_case_that_kills_its_worker_is_failed_and_no_other(tmp_path):
    summary = run_sweep(grid_scene(), tmp_path / "out.h5", jobs=2, simulate_many=deadly)
    results = open_results(tmp_path / "out.h5")
    assert (summary.failed, summary.cases) == (6, 120)
    died = np.char.startswith(results.messages, "worker died (run this case alone")
    np.testing.assert_array_equal(np.argwhere(died), [[0, 7], [1, 7], [2, 7]])


def test_the_others_do_not_depend_on_how_the_culprit_was_found(tmp_path):
    for jobs in (2, 3):
        run_sweep(grid_scene(), tmp_path / f"{jobs}.h5", jobs=jobs, simulate_many=deadly)
    assert_same(tmp_path / "2.h5", tmp_path / "3.h5")
    run_sweep(grid_scene(), tmp_path / "whole.h5", jobs=1, simulate_many=chained)
    one, other = (open_results(tmp_path / name).performance["volumetric_efficiency"] for name in ("2.h5", "whole.h5"))
    np.testing.assert_array_equal(one[:, 14:], other[:, 14:])  # later blocks know nothing of it
    assert np.all(one[:, 8] != other[:, 8])  # the next one starts cold
    speed = open_results(tmp_path / "2.h5").axes["operation.speed"]
    np.testing.assert_array_equal(one[:, 8], speed + 8.0)


def test_a_case_that_kills_only_after_another_is_found_too(tmp_path):
    summary = run_sweep(grid_scene(), tmp_path / "out.h5", jobs=2, simulate_many=deadly_in_a_row)
    results = open_results(tmp_path / "out.h5")
    assert summary.failed == 4
    assert results.messages[1, 7].startswith("worker died")


def test_a_worker_that_is_killed_while_it_sends_its_results_costs_nothing(tmp_path):
    """The pool would wait for ever for the other half of the message."""
    once = tmp_path / "once"
    once.touch()
    summary = run_sweep(grid_scene(), tmp_path / "out.h5", jobs=2, simulate_many=partial(torn, once))
    assert summary.failed == 3 and not once.exists()
    run_sweep(grid_scene(), tmp_path / "one.h5", jobs=1, simulate_many=chained)
    assert_same(tmp_path / "one.h5", tmp_path / "out.h5")


def test_a_case_that_never_ends_is_failed_and_no_other(tmp_path):
    began = time.monotonic()
    summary = run_sweep(grid_scene(), tmp_path / "out.h5", jobs=2, simulate_many=endless, case_limit=1.0)
    assert time.monotonic() - began < 30.0
    results = open_results(tmp_path / "out.h5")
    assert summary.failed == 4
    assert results.messages[0, 7].startswith("ran longer than 1 s and was ended (allow more with --case-limit")


def test_a_limit_makes_one_job_a_process_of_its_own(tmp_path):
    summary = run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, simulate_many=endless, case_limit=0.5)
    assert summary.failed == 4


def test_a_limit_that_no_case_reaches_changes_nothing(tmp_path):
    run_sweep(grid_scene(), tmp_path / "a.h5", jobs=1, simulate=fake_simulate)
    run_sweep(grid_scene(), tmp_path / "b.h5", jobs=2, simulate=fake_simulate, case_limit=5.0)
    assert_same(tmp_path / "a.h5", tmp_path / "b.h5")


def test_a_worker_that_others_kill_costs_no_case(tmp_path, monkeypatch):
    pids, output = tmp_path / "pids", tmp_path / "out.h5"
    monkeypatch.setenv("SWEEP_FAKES_PIDS", str(pids))
    process = start(output, 2, "mortal")
    wait_for_parts(output, 2)
    os.kill(int(pids.read_text().split()[-1]), signal.SIGKILL)
    process.communicate(timeout=30)
    assert process.returncode == 0
    run_sweep(grid_scene(), tmp_path / "one.h5", jobs=1, simulate_many=mortal)
    assert_same(output, tmp_path / "one.h5")


def test_workers_that_cannot_start_end_the_sweep(tmp_path, monkeypatch):
    monkeypatch.setattr("screwsim.study.pool.workers._start_worker", dying)
    with pytest.raises(RuntimeError, match="worker processes cannot start"):
        run_sweep(grid_scene(), tmp_path / "out.h5", jobs=2, simulate=fake_simulate)


def dying() -> None:
    os._exit(1)


def test_no_thread_of_a_pool_outlives_its_work():
    # one that ends while the process does makes Python print a traceback
    before = set(threading.enumerate())
    for _ in range(5):
        assert parallel_map(str, 4, died=lambda number: "", jobs=2, failed=lambda answer: False) == list("0123")
        assert [thread for thread in set(threading.enumerate()) - before if "Manager" in type(thread).__name__] == []
