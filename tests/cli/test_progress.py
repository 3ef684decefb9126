"""Progress of a sweep in a terminal, and what Ctrl-C leaves, with the program as people run it."""

import os
import pty
import re
import select
import sys
import time
from pathlib import Path

import pytest

import screwsim
from screwsim import cli

pytestmark = pytest.mark.around
PARTS = Path("grid.h5.parts")
GRID = "sweep.operation.speed={from: 2000 rpm, to: 4000 rpm, count: 400}"
COMMAND = ("sweep", "small.yaml", "--set", GRID, "--set", "numerics.accuracy=1e-5", "-o", "grid.h5")


def in_terminal(*arguments: str, interrupt_after: int = 0, columns: int = 80) -> tuple[int, str]:
    """Run the program in a terminal of 80 columns; press Ctrl-C when so many parts are there."""
    child, terminal = pty.fork()
    if not child:
        path = str(Path(screwsim.__file__).parents[1])
        os.environ.update(PYTHONPATH=path, COLUMNS=str(columns), TERM="xterm")
        os.execv(sys.executable, [sys.executable, "-m", "screwsim", *arguments])
    shown, deadline = b"", time.monotonic() + 120.0
    while time.monotonic() < deadline:
        if interrupt_after and PARTS.is_dir() and len(list(PARTS.glob("*.npz"))) >= interrupt_after:
            os.write(terminal, b"\x03")
            interrupt_after = 0
        if not select.select([terminal], [], [], 0.05)[0]:
            continue
        try:
            read = os.read(terminal, 65536)
        except OSError:  # the last process has closed it
            break
        if not read:
            break
        shown += read
    os.close(terminal)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), shown.decode()


def lines(shown: str) -> list[str]:
    """Return what a terminal showed, line by line, without its control sequences."""
    return re.split(r"[\r\n]+", re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown))


def test_ctrl_c_ends_with_130_and_the_next_run_resumes(folder):
    code, shown = in_terminal(*COMMAND, "--jobs", "2", interrupt_after=3)
    assert code == 130
    assert "interrupted; the same command resumes the sweep" in lines(shown)
    assert "Traceback" not in shown
    assert not Path("grid.h5").exists()
    code, shown = in_terminal(*COMMAND, "--jobs", "2")
    assert code == 0
    [told] = [line for line in lines(shown) if "from an earlier run" in line]
    reused = re.search(r"400 cases: 400 ok .*\((\d+) from an earlier run\)", told)
    assert reused is not None
    assert 3 * 16 <= int(reused[1]) < 400


def test_the_bar_shows_cases_rate_time_left_and_failures_on_one_line(folder):
    # a discharge pressure below that of the suction line: a fault of these cases alone
    pressures = "sweep.operation.discharge.pressure={from: 1 bar, to: 12 bar, count: 100}"
    code, shown = in_terminal("sweep", "small.yaml", "--set", pressures, "-o", "grid.h5", "--jobs", "2")
    assert code == 4
    bars = [line for line in lines(shown) if line.startswith("sweep ")]
    assert len(bars) > 3
    assert all(len(line) <= 80 for line in bars)
    assert re.search(r"100/100 +\d+ points/s +0:00:00 +\d not ok *$", bars[-1])


@pytest.mark.parametrize("json", [(), ("--json",)])
def test_nothing_is_shown_when_stderr_is_no_terminal(json, folder, new_python):
    answer = new_python("-m", "screwsim", "sweep", "swept.yaml", "-o", "two.h5", "--jobs", "2", *json)
    assert answer.returncode == 0
    assert "points/s" not in answer.stderr
    assert "\x1b" not in answer.stdout + answer.stderr


def test_an_interrupted_optimisation_says_whether_anything_is_kept(tmp_path, monkeypatch, capsys):
    def interrupted(name):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "_parser", interrupted)
    file = str(tmp_path / "front.h5")
    command = ["optimize", "x.yaml", "-o", file]
    assert cli.exit_code(command) == 130
    assert (
        capsys.readouterr().err.strip().endswith("interrupted; the same command begins anew, as no batch was finished")
    )
    Path(f"{file}.parts").mkdir()
    assert cli.exit_code(command) == 130
    assert capsys.readouterr().err.strip().endswith("interrupted; the same command continues where it stopped")
    assert cli.exit_code(["optimize", "x.yaml"]) == 130
    assert capsys.readouterr().err.strip() == "interrupted"
