"""Walls that exchange heat with the gas: balances, temperatures, the limit, the sign; gaps of warm parts."""

import pytest
from known_figures import known_solution
from scenes import CARRIED, FILMS, HELD_GAPS, RADAU, change, make, run

from screwsim.effects.wall_heat import coefficient
from screwsim.explain import explain
from screwsim.inputs.faults import SceneError
from screwsim.scene import loads

ACCURACY = 3e-4
SIZE = {"rotor_area": "400 cm^2", "housing_area": "150 cm^2", "characteristic_length": "58 mm"}
WALLS = {**CARRIED, "effects.wall_heat": SIZE}
BALANCES = ("mass", "energy", "entropy", "oil_mass")


def walls(**changes):
    return {**WALLS, "effects.wall_heat": {**SIZE, **changes}}


def assert_closed(result):
    assert result.status == "ok"
    names = BALANCES if result.performance.oil_mass_flow else BALANCES[:-1]  # of no oil the residual is one of nothing
    assert max(result.balance[name] for name in names) <= ACCURACY


@pytest.mark.parametrize(
    "changes",
    [{}, {"operation.speed": "500 rpm"}, {"numerics": {"closing": "coupled"}}, {"oil_supply.ratio": 0}],
    ids=["", "slow", "coupled", "dry"],
)
def test_mass_energy_entropy_and_oil_are_kept(changes):
    result = run({**WALLS, **changes})
    assert_closed(result)
    assert abs(result.ledger.relative_residue) <= ACCURACY


def test_walls_that_are_not_cooled_take_nothing_over_a_cycle():
    result = run(WALLS)
    p = result.performance
    assert abs(p.wall_heat_power) < ACCURACY * p.shaft_power
    assert p.suction_temperature < p.rotor_temperature < p.discharge_temperature
    assert result.ledger.exergy_destroyed_wall_heat > 0.0


def test_heat_goes_from_compression_to_suction():
    """Gas that is warmed as it is sucked in fills less, gas that is cooled as it is compressed stays cooler."""
    with_walls, without = run(WALLS).performance, run(CARRIED).performance
    assert with_walls.volumetric_efficiency < without.volumetric_efficiency
    assert with_walls.trapped_mass < without.trapped_mass


def test_cooling_is_what_the_walls_take():
    result, warm = run(walls(housing_cooling="200 W")), run(WALLS)
    p = result.performance
    assert p.wall_heat_power == pytest.approx(-200.0, abs=ACCURACY * p.shaft_power)
    assert p.housing_temperature < warm.performance.housing_temperature
    assert max(result.balance[name] for name in BALANCES) <= ACCURACY


def test_a_stated_temperature_is_kept():
    result = run(walls(rotor_temperature="350 K"))
    assert result.performance.rotor_temperature == pytest.approx(350.0, rel=1e-12)
    assert result.performance.wall_heat_power > 0.0
    assert max(result.balance[name] for name in BALANCES) <= ACCURACY


@pytest.mark.parametrize("none", [{"nusselt_factor": 0}, {"rotor_area": "0 m^2", "housing_area": "0 m^2"}], ids=str)
def test_without_transfer_nothing_changes(none):
    assert change(run(walls(**none)), run(CARRIED)) < ACCURACY


def test_both_closings_find_one_cycle():
    assert change(run(WALLS), run({**WALLS, "numerics": {"closing": "coupled"}})) < ACCURACY


@pytest.mark.slow
def test_radau_finds_the_same():
    assert change(run(WALLS), known_solution(make({**WALLS, "numerics": RADAU}))) < ACCURACY


def test_the_coefficient_is_that_of_the_correlation():
    """Nu = 0.023 Re^0.8 at Re = 10⁶ is 1451."""
    assert coefficient(20.0, 25.0, 0.024, 0.023, 0.024, 12e-6) == pytest.approx(1451.0, rel=1e-3)


def test_walls_may_be_far_better_conductors_than_any():
    """A hundred times the correlation's: gas and walls all but share their temperature; the cycle still closes."""
    result = run(walls(nusselt_factor=2.3))
    assert_closed(result)


def test_more_cooling_than_the_gas_can_give_fails_with_a_remedy():
    result = run(walls(rotor_cooling="200 kW", nusselt_factor=0.0001))
    assert result.status == "failed"
    assert "smaller effects.wall_heat.rotor_cooling" in result.message


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rotor_cooling": "1 W", "rotor_temperature": "300 K"}, "as well as rotor_temperature"),
        ({"rotor_cooling": "1 W", "nusselt_factor": 0}, "no gas warms"),
        ({"gas_viscosity": "12 uPa s"}, "gas_conductivity, gas_viscosity"),
        ({"reference_pressure": "2 bar"}, "reference_temperature"),
    ],
)
def test_contradictions_are_faults(changes, words):
    with pytest.raises(SceneError, match=words):
        make(walls(**changes))


def test_explain_and_the_scenes_text_tell_of_it():
    scene = make(WALLS)
    text = " ".join(str(explain(scene)).split())
    assert "heat between gas and rotor" in text
    assert "housing temperature, found with the cycle" in text
    assert loads(scene.text).text == scene.text


# ---- clearances ----------------------------------------------------------------------------------------------------

WARM = {"axis_distance": "125 mm", "rotor_temperature": "330 K", "housing_temperature": "320 K"}
GAPS = {**CARRIED, "effects.thermal_clearances": WARM}
BOTH = {**WALLS, "effects.thermal_clearances": {"axis_distance": "125 mm"}}


