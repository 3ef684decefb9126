"""Rules of offers: a slip of the keyboard is mended; a name that is another thing is not offered for an unknown one."""

from itertools import chain

import pytest
from each_row import each_row

from screwsim.effects import catalogue
from screwsim.inputs.suggestions import names_containing, nearest, paths_ending_in
from screwsim.outputs import PERFORMANCE
from screwsim.scene.fields import leaf_paths, unknown_key

PARAMETERS = {name: effect.parameters for name, effect in catalogue().items()}
LEAVES = leaf_paths(PARAMETERS)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("rotor_lenght", "rotor_length"),
        ("temprature", "temperature"),
        ("Blow-Hole", "blow_hole"),
        ("rael", "real"),
        ("isothermal_eficiency", "isothermal_efficiency"),
        ("operation.suction.temprature", "operation.suction.temperature"),
    ],
)
def test_a_slip_of_the_keyboard_is_mended(written, meant):
    options = [*PERFORMANCE, *LEAVES, *catalogue(), *(path.rpartition(".")[2] for path in LEAVES), "real", "ideal"]
    assert nearest(written, options) == meant


@each_row(
    ("written", "option"),
    [
        ("phi_D", "phi_A"),
        ("min", "max"),
        ("female_lobes", "male_lobes"),
        ("lobes", "male_lobes"),
        ("rodas5", "rodas4"),
        ("gas_torque_harmonic_5", "gas_torque_harmonic_4"),
        ("operation.discharge.superheat", "operation.suction.superheat"),
        ("discharge_plenum_presure", "suction_plenum_pressure"),
        ("evaporation_temperature", "condensing_temperature"),
        ("electrical_isentropic_efficiency", "electrical_isothermal_efficiency"),
    ],
)
def test_another_thing_is_not_offered(written, option):
    assert nearest(written, [option]) is None


def test_of_two_equally_near_none_is_offered():
    assert nearest("otor_inertia", ["motor_inertia", "rotor_inertia"]) is None


def test_no_name_that_a_scene_knows_is_mended_into_another():
    words = {path.rpartition(".")[2] for path in LEAVES}
    meant = {  # told where they belong
        ("fraction", "friction"),
        ("mode", "model"),
        ("motor_inertia", "rotor_inertia"),
        ("closing", "cooling"),
    }
    found = {tuple(sorted((word, near))) for word in words if (near := nearest(word, words - {word}))}
    assert found <= meant
    assert not [name for name in PERFORMANCE if nearest(name, set(PERFORMANCE) - {name})]
    choices = set(chain(*(leaf.limits["options"] for leaf in LEAVES.values() if leaf.kind == "choice")))
    assert not [name for name in choices if nearest(name, choices - {name})]


def test_a_key_is_found_where_it_belongs():
    assert paths_ending_in("speed", leaf_paths({})) == ["operation.speed"]
    assert paths_ending_in("suction.pressure", LEAVES) == ["operation.suction.pressure"]
    assert names_containing("lobes", ["male_lobes", "female_lobes", "kind"]) == ["male_lobes", "female_lobes"]


@each_row(
    ("name", "told"),
    [
        ("speed", "did you mean 'operation.speed'?"),
        ("model", "there are gas.model, "),
        ("operation.sped", "did you mean 'operation.speed'?"),
        ("effects.tip_leakage.fit", "there is effects.tip_leakage.friction_fit (write the whole name)"),
        (
            "effects.tip_leakage.friction",
            "there are effects.tip_leakage.friction_fit, effects.tip_leakage.mixture_friction (write the whole name)",
        ),
        ("effects.tip_leakage.xyz", "known there: flow_coefficient, "),
    ],
)
def test_a_path_is_told_where_its_key_belongs(name, told):
    assert told in unknown_key(name, leaf_paths({"tip_leakage": PARAMETERS["tip_leakage"]}), "a dotted path")
