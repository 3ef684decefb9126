"""Cycles live side by side: in threads, in one series, half done; none sees another."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scenes import SOLUBLE, make

from screwsim import simulate
from screwsim.cycle.close import close
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import ClosingTask, Problem, Series, problem_of
from screwsim.cycle.solution import CycleSolution
from screwsim.evaluate.evaluation import balance, evaluate
from screwsim.evaluate.ledger.total import ledger
from screwsim.evaluate.traces import traces
from screwsim.fluid import constants
from screwsim.model import leases
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.simulate import simulate_many
from screwsim.solve.accurately import solve

SPEEDS = ("1000 rpm", "2000 rpm", "3000 rpm")
FAST = ("2600 rpm", "2800 rpm", "3000 rpm")  # that close in few turns
REAL = {
    "gas.model": "real",
    "oil.transport": "carried",
    "oil_supply.temperature": "333 K",
    "operation.suction": {"pressure": "3.15 bar", "temperature": "285 K"},
    "operation.discharge": {"pressure": "11.6 bar"},
}
PLENUMS = {
    "oil.transport": "carried",
    "effects.plenums": {"suction_volume": "8 l", "discharge_volume": "3 l", "suction_area": "40 cm^2"},
}
THREADS, EACH = 8, 60
OFTEN = 2e-5  # [s] after which threads take turns: Python's own 5 ms is as long as a solution
FEWER = 15  # where the scenes are a part of those of two gases, each with the estimate of its errors
QUICK = {"numerics.accuracy": 9e-2, "numerics.error": "none"}  # many short solutions meet as often as long ones
PORTS = {"effects": {"suction_port": {}, "discharge_port": {}}}


def scenes(changes: dict | None = None, speeds: tuple[str, ...] = SPEEDS) -> list[Scene]:
    return [make({"operation.speed": speed, **(changes or {})}) for speed in speeds]


def figures(result: Result) -> tuple[str, dict, dict]:
    return result.status, dict(result.performance), dict(result.balance)


def answers(asked: list[Scene], thread: int, each: int) -> list[tuple[int, tuple]]:
    """Return place and answer of scenes in an order of the thread's own."""
    order = np.random.default_rng(thread).integers(len(asked), size=each).tolist()
    return [(place, figures(simulate(asked[place], trace=place == 0))) for place in order]


@pytest.fixture
def often() -> Iterator[None]:
    """Let threads take turns often, so that they meet in few solutions wherever they can."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(OFTEN)
    yield
    sys.setswitchinterval(usual)


def differing(asked: list[Scene], each: int = EACH) -> int:
    """Return how many answers of threads are not those of the scene alone."""
    alone = [figures(simulate(scene, trace=place == 0)) for place, scene in enumerate(asked)]
    assert len({repr(one) for one in alone}) == len(asked)
    with ThreadPoolExecutor(THREADS) as pool:
        found = pool.map(answers, [asked] * THREADS, range(THREADS), [each] * THREADS)
        return sum(alone[place] != answer for one in found for place, answer in one)


def test_threads_give_each_scene_its_own_answer():
    assert differing(scenes(), FEWER) == 0


@pytest.mark.usefixtures("often")
@pytest.mark.parametrize("each", [EACH, pytest.param(200, marks=pytest.mark.around)])
def test_threads_give_scenes_of_two_gases_their_own_answers(each):
    assert differing([*scenes({**QUICK, **PORTS}), *scenes({**REAL, **QUICK}, FAST)], each) == 0


def test_a_series_in_each_thread_is_that_series_alone():
    def run(thread: int) -> list[tuple]:
        ratios = np.linspace(1.0 + 0.1 * thread, 3.0, 6)
        return [figures(one) for one in simulate_many([make({"oil_supply.ratio": float(x)}) for x in ratios])]

    alone = [run(thread) for thread in range(THREADS)]
    with ThreadPoolExecutor(THREADS) as pool:
        assert list(pool.map(run, range(THREADS))) == alone


def all_of(problem: Problem, cycle: CycleSolution) -> tuple[dict, dict, dict, dict]:
    """Return all that is read of a cycle, traces as bytes."""
    of = evaluate(problem, cycle)
    book = ledger(of).figures()
    return dict(of.figures), dict(balance(of)), dict(book), {name: a.tobytes() for name, a in traces(of).items()}


@pytest.mark.parametrize("changes", [{}, REAL, SOLUBLE, PLENUMS], ids=("paper", "real gas", "soluble", "plenums"))
@pytest.mark.parametrize("closing", ["histories", "coupled"])
def test_a_cycle_is_read_after_another_one_of_its_structure_was_solved(closing, changes):
    """Also in one series, and in one machinery: what is done for the second leaves the first as it was."""
    all_ways = {"numerics.closing": closing, "numerics.accuracy": 1e-3, **changes}
    slow, fast = (make({"operation.speed": speed, **all_ways}) for speed in ("1000 rpm", "3000 rpm"))
    alone = all_of(*solved(problem_of(slow)))
    for shared in (False, True):
        series = Series() if shared else None
        problem, other = problem_of(slow, series), problem_of(fast, series)
        machinery = lease_for(problem)
        first = solve(problem, machinery).cycle
        leases.give_back(machinery)
        if shared:
            machinery = leases.lease(other.composition)  # the same one
        second = solve(other, machinery if shared else lease_for(other)).cycle
        simulate(fast)
        assert all_of(problem, first) == alone, f"shared: {shared}"
        assert all_of(other, second) != alone, f"shared: {shared}"


def solved(problem: Problem) -> tuple[Problem, CycleSolution]:
    return problem, solve(problem, lease_for(problem)).cycle


def test_one_cycle_is_read_in_threads_as_alone():
    problem, cycle = solved(problem_of(make(REAL)))
    alone = all_of(problem, cycle)
    with ThreadPoolExecutor(THREADS) as pool:
        assert all(found == alone for found in pool.map(lambda _: all_of(problem, cycle), range(EACH)))


def test_what_is_solved_cannot_be_written_into():
    problem, cycle = solved(problem_of(make({})))
    life = cycle.trajectory
    for array in (problem.composition.P, life.composition.P, life.R, life.times, life.dense, life.quads):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


def test_an_interrupted_solution_keeps_its_arrays_from_the_next():
    """Whatever it left half written is in nobody's hands."""

    class Stop(BaseException):
        pass

    def stop() -> None:
        raise Stop

    problem = problem_of(make({}))
    machinery = lease_for(problem)
    machinery.watch = stop
    with pytest.raises(Stop):
        close(ClosingTask(problem, machinery, problem.criteria))
    assert lease_for(problem) is not machinery


def test_threads_ask_coolprop_one_after_the_other(monkeypatch):
    """Its state is set and then read; two that ask at once must not read each other's."""
    fluids, pressures = ("R134a", "Propane", "Ammonia", "Water"), np.linspace(2e5, 2e6, 40).tolist()
    asked = [(fluid, p) for p in pressures for fluid in fluids]
    monkeypatch.setattr(constants, "append_line", lambda *_: None)  # nothing of it is kept
    monkeypatch.setattr(constants, "_stored_lines", dict)  # nor was

    def ask(pair: tuple[str, float]) -> tuple[float, float]:
        fluid, p = pair
        T = constants.saturation_temperature(fluid, p)
        return T, constants.saturated_liquid_enthalpy(fluid, T)

    constants._known.clear()
    alone = [ask(pair) for pair in asked]
    constants._known.clear()
    with ThreadPoolExecutor(THREADS) as pool:
        assert list(pool.map(ask, asked)) == alone
