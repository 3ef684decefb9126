"""What the shaft feels: virtual work, its mean and harmonics, loads of the bearings, three levels of power."""

import math

import numpy as np
import pytest
from each_row import each_row
from folders import CONFIGS
from scenes import DROP, closed, make, refusal, run

from screwsim.cycle.pitch import POINTS, Pitch, PitchQuadrature, _slopes
from screwsim.effects import gas_torque
from screwsim.evaluate.evaluation import evaluate
from screwsim.inputs.faults import SceneError
from screwsim.machine.geometry import Geometry
from screwsim.outputs import ledger_entries
from screwsim.scene import load

LOADED = {
    "effects.oil_drag": {"tip_gap": "0.1 mm", "tip_land": "3 mm", "end_gap": "0.1 mm", "end_solidity": 0.6},
    "effects.bearings": {
        "load": "gas",
        "radial_area": "60 cm^2",
        "axial_area": "30 cm^2",
        "friction_coefficient": 0.0018,
        "bore": "60 mm",
    },
    "effects.motor": {"rated_power": "75 kW"},
    "effects.gas_torque": {"male_share": 0.9, "axial_area": "30 cm^2", "radial_area": "60 cm^2"},
}
OMEGA = 3000.0 * math.pi / 30.0


def solved(changes):
    """Return a closed cycle being read, and its pitch."""
    problem, _, cycle = closed(make(changes))
    of = evaluate(problem, cycle)
    return of, of.pitch


# ---- torque ----


def test_the_mean_torque_is_the_indicated_power_over_the_speed():
    p = run(LOADED).performance
    assert p.gas_torque_mean == pytest.approx(p.indicated_power / OMEGA, rel=1e-12)
    curve = run(LOADED).cycle["gas_torque"][:90]  # one pitch, a point a degree
    assert curve.mean() == pytest.approx(p.gas_torque_mean, rel=2e-3)  # the trace leaves out three points of four


@pytest.mark.parametrize(("accuracy", "least"), [(3e-4, 3e-4), (1e-5, 1e-5)])
def test_the_trace_has_that_mean_itself_within_the_accuracy(accuracy, least):
    _, pitch = solved({"numerics": {"accuracy": accuracy}})
    assert gas_torque.raw_torque(pitch).mean() == pytest.approx(pitch.torque_mean, rel=least)
    assert gas_torque.torque(pitch).mean() == pytest.approx(pitch.torque_mean, rel=1e-12)


