"""Cases are counted while they are solved, by this process or by others, and each of them once."""

import multiprocessing
import pickle
import time

import pytest

from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import CountingProgress, Progress
from screwsim.study.pool.tally import SHOWN_EVERY, Place, Tally, no_mark


class Seen(CountingProgress):
    """Progress that keeps what it would show."""

    def __init__(self):
        super().__init__("seen", lambda: 0.0)
        self.shown = []

    def tick(self):
        self.shown.append(self._done)


@pytest.fixture
def seen():
    found = Seen()
    found.start(10, 0)
    return found


def test_other_processes_count_and_a_finished_chunk_counts_no_case_twice(seen):
    tally = Tally(seen, Place.BESIDE)
    try:
        mark = pickle.loads(pickle.dumps(tally.mark))
        with multiprocessing.get_context("fork").Pool(2) as pool:
            pool.map(_marked, [mark] * 5)
        tally.tick()
        tally.advance(3, 0)  # a chunk of three; two more are solved
        tally.tick()
        mark()
        tally.tick()
    finally:
        tally.stop()
    assert seen.shown == [5, 5, 5, 6]
    tally.mark()  # its file is gone, which is no fault
    assert tally.solved() == 6


def _marked(mark):
    mark()


def test_cases_that_are_solved_again_are_not_more_than_there_are_and_no_unfinished_one_stays(seen):
    tally = Tally(seen, Place.BESIDE)
    tally.start(10, 4)
    for _ in range(9):  # three of them by a worker that died
        tally.mark()
    tally.tick()
    tally.advance(2, 0)
    tally.tick()
    tally.stop()
    seen.tick()
    assert seen.shown == [10, 10, 10, 6]


def test_one_process_alone_shows_its_cases_now_and_then(seen, monkeypatch):
    times = iter([0.0, 0.5 * SHOWN_EVERY, 2.0 * SHOWN_EVERY])
    monkeypatch.setattr("screwsim.study.pool.tally.time.monotonic", lambda: 100.0 + next(times))
    tally = Tally(seen, Place.HERE)
    for _ in range(3):
        tally.mark()
    assert seen.shown == [1, 3]
    tally.advance_all(3, 0)
    assert seen.shown[-1] == 3


def test_nothing_is_counted_where_nobody_looks(seen):
    class Others:
        """Progress of another program, written before there was `solving`."""

        def tick(self):
            """Show nothing."""

    assert Tally(Progress(), Place.BESIDE).mark is no_mark
    assert Tally(seen, Place.ELSEWHERE).mark is no_mark
    tally = Tally(Others(), Place.HERE)
    assert tally.mark is no_mark
    tally.tick()


def test_a_sweep_and_an_optimisation_show_cases_before_a_chunk_is_finished(seen, monkeypatch, tmp_path, pytestconfig):
    """One block of six cases, and a batch of thirteen evaluations: both in this process, shown case by case."""
    import screwsim

    monkeypatch.setattr("screwsim.study.pool.tally.SHOWN_EVERY", 0.0)
    point = screwsim.load(pytestconfig.rootpath / "configs" / "paper" / "point.yaml")
    rough = point.with_({"numerics.accuracy": "1e-2", "numerics.error": "none"})
    swept = rough.with_({"sweep.oil_supply.ratio": [1, 1.2, 1.4, 1.6, 1.8, 2]})
    screwsim.run_sweep(swept, tmp_path / "a.h5", jobs=1, progress=seen)
    assert seen.shown[:6] == [1, 2, 3, 4, 5, 6] and seen.shown[-1] == 6
    other = Seen()
    screwsim.optimize(
        rough, ["oil_supply.ratio=1..2"], ["isothermal_efficiency"], evaluations=13, jobs=1, progress=other
    )
    assert {1, 2, 3, 5, 8} <= set(other.shown) and other.shown[-1] == 13


def _slower_and_slower(number):
    time.sleep(0.15 if number > 3 else 1e-3)  # so that the later ones come in chunks
    return number


def test_a_study_on_workers_shows_points_before_a_chunk_is_finished_and_each_of_them_once(seen, monkeypatch):
    ahead = []
    show = seen.solving
    monkeypatch.setattr(seen, "solving", lambda cases: (ahead.append(cases), show(cases)))
    assert parallel_map(_slower_and_slower, 16, died=lambda number: -1, jobs=2, progress=seen) == list(range(16))
    assert max(ahead) > 0 and ahead[-1] == 0
    assert seen.shown == sorted(seen.shown) and seen.shown[-1] == 16


def test_what_was_solved_in_a_chunk_that_was_never_finished_is_counted():
    counted = CountingProgress()
    counted.start(7, 1)
    counted.advance(1, 0)
    counted.solving(3)
    counted.more(2)
    assert counted.counts == (5, 9)
    counted.solving(0)  # as at the end of an interrupted study
    counted.stop()
    assert counted.counts == (5, 9)
