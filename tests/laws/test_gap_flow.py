"""Flow models of gaps in the cycle: both ways of closing agree, balances close, and each model vanishes."""

import pytest
from each_row import each_row
from scenes import CARRIED, FRICTION, HELD_GAPS, balanced, make, refusal, run

from screwsim.build import build_parts
from screwsim.explain import explain
from screwsim.fluid.gap_flow import flank_divisor, radial_divisor
from screwsim.model.compose import compose

FIGURES = ("gas_mass_flow", "shaft_power", "discharge_temperature", "trapped_mass")


def held(**changes):
    """Return HELD_GAPS with changes of `effects.<gap>.<parameter>` written gap__parameter."""
    return run({**HELD_GAPS, **{f"effects.{name.replace('__', '.')}": value for name, value in changes.items()}})


def test_mass_energy_and_entropy_close():
    balanced(held(), "oil_mass")


def test_coupled_chambers_agree_with_histories():
    together = run({**HELD_GAPS, "numerics": {"closing": "coupled", "error": "none"}}).performance
    for name in FIGURES:
        assert together[name] == pytest.approx(held().performance[name], rel=3e-4), name  # numerics.accuracy


def test_held_gaps_deliver_more_for_less():
    with_models, plain = held().performance, run(CARRIED).performance
    assert with_models.volumetric_efficiency > plain.volumetric_efficiency
    assert with_models.isentropic_efficiency > plain.isentropic_efficiency


def test_without_oil_and_depth_every_model_is_the_nozzle():
    """No oil: the mixture is gas; no depth: no friction of it; thin gas: no friction by the fits either."""
    thin = {"gas_viscosity": "1e-12 Pa s", "flow_coefficient": 0.7}
    changes = {
        "tip_leakage__passage": "1 nm",
        "end_face_leakage": {"gap": "1 mm", "length": "4 mm", "friction_fit": "radial", **FRICTION, **thin},
        "interlobe_leakage": {"gap": "10 mm", "length": "0.6 mm", "friction_fit": "flank", **FRICTION, **thin},
    }
    assert radial_divisor(1e9, 2e-3, 1e-3) < 1.0
    share = 1.0 / flank_divisor(1e9, 2e-3, 1e-2)  # M goes to 1.096 in a wide gap
    paths = {f"effects.{name.replace('__', '.')}": value for name, value in changes.items()}
    vanished = run({**HELD_GAPS, "oil_supply.ratio": 0, **paths})
    plain = run(
        {
            **CARRIED,
            "oil_supply.ratio": 0,
            "effects.tip_leakage": {"gap": "50 um", "reading": "interface"},
            "effects.end_face_leakage": {"gap": "1 mm", "length": "4 mm"},
            "effects.interlobe_leakage": {"gap": "10 mm", "length": "0.6 mm", "flow_coefficient": 0.7 * share},
        }
    )
    for name in FIGURES:
        assert vanished.performance[name] == pytest.approx(plain.performance[name], rel=3e-4), name


def test_a_gap_that_keeps_the_nozzle_keeps_its_text():
    named = {f"effects.{name}_leakage.model": "nozzle" for name in ("tip", "interlobe", "end_face")}
    one, other = (compose(build_parts(make(changes))) for changes in (named, {}))
    assert one.text == other.text
    assert (one.P == other.P).all()
    assert "gap_share" not in one.text


@each_row("ratio", [0.5, 3.0])
def test_oil_in_the_blow_hole_slows_the_gas_by_its_inertia(ratio):
    """M192 without depth: where oil takes no room, the gas flow is that of an area S/√(1 + x), x the chamber's oil."""
    alike = {**CARRIED, "oil_supply.ratio": ratio, "effects.suction_line": {}, "oil_supply.kind": "pump"}
    mixed = run({**alike, "effects.blow_hole.model": "homogeneous"})
    smaller = run({**alike, "effects.blow_hole.flow_coefficient": 0.7 / (1.0 + ratio) ** 0.5})
    plain = run(alike)
    for name in FIGURES:
        # x differs from d by what leaks bring along
        moved = abs(smaller.performance[name] - plain.performance[name])
        assert abs(mixed.performance[name] - smaller.performance[name]) < 0.1 * moved, name


def test_turbulent_friction_holds_back_thin_mixtures_alone():
    """By McAdams' viscosity the mixture is thin and fast; by Cicchitti's it creeps, and laminar friction is larger."""
    for rule in ("mcadams", "cicchitti"):
        laminar, turbulent = (
            held(tip_leakage__mixture_viscosity=rule, **more).performance.isentropic_efficiency
            for more in ({}, {"tip_leakage__mixture_friction": "blasius"})
        )
        assert turbulent > laminar + 1e-3 if rule == "mcadams" else turbulent == laminar


def test_explain_names_the_model_of_each_gap():
    text = " ".join(str(explain(make(HELD_GAPS))).split())
    assert "mixture of gas and oil, viscosity by cicchitti (M192, M193)" in text
    assert "friction by Bell et al., flank fit (M191)" in text
    turbulent = str(explain(make({**HELD_GAPS, "effects.tip_leakage.mixture_friction": "blasius"})))
    assert "viscosity by cicchitti, friction by blasius (M192, M193)" in " ".join(turbulent.split())
    assert "friction" not in str(explain(make())).partition("Flow paths")[2].partition("Gas")[0]


@each_row(
    ("changes", "words"),
    [
        ({"effects.tip_leakage.passage": "2 mm"}, "effects.tip_leakage.passage: has no meaning with model: nozzle"),
        ({"effects.tip_leakage.model": "nozzle_friction"}, "effects.tip_leakage.passage: is missing"),
        ({**HELD_GAPS, "effects.tip_leakage.friction_fit": "radial"}, "has no meaning with model: oil_sealed"),
        ({"effects.tip_leakage.mixture_friction": "blasius"}, "mixture_friction: has no meaning with model: nozzle"),
        ({**HELD_GAPS, "oil.transport": "paper"}, "oil_sealed needs oil.transport: carried"),
        ({"effects.blow_hole.model": "oil_sealed"}, "is not an option (choose from: nozzle, homogeneous)"),
        ({"effects.blow_hole.model": "homogeneous"}, "homogeneous needs oil.transport: carried"),
    ],
)
def test_what_does_not_go_together_is_said(changes, words):
    assert words in refusal(changes)
