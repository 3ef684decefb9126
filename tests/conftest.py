"""What holds for all tests."""

import gc
import multiprocessing
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from _pytest.runner import runtestprotocol
from hypothesis import HealthCheck, settings

settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])  # no wall times
settings.load_profile("any machine")

# what tests compile is kept for all runs, in the checkout where no folder is named
os.environ.setdefault("SCREWSIM_CACHE", str(Path(__file__).parents[1] / ".pytest_cache" / "screwsim"))

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as a shell's job in the background; commands inherit it
    signal.signal(signal.SIGINT, signal.default_int_handler)

# scripts/test gives each process whole files, in this order: those that take longest come first, so that none is last
LONGEST = (
    "tests/hard/test_found_closings.py",
    "tests/hard/test_hard_cases.py",
    "tests/report/test_browser.py",
    "tests/template/test_new.py",
    "tests/laws/test_everything.py",
    "tests/laws/test_side_by_side.py",
    "tests/hard/test_fuzz.py",
    "tests/report/test_report.py",
    "tests/study/test_optimize.py",
    "tests/machine/rotors/test_solids.py",
    "tests/cli/test_kept.py",
    "tests/derivatives/test_against_differences.py",
    "tests/effects/test_each_effect.py",
    "tests/cli/test_start.py",
    "tests/study/test_sweep.py",
    "tests/study/test_storage.py",
    "tests/results/test_results.py",
    "tests/hard/test_mutate.py",
    "tests/study/test_stages.py",
    "tests/study/test_stages_uncertain.py",
    "tests/study/test_stages_optimum.py",
    "tests/study/test_stages_find.py",
    "tests/study/test_stages_sensitivity.py",
    "tests/study/test_stages_store.py",
    "tests/study/test_datasheet.py",
    "tests/laws/test_blends.py",
    "tests/laws/test_drive.py",
    "tests/cli/test_warned.py",
    "tests/explore/test_browser.py",
    "tests/hard/test_fuzz_effects.py",
    "tests/explore/test_server.py",
    "tests/codegen/test_modules.py",
    "tests/cli/test_process.py",
    "tests/laws/test_separator.py",
    "tests/border/test_foreign_results.py",
    "tests/laws/test_line_valve.py",
    "tests/model/test_series.py",
    "tests/hard/test_alike.py",
    "tests/docs/test_tutorial.py",
    "tests/machine/test_own_machines.py",
    "tests/docs/test_snippets.py",
    "tests/fluid/test_blends.py",
    "tests/study/test_accuracy.py",
    "tests/laws/test_ledger.py",
    "tests/effects/test_figures.py",
    "tests/numerics/test_derivative.py",
    "tests/derivatives/test_nearby_and_beside.py",
    "tests/study/test_kept_slopes.py",
    "tests/export/test_rotor_balance.py",
    "tests/hard/test_fuzz_fluids.py",
    "tests/study/test_measured.py",
    "tests/laws/test_dragged_oil.py",
    "tests/cli/test_rotors.py",
    "tests/study/test_refrigeration_sheet.py",
    "tests/validation/test_cagi.py",
    "tests/study/test_claims.py",
    "tests/cli/test_export.py",
    "tests/study/test_limits.py",
    "tests/derivatives/test_phases.py",
    "tests/study/test_cluster.py",
    "tests/model/test_straight_line.py",
    "tests/model/test_checked.py",
    "tests/laws/test_course.py",
    "tests/fluid/test_blend_dome.py",
    "tests/batch/test_on_device.py",
    "tests/house/test_names_of_effects.py",
    "tests/study/test_batch_sweep.py",
    "tests/laws/test_suction_line.py",
    "tests/cli/test_own_faults.py",
    "tests/cli/test_calibrate.py",
    "tests/laws/test_closing.py",
    "tests/numerics/test_kept_text.py",
    "tests/report/test_page.py",
    "tests/laws/test_real_gas.py",
    "tests/batch/test_tasks.py",
    "tests/scene/test_blends.py",
    "tests/study/test_kills.py",
    "tests/study/test_fluid_axis.py",
    "tests/study/test_culprits.py",
    "tests/laws/test_plenums.py",
    "tests/laws/test_ports.py",
    "tests/laws/test_cylinder.py",
    "tests/cli/test_run.py",
    "tests/laws/test_balances.py",
    "tests/laws/test_oil_film.py",
    "tests/laws/test_estimate.py",
    "tests/cli/test_local.py",
    "tests/study/test_sensitivity.py",
    "tests/laws/test_solubility_rate.py",
    "tests/validation/test_fits.py",
    "tests/study/test_accuracy_kept.py",
    "tests/machine/rotors/test_profiles.py",
    "tests/laws/test_capacity_control.py",
    "tests/docs/test_site.py",
    "tests/machine/test_profile_law.py",
    "tests/docs/test_notebooks.py",
    "tests/study/test_notebook.py",
    "tests/study/test_performance_map.py",
    "tests/house/test_house.py",
    "tests/cli/test_told.py",
    "tests/docs/test_reference_pages.py",
)
YOUNG = 50_000  # objects made between two searches for garbage; Python's own number is 700
gc.set_threshold(YOUNG, *gc.get_threshold()[1:])

