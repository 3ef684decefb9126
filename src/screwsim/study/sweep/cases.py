"""Work of a worker: simulate blocks of cases, each case started from the one before, and return them as one table.

How cases are cut into blocks depends on the grid alone, so that results depend neither on the number of workers nor on
interruptions.
"""

import math
import pickle
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import tee
from typing import Any

import numpy as np

from screwsim.inputs.faults import in_one_line
from screwsim.outputs import Result
from screwsim.results.table import Table, table_of
from screwsim.scene import cross_check, dimensions, with_values
from screwsim.scene.types import Scene
from screwsim.study.pool.limit import TimeLimit, clock_handed_on, clocks_running
from screwsim.study.pool.tally import no_mark
from screwsim.study.pool.workers import pickled_work
from screwsim.study.sweep.agreement import Requirements, refuse_to_differ

BLOCK_CASES = 16  # cases per block at most in small sweeps: even work for all cores
LONG_BLOCK_CASES = 64  # cases per block at most in sweeps of
LARGE_SWEEP = 512  # cases or more: longer chains of neighbours
SAMPLE_BLOCK_CASES = 4  # cases per block of a random sample, whose points are not neighbours
SimulateMany = Callable[[Iterable[Scene]], Iterator[Result]]
BlockResults = tuple[Table, float]  # results, and the time taken [s]


@dataclass(frozen=True)
class Job:
    """Data common to all cases; its functions belong to modules, so that they can be sent to another process.

    `scene` has no sweep. The process is killed when one case takes longer than `limit` [s]; None: no limit.
    """

    scene: Scene
    paths: tuple[str, ...]
    simulate_many: SimulateMany
    warm_up: Callable[[Scene], None]
    keep_cycle: bool
    limit: float | None
    batch: bool = False  # blocks side by side, in the SIMD lanes of a core,
    gpu: bool = False  # or on a GPU
    mark: Callable[[], None] = no_mark  # called after each case


@dataclass(frozen=True)
class Block:
    """Cases to simulate in one go: values of the job's paths, order of simulation, reasons of those already failed."""

    values: Sequence[tuple[Any, ...]]
    order: Sequence[int]
    failed: Mapping[int, str] = field(default_factory=dict)


_jobs: dict[bytes, Job] = {}  # unpacked and warmed up; a forked process inherits those of its parent


def packed(job: Job) -> bytes:
    """Return a job as it is sent to workers; workers forked from now on inherit it warmed up."""
    raw = pickled_work(job)
    _jobs.clear()
    _jobs[raw] = job
    return raw


def run_packed(raw: bytes, wanted: Requirements, blocks: Sequence[Block]) -> BlockResults:
    """Run blocks in a worker, which unpacks a job once and warms up before the first case.

    Raise UsageError where this worker's code or files differ from those wanted.
    """
    job = _jobs.get(raw)
    if job is None:
        refuse_to_differ(wanted)
        job = pickle.loads(raw)
        job.warm_up(job.scene)
        _jobs.clear()  # another thread may still hold the previous job, and goes on with it
        _jobs[raw] = job
    return run_blocks(job, blocks)


def run_blocks(job: Job, blocks: Sequence[Block]) -> BlockResults:
    """Return the results of blocks, with the cases in the order of their values, and the time taken [s]."""
    began = time.perf_counter()
    results = [result for found in _block_results(job, blocks) for result in found]
    return table_of(results, keep_cycle=job.keep_cycle, keep_slopes=True), time.perf_counter() - began


def _block_results(job: Job, blocks: Sequence[Block]) -> list[list[Result]]:
    """Return the results of each block; several blocks run in step, with `batch` or `gpu` side by side."""
    if len(blocks) == 1 and not (job.batch or job.gpu):
        return [_results_of_block(job, blocks[0])]
    from screwsim.batch import together
    from screwsim.batch.tasks import IN_STEP, ON_GPU

    tasks = [partial(_results_of_block, job, block) for block in blocks]
    during, passed = (clocks_running, clock_handed_on) if job.limit else (None, None)
    in_flight = ON_GPU if job.gpu else IN_STEP
    return together(tasks, in_flight, during, gpu=job.gpu, handed_on=passed, lanes=job.batch)


