"""A Roots blower, a machine in one module that is no part of the package: nothing but back-flow compresses its gas.

The law: while the volume is constant no work is done, and beside wide ports the chamber fills at p_s and is pushed out
at p_d. So −∮ p dV = p_d ∫dV − p_s ∫dV = (p_d − p_s) ΔV with ΔV = V_max − V_min: V_min stays in the mesh, and what is
left in it at p_d expands where dV = 0. The power is that times the 2z pockets of a turn, and what leaks does not act
on it. The isentropic work of what is delivered, λ ρ_s ΔV k/(k − 1) R T_s (π^((k−1)/k) − 1), over it is the efficiency.
"""

import math
from itertools import pairwise

import pytest
from blowers import GAPS, P_D, P_S, POCKET, blower

from screwsim import simulate
from screwsim.explain import explain

LAW = (P_D - P_S) * POCKET


def missed(area, accuracy=3e-4, **others):
    """Return by how much of the law the work of a pocket is beyond it."""
    result = simulate(blower(area, accuracy=accuracy, **others))
    assert result.status == "ok"
    return result.performance.work_per_cycle / LAW - 1.0


@pytest.fixture(scope="module")
def leaky():
    return {lobes: simulate(blower(effects=GAPS, lobes=lobes)) for lobes in (2, 3)}


def test_the_work_of_a_pocket_tends_to_its_displacement_at_the_pressure_rise_as_ports_get_wider():
    over = [missed(area, accuracy=1e-5) for area in (30.0, 60.0, 120.0)]
    assert over[0] > over[1] > over[2] > 0.0
    # what a port throttles is as its flow's square over its area's: a quarter each
    assert [wide / narrow for narrow, wide in pairwise(over)] == pytest.approx([0.25, 0.25], rel=0.1)
    assert missed(6000.0, accuracy=1e-6) == pytest.approx(0.0, abs=1e-5)  # ports a hundred times as wide


def test_the_power_is_that_of_all_pockets_of_a_turn():
    result = simulate(blower())
    assert result.performance.indicated_power == pytest.approx(6 * 25.0 * LAW, rel=3e-4)  # the accuracy
    assert result.performance.displacement == pytest.approx(6 * POCKET, rel=1e-12)
    k, ratio = 1.4, P_D / P_S
    ideal = k / (k - 1.0) * (ratio ** ((k - 1.0) / k) - 1.0) / (ratio - 1.0)
    eta = result.performance.isentropic_efficiency / result.performance.volumetric_efficiency
    assert eta == pytest.approx(ideal, rel=3e-4)


@pytest.mark.parametrize("lobes", [2, 3])
def test_it_closes_its_balances_and_its_ledger(leaky, lobes):
    result = leaky[lobes]
    told = [warning for warning in result.warnings if "leaves with gas flowing back" in warning]
    assert result.status == "ok" and len(result.warnings) == len(told) == {2: 1, 3: 0}[lobes]
    for name in ("mass", "energy", "entropy"):
        assert abs(result.balance[name]) < result.balance.bound
    assert abs(result.ledger.relative_residue) < 1e-3  # as of the shipped scenes
    assert all(result.ledger[f"entropy_generated_{name}"] > 0.0 for name in GAPS)


@pytest.mark.parametrize("lobes", [2, 3])
def test_leaks_cost_gas_and_no_work(leaky, lobes):
    found = leaky[lobes].performance
    assert found.work_per_cycle == pytest.approx(LAW, rel=3e-4)
    assert found.volumetric_efficiency < 0.8
    less = {name: {"gap": f"{float(parameters['gap'].split()[0]) / 2} mm"} for name, parameters in GAPS.items()}
    half = simulate(blower(effects=less, lobes=lobes)).performance
    tight = simulate(blower(lobes=lobes)).performance
    lost = [tight.gas_mass_flow - each.gas_mass_flow for each in (half, found)]
    assert lost[1] / lost[0] == pytest.approx(2.0, rel=0.1)  # the gas that leaks is the hotter the more of it does


def test_it_is_explained_by_what_it_is_and_what_it_can_have():
    found = explain(blower(effects=GAPS))
    assert not {"blow_hole", "oil_heat", "slide_valve", "check_valves"} & {*found.left_out}
    assert {"plenums", "bypass", "motor", "drive"} <= {*found.left_out}
    text = " ".join(str(found).split())
    assert "kind own_machines.roots_blower, compressor" in text
    assert f"{math.degrees(math.pi / 3.0):g} deg apart" in text


def test_other_effects_that_need_no_screws_act_on_it():
    result = simulate(blower(effects={"plenums": {"discharge_volume": "5 l", "discharge_area": "30 cm^2"}}))
    assert result.status == "ok"
    assert result.performance.discharge_pulsation_peak_to_peak > 0.0
