"""Paths of flow as figures name them, and the pressures of the lines."""

from pathlib import Path

import numpy as np
import pytest

from screwsim.report.trace import chosen_trace, flow_paths, trace_of
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


def test_the_lines_of_a_stored_cycle_are_those_of_its_figures(tmp_path):
    """A package states its outlet; the machine delivers at a higher pressure, where its loop lies."""
    scene = load(PACKAGE)
    result = simulate(scene)
    save(tmp_path / "x.h5", scene, result)
    stored, own = chosen_trace(open_results(tmp_path / "x.h5")), trace_of(result)
    assert stored.pressures == pytest.approx(own.pressures)
    assert stored.pressures["$p_d$"] == pytest.approx(result.performance.discharge_pressure)
    assert stored.pressures["$p_d$"] > scene.operation.discharge.pressure
