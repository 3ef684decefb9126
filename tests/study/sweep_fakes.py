"""Simulators for sweeps: slow, deadly, faulty; functions of a module, so that workers can be given them."""

import os
import subprocess
import sys
import time
from pathlib import Path

from result_fakes import CYCLE, GRID, SCENE, fake_simulate, scene

import screwsim
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.study.sweep import run_sweep

HERE = Path(__file__).parent
PACKAGE = Path(screwsim.__file__).parents[1]


def grid_scene(extra: str = CYCLE) -> Scene:
    """Return a scene of 3 speeds × 10 ratios."""
    return scene(SCENE + GRID + extra)


def slow(case: Scene) -> Result:
    """Take 50 ms."""
    time.sleep(0.05)
    return fake_simulate(case)


def deadly(case: Scene) -> Result:
    """Kill the process at ratio 7."""
    if case.oil_supply.ratio == 7.0:
        os._exit(9)
    return fake_simulate(case)


def faulty(case: Scene) -> Result:
    """Raise at ratio 2."""
    if case.oil_supply.ratio == 2.0:
        raise ZeroDivisionError("float division\nby zero")
    return fake_simulate(case)


def forbidden(case: Scene) -> Result:
    """Be called by nobody."""
    raise AssertionError(f"computed again: {case.operation.speed}, {case.oil_supply.ratio}")


def start(output: Path, jobs: int) -> subprocess.Popen:
    """Start a slow sweep in a process of its own."""
    code = f"import sweep_fakes as f; f.run_sweep(f.grid_scene(), {str(output)!r}, jobs={jobs}, simulate=f.slow)"
    paths = (str(HERE), str(HERE.parent / "results"), str(PACKAGE))
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths)}
    return subprocess.Popen([sys.executable, "-c", code], env=environment, stderr=subprocess.PIPE)


def wait_for_parts(output: Path, count: int) -> int:
    """Wait until a sweep has stored `count` parts; return how many cases they hold."""
    folder = output.with_name(output.name + ".parts")
    deadline = time.monotonic() + 20.0
    while len(found := list(folder.glob("cases_*.npz"))) < count:
        assert time.monotonic() < deadline, "the sweep stores no parts"
        time.sleep(0.005)
    return sum(int(file.stem.split("_")[2]) - int(file.stem.split("_")[1]) for file in found)


__all__ = ["deadly", "faulty", "forbidden", "grid_scene", "run_sweep", "slow", "start", "wait_for_parts"]
