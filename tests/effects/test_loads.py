"""Drag, bearings, motor: closed forms, limits, and the numbers of their sources."""

import math
from types import SimpleNamespace

import pytest
from scenes import make

from screwsim.effects import bearings, motor, oil_drag
from screwsim.evaluate.performance import effect_figures, parted
from screwsim.fluid.oils import OILS
from screwsim.inputs.faults import SceneError

SIZE = SimpleNamespace(male_lobes=4, female_lobes=6, rotor_diameter=0.16, rotor_length=0.176, profile=None)
MACHINE = SimpleNamespace(settings=SIZE)
FIGURES = SimpleNamespace(
    omega=300.0,
    oil_temperature=310.0,
    oil_discharge_temperature=330.0,
    film_viscosity_at=lambda T: 0.02,
    oil_density_at=lambda T: 1000.0,
    turn=None,
)
LANDS = {"tip_gap": 1e-4, "tip_land": 3e-3}
SIMPLE = {"friction_coefficient": 0.0018, "bore": 0.06, "radial_load": 3e3, "axial_load": 4e3}
TWO_TERM = {
    "friction": "two_term",
    "mean_diameter": 0.085,
    "f_0": 2.0,
    "f_1": 4e-4,
    "radial_load": 3e3,
    "axial_load": 4e3,
}


def power(effect, parameters, **changes):
    (loss,) = effect.build(effect.Parameters(**parameters), MACHINE)
    return loss.power(SimpleNamespace(**{**vars(FIGURES), **changes}))


# ---- the stored oil ----


@pytest.mark.parametrize(("celsius", "printed"), [(40, 94.0), (60, 42.8), (80, 20.4), (100, 10.2)])
def test_the_stored_oil_has_the_viscosity_of_its_source(celsius, printed):
    oil, T = OILS["POE_ACD100FY"], celsius + 273.15
    found = 1e6 * oil.viscosity_at(T) / oil.density_at(T)
    assert found == pytest.approx(printed, rel=5e-3)  # printed to three digits; 10.15 stands as 10.2


# ---- drag ----


def test_drag_of_tips_is_couettes():
    """P = μ u² A/h: both rotors have the same tip speed ratio z1/z2, 4 and 6 lands."""
    male = 0.02 * (0.08 * 300.0) ** 2 * (4 * 3e-3 * 0.176) / 1e-4
    female = 0.02 * (0.08 * 200.0) ** 2 * (6 * 3e-3 * 0.176) / 1e-4
    assert power(oil_drag, LANDS) == pytest.approx(male + female, rel=1e-12)


def test_drag_of_an_end_face_is_the_integral_over_its_rings():
    """P = ∫ μ (ω r)² 2π r dr/h, by the midpoint rule on 10⁴ rings."""
    R, rings = 0.08, 10_000
    radii = [(i + 0.5) * R / rings for i in range(rings)]
    summed = sum((300.0 * r) ** 2 * 2.0 * math.pi * r * R / rings / 1e-4 for r in radii)
    assert oil_drag.end_drag(300.0, 2.0 * R, 1.0, 1e-4) == pytest.approx(summed, rel=1e-7)


def test_drag_goes_with_the_square_of_the_speed_and_the_inverse_of_the_gap():
    once = power(oil_drag, LANDS)
    assert power(oil_drag, LANDS, omega=600.0) == pytest.approx(4.0 * once, rel=1e-12)
    assert power(oil_drag, {**LANDS, "tip_gap": 2e-4}) == pytest.approx(0.5 * once, rel=1e-12)


@pytest.mark.parametrize("change", [{"tip_land": 0.0}, {"film_share": 0.0}])
def test_without_land_or_film_there_is_no_drag(change):
    assert power(oil_drag, {**LANDS, **change}) == 0.0


@pytest.mark.parametrize(
    ("stated", "out", "expected"), [(350.0, 330.0, 350.0), (None, 330.0, 320.0), (None, None, 310.0)]
)
def test_the_film_is_as_warm_as_stated_or_as_the_oil_in_the_mean(stated, out, expected):
    figures = SimpleNamespace(oil_temperature=310.0, oil_discharge_temperature=out)
    assert oil_drag.film_temperature(stated, figures) == expected


# ---- bearings ----


def test_simple_friction_is_half_of_coefficient_load_and_bore():
    moment = 0.5 * 0.0018 * 5e3 * 0.06  # loads 3 and 4 kN make 5 kN
    assert power(bearings, SIMPLE) == pytest.approx(moment * (300.0 + 200.0), rel=1e-12)


def test_a_female_rotor_without_load_adds_none():
    assert power(bearings, {**SIMPLE, "female_load": 0.0}) == pytest.approx(0.5 * 0.0018 * 5e3 * 0.06 * 300.0)


def test_idle_moment_is_palmgrens():
    """n = 3000 1/min, ν = 20 mm²/s, d_m = 85 mm, f_0 = 2: 1e-7 · 2 · 60 000^(2/3) · 85³ = 188.3 N mm."""
    found = bearings.idle_moment(3000.0 * math.pi / 30.0, 20e-6, 0.085, 2.0)
    assert found == pytest.approx(0.1882, rel=1e-3)


def test_idle_moment_is_continuous_where_its_rule_changes():
    """160e-7 f_0 d_m³ below ν n = 2000 of the source is 1e-7 · 2000^(2/3): 158.7, printed as 160."""
    speed = 2000.0 / 20.0 * math.pi / 30.0
    below, above = (bearings.idle_moment(speed * side, 20e-6, 0.085, 2.0) for side in (1 - 1e-9, 1 + 1e-9))
    assert below == pytest.approx(above, rel=1e-8)
    assert 1e4 * 1e3 * below / (2.0 * 85.0**3) * 1e3 == pytest.approx(160.0, rel=0.01)


