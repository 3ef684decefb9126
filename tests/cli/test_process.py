"""The process of a command ends at once, and nothing is lost by that; streams that nobody reads, and Ctrl-C."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import screwsim

pytestmark = pytest.mark.around
MAIN = "import sys; sys.argv = ['screwsim', {!r}]; from screwsim.cli import main; main()"
FINALIZED = "class A:\n    def __del__(self): print('taken apart', flush=True)\na = A()\n"  # what Python's own end does

OUTLIVES = "threading.main_thread().join()"


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
        (f"import threading; threading.Thread(target=lambda: ({OUTLIVES}, print('waited'))).start()", {}),
        ("print('waited')", {"SCREWSIM_DEBUG": "1"}),
    ],
)
def test_python_ends_a_process_with_other_threads_or_under_a_profiler(before, environment):
    found = ended(before, **environment)
    assert found.returncode == 0
    assert "waited" in found.stdout and "taken apart" in found.stdout


def test_letters_that_a_stream_has_not_are_written_out():
    last = "import atexit; atexit.register(lambda: sys.stdout.write('20 °C'))"
    found = ended(last, PYTHONIOENCODING="ascii")
    assert found.returncode == 0
    assert found.stdout.endswith(r"20 \xb0C")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
@pytest.mark.parametrize("argument", ["--version", "schema"])
def test_output_that_finds_no_room_is_told_in_one_line(argument):
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-c", MAIN.format(argument)]
        found = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    assert found.returncode == 2
    assert found.stderr.startswith("standard output: cannot be written: No space left on device (make room")
    assert len(found.stderr.splitlines()) == 1


# ---- streams that nobody reads -------------------------------------------------------------------------------


@pytest.mark.parametrize("argument", ["--version", "schema", "--help"])
def test_a_reader_that_has_seen_enough_is_no_error(argument):
    reading, writing = os.pipe()
    os.close(reading)  # as `| head -1` does, sooner or later
    try:
        command = [sys.executable, "-m", "screwsim", argument]
        found = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True)
    finally:
        os.close(writing)
    assert (found.returncode, found.stderr) == (0, "")


def test_what_comes_after_the_output_is_done_though_nobody_reads_it():
    reading, writing = os.pipe()
    os.close(reading)
    text = "import sys\nfrom screwsim import cli\n"
    text += "def report(*_):\n    for _ in range(9): print('x' * 9999, flush=True)\n"
    text += (
        "    print('done', file=sys.stderr)\n    raise cli.UsageError('a fault')\ncli.options.loaded_scene = report\n"
    )
    command = [sys.executable, "-c", text + "import sys; sys.argv = ['screwsim', 'explain', 'x']; cli.main()"]
    try:
        found = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True)
    finally:
        os.close(writing)
    assert (found.returncode, found.stderr) == (2, "done\na fault\n")


@pytest.mark.skipif(os.name != "posix", reason="closes a stream before the command starts")
@pytest.mark.parametrize("closed", [(2,), (1, 2), (0, 1, 2)])
def test_closed_streams_fail_no_sweep(folder, closed):
    def close() -> None:
        for number in closed:
            os.close(number)

    (folder / "worse.yaml").write_text("base: swept.yaml\nsweep:\n  operation.speed: [1 rpm/s]\n")
    for scene, code in (("swept.yaml", 0), ("worse.yaml", 3)):
        command = [sys.executable, "-m", "screwsim", "sweep", scene, "-o", "out.h5", "--jobs", "2"]
        found = subprocess.run(command, stdout=subprocess.PIPE, preexec_fn=close, text=True)
        assert found.returncode == code
        assert ("2 ok" in found.stdout) == (code == 0 and 1 not in closed)
    assert screwsim.open_results("out.h5").shape == (2,)


# ---- Ctrl-C --------------------------------------------------------------------------------------------------

PRESS = "import os, signal, time\ndef press(): signal.raise_signal(signal.SIGINT)\n"
COMMAND = "from screwsim import cli; cli.options.loaded_scene = loaded\n" + MAIN.format("explain").replace(
    "]", ", 'x']"
)
SWALLOWED = {
    "another error": "    try: press()\n    except KeyboardInterrupt: raise KeyError('a signature')\n",
    "nothing": "    try: press()\n    except KeyboardInterrupt: raise SystemError('a result with an exception set')\n",
    "an end": "    try: press()\n    except KeyboardInterrupt: raise cli.UsageError('the scheduler was lost')\n",
    "a call back": "    class A:\n        def __del__(self): press()\n    A()\n    raise KeyError('no object')\n",
    "a call back amid work": "    class A:\n        def __del__(self): press()\n    A()\n    time.sleep(60)\n",
    "itself": "    press()\n",
    "a second one, at once": "    try: press()\n    finally: press()\n",
    "a second one, insisting": "    try: press()\n    finally:\n        time.sleep(0.6); press(); time.sleep(60)\n",
    "one at the end": "    import atexit; atexit.register(press); press()\n",
}


@pytest.mark.parametrize("became", SWALLOWED)
def test_ctrl_c_is_an_interruption_whatever_became_of_it(became):
    text = PRESS + "def loaded(*_):\n" + SWALLOWED[became] + COMMAND
    found = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=50)
    assert (found.returncode, found.stdout, found.stderr) == (130, "", "interrupted\n")


def test_a_signal_to_end_is_an_interruption():
    """Batch systems send it; without a handler a command died without a word, and its workers lived on."""
    text = PRESS.replace("SIGINT", "SIGTERM") + "def loaded(*_):\n" + SWALLOWED["itself"] + COMMAND
    found = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=50)
    assert (found.returncode, found.stdout, found.stderr) == (130, "", "interrupted\n")


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timer raises a lost interruption again")
def test_a_lost_ctrl_c_is_not_raised_again_while_the_interruption_is_told():
    slow = "def tell(*_):\n    print('told'); time.sleep(0.3); return 130\n"
    slow += "cli.print_error = tell\n"
    text = PRESS + "def loaded(*_):\n" + SWALLOWED["a call back"] + COMMAND.replace("cli; ", f"cli\n{slow}", 1)
    found = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=50)
    assert (found.returncode, found.stdout, found.stderr) == (130, "told\n", "")


def test_ctrl_c_while_the_command_is_imported_is_one_line():
    text = "import sys\nclass Finder:\n    def find_spec(self, name, *_):\n        if name == 'screwsim.cli': press()\n"
    text += "sys.meta_path.insert(0, Finder())\nfrom screwsim.__main__ import main; main()"
    found = subprocess.run([sys.executable, "-c", PRESS + text], capture_output=True, text=True)
    assert (found.returncode, found.stdout, found.stderr) == (130, "", "interrupted\n")


def test_the_end_of_a_file_is_no_interruption():
    text = "def loaded(*_): raise EOFError('Ran out of input')\n" + COMMAND
    found = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True)
    assert found.returncode == 1
    assert "internal error: EOFError: Ran out of input\n" in found.stderr and "interrupted" not in found.stderr


def test_a_full_disk_is_not_taken_for_standard_output():
    text = "def loaded(*_): raise OSError(28, 'No space left on device')\n" + COMMAND
    found = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True)
    assert found.returncode == 2
    assert found.stderr.startswith("a file: cannot be written: No space left on device (")


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [0.0, 0.1, 0.25])
def test_ctrl_c_while_compiling_is_one_line(folder, seconds):
    environment = os.environ | {"SCREWSIM_CACHE": str(folder / "cache")}
    command = [sys.executable, "-m", "screwsim", "run", "small.yaml"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, env=environment, text=True, **pipes) as running:
        assert running.stderr is not None
        assert "compiling" in running.stderr.readline()
        time.sleep(seconds)
        running.send_signal(signal.SIGINT)
        out, err = running.communicate()
    told = [line for line in err.splitlines() if not line.startswith("screwsim: compil")]
    assert (running.returncode, told) == (130, ["interrupted"]) or "status: ok" in out  # on a fast machine
    assert not list(Path(folder / "cache").glob("*.tmp"))
