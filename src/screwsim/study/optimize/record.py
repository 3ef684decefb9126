"""All evaluations of an optimisation, in the order in which it asked for them; those of an earlier run are reused.

Each request depends on nothing but the answers so far, so that a restarted run makes the same requests: the stored
cases of an interrupted run are its first answers. A batch is cut into blocks whose cycles start from each other; the
cut depends on the batch alone, so that answers depend neither on the number of workers nor on interruptions.
"""

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from screwsim.outputs import Result
from screwsim.results.table import Table, join, table_of, warnings_at
from screwsim.scene import Scene
from screwsim.study.asked.varied import with_values
from screwsim.study.optimize.evaluate import Evaluation, evaluation_of, simulated
from screwsim.study.optimize.question import Question
from screwsim.study.pool.limit import CASE_LIMIT, TimeLimit
from screwsim.study.pool.parallel import BatchWorkers, WarmSimulation, unpacked
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.solving import Simulate
from screwsim.study.pool.tally import Place, Tally
from screwsim.study.pool.workers import WORKER_DIED, pickled_work
from screwsim.study.sweep.shards import Parts
from screwsim.study.uncertainty.point import with_slopes

# evaluations after which workers start afresh: their caches fill with tables and rotors of many profiles
EVALUATIONS_PER_WORKER = 2000
BLOCK_EVALUATIONS = 4  # evaluations of a batch whose cycles start from each other
MOST_REASONS = 100  # kinds of failure reasons that are kept
OTHER_REASON = "another reason"
# question, simulation, time limit of a case [s], and what counts an evaluation
_Job = tuple[Question, Simulate | None, float | None, Callable[[], None]]


class BudgetExhausted(Exception):
    """All evaluations have been used."""


