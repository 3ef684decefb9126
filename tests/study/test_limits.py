"""What a study refuses before it begins, and what may happen beside it while it runs."""

import errno
import io
import math
import os
import sys
from collections.abc import Callable

import pytest
from result_fakes import GRID, SCENE, fake_simulate, scene
from sweep_fakes import assert_same, chained, forbidden, grid_scene

from screwsim.cli import exit_code
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.results import atomic
from screwsim.scene.grid import MOST_CASES
from screwsim.study.asked.spans import Span
from screwsim.study.pool.progress import OccasionalLine, Progress, TerminalBar, for_terminal
from screwsim.study.sweep import run_sweep
from screwsim.study.uncertainty.sobol import sensitivity

pytestmark = pytest.mark.usefixtures("one_moment")


@pytest.mark.parametrize("limit", [math.inf, -math.inf, math.nan, 0.0, -1.0, 1e9, 1e300])
def test_a_limit_that_is_no_time_is_refused(limit, tmp_path):
    with pytest.raises(UsageError, match=r"--case-limit \S+: is not a time from 0\.001 to 1e\+08 seconds \(leave it"):
        run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, case_limit=limit, simulate=forbidden)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("limit", ["inf", "nan", "0", "-3", "1e30"])
def test_the_command_tells_it_as_wrong_use(limit, tmp_path, capsys):
    (tmp_path / "scene.yaml").write_text(SCENE + GRID)
    arguments = ["sweep", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "out.h5"), f"--case-limit={limit}"]
    assert exit_code(arguments) == 2
    assert "--case-limit" in capsys.readouterr().err and not (tmp_path / "out.h5").exists()


@pytest.mark.parametrize("limit", [0.5, 1e8])
def test_limits_that_are_times_hold(limit, tmp_path):
    assert run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, case_limit=limit, simulate=fake_simulate).failed == 3


@pytest.mark.parametrize("jobs", [0, -1])
def test_no_workers_are_refused(jobs, tmp_path):
    with pytest.raises(UsageError, match=f"jobs: {jobs} is not a number of workers"):
        run_sweep(grid_scene(), tmp_path / "out.h5", jobs=jobs, simulate=forbidden)


LONG = "{from: 1, to: 2, count: 100000}"
SPEEDS = "operation.speed: {from: 1000 rpm, to: 2000 rpm, count: 1000}"
PRESSURES = "operation.discharge.pressure: {from: 5 bar, to: 9 bar, count: 100}"
FIVE = ", ".join(
    f"{path}: {{from: {low}, to: {high}, count: 10000}}"
    for path, low, high in (
        ("oil_supply.ratio", "1", "2"),
        ("oil_supply.temperature", "300 K", "320 K"),
        ("operation.discharge.pressure", "5 bar", "9 bar"),
        ("operation.speed", "1000 rpm", "2000 rpm"),
        ("machine.volume.max", "1 l", "2 l"),
    )
)


@pytest.mark.parametrize(
    ("sweep", "cases"),
    [
        (f"oil_supply.ratio: {LONG}, {SPEEDS}, {PRESSURES}", "10,000,000,000"),
        (FIVE, "1e+20"),
        (
            "sample: {kind: sobol, count: 1048576, over: {oil_supply.ratio: {from: 1, to: 2}}}, "
            "operation.speed: {from: 1000 rpm, to: 2000 rpm, count: 10}",
            "10,485,760",
        ),
        (
            f"zip: [{{oil_supply.ratio: {LONG}}}], operation.speed: {{from: 1000 rpm, to: 2000 rpm, count: 101}}",
            "10,100,000",
        ),
    ],
)
def test_a_grid_that_no_one_can_mean_is_a_fault_of_the_scene(sweep, cases):
    with pytest.raises(SceneError) as caught:
        scene(SCENE + f"sweep: {{{sweep}}}\n")
    told = f"sweep: has {cases} cases, more than the 10,000,000 that one study may have (use fewer values, or split it)"
    assert len(caught.value.lines) == 1 and caught.value.lines[0].endswith(told)


def test_the_largest_grid_loads():
    axes = "oil_supply.ratio: {from: 1, to: 2, count: 100000}, operation.speed: {from: 1 rpm, to: 9 rpm, count: 100}"
    assert MOST_CASES == 10_000_000 == 100 * len(scene(SCENE + f"sweep: {{{axes}}}\n").sweep["oil_supply.ratio"])


def test_a_sample_that_no_one_can_mean_is_refused_before_it_is_drawn():
    spans = [Span("operation.speed", 100.0, 200.0)]
    with pytest.raises(
        UsageError, match=r"--samples 1099511627776: has 3,298,534,883,328 cases, more than the 10,000,"
    ):
        sensitivity(scene(), spans, samples=2**40, simulate=forbidden)


