"""Hard cases with effects on: gaps of three flow models, oil of a pump through a port, and the gas dissolved in it.

One structure, so that all of them share a compiled model; a case that changes the gas, the laws or the structure is
left out, and so is one whose lines or oil lie where nothing is known of the solubility.
"""

import math

import pytest
from hard_cases import CASES
from scenes import HELD_GAPS, balanced, make

from screwsim.inputs.faults import SceneError
from screwsim.simulate import simulate

ON = {
    **HELD_GAPS,
    "effects.oil_injection": {"opens": "365 deg", "closes": "455 deg"},
    "effects.refrigerant_solubility": {"separator_temperature": "366 K"},
}
STRUCTURE = (
    "gas",
    "effects",
    "machine.volume",
    "machine.suction_port",
    "machine.male_lobes",
    "numerics",
    "oil",
    "oil_supply",
)


def belongs(case):
    """Tell whether a case has the structure of these tests."""
    path_of = {path for path in case.changes if path in STRUCTURE or path.startswith(("gas.", "numerics."))}
    carried = case.changes.get("oil.transport") == "carried"
    return carried and not path_of and case.guess is None and case.status == "ok" and not case.name.startswith("found")


def scene_of(case):
    """Return the scene of a case with the effects; None where the effects do not cover its oil."""
    changes = {path: value for path, value in case.changes.items() if not path.endswith("_leakage.gap")}
    gaps = {path: value for path, value in case.changes.items() if path.endswith("_leakage.gap")}
    try:
        return make({**ON, **changes, **gaps})
    except SceneError as error:
        assert "solubility is known" in str(error)
        return None


CHOSEN = [case for case in CASES if belongs(case)]


@pytest.mark.slow
@pytest.mark.parametrize("case", CHOSEN, ids=lambda case: case.name)
def test_case_closes_with_effects_on(case):
    scene = scene_of(case)
    if scene is None:
        pytest.skip("oil colder or hotter than the solubility is known for")
    result = balanced(simulate(scene))
    assert all(math.isfinite(value) for value in result.performance.values() if value is not None)
    assert result.performance.flash_mass_flow >= 0.0


def test_there_are_enough_of_them():
    assert len(CHOSEN) > 20
    assert sum(scene_of(case) is not None for case in CHOSEN) > 18
