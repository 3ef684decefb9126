"""Another estimate of the errors is one function and one entry: what is asked of errors is asked of finer solutions."""

from dataclasses import fields, replace

import pytest
from scenes import make

from screwsim.cycle.close import close
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import ClosingTask
from screwsim.evaluate.evaluation import evaluate
from screwsim.figures.errors import relative_errors, worst
from screwsim.inputs.declare import LEAF
from screwsim.model import leases
from screwsim.numerics.settings import ERRORS, ErrorOption, NumericsSettings
from screwsim.outputs import Figures
from screwsim.simulate import simulate
from screwsim.solve.estimate import ESTIMATES, WHOLE
from screwsim.solve.estimate_protocol import NO_SOLUTIONS, FinerSolutions
from screwsim.solve.swings import Solution, solution_of

NAME = "from afar"
TIGHTER = 0.05
ACCURACY = 3e-4  # the default


def from_afar(asked):
    """Close the cycle from the first guess with a twentieth of the tolerances, in a machinery of its own."""
    machinery = lease_for(asked.problem)
    try:
        cycle = close(ClosingTask(asked.problem, machinery, asked.criteria.tighter(TIGHTER)))
        found = solution_of(evaluate(asked.problem, cycle))
    finally:
        leases.give_back(machinery)
    return FinerSolutions([found]) if cycle.status == "ok" else NO_SOLUTIONS


@pytest.fixture
def registered(monkeypatch):
    monkeypatch.setitem(ESTIMATES, NAME, from_afar)
    monkeypatch.setitem(ERRORS, NAME, ErrorOption((NAME,), "the cycle from its first guess, with finer tolerances"))


def asking(error, **changes):
    scene = make({"operation.speed": "1500 rpm"})
    return replace(scene, numerics=replace(scene.numerics, error=error, **changes))


def test_a_scene_may_name_every_estimate_and_each_names_functions_that_are_there():
    offered = next(each for each in fields(NumericsSettings) if each.name == "error").metadata[LEAF].limits["options"]
    assert tuple(ERRORS) == offered
    assert {name for error in ERRORS.values() for name in error.by} == set(ESTIMATES)


def test_another_estimate_tells_the_errors_that_it_finds(registered):
    one, none = simulate(asking(NAME)), simulate(asking("none"))
    true = simulate(asking("none", accuracy=1e-7, closing="coupled"))
    assert one.status == "ok" and dict(one.performance) == dict(none.performance)
    told, off = worst(one.error)[1], worst(relative_errors(none.performance, true.performance))[1]
    assert off / 2.0 < told < 2.0 * WHOLE * off


def test_a_cycle_is_closed_again_where_another_estimate_finds_it_coarse(registered, monkeypatch):
    asked = []

    def coarse_at_first(of):
        asked.append(of.cycle.rtol)
        figures, curves = from_afar(of).solutions[0]
        power = figures["shaft_power"] * (1.001 if len(asked) == 1 else 1.0)
        return FinerSolutions([Solution(Figures(figures | {"shaft_power": power}), curves)])

    monkeypatch.setitem(ESTIMATES, NAME, coarse_at_first)
    result = simulate(asking(NAME))
    assert len(asked) == 2 and asked[1] < 0.5 * asked[0]
    assert result.numerics.rtol == asked[1] and worst(result.error)[1] < ACCURACY


def test_what_finds_too_little_leaves_the_word_to_the_next(registered, monkeypatch):
    asked = []

    def nothing(of):
        asked.append("nothing")
        return NO_SOLUTIONS

    monkeypatch.setitem(ESTIMATES, "nothing", nothing)
    monkeypatch.setitem(ERRORS, "both", ErrorOption(("nothing", NAME), "one that finds nothing, then another"))
    both, one = simulate(asking("both")), simulate(asking(NAME))
    assert asked and dict(both.error) == dict(one.error)
