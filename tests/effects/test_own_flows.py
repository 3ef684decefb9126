"""A new kind of flow takes two files: its law, and the effect that uses it; everything else follows from them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from known_figures import known_solution
from own_flows import viscous

import screwsim
from screwsim.build import build_parts
from screwsim.effects.base import ChamberState
from screwsim.model.compose import compose
from screwsim.numerics.kernel import kernel

CONFIGS = Path(__file__).parents[2] / "configs"
SLOT = "effects={own_flows.slot: {height: 60 um}}"


@pytest.fixture(scope="module")
def of_closings():
    found = {}

    def solved(closing, *changes):
        key = closing, *changes
        if key not in found:
            found[key] = screwsim.simulate(closed_by(closing, *changes))
        return found[key]

    return solved


def closed_by(closing, *changes):
    wanted = [f"numerics.closing={closing}", "numerics.accuracy=1e-5", SLOT, *changes]
    return screwsim.load(CONFIGS / "paper" / "point.yaml", wanted)


def test_the_flow_through_a_slot_is_that_of_its_law(of_closings):
    result = of_closings("histories", "numerics.accuracy=2e-6")  # its traces are slopes of the states
    assert result.status == "ok"
    cycle = result.cycle
    p, rho = cycle["pressure"], cycle["gas_mass"] / cycle["volume"]
    line = result.performance.suction_pressure, rho[len(p) // 8]  # of a chamber that is wide open to it
    closed = cycle["mass_flow_suction_port"] == 0.0
    flux = viscous.slot_flux(p, rho, *line, 60e-6, 20e-3, 2e-5) * 60e-6 * 0.1
    found = cycle["mass_flow_own_flows.slot"]
    assert np.count_nonzero(closed) > 100 and np.max(np.abs(found[closed])) > 0.01
    np.testing.assert_allclose(found[closed], flux[closed], rtol=2e-3, atol=1e-4 * np.max(np.abs(found)))


def test_its_balances_close_and_its_entropy_is_generated(of_closings):
    for closing in ("histories", "coupled"):
        result = of_closings(closing)
        assert max(result.balance.mass, result.balance.energy, result.balance.entropy) < 1e-5
        assert result.ledger["entropy_generated_own_flows.slot"] > 0.0


@pytest.mark.parametrize("figure", ["volumetric_efficiency", "isothermal_efficiency", "indicated_power"])
def test_both_closings_and_radau_agree_on_it(of_closings, figure):
    alone = of_closings("histories").performance[figure]
    assert of_closings("coupled").performance[figure] == pytest.approx(alone, rel=3e-5)
    radau = known_solution(closed_by("coupled", "numerics.integrator=scipy-radau")).performance[figure]
    assert radau == pytest.approx(alone, rel=3e-5)


@kernel
def standing(phi):
    """Return the rate of a state that never changes."""
    return 0.0


@pytest.mark.parametrize(("name", "closing"), [("V", "one"), ("flow", "one"), ("q_crossing", "all")])
def test_a_state_that_is_called_as_a_variable_of_the_text_is_refused(name, closing):
    parts = build_parts(screwsim.load(CONFIGS / "paper" / "point.yaml"))
    named = replace(parts, effects={**parts.effects, "mine": [ChamberState(name, standing, {})]})
    with pytest.raises(TypeError, match=f"a state cannot be called {name}"):
        compose(named).together() if closing == "all" else compose(named)
