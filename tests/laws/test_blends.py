"""Cycles of blends: what a closed chamber keeps, what a whole machine closes, which temperatures state its lines."""

import json
import re
from pathlib import Path

import closed_blends
import CoolProp.CoolProp as coolprop
import numpy as np
import pytest
from scenes import balanced, make, run

from screwsim.build import build_gas
from screwsim.cycle.close import close
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import ClosingTask, problem_of
from screwsim.explain import explain
from screwsim.fluid import constants
from screwsim.inputs.faults import SceneError
from screwsim.scene import load
from screwsim.scene.lines import lines, refrigerating_effect
from screwsim.simulate import simulate
from screwsim.study.sweep import sweep

CONFIG = Path(__file__).parents[2] / "configs" / "r454b" / "point.yaml"
DOCS = Path(__file__).parents[2] / "docs" / "reference"
STORED = json.loads((Path(__file__).parent / "closed_blends.json").read_text(encoding="utf-8"))
OWN = ["gas.fluid=[R32, R1234yf]", "gas.mass_fractions=[0.689, 0.311]"]
# dead volume of half the swept one: the chamber expands by three only, and stays within the equation's temperatures
WET = ["gas.two_phase=equilibrium"]
SHUT = {"effects": {}, "machine.volume.min": "300 cm^3", "numerics": {"accuracy": 1e-4, "rtol": 1e-10}}


def blend(fluid):
    """Return the paper's machine on a blend, 10 K above its dew point at 3 bar."""
    return {
        "gas": {"fluid": fluid, "model": "real"},
        "oil.transport": "carried",
        "oil_supply.temperature": "330 K",
        "operation.suction": {"pressure": "3 bar", "superheat": "10 K"},
        "operation.discharge": {"pressure": "11 bar"},
    }


def test_a_closed_chamber_keeps_its_entropy():
    changes = {**blend("R448A"), **SHUT}
    gas, cycle = build_gas(make(changes)), run(changes).cycle
    states = zip(cycle["gas_temperature"], cycle["gas_mass"] / cycle["volume"], strict=True)
    s = [gas.specific_entropy(T, rho) for T, rho in states]
    assert np.ptp(s) / gas.R < 1e-8  # a hundred steps of rtol 1e-10 each


def test_a_closed_chamber_keeps_its_entropy_through_two_phases():
    """From vapour into the dome and back, across the border at which the table meets the equation."""
    wet = {**blend("R454B"), **SHUT, "operation.suction": {"pressure": "9 bar", "superheat": "1 K"}}
    wet = {**wet, "gas": {"fluid": "R454B", "model": "real", "two_phase": "equilibrium"}}
    wet["operation.discharge"] = {"pressure": "12 bar"}
    gas, cycle = build_gas(make(wet)), run(wet).cycle
    states = list(zip(cycle["gas_temperature"], cycle["gas_mass"] / cycle["volume"], strict=True))
    phases = [gas.phased_state[0](T, rho) for T, rho in states]
    assert 0.1 < np.mean(phases) < 0.9
    s = [gas.specific_entropy(T, rho) for T, rho in states]
    assert np.ptp(s) / gas.R < 2e-6  # by which s jumps there: below 1e-6


def rows(page):
    """Return the cells of each row of a table of blends in docs/reference."""
    lines = (DOCS / page).read_text(encoding="utf-8").splitlines()
    return {cells[0]: cells[1:] for cells in (re.findall(r"[^|]+", line[1:]) for line in lines if line[:2] == "| ")}


def test_a_closed_chamber_of_every_blend_keeps_its_entropy():
    """As tests/tools/closed_blends.py found, dry and through its two phases, of each that docs/reference lists."""
    found = {name.strip(): cells for name, cells in rows("blends.md").items()}
    listed = {name for name, cells in found.items() if "gas from" not in " ".join(cells)} - {"blend"}  # no dew line
    followed = {name.strip(): float(cells[7]) for name, cells in rows("blend-domes.md").items() if name != " blend "}
    assert set(STORED) == listed
    for name, found in STORED.items():
        assert found["dry"]["s"] < 1e-8, name  # over R: a hundred steps of rtol 1e-10 each
        assert ("refused" in found["wet"]) == (name not in followed), name
        if name in followed:  # the jump of s where the table meets the equation, which is crossed in and out
            assert 0.0 < found["wet"]["wet"] <= 1.0 and found["wet"]["s"] < 2.0 * followed[name] + 1e-8, name


