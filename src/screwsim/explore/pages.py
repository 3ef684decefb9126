"""The open pages: what each requests, in order, with only the newest of waiting settings solved.

A page numbers its settings 1, 2, 3 … An answer states the range of numbers that it covers: settings overtaken by newer
ones while waiting are answered by those.
"""

import asyncio
import json
import time
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Any, NamedTuple

from screwsim.explore import answer
from screwsim.explore.worker import Job
from screwsim.explore.worker_pool import WorkerPool

MOST_POINTS = 200  # of a curve, or of variations around the settings
LONGEST_MESSAGE = 64_000  # characters of a message
RATE, BURST = 200.0, 400.0  # messages per second that a page may send, and in a burst
POINT_QUEUES = ("curve", "around")  # of points, in order of priority


class InvalidMessage(Exception):
    """Reason why a message cannot come from our page."""


class PageRequest(NamedTuple):
    """The newest settings, their number, and the key of the machine that the page draws."""

    number: int
    changes: Any
    machine: str


class RateLimit:
    """Rate limit for pages that send too much."""

    def __init__(self, rate: float = RATE, burst: float = BURST) -> None:
        self._rate, self._burst, self._left, self._last = rate, burst, burst, time.monotonic()

    def wait(self) -> float:
        """Count a message; return how long [s] to wait before reading the next."""
        now = time.monotonic()
        self._left = min(self._burst, self._left + self._rate * (now - self._last)) - 1.0
        self._last = now
        return max(0.0, -self._left / self._rate)


class Page:
    """One open page."""

    def __init__(self, crew: WorkerPool, send: Callable[[bytes], Awaitable[None]]) -> None:
        self._crew, self._send = crew, send
        self._newest: PageRequest | None = None
        self._asked, self._answered = 0, 0
        self._lanes: dict[str, deque[Job]] = {lane: deque() for lane in POINT_QUEUES}
        self._awake = asyncio.Event()
        self._aside: Job | None = None
        self._aside_awake = asyncio.Event()
        self._notes: set[asyncio.Task[None]] = set()
        self.gone = False

    def take(self, text: str) -> None:
        """Accept a message; raise InvalidMessage if it is not a valid one."""
        if len(text) > LONGEST_MESSAGE:
            raise InvalidMessage("a message is too long")
        try:
            asked = json.loads(text)
        except (ValueError, RecursionError):
            raise InvalidMessage("a message is not JSON") from None
        if not isinstance(asked, dict):
            raise InvalidMessage("a message is not a mapping")
        if asked.get("kind") == "point":
            number, machine = asked.get("number"), asked.get("machine", "")
            if type(number) is not int or number != self._asked + 1 or not isinstance(machine, str):
                raise InvalidMessage("settings are not numbered 1, 2, 3 and so on")
            self._asked = number
            self._newest = PageRequest(number, asked.get("changes"), machine[:16])
        elif asked.get("kind") in POINT_QUEUES:
            self._take_points(asked["kind"], asked)
        elif asked.get("kind") == "slopes" and type(asked.get("id")) is int:
            self._aside = Job("slopes", asked.get("changes"), {"lane": "slopes", "id": asked["id"]})
            self._aside_awake.set()
        else:
            raise InvalidMessage("a message is of no known kind")
        self._awake.set()

    def _take_points(self, lane: str, asked: dict[str, Any]) -> None:
        """Replace the points of a lane by new ones: each [path, value], with the rest as in `changes`."""
        points, changes, name = asked.get("points"), asked.get("changes"), asked.get("id")
        values = changes.get("set", {}) if isinstance(changes, dict) else None
        if not isinstance(points, list) or len(points) > MOST_POINTS or type(name) is not int:
            raise InvalidMessage("points are not a list, or too many")
        pairs = (isinstance(point, list) and len(point) == 2 and isinstance(point[0], str) for point in points)
        if not isinstance(changes, dict) or not isinstance(values, dict) or not all(pairs):
            raise InvalidMessage("points are not pairs [path, value] for the settings")
        self._lanes[lane].clear()
        for index, (path, value) in enumerate(points):
            changed = {**changes, "set": {**values, path: value}}
            self._lanes[lane].append(Job("curve", changed, {"lane": lane, "id": name, "index": index}))

    def _next(self) -> Job | None:
        """Return the next job: the newest settings, then points."""
        if self._newest is not None:
            number, changes, machine = self._newest
            tag = {"first": self._answered + 1, "number": number}
            self._newest, self._answered = None, number
            return Job("point", changes, tag, machine)
        return next((self._lanes[lane].popleft() for lane in POINT_QUEUES if self._lanes[lane]), None)

    async def work(self) -> None:
        """Answer the page's requests, one after another, as long as it is open."""
        while True:
            await self._awake.wait()
            worker = await self._crew.lend()
            job = self._next()
            if job is None:
                self._crew.give_back(worker)
                self._awake.clear()
                continue
            await self._send(await self._crew.solve(worker, job, self._newer, self._note))

    async def work_aside(self) -> None:
        """Answer the newest long request beside all others, if there is a worker for it."""
        while True:
            await self._aside_awake.wait()
            self._aside_awake.clear()
            async with self._crew.aside:
                worker = await self._crew.lend()
                job, self._aside = self._aside, None
                if job is None:
                    self._crew.give_back(worker)
                    continue
                await self._send(await self._crew.solve(worker, job, lambda: self.gone, lambda text: None))

    def _newer(self) -> bool:
        return self.gone or self._newest is not None

    def _note(self, text: str) -> None:
        """Send a worker's remark while it solves."""
        if not self.gone:
            task = asyncio.ensure_future(self._send(answer.pack_message({"kind": "note", "text": text})))
            self._notes.add(task)
            task.add_done_callback(self._note_sent)

    def _note_sent(self, task: asyncio.Task[None]) -> None:
        self._notes.discard(task)
        if not task.cancelled():
            task.exception()  # retrieves the error of a page that has closed meanwhile
