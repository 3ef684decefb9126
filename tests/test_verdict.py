"""What may help follows from which limit a gas's equation has met, whatever the gas's words for it are."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from each_row import each_row

from screwsim.cycle.problem import Problem, problem_of
from screwsim.evaluate.verdict import failure, outside_gas_range, remedy_for
from screwsim.fluid.limits import Limit, Outside
from screwsim.fluid.saturation import saturation
from screwsim.scene import load, with_values
from screwsim.simulate import simulate

CONFIGS = Path(__file__).parents[1] / "configs"


def outside(scene: str, limit: Limit, what: str) -> Problem:
    """Return the problem of a scene whose gas is outside a limit, whatever its state."""
    problem = problem_of(load(CONFIGS / scene))
    gas = SimpleNamespace(first_outside=lambda T, rho: 0, why_outside=lambda T, rho: Outside(limit, what))
    return replace(problem, parts=replace(problem.parts, gas=gas))


@each_row("limit", Limit)
def test_each_limit_has_its_remedy_even_where_the_words_name_another(limit):
    words = "the highest and the lowest of it"
    life = SimpleNamespace(times=np.radians([0.0, 90.0]), ends=(np.ones(1), np.ones(1)))
    problem = outside("paper/point.yaml", limit, words)
    assert outside_gas_range(problem, life) == f"at 90.00 deg {words}; {remedy_for(limit, problem)}"


@pytest.mark.parametrize(
    ("scene", "remedy"),
    [
        (
            "paper/point.yaml",
            "use more or cooler oil, a wider discharge port, a larger machine.volume.min or smaller leaks",
        ),
        ("expander/point.yaml", "use cooler gas in the suction line, or a lower pressure there"),
        (
            "slider_crank/air.yaml",
            "use cooler gas in the suction line, a wider discharge port, a larger machine.clearance or smaller leaks",
        ),
    ],
)
def test_what_cools_is_of_what_the_machine_has(scene, remedy):
    assert {remedy_for(limit, outside(scene, limit, "")) for limit in (Limit.HOT, Limit.PRESSED)} == {remedy}


def test_gas_that_an_expander_does_not_let_out_is_told_from_gas_that_comes_hot():
    """The chamber ends its life hotter than the gas came: the outlet is too narrow, whatever comes."""
    problem, told = outside("expander/point.yaml", Limit.HOT, "hot"), {}
    for end in (0.9, 1.1):
        ends = np.full(2, end * problem.lines.T_s), np.ones(2)
        told[end] = outside_gas_range(problem, SimpleNamespace(times=np.radians([0.0, 9.0, 720.0]), ends=ends))
    assert told[0.9] == f"at 9.00 deg hot; {remedy_for(Limit.HOT, problem)}"
    assert "use a wider machine.suction_port" in told[1.1] and "cooler" not in told[1.1]


def test_a_guess_that_went_astray_is_no_state_of_the_gas():
    """A plenum that lets nothing through drove pressures to 1e28 kg/m³, told as a state to check clearances for."""
    problem = problem_of(load(CONFIGS / "paper" / "point.yaml"))
    life = SimpleNamespace(times=np.zeros(2), ends=(np.ones(1), np.ones(1)), R=np.zeros(99))
    stopped = SimpleNamespace(y=np.array([700.0, 3e28, 600.0]), angle=0.0, impacts=0, trajectory=life)
    found = failure(problem, stopped)
    assert "diverged, to a density of 3.0e+28 kg/m3" in found and "clearances" not in found


@pytest.mark.parametrize(
    ("scene", "remedy"),
    [
        (
            "paper/point.yaml",
            "use a wider discharge port, a larger machine.volume.min, a lower discharge pressure or warmer oil",
        ),
        (
            "slider_crank/air.yaml",
            "use a wider discharge port, a larger machine.clearance, a lower discharge pressure or warmer suction gas",
        ),
    ],
)
def test_what_keeps_from_the_critical_point_is_of_what_the_machine_has(scene, remedy):
    assert remedy_for(Limit.CRITICAL, outside(scene, Limit.CRITICAL, "")) == remedy


@pytest.mark.parametrize(
    ("scene", "wet", "cold", "blend"),
    [
        ("paper/point.yaml", "warmer oil or gas", "warmer suction gas or oil", ""),
        ("slider_crank/air.yaml", "warmer gas in the suction line", "warmer suction gas", "Air.mix"),
    ],
)
def test_what_keeps_from_condensing_and_cold_is_of_what_the_machine_has(scene, wet, cold, blend):
    told = {limit: remedy_for(limit, outside(scene, limit, "")) for limit in (Limit.WET, Limit.GLIDING, Limit.COLD)}
    assert told[Limit.WET] == f"use {wet}, or gas.two_phase: equilibrium"
    known = f", or gas.fluid: {blend} with gas.two_phase: equilibrium" if blend else ""
    assert told[Limit.GLIDING] == f"use {wet}{known}" and told[Limit.COLD] == f"use {cold}, or a wider suction port"


def test_a_pseudo_pure_fluid_that_condenses_is_offered_the_blend_whose_phases_are_followed():
    """What expands out of the dead volume of a screw from -40 to 40 °C gets wet, whatever the oil."""
    problem = outside("paper/point.yaml", Limit.GLIDING, "")
    scene = with_values(problem.scene, {"gas.fluid": "R410A", "gas.model": "real"})
    told = remedy_for(Limit.GLIDING, replace(problem, scene=scene))
    assert told == "use warmer oil or gas, or gas.fluid: R410A.mix with gas.two_phase: equilibrium"


def test_a_machine_that_all_but_stands_is_told_so():
    """Its areas and tolerances are in order: gas is at rest long before it turns."""
    result = simulate(load(CONFIGS / "paper" / "point.yaml", ["operation.speed=1e-9 rpm"]), trace=False)
    assert result.status == "failed"
    assert "almost stands still: a turn takes 6.94e+05 days" in result.message
    assert "port areas" not in result.message


def test_an_integration_that_stops_at_the_critical_point_says_so():
    """The heat capacity of both phases has no bound there: an expander from 50.4 bar and 165 °C came upon it."""
    states = {"gas.fluid": "R245fa", "gas.model": "real", "gas.two_phase": "equilibrium"}
    states |= {"operation.suction.temperature": "140 degC"}
    problem = problem_of(load(CONFIGS / "expander/point.yaml").with_(states))
    T, rho = saturation("R245fa").T_c, saturation("R245fa").rho_c
    y = np.array([T, rho, *[0.0] * (len(problem.composition.states) - 2)])
    cycle = SimpleNamespace(y=y, angle=np.radians(71.07), impacts=0, trajectory=SimpleNamespace(R=None))
    told = failure(problem, cycle)
    assert told.startswith("the integration stopped at 71.07 deg, at the critical point of R245fa (153.86 degC")
    assert "temperature or pressure at the inlet" in told
