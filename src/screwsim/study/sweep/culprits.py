"""Find the case that kills its worker or never ends, and let all other cases finish."""

import os
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor, Executor
from dataclasses import replace
from typing import Any, Self

from screwsim.study.pool.workers import WORKER_DIED, Chunks, ChunkWork, LostChunk, drain, stop_executor
from screwsim.study.sweep.cases import Block

_HUNG = "ran longer than {:g} s and was ended (allow more with --case-limit, or run this case alone)"
_UNEXPLAINED = "worker died {} times on the block of this case, but on none of its cases alone"
_TRIES = 3  # of a block whose worker dies although no case alone kills it: something else may have killed it


class _SingleTaskWorker:
    """One worker running one task at a time, so that it is certain which task was running when it dies."""

    def __init__(self, work: ChunkWork) -> None:
        self._work = work
        self._executor: Executor | None = None

    def __enter__(self) -> Self:
        """Raise RuntimeError when workers die without any case, so that no case is to blame."""
        try:
            self._start().submit(os.getpid).result()
        except BrokenExecutor as error:
            raise RuntimeError("worker processes cannot start (use a single job: --jobs 1)") from error
        return self

    def __exit__(self, kind: Any, *error: object) -> None:
        if self._executor is not None and kind is None:
            self._executor.shutdown()
        elif self._executor is not None:
            stop_executor(self._executor)

    def _start(self) -> Executor:
        if self._executor is None:
            self._executor = self._work.pool.executor(1)
        return self._executor

    def run(self, blocks: Sequence[Block]) -> Any:
        """Return the outcome of blocks, or the `LostChunk` that killed the worker."""
        outcomes: list[Any] = []
        work = replace(self._work, payload=lambda _: blocks, finish=lambda _, outcome: outcomes.append(outcome))
        lost = drain(Chunks([range(1)], 1, lambda: 1), work, self._start())
        if not lost:
            return outcomes[0]
        self._start().shutdown()
        self._executor = None
        return lost[0]


def run_chunks(chunks: Chunks, work: ChunkWork, limit: float | None) -> None:
    """Run all chunks, and find the cases over which workers die.

    When a worker dies, it is not known which of the running chunks was its own. They are run again one at a time, the
    oldest first, until one kills its worker again; all others are put back.
    """
    while lost := drain(chunks, work):
        lost.sort(key=lambda each: -each.seconds)
        with _SingleTaskWorker(work) as alone:
            while lost and not _finish_alone(lost.pop(0), alone, work, limit):
                pass
        for each in lost:
            chunks.give_back(each.blocks)


def _finish_alone(lost: LostChunk, alone: _SingleTaskWorker, work: ChunkWork, limit: float | None) -> bool:
    """Finish a chunk alone; return whether one of its cases kills the worker."""
    hung = _hanging_culprit(lost, limit)
    guilty = False
    for number, block in zip(lost.blocks, work.payload(lost.blocks), strict=True):
        outcome, failed = _marked_outcome(block, alone, limit, hung)
        work.finish(range(number, number + 1), outcome)
        guilty |= bool(failed)
    return guilty


def _marked_outcome(block: Block, alone: _SingleTaskWorker, limit: float | None, hung: bool) -> tuple[Any, bool]:
    """Return the outcome of a block with its culprits marked failed; `hung`: search for them before it is run."""
    unexplained = 0
    while True:
        outcome = LostChunk(range(0), 0.0) if hung else alone.run([block])
        if not isinstance(outcome, LostChunk):
            return outcome, bool(block.failed)
        found = _culprit_of(block, alone, limit)
        unexplained += not (found or hung)
        hung = False
        if unexplained == _TRIES:
            found = dict.fromkeys(range(len(block.values)), _UNEXPLAINED.format(_TRIES))
        block = replace(block, failed={**found, **block.failed})


def _culprit_of(block: Block, alone: _SingleTaskWorker, limit: float | None) -> dict[int, str]:
    """Return {position: why} of one case over which the worker dies, {} without any; results are discarded."""
    for place in block.order:
        if place in block.failed:
            continue
        one = Block([block.values[place]], [0])
        death = alone.run([one])
        if not isinstance(death, LostChunk):
            continue
        # twice: rules out a cause from outside
        if _hanging_culprit(death, limit) or isinstance(alone.run([one]), LostChunk):
            return {place: _why(death, limit)}
    return _culprit_in_chain(block, alone, limit)


def _hanging_culprit(death: LostChunk, limit: float | None) -> bool:
    return limit is not None and death.seconds >= limit


def _why(death: LostChunk, limit: float | None) -> str:
    return _HUNG.format(limit) if _hanging_culprit(death, limit) else WORKER_DIED


def _culprit_in_chain(block: Block, alone: _SingleTaskWorker, limit: float | None) -> dict[int, str]:
    """Return the case that kills its worker only after those before it: the end of the shortest chain that does."""
    shortest, longest = 1, len(block.order)
    death = alone.run([block])
    if not isinstance(death, LostChunk):
        return {}
    while shortest < longest:
        middle = (shortest + longest) // 2
        chosen = block.order[:middle]
        failed = {place: block.failed[old] for place, old in enumerate(chosen) if old in block.failed}
        outcome = alone.run([Block([block.values[place] for place in chosen], range(middle), failed)])
        if isinstance(outcome, LostChunk):
            longest, death = middle, outcome
        else:
            shortest = middle + 1
    return {block.order[shortest - 1]: _why(death, limit)}
