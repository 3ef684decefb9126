"""Power losses and oil heat, from figures made up here."""

import math
from types import SimpleNamespace

import pytest
from folders import CONFIGS

from screwsim.build import build_parts
from screwsim.effects import hydromechanical, mechanical, oil_heat, oil_pump
from screwsim.effects.oil_pump import friction_factor
from screwsim.figures import called_for
from screwsim.inputs.faults import SceneError
from screwsim.scene import load
from screwsim.simulate import simulate

OF_THEORETICAL = "effects.mechanical.of=theoretical_power"
MACHINE = SimpleNamespace(lobes=4, swept_volume=1.692e-4, pitch=0.5 * math.pi)
FIGURES = SimpleNamespace(
    omega=300.0,
    tip_speed=24.0,
    indicated_power=5e4,
    oil_mass_flow=2.0,
    oil_volume_flow=2e-3,
    oil_temperature=330.0,
    film_viscosity_at=lambda T: 0.02,
    supply_viscosity=0.02,
    injection_pressure=2e5,
    delivery_pressure=12e5,
    oil_source_pressure=12e5,
)


def power(effect, parameters, **changes):
    (loss,) = effect.build(parameters, MACHINE)
    return loss.power(SimpleNamespace(**{**vars(FIGURES), **changes}))


def dragged_up(u, force):
    """Return the work [J] of a wall of speed u that drags a resting kilogram to its own speed with a force [N]."""
    slipping = u / force  # [s]
    return force * u * slipping


@pytest.mark.parametrize("force", [0.1, 10.0])
def test_acceleration_takes_what_a_moving_wall_gives_to_oil_that_it_drags_along(force):
    """Twice the kinetic energy, however long the oil slips."""
    taken = power(hydromechanical, hydromechanical.Parameters())
    assert taken == pytest.approx(2.0 * dragged_up(24.0, force), rel=1e-12)


def test_half_the_factor_is_the_kinetic_energy_of_the_tip():
    parameters = hydromechanical.Parameters(acceleration_factor=0.5)
    assert power(hydromechanical, parameters) == pytest.approx(0.5 * 2.0 * 24.0**2)


def test_giuffridas_viscous_term_is_the_one_he_gives():
    """676.8 cm³, 2900 rpm, 20 mPa s: 168 W."""
    parameters = hydromechanical.Parameters(acceleration_factor=0.0, viscous_coefficient=hydromechanical.GIUFFRIDA)
    assert power(hydromechanical, parameters, omega=303.687) == pytest.approx(168.0, abs=0.5)  # printed to 1 W


def test_a_pump_from_the_separator_pays_only_its_lines():
    parameters = oil_pump.Parameters(efficiency=0.5, pressure_loss=1e5)
    assert power(oil_pump, parameters) == pytest.approx(2e-3 * 1e5 / 0.5)


def test_a_pump_from_a_sump_pays_the_rise_too():
    parameters = oil_pump.Parameters(efficiency=0.5, pressure_loss=1e5)
    found = power(oil_pump, parameters, oil_source_pressure=1.5e5, delivery_pressure=2e5)
    assert found == pytest.approx(2e-3 * 1.5e5 / 0.5)


def test_a_pump_without_losses_from_the_separator_is_free():
    assert power(oil_pump, oil_pump.Parameters(efficiency=0.5)) == 0.0


@pytest.mark.parametrize("indicated", [5e4, -5e4])
def test_mechanical_loss_is_never_negative(indicated):
    assert power(mechanical, mechanical.Parameters(fraction=0.1), indicated_power=indicated) == pytest.approx(5e3)


def test_friction_of_the_theoretical_power_has_a_torque_that_no_slide_changes():
    """Of the displacement between the lines: ρ V_sw (h_2s − h_1) a pitch, twice the power at twice the speed (M460)."""
    stays = mechanical.Parameters(fraction=0.1, of=mechanical.THEORETICAL)
    known = {"theoretical_torque": lambda: 200.0}
    taken = [power(mechanical, stays, indicated_power=each, **known) for each in (5e4, 1e4)]
    assert taken == [pytest.approx(0.1 * 200.0 * 300.0)] * 2
    assert power(mechanical, stays, omega=600.0, **known) == pytest.approx(2.0 * taken[0])


def test_friction_at_a_mean_effective_pressure_takes_the_same_work_a_turn_whatever_the_gas_does():
    """Besides the share of the power; the pressure times the volume that is displaced in a turn (M461)."""
    rubs = mechanical.Parameters(fraction=0.1, mean_effective_pressure=3e4)
    displaced = 4 * 1.692e-4 * 300.0 / (2.0 * math.pi)  # [m³/s] of four lobes
    for indicated in (5e4, -5e4, 0.0):
        taken = power(mechanical, rubs, indicated_power=indicated)
        assert taken == pytest.approx(0.1 * abs(indicated) + 3e4 * displaced)
    assert power(mechanical, rubs, indicated_power=0.0, omega=600.0) == pytest.approx(2.0 * 3e4 * displaced)


