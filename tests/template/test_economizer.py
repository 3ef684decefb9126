"""The port of a new machine's economizer: little is pushed back, no other size is better, and the motor turns it."""

import math

import pytest

import screwsim
from screwsim.build import build_parts
from screwsim.template import economizer, new_scene, request_of
from screwsim.template.duty import duty_of

CONDITIONS = [
    ("R134a", "0/40 degC"),
    ("R717", "-10/35 degC"),
    ("R717", "-35/35 degC"),
    ("R290", "-5/40 degC"),
    ("R404A", "-30/40 degC"),
    ("R1234ze(E)", "0/45 degC"),
]
CASES = pytest.mark.parametrize(("fluid", "condition"), CONDITIONS)
FLOW = 600.0 / 3600.0


def scene_of(fluid, condition, size=1.0):
    scene = screwsim.loads(new_scene("refrigeration", request_of(fluid=fluid, condition=condition, economizer=True)))
    area = size * scene.effects["economizer"].parameters.area
    return screwsim.loads(scene.text, overrides=[f"effects.economizer.area={area!r} m^2"])


@CASES
def test_chambers_push_little_of_the_vapour_back_and_the_port_is_of_the_best_size(fluid, condition):
    """Of ammonia at -10/35 °C 36 % came back, as the port was made for R134a, in whose vapour sound is slower."""
    scene = scene_of(fluid, condition)
    result = screwsim.simulate(scene)
    assert (result.status, result.warnings) == ("ok", ())
    drawn, moved = result.performance.economizer_mass_flow, result.ledger["gas_moved_economizer"]
    assert 0.0 <= (moved - drawn) / (moved + drawn) < 0.05
    for size in (0.5, 2.0):
        other = screwsim.simulate(scene_of(fluid, condition, size), trace=False).performance
        assert other.electrical_cop < result.performance.electrical_cop
    load = result.performance.shaft_power / scene.effects["motor"].parameters.rated_power
    assert 0.6 < load < 1.0


@CASES
def test_an_economizers_vapour_is_estimated_as_it_is_solved(fluid, condition):
    """The estimate of pressure and flow decides on area and motor."""
    found = screwsim.simulate(scene_of(fluid, condition), trace=False).performance
    vapour = economizer.vapour_of(fluid, duty_of(fluid, FLOW, condition, condition))
    assert vapour.p == pytest.approx(found.economizer_pressure, rel=0.06)
    assert vapour.ratio == pytest.approx(found.economizer_flow_ratio, rel=0.08)


@CASES
def test_the_estimate_of_an_economizers_vapour_has_converged(fluid, condition, monkeypatch):
    duty = duty_of(fluid, FLOW, condition, condition)
    found = economizer.vapour_of(fluid, duty)
    monkeypatch.setattr(economizer, "STEPS", 2 * economizer.STEPS)
    assert found == pytest.approx(economizer.vapour_of(fluid, duty), rel=0.01)


def test_volume_at_which_an_economizers_port_closes():
    geometry = build_parts(scene_of("R134a", "0/40 degC")).geometry
    volume, closes = geometry.profile.volume, geometry.injection_angle + economizer.BESIDE + geometry.pitch
    at = float(volume.value[abs(volume.angle - closes).argmin()])
    assert geometry.swept_volume / at == pytest.approx(economizer.CLOSED_IN, rel=0.01)
    assert math.degrees(closes) == pytest.approx(545.0)
