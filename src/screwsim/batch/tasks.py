"""Solve points side by side: each point proceeds on its own, and turns are integrated for many points in one call.

Each task runs in its own greenlet until it asks for a turn; then the next task continues, in the same thread. When all
have asked, the turns of one structure are integrated together (`model.side_by_side`). Everything between turns (mixing,
corrections, estimates, figures, the verdict) is done as for a single point, and so is the arithmetic of each lane: no
result depends on which points ran beside it.
"""

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import copy_context
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from greenlet import GreenletExit, getcurrent, greenlet

from screwsim.batch.driver import DeviceError, device, look_for_driver
from screwsim.batch.on_device import DeviceTurns, ptx_of
from screwsim.codegen.kinds import LANES
from screwsim.codegen.program import CannotCompile
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import problem_of, sharing
from screwsim.inputs.faults import UsageError
from screwsim.model import compiled, side_by_side
from screwsim.model.run import Machinery
from screwsim.model.turn_scheduler import scheduler
from screwsim.numerics.compiling import again, clock
from screwsim.outputs import Result
from screwsim.scene.types import Scene
from screwsim.simulate import simulate, simulate_many

Answer = TypeVar("Answer")
IN_FLIGHT = 2 * LANES  # tasks at a time: enough to find turns of similar tolerance
IN_STEP = LANES  # the same for courses, whose points take similar turns; more would not fit in the cache
ON_GPU = 1024  # tasks at a time on a GPU, and turns in one call
Turns = Callable[[Sequence[side_by_side.TurnRequest]], list[Any]]
OnSwitch = Callable[[greenlet, greenlet], None]
During = Callable[[Sequence[greenlet]], AbstractContextManager[Any]]  # called with the tasks for which a call is made


@dataclass(eq=False)
class _Task:
    """A task with its greenlet, and the turn it asks for or the answer."""

    number: int
    run: greenlet
    asked: side_by_side.TurnRequest | None = None
    answer: Any = None


def together(
    tasks: Sequence[Callable[[], Answer]],
    in_flight: int | None = None,
    during: During | None = None,
    gpu: bool = False,
    handed_on: OnSwitch | None = None,
    lanes: bool = True,
) -> list[Answer]:
    """Return what each task returns; the turns that they ask for are integrated side by side.

    `in_flight` tasks run at a time. What a task raises is raised here once all have ended; those that wait for a
    turn are ended by GreenletExit. `during` is a context around waiting and calls, for measuring times; `handed_on`
    is called when one task continues in place of another. With `gpu` a GPU integrates (`screwsim.batch.on_device`),
    otherwise the lanes of this core; without `lanes` turns are integrated one by one, with the bits of single
    points.
    """
    default, most = (ON_GPU, ON_GPU) if gpu else (IN_FLIGHT, LANES)
    turns = _turns_on_gpu if gpu else _turns if lanes else _one_by_one
    return _Scheduler(tasks, max(1, in_flight or default), during or nullcontext, most, turns, handed_on).run()


def simulate_courses(courses: Iterable[Iterable[Scene]], trace: bool = False, gpu: bool = False) -> list[list[Result]]:
    """Return the results of courses of scenes, side by side; within a course each scene starts from those before it.

    Courses of one scene each are independent points, like those of a sample.
    """
    every = [list(scenes) for scenes in courses]
    in_flight = IN_STEP if not gpu and any(len(scenes) > 1 for scenes in every) else None
    return together([partial(_course, scenes, trace) for scenes in every], in_flight, gpu=gpu)


def _course(scenes: Sequence[Scene], trace: bool) -> list[Result]:
    return list(simulate_many(scenes, trace))


def warm_up(scene: Scene) -> None:
    """Compile or load what a scene needs to run side by side with others."""
    together([partial(simulate, scene, scene.output.keeps_cycle)])


def prepare_for_gpu(scene: Scene) -> None:
    """Compile what a scene needs on a GPU, without opening one: a process that has opened one must not be forked.

    Raises UsageError without access to a GPU, or where the scene calls something that a GPU does not have.
    """
    look_for_driver()
    problem = problem_of(scene)
    machinery = lease_for(problem)
    with compiled.announce_first(machinery.module, "device"), _device_errors(), again():
        ptx_of(machinery)


@contextmanager
def _device_errors() -> Iterator[None]:
    """Turn errors of the compiler and the device into UsageError."""
    try:
        yield
    except (CannotCompile, DeviceError) as why:
        raise UsageError(f"this scene cannot be solved on a GPU: {why}; leave it to the processor") from None


