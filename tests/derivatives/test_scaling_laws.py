"""Derivatives obey the laws of scaling of the equations, exactly: Euler's theorem on homogeneous functions."""

from pathlib import Path

import pytest
from each_row import each_row

import screwsim
from screwsim.study.uncertainty.point import sensitivities

CONFIGS = Path(__file__).parents[2] / "configs"
R134A = Path(__file__).parents[1] / "plain" / "r134a.yaml"
CLOSE = 1e-4  # the figures of the run, over which slopes are taken, err by up to that; the slopes' own sums by 1e-7
PRESSURES = ("operation.suction.pressure", "operation.discharge.pressure")
LOSSES = ("oil_pump", "hydromechanical", "mechanical")  # powers of their own


@pytest.fixture(scope="module", params=["histories", "coupled"])
def found(request):
    """Return the derivatives of the paper's machine without its losses, its cycle closed either way."""
    way = [f"numerics.closing={request.param}"]
    return sensitivities(screwsim.load(CONFIGS / "paper" / "point.yaml", way, LOSSES))


def together(found, figure, paths):
    """Return the change of a figure, in percent per percent of all the numbers at once."""
    return sum(found.relative(figure, path) for path in paths)


def openings(found):
    """Return the paths of all flow coefficients."""
    return [path for path in found.values if path.endswith(".flow_coefficient")]


@each_row(
    ("figure", "power"),
    [("gas_mass_flow", 1), ("work_per_cycle", 1), ("oil_lift_power", 2), ("discharge_temperature", 0)],
)
def test_an_ideal_gas_at_all_pressures_times_a_factor_flows_and_works_as_much_more(found, figure, power):
    assert together(found, figure, PRESSURES) == pytest.approx(power, abs=CLOSE)


@each_row(
    ("figure", "power"),
    [("gas_mass_flow", 1), ("indicated_power", 1), ("work_per_cycle", 0), ("volumetric_efficiency", 0)],
)
def test_a_machine_as_much_faster_as_all_its_rates_makes_the_same_cycle(found, figure, power):
    rates = ["operation.speed", "effects.oil_heat.heat_transfer_coefficient", *openings(found)]
    assert together(found, figure, rates) == pytest.approx(power, abs=CLOSE)


@each_row(("figure", "power"), [("gas_mass_flow", 1), ("shaft_power", 1), ("discharge_temperature", 0)])
def test_a_machine_as_much_larger_as_all_its_openings_gives_as_much_more(found, figure, power):
    assert together(found, figure, ["machine.volume.max", *openings(found)]) == pytest.approx(power, abs=CLOSE)


def test_a_gap_and_its_flow_coefficient_are_one_factor_of_its_flow(found):
    tip = "effects.tip_leakage"
    slopes = [found.relative("gas_mass_flow", f"{tip}.{name}") for name in ("gap", "flow_coefficient")]
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-5)  # differences of composed numbers: a millionth


def test_every_number_of_the_scene_has_its_derivative_and_is_told_to_be_exact(found):
    assert set(found.method.values()) == {"exact"}
    assert set(found.values) == set(found.derivatives["shaft_power"])
    assert found.left_out["machine.male_lobes"] == "a whole number"


@pytest.mark.parametrize("fine", [True, False])
def test_the_heat_of_insulated_walls_is_none_whatever_the_numbers_and_else_what_cools_them(fine):
    """What is found there are digits of rounding, up to 4e-8 of the shaft power by a whole number."""
    walls = {"rotor_area": "300 cm^2", "housing_area": "200 cm^2", "characteristic_length": "40 mm"}
    scene = screwsim.load(R134A).with_({"effects.wall_heat": walls})
    cooling = "effects.wall_heat.rotor_cooling"
    paths = ["operation.speed", "operation.evaporating_temperature", "effects.tip_leakage.gap", cooling]
    found = sensitivities(scene, [*paths, "effects.wall_heat.nusselt_factor"], fine=fine)
    slopes = dict(found.derivatives["wall_heat"])
    assert slopes.pop(cooling) == pytest.approx(-1.0, rel=1e-3)
    assert set(slopes.values()) == {0.0}
    assert all(found.derivatives["shaft_power"][path] for path in paths)
