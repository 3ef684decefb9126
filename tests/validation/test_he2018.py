"""The air screw of validation/he2018: whose gaps and shafts it has, and what makes more oil fill it better."""

from itertools import pairwise

import pytest
from folders import ROOT

import screwsim

HERE = ROOT / "validation" / "he2018"
FLOWS = (27.0, 50.0)  # L/min
QUICK = ("numerics.error=none",)  # gains are held against limits, not against their errors


@pytest.fixture(scope="module")
def he(compare_of):
    return compare_of("he2018")


def test_gaps_and_shafts_are_those_of_the_machine_fitted_to_bitzer():
    """Both have rotors of 160 mm; the fit's 26.08 µm to its three digits, its shafts as validation/cagi reads them."""
    own, fitted, air = (
        screwsim.load(ROOT / "validation" / each)
        for each in ("he2018/machine.yaml", "bitzer/fitted/scene.yaml", "cagi/machine.yaml")
    )
    assert own.machine.rotor_diameter == fitted.machine.rotor_diameter
    for gap in ("tip_leakage", "interlobe_leakage", "end_face_leakage"):
        ours, theirs = own.effects[gap].parameters, fitted.effects[gap].parameters
        assert ours.gap == pytest.approx(theirs.gap, rel=2e-3)
        assert (ours.model, ours.mixture_viscosity, ours.passage) == (
            theirs.model,
            theirs.mixture_viscosity,
            pytest.approx(theirs.passage),
        )
    ours, larger = (each.effects["shaft_leakage"].parameters for each in (own, air))
    for length in ("shaft_diameter", "clearance", "passage"):
        assert getattr(larger, length) == pytest.approx(1.5 * getattr(ours, length))


def test_what_was_tried_are_scenes_that_can_be(he):
    for changes in he.TRIED.values():
        screwsim.load(HERE / "machine.yaml", changes)


def test_a_course_is_told_in_a_word(he):
    assert [he.course(values) for values in ([1, 2, 3], [3, 2, 1], [1, 2, 1])] == ["rises", "falls", "rises and falls"]


@pytest.mark.slow
def test_more_oil_fills_a_machine_better_whose_shafts_it_seals(he):
    """And not one without that leak, nor one with dry gaps, unless its oil is as cold as the gas."""

    def gain(name):
        changes = [*he.TRIED[name], *QUICK]
        at = [he.at(HERE / "machine.yaml", 2000.0, flow, changes).volumetric_efficiency for flow in FLOWS]
        return next(b - a for a, b in pairwise(at))

    assert gain("machine.yaml") > 0.01
    assert gain("machine.yaml, no shaft leak") < 0.0
    assert gain("machine.yaml, oil at the suction's closing") > 0.0
    assert gain("the same, oil as cold as the gas") > 0.0
