"""An integrator of the user's own is one file: its coefficients are checked, and it solves what Rodas4 solves."""

from dataclasses import replace

import numpy as np
import pytest
from each_row import each_row
from folders import POINT

import screwsim
from screwsim.figures.errors import relative_errors, worst
from screwsim.inputs.faults import SceneError
from screwsim.numerics.integrators import RODAS3, RODAS4, find_integrator
from screwsim.results.schema import identity_of
from screwsim.simulate import simulate

RODASP, RADAU = "own_integrators.rodasp", "own_integrators.radau"


def scene(integrator, *others):
    return screwsim.load(POINT, overrides=[f"numerics.integrator={integrator}", *others])


@pytest.fixture(scope="module")
def paper():
    return simulate(screwsim.load(POINT), trace=False)


@pytest.mark.parametrize("name", [RODASP, RADAU])
def test_another_integrator_solves_the_papers_point_to_the_same_figures(name, paper):
    found = simulate(scene(name), trace=False)
    assert (found.status, found.numerics.integrator) == ("ok", name)
    assert (found.numerics.steps, found.numerics.jacobians) != (paper.numerics.steps, paper.numerics.jacobians)
    accuracy = screwsim.load(POINT).numerics.accuracy
    assert worst(relative_errors(paper.performance, found.performance))[1] <= 2.0 * accuracy  # each within its own
    assert bool(found.error) == (name == RODASP)  # a check estimates nothing
    assert all(size <= accuracy for size in found.error.values() if size is not None)


def test_results_know_the_module_of_an_integrator():
    assert "module own_integrators/rodasp.py" in identity_of(scene(RODASP))
    assert scene(RODASP).own == {RODASP: f"numerics.integrator: {RODASP}"}


@pytest.mark.parametrize("method", [RODAS4, RODAS3, pytest.param(RODASP, id="rodasp")])
def test_order_conditions_are_met_up_to_the_order(method):
    found = find_integrator(method) if isinstance(method, str) else method
    off = [(order, abs(is_ - should)) for order, is_, should in found.conditions()]
    assert all(size < 1e-12 for order, size in off if order <= found.order)
    assert all(size > 1e-3 for order, size in off[-1:] if order > found.order)


def bent(array, place):
    """Return an array with another value at one place."""
    array = np.array(array)
    array[place] += 1e-3
    return array


FLAWS = {
    "nodes": ({"nodes": bent(RODAS4.nodes, 2)}, "are not those of its nodes"),
    "slopes": ({"d": bent(RODAS4.d, 1)}, "are not those of its d_i"),
    "order": ({**vars(RODAS3), "order": 4}, "do not meet the conditions of order 4"),
    "weights": ({"a": bent(RODAS4.a, (5, 0))}, "are not those of its nodes"),
    "dense": ({"dense": bent(RODAS4.dense, (0, 0))}, "give no dense output of order 2"),
    "shapes": ({"d": RODAS4.d[:-1]}, "have the shapes"),
}


@each_row("name", FLAWS)
def test_coefficients_that_are_none_of_a_method_are_refused(name):
    changes, words = FLAWS[name]
    coefficients = {name: value for name, value in changes.items() if name != "couplings"}
    with pytest.raises(ValueError, match=f"its coefficients {words}"):
        replace(RODAS4, **coefficients)


MODULES = {
    "nothing": ("", "cannot be imported (module {} defines no INTEGRATOR); fix that module"),
    "wrong": (
        "from dataclasses import replace\nfrom screwsim.numerics.integrators import RODAS4\n"
        "INTEGRATOR = replace(RODAS4, d=2.0 * RODAS4.d)\n",
        "fails on import (ValueError: its coefficients are not those of its d_i); fix that module",
    ),
}


@pytest.mark.parametrize("name", MODULES)
def test_a_module_that_is_no_integrator_is_refused_in_one_line(name, tmp_path, monkeypatch):
    text, what = MODULES[name]
    (tmp_path / f"{name}_integrators").mkdir()
    (tmp_path / f"{name}_integrators" / "it.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    module = f"{name}_integrators.it"
    with pytest.raises(SceneError) as error:
        scene(module)
    assert [line.partition("numerics.integrator: ")[2] for line in error.value.lines] == [
        f"'{module}' {what.format(module)}"
    ]


def test_a_name_that_is_none_is_refused_with_those_that_are():
    with pytest.raises(SceneError, match="choose from: rodas4, scipy-radau, scipy-bdf, scipy-lsoda"):
        scene("rodas5")