@pytest.mark.parametrize("kind", ["dry", "wet"])
def test_the_stored_change_of_entropy_is_what_comes_out(kind):
    """But for the chamber's charge, of which any is a cycle: which one comes hangs on the way of closing."""
    found = closed_blends.turn("R454B", kind)
    assert (found["wet"] > 0.0) == (STORED["R454B"][kind]["wet"] > 0.0)
    assert found["s"] == pytest.approx(STORED["R454B"][kind]["s"], abs=1e-7)  # of a hundred blends at most 9.3e-8


def test_nothing_is_asked_of_coolprop_inside_the_cycle(monkeypatch):
    problem = problem_of(load(CONFIG))
    machinery = lease_for(problem)
    close(ClosingTask(problem, machinery, problem.criteria))  # compiled

    def asked(*_args, **_kwargs):
        raise AssertionError("CoolProp was asked")

    for name in ("AbstractState", "PropsSI"):
        monkeypatch.setattr(coolprop, name, asked)
    monkeypatch.setattr(constants, "ask", asked)
    assert close(ClosingTask(problem, machinery, problem.criteria)).status == "ok"


def test_a_blends_cycle_takes_about_as_many_evaluations_as_a_pure_fluids():
    """So that a point takes less than three times R134a's: benchmarks/blends.py --points measures the times."""
    blends, pure = (simulate(load(CONFIG, overrides=[f"gas.fluid={name}"])).numerics for name in ("R454B", "R134a"))
    assert blends.rhs_evaluations < 1.5 * pure.rhs_evaluations  # found: 1.3; between other pressures


@pytest.mark.parametrize("overrides", [[], OWN], ids=["predefined", "own"])
def test_a_machine_on_a_blend_closes(overrides):
    scene = load(CONFIG, overrides=overrides)
    result = simulate(scene)
    assert result.status == "ok"
    balance, ledger = result.balance, result.ledger
    for name in ("mass", "energy", "oil_mass", "entropy"):
        assert abs(balance[name]) < balance.bound
    assert abs(ledger.relative_residue) < 1e-3  # what is promised at the default accuracy; found below 1e-4
    p = result.performance
    assert 0.0 < p.isentropic_efficiency < 1.0 and p.discharge_temperature > lines(scene).T_s


def test_a_blend_of_ones_own_is_the_predefined_one():
    own, predefined = (simulate(load(CONFIG, overrides=overrides)).performance for overrides in (OWN, []))
    for name in ("gas_mass_flow", "shaft_power", "discharge_temperature", "cop"):
        assert own[name] == pytest.approx(predefined[name], rel=1e-4)  # the default accuracy; one composition


def test_the_figures_are_as_accurate_as_asked():
    fine = simulate(load(CONFIG, overrides=["numerics.accuracy=1e-6"])).performance
    found = simulate(load(CONFIG)).performance
    for name in ("isentropic_efficiency", "gas_mass_flow", "shaft_power", "discharge_temperature"):
        assert found[name] == pytest.approx(fine[name], rel=3e-4)  # the default accuracy


def test_dew_points_state_the_lines_and_the_bubble_point_the_liquid():
    """EN 12900 and AHRI 540: both lines by dew points; subcooling from the bubble point at the discharge pressure."""
    scene = load(CONFIG, overrides=["operation.subcooling=3 K"])
    at = lines(scene)
    assert constants.saturation_temperature("R454B", at.p_s) == pytest.approx(275.15, rel=1e-10)
    assert constants.saturation_temperature("R454B", at.p_d) == pytest.approx(318.15, rel=1e-10)
    assert at.T_s == pytest.approx(285.15, rel=1e-12)
    T_liquid = constants.condensed("R454B", 318.15)
    assert 316.0 < T_liquid < 317.5  # the glide of R454B is 1 to 2 K
    h = constants.vapour_enthalpy("R454B", at.p_s, at.T_s) - constants.liquid_enthalpy("R454B", at.p_d, T_liquid - 3.0)
    assert refrigerating_effect(scene) == pytest.approx(h, rel=1e-12)
    text = " ".join(line for _, section in explain(scene).sections for line in section)
    text = " ".join(text.split())
    assert "dew point at 45 degC" in text and "bubble point" not in text and "M315" in text


