"""Sweeps: simulate every point of a scene's grid on all cores, resumable after any interruption."""

import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.arguments import FLAG, REAL, TEXT, checked_arguments
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.results.atomic import has_content, make_folder
from screwsim.results.identity import changed_values, differences, scene_values, unpacked
from screwsim.results.read import count_statuses, open_results, read_attributes
from screwsim.results.schema import axes_of, digest, identity_of
from screwsim.results.table import same_angles
from screwsim.results.write import Draft
from screwsim.scene import SceneLike, grid
from screwsim.scene.load import scene_of
from screwsim.scene.operation import SPEED
from screwsim.scene.types import Scene
from screwsim.study.pool.limit import CASE_LIMIT, checked_limit
from screwsim.study.pool.progress import Progress, progress_of
from screwsim.study.pool.tally import Place, Tally
from screwsim.study.pool.workers import Chunks, ChunkWork, LocalPool, Pool, cores
from screwsim.study.sweep.agreement import FileWatch, requirements_of
from screwsim.study.sweep.cases import (
    Block,
    BlockResults,
    Job,
    SimulateMany,
    blocks_of,
    packed,
    run_blocks,
    run_packed,
    simulate_with,
)
from screwsim.study.sweep.culprits import run_chunks
from screwsim.study.sweep.shards import Parts
from screwsim.version import release

CHUNK_CASES = 1024  # cases per chunk at most,
CHUNK_TRACES = 256  # and where cases keep their traces: bounds the memory
SIDE_BY_SIDE = 8  # blocks per chunk at least where they are simulated side by side: as many as a core has lanes
BESIDE_ON_GPU, CASES_ON_GPU = 256, 8192  # blocks per chunk at least on a GPU, unless blocks are long: bounds the memory
FEW_BLOCKS = 512  # blocks up to which the last chunks decide how long a sweep takes
FLUID = grid.FLUID
Simulate = Callable[[Scene], Result]
WarmUp = Callable[[Scene], None]