def test_the_load_dependent_moment_is_that_of_the_load():
    idle = power(bearings, {**TWO_TERM, "radial_load": 0.0, "axial_load": 0.0})
    assert power(bearings, TWO_TERM) - idle == pytest.approx(4e-4 * 5e3 * 0.085 * 500.0, rel=1e-12)


# ---- motor ----


def electrical(shaft, omega=300.0, **parameters):
    (reading,) = motor.build(motor.Parameters(rated_power=1e5, **parameters), MACHINE)
    none = {"isothermal_efficiency": None, "isentropic_efficiency": 0.8, "cop": None, "heating_cop": None}
    given = reading.read(SimpleNamespace(shaft_power=shaft, motor_power=None, omega=omega, **none))
    found, notes = parted(effect_figures(given, "motor"))
    assert {name for name, value in found.items() if value is None} == set(notes) and all(notes.values())
    return found


def test_the_motor_has_its_efficiency_at_rated_power():
    found = electrical(1e5, efficiency=0.93)
    assert found["electrical_power"] == pytest.approx(1e5 / 0.93, rel=1e-12)
    assert found["motor_efficiency"] == pytest.approx(0.93, rel=1e-12)
    assert found["electrical_isentropic_efficiency"] == pytest.approx(0.8 * 0.93, rel=1e-12)


def test_the_loss_at_half_load_is_its_constant_share_and_a_quarter_of_the_rest():
    loss = electrical(5e4, efficiency=0.9, constant_share=0.4)["motor_loss"]
    assert loss == pytest.approx(1e5 * (1 / 0.9 - 1) * (0.4 + 0.6 / 4), rel=1e-12)


def test_efficiency_falls_at_part_load_and_an_ideal_motor_loses_nothing():
    assert electrical(2.5e4)["motor_efficiency"] < electrical(1e5)["motor_efficiency"]
    assert electrical(5e4, efficiency=1.0)["motor_loss"] == 0.0


def test_an_inverter_multiplies():
    with_it, without = (electrical(1e5, drive_efficiency=eta)["electrical_power"] for eta in (0.97, 1.0))
    assert with_it * 0.97 == pytest.approx(without, rel=1e-12)


def test_a_generator_gives_less_than_the_shaft():
    found = electrical(-5e4, drive_efficiency=0.97)
    assert -5e4 < found["electrical_power"] < 0.0
    assert 0.0 < found["motor_efficiency"] < 1.0
    assert found["electrical_power"] == pytest.approx(-5e4 + found["motor_loss"])


def test_a_shaft_that_idles_has_no_efficiency():
    assert electrical(0.0)["motor_efficiency"] is None
    assert electrical(-10.0)["motor_efficiency"] is None  # gives less than the motor loses


# ---- a motor's table ----


def table_of(tmp_path, *rows, head="load,efficiency"):
    path = tmp_path / "motor.csv"
    path.write_text("\n".join(["# efficiencies", head, *(f"{load},{efficiency}" for load, efficiency in rows)]))
    return str(path)


def test_a_table_gives_its_own_efficiencies(tmp_path):
    rows = [(0.25, 0.90), (0.5, 0.94), (0.75, 0.95), (1.0, 0.948)]
    name = table_of(tmp_path, *rows)
    for load, efficiency in rows:
        assert electrical(1e5 * load, efficiency_file=name)["motor_efficiency"] == pytest.approx(efficiency, rel=1e-12)
    ends = [electrical(1e5 * load, efficiency_file=name)["motor_loss"] for load in (0.05, 0.25)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)
    assert electrical(1.3e5, efficiency_file=name)["motor_efficiency"] == pytest.approx(0.948, rel=1e-12)


def test_a_table_of_the_formula_is_the_formula(tmp_path):
    loads = [0.1 + 0.02 * i for i in range(56)]
    rows = [(load, electrical(1e5 * load)["motor_efficiency"]) for load in loads]
    tabled = electrical(0.6543e5, efficiency_file=table_of(tmp_path, *rows))["motor_loss"]
    assert tabled == pytest.approx(electrical(0.6543e5)["motor_loss"], rel=1e-4)


@pytest.mark.parametrize(
    ("rows", "head", "words"),
    [
        ([(0.5, 0.9)], "load,efficiency", "two rows"),
        ([(0.5, 0.9), (0.4, 0.9)], "load,efficiency", "increasing"),
        ([(0.5, 90), (1.0, 95)], "load,efficiency", "shares, not percent"),
        ([(25, 0.9), (50, 0.93), (100, 0.95)], "load,efficiency", "a load of 100, above 3.5 times the rated power"),
        ([(0.5, 0.9), (math.nan, 0.9), (1.0, 0.9)], "load,efficiency", "increasing"),
        ([(0.5, 0.9), (math.inf, 0.9)], "load,efficiency", "increasing"),
        ([(0.5, 0.9), (1.0, 0.9)], "load,eta", "columns load and efficiency"),
    ],
)
def test_a_table_that_is_none_is_said(tmp_path, rows, head, words):
    motor_section = {"rated_power": "100 kW", "efficiency_file": table_of(tmp_path, *rows, head=head)}
    with pytest.raises(SceneError, match=words):
        make({"effects.motor": motor_section})
