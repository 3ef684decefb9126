"""The shipped R134a machines are such as machines on the market are, and say where what they take comes from."""

import pytest
from each_row import each_row
from folders import CONFIGS

from screwsim.scene import load
from screwsim.simulate import simulate

MACHINES = ("r134a/point.yaml", "r134a/compact.yaml", "control/point.yaml")
APART = {"r134a/point.yaml": 13.2, "r134a/compact.yaml": 9.0}  # K between gas and oil at the port; tests/plain: 17.7


@pytest.fixture(scope="module")
def found():
    return {name: simulate(load(CONFIGS / name), trace=False) for name in MACHINES}


@pytest.mark.parametrize("name", MACHINES)
def test_efficiencies_and_discharge_temperature_are_those_of_machines(found, name):
    """2/45 °C, 10 K superheat: volumetric 88 to 93.5 %, isentropic 70 to 77 %, mixture at discharge 60 to 80 °C."""
    assert found[name].status == "ok" and found[name].warnings == ()
    p = found[name].performance
    assert 0.88 <= p.volumetric_efficiency <= 0.935
    assert 0.70 <= p.isentropic_efficiency <= 0.77
    assert 333.15 <= p.mixture_discharge_temperature <= 353.15


def test_the_machine_by_the_papers_laws_does_what_the_one_with_rotors_does(found):
    one, other = (found[name].performance for name in MACHINES[:2])
    for figure in ("volumetric_efficiency", "isentropic_efficiency"):
        assert one[figure] == pytest.approx(other[figure], abs=0.01), figure
    assert one.mixture_discharge_temperature == pytest.approx(other.mixture_discharge_temperature, abs=1.0)


def test_both_state_the_same_but_for_rotors():
    one, other = (load(CONFIGS / name).effects for name in MACHINES[:2])
    assert one.keys() == other.keys()
    of_rotors = {"interlobe_leakage", "blow_hole", "end_face_leakage"}  # lengths and areas, which a profile gives
    assert {name for name in one if one[name] != other[name]} <= of_rotors


@pytest.mark.parametrize("name", MACHINES[:2])
def test_gas_and_oil_leave_an_uncooled_machine_close_together(found, name):
    p = found[name].performance
    assert p.discharge_temperature - p.oil_discharge_temperature == pytest.approx(APART[name], abs=0.5)
    gone = [f"effects.droplets.{each}=null" for each in ("orifice_diameter", "jet_pressure", "surface_tension")]
    mist = load(CONFIGS / name, [*gone, "effects.droplets.size=fixed", "effects.droplets.diameter=5 um"])
    p = simulate(mist, trace=False).performance
    assert p.discharge_temperature == pytest.approx(p.oil_discharge_temperature, abs=0.5)


@each_row("path", sorted((CONFIGS / "r134a").glob("*.yaml")), ids=lambda path: path.stem)
def test_droplets_are_those_of_a_jet_by_its_source(path):
    droplets = load(path).effects["droplets"].parameters
    assert (droplets.size, droplets.slip) == ("varde", 0.1)


def test_oil_takes_most_of_the_heat_where_it_is_cooled_and_plenty():
    """Ammonia with five kilograms of oil a kilogram of gas: half the shaft power, more with friction."""
    changes = ("gas.fluid=Ammonia", "gas.two_phase=equilibrium", "oil_supply.ratio=5", "oil_supply.temperature=60 degC")
    scene = load(CONFIGS / "r134a" / "point.yaml", [*changes, "effects.motor.rated_power=110 kW"])
    p = simulate(scene, trace=False).performance
    assert scene.oil is not None
    warmed = p.oil_mass_flow * scene.oil.heat_capacity * (p.oil_discharge_temperature - p.oil_supply_temperature)
    assert warmed > 0.4 * p.shaft_power
    assert 0.6 * p.shaft_power < p.oil_cooler_duty < p.shaft_power
    assert p.discharge_temperature - p.oil_discharge_temperature == pytest.approx(19.1, abs=0.5)  # K