class _SideBySide(NamedTuple):
    """How blocks are solved side by side, if at all."""

    batch: bool  # in the lanes of a core
    gpu: bool

    def blocks(self, size: int) -> int:
        """Return the least number of blocks per chunk, given the number of cases per block."""
        return min(BESIDE_ON_GPU, max(1, CASES_ON_GPU // size)) if self.gpu else SIDE_BY_SIDE if self.batch else 1

    def warm_up(self, own: WarmUp, scene: Scene) -> None:
        """Warm up the code for single cases, and that for lanes, or compile that for a GPU, which each worker opens."""
        own(scene)
        if any(self):
            from screwsim import batch

            (batch.prepare_for_gpu if self.gpu else batch.warm_up)(scene)


@dataclass(frozen=True)
class SweepSummary:
    """Outcome of a sweep: numbers of cases (`reused`: computed by an earlier run), time [s], path of the file."""

    cases: int
    ok: int
    not_closed: int
    failed: int
    reused: int
    seconds: float
    path: Path


@checked_arguments(scheduler=TEXT, case_limit=REAL, batch=FLAG, gpu=FLAG)
def run_sweep(
    scene: SceneLike,
    output: str | Path,
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
    case_limit: float | None = None,
    restart: bool = False,
    batch: bool = False,
    gpu: bool = False,
    simulate: Simulate | None = None,
    simulate_many: SimulateMany | None = None,
    warm_up: WarmUp | None = None,
    progress: Progress | bool | None = None,
) -> SweepSummary:
    """Simulate every case of the scene's grid and write the results to `output` (HDF5).

    The cases run on `jobs` worker processes (default: all cores; 1: in this process), or on those of a dask scheduler
    given by its address or its scheduler file. A case that takes longer than `case_limit` [s] (default: 300; in this
    process no limit) or kills its worker is marked failed, and the sweep goes on. Finished cases of an interrupted
    sweep of the same scene lie in `output.parts` and are reused, unless `restart` is set. With `batch` the blocks of a
    worker are simulated side by side in the SIMD lanes of its core, with `gpu` on a GPU that all workers share
    (docs/how-to/sweeps.md). `simulate` (one scene), `simulate_many` (consecutive scenes, each started from the one
    before) and `warm_up` replace those of `screwsim.simulate`; `progress` is as for `sweep`. Raise UsageError when the
    file or its parts belong to another scene or cannot be written, when the scheduler cannot be reached, or where there
    is no GPU.
    """
    began = time.perf_counter()
    case_limit, scene = checked_limit(case_limit), scene_of(scene)
    if batch and gpu:
        raise UsageError("--batch and --gpu are two ways to solve points side by side (choose one of the two)")
    output = Path(output)
    parts = Parts(output, {"scene_sha256": digest(scene.text), "identity": identity_of(scene)})
    complete = _is_finished_file(output, parts, restart, scene.text)
    if complete and not restart and parts.stored_identity() is None:
        return _summary_of_finished(output, began, parts)
    make_folder(output.parent)
    parts.open(restart)
    try:
        many, warm = _simulator(scene, simulate, simulate_many, warm_up)
        with Draft(output, scene, axes_of(scene), "sweep", parts.folder) as draft:
            beside = _SideBySide(batch, gpu)
            warm = partial(beside.warm_up, warm)
            run = _Sweep(scene, parts, progress_of("sweep", progress), many, warm, draft, beside)
            reused = run.run(jobs, scheduler, case_limit)
            draft.complete(parts.all(run.blocks.cases))
        parts.discard()
    finally:
        parts.close()
    return _summary_of_finished(output, began, parts, reused)


@checked_arguments()
def sweep(scene: SceneLike, jobs: int | None = None, progress: Progress | bool | None = None, **options: Any) -> Any:
    """Return all figures of a scene's sweep in memory: an xarray.Dataset, or Results where xarray is missing.

        data = screwsim.sweep("study.yaml")
        data.shaft_power.sel(operation_speed=314.159, method="nearest")

    The scene is what `load` returns, the path of a file, YAML text, or a dict laid out as the file is. `progress`: True
    shows a bar or a line on stderr, None a bar in a notebook, False nothing.

    Dimensions are those of the sweep (docs/how-to/sweeps.md), named by their paths with `_` for each dot, values in SI;
    `case` and `sample` where paths vary together. Names of balance, error, numerics, cycle and ledger carry their group
    as prefix. `jobs` workers (default: all cores); `options` as of `run_sweep`, e.g. `scheduler="tcp://…"`. If the
    results do not fit into memory, use `run_sweep` and open its file lazily.
    """
    scene = scene_of(scene)
    if not scene.sweep:
        raise UsageError(
            "the scene has no sweep (scene.with_({'sweep.operation.speed': ['1000 rpm', '3000 rpm']}) gives it one; "
            "one point is simulated by screwsim.simulate)"
        )
    try:
        import xarray  # noqa: F401 - only whether it is there
    except ImportError:
        file = Path(tempfile.mkdtemp(prefix="screwsim-")) / "sweep.h5"  # kept: Results reads it lazily
        return open_results(run_sweep(scene, file, jobs=jobs, progress=progress, **options).path)
    with tempfile.TemporaryDirectory(prefix="screwsim-") as folder:
        run_sweep(scene, Path(folder) / "sweep.h5", jobs=jobs, progress=progress, **options)
        return open_results(Path(folder) / "sweep.h5").to_xarray(None)


@dataclass
class _Sweep:
    """One run over the cases that the stored parts do not hold yet."""

    scene: Scene
    parts: Parts
    progress: Progress
    many: SimulateMany
    warm_up: WarmUp  # of all code that is needed
    draft: Draft
    beside: _SideBySide

    def __post_init__(self) -> None:
        self.blocks = blocks_of(self.scene)
        self._angle = np.empty(0)  # common grid of the traces: cases with longer lives of chambers are refused
        self._wanted = requirements_of(self.scene)
        self._watch = FileWatch(self._wanted["files"], self._wanted["identity"])

    def run(self, jobs: int | None, scheduler: str | None, case_limit: float | None) -> int:
        """Compute the missing cases; return how many were there already."""
        finished = self.parts.finished(lambda cases: self.blocks.blocks_of(cases) is not None)
        reused = sum(map(len, finished))
        done = [blocks for cases in finished if (blocks := self.blocks.blocks_of(cases)) is not None]
        edges = [0, *(edge for span in done for edge in (span.start, span.stop)), self.blocks.count]
        gaps = (range(start, stop) for start, stop in zip(edges[::2], edges[1::2], strict=True))
        todo = self._slow_machines_first([gap for gap in gaps if gap])
        if not todo:
            return reused
        if scheduler is not None:
            from screwsim.study.sweep.cluster import Cluster

            with Cluster(scheduler, wanted=self._wanted) as cluster:
                self._compute(todo, reused, cluster, case_limit or CASE_LIMIT)
        else:
            jobs = min(jobs or cores(), sum(map(len, todo)))
            here = jobs == 1 and case_limit is None
            self._compute(todo, reused, LocalPool(jobs), None if here else case_limit or CASE_LIMIT)
        return reused

    def _slow_machines_first(self, todo: list[range]) -> list[range]:
        """Return the missing blocks with slow machines first: leaks dominate them, and they take longest.

        If one of them began last, the other workers would be idle until it ends.
        """
        if SPEED not in self.scene.sweep or self.blocks.count > FEW_BLOCKS or any(self.beside):
            return todo

        def speed(block: int) -> float:
            first = self.blocks.cases_of(range(block, block + 1)).start
            return float(grid.case_values(self.scene, first)[SPEED])

        runs: list[range] = []
        for block in sorted((block for blocks in todo for block in blocks), key=speed):
            if runs and runs[-1].stop == block:
                runs[-1] = range(runs[-1].start, block + 1)
            else:
                runs.append(range(block, block + 1))
        return runs

    def _compute(self, todo: list[range], reused: int, pool: Pool, limit: float | None) -> None:
        """Compute blocks on a pool, or in this process where there is no limit."""
        self.warm_up(self.scene)  # before the fork: every worker inherits the compiled code
        keep = self.scene.output.keeps_cycle
        size = len(self.blocks.cases_of(range(1)))
        longest = (CHUNK_TRACES if keep else CHUNK_CASES) // size
        self._chunks = Chunks(todo, longest, pool.workers, self.beside.blocks(size))
        base = replace(grid.without_sweep(self.scene), text="")
        place = Place.HERE if limit is None else Place.BESIDE if isinstance(pool, LocalPool) else Place.ELSEWHERE
        tally = self._tally = Tally(self.progress, place)
        try:
            job = Job(base, tuple(self.scene.sweep), self.many, self.warm_up, keep, limit, *self.beside, tally.mark)
            tally.start(self.blocks.cases, reused)
            if limit is None:
                while (blocks := self._chunks.take()) is not None:
                    self._finish(blocks, run_blocks(job, self._payload(blocks)))
                    tally.tick()
            else:
                task = partial(run_packed, packed(job), self._wanted)
                run_chunks(self._chunks, ChunkWork(pool, task, self._payload, self._finish, tally.tick), limit)
        except UsageError:
            self._watch.look()  # a worker that started after a file changed here reads the changed one
            raise
        finally:
            tally.stop()

    def _payload(self, blocks: range) -> list[Block]:
        """Return the cases of blocks, built on demand."""
        cases = self.blocks.cases_of(blocks)
        values = grid.values_of(self.scene, cases)
        spans = [self.blocks.cases_of(range(block, block + 1)) for block in blocks]
        rows = (values[span.start - cases.start : span.stop - cases.start] for span in spans)
        return [Block(part, self._order(block, part)) for part, block in zip(rows, blocks, strict=True)]

    def _order(self, block: int, values: Sequence[tuple[Any, ...]]) -> list[int]:
        """Return the order in which the cases of a block are simulated: cases of the same fluid one after another."""
        order = self.blocks.order(block)
        if FLUID not in self.scene.sweep:
            return order
        place = list(self.scene.sweep).index(FLUID)
        rank = {fluid: number for number, fluid in enumerate(dict.fromkeys(self.scene.sweep[FLUID]))}
        return sorted(order, key=lambda case: rank[values[case][place]])

    def _finish(self, blocks: range, outcome: BlockResults) -> None:
        table, seconds = outcome
        if table.angle.size:
            self._angle = self._angle if self._angle.size else table.angle
            same_angles(self._angle, table.angle)
        self._watch.look()
        self.parts.write(self.blocks.cases_of(blocks).start, table)
        self._chunks.learn(len(blocks), seconds)
        self._tally.advance(len(table), int(np.count_nonzero(table.status)))
        self.draft.lay_out(table)  # once, while the other chunks are being computed


def _simulator(
    scene: Scene, simulate: Simulate | None, many: SimulateMany | None, warm_up: WarmUp | None
) -> tuple[SimulateMany, WarmUp]:
    if many is not None:
        return many, warm_up or no_warm_up
    if simulate is not None:
        return partial(map, simulate), warm_up or no_warm_up  # each from its own start
    from screwsim.simulate import warm_up as default_warm_up

    return default_simulate_many(scene), warm_up or default_warm_up


def default_simulate_many(scene: Scene) -> SimulateMany:
    """Return the function that simulates consecutive cases of a scene's sweep."""
    from screwsim.simulate import simulate_many  # by the module's own name: the package has a function of that name

    many = partial(simulate_many, trace=scene.output.keeps_cycle)
    if scene.uncertain:
        from screwsim.study.uncertainty.point import with_uncertainty

        many = partial(simulate_with, with_uncertainty, many)
    if scene.output.keeps_slopes:
        from screwsim.study.uncertainty.point import with_slopes

        many = partial(simulate_with, with_slopes, many)
    return many


def no_warm_up(scene: Scene) -> None:
    """Do nothing, where no warm-up is needed."""


def _is_finished_file(output: Path, parts: Parts, restart: bool, text: str) -> bool:
    """Return whether the scene's results file exists; raise UsageError when the file or the parts belong elsewhere."""
    found = has_content(output)
    if found:
        attributes = read_attributes(output)
        stored = {"scene_sha256": attributes["scene_sha256"], "version": attributes["screwsim_version"]}
        stored |= {"identity": unpacked(attributes.get("screwsim_identity"))}
        _compare(output, parts, stored, restart, (str(attributes.get("scene_yaml", "")), text))
    stored = parts.stored_identity()
    if stored is not None:
        _compare(parts.folder, parts, stored, restart)
    return found


def _compare(where: Path, parts: Parts, stored: Mapping[str, Any], restart: bool, texts: Sequence[str] = ()) -> None:
    if stored.get("scene_sha256") != parts.identity["scene_sha256"]:
        changed = changed_values(*(scene_values(text, str(where)) for text in texts)) if texts else ""
        raise UsageError(f"{where}: holds another scene's results{changed} (choose another -o, or remove it)")
    if restart:
        return
    identity = stored.get("identity")
    if isinstance(identity, dict):
        what = differences(identity, parts.identity["identity"])
    else:  # written before code and files were recorded
        version = release(str(stored.get("version", "")))
        what = f"from a screwsim {version} that did not record its code and input files"
    if what:
        remedy = "choose another -o to keep them (--restart computes them again)"
        raise UsageError(f"{where}: holds results of this scene, but {what}; {remedy}")


def _summary_of_finished(output: Path, began: float, parts: Parts, reused: int | None = None) -> SweepSummary:
    """Return the summary of a finished sweep; without `reused` an earlier run computed all cases."""
    parts.discard()  # left over from a crash after the file was written
    ok, not_closed, failed = count_statuses(output)
    count, seconds = ok + not_closed + failed, time.perf_counter() - began
    return SweepSummary(count, ok, not_closed, failed, count if reused is None else reused, seconds, output)
