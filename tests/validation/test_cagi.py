"""The air package of validation/cagi: units, where verdicts turn, how its machine was made larger."""

from math import log

import pytest
from folders import CONFIGS, ROOT

import screwsim
from screwsim.effects.parts.rating import STANDARDS, isentropic_power
from screwsim.study.validation import NotRun, read_table

HERE = ROOT / "validation" / "cagi"
ROUND = ("flank_radius", "root_radius")
PRINTED = (19.3, 18.0, 17.7, 17.7, 17.8)  # kW/100 acfm, as the sheet has them, from the lowest flow on


@pytest.fixture(scope="module")
def cagi(compare_of):
    return compare_of("cagi")


@pytest.fixture(scope="module")
def sheet(cagi):
    return cagi.read_sheet(HERE)


def test_power_over_flow_is_what_the_sheet_prints(cagi, sheet):
    found = [sheet.specific(flow) / cagi.UNIT for flow in sheet.flow]
    assert [round(each, 1) for each in found] == list(PRINTED)


def test_the_sheet_beside_itself_holds_everywhere(cagi, sheet):
    bare = cagi.Curve(sheet.flow, [each - cagi.FAN for each in sheet.power], sheet.filled)
    size = cagi.size_row("itself", bare, sheet, "published")
    assert size.ours == pytest.approx(size.theirs, rel=1e-12)  # the fan that was taken off is added: rounding
    rows = cagi.shape_rows("itself", sheet, sheet, "published")
    assert [row.ours for row in rows] == [row.theirs for row in rows]
    assert len(rows) == 4


def test_a_fan_in_proportion_falls_out_and_one_at_constant_speed_does_not(cagi, sheet):
    low, full = sheet.flow[0], sheet.flow[-1]
    more = cagi.Curve(sheet.flow, [1.03 * each for each in sheet.power], sheet.filled)
    assert more.relative(low, full) == pytest.approx(sheet.relative(low, full), rel=1e-14)
    power = sheet.power[0] + cagi.FAN, sheet.power[-1] + cagi.FAN
    assert sheet.relative(low, full, cagi.FAN) == pytest.approx(power[0] / low / (power[1] / full), rel=1e-14)
    assert sheet.relative(low, full, cagi.FAN) > 1.05 * sheet.relative(low, full)


@pytest.mark.parametrize("factor", [0.9, 1.01])
def test_no_flow_is_looked_up_outside_the_sweep(cagi, sheet, factor):
    flow = sheet.flow[0] * factor if factor < 1.0 else sheet.flow[-1] * factor
    with pytest.raises(NotRun, match="no speed of the sweep"):
        sheet.at(sheet.power, flow)


def test_plausibility_turns_at_the_least_and_at_the_isothermal_efficiency(cagi, sheet):
    pressures, full = (1e5, 9.62e5), sheet.flow[-1]
    least = STANDARDS["variable", "air"].least(full)
    ideal = isentropic_power(full, *pressures)
    isothermal = pressures[0] * full * log(pressures[1] / pressures[0])

    def verdict(power):
        curve = cagi.Curve(sheet.flow, [power - cagi.FAN] * 5, sheet.filled)
        return cagi.regulation_row("x", curve, sheet, pressures, least).verdict

    found = [verdict(factor * power) for power in (ideal / least, isothermal) for factor in (1.01, 0.99)]
    assert found == ["fails", "holds", "holds", "fails"]


@pytest.fixture(scope="module")
def physics(cagi):
    return cagi.physics


def test_rotors_and_clearances_are_those_of_160_mm_made_larger(cagi, physics):
    small, large = (screwsim.load(path) for path in (CONFIGS / "rotors" / "b.yaml", HERE / "machine.yaml"))
    factor = physics.LARGER
    assert large.machine.rotor_diameter == pytest.approx(factor * small.machine.rotor_diameter)
    assert large.machine.rotor_length == pytest.approx(factor * small.machine.rotor_length)
    for name in ("centre_distance", "female_diameter", "male_tip_radius", "female_tip_radius", *ROUND):
        theirs, ours = (getattr(each.machine.profile, name) for each in (small, large))
        assert ours == pytest.approx(factor * theirs), name
    for gap in physics.GAPS:
        assert large.effects[gap].parameters.gap == pytest.approx(factor * physics.GAP)
    shafts, films = (large.effects[name].parameters for name in ("shaft_leakage", "oil_drag"))
    assert shafts.clearance == pytest.approx(factor * physics.CLEARANCE)
    assert (shafts.shaft_diameter, shafts.passage) == pytest.approx((factor * 70e-3, factor * 10e-3))
    assert (films.tip_gap, films.end_gap) == pytest.approx((factor * physics.GAP,) * 2)


