"""Laws of a cylinder: the closed-form ideal cycle, conservation, one result by two integrators, hard cases."""

from dataclasses import replace

import pytest
from cylinder_scenes import CHECK, P_S, REEDS, RPM, SHUT, K, cylinder, with_areas
from folders import CONFIGS
from known import known
from scenes import balanced, closed

from screwsim.build import build_gas
from screwsim.evaluate.evaluation import evaluate
from screwsim.scene import load, scene_text, with_values
from screwsim.simulate import simulate
from screwsim.solve import stability

BOTH = pytest.mark.parametrize("text", [CHECK, REEDS], ids=["check", "reeds"])


def ideal_volumetric_efficiency(scene) -> float:
    """Return λ of S21, 0 where nothing is delivered."""
    c, ratio = scene.machine.clearance_ratio, scene.operation.discharge.pressure / scene.operation.suction.pressure
    return max(0.0, 1.0 + c - c * ratio ** (1.0 / K))


@pytest.mark.parametrize(("clearance", "ratio"), [(0.03, 4.0), (0.1, 3.0), (1e-3, 8.0)])
def test_wide_valves_approach_the_ideal_cycle(clearance, ratio):
    scene = cylinder(numerics__accuracy=3e-5, operation__discharge__pressure=ratio * P_S)
    scene = with_values(scene, {"machine.clearance": clearance * scene.machine.swept_volume})
    expected = ideal_volumetric_efficiency(scene)
    # S23
    work = K / (K - 1.0) * P_S * expected * scene.machine.swept_volume * (ratio ** ((K - 1.0) / K) - 1.0)
    short = []
    for factor in (1.0, 10.0, 100.0):
        found = simulate(with_areas(scene, factor), trace=False)
        assert found.status == "ok"
        short.append(expected - found.performance.volumetric_efficiency)
    assert short[0] > 0.0
    assert abs(short[-1]) < 1e-4
    assert found.performance.work_per_cycle == pytest.approx(work, rel=2e-4)
    assert found.performance.isentropic_efficiency == pytest.approx(1.0, abs=2e-4)


@BOTH
def test_mass_energy_and_entropy_close(text):
    found = balanced(simulate(cylinder(text)))
    performance = found.performance
    flow = -found.cycle[f"mass_flow_{'check' if text is CHECK else 'reed'}_valves"]
    assert flow.min() < 0.0 < flow.max()
    assert performance.gas_mass_flow > 0.0


# scipy's steps end where reeds meet seat and stop, but not where a check valve switches: at 1e-4 they see it by chance
@pytest.mark.parametrize(("text", "apart"), [(CHECK, 4e-4), (REEDS, 1e-5)], ids=["check", "reeds"])
def test_radau_gives_the_same(text, apart):
    scene = cylinder(text, numerics__accuracy=1e-5)
    ours = simulate(scene, trace=False)
    other = with_values(scene, {"numerics.integrator": "scipy-radau", "numerics.error": "none"})
    names = "volumetric_efficiency", "indicated_power", "discharge_temperature", "trapped_mass"

    def find():
        radau = simulate(other, trace=False)
        assert radau.status == "ok", radau.message
        return {name: float(radau.performance[name]) for name in names}

    theirs = known("radau", "a cylinder's cycle", scene_text(other), find, 1e-6)
    assert ours.status == "ok"
    for name in names:
        assert theirs[name] == pytest.approx(ours.performance[name], rel=apart), name


@BOTH
def test_coupled_closing_gives_the_same(text):
    scene = cylinder(text)
    turned, together = (
        simulate(with_values(scene, {"numerics.closing": way}), trace=False) for way in ("histories", "coupled")
    )
    assert together.status == "ok"
    for name in ("volumetric_efficiency", "indicated_power"):
        assert together.performance[name] == pytest.approx(turned.performance[name], rel=6e-4)


@BOTH
@pytest.mark.parametrize(
    "changes",
    [
        {"operation__speed": 50.0 * RPM},
        {"operation__speed": 3000.0 * RPM},
        {"operation__discharge__pressure": 1.05 * P_S},
        {"operation__discharge__pressure": 20.0 * P_S},
        {"clearance_ratio": 1e-4},
        {"clearance_ratio": 0.2},
        {"areas": 0.01},
        {"areas": 100.0},
    ],
    ids=lambda changes: " ".join(f"{name}={value:.4g}" for name, value in changes.items()),
)
def test_hard_cases_close(text, changes):
    changes = dict(changes)
    ratio, areas = changes.pop("clearance_ratio", None), changes.pop("areas", 1.0)
    scene = with_areas(cylinder(text, **changes), areas)
    if ratio is not None:
        scene = with_values(scene, {"machine.clearance": ratio * scene.machine.swept_volume})
    found = simulate(scene, trace=False)
    assert found.status == "ok", found.message
    assert 0.0 <= found.performance.volumetric_efficiency < 1.0 + (0.3 if text is REEDS else 0.0)
    assert max(size for size in found.error.values() if size is not None) <= scene.numerics.accuracy


