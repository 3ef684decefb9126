"""A heat pump in TESPy with the exported compressor has our flow, power and heat at a point that was not fitted."""

import itertools
import warnings
from pathlib import Path

import numpy as np
import pytest

from screwsim.export.tespy import tespy_document
from screwsim.inputs.faults import UsageError
from screwsim.results import open_results
from screwsim.scene import load, with_values
from screwsim.simulate import simulate
from screwsim.study.sweep import run_sweep

pytestmark = pytest.mark.around
SCENE = Path(__file__).parents[2] / "configs" / "r134a" / "point.yaml"
T_E, T_C = -2.5, 42.0  # [°C] between the nodes


@pytest.fixture(scope="module")
def exported(swept_map):
    return tespy_document(swept_map)


def heat_pump(one, T_e, T_c):
    """Return compressor, evaporator, condenser and the temperature [K] behind the compressor of TESPy's heat pump."""
    with warnings.catch_warnings():  # here, as it takes seconds to import
        warnings.simplefilter("ignore")
        components = pytest.importorskip("tespy.components")
        from tespy.connections import Connection
        from tespy.networks import Network
    plant = Network(iterinfo=False)
    plant.units.set_defaults(pressure="bar", temperature="degC", temperature_difference="delta_degC")
    compressor = components.PolynomialCompressor("compressor")
    evaporator, condenser = (components.SimpleHeatExchanger(name) for name in ("evaporator", "condenser"))
    valve, cycle = components.Valve("valve"), components.CycleCloser("cycle")
    parts = (cycle, compressor, condenser, valve, evaporator, cycle)
    lines = [Connection(a, "out1", b, "in1") for a, b in itertools.pairwise(parts)]
    plant.add_conns(*lines)
    lines[0].set_attr(fluid={"R134a": 1}, T_dew=T_e, td_dew=10)
    lines[2].set_attr(T_bubble=T_c, x=0)
    for exchanger in (evaporator, condenser):
        exchanger.set_attr(dp=0)
    compressor.set_attr(**one["attributes"], frequency=one["frequency"])
    plant.solve("design")
    return lines[0].m.val_SI, compressor.P.val_SI, evaporator.Q.val_SI, -condenser.Q.val_SI, lines[1].T.val_SI


@pytest.mark.filterwarnings("ignore")
def test_a_heat_pump_is_at_our_point(exported):
    (one,) = exported["maps"]
    flow, power, cooling, _, leaving = heat_pump(one, T_E, T_C)
    scene = load(SCENE)
    at = {"operation.evaporating_temperature": T_E + 273.15, "operation.condensing_temperature": T_C + 273.15}
    ours = simulate(with_values(scene.without("motor"), at), trace=False).performance
    # the fits are within 0.5 % of their points (asserted below), the property calls are the same
    assert flow == pytest.approx(ours.gas_mass_flow, rel=0.002)
    assert power == pytest.approx(ours.shaft_power, rel=0.005)
    assert cooling == pytest.approx(ours.cooling_capacity, rel=0.003)
    assert one["leaves_at"] == "separator_temperature"
    assert leaving == pytest.approx(ours.separator_temperature, abs=0.5)  # of a constant share of heat
    assert max(one["largest_error"].values()) < 0.005


@pytest.mark.filterwarnings("ignore")
def test_what_one_share_of_heat_makes_is_told(tmp_path):
    """With cooled oil TESPy, at the corners of the map, is off by the errors told: there the share is extreme."""
    changes = [
        "effects.motor=off",
        "numerics.error=none",
        "sweep.operation.evaporating_temperature=[-10 degC, -5 degC, 0 degC, 5 degC]",
        "sweep.operation.condensing_temperature=[35 degC, 40 degC, 45 degC, 50 degC]",
    ]
    run_sweep(load(SCENE.with_name("separator.yaml"), changes), tmp_path / "map.h5", jobs=1)
    ours = open_results(tmp_path / "map.h5")
    (one,) = tespy_document(ours)["maps"]
    apart, off = [], []
    for T_e, T_c in one["envelope"]:
        there = np.isclose(ours.along("operation.evaporating_temperature"), T_e + 273.15)
        there &= np.isclose(ours.along("operation.condensing_temperature"), T_c + 273.15)
        *_, heat, leaving = heat_pump(one, T_e, T_c)
        apart.append(abs(leaving - ours.performance["separator_temperature"][there].item()))
        off.append(abs(heat / ours.performance["heating_capacity"][there].item() - 1.0))
    told = one["errors_by_dissipation_ratio"]
    assert max(apart) == pytest.approx(told["separator_temperature"], rel=0.02) and max(apart) > 2.0
    assert max(off) == pytest.approx(told["heating_capacity"], rel=0.02) and max(off) > 0.01


@pytest.mark.parametrize(
    ("change", "figure"),
    [
        ("effects.economizer={temperature: 18 degC, opens: 420 deg, closes: 520 deg, area: 1 cm^2}", "power"),
        ("effects.liquid_injection={opens: 500 deg, closes: 600 deg, area: 4 mm^2}", "the condenser"),
        ("gas.model=ideal", "power"),
    ],
)
def test_what_would_be_another_machine_there_is_refused(change, figure, tmp_path):
    """TESPy has ṁ w/η_s for the power and η_v ρ V n for the flow of one inlet, with the real fluid's w and ρ."""
    changes = [
        change,
        "numerics.error=none",
        "sweep.operation.evaporating_temperature=[-10 degC, -5 degC, 0 degC, 5 degC]",
        "sweep.operation.condensing_temperature=[35 degC, 40 degC, 45 degC, 50 degC]",
    ]
    run_sweep(load(SCENE, changes), tmp_path / "map.h5", jobs=1)
    with pytest.raises(UsageError, match=f"from one inlet, would be up to [0-9]+[.][0-9]% off in {figure}"):
        tespy_document(open_results(tmp_path / "map.h5"))


def test_gas_that_leaves_wet_is_refused_in_one_line(tmp_path):
    changes = [
        "effects.liquid_injection={opens: 420 deg, closes: 600 deg, area: 60 mm^2}",
        "gas.two_phase=equilibrium",
        "effects.separator=off",
        "oil_supply.temperature=40 degC",
        "numerics.error=none",
        "sweep.operation.evaporating_temperature=[-5 degC, 0 degC, 5 degC, 10 degC]",
        "sweep.operation.condensing_temperature=[35 degC, 38 degC, 42 degC, 45 degC]",
    ]
    run_sweep(load(SCENE, changes), tmp_path / "map.h5", jobs=1)
    with pytest.raises(UsageError, match="gas leaves wet, at 35 degC"):
        tespy_document(open_results(tmp_path / "map.h5"))
