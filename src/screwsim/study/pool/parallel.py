"""Work on all cores for studies whose answers fit into memory: a function of a range of numbers, or small batches.

`BatchWorkers` keeps its workers for many batches, for studies whose next questions depend on the last answers.
"""

import pickle
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any, Self, TypeVar

from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.study.asked.varied import Varied
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.tally import Place, Tally
from screwsim.study.pool.workers import (
    Chunks,
    ChunkWork,
    LocalPool,
    LostChunk,
    cores,
    drain,
    pickled_work,
    stop_executor,
)

Answer = TypeVar("Answer")


def parallel_map(
    function: Callable[[int], Answer],
    count: int,
    *,
    died: Callable[[int], Answer],
    jobs: int | None = None,
    failed: Callable[[Answer], bool] = lambda answer: getattr(answer, "status", "ok") != "ok",
    progress: Progress | None = None,
    kept: Callable[[dict[int, Answer]], None] | None = None,
) -> list[Answer]:
    """Return [function(0), …, function(count - 1)], computed by `jobs` workers (default: all cores; 1: this process).

    The function is pickled once. `died` gives the answer for a number whose worker died; `failed` decides which answers
    the progress counts as failed, by default those with a status other than ok. `kept` is called in this process with
    the answers of each finished chunk, which an interruption leaves there. Numbers are counted as they are computed,
    before their chunk is finished.
    """
    jobs = min(jobs or cores(), count)
    answers: dict[int, Answer] = {}
    chunks = Chunks([range(count)], count, lambda: jobs)

    def finish(numbers: range, outcome: tuple[list[Answer], float]) -> None:
        found, seconds = outcome
        chunks.learn(len(numbers), seconds)
        new = dict(zip(numbers, found, strict=True))
        answers.update(new)
        if kept is not None:
            kept(new)
        tally.advance(len(found), sum(map(failed, found)))

    # alone, this process finishes each number by itself
    tally = Tally(progress or Progress(), Place.BESIDE if jobs > 1 else Place.ELSEWHERE)
    tally.start(count, 0)
    try:
        if jobs <= 1:
            for number in range(count):
                finish(range(number, number + 1), ([function(number)], 0.0))
        else:
            task = partial(_answers, pickled_work((function, tally.mark)))
            work = ChunkWork(LocalPool(jobs), task, lambda numbers: numbers, finish, tally.tick)
            while lost := drain(chunks, work):
                _run_alone(lost, work, lambda number: ([died(number)], 0.0))
    finally:
        tally.stop()
    return [answers[number] for number in range(count)]


def _run_alone(lost: Sequence[LostChunk], work: ChunkWork, died: Callable[[int], Any]) -> None:
    """Run the numbers of lost chunks one by one, each on a worker of its own; `died` is the outcome where that dies."""
    for number in sorted(number for chunk in lost for number in chunk.blocks):
        alone = range(number, number + 1)
        if drain(Chunks([alone], 1, lambda: 1), replace(work, pool=LocalPool(1))):
            work.finish(alone, died(number))


def _answers(work: bytes, numbers: range) -> tuple[list[Any], float]:
    """Return the answers for numbers, and the time taken [s]; `work` is the function, and what counts an answer."""
    began, (function, mark) = time.perf_counter(), unpacked(work)
    answers = []
    for number in numbers:
        answers.append(function(number))
        mark()
    return answers, time.perf_counter() - began


unpacked = lru_cache(maxsize=1)(pickle.loads)


class BatchWorkers:
    """Call a module-level function for each payload of a batch on the same workers; with one job in this process.

    A payload that is lost when a worker dies is tried once more, alone; if that worker dies, too, the answer is None.
    """

    def __init__(self, jobs: int, tick: Callable[[], None]) -> None:
        self.jobs = jobs
        self._tick = tick
        self._executor: Executor | None = None

    def __enter__(self) -> Self:
        """Return the crew, whose workers start with the first batch."""
        return self

    def __exit__(self, *error: object) -> None:
        """Stop the workers."""
        self.leave()

    def leave(self) -> None:
        """Stop the workers, which frees their memory; the next batch starts new ones."""
        if self._executor is not None:
            stop_executor(self._executor)
            self._executor = None

    def answers(self, task: Callable[[Any], Any], payloads: Sequence[Any]) -> list[Any]:
        """Return the answers to payloads, in their order."""
        if self.jobs <= 1:
            return [self._here(task, payload) for payload in payloads]
        found: dict[int, Any] = {}
        work = ChunkWork(
            LocalPool(self.jobs),
            task,
            lambda numbers: payloads[numbers.start],
            lambda numbers, answer: found.__setitem__(numbers.start, answer),
            self._tick,
        )
        chunks = Chunks([range(len(payloads))], 1, lambda: self.jobs)
        while lost := drain(chunks, work, self._begun()):
            self.leave()
            _run_alone(lost, work, lambda number: None)
        return [found[number] for number in range(len(payloads))]

    def _begun(self) -> Executor:
        """Return the workers, started where there are none."""
        self._executor = self._executor or LocalPool(self.jobs).executor(self.jobs)
        return self._executor

    def _here(self, task: Callable[[Any], Any], payload: Any) -> Any:
        self._tick()
        return task(payload)


class WarmSimulation:
    """Solve a scene when called, starting from that of the last call where it is near; or two stages.

    With `trace` results of a scene keep their cycle.
    """

    def __init__(self, trace: bool = False) -> None:
        self._trace = trace
        self._scene: Scene | None = None
        self._course: Iterator[Result] | None = None

    def __call__(self, scene: Varied) -> Result:
        from screwsim.simulate import simulate_many

        if not isinstance(scene, Scene):
            return scene.solved()
        self._scene = scene
        self._course = self._course or iter(simulate_many(self._scenes(), trace=self._trace))
        try:
            return next(self._course)
        except Exception:
            self._course = None
            raise

    def _scenes(self) -> Iterator[Scene]:
        while self._scene is not None:
            yield self._scene
