"""Where differences of cycles replace exact derivatives, their steps suit what is shifted."""

from dataclasses import replace

import pytest
from CoolProp.CoolProp import PropsSI

import screwsim
from screwsim.derivatives.solving import SceneDerivatives
from screwsim.scene import value_at, with_values
from screwsim.study.uncertainty.point import sensitivities

OUTLET, OFFSET = "operation.gas_cooler.outlet_temperature", "machine.offset"


@pytest.fixture(scope="module")
def scene(request):
    return screwsim.load(request.config.rootpath / "configs/co2/transcritical.yaml")


@pytest.fixture(autouse=True)
def none_exact(monkeypatch):
    """Let differences stand in for all derivatives."""
    none = SceneDerivatives({}, {}, "asked for")
    monkeypatch.setattr("screwsim.study.uncertainty.slopes.scene_derivatives", lambda *_: none)


def test_cooling_follows_the_gas_coolers_outlet_by_the_heat_capacity_there(scene):
    # half a percent of the temperature is 1.5 K, over which the capacity goes from 4.8 to 7.1 kJ/(kg K)
    found = sensitivities(scene, [OUTLET], ["cooling_capacity"])
    assert found.method[OUTLET] == "differences"
    flow = found.result.performance["gas_mass_flow"]
    p, T = (float(value_at(scene, path)) for path in ("operation.gas_cooler.pressure", OUTLET))
    cp = PropsSI("CPMASS", "P", p, "T", T, "CO2")
    assert found.derivatives["cooling_capacity"][OUTLET] == pytest.approx(-flow * cp, rel=2e-3)


def test_an_offset_of_zero_is_shifted_by_far_less_than_the_crank(scene):
    # over ±5 mm of a crank of 12.7 mm the slope is 4 % off
    tight = replace(scene, numerics=replace(scene.numerics, accuracy=1e-7, error="none"))
    ends = [screwsim.simulate(with_values(tight, {OFFSET: by})).performance["shaft_power"] for by in (5e-5, -5e-5)]
    found = sensitivities(scene, [OFFSET], ["shaft_power"]).derivatives["shaft_power"][OFFSET]
    assert found == pytest.approx((ends[0] - ends[1]) / 1e-4, rel=5e-3)
