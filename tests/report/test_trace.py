"""Paths of flow as figures name them, and the pressures of the lines."""

from pathlib import Path

import numpy as np
import pytest

from screwsim.report.trace import Trace, chosen_trace, flow_paths, temperature_limits, trace_of
from screwsim.results import open_results, save
from screwsim.scene import load
from screwsim.simulate import simulate

PACKAGE = Path(__file__).parents[2] / "configs" / "air" / "fixed_speed_7.yaml"

FLOW = np.array([0.0, 1e-3])


def paths(*effects: str) -> dict[str, dict[str, str]]:
    return flow_paths({f"mass_flow_{effect}": FLOW for effect in effects})


def test_an_own_effect_is_named_without_its_package():
    assert list(paths("suction_port", "my.slot_leak")) == ["suction port", "slot leak"]


def test_two_effects_of_the_same_words_are_two_paths():
    leaks = ("blow_hole_leading", "blow_hole_trailing", "my.blow_hole_leading", "my.blow_hole_trailing")
    assert paths(*leaks, "discharge_port", "suction_port") == {
        "suction port": {"": "mass_flow_suction_port"},
        "discharge port": {"": "mass_flow_discharge_port"},
        "blow_hole": {"leading": "mass_flow_blow_hole_leading", "trailing": "mass_flow_blow_hole_trailing"},
        "my.blow_hole": {"leading": "mass_flow_my.blow_hole_leading", "trailing": "mass_flow_my.blow_hole_trailing"},
    }


@pytest.mark.parametrize(
    ("gas", "limits"),
    [
        ([230.0, 280.0, 290.0, 300.0], (280.0, 300.0, 230.0)),  # far below, of a chamber with hardly any gas
        ([400.0, 280.0, 290.0, 300.0], (280.0, 300.0, 400.0)),
        ([278.0, 280.0, 290.0, 300.0], (280.0, 300.0, None)),  # near: the axis has room for it
    ],
)
def test_the_gas_of_a_nearly_empty_chamber_does_not_set_the_axis_of_temperatures(gas, limits):
    values = {"gas_mass": np.array([1e-6, 1.0, 1.0, 1.0]), "gas_temperature": np.array(gas)}
    assert temperature_limits(Trace("", np.arange(4.0), values, {}, {})) == limits


def test_warm_oil_belongs_to_the_axis_of_temperatures():
    values = {"gas_mass": np.ones(3), "gas_temperature": np.array([280.0, 290.0, 300.0])}
    values["oil_temperature"] = np.array([np.nan, 330.0, 320.0])
    assert temperature_limits(Trace("", np.arange(3.0), values, {}, {})) == (280.0, 330.0, None)


def test_the_lines_of_a_stored_cycle_are_those_of_its_figures(tmp_path):
    """A package states its outlet; the machine delivers at a higher pressure, where its loop lies."""
    scene = load(PACKAGE)
    result = simulate(scene)
    save(tmp_path / "x.h5", scene, result)
    stored, own = chosen_trace(open_results(tmp_path / "x.h5")), trace_of(result)
    assert stored.pressures == pytest.approx(own.pressures)
    assert stored.pressures["$p_d$"] == pytest.approx(result.performance.discharge_pressure)
    assert stored.pressures["$p_d$"] > scene.operation.discharge.pressure
