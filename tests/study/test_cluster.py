"""A dask scheduler with workers on this machine: the same file as of the local pool, whatever happens to a worker."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from pathlib import Path

import numpy as np
import pytest
from dask_programs import Program, server
from distributed import Client
from distributed.client import ClosedClientError
from result_fakes import SCENE, scene
from sweep_fakes import (
    GRID,
    PACKAGE,
    assert_same,
    chained,
    crawling,
    dawdling,
    deadly,
    environment,
    grid_scene,
    mortal,
    wait_for_parts,
)

from screwsim.inputs.faults import UsageError
from screwsim.results import open_results
from screwsim.scene import load
from screwsim.study.pool.workers import stop_executor
from screwsim.study.sweep import run_sweep
from screwsim.study.sweep.cluster import Cluster

pytestmark = [pytest.mark.slow, pytest.mark.around]
SETTINGS = {
    "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0",
    "DASK_DISTRIBUTED__SCHEDULER__WORKER_SATURATION": "1.0",
    "DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD": "forkserver",  # a worker that is killed is soon another
}

ALONE = ("--nthreads", "1", "--no-nanny")  # a worker that nobody kills needs no second process to start it again


@pytest.fixture(scope="module")
def started() -> Iterator[Callable[..., Program]]:
    """Return a function that starts a program of dask; `package`: the folder in which it finds screwsim."""
    with server(os.environ | SETTINGS) as serving:

        def start(*arguments: str, folder: Path, package: Path = PACKAGE) -> Program:
            variables = environment() | SETTINGS
            variables["PYTHONPATH"] = os.pathsep.join([str(package), variables["PYTHONPATH"]])
            return serving.start(*arguments, variables=variables, folder=folder)

        yield start


def wait_for_scheduler(file: Path) -> None:
    """Wait until a scheduler's file says where it is: the file is there before anything stands in it."""
    deadline = time.monotonic() + 60.0
    while not (file.exists() and file.read_text().rstrip().endswith("}")):
        assert time.monotonic() < deadline, (file.parent / "dask.log").read_text()
        time.sleep(0.05)


@pytest.fixture(scope="module")
def scheduler(started, tmp_path_factory):
    """Run a scheduler with two workers; give its file."""
    folder = tmp_path_factory.mktemp("dask")
    os.environ["SWEEP_FAKES_PIDS"] = str(folder / "pids")
    file = folder / "scheduler.json"
    local = ("--host", "127.0.0.1", "--no-dashboard")
    programs = [started("scheduler", *local, "--port", "0", "--scheduler-file", str(file), folder=folder)]
    one = ("worker", "--scheduler-file", str(file), "--nthreads", "1", "--nworkers", "2", *local)
    programs.append(started(*one, folder=folder))
    wait_for_scheduler(file)
    yield file
    for program in reversed(programs):
        program.terminate()
        program.wait(60)


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


@pytest.fixture
def other_package(tmp_path) -> Path:
    """Give a folder with this package in which one line of what computes is another."""
    shutil.copytree(PACKAGE / "screwsim", tmp_path / "other/screwsim", ignore=shutil.ignore_patterns("__pycache__"))
    with open(tmp_path / "other/screwsim/simulate.py", "a") as module:
        module.write("DRAWN_TOO_MUCH = 0.5\n")
    return tmp_path / "other"