def test_gaps_are_those_of_linear_expansion():
    """At 330 and 320 K against 293.15 K: γ = 10.5e-6 · 26.85 − 11.5e-6 · 36.85 = −1.4185e-4, over 80 and 125 mm."""
    p = run(GAPS).performance
    assert p.tip_gap == pytest.approx(50e-6 - 11.348e-6, rel=1e-4)
    assert p.interlobe_gap == pytest.approx(40e-6 - 17.731e-6, rel=1e-4)
    assert p.end_face_gap == pytest.approx(50e-6, rel=1e-12)  # no bearing distance


@pytest.mark.parametrize(("end", "grown"), [("discharge", -1.0), ("suction", 1.0)])
def test_rotors_grow_away_from_their_thrust_bearing(end, grown):
    """Bearing at 0: end face and wall of the discharge end, which is 60 mm behind or 300 mm ahead of the bearing."""
    length = 0.06 if end == "discharge" else 0.3
    held = {"thrust_bearing": end, "bearing_distance": f"{length} m"}
    gap = run({**GAPS, "effects.thermal_clearances": {**WARM, **held}}).performance.end_face_gap
    face, wall = (length * (1.0 + each) for each in (11.5e-6 * 36.85, 10.5e-6 * 26.85))  # from the bearing, warm
    assert gap == pytest.approx(50e-6 + grown * (wall - face), rel=1e-6)
    assert (gap > 50e-6) == (end == "discharge")  # the rotors are the warmer part


def test_a_bearing_behind_the_suction_end_is_beyond_the_rotors():
    inside = {"thrust_bearing": "suction", "bearing_distance": "50 mm"}
    with pytest.raises(SceneError, match="bearing_distance: 50 mm: a thrust bearing behind"):
        run({**GAPS, "effects.thermal_clearances": {**WARM, **inside}})


def test_a_warm_gap_is_a_narrower_gap():
    """The machine whose gaps are stated as narrow as the warm ones."""
    p = run(GAPS).performance
    stated = {"effects.tip_leakage.gap": f"{p.tip_gap} m", "effects.interlobe_leakage.gap": f"{p.interlobe_gap} m"}
    assert change(run(GAPS), run({**CARRIED, **stated})) < ACCURACY
    assert p.volumetric_efficiency > run(CARRIED).performance.volumetric_efficiency


@pytest.mark.parametrize("models", [HELD_GAPS, FILMS], ids=["friction and seal", "films"])
def test_what_holds_back_in_a_warm_gap_is_that_of_the_narrower_gap(models):
    """Where the share hangs on the clearance: the machine whose gaps are stated as narrow as the warm ones."""
    warm = run({**models, "effects.thermal_clearances": WARM})
    p = warm.performance
    stated = {"effects.tip_leakage.gap": f"{p.tip_gap} m", "effects.interlobe_leakage.gap": f"{p.interlobe_gap} m"}
    assert change(warm, run({**models, **stated})) < ACCURACY
    assert max(warm.balance[name] for name in BALANCES) <= ACCURACY


def test_the_oil_in_a_warm_gap_is_dragged_as_in_the_narrower_gap():
    """M141, M142 at one film temperature: of the tips 1/h, of the end faces, which keep their gap, the same."""
    tips = {"tip_gap": "50 um", "tip_land": "3 mm", "film_temperature": "320 K"}
    drag = {**tips, "end_gap": "50 um", "end_solidity": 0.6}
    cold, both = (run({**CARRIED, "effects.oil_drag": one}).performance.oil_drag_power for one in (tips, drag))
    warm = run({**GAPS, "effects.oil_drag": drag}).performance
    assert warm.oil_drag_power == pytest.approx(cold * 50e-6 / warm.tip_gap + both - cold, rel=1e-6)


@pytest.mark.parametrize(
    "none",
    [
        {"rotor_expansion": "0 1/K", "housing_expansion": "0 1/K"},
        {"rotor_temperature": "293.15 K", "housing_temperature": "293.15 K"},
    ],
    ids=["no expansion", "cold"],
)
def test_without_expansion_nothing_changes(none):
    assert change(run({**GAPS, "effects.thermal_clearances": {**WARM, **none}}), run(CARRIED)) < ACCURACY


@pytest.mark.slow
def test_walls_and_gaps_settle_together():
    result = run(BOTH)
    p = result.performance
    assert_closed(result)
    assert abs(p.wall_heat_power) < ACCURACY * p.shaft_power
    growth = 10.5e-6 * (p.housing_temperature - 293.15) - 11.5e-6 * (p.rotor_temperature - 293.15)
    assert p.tip_gap == pytest.approx(50e-6 + 0.08 * growth, rel=1e-6)
    assert change(result, run({**BOTH, "numerics": {"closing": "coupled", "error": "none"}})) < ACCURACY


def test_rotors_that_touch_fail_with_a_remedy():
    result = run({**GAPS, "effects.thermal_clearances": {**WARM, "rotor_temperature": "450 K"}})
    assert result.status == "failed"
    assert "warm rotors touch" in result.message


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({**CARRIED, "effects.thermal_clearances": {"axis_distance": "125 mm"}}, "rotor_temperature: is missing"),
        ({**WALLS, "effects.thermal_clearances": WARM}, "as well as effects.wall_heat"),
        ({**GAPS, "effects.thermal_clearances": {**WARM, "axis_distance": None}}, "axis_distance: is missing"),
        (
            {**GAPS, "effects.thermal_clearances": {**WARM, "thrust_bearing": "suction"}},
            "bearing_distance: 0 mm: a thrust bearing",
        ),
    ],
)
def test_contradicting_clearances_are_faults(changes, words):
    with pytest.raises(SceneError, match=words):
        make(changes)
