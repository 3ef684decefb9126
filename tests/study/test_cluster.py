"""A dask scheduler with workers on this machine: the same file as of the local pool, whatever happens to a worker."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from result_fakes import SCENE, scene
from sweep_fakes import (
    GRID,
    assert_same,
    chained,
    dawdling,
    deadly,
    environment,
    grid_scene,
    mortal,
    wait_for_parts,
)

from screwsim.faults import UsageError
from screwsim.study.cluster import Cluster
from screwsim.study.sweep import run_sweep

pytestmark = pytest.mark.slow
QUIET = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0", "DASK_DISTRIBUTED__SCHEDULER__WORKER_SATURATION": "1.0"}


def started(*arguments: str, folder: Path) -> subprocess.Popen:
    """Start a program of dask that writes into a log."""
    with open(folder / "dask.log", "a") as log:
        command = [sys.executable, "-m", "dask", *arguments]
        return subprocess.Popen(command, env=environment() | QUIET, stdout=log, stderr=log, cwd=folder)


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """Run a scheduler with two workers; give its file."""
    folder = tmp_path_factory.mktemp("dask")
    os.environ["SWEEP_FAKES_PIDS"] = str(folder / "pids")
    file = folder / "scheduler.json"
    local = ("--host", "127.0.0.1", "--no-dashboard")
    programs = [started("scheduler", *local, "--port", "0", "--scheduler-file", str(file), folder=folder)]
    one = ("worker", "--scheduler-file", str(file), "--nthreads", "1", "--nworkers", "2", *local)
    programs.append(started(*one, folder=folder))
    deadline = time.monotonic() + 60.0
    while not file.exists():
        assert time.monotonic() < deadline, (folder / "dask.log").read_text()
        time.sleep(0.05)
    yield file
    for program in reversed(programs):
        program.terminate()
        program.wait(20)


@pytest.fixture(scope="module")
def reference(tmp_path_factory) -> Path:
    output = tmp_path_factory.mktemp("reference") / "local.h5"
    run_sweep(grid_scene(), output, jobs=2, simulate_many=chained)
    return output


def test_the_file_is_that_of_the_local_pool(scheduler, reference, tmp_path):
    run_sweep(grid_scene(), tmp_path / "out.h5", scheduler=str(scheduler), simulate_many=chained)
    assert_same(reference, tmp_path / "out.h5")


def test_a_worker_that_is_killed_changes_nothing(scheduler, reference, tmp_path):
    output = tmp_path / "out.h5"
    pids = Path(os.environ["SWEEP_FAKES_PIDS"])
    killed = []

    def kill() -> None:
        wait_for_parts(output, 2)
        killed.append(int(pids.read_text().split()[-1]))
        os.kill(killed[0], signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    run_sweep(grid_scene(), output, scheduler=str(scheduler), simulate_many=mortal)
    thread.join()
    assert len(killed) == 1
    assert_same(reference, output)


def test_a_case_that_kills_its_worker_is_failed_as_on_the_local_pool(scheduler, tmp_path):
    swept = scene(SCENE + GRID.replace("1000 rpm, 2000 rpm, ", ""))
    run_sweep(swept, tmp_path / "one.h5", jobs=2, simulate_many=deadly)
    run_sweep(swept, tmp_path / "other.h5", scheduler=str(scheduler), simulate_many=deadly)
    assert_same(tmp_path / "one.h5", tmp_path / "other.h5")


def test_a_scheduler_that_is_lost_ends_the_sweep_in_one_line_and_loses_nothing(reference, tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("SWEEP_FAKES_PIDS", str(tmp_path / "pids"))
    file, output = tmp_path / "scheduler.json", tmp_path / "out.h5"
    local = ("--scheduler-file", str(file), "--host", "127.0.0.1", "--no-dashboard")
    program = started("scheduler", "--port", "0", *local, folder=tmp_path)
    worker = started("worker", *local, "--nthreads", "1", folder=tmp_path)

    def kill() -> None:
        wait_for_parts(output, 1)
        program.kill()

    thread = threading.Thread(target=kill)
    thread.start()
    try:
        while not file.exists():
            time.sleep(0.05)
        with pytest.raises(UsageError, match=r"the scheduler, or its connection, was lost \(start it again; the sweep"):
            run_sweep(grid_scene(), output, scheduler=str(file), simulate_many=dawdling)
    finally:
        thread.join()
        program.kill()
        program.wait(20)
        worker.terminate()
        worker.wait(20)
    assert capfd.readouterr().err == ""
    assert run_sweep(grid_scene(), output, jobs=1, simulate_many=chained).reused >= 13
    assert_same(reference, output)


def test_a_scheduler_without_workers_is_told(tmp_path):
    file = tmp_path / "scheduler.json"
    program = started(
        "scheduler", "--host", "127.0.0.1", "--no-dashboard", "--port", "0", "--scheduler-file", str(file),
        folder=tmp_path,
    )  # fmt: skip
    try:
        while not file.exists():
            time.sleep(0.05)
        with pytest.raises(UsageError, match=r"no worker came within 0\.5 s \(start some"), Cluster(str(file), 0.5):
            pass
    finally:
        program.terminate()
        program.wait(20)


@pytest.mark.parametrize(
    ("where", "told"),
    [
        ("nowhere.json", "nowhere.json: is neither an address nor a file (give tcp://HOST:PORT, or the file that"),
        ("empty.json", "empty.json: is no scheduler file (give tcp://"),
        ("tcp://127.0.0.1:9", "tcp://127.0.0.1:9: no scheduler can be reached: "),
        ("127.0.0.1:9", "127.0.0.1:9: no scheduler can be reached: "),
        ("smoke://signal", "smoke://signal: no scheduler can be reached: "),
    ],
)
def test_a_wrong_scheduler_is_told_in_one_line(where, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("empty.json").write_text("{}")
    with pytest.raises(UsageError) as caught, Cluster(where, patience=1.0):
        pass
    assert str(caught.value).startswith(told)
    assert "\n" not in str(caught.value)
