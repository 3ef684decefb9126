"""Solutions live side by side: in threads, in one series, half done; none sees another."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scenes import make

from screwsim import simulate
from screwsim.fluid import constants
from screwsim.outputs import Result
from screwsim.prepared import Series
from screwsim.scene import Scene
from screwsim.simulate import simulate_many
from screwsim.solution import Solution

SPEEDS = ("1000 rpm", "2000 rpm", "3000 rpm")
REAL = {
    "gas.model": "real",
    "oil.transport": "carried",
    "oil_supply.temperature": "333 K",
    "operation.suction": {"pressure": "3.15 bar", "temperature": "285 K"},
    "operation.discharge": {"pressure": "11.6 bar"},
}
THREADS, EACH = 8, 200


def scenes(changes: dict | None = None) -> list[Scene]:
    return [make({"operation.speed": speed, **(changes or {})}) for speed in SPEEDS]


def figures(result: Result) -> tuple[str, dict, dict]:
    return result.status, dict(result.performance), dict(result.balance)


def answers(asked: list[Scene], thread: int) -> list[tuple[int, tuple]]:
    """Return place and answer of scenes in an order of the thread's own."""
    order = np.random.default_rng(thread).integers(len(asked), size=EACH).tolist()
    return [(place, figures(simulate(asked[place], trace=place == 0))) for place in order]


def differing(asked: list[Scene]) -> int:
    """Return how many answers of threads are not those of the scene alone."""
    alone = [figures(simulate(scene)) for scene in asked]
    assert len({repr(one) for one in alone}) == len(asked)
    with ThreadPoolExecutor(THREADS) as pool:
        found = pool.map(answers, [asked] * THREADS, range(THREADS))
        return sum(alone[place] != answer for one in found for place, answer in one)


def test_threads_give_each_scene_its_own_answer():
    assert differing(scenes()) == 0


def test_threads_give_scenes_of_two_gases_their_own_answers():
    assert differing([*scenes(), *scenes(REAL)]) == 0


def test_a_series_in_each_thread_is_that_series_alone():
    def run(thread: int) -> list[tuple]:
        ratios = np.linspace(1.0 + 0.1 * thread, 3.0, 25)
        return [figures(one) for one in simulate_many([make({"oil_supply.ratio": float(x)}) for x in ratios])]

    alone = [run(thread) for thread in range(THREADS)]
    with ThreadPoolExecutor(THREADS) as pool:
        assert list(pool.map(run, range(THREADS))) == alone


@pytest.mark.parametrize("shared", [False, True])
def test_a_solution_stays_while_others_are_solved(shared):
    """Also two of one series: what is composed for the second leaves the first as it was."""
    slow, fast = make({"operation.speed": "1000 rpm"}), make({})
    series = Series() if shared else None
    first = Solution(slow, series)
    closed = first.close()
    before = dict(first.figures(closed.q)[0])
    second = Solution(fast, series)
    other = second.close()
    simulate(fast)
    first._read.clear()  # what it remembers of the closed cycle: it reads its arrays again
    assert dict(first.figures(closed.q)[0]) == before
    assert dict(second.figures(other.q)[0]) != before
    assert first.machinery is not second.machinery
    assert not np.shares_memory(first.machinery.composition.P, second.machinery.composition.P)


def test_what_is_given_back_cannot_be_read_any_more():
    solution = Solution(make({}))
    closed = solution.close()
    solution.release()
    with pytest.raises(AttributeError):
        solution.figures(closed.q)


def test_an_interrupted_solution_keeps_its_arrays_from_the_next():
    """Whatever it left half written is in nobody's hands."""

    class Stop(BaseException):
        pass

    def stop() -> None:
        raise Stop

    solution = Solution(make({}))
    solution.machinery.watch = stop
    with pytest.raises(Stop):
        solution.close()
    assert Solution(make({})).machinery is not solution.machinery


def test_threads_ask_coolprop_one_after_the_other(monkeypatch):
    """Its state is set and then read; two that ask at once must not read each other's."""
    fluids, pressures = ("R134a", "Propane", "Ammonia", "Water"), np.linspace(2e5, 2e6, 40).tolist()
    asked = [(fluid, p) for p in pressures for fluid in fluids]
    monkeypatch.setattr(constants, "append_line", lambda *_: None)  # nothing of it is kept

    def ask(pair: tuple[str, float]) -> tuple[float, float]:
        fluid, p = pair
        T = constants.saturation_temperature(fluid, p)
        return T, constants.saturated_liquid_enthalpy(fluid, T)

    constants._known().clear()
    alone = [ask(pair) for pair in asked]
    constants._known().clear()
    with ThreadPoolExecutor(THREADS) as pool:
        assert list(pool.map(ask, asked)) == alone