def test_an_ideal_gas_may_have_a_blends_properties():
    scene = load(CONFIG, overrides=["gas.model=ideal"])
    result = simulate(scene)
    assert result.status == "ok"
    assert build_gas(scene).R == pytest.approx(constants.gas_constant("R454B"), rel=1e-15)


def test_a_cycle_that_condenses_is_refused_with_its_state():
    cold = ["oil_supply.temperature=295 K", "oil_supply.ratio=5", "effects.oil_heat.droplet_radius=10 um"]
    result = simulate(load(CONFIG, overrides=cold))
    assert result.status == "failed" and "R454B condenses at" in result.message
    assert result.message.endswith("; use warmer oil or gas, or gas.two_phase: equilibrium")
    followed = simulate(load(CONFIG, overrides=[*cold, *WET]))
    assert followed.status == "ok" and closed(followed)


def test_a_point_whose_isentrope_ends_wet_has_failed_and_ends_no_sweep():
    """Of a retrograde blend the isentrope from a little superheat ends wet; of more it does not."""
    heavy = ["gas.fluid=[Isobutane, n-Pentane]", "gas.mass_fractions=[0.5, 0.5]", "oil_supply.temperature=370 K"]
    lines_of = ["operation.evaporating_temperature=20 degC", "operation.condensing_temperature=80 degC"]
    cold = load(CONFIG, [*heavy, *lines_of, "operation.superheat=0.5 K"], ["oil_heat"])
    result = simulate(cold)
    assert result.status == "failed" and "at the end of an isentrope, is wet" in result.message
    assert result.message.endswith("; use warmer gas in the suction line, or gas.two_phase: equilibrium")
    found = sweep(cold.with_({"sweep.operation.superheat": ["40 K", "0.5 K", "30 K"]}), jobs=1)
    assert found.status.values.tolist() == [0, 2, 0]
    assert simulate(cold.with_({"gas.two_phase": "equilibrium"})).status == "ok"


def closed(result):
    return all(abs(result.balance[name]) < result.balance.bound for name in ("mass", "energy", "oil_mass", "entropy"))


def test_wet_suction_of_a_blend_closes():
    """Less capacity for more gas; the state between dew and bubble point, by mass of vapour."""
    wet = ["operation.superheat=null", "operation.suction.quality=0.9"]
    scene = load(CONFIG, overrides=[*WET, *wet])
    result, dry = simulate(scene), simulate(load(CONFIG))
    assert result.status == "ok" and closed(result) and abs(result.ledger.relative_residue) < 1e-3
    at = lines(scene)
    assert constants.condensed("R454B", 275.15) < at.T_s < 275.15
    assert result.performance.gas_mass_flow > 1.05 * dry.performance.gas_mass_flow
    assert result.performance.cop < dry.performance.cop


def test_what_is_followed_and_stays_dry_is_what_is_refused_there():
    """A machine that never condenses: the same cycle."""
    found, dry = (simulate(load(CONFIG, overrides=changes)).performance for changes in (WET, []))
    for name in ("gas_mass_flow", "shaft_power", "discharge_temperature"):
        assert found[name] == pytest.approx(dry[name], rel=1e-4)


def test_wet_suction_that_no_table_holds_is_refused():
    cold = ["operation.evaporating_temperature=-75 degC", "operation.superheat=null", "operation.suction.quality=0.9"]
    with pytest.raises(
        SceneError, match=r"R454B at .* bar has two phases from -7.* degC, and it is followed only from -69\.3"
    ):
        load(CONFIG, overrides=[*WET, *cold])


def test_an_economizer_and_liquid_close_on_a_blend():
    """A subcooler's vapour is the whole liquid evaporated, and injected liquid is that of the condenser."""
    at = "area: 2 cm^2, opens: 330 deg, closes: 365 deg"
    economizer = f"effects.economizer={{{at}, temperature: 17 degC, superheat: 5 K}}"
    injected = "effects.liquid_injection={area: 2 mm^2, opens: 400 deg, closes: 440 deg}"
    for change in (economizer, injected):
        balanced(simulate(load(CONFIG, overrides=[change])))
