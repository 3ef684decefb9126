"""An inverter and the motor behind it: each loss against a sum by hand, a maker's points, and what is refused."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

import screwsim
from screwsim.effects import motor
from screwsim.effects.base import SuctionHeat
from screwsim.effects.parts import inverter
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.scene import scene_text, with_values

RATED, SPEED, LOSS = 1e5, 300.0, 3000.0  # [W, rad/s, W]
DRIVE = inverter.Inverter(rated_speed=SPEED, loss=LOSS, harmonic_loss=0.0)
POINTS = [(0, 0.25), (0, 0.5), (0, 1), (0.5, 0.25), (0.5, 0.5), (0.5, 1), (0.9, 0.5), (0.9, 1)]  # IEC 61800-9-2
POINT = Path(__file__).parents[2] / "configs" / "air" / "fixed_speed_7.yaml"


def losses(power, omega, drive=DRIVE, **motors):
    """Return what the motor loses and what its inverter does."""
    stated = motor.Parameters(rated_power=RATED, efficiency=0.95, inverter=drive, **motors)
    own, both = motor.losses_of(stated)(power, omega)
    return own, both - own


def test_at_the_point_of_its_class_an_inverter_loses_what_is_stated():
    """90 % of the frequency, all of the current: 90 % of the power."""
    assert losses(0.9 * RATED, 0.9 * SPEED)[1] == pytest.approx(LOSS, rel=1e-9)


def test_at_constant_torque_and_a_third_of_the_speed_most_of_the_loss_stays():
    """ℓ (0.3 + 0.4 + 0.3 · 0.3/0.9) = 0.8 ℓ, where a constant efficiency would leave a third."""
    assert losses(0.3 * RATED, 0.3 * SPEED)[1] == pytest.approx(0.8 * LOSS, rel=1e-9)


def test_without_load_the_standing_loss_is_left():
    assert losses(0.0, SPEED)[1] == pytest.approx(0.3 * LOSS, rel=1e-9)


def test_at_rated_speed_a_motor_on_a_sine_loses_what_it_does_on_the_mains():
    mains = motor.losses_of(motor.Parameters(rated_power=RATED, efficiency=0.95))
    for load in (0.25, 0.5, 1.0, 1.2):
        assert losses(load * RATED, SPEED)[0] == pytest.approx(mains(load * RATED, SPEED)[0], rel=1e-12)


def test_copper_follows_the_torque_and_iron_the_speed():
    """At half speed and full torque: rated loss times 0.6 + 0.4 · 0.5^1.5, and r more."""
    rated = RATED * (1 / 0.95 - 1)
    assert losses(0.5 * RATED, 0.5 * SPEED)[0] == pytest.approx(rated * (0.6 + 0.4 * 0.5**1.5), rel=1e-12)
    drive = inverter.Inverter(rated_speed=SPEED, loss=LOSS, harmonic_loss=0.15)
    assert losses(RATED, SPEED, drive)[0] == pytest.approx(1.15 * rated, rel=1e-12)


@pytest.mark.parametrize(("rated", "more"), [(15e3, 0.15), (90e3, 0.15), (110e3, 0.25), (400e3, 0.25)])
def test_what_an_inverter_adds_to_a_motors_loss_goes_by_its_size(rated, more):
    drive = inverter.Inverter(rated_speed=SPEED, loss=LOSS)
    own = motor.losses_of(motor.Parameters(rated_power=rated, efficiency=0.95, inverter=drive))(rated, SPEED)[0]
    assert own == pytest.approx((1.0 + more) * rated * (1 / 0.95 - 1), rel=1e-12)


def test_an_added_loss_that_is_stated_stays_with_any_size():
    drive = inverter.Inverter(rated_speed=SPEED, loss=LOSS, harmonic_loss=0.15)
    assert motor.Parameters(rated_power=400e3, inverter=drive).inverter == drive


def test_the_added_loss_follows_a_rated_power_that_is_changed():
    stated = "effects.motor={rated_power: 75 kW, efficiency: 0.95, inverter: {rated_speed: 3000 rpm, loss: 2 kW}}"
    small = screwsim.load(POINT, [stated])
    large = screwsim.load(POINT, [stated, "effects.motor.rated_power=132 kW"])
    assert (harmonic(small), harmonic(large)) == (0.15, 0.25)
    assert "harmonic_loss" not in scene_text(large)
    assert harmonic(with_values(small, {"effects.motor.rated_power": 132e3})) == 0.25


def test_a_motor_of_a_standard_size_has_no_step_in_its_derivatives():
    """Differences over a rated power of 90 kW met the step to the larger ones: 35 kW of power per watt."""
    stated = "{rated_power: 90 kW, efficiency: 0.95, inverter: {rated_speed: 3000 rpm, loss: 2 kW}}"
    path, figure = "effects.motor.rated_power", "electrical_power"
    found = screwsim.sensitivities(screwsim.load(POINT, [f"effects.motor={stated}"]), [path], [figure])
    assert abs(found.relative(figure, path)) < 0.1


def harmonic(scene):
    return scene.effects["motor"].parameters.inverter.harmonic_loss


def test_a_generator_loses_as_much():
    assert losses(-5e4, 200.0) == pytest.approx(losses(5e4, 200.0), rel=1e-12)


def test_a_table_of_the_motor_is_kept_and_loses_more_on_an_inverter(tmp_path):
    table = tmp_path / "motor.csv"
    table.write_text("load,efficiency\n0.5,0.94\n1,0.95\n")
    drive = inverter.Inverter(rated_speed=SPEED, loss=LOSS, harmonic_loss=0.2)
    found = losses(0.5 * RATED, 0.5 * SPEED, drive, efficiency_file=str(table))[0]
    assert found == pytest.approx(1.2 * 0.5 * RATED * (1 / 0.94 - 1), rel=1e-9)


def stated(path, law):
    path.write_text("speed,current,loss\n" + "".join(f"{f},{i},{law(f, i)}\n" for f, i in POINTS))
    return inverter.Inverter(rated_speed=SPEED, points_file=str(path), harmonic_loss=0.0)


def test_a_makers_points_are_met(tmp_path):
    def law(f, i):
        return 700.0 + 900.0 * i + 400.0 * i * i + 1000.0 * i * f

    drive = stated(tmp_path / "points.csv", law)
    for f, i in (*POINTS[3:], (0.7, 0.8)):
        assert losses(i * f * RATED, f * SPEED, drive)[1] == pytest.approx(law(f, i), rel=1e-9)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0.9,1,3000\n0.9,0.5,2000\n", "needs at least 5 points"),
        (
            "".join(f"0.9,{i},{1000 * i}\n" for i in (0.2, 0.4, 0.6, 0.8, 1)),
            "needs at least 5 points, with three currents",
        ),
        ("90,100,3000\n" * 5, "shares, not percent"),
        (
            "".join(f"{f},{i},{w}\n" for (f, i), w in zip(POINTS, [9, 1, 9, 1, 9, 1, 9, 1], strict=True)),
            "away from the law",
        ),
        ("a,1,3\n" * 5, "that is not a number"),
    ],
)
def test_points_that_tell_no_law_are_refused(tmp_path, rows, message):
    path = tmp_path / "points.csv"
    path.write_text(f"speed,current,loss\n{rows}")
    with pytest.raises(UsageError, match=message):
        inverter.fitted(inverter.read_points(str(path)))


def test_points_too_narrow_to_tell_the_loss_elsewhere_are_refused(tmp_path):
    """Currents of 0.9 to 1 that are met to 3 %, and tell of six times the largest loss without current."""
    rows = [(0.9, 0.9, 2000), (0.9, 0.95, 2300), (0.9, 1, 2700), (0.95, 0.9, 2050), (0.95, 1, 2750), (0.85, 0.95, 2200)]
    with pytest.raises(UsageError, match="too narrow to find the loss elsewhere"):
        inverter.fitted(rows)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("{rated_speed: 2950 rpm}", "inverter.loss: is missing"),
        (
            "{rated_speed: 2950 rpm, loss: 3 kW, points_file: none.csv}",
            "given as well as effects.motor.inverter.points_file",
        ),
        ("{rated_speed: 2950 rpm, points_file: none.csv}", "inverter.points_file: cannot be read"),
        (
            "{rated_speed: 2950 rpm, loss: 3 kW, full_field_speed: 1475 rpm}",
            "full_field_speed: is below rated_speed, where the motor has its rated field",
        ),
        (
            "{rated_speed: 2950 rpm, loss: 3 kW, standing_share: 0.7}",
            "current_share: exceeds the rest of the loss after standing_share",
        ),
    ],
)
def test_what_an_inverter_lacks_or_has_twice_is_refused(more, message):
    with pytest.raises(SceneError, match=message):
        screwsim.load(POINT, [f"effects.motor.inverter={more}"])


def test_an_inverter_beside_a_constant_efficiency_is_refused():
    sets = ["effects.motor.inverter={rated_speed: 2950 rpm, loss: 3 kW}", "effects.motor.drive_efficiency=0.97"]
    with pytest.raises(SceneError, match=r"given as well as effects\.motor\.inverter"):
        screwsim.load(POINT, sets)


@pytest.mark.parametrize(("share", "speed"), [(0.5, 1.5), (1.0, 1.5), (0.8, 2.0)])
def test_above_its_rated_speed_a_motor_takes_the_current_of_its_power(share, speed):
    """In a field of 1/f a torque takes f times the current: copper by the power, whatever the speed (M433)."""
    rated = RATED * (1 / 0.95 - 1)
    own, inverters = losses(share * RATED, speed * SPEED)
    assert own == pytest.approx(rated * (0.4 + 0.6 * share**2), rel=1e-12)
    assert inverters == pytest.approx(LOSS * (0.3 + 0.4 * share + 0.3 * share / 0.9), rel=1e-12)


@pytest.mark.parametrize("full", [1.0, 1.74])
def test_losses_have_no_step_where_the_field_begins_to_weaken(full):
    drive = replace(DRIVE, full_field_speed=full * SPEED)
    below, above = (losses(0.8 * RATED, full * speed * SPEED, drive) for speed in (1.0 - 1e-9, 1.0 + 1e-9))
    assert below == pytest.approx(above, rel=1e-8)


def test_where_the_voltage_rises_on_above_the_rated_speed_the_field_stays():
    """At full torque and 1.5 times the speed copper loses what it does at rated speed, iron 1.5^1.5 as much."""
    drive = replace(DRIVE, full_field_speed=1.74 * SPEED)
    rated = RATED * (1 / 0.95 - 1)
    assert losses(1.5 * RATED, 1.5 * SPEED, drive)[0] == pytest.approx(rated * (0.4 * 1.5**1.5 + 0.6), rel=1e-12)
    beyond = rated * (0.4 * 1.74**1.5 + 0.6 * (2.0 / 1.74) ** 2)
    assert losses(2.0 * RATED, 2.0 * SPEED, drive)[0] == pytest.approx(beyond, rel=1e-12)
    assert judged(1.5 * RATED, 1.5 * SPEED, inverter=drive) == ("", ())
    (warning,) = judged(2.4 * RATED, 2.0 * SPEED, inverter=drive)[1]
    assert "the motor's current is 1.38 times its rated one" in warning


@pytest.mark.parametrize(("speed", "share"), [(0.5, 1.0), (1.0, 1.0), (1.5, 1.5), (1.74, 1.74), (2.5, 1.74)])
def test_a_motor_carries_the_power_that_takes_its_rated_current(speed, share):
    drive = replace(DRIVE, full_field_speed=1.74 * SPEED)
    assert inverter.reach(drive, speed * SPEED) == pytest.approx(share, rel=1e-12)
    assert inverter.reach(DRIVE, speed * SPEED) == 1.0
    if speed >= 1.0:
        assert inverter.turning(drive, share * RATED, RATED, speed * SPEED).current == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(("speed", "told"), [(1.0, False), (1.39, False), (1.41, True)])
def test_a_motor_of_the_least_breakdown_torque_would_stall_where_its_field_is_weak(speed, told):
    """1.15 times the rated power: its torque is 1.15/f of the rated one, and 1.6/f² is less from f = 1.6/1.15 on."""
    why, warnings = judged(1.15 * RATED, speed * SPEED, inverter=DRIVE)
    assert why == ""
    assert any("stalls at" in each and "IEC 60034-12" in each for each in warnings) == told


def test_no_motor_carries_its_rated_power_at_four_times_its_speed():
    """3.5/f² falls below 1/f at 3.5 times the rated speed."""
    assert judged(RATED, 3.45 * SPEED, inverter=DRIVE)[0] == ""
    assert "no motor carries more than 0.219 times there" in judged(RATED, 4.0 * SPEED, inverter=DRIVE)[0]


def judged(power, omega, **motors):
    """Return why a motor cannot give a power at a speed (empty: it can), and its warnings."""
    stated = {"rated_power": RATED, "efficiency": 0.95, **motors}
    reading, *_ = motor.build(motor.Parameters(**stated), SimpleNamespace())
    return reading.judge(SimpleNamespace(shaft_power=power, motor_power=None, omega=omega))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_below_its_rated_speed_a_motor_is_overloaded_by_its_torque(sign):
    """Half the rated power is all of the torque at half the speed, twice at a quarter, four times at an eighth."""
    power = sign * 0.5 * RATED
    assert judged(power, 0.5 * SPEED, inverter=DRIVE) == ("", ())
    why, (warning,) = judged(power, 0.25 * SPEED, inverter=DRIVE)
    assert why == "" and "torque is 2 times its rated one, at 716.2 rpm: it would not last" in warning
    assert "no motor carries more than 3.5 times its rated torque" in judged(power, 0.125 * SPEED, inverter=DRIVE)[0]
    assert judged(power, 0.125 * SPEED) == ("", ())  # without an inverter it has no other speed to be judged by
    (above,) = judged(1.3 * RATED, 1.01 * SPEED, inverter=DRIVE)[1]
    assert "load is 130 kW, 1.3 times effects.motor.rated_power" in above


@pytest.mark.parametrize("name", ["shaft_power", "gas_mass_flow"])
def test_nothing_of_the_cycle_changes(name):
    with_it = screwsim.simulate(screwsim.load(POINT, ["effects.motor.inverter={rated_speed: 2950 rpm, loss: 3 kW}"]))
    assert with_it.performance[name] == screwsim.simulate(screwsim.load(POINT)).performance[name]
    assert with_it.performance.motor_loss > 0.0


def test_of_a_cooled_motor_the_gas_takes_up_its_own_loss_alone():
    parameters = motor.Parameters(rated_power=RATED, efficiency=0.95, inverter=DRIVE, cooling="suction_gas")
    _, heat = motor.build(parameters, SimpleNamespace())
    assert isinstance(heat, SuctionHeat)
    assert heat.power(0.5 * RATED, 0.5 * SPEED) == pytest.approx(losses(0.5 * RATED, 0.5 * SPEED)[0], rel=1e-12)


@pytest.mark.parametrize(("rated", "told"), [(11e3, "91.4 %"), (75e3, ""), (200e3, "")])
def test_a_small_motor_of_the_default_efficiency_is_told(rated, told):
    """IE3, four poles, 11 kW: 91.4 % (Regulation (EU) 2019/1781)."""
    (reading, *_) = motor.build(motor.Parameters(rated_power=rated), SimpleNamespace())
    why, warnings = reading.judge(SimpleNamespace(shaft_power=rated, motor_power=None, omega=SPEED))
    assert why == "" and len(warnings) == bool(told)
    assert not told or (told in warnings[0] and "write effects.motor.efficiency_class: IE3" in warnings[0])
    stated = motor.build(motor.Parameters(rated_power=rated, efficiency=0.95), SimpleNamespace())[0]
    assert stated.judge(SimpleNamespace(shaft_power=rated, motor_power=None, omega=SPEED)) == ("", ())


@pytest.mark.parametrize(
    ("share", "told"),
    [
        (1.0, ""),
        (1.004, ""),  # to a percent
        (1.07, "above its rating, within a service factor of 1.15 (NEMA MG 1)"),
        (1.16, "above its rating and a service factor of 1.15 (NEMA MG 1)"),
    ],
)
def test_a_load_above_the_rating_is_told_and_above_the_service_factor_warned_of(share, told):
    assert motor.beyond_rating(share, motor.SERVICE_FACTOR) == told
    warned = any("service factor of 1.15 (NEMA MG 1)" in text for text in judged(share * RATED, SPEED)[1])
    assert warned == (share > 1.15)


@pytest.mark.parametrize("inverts", [{"inverter": DRIVE}, {"drive_efficiency": 0.97}])
@pytest.mark.parametrize(("share", "beyond"), [(1.0, False), (1.004, False), (1.09, True)])
def test_a_motor_on_an_inverter_has_no_service_factor(inverts, share, beyond):
    """NEMA MG 1, part 31: 1.0."""
    told = motor.beyond_rating(share, motor.SERVICE_FACTOR_OF_INVERTED)
    assert told == ("above its rating, which is all that it carries for long on an inverter (NEMA MG 1)" * beyond)
    warned = [text for text in judged(share * RATED, SPEED, **inverts)[1] if "above its rating on an inverter" in text]
    assert len(warned) == beyond and all(text.endswith("(choose a larger one)") for text in warned)


@pytest.mark.parametrize(
    ("power", "speed", "told"),
    [(0.99, 0.95, ""), (1.07, 0.95, "load is"), (0.99, 0.8, "torque is 1.24"), (1.26, 1.2, "torque is 1.05")],
)
def test_behind_an_inverter_power_counts_at_any_speed_and_torque_far_beyond_its_rated_one(power, speed, told):
    """A voltage that rises up to 1.74 times the rated speed carries 1.2 times the rated power at 1.2 times it."""
    _, warnings = judged(power * RATED, speed * SPEED, inverter=replace(DRIVE, full_field_speed=1.74 * SPEED))
    assert len(warnings) == bool(told) and all(told in text for text in warnings)