class _Scheduler:
    """Tasks in greenlets, one running at a time; the scheduler runs in the caller's greenlet."""

    def __init__(
        self,
        tasks: Sequence[Callable[[], Any]],
        in_flight: int,
        during: During,
        most: int,
        turns: Turns,
        handed_on: OnSwitch | None,
    ) -> None:
        self._left = deque(enumerate(tasks))
        self._answers: list[Any] = [None] * len(tasks)
        self._in_flight, self._during = in_flight, during
        self._most, self._turns, self._handed_on = most, turns, handed_on
        self._ready: deque[_Task] = deque()
        self._waiting: list[_Task] = []
        self._own = getcurrent()
        self._now: _Task | None = None  # the running task

    def run(self) -> list[Any]:
        """Run all tasks and return their answers."""
        before = scheduler.turn, scheduler.station
        scheduler.turn, scheduler.station = self._turn, self._station
        try:
            with sharing():
                while self._go_on():
                    pass
            return self._answers
        finally:
            scheduler.turn = scheduler.station = _end_task
            try:
                # end tasks that nobody waits for any more, where they asked for a turn
                while self._ready or self._waiting:
                    task = self._ready.popleft() if self._ready else self._waiting.pop()
                    task.run.throw()
            finally:
                scheduler.turn, scheduler.station = before

    def _go_on(self) -> bool:
        """Run the next task: a new one while there is room, one that has its answer, or one after a call."""
        while self._left and len(self._ready) + len(self._waiting) < self._in_flight:
            self._begin(*self._left.popleft())
        if not self._ready and self._waiting:
            self._call()
        if self._ready:
            self._run(self._ready.popleft())
        return bool(self._ready or self._waiting or self._left)

    def _begin(self, number: int, work: Callable[[], Any]) -> None:
        """Start a task in its own greenlet and context."""
        run = greenlet(partial(self._after_begin, work), self._own)
        run.gr_context = copy_context()
        run.switch()
        self._ready.append(_Task(number, run))

    def _after_begin(self, work: Callable[[], Any]) -> Any:
        """Wait until scheduled: the task's stack then starts from the scheduler's, not from another task's station."""
        self._own.switch()
        return work()

    def _run(self, task: _Task) -> None:
        """Run a task, and others from its stations on, until one asks for a turn or ends; raise what it raises."""
        self._now = task
        answer = task.run.switch()
        task = self._now
        if task.run.dead:
            self._answers[task.number] = answer
        else:
            self._waiting.append(task)

    def _turn(self, machinery: Machinery, y: Any, rtol: float, h: float) -> Any:
        """Ask for a turn, let others run, and return the answer (in the task's own greenlet)."""
        began, before, task = clock(), scheduler.elsewhere, self._now
        assert task is not None
        task.asked = side_by_side.TurnRequest(machinery, y, rtol, h)
        with self._during(()):
            self._own.switch()
        if isinstance(task.answer, BaseException):  # an error of the call, raised in every task that waited for it
            raise task.answer
        answer, share = task.answer
        scheduler.elsewhere = before + clock() - began - share
        return answer

    def _station(self) -> None:
        """Let others run until they reach the same station (in the task's own greenlet); the next one continues."""
        if not self._ready:
            return
        began, before, task = clock(), scheduler.elsewhere, self._now
        assert task is not None
        other = self._now = self._ready.popleft()
        self._ready.append(task)
        if self._handed_on is not None:
            self._handed_on(task.run, other.run)
        other.run.switch()
        scheduler.elsewhere = before + clock() - began

    # ---- turns in one call -----------------------------------------------------------------------------------------

    def _call(self) -> None:
        """Integrate turns of waiting tasks: of the longest waiting one's structure, those nearest to its tolerance."""
        pairs = [(task, task.asked) for task in self._waiting if task.asked is not None]
        first = pairs[0][1]
        alike = [pair for pair in pairs if pair[1].machinery.module is first.machinery.module]
        alike.sort(key=lambda pair: abs(pair[1].rtol - first.rtol))
        chosen, asked = zip(*alike[: self._most], strict=True)
        self._answer(chosen, asked)
        answered = set(chosen)
        self._waiting = [task for task in self._waiting if task not in answered]
        self._ready.extend(chosen)

    def _answer(self, chosen: Sequence[_Task], asked: Sequence[side_by_side.TurnRequest]) -> None:
        """Integrate turns and give each task its answer and its share of the time, or the error."""
        began = clock()
        try:
            with self._during([task.run for task in chosen]):
                answers = self._turns(asked)
        except Exception as error:  # noqa: BLE001 - raised where the turns were asked for
            for task in chosen:
                task.answer = error
            return
        share = (clock() - began) / len(chosen)
        for task, answer in zip(chosen, answers, strict=True):
            task.answer = answer, share


def _end_task(*_asked: object) -> Any:
    """End a task that asks for another turn although nobody waits for it."""
    raise GreenletExit


_lanes: dict[str, side_by_side.Lanes | None] = {}  # by module name; None where the text cannot be compiled for lanes


def _turns(asked: Sequence[side_by_side.TurnRequest]) -> list[Any]:
    """Return turns of one structure, integrated side by side, or one by one where its text does not allow that."""
    machinery = asked[0].machinery
    name = machinery.module.__name__
    if name not in _lanes:
        try:
            with compiled.announce_first(machinery.module, "lanes"), again():
                _lanes[name] = side_by_side.Lanes(machinery)
        except CannotCompile:
            _lanes[name] = None
    lanes = _lanes[name]
    return _one_by_one(asked) if lanes is None else lanes.turns(asked)


def _one_by_one(asked: Sequence[side_by_side.TurnRequest]) -> list[Any]:
    return [each.machinery.own_turn(each.y, each.rtol, each.h) for each in asked]


_on_device: dict[tuple[int, str], DeviceTurns] = {}  # by process and name of a module


def _turns_on_gpu(asked: Sequence[side_by_side.TurnRequest]) -> list[Any]:
    """Return turns of one structure, integrated on a GPU."""
    machinery = asked[0].machinery
    key = os.getpid(), machinery.module.__name__
    if key not in _on_device:
        with compiled.announce_first(machinery.module, "device"), _device_errors(), again():
            _on_device[key] = DeviceTurns(machinery, device())
    return _on_device[key].turns(asked)