@dataclass
class Record:
    """Evaluations so far: places (n, paths), aims, errors, excess (n, …), and why some failed."""

    asked: Question
    crew: BatchWorkers
    parts: Parts | None = None  # where the cases are stored
    simulate: Simulate | None = None
    tally: Tally = field(default_factory=lambda: Tally(Progress(), Place.HERE))  # shared where there are workers
    reasons: Counter[str] = field(default_factory=Counter)
    reused: int = 0
    warned: dict[int, tuple[str, ...]] = field(default_factory=dict)  # by number of the evaluation, of those that warn
    _places: list[np.ndarray] = field(default_factory=list)
    _rows: list[np.ndarray] = field(default_factory=list)
    _kinds: dict[str, str] = field(default_factory=dict)  # kind of a reason -> its first example
    _job: _Job | bytes = b""
    _crews: int = 0
    _kept: int = 0  # cases stored by an earlier run, counted from the first

    def __post_init__(self) -> None:
        limit = CASE_LIMIT * len(self.asked.points.points) if self.crew.jobs > 1 else None
        job = self.asked, self.simulate, limit, self.tally.mark
        self._job = job if self.crew.jobs <= 1 else pickled_work(job)
        if self.parts is not None:
            for cases in self.parts.finished():
                self._kept = cases.stop if cases.start == self._kept else self._kept
        self.tally.start(self.asked.evaluations, 0)

    def __len__(self) -> int:
        return sum(map(len, self._places))

    @property
    def places(self) -> np.ndarray:
        """Places of all evaluations, (n, paths)."""
        return np.concatenate(self._places) if self._places else np.empty((0, len(self.asked.spans)))

    def columns(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return aims, their errors and the excess over the bounds, (n, …); NaN where an evaluation failed."""
        aims, bounds = len(self.asked.aims), len(self.asked.bounds)
        rows = np.concatenate(self._rows) if self._rows else np.empty((0, 2 * aims + bounds))
        return rows[:, :aims], rows[:, aims : 2 * aims], rows[:, 2 * aims :]

    def evaluate(self, places: np.ndarray) -> list[Evaluation]:
        """Return the evaluations of places (n, paths); where fewer are left, keep those and raise `BudgetExhausted`."""
        wanted, left = np.clip(np.atleast_2d(np.asarray(places, float)), 0.0, 1.0), self.asked.evaluations - len(self)
        places = wanted[:left]
        if not len(places):
            raise BudgetExhausted
        size = len(self.asked.points.points)
        cases = range(size * len(self), size * (len(self) + len(places)))
        table = self.parts.table(cases) if self.parts is not None and cases.stop <= self._kept else None
        if table is None:
            table = self._computed(places)
            if self.parts is not None:
                self.parts.write(cases.start, table)
        else:
            self.reused += len(places)
        found = [evaluation_of(self.asked, table, size * number) for number in range(len(places))]
        for number in range(len(places)):
            texts = dict.fromkeys(text for row in range(size) for text in warnings_at(table, size * number + row))
            if texts:
                self.warned[len(self) + number] = tuple(texts)
        self._keep(places, found)
        if len(places) < len(wanted):
            raise BudgetExhausted
        return found

    def _keep(self, places: np.ndarray, found: Sequence[Evaluation]) -> None:
        failed = [(each.at, each.failed) for each in found if each.failed]
        for at, reason in failed:  # one example of those that differ by their numbers alone
            kind = at + re.sub(r"[0-9][0-9.e+-]*", "#", reason)
            if len(self._kinds) < MOST_REASONS:
                self._kinds.setdefault(kind, reason)
            self.reasons[self._kinds.get(kind, OTHER_REASON)] += 1
        self._places.append(places)
        self._rows.append(np.array([(*each.aims, *each.errors, *each.excess) for each in found], float))
        self.tally.advance_all(len(found), len(failed))

    def _computed(self, places: np.ndarray) -> Table:
        if len(self) // EVALUATIONS_PER_WORKER > self._crews:  # bounds the memory of workers
            self._crews = len(self) // EVALUATIONS_PER_WORKER
            self.crew.leave()
        order = nearest_neighbour_order(places)
        blocks = [order[start : start + BLOCK_EVALUATIONS] for start in range(0, len(order), BLOCK_EVALUATIONS)]
        tables = self._solved(places, blocks)
        whole = join(tables) if len(tables) > 1 else tables[0]
        size, back = len(self.asked.points.points), np.argsort(order)
        return whole.rows((size * back[:, None] + np.arange(size)).ravel())

    def _solved(self, places: np.ndarray, blocks: Sequence[np.ndarray]) -> list[Table]:
        """Return the results of blocks; where a worker died over a block, its evaluations are tried one by one."""
        tables = self.crew.answers(partial(_block, self._job), [places[rows] for rows in blocks])
        for number, table in enumerate(tables):
            if table is None and len(blocks[number]) == 1:
                dead = [Result("failed", message=WORKER_DIED)] * len(self.asked.points.points)
                tables[number] = table_of(dead, keep_cycle=False)
            elif table is None:
                tables[number] = join(self._solved(places, [rows[None] for rows in blocks[number]]))
        return tables


def nearest_neighbour_order(places: np.ndarray) -> np.ndarray:
    """Return an order in which each place is followed by the nearest remaining one."""
    left, order = set(range(1, len(places))), [0]
    while left:
        rest = np.array(sorted(left))
        nearest = rest[np.argmin(np.sum((places[rest] - places[order[-1]]) ** 2, axis=1))]
        order.append(int(nearest))
        left.remove(int(nearest))
    return np.array(order)


def _block(job: _Job | bytes, block: np.ndarray) -> Table:
    """Return the results of a block of places (n, paths), one operating point per row."""
    asked, simulate, limit, mark = job if isinstance(job, tuple) else unpacked(job)
    simulate = simulate or WarmSimulation()
    results: list[Result] = []
    for places in block:
        with TimeLimit(limit):
            values = asked.values(places)
            machine = with_values(asked.scene, values)
            for each in simulated(asked, values, simulate):
                at = with_values(machine, each.values)
                results.append(with_slopes(at, each.result) if isinstance(at, Scene) else each.result)
        mark()
    return table_of(results, keep_cycle=False, keep_slopes=True)
