"""The command prints its address, solves behind it and ends with all its processes; faults have their exit codes."""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from explore_line import PAPER, Line

from screwsim.cli import exit_code
from screwsim.explore.serve import listen
from screwsim.scene import load

pytestmark = pytest.mark.around
SOURCES = str(Path(__file__).parents[2] / "src")


class Running:
    """A command that runs: its process, and the address that it printed."""

    def __init__(self, process):
        self.process = process
        self.said = process.stdout.readline()
        match = re.match(r"(http://(\S+?)/\S*) shows ", self.said)
        assert match, self.said
        self.url, self.host = match.groups()


@contextmanager
def running(*arguments, **variables):
    command = [sys.executable, "-m", "screwsim", "explore", *arguments, "--no-browser", "--port", "0"]
    if shutil.which("taskset") and hasattr(os, "sched_getaffinity"):  # one core, so that one worker compiles
        command = ["taskset", "-c", str(min(os.sched_getaffinity(0))), *command]
    environment = {**os.environ, "PYTHONPATH": SOURCES, **variables}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, env=environment, text=True, start_new_session=True, **pipes) as process:
        try:
            yield Running(process)
        finally:
            process.kill()


def children_of(parent):
    """Return the processes below one, as the system tells."""
    found = subprocess.run(["ps", "-eo", "pid=,ppid="], capture_output=True, text=True, check=True).stdout
    pairs = [tuple(map(int, line.split())) for line in found.splitlines()]
    below, left = [], [parent]
    while left:
        above = left.pop()
        mine = [pid for pid, its in pairs if its == above]
        below += mine
        left += mine
    return below


def is_alive(pid):
    state = Path(f"/proc/{pid}/stat")
    try:
        return state.read_text(encoding="ascii").rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def gone(pids, seconds=10.0):
    end = time.monotonic() + seconds
    while any(map(is_alive, pids)) and time.monotonic() < end:
        time.sleep(0.05)
    return not any(map(is_alive, pids))


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks Linux for the processes")
def test_the_command_compiles_and_tells_the_page_and_ctrl_c_ends_all(tmp_path):
    tmp_path.chmod(0o700)
    small = [f"--without={name}" for name in load(PAPER).effects if not name.endswith("_port")]  # compiled sooner
    with running(PAPER, "--set", "operation.speed=1500 rpm", *small, SCREWSIM_CACHE=str(tmp_path)) as found:
        with Line(found) as line:
            head = line.answer({}, blow_hole=True)
            assert head["status"] == "ok"
            assert any(note.startswith("compiling") for note in line.notes)
            assert any(note.startswith("compiled in") for note in line.notes)
            assert "--set 'operation.speed=1500 rpm'" in head["texts"]["shell"]
        below = children_of(found.process.pid)
        assert below
        found.process.send_signal(signal.SIGINT)
        assert found.process.wait(20.0) == 130
        assert found.process.stderr.read().splitlines()[-1] == "interrupted"
        assert gone(below)


@pytest.mark.parametrize("seconds", [0.0, 0.5])
def test_ctrl_c_while_the_workers_start_is_one_line(seconds):
    """A terminal sends it to all processes, also to the one that forks them and still imports."""
    with running(PAPER) as found:
        time.sleep(seconds)
        os.killpg(found.process.pid, signal.SIGINT)
        assert found.process.wait(20.0) == 130
        assert found.process.stderr.read().splitlines() == ["interrupted"]


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks Linux for the processes")
def test_workers_end_with_a_command_that_is_killed():
    with running(PAPER) as found:
        with Line(found) as line:
            assert line.answer()["status"] == "ok"
        below = children_of(found.process.pid)
        found.process.kill()
        assert gone(below)


def test_a_port_that_is_taken_is_a_wrong_use(capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert exit_code(["explore", PAPER, "--no-browser", "--port", str(port)]) == 2
    assert f"--port {port}: cannot listen there" in capsys.readouterr().err


def test_an_address_that_is_none_of_this_machine_is_a_wrong_use(capsys):
    assert exit_code(["explore", PAPER, "--no-browser", "--host", "192.0.2.1"]) == 2
    assert "--host 192.0.2.1" in capsys.readouterr().err


def test_a_scene_with_faults_is_told_before_anything_is_served(capsys, tmp_path):
    (tmp_path / "x.yaml").write_text(f"base: {PAPER}\noperation: {{speed: fast}}\n", encoding="utf-8")
    assert exit_code(["explore", str(tmp_path / "x.yaml"), "--no-browser"]) == 3
    assert "operation.speed" in capsys.readouterr().err


def test_without_the_extra_it_says_what_to_install(capsys, monkeypatch):
    monkeypatch.setattr("screwsim.explore.find_spec", lambda name: None)
    assert exit_code(["explore", PAPER]) == 2
    assert "pip install 'screwsim[explore]'" in capsys.readouterr().err


def test_the_loopback_address_asks_for_no_token_and_any_other_does():
    for host, asks in (("127.0.0.1", False), ("0.0.0.0", True)):
        address = listen(host, 0)
        address.socket.close()
        assert bool(address.rules.token) == asks == ("token=" in address.url)
        assert bool(address.rules.names) != asks