@pytest.mark.slow
@pytest.mark.parametrize("condition", [(2, 45), (5, 35), (-10, 40)])
def test_sealed_shafts_leak_what_was_fitted_on_r134a(physics, condition):
    """At the points of the fit: 42 µm around two shafts of 70 mm, 10 mm deep, for 9.6 mm² as a nozzle; 0.15 points."""
    fitted = ROOT / "validation" / "bitzer" / "fitted" / "scene.yaml"
    rule = "model: oil_sealed, mixture_viscosity: mcadams, passage: 10 mm, area: null"
    sealed = f"effects.shaft_leakage={{shaft_diameter: 70 mm, clearance: {1e6 * physics.CLEARANCE:g} um, {rule}}}"
    which = ("evaporating", "condensing")
    at = [f"operation.{each}_temperature={T} degC" for each, T in zip(which, condition, strict=True)]
    found = [screwsim.simulate(screwsim.load(fitted, [*at, *more])) for more in ([], [sealed])]
    λ = [result.performance.volumetric_efficiency for result in found]
    assert λ[1] == pytest.approx(λ[0], abs=1.5e-3)


def test_the_motor_turns_against_a_torque_that_hardly_changes():
    """Six tenths of its loss stay, four tenths go with the speed to 1.5: the formula that motor.csv states."""
    for row in read_table(CONFIGS / "air" / "motor.csv"):
        x, efficiency = (float(row[name]) for name in ("load", "efficiency"))
        loss = (1.0 / 0.96 - 1.0) * (0.6 + 0.4 * x**1.5)
        assert efficiency == pytest.approx(x / (x + loss), abs=6e-6)


def test_tolerances_grow_more_slowly_than_lengths(physics):
    """ISO 286: i is 1.31 µm at 18 to 30 mm (geometric mean 23.2) and 2.17 at 80 to 120 mm (98)."""
    assert [round(1e6 * physics.tolerance(each), 2) for each in (0.0232379, 0.0979796)] == [1.31, 2.17]


def test_end_faces_have_the_middle_of_the_makers_limits_and_grow_in_proportion_beyond_them(physics):
    known = {160.0: 50.0, 200.0: 60.0, 250.0: 95.0, 320.0: 190.0}  # mm: µm, of limits 40-60, 50-70, 80-110, 170-210
    between = {240.0: 60.0 + 0.8 * 35.0, 80.0: 25.0, 640.0: 380.0}
    for diameter, clearance in (known | between).items():
        assert 1e6 * physics.end_clearance(1e-3 * diameter) == pytest.approx(clearance, rel=1e-12)


def test_every_piece_of_physics_is_a_scene_that_can_be(physics):
    for each in physics.variants(HERE, 3e4):
        screwsim.load(HERE / "machine.yaml", each.changes)


@pytest.mark.around
@pytest.mark.slow
def test_leaks_that_no_oil_seals_make_the_curve_steeper_and_a_loss_of_the_package_flatter(cagi, physics, sheet):
    low, full = sheet.flow[0], sheet.flow[-1]
    lost, file = (cagi.LOSS, 0.0), HERE / "machine.yaml"
    rough = ["numerics.accuracy=3e-3", "numerics.error=none"]
    others = physics.DRY, [physics.nozzle(22.5e-6)]
    own, dry, shafts = (cagi.swept(file, full, lost, [*rough, *each]) for each in ((), *others))
    lossless = cagi.swept(file, full, (0.0, 0.0), rough)
    assert min(dry.relative(low, full), shafts.relative(low, full)) > 1.05 * own.relative(low, full)
    assert lossless.relative(low, full) > own.relative(low, full)
    assert lossless.specific(full) < own.specific(full)
    assert list(own.flow) == sorted(own.flow)
