"""What flows back of the discharge line makes the next outflow warmer by its share: what that comes to is known."""

from dataclasses import replace

import numpy as np
import pytest
from folders import POINT
from fuzz_courses import KINDS, course
from scenes import CARRIED, make

from screwsim.cycle.backflow import LARGEST_CHANGE, LARGEST_SHARE, NO_FEEDBACK, backflow_feedback
from screwsim.cycle.balances import streams_of
from screwsim.cycle.feedback import unknowns
from screwsim.cycle.guess import install_first_guess, lease_for
from screwsim.cycle.problem import ClosingTask, problem_of
from screwsim.cycle.relaxation import _Turns, relax
from screwsim.cycle.solution import Start
from screwsim.figures.errors import relative_errors, worst
from screwsim.model import leases
from screwsim.scene import load
from screwsim.simulate import simulate, simulate_many

OUT = np.array([1e-3, 3e-3])  # gas and oil that flow out in a life [kg]


def life(problem, share):
    """Return the quadratures of a life of which that share of the outflow had flowed back."""
    machinery = lease_for(problem)
    q = np.zeros(machinery.nq)
    leases.give_back(machinery)
    columns = [0, 2] if problem.composition.carried else [0]
    streams_of(problem.composition, q)[2:4, columns] = np.array([share * OUT, -OUT])[:, : len(columns)]
    return q


def line(problem, T):
    """Return a discharge line of gas and oil at a temperature [K]."""
    return np.array([problem.parts.gas.c_p * T, 3.0, T])


@pytest.mark.parametrize("share", [0.1, 0.3, 0.49])
def test_a_mixture_of_what_flows_back_and_what_is_fresh_is_led_to_the_fresh(share):
    """In the steady cycle what flows back is as warm as what flows out, and so both are as warm as what is fresh."""
    problem = problem_of(make(CARRIED))
    met, fresh = 300.0, 315.0
    made = share * met + (1.0 - share) * fresh
    found = backflow_feedback(problem, life(problem, share), line(problem, met), line(problem, made))
    assert found.share == pytest.approx(share)
    led = found.extrapolated(line(problem, made))
    assert led == pytest.approx(line(problem, fresh), rel=1e-12)


def test_gas_and_oil_of_different_temperatures_flow_back_as_their_mixture():
    problem, share = problem_of(make(CARRIED)), 0.2
    gas, oil = OUT * (problem.parts.gas.c_p, problem.parts.oil.heat_capacity)
    met, made = line(problem, 300.0), line(problem, 300.0)
    made[2] = 310.0
    found = backflow_feedback(problem, life(problem, share), met, made)
    mixed = 10.0 * oil / (gas + oil)
    assert found.temperature == pytest.approx(share / (1.0 - share) * mixed)
    assert found.enthalpy == pytest.approx(problem.parts.gas.c_p * found.temperature)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {**CARRIED, "operation.discharge": {"pressure": "4 bar", "temperature": "350 K"}},
        {**CARRIED, "gas.model": "real", "gas.two_phase": "equilibrium"},
    ],
)
def test_heat_that_droplets_a_given_temperature_or_drops_that_condense_take_does_not_come_back(changes):
    problem = problem_of(make(changes))
    assert backflow_feedback(problem, life(problem, 0.2), line(problem, 300.0), line(problem, 310.0)) is NO_FEEDBACK


def test_no_more_is_believed_than_half_and_no_change_that_is_far():
    problem = problem_of(make(CARRIED))
    met, far = line(problem, 300.0), line(problem, 300.0 * (1.0 + 2.0 * LARGEST_CHANGE))
    assert backflow_feedback(problem, life(problem, 0.9), met, met).share == LARGEST_SHARE
    found = backflow_feedback(problem, life(problem, 0.5), met, far)
    assert found.share == pytest.approx(0.5) and found.extrapolated(far) is far
    for share in (0.0, 1.0):  # nothing flows back; or all, and then anything is as steady
        assert backflow_feedback(problem, life(problem, share), met, far) is NO_FEEDBACK


def test_of_a_trace_of_oil_nothing_is_foretold():
    """How much of it flows back, and for how long, is not known; a guess's seems to have left with the heat."""
    problem = problem_of(make(CARRIED))
    q = life(problem, 0.2)
    streams_of(problem.composition, q)[:, 2] *= 1e-3
    assert backflow_feedback(problem, q, line(problem, 300.0), line(problem, 310.0)) is NO_FEEDBACK


@pytest.mark.parametrize("rpm", [1000, 6000])
def test_the_line_is_led_nearer_to_that_of_the_closed_cycle(rpm):
    """Of the first turn, whose oil comes back as cold as it was supplied: that is what is guessed."""
    problem = problem_of(load(POINT, ["oil.transport=carried", f"operation.speed={rpm} rpm"]))
    machinery = lease_for(problem)
    turns = _Turns(ClosingTask(problem, machinery, problem.criteria), Start(install_first_guess(problem, machinery)))
    assert turns.integrate() is None
    assert turns.correction() is None
    unknowns_out, led = turns.unknowns_out, turns.returning.extrapolated(turns.unknowns_out)
    turns.go_on(None)
    cycle = relax(ClosingTask(problem, machinery, problem.criteria), Start(turns.y), last=True)
    assert cycle.status == "ok"
    steady = unknowns(problem, machinery)
    leases.give_back(machinery)
    assert np.all(np.abs(led - steady)[[0, 2]] < 0.6 * np.abs(unknowns_out - steady)[[0, 2]])


def test_a_fast_machine_with_carried_oil_closes_in_three_turns():
    """Only the heat of the line comes back there, by a fifth a turn: it took five."""
    problem = problem_of(load(POINT, ["oil.transport=carried", "operation.speed=6000 rpm"]))
    machinery = lease_for(problem)
    cycle = relax(
        ClosingTask(problem, machinery, problem.criteria), Start(install_first_guess(problem, machinery)), last=True
    )
    leases.give_back(machinery)
    assert cycle.status == "ok" and cycle.turns == 3


def test_what_a_correction_missed_of_the_line_the_next_is_taken_to_miss_as_well():
    """A sweep whose points lie far apart: tangents of a guess's turn miss a tenth of what comes back of the line."""
    scenes = course(KINDS["rotors"], 6, 27)[23:]
    finer = replace(scenes[-1].numerics, accuracy=scenes[-1].numerics.accuracy / 20, error="none")
    exact = simulate(replace(scenes[-1], numerics=finer), trace=False)
    *_, found = simulate_many(scenes, trace=False)
    assert found.numerics.closing == exact.numerics.closing == "histories"
    assert worst(relative_errors(found.performance, exact.performance))[1] < 0.6 * scenes[-1].numerics.accuracy
