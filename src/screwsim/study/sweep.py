"""Sweeps: simulate every point of a scene's grid on all cores, resumable after any interruption."""

from __future__ import annotations

import os
import pickle
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.faults import UsageError
from screwsim.outputs import STATUSES, Result
from screwsim.results.atomic import make_folder
from screwsim.results.read import open_results
from screwsim.results.schema import axes_of, digest, fingerprint, version
from screwsim.results.table import Table, table_of
from screwsim.results.write import write_table
from screwsim.scene import cross_check, grid
from screwsim.scene.types import Scene
from screwsim.study.progress import Progress, Silent
from screwsim.study.shards import AngleGuard, Parts
from screwsim.study.workers import Chunks, MakePool, Work, process_pool, settle

Simulate = Callable[[Scene], Result]


@dataclass(frozen=True)
class SweepSummary:
    """How a sweep ended: numbers of cases (`reused`: those an earlier run computed), time [s], the file."""

    cases: int
    ok: int
    not_closed: int
    failed: int
    reused: int
    seconds: float
    path: Path


@dataclass(frozen=True)
class _Job:
    """What a worker needs; `simulate` is a function of a module, so that it can be sent to a process."""

    scene: Scene
    simulate: Simulate
    keep_cycle: bool


def run_sweep(
    scene: Scene,
    output: str | Path,
    *,
    jobs: int | None = None,
    restart: bool = False,
    simulate: Simulate | None = None,
    warm_up: Callable[[Scene], None] | None = None,
    progress: Progress | None = None,
    make_pool: MakePool = process_pool,
) -> SweepSummary:
    """Simulate every case of the scene's grid and write them to `output` (HDF5).

    `jobs` workers (default: all cores; 1: in this process). What an interrupted sweep of the same scene has
    finished lies in `output.parts` and is not computed again, unless `restart`. A case that fails is stored as
    failed and the sweep goes on. `simulate` and `warm_up` default to those of `screwsim.simulate`.
    Raise UsageError when the file or its parts belong to another scene, or cannot be written.
    """
    began = time.perf_counter()
    output = Path(output)
    parts = Parts(output, {"scene_sha256": digest(scene.text), "fingerprint": fingerprint(scene), "version": version()})
    complete = _claim(output, parts, restart)
    if complete and not restart and parts.stored_identity() is None:
        return _finished(output, began, parts)
    make_folder(output.parent)
    parts.open(restart)
    try:
        sweep = _Sweep(scene, parts, progress or Silent(), _simulator(scene, simulate, warm_up))
        reused = sweep.run(jobs or _cores(), make_pool)
        table = parts.merged(sweep.cases)
        write_table(output, scene, axes_of(scene), table, "sweep", folder=parts.folder)
        parts.discard()
    finally:
        parts.close()
    return _summary(table.status, reused, began, output)


def sweep(scene: Scene, jobs: int | None = None, **options: Any) -> Any:
    """Return all figures of a scene's sweep in memory: an xarray.Dataset, or Results where xarray is missing.

    Names of balance, error, numerics and cycle carry their group as prefix. `options` as of `run_sweep`.
    """
    try:
        import xarray  # noqa: F401 - only whether it is there
    except ImportError:
        file = Path(tempfile.mkdtemp(prefix="screwsim-")) / "sweep.h5"  # stays: Results reads when asked
        run_sweep(scene, file, jobs=jobs, **options)
        return open_results(file)
    with tempfile.TemporaryDirectory(prefix="screwsim-") as folder:
        run_sweep(scene, Path(folder) / "sweep.h5", jobs=jobs, **options)
        return open_results(Path(folder) / "sweep.h5").to_xarray(None)


class _Sweep:
    """One run over the cases that the parts do not hold yet."""

    def __init__(
        self, scene: Scene, parts: Parts, progress: Progress, simulator: tuple[Simulate, Callable[[Scene], None]]
    ) -> None:
        self.scene = scene
        self.cases = grid.case_count(scene)
        self._parts = parts
        self._progress = progress
        self._simulate, self._warm_up = simulator
        self._angles = AngleGuard()
        self._chunks = Chunks([], 1)

    def run(self, jobs: int, make_pool: MakePool) -> int:
        """Compute what is missing; return how many cases were there."""
        finished = self._parts.finished()
        reused = sum(map(len, finished))
        todo = _gaps(finished, self.cases)
        if not todo:
            return reused
        jobs = min(jobs, self.cases - reused)
        self._warm_up(self.scene)  # before the fork: every worker inherits what is compiled here
        self._chunks = Chunks(todo, jobs)
        job = _Job(self.scene, self._simulate, self.scene.output.keep == "cycle")
        try:
            self._progress.start(self.cases, reused)
            if jobs == 1:
                self._run_here(job)
            else:
                task = partial(run_packed, pickle.dumps(job))
                settle(self._chunks, jobs, Work(make_pool, task, self._finish, self._dead, self._progress.tick))
        finally:
            self._progress.stop()
        return reused

    def _run_here(self, job: _Job) -> None:
        while (cases := self._chunks.take()) is not None:
            self._finish(cases, run_cases(job, cases.start, cases.stop))
            self._progress.tick()

    def _finish(self, cases: range, outcome: tuple[Table, float]) -> None:
        table, seconds = outcome
        self._angles.check(table.angle)
        self._parts.write(cases.start, table)
        self._chunks.learn(len(cases), seconds)
        self._progress.advance(len(cases), int(np.count_nonzero(table.status)))

    def _dead(self, case: int) -> None:
        result = Result("failed", message="worker died (run this case alone, with `screwsim run --set …`)")
        self._finish(range(case, case + 1), (table_of([result], keep_cycle=False), 0.0))