@pytest.mark.parametrize("late", [False, True])
def test_a_worker_with_other_sources_is_refused_by_its_name_whenever_it_comes(
    late, started, other_package, reference, tmp_path
):
    file, output = tmp_path / "scheduler.json", tmp_path / "out.h5"
    local = ("--scheduler-file", str(file), "--host", "127.0.0.1", "--no-dashboard")
    programs = [started("scheduler", "--port", "0", *local, folder=tmp_path)]
    programs.append(started("worker", *local, *ALONE, folder=tmp_path))

    def join() -> None:
        if late:
            wait_for_parts(output, 1)
        programs.append(started("worker", *local, *ALONE, folder=tmp_path, package=other_package))

    try:
        wait_for_scheduler(file)
        if late:
            threading.Thread(target=join).start()
        else:
            join()
            with Client(json.loads(file.read_text())["address"], set_as_default=False) as client:
                client.wait_for_workers(2, timeout=60.0)
        told = r"worker tcp://127\.0\.0\.1:\d+ has different sources of screwsim 0\.1\.0 \(install the same versions "
        r"and files"
        with pytest.raises(UsageError, match=told) as caught:
            run_sweep(grid_scene(), output, scheduler=str(file), simulate_many=crawling)
        assert "\n" not in str(caught.value)
    finally:
        for program in reversed(programs):
            program.terminate()
            program.wait(60)
    assert run_sweep(grid_scene(), output, jobs=1, simulate_many=chained).reused >= 13 * late
    assert_same(reference, output)