@pytest.mark.parametrize("scene", ["r134a/point", "slider_crank/air"])
def test_the_mean_effective_pressure_of_friction_is_that_of_the_displaced_flow(scene):
    stated = "effects.mechanical={fraction: 0, mean_effective_pressure: 0.3 bar}"
    found = simulate(load(CONFIGS / f"{scene}.yaml", [stated, "numerics.error=none"]), trace=False).performance
    assert found.mechanical_power == pytest.approx(0.3e5 * found.displacement_flow, rel=1e-12)


@pytest.mark.parametrize("scene", ["r134a/point", "paper/point", "slider_crank/air"])
def test_the_theoretical_power_is_that_of_the_displacement_compressed_without_loss(scene):
    """As the isentropic efficiency counts it (M36), of all that is displaced in place of the flow."""
    stated = load(CONFIGS / f"{scene}.yaml", [OF_THEORETICAL, "numerics.error=none"])
    found, fraction = simulate(stated, trace=False).performance, stated.effects["mechanical"].parameters.fraction
    isentropic = found.shaft_power * found.isentropic_efficiency / found.volumetric_efficiency
    assert found.mechanical_power / fraction == pytest.approx(isentropic, rel=1e-6)


def test_an_expander_has_no_theoretical_power_of_what_it_displaces():
    with pytest.raises(
        SceneError, match=r"mechanical\.of: theoretical_power counts the whole displacement of a compressor"
    ):
        load(CONFIGS / "expander" / "point.yaml", [OF_THEORETICAL])


def test_heat_of_droplets_is_the_papers():
    """(1): 3 α/(r ρ) m_oil (T_oil − T): 1 kg of 1 mm drops at 100 W/m²K, 10 K warmer."""
    assert oil_heat.heat(300.0, 310.0, 1.0, 1e-3, 100.0, 1000.0) == pytest.approx(3000.0)


def test_heat_is_surface_times_coefficient_times_difference():
    r, alpha, rho, m = 5e-5, 500.0, 1000.0, 2e-3
    from math import pi

    droplets = m / (rho * 4 / 3 * pi * r**3)
    expected = alpha * droplets * 4 * pi * r**2 * 15.0
    assert oil_heat.heat(300.0, 315.0, m, r, alpha, rho) == pytest.approx(expected, rel=1e-13)


def test_no_heat_flows_at_one_temperature():
    assert oil_heat.heat(300.0, 300.0, 1.0, 1e-4, 500.0, 1000.0) == 0.0


# ---- oil line ----

LINE = {"length": 3.0, "diameter": 0.02}


def line_loss(**changes):
    parameters = oil_pump.Parameters(efficiency=0.5, pressure_loss=1e5, line=oil_pump.Line(**LINE))
    loss, reading = oil_pump.build(parameters, MACHINE)
    figures = SimpleNamespace(**{**vars(FIGURES), **changes})
    found = reading.read(figures)["oil_line_pressure_loss"]
    assert loss.power(figures) == pytest.approx(
        figures.oil_volume_flow * found / 0.5
    )  # from the separator it pays that
    return found - 1e5


def test_viscous_oil_in_a_pipe_loses_what_hagen_and_poiseuille_say():
    """8 μ L V̇/(π r⁴), in proportion to the viscosity: Re = 1273 at 0.1 Pa s."""
    for mu in (0.1, 0.2):
        assert line_loss(supply_viscosity=mu) == pytest.approx(8.0 * mu * 3.0 * 2e-3 / (math.pi * 0.01**4), rel=1e-12)


def test_thin_oil_loses_by_blasius():
    """ρ 1000, w 6.366 m/s, Re 63 662: f = 0.3164/Re^¼ = 0.019919."""
    assert line_loss(supply_viscosity=0.002) == pytest.approx(0.019919 * 150.0 * 0.5 * 1000.0 * 6.36620**2, rel=1e-4)


def test_the_friction_factor_is_continuous():
    for Re in (2000.0, 4000.0):
        assert friction_factor(Re * (1.0 - 1e-9)) == pytest.approx(friction_factor(Re * (1.0 + 1e-9)), rel=1e-6)


@pytest.mark.parametrize(("viscosity", "beyond"), [(0.1, False), (0.002, False), (0.0012, True)])
def test_a_flow_beyond_blasius_law_is_told(viscosity, beyond):
    """From Re = 1e5 on: 106 103 at 1.2 mPa s."""
    parameters = oil_pump.Parameters(efficiency=0.5, line=oil_pump.Line(**LINE))
    _, reading = oil_pump.build(parameters, MACHINE)
    why, warnings = reading.judge(SimpleNamespace(**{**vars(FIGURES), "supply_viscosity": viscosity}))
    assert why == ""
    assert [("is 106103" in line) for line in warnings] == [True] * beyond


def test_no_flow_loses_nothing_in_the_pipe():
    assert line_loss(oil_volume_flow=0.0, oil_mass_flow=0.0) == 0.0


def test_a_scene_without_a_line_has_no_figure_of_it():
    for change, there in (((), False), (("effects.oil_pump.line={length: 3 m, diameter: 20 mm}",), True)):
        scene = load(CONFIGS / "paper" / "point.yaml", change)
        assert (oil_pump.LOSS in called_for(scene, build_parts(scene))) is there
