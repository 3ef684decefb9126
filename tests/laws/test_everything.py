"""All effects that can be on together: they converge, close, and keep the signs of what each of them does."""

import math
from pathlib import Path

import pytest
from scenes import balanced

from screwsim.effects import catalogue
from screwsim.machine.kinds import MACHINES
from screwsim.scene import load, with_values
from screwsim.simulate import simulate, simulate_many
from screwsim.study.uncertainty.point import sensitivities

SCENE = Path(__file__).parents[2] / "configs" / "everything.yaml"
LEFT_OUT = {"oil_heat"}  # droplets take its place


def test_only_what_cannot_be_on_is_left_out():
    of_screws = {name for name, effect in catalogue().items() if effect.fits(MACHINES["twin_screw"])}
    assert of_screws - set(load(SCENE).effects) == LEFT_OUT


@pytest.mark.slow
def test_all_together_close():
    result = balanced(simulate(load(SCENE)), "oil_mass")
    assert not result.warnings
    for name in ("economizer_mass_flow", "liquid_injection_mass_flow", "flash_mass_flow"):
        assert result.performance[name] > 0.0
    destroyed = {name: value for name, value in result.ledger.items() if name.startswith("exergy_destroyed_")}
    # the suction line may be a sink of cold that costs nothing (M54)
    negative = {name for name, value in destroyed.items() if value < -1e-6 * result.ledger.shaft_power}
    assert negative <= {"exergy_destroyed_suction_line"}


@pytest.mark.slow
def test_near_points_close_in_a_turn_or_two_and_give_what_each_gives_alone():
    scene = load(SCENE)
    course = [with_values(scene, {"operation.speed": scene.operation.speed * (1.0 + 0.003 * i)}) for i in range(8)]
    found = list(simulate_many(course, trace=False))
    assert [result.status for result in found] == ["ok"] * len(course)
    assert all(result.numerics.turns <= 2 for result in found[1:]) and found[-1].numerics.turns == 1
    alone = simulate(course[-1], trace=False)
    later = [result.numerics.rhs_evaluations for result in found[1:]]
    assert sum(later) < 0.6 * len(later) * alone.numerics.rhs_evaluations
    alone = alone.performance
    for name in ("gas_mass_flow", "shaft_power", "rotor_temperature", "mean_speed"):
        assert found[-1].performance[name] == pytest.approx(alone[name], rel=scene.numerics.accuracy), name


@pytest.mark.parametrize("method", ["quick", pytest.param("exact", marks=pytest.mark.around)])
def test_every_figure_of_all_together_has_a_derivative_of_the_closed_cycle(method):
    """But for a drive, whose speed is found, and for what is left of the circuit's residual."""
    gap = "effects.tip_leakage.gap"
    found = sensitivities(load(SCENE, ["effects.drive=off"]), [gap], fine=method == "exact")
    with_value = {name for name, value in found.result.performance.items() if value is not None}
    assert found.method == {gap: method}
    assert with_value - set(found.derivatives) == {"oil_circuit_residual"}
    assert all(math.isfinite(each[gap]) for each in found.derivatives.values())


@pytest.mark.slow
def test_throttle_and_bypass_destroy_what_they_do_beside_other_plenums():
    """Of their own: y ṁ (ψ_d − ψ_m) and ṁ (ψ_m − ψ_s′), whatever an economizer adds behind the suction port."""
    alone = ["economizer", "liquid_injection", "refrigerant_solubility"]
    with_it, without = (simulate(load(SCENE, without=names)).ledger for names in ([], alone))
    for name in ("bypass", "suction_throttle"):
        per_gas = [book[f"exergy_destroyed_{name}"] / book[f"gas_moved_{name}"] for book in (with_it, without)]
        assert per_gas[0] == pytest.approx(per_gas[1], rel=0.35)
        assert per_gas[0] > 0.0