@pytest.mark.skipif(shutil.which("openssl") is None, reason="makes certificates with openssl")
def test_the_tls_example_of_the_docs_lets_in_only_who_has_the_certificate(reference, tmp_path):
    text = (Path(__file__).parents[2] / "docs/how-to/clusters.md").read_text()
    make, run = re.findall(r"```bash\n(.*?)```", text.partition("## SLURM")[0], re.DOTALL)[:2]
    (tmp_path / "study.yaml").write_text(SCENE + GRID)
    (tmp_path / "sweep.py").write_text(SWEPT)
    assert "screwsim sweep study.yaml -o study.h5 --scheduler s.json" in run
    run = run.replace("screwsim sweep study.yaml -o study.h5 --scheduler s.json", "python sweep.py; kill $(jobs -p)")
    variables = environment() | {"HOME": str(tmp_path)}
    variables["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    for script in (make, run):
        done = subprocess.run(["bash", "-c", script], env=variables, cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout.split() == ["refused", "30"], done.stderr


SWEPT = """\
import json, socket, ssl
from result_fakes import fake_simulate, scene, SCENE, GRID
from screwsim.study.sweep import run_sweep
host, port = json.load(open("s.json"))["address"].removeprefix("tls://").rsplit(":", 1)
stranger = ssl._create_unverified_context().wrap_socket(socket.create_connection((host, int(port))))
try:
    stranger.recv(1)
except ssl.SSLError:
    print("refused")
print(run_sweep(scene(SCENE + GRID), "out.h5", scheduler="s.json", simulate=fake_simulate).cases)
"""


def test_a_scheduler_that_is_lost_ends_the_sweep_in_one_line_and_loses_nothing(
    started, reference, tmp_path, monkeypatch, capfd
):
    monkeypatch.setenv("SWEEP_FAKES_PIDS", str(tmp_path / "pids"))
    monkeypatch.setattr("screwsim.study.sweep.cluster._TIMEOUT", 3.0)  # and the worker is there before the sweep
    file, output = tmp_path / "scheduler.json", tmp_path / "out.h5"
    local = ("--scheduler-file", str(file), "--host", "127.0.0.1", "--no-dashboard")
    program = started("scheduler", "--port", "0", *local, folder=tmp_path)
    worker = started("worker", *local, *ALONE, folder=tmp_path)

    def kill() -> None:
        wait_for_parts(output, 1)
        program.kill()

    thread = threading.Thread(target=kill)
    thread.start()
    try:
        wait_for_scheduler(file)
        with Client(json.loads(file.read_text())["address"], set_as_default=False) as client:
            client.wait_for_workers(1, timeout=60.0)
        with pytest.raises(UsageError, match=r"the scheduler, or its connection, was lost \(start it again; the sweep"):
            run_sweep(grid_scene(), output, scheduler=str(file), simulate_many=dawdling)
    finally:
        thread.join()
        program.kill()
        program.wait(60)
        worker.terminate()
        worker.wait(60)
    assert capfd.readouterr().err == ""
    assert run_sweep(grid_scene(), output, jobs=1, simulate_many=chained).reused >= 13
    assert_same(reference, output)


def test_an_executor_whose_client_has_closed_is_given_up_all_the_same():
    """A lost scheduler closes it at some moment of its own, and what ends the sweep must not be that error."""

    class Closed(Executor):
        def __init__(self, error: type[Exception]) -> None:
            self.error = error

        def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
            raise self.error("Client is closed. Can't send cancel-keys message.")

    stop_executor(Closed(ClosedClientError))
    with pytest.raises(ZeroDivisionError):
        stop_executor(Closed(ZeroDivisionError))


def test_a_scheduler_without_workers_is_told(started, tmp_path):
    file = tmp_path / "scheduler.json"
    program = started(
        "scheduler", "--host", "127.0.0.1", "--no-dashboard", "--port", "0", "--scheduler-file", str(file),
        folder=tmp_path,
    )  # fmt: skip
    try:
        wait_for_scheduler(file)
        with pytest.raises(UsageError, match=r"no worker appeared within 0\.5 s \(start some"), Cluster(str(file), 0.5):
            pass
    finally:
        program.terminate()
        program.wait(60)


@pytest.mark.parametrize("where", ["smoke://signal", "tls://127.0.0.1:9", "tcp://127.0.0.1:port"])
def test_a_wrong_address_ends_the_program(where, tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE + GRID)
    command = [sys.executable, "-m", "screwsim", "sweep", "scene.yaml", "-o", "out.h5", "--scheduler", where]
    done = subprocess.run(command, env=environment(), cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith(f"{where}: cannot reach a scheduler: ")


def test_what_answers_but_is_no_scheduler_is_given_up():
    with socket.create_server(("127.0.0.1", 0)) as silent:
        where = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(UsageError, match="cannot reach a scheduler: no answer"), Cluster(where, patience=0.5):
            pass


@pytest.mark.parametrize(
    ("where", "told"),
    [
        ("five.json", "five.json: is not a scheduler file (give tcp://"),
        ("nowhere.json", "nowhere.json: is neither an address nor a file (give tcp://HOST:PORT, or the file that"),
        ("empty.json", "empty.json: is not a scheduler file (give tcp://"),
        ("tcp://127.0.0.1:9", "tcp://127.0.0.1:9: cannot reach a scheduler: "),
        ("127.0.0.1:9", "127.0.0.1:9: cannot reach a scheduler: "),
        ("smoke://signal", "smoke://signal: cannot reach a scheduler: "),
    ],
)
def test_a_wrong_scheduler_is_told_in_one_line(where, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("empty.json").write_text("{}")
    Path("five.json").write_text('{"address": 5}')
    with pytest.raises(UsageError) as caught, Cluster(where, patience=1.0):
        pass
    assert str(caught.value).startswith(told)
    assert "\n" not in str(caught.value)


def test_threads_of_one_worker_give_the_file_of_the_local_pool(started, tmp_path):
    """Solutions live side by side in one process."""
    swept = ("sweep.operation.speed=[1000 rpm, 2000 rpm, 3000 rpm]", "sweep.oil_supply.ratio=[1, 2, 3, 4]")
    paper = load(Path(__file__).parents[2] / "configs" / "paper" / "point.yaml", swept)
    run_sweep(paper, tmp_path / "local.h5", jobs=1)
    folder = tmp_path / "threads"
    folder.mkdir()
    file = folder / "scheduler.json"
    local = ("--host", "127.0.0.1", "--no-dashboard")
    programs = [started("scheduler", *local, "--port", "0", "--scheduler-file", str(file), folder=folder)]
    one = ("worker", "--scheduler-file", str(file), "--nthreads", "6", "--no-nanny", *local)
    try:
        programs.append(started(*one, folder=folder))
        wait_for_scheduler(file)
        run_sweep(paper, tmp_path / "out.h5", scheduler=str(file))
    finally:
        for program in reversed(programs):
            program.terminate()
            program.wait(60)
    here, there = open_results(tmp_path / "local.h5"), open_results(tmp_path / "out.h5")
    for group in ("performance", "balance", "error"):
        for name, values in getattr(here, group).items():
            np.testing.assert_array_equal(getattr(there, group)[name], values, err_msg=f"{group}.{name}")
