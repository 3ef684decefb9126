"""Paths of flow as figures name them."""

import numpy as np

from screwsim.report.trace import flow_paths

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