class Puts:
    """Progress in which something comes to a place after some parts."""

    def __init__(self, put: Callable[[], object], after: int = 2) -> None:
        self.put, self.left = put, after

    def start(self, cases: int, reused: int) -> None: ...

    def advance(self, cases: int, failed: int) -> None:
        self.left -= 1
        if not self.left:
            self.put()

    def tick(self) -> None: ...

    def stop(self) -> None: ...


@pytest.mark.parametrize("links", [True, False])
def test_a_file_that_comes_to_the_output_meanwhile_stays_and_nothing_is_lost(links, tmp_path, monkeypatch):
    output = tmp_path / "out.h5"
    if not links:
        monkeypatch.setattr(atomic.os, "link", no_links)
    told = r"out\.h5: another file was put there meanwhile, and is kept; all cases are finished, in .*out\.h5\.parts "
    r"\(move"
    with pytest.raises(UsageError, match=told) as caught:
        mine = Puts(lambda: output.write_text("my thesis"))
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained, progress=mine)
    assert "\n" not in str(caught.value)
    assert output.read_text() == "my thesis"
    output.unlink()
    assert run_sweep(grid_scene(), output, jobs=1, simulate=forbidden).reused == 120
    run_sweep(grid_scene(), tmp_path / "one.h5", jobs=1, simulate_many=chained)
    assert_same(output, tmp_path / "one.h5")
    assert sorted(os.listdir(tmp_path)) == ["one.h5", "out.h5"]


def no_links(*_) -> None:
    raise OSError(errno.EPERM, os.strerror(errno.EPERM))


def test_a_restart_replaces_its_own_old_file_and_no_other(tmp_path):
    output = tmp_path / "out.h5"
    run_sweep(grid_scene(), output, jobs=1, simulate=fake_simulate)
    assert run_sweep(grid_scene(), output, jobs=1, restart=True, simulate=fake_simulate).reused == 0

    def replaced() -> None:
        (tmp_path / "other").write_text("my thesis")
        os.replace(tmp_path / "other", output)

    with pytest.raises(UsageError, match="another file was put there meanwhile"):
        run_sweep(grid_scene(), output, jobs=1, restart=True, simulate=fake_simulate, progress=Puts(replaced))
    assert output.read_text() == "my thesis"


class Gone(io.StringIO):
    """A terminal that goes away after some letters."""

    def __init__(self, error: Exception, letters: int) -> None:
        super().__init__()
        self.error, self.letters = error, letters

    def isatty(self) -> bool:
        return True

    def write(self, text: str) -> int:
        self.letters -= len(text)
        if self.letters < 0:
            raise self.error
        return len(text)


@pytest.mark.parametrize("letters", [0, 200, 2000])
@pytest.mark.parametrize("error", [BrokenPipeError(), OSError(errno.EIO, "gone"), ValueError("closed file")])
def test_a_terminal_that_goes_fails_no_sweep(error, letters, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys, "stderr", Gone(error, letters))
    out = sys.stdout
    assert isinstance(for_terminal(), TerminalBar)
    summary = run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, simulate=fake_simulate, progress=for_terminal())
    assert summary.cases == 120 and sys.stdout is out and isinstance(sys.stderr, Gone)


def test_without_a_stderr_nothing_is_told(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    assert type(for_terminal()) is Progress
    closed = io.StringIO()
    closed.close()
    monkeypatch.setattr(sys, "stderr", closed)
    assert type(for_terminal()) is Progress


def test_a_log_gets_a_line_of_a_long_study_whenever_twice_as_long_has_passed(capsys):
    now = [0.0]
    told = OccasionalLine("plan", clock=lambda: now[0])
    told.start(202, 2)
    for second in range(1, 101):
        now[0] = float(second)
        told.advance(2, int(second == 15))
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        "screwsim: plan: continues with 2 of 202 that were there",
        "screwsim: plan: 22 of 202 in 10 s, about 90 s left",
        "screwsim: plan: 42 of 202 in 20 s, 1 not ok, about 80 s left",
        "screwsim: plan: 82 of 202 in 40 s, 1 not ok, about 60 s left",
        "screwsim: plan: 162 of 202 in 80 s, 1 not ok, about 20 s left",
    ]


def test_a_study_whose_first_case_takes_long_gives_a_sign_of_life(capsys):
    now = [0.0]
    told = OccasionalLine("sweep", clock=lambda: now[0])
    told.start(3, 0)
    now[0] = 35.0
    told.tick()
    told.tick()
    assert capsys.readouterr().err == "screwsim: sweep: 0 of 3 in 35 s\n"
