"""Simulators for sweeps: slow, deadly, faulty; functions of a module, so that workers can be given them."""

import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from multiprocessing import connection
from multiprocessing.process import BaseProcess
from pathlib import Path

import numpy as np
from apart import begun
from result_fakes import CYCLE, SCENE, fake_simulate, scene
from result_fakes import GRID as GRID_OF_FAKES

import screwsim
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.results import open_results
from screwsim.scene import Scene, loads
from screwsim.study.sweep import run_sweep

HERE = Path(__file__).parent
PACKAGE = Path(screwsim.__file__).parents[1]
FOUND = (str(HERE), *(str(HERE.parent / name) for name in ("results", "tools")), str(PACKAGE))
RATIOS = 40  # on the last axis: three blocks a row
GRID = f"""\
sweep:
  operation.speed: [1000 rpm, 2000 rpm, 3000 rpm]
  oil_supply.ratio: {{from: 0, to: {RATIOS - 1}, count: {RATIOS}}}
"""


def grid_scene(extra: str = CYCLE) -> Scene:
    """Return a scene of 3 speeds × 40 ratios."""
    return scene(SCENE + GRID + extra)


def chained(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Give results in which all predecessors leave their trace; a case that fails leaves the next a cold start."""
    memory = 0.0
    for case in scenes:
        result = fake_simulate(case)
        memory = 0.5 * memory + case.operation.speed + case.oil_supply.ratio if result.status != "failed" else 0.0
        if result.performance:
            figures = Figures(result.performance | {"volumetric_efficiency": memory})
            result = replace(result, performance=figures)
        yield result


def slow(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Take 5 ms a case."""
    for result in chained(scenes):
        time.sleep(0.005)
        yield result


def dawdling(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Take 50 ms a case."""
    for result in chained(scenes):
        time.sleep(0.05)
        yield result


def crawling(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Take a quarter of a second a case."""
    for result in chained(scenes):
        time.sleep(0.25)
        yield result


def deadly(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Kill the process at ratio 7."""

    def watched() -> Iterator[Scene]:
        for case in scenes:
            if case.oil_supply.ratio == 7.0:
                os._exit(9)
            yield case

    return chained(watched())


def deadly_in_a_row(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Kill the process at ratio 7 and 2000 rpm, but only after another case."""
    for number, result in enumerate(chained(scenes)):
        figures = result.performance
        if number and figures and figures["oil_ratio"] == 7.0 and 2000.0 < figures["shaft_power"] < 2200.0:
            os._exit(9)
        yield result


def endless(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Never end at ratio 7 and 1000 rpm."""

    def watched() -> Iterator[Scene]:
        for case in scenes:
            while case.oil_supply.ratio == 7.0 and case.operation.speed < 110.0:
                pass
            yield case

    return chained(watched())


def mortal(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Leave the process's number in the file that SWEEP_FAKES_PIDS names, for others to kill it; 5 ms a case."""
    with open(os.environ["SWEEP_FAKES_PIDS"], "a") as stream:
        stream.write(f"{os.getpid()}\n")
    return slow(scenes)


def torn(once: Path, scenes: Iterable[Scene]) -> Iterator[Result]:
    """Be killed when half of the results are sent, where a file is there, which goes then."""
    with suppress(FileNotFoundError):
        once.unlink()
        connection.Connection._send = _half  # of this process, which ends with it
    return chained(scenes)


def _half(self: connection.Connection, raw: bytes, *_: object) -> None:
    os.write(self.fileno(), raw[: len(raw) // 2])
    os.kill(os.getpid(), signal.SIGKILL)


def stuck(scenes: Iterable[Scene]) -> Iterator[Result]:
    """Stop when half of the results are sent, and make the file that SWEEP_FAKES_PIDS names."""
    connection.Connection._send = _half_and_wait  # of this process
    return chained(scenes)


def _half_and_wait(self: connection.Connection, raw: bytes, *_: object) -> None:
    os.write(self.fileno(), raw[: len(raw) // 2])
    Path(os.environ["SWEEP_FAKES_PIDS"]).touch()
    time.sleep(60.0)


def faulty(case: Scene) -> Result:
    """Raise at ratio 2."""
    if case.oil_supply.ratio == 2.0:
        raise ZeroDivisionError("float division\nby zero")
    return fake_simulate(case)


def forbidden(case: Scene) -> Result:
    """Be called by nobody."""
    raise AssertionError(f"computed again: {case.operation.speed}, {case.oil_supply.ratio}")


def note_warm_up(case: Scene) -> None:
    """Add a line to the file that SWEEP_FAKES_WARM names."""
    with open(os.environ["SWEEP_FAKES_WARM"], "a") as stream:
        stream.write(f"{os.getpid()}\n")


def environment() -> dict[str, str]:
    """Return an environment in which this module and the package can be imported."""
    return os.environ | {"PYTHONPATH": os.pathsep.join(FOUND)}


def start(output: Path, jobs: int, simulator: str = "slow") -> subprocess.Popen:
    """Start a slow sweep in a process of its own."""
    call = f"f.run_sweep(f.grid_scene(), {str(output)!r}, jobs={jobs}, simulate_many=f.{simulator})"
    command = [sys.executable, "-c", f"import sweep_fakes as f; {call}"]
    return subprocess.Popen(command, env=environment(), stderr=subprocess.PIPE)


def begin(output: Path, jobs: int, simulator: Callable[..., Iterator[Result]] = slow) -> BaseProcess:
    """Start a slow sweep in a fork; what it prints on stderr is in the file err beside."""
    return begun(_sweep_apart, output, jobs, simulator, folder=output.parent)


def _sweep_apart(output: Path, jobs: int, simulator: Callable[..., Iterator[Result]]) -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)  # the server of forks leaves Ctrl-C to others
    run_sweep(grid_scene(), output, jobs=jobs, simulate_many=simulator)


def sweep_of_mine(chunks: int) -> None:
    """Sweep over a scene with the effect identity_effects.mine, stopped after some chunks; print what comes of it."""
    sys.dont_write_bytecode = True
    own = loads(SCENE + "  identity_effects.mine:\n" + GRID_OF_FAKES)
    try:
        print(run_sweep(own, "out.h5", jobs=1, simulate=fake_simulate, progress=StopAfter(chunks)).reused)
    except (KeyboardInterrupt, UsageError) as error:
        print(str(error) or "stopped")


def swept_with(pids: Path, output: Path) -> None:
    """Sweep on two workers that leave their numbers in a file."""
    os.environ["SWEEP_FAKES_PIDS"] = str(pids)
    run_sweep(grid_scene(), output, jobs=2, simulate_many=mortal)


def forked(pids: Path, output: Path) -> multiprocessing.Process:
    """Start `swept_with` in a process of its own, forked from one that has imported all it needs."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["__main__", __name__])
    process = context.Process(target=swept_with, args=(pids, output))
    process.start()
    return process


def parts_of(output: Path) -> Path:
    """Return the folder of a sweep's parts."""
    return output.with_name(output.name + ".parts")


def held(output: Path) -> int:
    """Return how many cases the parts of a sweep hold."""
    names = [file.stem.split("_") for file in parts_of(output).glob("cases_*.npz")]
    return sum(int(stop) - int(start) for _, start, stop in names)


def wait_for_parts(output: Path, count: int) -> int:
    """Wait until a sweep has stored `count` parts; return how many cases they hold."""
    deadline = time.monotonic() + 60.0
    while len(list(parts_of(output).glob("cases_*.npz"))) < count:
        assert time.monotonic() < deadline, "the sweep stores no parts"
        time.sleep(0.005)
    return held(output)


def without_moments(path: Path) -> bytes:
    """Return a file's bytes without the moments at which it was written."""
    return re.sub(rb"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", b"", path.read_bytes())


COMPARED = "inputs", "performance", "balance", "error", "numerics", "cycle", "ledger"


def assert_same(one: Path, other: Path) -> None:
    """Assert that two files differ in nothing but their history."""
    if without_moments(one) == without_moments(other):
        return
    (first, said), (second, also_said) = (held_by(each, each.stat().st_mtime_ns) for each in (one, other))
    assert said == also_said
    for group, left in first.items():
        right = second[group]
        assert list(left) == list(right)
        for name in left:
            np.testing.assert_array_equal(left[name], right[name], err_msg=f"{group}.{name}")


@lru_cache(maxsize=8)  # a reference is read once for all that are held against it
def held_by(path: Path, written: int) -> tuple[dict[str, dict[str, np.ndarray]], dict[str, object]]:
    """Return the groups of a file that was written at that time, and its attributes but the history."""
    results = open_results(path)
    groups = {group: dict(getattr(results, group).items()) for group in COMPARED}
    return groups, {name: value for name, value in results.attributes.items() if name != "history"}


class StopAfter:
    """Progress that interrupts after some parts; 0: never."""

    def __init__(self, parts: int) -> None:
        self.left = parts

    def start(self, cases: int, reused: int) -> None: ...

    def advance(self, cases: int, failed: int) -> None:
        self.left -= 1
        if not self.left:
            raise KeyboardInterrupt

    def tick(self) -> None: ...

    def stop(self) -> None: ...


__all__ = ["run_sweep"]
