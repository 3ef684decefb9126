"""Solve points side by side: each goes its own way, and what they have in common is done for many in one call.

Each task runs in a thread of its own, one at a time, until it asks for a turn. When all of them have asked, the turns
of one structure are integrated together (`model.side_by_side`). What is done between turns (mixing, corrections,
estimates, figures, the verdict) is that of a single point, and so is what each lane computes: no result depends on
which points ran beside it.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

from screwsim.codegen.kinds import LANES
from screwsim.codegen.program import CannotCompile
from screwsim.model import compiled, side_by_side
from screwsim.model.exchange import here
from screwsim.model.run import Machinery
from screwsim.outputs import Result
from screwsim.scene.types import Scene
from screwsim.simulate import simulate, simulate_many

Answer = TypeVar("Answer")
IN_FLIGHT = 2 * LANES  # tasks at a time: turns of like tolerance find each other
IN_STEP = LANES  # the same of courses, whose points take like turns: what more of them hold leaves the cache
ON_GPU = 1024  # the same on a GPU, and turns in one call
Turns = Callable[[Sequence[side_by_side.Asked]], list[Any]]
During = Callable[[Sequence[int]], AbstractContextManager[None]]  # the threads for which a call is made


class Stopped(BaseException):
    """The end of a task that nobody waits for any more."""


@dataclass(eq=False)
class _Task:
    number: int
    work: Callable[[], Any]
    go: threading.Lock = field(default_factory=threading.Lock)  # held until it may go on
    asked: side_by_side.Asked | None = None
    answer: Any = None
    thread: threading.Thread | None = None

    def __post_init__(self) -> None:
        self.go.acquire()


def together(
    tasks: Sequence[Callable[[], Answer]], in_flight: int | None = None, during: During | None = None, gpu: bool = False
) -> list[Answer]:
    """Return what each task returns; the turns that they ask for are integrated side by side.

    `in_flight` tasks run at a time. What a task raises is raised here, once all have ended. `during` surrounds waiting
    and calls, for who takes times. With `gpu` a GPU integrates (`screwsim.batch.cuda`), else the lanes of this core.
    """
    default, most = (ON_GPU, ON_GPU) if gpu else (IN_FLIGHT, LANES)
    return _Together(
        tasks, max(1, in_flight or default), during or _plain, most, _turns_on_gpu if gpu else _turns
    ).run()


def simulate_courses(courses: Iterable[Iterable[Scene]], trace: bool = False, gpu: bool = False) -> list[list[Result]]:
    """Return the results of courses of scenes, side by side; within a course each scene begins from those before it.

    Courses of one scene each are points that have nothing to do with each other, as those of a sample.
    """
    every = [list(scenes) for scenes in courses]
    in_flight = IN_STEP if not gpu and any(len(scenes) > 1 for scenes in every) else None
    return together([partial(_course, scenes, trace) for scenes in every], in_flight, gpu=gpu)


def _course(scenes: Sequence[Scene], trace: bool) -> list[Result]:
    return list(simulate_many(scenes, trace))


def warm_up(scene: Scene) -> None:
    """Compile or load what a scene needs to run side by side with others."""
    together([partial(simulate, scene, scene.output.keep == "cycle")])


def _plain(threads: Sequence[int]) -> AbstractContextManager[None]:
    return nullcontext()


class _Together:
    """Tasks in threads of their own, of which one runs at a time and hands on to the next."""

    def __init__(
        self, tasks: Sequence[Callable[[], Any]], in_flight: int, during: During, most: int, turns: Turns
    ) -> None:
        self._left = deque(_Task(number, work) for number, work in enumerate(tasks))
        self._answers: list[Any] = [None] * len(tasks)
        self._in_flight, self._during = in_flight, during
        self._most, self._turns = most, turns
        self._ready: deque[_Task] = deque()
        self._waiting: list[_Task] = []
        self._alive = 0
        self._threads: list[threading.Thread] = []
        self._error: BaseException | None = None
        self._stopped = False
        self._ended = threading.Semaphore(0)

    def run(self) -> list[Any]:
        try:
            self._hand_on()
            self._ended.acquire()
        except BaseException:  # of who waits: Ctrl-C
            self._stopped = True
            self._ended.acquire()
            raise
        finally:
            for thread in self._threads:
                thread.join()
        if self._error is not None:
            raise self._error
        return self._answers

    # ---- one runs at a time ----------------------------------------------------------------------------------------

    def _hand_on(self) -> None:
        """Let the next task run: a new one while there is room, one that has its answer, one after a call."""
        while self._left and self._alive < self._in_flight and not self._stopped:
            self._begin(self._left.popleft())
        if not self._ready and self._waiting:
            self._call()
        if self._ready:
            self._ready.popleft().go.release()
        elif not self._alive:
            self._ended.release()

    def _begin(self, task: _Task) -> None:
        self._alive += 1
        task.thread = threading.Thread(target=self._run, args=(task,), name=f"point {task.number}", daemon=True)
        self._threads = [thread for thread in self._threads if thread.is_alive()] + [task.thread]
        task.thread.start()
        self._ready.append(task)

    def _run(self, task: _Task) -> None:
        here.turn = partial(self._turn, task)
        task.go.acquire()
        try:
            self._answers[task.number] = task.work()
        except Stopped:
            pass
        except BaseException as error:  # noqa: BLE001 - raised where all are waited for
            self._error = self._error or error
            self._stopped = True
        self._alive -= 1
        self._hand_on()

    def _turn(self, task: _Task, machinery: Machinery, y: Any, rtol: float, h: float) -> Any:
        """Ask for a turn, let others run, and return it (in the task's own thread)."""
        began = time.perf_counter()
        task.asked = side_by_side.Asked(machinery, y, rtol, h)
        self._waiting.append(task)
        with self._during([]):
            self._hand_on()
            task.go.acquire()
        if self._stopped:
            raise Stopped
        if isinstance(task.answer, BaseException):  # of the call: it is told in each that was waiting for it
            raise task.answer
        answer, share = task.answer
        machinery.compile_time += time.perf_counter() - began - share  # what others took is no time of this one
        return answer

    # ---- turns in one call -----------------------------------------------------------------------------------------

    def _call(self) -> None:
        """Integrate turns of those that wait: of one structure, of like tolerance, the one that waits longest first."""
        if self._stopped:
            chosen = list(self._waiting)
        else:
            first = self._waiting[0].asked
            assert first is not None
            alike = [task for task in self._waiting if _alike(task.asked, first)]
            alike.sort(key=lambda task: _distance(task.asked, first))
            chosen = alike[: self._most]
            self._answer(chosen)
        self._waiting = [task for task in self._waiting if task not in chosen]
        self._ready.extend(chosen)

    def _answer(self, chosen: Sequence[_Task]) -> None:
        asked = [task.asked for task in chosen if task.asked is not None]
        began = time.perf_counter()
        try:
            with self._during([task.thread.ident or 0 for task in chosen if task.thread]):
                answers = self._turns(asked)
        except BaseException as error:  # noqa: BLE001 - raised where the turns were asked for
            for task in chosen:
                task.answer = error
            return
        share = (time.perf_counter() - began) / len(chosen)
        for task, answer in zip(chosen, answers, strict=True):
            task.answer = answer, share


def _alike(one: side_by_side.Asked | None, other: side_by_side.Asked) -> bool:
    return one is not None and one.machinery.module is other.machinery.module


def _distance(one: side_by_side.Asked | None, other: side_by_side.Asked) -> float:
    return abs(one.rtol - other.rtol) if one is not None else 0.0


_lanes: dict[str, side_by_side.Lanes | None] = {}  # by the name of a module; None where its text cannot be so compiled


def _turns(asked: Sequence[side_by_side.Asked]) -> list[Any]:
    """Return turns of one structure, side by side, or one by one where its text does not allow that."""
    machinery = asked[0].machinery
    name = machinery.module.__name__
    if name not in _lanes:
        try:
            with compiled.first(machinery.module, "lanes"):
                _lanes[name] = side_by_side.Lanes(machinery)
        except CannotCompile:
            _lanes[name] = None
    lanes = _lanes[name]
    if lanes is None:
        return [each.machinery.own_turn(each.y, each.rtol, each.h) for each in asked]
    return lanes.turns(asked)


_on_gpu: dict[str, Any] = {}  # by the name of a module


def _turns_on_gpu(asked: Sequence[side_by_side.Asked]) -> list[Any]:
    """Return turns of one structure, integrated on a GPU."""
    from screwsim.batch.cuda import Cuda

    machinery = asked[0].machinery
    name = machinery.module.__name__
    if name not in _on_gpu:
        _on_gpu[name] = Cuda(machinery)
    return _on_gpu[name].turns(asked)