def test_the_torque_of_closed_chambers_is_that_of_isentropic_springs():
    """No port, no leak: p = p_s (ρ/ρ_s)^k in every chamber from its rest at 0°; M = −Σ (p − p_s) dV/dφ, mean zero."""
    of, pitch = solved({"effects": {}, "oil": DROP, "oil_supply": DROP, "numerics": {"accuracy": 1e-6}})
    parts = of.problem.parts
    k, p_0, V_0 = parts.gas.k, None, None
    law, n = parts.geometry.volume_law(), parts.geometry.chambers
    V_max, V_min, phi_A = (law.values[name] for name in ("V_max", "V_min", "phi_A"))
    grid = pitch.angle[:, None] + parts.geometry.pitch * np.arange(n)
    V = np.array([[law.volume(phi, V_max, V_min, phi_A) for phi in row] for row in grid])
    p_0, V_0 = pitch.pressure[0, n // 2], V[0, n // 2]
    expected = p_0 * (V_0 / V) ** k
    assert np.allclose(pitch.pressure, expected, rtol=1e-3)
    torque = -((expected - pitch.low_pressure) * pitch.slope).sum(axis=1)
    assert np.max(np.abs(gas_torque.raw_torque(pitch) - torque)) < 2e-3 * np.max(np.abs(expected * pitch.slope))


def test_the_torque_repeats_every_pitch_and_pulsates_about_its_mean():
    curve, p = run(LOADED).cycle["gas_torque"], run(LOADED).performance
    assert np.allclose(curve[90:], curve[:-90], rtol=1e-12)
    assert curve.min() < p.gas_torque_mean < curve.max()
    assert p.gas_torque_peak_to_peak == pytest.approx(np.ptp(curve), rel=0.02)
    assert p.gas_torque_peak_to_peak > 2.0 * p.gas_torque_harmonic_1 * 0.7


def test_the_swing_is_that_of_the_curve_not_of_its_points():
    """Tops are corners where ports open: values every 0.25° miss up to 5e-3 of the swing, which no error would show."""
    found, pitch = solved({"effects.gas_torque": {}})
    life, geometry, n = found.life, found.problem.parts.geometry, 3600
    grid = np.arange(n)[:, None] * (geometry.pitch / n) + geometry.pitch * np.arange(geometry.chambers)
    p = life.states_at(grid.T.ravel())[:, -1].reshape(geometry.chambers, n).T
    fine = -((p - pitch.low_pressure) * geometry.volume_law().along(grid)[1]).sum(axis=1)
    assert found.figures["gas_torque_peak_to_peak"] == pytest.approx(np.ptp(fine), rel=5e-5)
    assert np.ptp(gas_torque.torque(pitch)) < (1.0 - 1e-4) * np.ptp(fine)


def test_harmonics_are_amplitudes():
    phase = np.arange(360) / 360
    x = 2.0 * math.pi * phase
    within = PitchQuadrature(phase, np.full(360, 1 / 360), phase, phase, None)
    found = within.harmonics(5.0 + 3.0 * np.cos(x + 0.3) + 0.5 * np.sin(3 * x), 4)
    assert found == pytest.approx([3.0, 0.0, 0.5, 0.0], abs=1e-12)


def test_a_curve_of_harmonics_keeps_none_of_those_that_its_angles_cannot_tell_apart():
    """A saw tooth has b_k = 2 (-1)^(k+1)/k; sampled at 21 angles the first would be off by a hundredth."""
    ends, nodes, weights = np.linspace(-0.5, 0.5, 64), *np.polynomial.legendre.leggauss(3)
    half = 0.5 * np.diff(ends)[:, None]
    phase = (ends[:-1, None] + half * (1.0 + nodes)).ravel()
    within = PitchQuadrature(phase, (half * weights).ravel(), phase, phase, None)
    x, k = 2.0 * math.pi * np.arange(21) / 21, np.arange(1, 11)[:, None]
    exact = 7.0 + (2.0 * (-1.0) ** (k + 1) / k * np.sin(k * x)).sum(axis=0)
    assert within.smooth(2.0 * math.pi * phase, 7.0, 21) == pytest.approx(exact, abs=2e-5)


@pytest.mark.parametrize("lobes", [1, 2, 4])
def test_mean_force_and_harmonics_are_those_of_the_curve(lobes):
    """Even angles took what expands at 0° within a degree for half an angle: of one lobe the force was 1.6e-3 off."""
    machine = {"machine.male_lobes": lobes, "machine.female_lobes": lobes + 1}
    found, pitch = solved(LOADED | machine)
    geometry, n = found.problem.parts.geometry, 40000
    fine = (np.arange(n) + 0.5) * (geometry.pitch / n)
    pressure, slope = pitch.at(fine)
    excess = pressure - pitch.low_pressure
    assert found.figures["axial_gas_force"] == pytest.approx(3e-3 * excess.sum(axis=1).mean(), rel=2e-6)
    torque = np.abs(np.fft.rfft(-(excess * slope).sum(axis=1)))[1:5] * 2.0 / n
    assert [found.figures[f"gas_torque_harmonic_{k}"] for k in range(1, 5)] == pytest.approx(torque.tolist(), rel=1e-5)


def test_the_shares_of_both_shafts_give_the_power():
    p = run(LOADED).performance
    female_speed = OMEGA * 4 / 6
    assert p.male_gas_torque * OMEGA + p.female_gas_torque * female_speed == pytest.approx(p.indicated_power, rel=1e-12)
    assert p.male_gas_torque == pytest.approx(0.9 * p.gas_torque_mean, rel=1e-12)


def test_torques_of_both_rotors_over_the_angle_do_the_work_of_the_whole():
    cycle, p = run(LOADED).cycle, run(LOADED).performance
    male, female = cycle["male_gas_torque"], cycle["female_gas_torque"]
    assert np.allclose(male + female * 4 / 6, cycle["gas_torque"], rtol=1e-12)
    assert np.mean(male[:-1]) == pytest.approx(p.male_gas_torque, rel=1e-3)  # the trace has a point a degree


def test_rotors_know_the_share_of_each():
    """The volume's slope is the sum of both rotors' parts, and uniform pressure on one chamber has their mean share."""
    geometry = Geometry(load(CONFIGS / "rotors" / "a.yaml").machine)
    slope, male = _slopes(geometry)
    exact = geometry.profile.rotors.volume_slope(
        np.arange(POINTS)[:, None] * (geometry.pitch / POINTS)
        + geometry.pitch * np.arange(geometry.chambers)
        - geometry.profile.born
        + geometry.profile.rotors.start
    )
    assert np.max(np.abs(slope - exact)) < 0.02 * np.max(np.abs(exact))  # the table is a spline over every degree
    falling = np.minimum(exact, 0.0).sum(), np.where(exact < 0.0, male, 0.0).sum()
    assert falling[1] / falling[0] == pytest.approx(geometry.profile.rotors.sections.male_share, abs=0.02)
    pressure = np.where(exact < 0.0, 2e5, 1e5)
    within = PitchQuadrature(np.arange(POINTS) / POINTS, np.full(POINTS, 1.0 / POINTS), pressure, slope, male)
    curves = np.arange(POINTS), pressure, slope, male, 1e5, 50.0, 2e5
    pitch = Pitch(*curves, at=lambda _: (pressure, slope), missed=np.zeros_like, steps=exact, within=lambda: within)
    shaft, female = gas_torque.on_rotors(gas_torque.Parameters(), pitch, 1.5)
    assert shaft + female / 1.5 == pytest.approx(50.0, rel=1e-12)
    assert shaft / 50.0 == pytest.approx(geometry.profile.rotors.sections.male_share, abs=0.02)
    curves = gas_torque.rotor_torques(gas_torque.Parameters(), pitch, 1.5)
    assert curves is not None
    assert [curve.mean() for curve in curves] == pytest.approx([shaft, female], rel=1e-12)
    assert np.allclose(curves[0] + curves[1] / 1.5, gas_torque.torque(pitch), rtol=1e-12)
    assert np.ptp(curves[0] / gas_torque.torque(pitch)) > 1e-3  # the share changes over the angle


def test_forces_are_areas_times_the_excess_of_pressure():
    result = run(LOADED)
    p, cycle = result.performance, result.cycle
    excess = sum(np.roll(cycle["pressure"][:-1] - 1.5e5, 90 * j) for j in range(8))  # eight chambers, a pitch apart
    assert p.axial_gas_force == pytest.approx(30e-4 * excess.mean(), rel=3e-3)  # the trace has a point a degree
    assert p.radial_gas_force_peak == pytest.approx(60e-4 * excess.max(), rel=0.01)
    assert np.max(cycle["axial_gas_force"]) == pytest.approx(p.axial_gas_force_peak, rel=0.01)


def test_behind_a_loss_forces_count_from_what_the_chambers_meet():
    """A plenum so large that it hardly pulsates: the machine that sucks at its pressure (ideal gas: no cooler)."""
    lossy = {"suction_volume": "1000 l", "suction_area": "40 cm^2", "suction_loss": 4}
    p = run({**LOADED, "effects.plenums": lossy}).performance
    assert p.suction_plenum_pressure < 0.97 * p.suction_pressure
    plain = run({**LOADED, "operation.suction.pressure": f"{p.suction_plenum_pressure:.10g} Pa"}).performance
    for name in ("radial_gas_force", "axial_gas_force_peak", "bearing_power", "indicated_power"):
        assert p[name] == pytest.approx(plain[name], rel=1e-3)  # the pulsation that is left


# ---- powers ----


def test_the_three_levels_of_power():
    p = run(LOADED).performance
    losses = sum(p[name] for name in ("oil_pump_power", "hydromechanical_power", "mechanical_power"))
    own = p.oil_drag_power + p.bearing_power
    assert p.shaft_power == pytest.approx(p.indicated_power + p.oil_lift_power + losses + own, rel=1e-12)
    assert p.electrical_power == pytest.approx(p.shaft_power + p.motor_loss, rel=1e-12)
    assert p.indicated_power < p.shaft_power < p.electrical_power
    assert p.electrical_isothermal_efficiency == pytest.approx(p.isothermal_efficiency * p.motor_efficiency, rel=1e-12)


def test_bearings_under_gas_carry_the_gas_forces():
    p = run(LOADED).performance
    load = math.hypot(p.axial_gas_force, p.radial_gas_force)
    assert p.bearing_power == pytest.approx(0.5 * 0.0018 * load * 0.06 * OMEGA * (1 + 4 / 6), rel=1e-9)


def test_the_drag_is_dissipated_at_ambient_temperature_and_the_ledger_closes():
    result = run(LOADED)
    entries = ledger_entries(result.ledger)
    for name, figure in (("oil_drag", "oil_drag_power"), ("bearings", "bearing_power")):
        assert entries[name]["exergy_destroyed"] == pytest.approx(result.performance[figure], rel=1e-12)
    assert abs(result.ledger.relative_residue) < 1e-3
    assert not {"motor", "gas_torque"} & set(entries)  # beyond the shaft, and no power at all


def test_the_cycle_is_that_without_them_bit_for_bit():
    with_them, without = run(LOADED), run()
    for name in ("indicated_power", "gas_mass_flow", "discharge_temperature", "peak_pressure"):
        assert with_them.performance[name] == without.performance[name]
    assert with_them.numerics.rhs_evaluations == without.numerics.rhs_evaluations
    assert with_them.balance == {**without.balance, "entropy": with_them.balance.entropy}


def test_what_is_not_simulated_is_not_there():
    p = run().performance
    names = ("oil_drag_power", "bearing_power", "electrical_power", "gas_torque_mean", "axial_gas_force_peak")
    assert not {*names} & {*p}


def test_colder_films_drag_more():
    named = {"oil.name": "POE_ACD100FY", "oil.density": DROP, "oil.heat_capacity": DROP, "oil.viscosity": DROP}
    named |= {"oil_supply.temperature": "330 K", **LOADED}
    cold, warm = (run({**named, "effects.oil_drag.film_temperature": T}) for T in ("320 K", "360 K"))
    assert cold.performance.oil_drag_power > 4.0 * warm.performance.oil_drag_power  # (360/320)^12.96 = 4.6


# ---- faults ----


@each_row(
    ("changes", "words"),
    [
        ({"oil.viscosity": DROP}, "oil.viscosity: is missing (effects.oil_drag needs it, or oil.name)"),
        ({"effects.oil_drag.end_solidity": DROP}, "effects.oil_drag.end_solidity: is missing"),
        ({"effects.bearings.load": "stated"}, "effects.bearings.radial_load: is missing (stated needs it"),
        (
            {"effects.bearings.radial_load": "8 kN"},
            "effects.bearings.radial_load: applies only to stated, and gas is chosen",
        ),
        ({"effects.bearings.friction": "two_term"}, "effects.bearings.f_0: is missing (two_term needs it"),
        ({"oil.name": "POE_ACD100FY"}, "oil.density: is given as well as oil.name"),
        ({"oil.density": DROP}, "oil.density: is missing (write e.g. density: 980 kg/m^3, or the name of a stored oil"),
    ],
)
def test_a_fault_is_found_with_its_remedy(changes, words):
    assert words in refusal({**LOADED, **changes})


def test_a_stored_oil_is_supplied_inside_its_range():
    named = {"oil": {"name": "POE_ACD100FY"}}
    with pytest.raises(SceneError, match=r"19\.85 degC lies outside the range of POE_ACD100FY, 39\.85 degC to"):
        make(named)


def test_a_stored_oil_is_that_of_its_numbers():
    """At 330 K: the same scene with the numbers written out is the same cycle, bit for bit."""
    from screwsim.fluid.oils import OILS

    oil = OILS["POE_ACD100FY"]
    numbers = {
        "density": f"{oil.density_at(330.0)!r} kg/m^3",
        "heat_capacity": f"{oil.heat_capacity_at(330.0)!r} J/(kg K)",
        "viscosity": f"{oil.viscosity_at(330.0)!r} Pa s",
        "transport": "paper",
    }
    supply = {"oil_supply.temperature": "330 K"}
    by_name = run({"oil": {"name": "POE_ACD100FY", "transport": "paper"}, **supply})
    by_number = run({"oil": numbers, **supply})
    assert by_name.performance == by_number.performance


def test_the_figure_shows_the_harmonics_of_the_result(tmp_path):
    from screwsim.report import cycle
    from screwsim.results import open_results, save

    save(tmp_path / "run.h5", make(LOADED), run(LOADED))
    plans = dict(cycle.plans(open_results(tmp_path / "run.h5")))
    upper, lower = plans["gas_torque"]().axes
    heights = [bar.get_height() for bar in lower.patches]
    p = run(LOADED).performance
    assert upper.get_xlim() == (0.0, 180.0)
    assert heights[0] == pytest.approx(p.gas_torque_harmonic_1, rel=0.01)  # the trace has a point a degree
    assert heights[3] == pytest.approx(p.gas_torque_harmonic_4, abs=0.01 * p.gas_torque_mean)
