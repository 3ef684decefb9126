"""Laws of valves: switches, contact with seat and stop against its closed forms, the energy of a reed in a cycle."""

import math

import numpy as np
import pytest
from cylinder import REEDS, cylinder
from scipy.integrate import solve_ivp

from screwsim.effects import check_valves, reed_valves
from screwsim.effects.reed_valves import contact, contact_damping, opened, reed_acceleration
from screwsim.model.slots import FREE, LOOSE
from screwsim.numerics.rodas import dense_value
from screwsim.scene import with_values
from screwsim.simulate import simulate
from screwsim.solution import Solution

SOFTNESS = 1e-3


def potential(v: float, damping: float) -> float:
    """Return g(v) of S26."""
    return v / damping - math.log1p(damping * v) / damping**2


def impact(v: float, damping: float) -> tuple[float, float]:
    """Return speed after, and the deepest dent of, an impact at speed v on a seat alone (unit frequency)."""

    def rates(_, state):
        return [state[1], -contact(state[0], state[1], 1.0 / SOFTNESS, damping)]

    def leaves(_, state):
        return state[0]

    leaves.terminal, leaves.direction = True, -1
    found = solve_ivp(rates, (0.0, 10.0), [0.0, v], "DOP853", rtol=1e-11, atol=1e-13, events=leaves, max_step=1e-3)
    return -float(found.y[1, -1]), float(found.y[0].max())


@pytest.mark.parametrize("restitution", [0.1, 0.3, 0.9])
def test_restitution_at_the_scale_of_speed_is_the_stated_one(restitution):
    after, _ = impact(1.0, contact_damping(restitution))
    assert after == pytest.approx(restitution, rel=1e-5)


@pytest.mark.parametrize("v", [0.1, 0.5, 2.0])
def test_impacts_follow_the_closed_forms(v):
    damping = contact_damping(0.3)
    after, dent = impact(v, damping)
    assert potential(-after, damping) == pytest.approx(potential(v, damping), rel=1e-5)
    assert dent == pytest.approx(math.sqrt(2.0 * SOFTNESS * potential(v, damping)), rel=2e-4)


def test_contact_never_pulls():
    assert contact(-1e-3, 1.0, 1e3, 3.0) == 0.0
    assert contact(1e-3, -10.0, 1e3, 3.0) == 0.0


def test_a_shut_reed_dents_its_seat_by_the_softness_under_the_full_pressure():
    area, drop, stop, mass, stiffness = 1e-4, 8e5, 1e-3, 1e-3, 500.0
    numbers = {"load": area * drop, "stiffness": stiffness, "mass": mass, "stop": stop, "preload": 0.0}
    numbers |= {"damping_ratio": 0.1, "contact_stiffness": 1.0 / SOFTNESS, "contact_damping": 3.0}

    def at(lift):
        return reed_acceleration.function(lift, 0.0, -area * drop, **numbers)

    assert at(-0.99 * SOFTNESS) < 0.0 < at(-1.01 * SOFTNESS)


def test_a_free_reed_swings_at_its_own_frequency():
    mass, stiffness = 1e-3, 400.0
    numbers = {"load": 0.0, "stiffness": stiffness, "mass": mass, "stop": 1e-3, "preload": 0.0}
    numbers |= {"damping_ratio": 0.0, "contact_stiffness": 1e3, "contact_damping": 3.0}
    own = math.sqrt(stiffness / mass)
    assert reed_acceleration.function(0.5, 0.0, 0.0, **numbers) == pytest.approx(-0.5 * own)


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


def works(scene, side: str) -> tuple[float, float]:
    """Return the work of the gas on a reed over a closed turn, and what damping and contact take of it [J]."""
    solution = Solution(scene)
    machinery = solution.machinery
    machinery.warm_up(solution.rehearse)
    assert solution.close().status == "ok"
    states = machinery.composition.states
    lift, speed = (states.index(f"{side}_valve_{name}") for name in ("lift", "speed"))
    times, dense, _, steps = machinery.last()
    nodes, weights = np.polynomial.legendre.leggauss(4)
    theta = 0.5 + 0.5 * nodes[:, None]

    def along(column):
        return dense_value(theta, *(dense[None, :steps, row, column] for row in range(4)))

    xi, eta, p = along(lift), along(speed), along(len(states))
    dt = 0.5 * weights[:, None] * np.diff(times[: steps + 1]) / scene.operation.speed
    parameters = scene.effects["reed_valves"].parameters
    n = reed_valves.reed(parameters, side)
    p_s, p_d = scene.operation.suction.pressure, scene.operation.discharge.pressure
    load = n["force_area"] * (p_d - p_s)
    scale = reed_valves.speed_scale(load, n["stiffness"], n["mass"], n["stop"])
    v = eta * scale * n["stop"]
    force = n["force_area"] * (p_s - p if side == "suction" else p - p_d)
    bare = [n[name] for name in ("stiffness", "mass", "stop", "preload")]
    own = [n["damping_ratio"], n["contact_stiffness"], n["contact_damping"]]
    total = np.vectorize(lambda x, u, f: reed_acceleration.function(x, u, f, load, *bare, *own))(xi, eta, force)
    elastic = (force - n["preload"] - n["stiffness"] * n["stop"] * xi) / (n["mass"] * n["stop"] * scale)
    taken = (elastic - total) * n["mass"] * n["stop"] * scale  # force of damping and contact [N]
    return float((force * v * dt).sum()), float((taken * v * dt).sum())


@pytest.mark.parametrize("side", ["suction", "discharge"])
def test_what_the_gas_does_on_a_reed_is_what_damping_and_impacts_take(side):
    scene = cylinder(REEDS, numerics__accuracy=1e-4)
    done, taken = works(scene, side)
    assert done > 0.0
    assert taken == pytest.approx(done, rel=5e-3)
    assert done < 0.03 * simulate(scene, trace=False).performance.work_per_cycle


def test_the_softness_of_seat_and_stop_moves_the_figures_by_half_a_per_cent_at_most():
    found = [
        simulate(
            with_values(cylinder(REEDS, numerics__accuracy=1e-4), {"effects.reed_valves.softness": softness}),
            trace=False,
        ).performance
        for softness in (1e-3, 2.5e-4, 6e-5)
    ]
    for name in ("volumetric_efficiency", "indicated_power"):
        assert abs(found[0][name] / found[2][name] - 1.0) < 5e-3
        assert abs(found[1][name] / found[2][name] - 1.0) < 2.5e-3