def run_packed(job: bytes, start: int, stop: int) -> tuple[Table, float]:
    """Run cases in a worker; the job comes pickled so that a worker unpacks it once."""
    return run_cases(_unpacked(job), start, stop)


@lru_cache(maxsize=1)
def _unpacked(job: bytes) -> _Job:
    return pickle.loads(job)


def run_cases(job: _Job, start: int, stop: int) -> tuple[Table, float]:
    """Return the results of the cases `start` … `stop` - 1, and the time they took [s]."""
    began = time.perf_counter()
    results = [_one_case(job, case) for case in range(start, stop)]
    return table_of(results, keep_cycle=job.keep_cycle), time.perf_counter() - began


def _one_case(job: _Job, index: int) -> Result:
    """Return the result of a case; whatever goes wrong with it is its result and not the end of the sweep."""
    try:
        scene = grid.case(job.scene, index)
        faults = cross_check(scene)
        if faults:
            return Result("failed", message="; ".join(f"{fault.path}: {fault.what}" for fault in faults))
        return job.simulate(scene)
    except Exception as error:  # noqa: BLE001 - any error of one case; KeyboardInterrupt is none
        return Result("failed", message=" ".join(f"{type(error).__name__}: {error}".split()))


def _simulator(
    scene: Scene, simulate: Simulate | None, warm_up: Callable[[Scene], None] | None
) -> tuple[Simulate, Callable[[Scene], None]]:
    if simulate is not None:
        return simulate, warm_up or _nothing
    # by the module's own name: the package has a function of that name
    from screwsim.simulate import simulate as default_simulate
    from screwsim.simulate import warm_up as default_warm_up

    return partial(default_simulate, trace=scene.output.keep == "cycle"), warm_up or default_warm_up


def _nothing(scene: Scene) -> None: ...


def _claim(output: Path, parts: Parts, restart: bool) -> bool:
    """Return whether the file of this sweep is there; raise UsageError when file or parts are of something else."""
    found = output.exists()
    if found:
        attributes = open_results(output).attributes
        stored = {"scene_sha256": attributes["scene_sha256"], "fingerprint": attributes["screwsim_fingerprint"]}
        _compare(output, parts, stored | {"version": attributes["screwsim_version"]}, restart)
    identity = parts.stored_identity()
    if identity is not None:
        _compare(parts.folder, parts, identity, restart)
    return found


def _compare(where: Path, parts: Parts, stored: dict[str, Any], restart: bool) -> None:
    wanted = parts.identity
    if stored.get("scene_sha256") != wanted["scene_sha256"]:
        raise UsageError(f"{where}: holds another scene's results (choose another -o, or remove it)")
    if stored.get("fingerprint") != wanted["fingerprint"] and not restart:
        same = stored.get("version") == wanted["version"]
        what = "made with other contents of the scene's files" if same else f"of screwsim {stored.get('version')}"
        raise UsageError(f"{where}: holds results of this scene, but {what} (--restart computes them again)")


def _finished(output: Path, began: float, parts: Parts) -> SweepSummary:
    parts.discard()  # what a crash left after the file was written
    status = open_results(output).performance["status"]
    return _summary(status.ravel(), status.size, began, output)


def _summary(status: np.ndarray, reused: int, began: float, path: Path) -> SweepSummary:
    ok, not_closed, failed = (int(np.count_nonzero(status == index)) for index in range(len(STATUSES)))
    return SweepSummary(len(status), ok, not_closed, failed, reused, time.perf_counter() - began, path)


def _gaps(finished: list[range], cases: int) -> list[range]:
    """Return the cases between the finished ones."""
    edges = [0, *(edge for span in finished for edge in (span.start, span.stop)), cases]
    return [range(start, stop) for start, stop in zip(edges[::2], edges[1::2], strict=True) if stop > start]


def _cores() -> int:
    """Return the number of cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1