@pytest.mark.parametrize("factor", [0.01, 100.0])
@pytest.mark.parametrize("name", ["stiffness", "mass", "stop"])
def test_soft_and_stiff_light_and_heavy_reeds_close(name, factor):
    scene = cylinder(REEDS)
    parameters = scene.effects["reed_valves"].parameters
    fields = [f"{side}_{name}" for side in ("suction", "discharge")]
    values = {f"effects.reed_valves.{field}": factor * getattr(parameters, field) for field in fields}
    found = simulate(with_values(scene, values), trace=False)
    assert found.status == "ok", found.message
    assert found.numerics.rhs_evaluations < 60_000
    assert max(size for size in found.error.values() if size is not None) <= scene.numerics.accuracy


@pytest.mark.parametrize(
    ("restitution", "rpm", "status"),
    [(0.0, 1500.0, "ok"), (0.9, 1500.0, "ok"), (0.999, 1500.0, "not_closed"), (0.9999, 20.0, "failed")],
)
def test_reeds_that_bounce_without_end_are_said_to(restitution, rpm, status):
    scene = cylinder(REEDS, numerics__closing="histories", operation__speed=rpm * RPM)
    scene = with_values(scene, {f"effects.reed_valves.{end}_restitution": restitution for end in ("seat", "stop")})
    found = simulate(scene, trace=False)
    assert found.status == status
    assert found.numerics.rhs_evaluations < 4_000_000
    assert ("impacts of its reeds" in found.message) == (status != "ok")


def test_heavy_reeds_on_soft_springs_do_not_stay_on_their_cycle():
    scene = cylinder(
        REEDS,
        operation__speed=2070.0 * RPM,
        operation__discharge__pressure=5.18 * P_S,
        machine__clearance=0.435e-6,
        effects__reed_valves__suction_port_area=0.911e-4,
        effects__reed_valves__suction_perimeter=42e-3,
        effects__reed_valves__suction_stop=1.64e-3,
        effects__reed_valves__suction_mass=11.8e-3,
        effects__reed_valves__suction_stiffness=337.0,
        effects__reed_valves__discharge_port_area=12.1e-4,
        effects__reed_valves__discharge_perimeter=164e-3,
        effects__reed_valves__discharge_stop=2.34e-3,
        effects__reed_valves__discharge_mass=8.67e-3,
        effects__reed_valves__discharge_stiffness=72.3,
        effects__reed_valves__seat_restitution=0.25,
        effects__reed_valves__stop_restitution=0.274,
    )
    restless, steady = simulate(scene, trace=False), simulate(cylinder(REEDS), trace=False)
    assert restless.status == steady.status == "ok"
    assert any("does not stay on this cycle" in warning for warning in restless.warnings)
    assert not steady.warnings


def test_the_question_whether_a_cycle_lasts_changes_nothing_of_it():
    problem, machinery, cycle = closed(cylinder(REEDS))
    before = evaluate(problem, cycle).figures
    counts = machinery.counts.copy()
    rtol = problem.criteria.rtol
    assert (
        stability.largest_work_change(problem, machinery, replace(cycle, how="coupled"), rtol)
        < stability.LARGEST_WORK_CHANGE
    )
    assert (machinery.counts > counts)[[0, 2]].all()  # it was asked
    assert evaluate(problem, cycle).figures == before


def test_heat_that_leaves_with_what_the_rings_let_past_is_told():
    """The first law: what the delivered gas has more than the work is negative, and left with the rings' leak."""
    scene = load(CONFIGS / "slider_crank" / "air.yaml", ["effects.ring_leakage.gap=60 um"])
    result = simulate(scene, trace=False)
    p, gas = result.performance, build_gas(scene)
    rise = p.gas_mass_flow * gas.c_p * (p.discharge_temperature - p.suction_temperature)
    lost = p.indicated_power + p.wall_heat - rise
    assert lost > 0.05 * p.shaft_power
    (told,) = result.warnings
    assert float(told.split()[0]) == pytest.approx(1e-3 * lost, rel=5e-3)  # kW, three digits
    assert "of the shaft power, leaves with gas flowing back" in told
    assert "name effects.suction_line" in told
    assert not simulate(load(CONFIGS / "slider_crank" / "air.yaml"), trace=False).warnings


def test_a_ratio_too_high_delivers_nothing():
    scene = cylinder()
    scene = with_values(scene, {"machine.clearance": 0.2 * scene.machine.swept_volume})
    scene = with_values(scene, {"operation.discharge.pressure": 1.2 * P_S * (1.0 / 0.2 + 1.0) ** K})
    assert ideal_volumetric_efficiency(scene) == 0.0
    found = simulate(scene)
    assert found.status == "ok"
    assert found.performance.volumetric_efficiency == pytest.approx(0.0, abs=1e-4)
    assert any("no net gas is delivered" in warning for warning in found.warnings)


def test_a_cylinder_without_valves_compresses_and_expands_the_same_gas():
    found = simulate(cylinder(SHUT))
    assert found.status == "ok"
    assert found.performance.gas_mass_flow == 0.0
    p, V = found.cycle["pressure"], found.cycle["volume"]
    assert (p * V**K).std() / (p * V**K).mean() < 1e-4
