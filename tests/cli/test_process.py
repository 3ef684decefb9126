"""The process of a command ends at once, and nothing is lost by that."""

import os
import subprocess
import sys

import pytest

MAIN = "import sys; sys.argv = ['screwsim', {!r}]; from screwsim.cli import main; main()"
FINALIZED = "class A:\n    def __del__(self): print('taken apart', flush=True)\na = A()\n"  # what Python's own end does


def ended(before: str, argument: str = "--version", **environment: str) -> subprocess.CompletedProcess[str]:
    program = FINALIZED + before + "\n" + MAIN.format(argument)
    inherited = {name: value for name, value in os.environ.items() if name != "SCREWSIM_DEBUG"}
    command = [sys.executable, "-c", program]
    return subprocess.run(command, capture_output=True, text=True, env=inherited | environment)


def test_output_is_whole_and_what_is_registered_for_the_end_is_done():
    found = ended("import atexit; atexit.register(print, 'at the end')")
    assert found.returncode == 0
    assert found.stdout.splitlines()[0].startswith("screwsim ")
    assert found.stdout.splitlines()[1:] == ["at the end"]


def test_the_exit_code_is_that_of_the_command():
    found = ended("", "no-such-command")
    assert found.returncode == 2
    assert "no-such-command" in found.stderr


@pytest.mark.parametrize(
    ("before", "environment"),
    [
        ("import threading, time; threading.Thread(target=lambda: (time.sleep(0.3), print('waited'))).start()", {}),
        ("print('waited')", {"SCREWSIM_DEBUG": "1"}),
    ],
)
def test_python_ends_a_process_with_other_threads_or_under_a_profiler(before, environment):
    found = ended(before, **environment)
    assert found.returncode == 0
    assert "waited" in found.stdout and "taken apart" in found.stdout


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
@pytest.mark.parametrize("argument", ["--version", "schema"])
def test_output_that_finds_no_room_is_told_in_one_line(argument):
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-c", MAIN.format(argument)]
        found = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    assert found.returncode == 2
    assert found.stderr.startswith("standard output: cannot be written: No space left on device (make room")
    assert len(found.stderr.splitlines()) == 1
