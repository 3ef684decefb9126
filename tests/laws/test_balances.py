"""Whole solutions: balances, both closings, convergence with accuracy, an independent integrator, repeatability."""

import numpy as np
import pytest
from each_row import each_row
from known_figures import known_solution
from scenes import RADAU, SPEEDS, change, closed, make, run

from screwsim.cycle.close import close
from screwsim.cycle.problem import ClosingTask, problem_of
from screwsim.evaluate.evaluation import evaluate
from screwsim.evaluate.traces import traces
from screwsim.model import leases
from screwsim.model.run import Machinery
from screwsim.simulate import simulate

SEEN = (
    "gas_mass_flow",
    "work_per_cycle",
    "trapped_mass",
    "shaft_power",
    "isothermal_efficiency",
    "discharge_temperature",
)


def asked(speed, transport="paper", **numerics):
    return {"operation.speed": f"{speed} rpm", "oil.transport": transport, "numerics": numerics}


def at(speed, transport="paper", **numerics):
    return run(asked(speed, transport, **numerics))


CASES = [(speed, transport) for transport in ("paper", "carried") for speed in SPEEDS]


@pytest.mark.parametrize(("speed", "transport"), CASES)
def test_the_cycle_closes(speed, transport):
    assert at(speed, transport).status == "ok"


@each_row("kind", ["mass", "energy"])
@each_row(("speed", "transport"), CASES)
def test_what_enters_leaves(speed, transport, kind):
    result = at(speed, transport)
    assert result.status != "ok" or result.balance[kind] <= result.balance.bound  # the contract of status ok


@each_row("speed", SPEEDS)
def test_carried_oil_that_enters_leaves(speed):
    result = at(speed, "carried")
    assert result.status != "ok" or result.balance.oil_mass <= 10 * result.balance.bound  # not part of the bound itself


@pytest.mark.parametrize("transport", ["paper", "carried"])
@pytest.mark.parametrize("speed", [3000, 1000])
def test_both_closings_find_one_cycle(speed, transport):
    one, other = (at(speed, transport, closing=way, error="none") for way in ("histories", "coupled"))
    assert change(one, other, ("work_per_cycle", "trapped_mass", "gas_mass_flow")) < 3e-4  # numerics.accuracy


ACCURACIES = (3e-3, 3e-4, 3e-5)


def errors(names=SEEN):
    """Return the largest error of the figures at three accuracies, against a reference at 1e-7."""
    reference = at(3000, accuracy=1e-7)
    return [change(at(3000, accuracy=a), reference, names) for a in ACCURACIES]


def test_figures_converge_with_accuracy():
    found = errors()
    assert found[0] > found[1] > found[2]


@pytest.mark.parametrize("index", range(3))
def test_figures_are_as_accurate_as_asked(index):
    assert errors()[index] < ACCURACIES[index]  # what numerics.accuracy promises


def test_peak_pressure_is_as_accurate_as_asked():
    assert errors(("peak_pressure",))[2] < ACCURACIES[2]


@pytest.fixture(scope="module")
def radau():
    """Return the cycle that scipy's implicit Runge–Kutta method closes; it shares nothing with ours but the rates."""
    return known_solution(make(asked(3000, accuracy=1e-7, rtol=1e-10, **RADAU)))


@pytest.mark.slow
def test_radau_finds_the_cycle_of_the_default_accuracy(radau):
    assert change(at(3000), radau, SEEN) < 3e-4  # the default accuracy


@pytest.mark.slow
def test_radau_finds_the_cycle_of_a_tight_accuracy(radau):
    assert change(at(3000, accuracy=1e-7), radau, SEEN) < 1e-6  # ten times ours: closing and steps


def test_gas_between_chambers_cancels():
    """Coupled chambers: what leaves one enters another, so the sum over all is rounding."""
    between, moved = exchanged("paper")
    assert abs(between[0]) < 1e-13 * moved


def exchanged(transport):
    """Return the summed streams between chambers of a coupled solution [kg, J, …] and the mass moved [kg] in a life."""
    scene = make({"operation.speed": "1000 rpm", "oil.transport": transport, "numerics": {"closing": "coupled"}})
    problem, _, cycle = closed(scene)
    of = evaluate(problem, cycle)
    flows = [trace for name, trace in traces(of).items() if name.startswith("mass_flow_") and "port" not in name]
    life = problem.parts.geometry.life / problem.parts.omega
    return of.streams[4], float(np.mean(np.abs(flows).sum(axis=0))) * life


def test_energy_between_chambers_cancels():
    between, moved = exchanged("paper")
    assert abs(between[1]) < 1e-13 * moved * 3e5  # enthalpies are about 3e5 J/kg


def test_carried_oil_between_chambers_cancels():
    between, moved = exchanged("carried")
    assert abs(between[2]) < 1e-13 * moved * 3  # ratios are about 3


def equal(one, other):
    """Assert that two results agree bit for bit, times apart."""
    assert one.performance == other.performance
    assert one.balance == other.balance
    for name in one.cycle:
        np.testing.assert_array_equal(one.cycle[name], other.cycle[name])
    times = {"wall_time": 0, "estimating_time": 0}
    assert one.numerics | times == other.numerics | times
    assert one.error == other.error


OTHER_ANGLES = {
    "machine.volume.phi_A": "90 deg",
    "machine.suction_port.phi_B": "100 deg",
    "machine.discharge_port.opens": "570 deg",
    "machine.discharge_port.phi_C": "600 deg",
    "operation.speed": "1500 rpm",
    "operation.discharge.pressure": "9 bar",
}


@pytest.mark.parametrize("transport", ["paper", "carried"])
@pytest.mark.parametrize("way", ["histories", "coupled"])
def test_a_scene_simulated_again_gives_the_same_bits(way, transport):
    scene = make({"numerics": {"closing": way}, "oil.transport": transport})
    simulate(scene)  # whatever has to be compiled
    equal(simulate(scene), simulate(scene))


@pytest.mark.parametrize("transport", ["paper", "carried"])
@pytest.mark.parametrize("way", ["histories", "coupled"])
def test_a_scene_leaves_nothing_behind_for_the_next(way, transport):
    """Sweeps reuse the arrays of a composition: another scene in between must not be seen."""
    ours = make({"numerics": {"closing": way}, "oil.transport": transport})
    other = make({"numerics": {"closing": way}, "oil.transport": transport, **OTHER_ANGLES})
    simulate(ours)
    first = simulate(ours)
    between = simulate(other)
    assert between.performance.shaft_power != first.performance.shaft_power
    equal(first, simulate(ours))
    equal(between, simulate(other))


@pytest.mark.parametrize("way", ["histories", "coupled"])
def test_every_scene_is_solved_as_if_it_were_the_first(way):
    numerics = {"closing": way, "error": "none"}  # an estimate may close again
    ours, other = (make({"numerics": numerics, **changes}) for changes in ({}, OTHER_ANGLES))
    simulate(ours)
    after = simulate(other)
    problem = problem_of(other)
    lent, fresh = leases.lease(problem.composition), Machinery(problem.composition)
    assert lent.lives.last()[0].any() and not fresh.lives.last()[0].any()  # the first has been used before
    found = evaluate(problem, close(ClosingTask(problem, fresh, problem.criteria))).figures
    assert found == after.performance
