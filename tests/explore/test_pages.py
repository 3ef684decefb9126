"""Every number that a page asks is answered once, in order; what waits is overtaken by what is newer."""

import asyncio
import json

import pytest
from each_row import each_row

from screwsim.explore import answer
from screwsim.explore.pages import Page


class Desk:
    """A crew that answers when it is let."""

    def __init__(self, workers):
        self.free: asyncio.Queue = asyncio.Queue()
        for name in ("one", "other")[:workers]:
            self.free.put_nowait(name)
        self.jobs, self.let, self.aside = [], asyncio.Semaphore(0), asyncio.Semaphore(1)

    async def lend(self):
        return await self.free.get()

    def give_back(self, worker):
        self.free.put_nowait(worker)

    async def solve(self, worker, job, newer, note):
        self.jobs.append(job)
        await self.let.acquire()
        self.give_back(worker)
        return answer.pack_message({"kind": "solved", **job.tag, "newer": newer()})


def point(number):
    return json.dumps({"kind": "point", "number": number, "changes": {"set": {"x": number}}})


def points(lane, name, count):
    return json.dumps(
        {"kind": lane, "id": name, "points": [["x", i] for i in range(count)], "changes": {"set": {"y": 1}}}
    )


def played(script, workers=1):
    """Return heads of all answers of a page over a script of messages, and of ints: so many answers are let."""

    async def run():
        desk, heads = Desk(workers), []

        async def send(message):
            heads.append(answer.unpack_message(message)[0])

        page = Page(desk, send)
        tasks = [asyncio.create_task(page.work()), asyncio.create_task(page.work_aside())]
        for step in script:
            if isinstance(step, str):
                page.take(step)
            else:
                for _ in range(step):
                    desk.let.release()
            for _ in range(20):
                await asyncio.sleep(0)
        for task in tasks:
            task.cancel()
        return heads, desk.jobs

    return asyncio.run(run())


def test_each_number_is_answered_once_and_in_order():
    heads, _ = played([point(1), point(2), point(3), 1, point(4), 1, point(5), point(6), point(7), 9])
    assert [(head["first"], head["number"]) for head in heads] == [(1, 1), (2, 3), (4, 4), (5, 7)]


def test_the_newest_is_solved_and_what_it_overtook_is_not():
    _, jobs = played([point(1), point(2), point(3), 5])
    assert [job.changes["set"]["x"] for job in jobs] == [1, 3]


def test_a_solution_knows_that_a_newer_one_waits():
    heads, _ = played([point(1), point(2), 2])
    assert [head["newer"] for head in heads] == [True, False]


def test_settings_go_before_points_and_the_small_sweep_before_what_lies_around():
    _, jobs = played([point(1), points("around", 1, 2), points("curve", 2, 2), point(2), 9])
    assert [(job.kind, job.tag.get("lane")) for job in jobs] == [
        ("point", None),
        ("point", None),
        ("curve", "curve"),
        ("curve", "curve"),
        ("curve", "around"),
        ("curve", "around"),
    ]


def test_points_change_one_value_beside_the_settings():
    _, jobs = played([points("curve", 7, 2), 2])
    assert [job.changes["set"] for job in jobs] == [{"y": 1, "x": 0}, {"y": 1, "x": 1}]
    assert [job.tag for job in jobs] == [{"lane": "curve", "id": 7, "index": i} for i in range(2)]


def test_new_points_take_the_place_of_old_ones():
    heads, _ = played([point(1), points("curve", 1, 5), points("curve", 2, 1), 9])
    assert [head.get("id") for head in heads] == [None, 2]


@each_row("numbers", [(2,), (1, 1), (1, 3), (0,), (-1,)])
def test_numbers_that_skip_are_refused(numbers):
    with pytest.raises(Exception, match="not numbered"):
        played([point(number) for number in numbers])


def slopes(name):
    return json.dumps({"kind": "slopes", "id": name, "changes": {"set": {"x": 0}}})


def test_derivatives_are_found_beside_all_else():
    _, jobs = played([slopes(1), point(1)], workers=2)
    assert [job.kind for job in jobs] == ["slopes", "point"]  # neither was let end


def test_of_derivatives_the_newest_alone_is_found_next():
    heads, _ = played([slopes(1), slopes(2), slopes(3), 5], workers=2)
    assert [head["id"] for head in heads] == [1, 3]
