"""A scene solved alone is nothing to the next: what was built for one gives the bits that building anew does."""

import pytest
from folders import CONFIGS, ROOT
from scenes import make
from test_closed_chamber import NO_EFFECTS

from screwsim.cycle import problem
from screwsim.scene import load
from screwsim.simulate import simulate

POINT = str(CONFIGS / "paper" / "point.yaml")
REAL = str(ROOT / "tests" / "plain" / "r134a.yaml")
OTHERS = {  # beside the paper's point, of which they share more or less
    "speed": (POINT, ["operation.speed=2000 rpm"]),
    "oil": (POINT, ["oil_supply.ratio=1.5"]),
    "effect": (POINT, ["effects.tip_leakage.gap=0.1 mm"]),
    "machine": (POINT, ["machine.rotor_diameter=150 mm"]),
    "volume": (POINT, ["machine.volume.min=2e-6 m^3"]),
    "gas": (REAL, []),
}


def told(result):
    """Return all that a result says but times."""
    numerics = {name: value for name, value in result.numerics.items() if "time" not in name}
    return result.status, result.message, result.warnings, numerics, *map(dict, (result.performance, result.balance))


@pytest.fixture(scope="module")
def anew():
    """Results, each of a scene for which all is built anew."""
    found = {}
    for name, (path, changes) in {"point": (POINT, []), **OTHERS}.items():
        problem._free.clear()
        found[name] = told(simulate(load(path, changes), trace=False))
    return found


def test_scenes_alone_are_those_of_scenes_built_anew(anew):
    point = load(POINT)
    for name, (path, changes) in OTHERS.items():
        assert told(simulate(point, trace=False)) == anew["point"]
        assert told(simulate(load(path, changes), trace=False)) == anew[name]


def test_what_was_built_is_taken_over_and_given_back():
    problem._free.clear()
    point = load(POINT)
    simulate(point, trace=False)
    (before,) = problem._free
    simulate(point, trace=False)
    (after,) = problem._free
    assert after[0] is before[0] and after[1] is before[1]


def test_scenes_that_differ_give_different_figures(anew):
    figures = [result[-2]["shaft_power"] for result in anew.values()]
    assert len(set(figures)) == len(figures)


def test_a_machine_without_effects_takes_none_of_the_one_before():
    simulate(load(POINT), trace=False)
    taken_over = told(simulate(make(NO_EFFECTS), trace=False))
    problem._free.clear()
    assert told(simulate(make(NO_EFFECTS), trace=False)) == taken_over


def test_a_drive_moves_as_it_does_at_first():
    """The motion under a torque is found from that alone, not from one of before."""
    problem._free.clear()
    scene = load(CONFIGS / "everything.yaml", ["numerics.closing=histories"])
    first, again = (told(simulate(scene, trace=False)) for _ in range(2))
    assert again == first
