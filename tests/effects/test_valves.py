"""Laws of valves: switches, the forces on a reed, its energy in a cycle, its limits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from cylinder_scenes import REEDS, RPM, cylinder
from folders import CONFIGS
from scenes import closed

from screwsim.effects import check_valves, reed_valves
from screwsim.effects.reed_valves import opened, push_of, reed_acceleration, reed_push
from screwsim.figures.errors import relative_errors, worst
from screwsim.model.slots import FREE, LOOSE
from screwsim.numerics.rodas import dense_value
from screwsim.scene import load, with_values
from screwsim.simulate import simulate


def test_a_free_reed_swings_at_its_own_frequency():
    mass, stiffness, lift = 1e-3, 400.0, 0.5
    push = push_of.function(lift, 0.0, 0.0, stiffness, 1e-3, 0.0)
    own = math.sqrt(stiffness / mass)
    assert reed_acceleration.function(0.0, push, 0.0, stiffness, mass, 1e-3, 0.0) == pytest.approx(-lift * own)


def test_the_push_on_a_shut_reed_is_that_of_the_gas_less_the_preload():
    numbers = {"force_area": 1e-4, "stiffness": 500.0, "stop": 1e-3, "preload": 2.0}
    load = 1e-4 * 8e5 + 500.0 * 1e-3
    assert reed_push.function(0.0, 0.9e5, 1e5, 9e5, 1.0, **numbers) == pytest.approx((1.0 - 2.0) / load)
    assert reed_push.function(0.0, 9.5e5, 1e5, 9e5, -1.0, **numbers) == pytest.approx((5.0 - 2.0) / load)


def test_a_reed_opens_from_nothing_to_port_and_curtain_in_series():
    assert opened(-0.01, 3.0) == opened(0.0, 3.0) == 0.0
    assert opened(0.01, 3.0) == pytest.approx(0.03, rel=1e-3)
    assert opened(1.0, 1.0) == pytest.approx(1.0 / math.sqrt(2.0))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_check_valve_is_open_along_its_flow_only(sign):
    opening = check_valves.opening.function
    assert opening(FREE, -sign * 1.0, 10.0, sign) == 0.0
    assert opening(FREE, sign * 100.0, 10.0, sign) == 1.0
    assert 0.0 < opening(FREE, sign * 5.0, 10.0, sign) < 1.0
    assert opening(1.0, -sign * 100.0, 10.0, sign) == 1.0  # held open until the step ends
    assert opening(LOOSE, -sign * 0.5, 10.0, sign) == 1.0


def test_steps_from_an_opening_valve_see_their_error():
    """There the flow is steepest over Δp: a step of 12 degrees erred a hundred times what it told."""
    changes = {"operation.speed": 8700 * RPM, "operation.suction.pressure": 16.7e5}
    scene = with_values(load(CONFIGS / "slider_crank" / "flexible_rod.yaml"), changes)
    found = simulate(scene, trace=False)
    numerics = replace(scene.numerics, accuracy=0.01 * scene.numerics.accuracy, error="none")
    finer = simulate(replace(scene, numerics=numerics), trace=False)
    true = relative_errors(found.performance, finer.performance)
    assert true["discharge_valve_power"] < 0.5 * scene.numerics.accuracy


def works(scene, side: str) -> tuple[float, float, float]:
    """Return the work of the gas on a reed over a closed turn, and what damping and impacts take of it [J]."""
    _, machinery, cycle = closed(scene)
    assert cycle.status == "ok"
    states = machinery.composition.states
    lift, speed = (states.index(f"{side}_valve_{name}") for name in ("lift", "speed"))
    times, dense, _, steps = machinery.lives.last()
    nodes, weights = np.polynomial.legendre.leggauss(4)
    theta = 0.5 + 0.5 * nodes[:, None]

    def along(column):
        return dense_value(theta, *(dense[None, :steps, row, column] for row in range(4)))

    eta, p = along(speed), along(len(states))
    dt = 0.5 * weights[:, None] * np.diff(times[: steps + 1]) / scene.operation.speed
    n = reed_valves.reed(scene.effects["reed_valves"].parameters, side)
    p_s, p_d = scene.operation.suction.pressure, scene.operation.discharge.pressure
    scale = reed_valves.speed_scale(n["force_area"] * (p_d - p_s), n["stiffness"], n["mass"], n["stop"]) * n["stop"]
    force = n["force_area"] * (p_s - p if side == "suction" else p - p_d)
    damping = 2.0 * n["damping_ratio"] * math.sqrt(n["stiffness"] * n["mass"]) * eta * scale
    before, after = dense[: steps - 1, 1, speed], dense[1:steps, 0, speed]
    jump = before != after
    np.testing.assert_allclose(after[jump & (after != 0.0)], -0.3 * before[jump & (after != 0.0)], rtol=1e-14)
    at_ends = dense[: steps - 1, 1, lift][jump]
    assert jump.sum() > 4
    assert set(at_ends) <= {0.0, 1.0}
    impacts = 0.5 * n["mass"] * scale**2 * (before**2 - after**2).sum()
    return float((force * eta * scale * dt).sum()), float((damping * eta * scale * dt).sum()), float(impacts)


@pytest.mark.parametrize("side", ["suction", "discharge"])
def test_what_the_gas_does_on_a_reed_is_what_damping_and_impacts_take(side):
    scene = cylinder(REEDS, numerics__accuracy=1e-5)
    done, damped, struck = works(scene, side)
    assert done > 0.0
    assert struck > damped > 0.0
    assert damped + struck == pytest.approx(done, rel=1e-5)
    assert done < 0.03 * simulate(scene, trace=False).performance.work_per_cycle


def bounced(scene, restitution: float):
    names = (f"effects.reed_valves.{end}_restitution" for end in ("seat", "stop"))
    return with_values(scene, dict.fromkeys(names, restitution))


def test_figures_converge_with_the_accuracy():
    scene = cylinder(REEDS)
    fine = simulate(with_values(scene, {"numerics.accuracy": 1e-7}), trace=False).performance
    for accuracy in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
        found = simulate(with_values(scene, {"numerics.accuracy": accuracy}), trace=False)
        assert found.status == "ok"
        assert worst(relative_errors(found.performance, fine))[1] < accuracy


def test_reeds_that_hardly_bounce_are_those_that_do_not():
    scene = cylinder(REEDS, numerics__accuracy=1e-5)
    none, little = (simulate(bounced(scene, e), trace=False).performance for e in (0.0, 1e-4))
    for name in ("volumetric_efficiency", "indicated_power"):
        assert little[name] == pytest.approx(none[name], rel=1e-4)


def test_a_stop_out_of_reach_is_none():
    scene = cylinder(REEDS, numerics__accuracy=1e-5)
    far, further = (simulate(with_stops(scene, factor), trace=False) for factor in (30.0, 100.0))
    assert far.status == further.status == "ok"
    assert further.performance.volumetric_efficiency == pytest.approx(far.performance.volumetric_efficiency, rel=2e-5)


def test_a_stop_at_the_seat_shuts_the_valve():
    found = [simulate(with_stops(cylinder(REEDS), factor), trace=False) for factor in (1e-2, 1e-3, 1e-4)]
    assert [each.status for each in found] == ["ok"] * 3
    share = [each.performance.volumetric_efficiency for each in found]
    assert share[0] > share[1] > share[2]
    assert share[2] < 1e-3


def with_stops(scene, factor: float):
    parameters = scene.effects["reed_valves"].parameters
    names = (f"{side}_stop" for side in ("suction", "discharge"))
    return with_values(scene, {f"effects.reed_valves.{name}": factor * getattr(parameters, name) for name in names})