# workers of sweeps start afresh beside pytest-xdist's threads, and commands that tests look at from outside (apart.py):
# from a process that has imported what they need
NEEDED = "screwsim.simulate", "screwsim.study.sweep.run", "screwsim.cli", "screwsim.results", "h5py", "rich.table"
BUILT_OF = (
    "screwsim.codegen.machine",
    *(  # what builds any scene, and loads what is compiled of it
        f"screwsim.effects.{file.stem}"
        for file in sorted(Path(__file__).parents[1].glob("src/screwsim/effects/[!_]*.py"))
    ),
)
multiprocessing.get_context("forkserver").set_forkserver_preload([*NEEDED, *BUILT_OF])

WHOLE = re.compile(r"^pytestmark = (\[[^]]*\]|.*)", re.MULTILINE)  # marks of a whole file
SOURCES = str(Path(__file__).parents[1] / "src")
NAMES = ("SCREWSIM_CACHE", "SCREWSIM_PRIVATE_CACHE", "XDG_CACHE_HOME")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave whole files of `around` unread where none of them runs: some read all pages before their first test."""
    if config.option.markexpr != "not around" or collection_path.suffix != ".py":
        return None
    marked = WHOLE.search(collection_path.read_text(encoding="utf-8"))
    return True if marked and "mark.around" in marked[0] else None


def pytest_configure(config: pytest.Config) -> None:
    """Take what other methods found of scenes as it is stored, where scripts/test does not run all (`known.py`)."""
    if config.option.markexpr == "not around":
        os.environ.setdefault("SCREWSIM_KNOWN", "stored")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files that take longest first, and leave all else in its order."""
    root, last = Path(__file__).parents[1], len(LONGEST)
    place = {root / name: number for number, name in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.path, last))


def pytest_collection_finish() -> None:
    """Take what was imported and collected, some million objects, out of the searches for garbage."""
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Leave out of what passed the words by which a test can be chosen: to send them takes as long as all else."""
    report = yield
    if report.passed:
        report.keywords = {}
    return report


def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
    """Let pytest-xdist's workers tell once that a test passed, not also of what came before and after it.

    These two thirds of all messages take a worker and the process that prints them half a millisecond a test; with
    --durations they are asked for.
    """
    if not hasattr(item.config, "workerinput") or item.config.option.durations is not None:
        return None
    tell = item.ihook
    tell.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    for report in runtestprotocol(item, log=False, nextitem=nextitem):
        if report.when == "call" or not report.passed:
            tell.pytest_runtest_logreport(report=report)
    tell.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


@pytest.fixture(scope="module")
def browser():
    """Return Debian's Chromium; what playwright would download is not wanted."""
    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium") or shutil.which("chromium-browser")
    assert path, "no chromium on PATH (apt-get install chromium, or leave these tests out with -m 'not browser')"
    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture(scope="session")
def sketch() -> Callable[[Any, Path, str], list[str]]:
    """Return what stands for `report.style.write`: all that a figure holds is drawn, but small, once, as it lies."""

    def write(figure: Any, folder: Path, name: str) -> list[str]:
        figure.set_dpi(30)
        figure.set_layout_engine("none")
        paths = [folder / f"{name}.{form}" for form in ("png", "pdf")]
        figure.canvas.print_png(paths[0])
        shutil.copy(paths[0], paths[1])
        return [str(path) for path in paths]

    return write


@pytest.fixture
def sketched(monkeypatch: pytest.MonkeyPatch, sketch: Callable[[Any, Path, str], list[str]]) -> None:
    """Sketch figures where a test asks which there are; how they are written is asked in tests/cli/test_rotors.py."""
    monkeypatch.setattr("screwsim.report.style.write", sketch)


@pytest.fixture
def python() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Return a function that runs a text in a new Python, with no cache named but by `variables` (None: unset)."""

    def call(text: str, **variables: str | None) -> subprocess.CompletedProcess[str]:
        inherited = {name: value for name, value in os.environ.items() if name not in NAMES}
        changed = inherited | {"PYTHONPATH": SOURCES} | variables
        environment = {name: value for name, value in changed.items() if value is not None}
        return subprocess.run([sys.executable, "-c", text], env=environment, capture_output=True, text=True)

    return call


class Answer(NamedTuple):
    """How a command ended, and what it printed."""

    code: int
    out: str
    err: str


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Callable[..., Answer]:
    """Return a function that runs `screwsim ARGUMENTS…` in this process."""
    from screwsim import cli

    def call(*arguments: object) -> Answer:
        code = cli.exit_code([str(each) for each in arguments])
        return Answer(code, *capsys.readouterr())

    return call