def _results_of_block(job: Job, block: Block) -> list[Result]:
    results: dict[int, Result] = {}
    run: list[tuple[int, Scene]] = []
    for place in block.order:
        scene = with_values(job.scene, dict(zip(job.paths, block.values[place], strict=True)))
        failed = block.failed.get(place) or _misfit_of_case(scene)
        if not failed:
            run.append((place, scene))
            continue
        results[place] = Result("failed", message=failed)
        job.mark()
        results |= _consecutive_results(job, run)
        run = []
    results |= _consecutive_results(job, run)
    return [results[place] for place in range(len(block.values))]


def _misfit_of_case(scene: Scene) -> str:
    """Return why the values of a case do not fit together; '' when they do."""
    try:
        return "; ".join(map(str, cross_check(scene)))
    except (Exception, SystemExit) as error:  # noqa: BLE001 - as below
        return in_one_line(error)


def _consecutive_results(job: Job, run: Sequence[tuple[int, Scene]]) -> dict[int, Result]:
    """Return the results of consecutive cases; an error in one of them becomes its result and ends nothing else."""
    results: dict[int, Result] = {}
    limit = TimeLimit(job.limit)
    many: Iterator[Result] | None = None
    for number, (place, _) in enumerate(run):
        try:
            with limit:
                many = many or iter(job.simulate_many(scene for _, scene in run[number:]))
                results[place] = next(many)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - any error of one case; KeyboardInterrupt is none
            results[place] = Result("failed", message=in_one_line(error))
            many = None
        job.mark()
    return results


class Blocks:
    """Consecutive cases of a grid of a given shape in blocks: parts of one row along the last axis, or whole rows."""

    def __init__(self, shape: Sequence[int], longest: int = BLOCK_CASES) -> None:
        self.cases = math.prod(shape)
        self._row = shape[-1] if shape else 1
        parts = -(-self._row // longest)  # blocks per row
        size = max(1, longest // self._row) * self._row  # cases per block where rows are short
        starts = np.arange(0, self.cases, size if parts == 1 else self._row)
        self._edges = np.append(np.add.outer(starts, np.arange(parts) * self._row // parts), self.cases)
        self.count = len(self._edges) - 1

    def cases_of(self, blocks: range) -> range:
        """Return the cases of consecutive blocks."""
        return range(int(self._edges[blocks.start]), int(self._edges[blocks.stop]))

    def blocks_of(self, cases: range) -> range | None:
        """Return the blocks that make up consecutive cases; None when these are not whole blocks."""
        found = range(*np.searchsorted(self._edges, (cases.start, cases.stop)).tolist())
        return found if found.stop <= self.count and self.cases_of(found) == cases else None

    def order(self, block: int) -> list[int]:
        """Return the positions in a block in order of simulation: every other row reversed, so neighbours follow."""
        size = len(self.cases_of(range(block, block + 1)))
        if size <= self._row:
            return list(range(size))
        rows = [range(start, start + self._row) for start in range(0, size, self._row)]
        return [place for number, row in enumerate(rows) for place in (reversed(row) if number % 2 else row)]


def blocks_of(scene: Scene) -> Blocks:
    """Return the blocks of a scene's sweep."""
    found = dimensions(scene)
    sampled = bool(found) and found[-1].joint is not None and found[-1].joint.sample is not None
    shape = [dimension.size for dimension in found]
    whole = LONG_BLOCK_CASES if math.prod(shape) >= LARGE_SWEEP else BLOCK_CASES
    return Blocks(shape, SAMPLE_BLOCK_CASES if sampled else whole)


def simulate_with(
    added: Callable[[Scene, Result], Result],
    many: Callable[[Iterable[Scene]], Iterator[Result]],
    scenes: Iterable[Scene],
) -> Iterator[Result]:
    """Yield the results of consecutive scenes, simulated by `many` and completed by `added`."""
    first, second = tee(scenes)
    for result in many(first):
        yield added(next(second), result)
