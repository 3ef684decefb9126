"""M480–M484: what each bearing carries, and how long it lives by ISO 281."""

import math

import numpy as np
import pytest
from each_row import each_row
from folders import CONFIGS

from screwsim import load, simulate
from screwsim.effects.parts.bearing_life import TYPES, equivalent_load, life_of_set, mean_load, rating_life
from screwsim.export.loads import document, loads
from screwsim.figures.engineering import figure_text
from screwsim.inputs.faults import SceneError
from screwsim.machine.rotors.loads import bearing_forces
from screwsim.study.asked.goals import read_figure

NAMES = ("male", "female")
MU, BORE, SHAFT = 0.0018, 0.06, 0.05
AT = {"suction": 0.04, "discharge": 0.06}  # [m]
PLAIN = {"load": "rotors", "friction_coefficient": MU, "bore": f"{BORE} m", "shaft_diameter": f"{SHAFT} m"}
RADIAL = {end: {"distance": f"{at} m", "rating": "150 kN"} for end, at in AT.items()}
MALE = RADIAL | {"axial": {"rating": "90 kN"}}
TAPERED = {"type": "tapered_roller", "axial_factor": 1.6}
FEMALE = {"thrust": "discharge", "suction": RADIAL["suction"], "discharge": RADIAL["discharge"] | TAPERED}
BOTH = PLAIN | {"male": MALE, "female": FEMALE, "life_of_set": "weibull"}


def with_bearings(bearings, **changes):
    return load(CONFIGS / "rotors" / "b.yaml").with_({"effects.bearings": bearings} | changes)


@pytest.fixture(scope="module")
def found():
    return simulate(with_bearings(BOTH))


# ---- statics (M480) ----


def test_a_load_in_the_middle_of_a_symmetric_rotor_is_halved():
    own = {"total_x": np.array([3e3]), "total_y": np.array([-4e3])}
    own |= {f"total_moment_{way}": 0.1 * own[f"total_{way}"] for way in "xy"}  # at 0.1 m of 0.2 m
    carried = bearing_forces(own, 0.2, (0.05, 0.05))
    for end in AT:
        assert carried[f"{end}_bearing"] == pytest.approx(2.5e3, rel=1e-15)


def test_an_axial_force_off_the_axis_makes_a_couple_of_the_bearings():
    """1 kN towards suction at y = 40 mm turns the shaft, whose bearings 0.25 m apart hold it with 160 N each."""
    own = {"total_x": 0.0, "total_y": 0.0, "total_moment_x": 0.0, "total_moment_y": 0.04 * 1e3}
    carried = bearing_forces(own, 0.2, (0.02, 0.03))
    assert carried["discharge_bearing_y"] == pytest.approx(160.0, rel=1e-15)
    assert carried["suction_bearing_y"] == pytest.approx(-160.0, rel=1e-15)


def assert_exported_as_simulated(found, columns):
    """Hold columns, at 48 angles from traces a degree apart, against the figures of a run."""
    for rotor in NAMES:
        size = found.performance[f"{rotor}_radial_load"]
        for end in AT:
            by_angle = columns[f"{rotor}_{end}_bearing_total"]
            assert abs(found.performance[f"{rotor}_{end}_bearing_load"] - by_angle.mean()) < 0.005 * size
            assert abs(found.performance[f"{rotor}_{end}_bearing_load_peak"] - by_angle.max()) < 0.01 * size
        thrust = -columns[f"{rotor}_thrust_bearing"]
        assert abs(found.performance[f"{rotor}_axial_load"] - thrust.mean()) < 0.005 * size
        assert abs(found.performance[f"{rotor}_axial_load_peak"] - np.abs(thrust).max()) < 0.01 * size


def test_bearings_carry_what_is_exported_for_them(found):
    assert_exported_as_simulated(found, loads(with_bearings(BOTH), found).curves["forces"][1])


def test_each_rotor_s_own_distances_and_piston_are_exported():
    """Distances that differ by rotor, a piston at the pressure of a plenum, behind a throttle."""
    far = FEMALE | {"suction": RADIAL["suction"] | {"distance": "150 mm"}}
    bearings = BOTH | {"male": MALE | {"balance_piston": {"area": "10 cm^2"}}, "female": far}
    volumes = {"discharge_volume": "3 l", "discharge_area": "15 cm^2"}
    lines = {"effects.plenums": volumes, "effects.suction_throttle.pressure_ratio": 0.7}
    scene = with_bearings(bearings, **lines)
    result = simulate(scene)
    columns = loads(scene, result).curves["forces"][1]
    assert_exported_as_simulated(result, columns)
    other = loads(scene, result, (AT["suction"], AT["discharge"]), (0.0, 0.0)).curves["forces"][1]  # options hold
    for rotor, same in (("male", True), ("female", False)):
        name = f"{rotor}_suction_bearing_x"
        assert np.allclose(columns[name], other[name]) == same
        assert np.abs(other[f"{rotor}_thrust_bearing"]).mean() > np.abs(columns[f"{rotor}_thrust_bearing"]).mean()


def test_the_exported_document_states_where_the_bearings_of_each_rotor_are(found):
    scene = with_bearings(BOTH | {"male": MALE | {"suction": RADIAL["suction"] | {"distance": "150 mm"}}})
    told = document(loads(scene, found))["supports"]
    length = scene.machine.rotor_length
    for rotor, before in (("male", 0.15), ("female", AT["suction"])):
        own = {name: (each["units"], each["value"]) for name, each in told[rotor].items()}
        assert own["suction_bearing_distance"] == ("m", before) and own["suction_bearing_z"] == ("m", -before)
        assert own["discharge_bearing_distance"] == ("m", AT["discharge"]) and own["shaft_diameter"] == ("m", SHAFT)
        assert own["discharge_bearing_z"] == ("m", pytest.approx(length + AT["discharge"], rel=1e-15))
        assert own["balance_piston_force"] == ("N", 0.0)
    other = document(loads(scene, found, (0.01, 0.02), (0.0, 0.0)))["supports"]["male"]  # options hold
    assert other["suction_bearing_z"] == {"units": "m", "value": -0.01, "stated": True}


def test_the_exported_document_tells_bearings_that_are_assumed_in_the_end_planes(found):
    def assumed(scene, *options):
        told = document(loads(scene, found, *options))["supports"]
        lacking = [(rotor, name) for rotor, own in told.items() for name, each in own.items() if not each["stated"]]
        assert all(told[rotor][name]["value"] == 0.0 for rotor, name in lacking if not name.endswith("_z"))
        return lacking

    bearings = [f"{end}_bearing_{what}" for what in ("z", "distance") for end in ("suction", "discharge")]
    assert assumed(with_bearings(BOTH)) == []
    assert assumed(with_bearings(PLAIN | {"male": MALE})) == [("female", name) for name in bearings]
    bare = with_bearings(BOTH).without("bearings")
    assert assumed(bare) == [(rotor, name) for rotor in ("male", "female") for name in (*bearings, "shaft_diameter")]
    assert assumed(bare, (0.0, 0.0), (0.0, 0.0)) == []


def test_the_export_takes_no_distances_where_the_scene_names_none():
    scene = with_bearings(PLAIN | {"male": MALE})
    result = simulate(scene)
    assumed, stated = (loads(scene, result, spans).curves["forces"][1] for spans in (None, (0.0, 0.0)))
    for way in "xy":
        name = f"discharge_bearing_total_{way}"
        assert np.array_equal(assumed[f"female_{name}"], stated[f"female_{name}"])
        assert not np.allclose(assumed[f"male_{name}"], stated[f"male_{name}"])


def test_the_course_over_the_angle_has_the_figures_mean_and_peak(found):
    for rotor in NAMES:
        for name in ("suction_bearing_load", "discharge_bearing_load", "axial_load"):
            course = found.cycle[f"{rotor}_{name}"][:-1]  # of whole pitches, read at degrees
            figure = found.performance[f"{rotor}_{name}"]
            assert course.mean() == pytest.approx(figure, rel=2e-3)
            assert np.abs(course).max() == pytest.approx(found.performance[f"{rotor}_{name}_peak"], rel=2e-3)


# ---- friction (M481), piston, and what stays ----


def test_friction_is_that_of_each_bearing_s_own_load(found):
    """The male rotor has three; the female's discharge bearing carries both loads, added as vectors."""
    scene, p = with_bearings(BOTH), found.performance
    speeds = scene.operation.speed * np.array([1.0, scene.machine.male_lobes / scene.machine.female_lobes])
    male = p.male_suction_bearing_load + p.male_discharge_bearing_load + p.male_axial_load
    both = [found.cycle[f"female_{name}"][:-1] for name in ("discharge_bearing_load", "axial_load")]
    female = p.female_suction_bearing_load + np.hypot(*both).mean()
    power = 0.5 * MU * BORE * float(speeds @ [male, female])
    assert p.bearing_power == pytest.approx(power, rel=1e-3)  # courses are read at degrees


def test_naming_bearings_leaves_the_cycle_and_the_rotors_loads_as_they_are(found):
    plain = simulate(with_bearings(PLAIN)).performance
    for name in ("indicated_power", "gas_mass_flow", "discharge_temperature", *(f"{of}_radial_load" for of in NAMES)):
        assert found.performance[name] == plain[name]
    assert found.performance.bearing_power > plain.bearing_power  # sums of lengths, in place of one vector's
    assert not [name for name in plain if "bearing_l" in name or "life" in name or name.endswith("load_peak")]


@pytest.mark.parametrize("stated", [None, "5 bar"])
def test_a_balance_piston_takes_its_area_times_its_pressure_off_the_thrust(found, stated):
    piston = {"area": "10 cm^2"} | ({} if stated is None else {"pressure": stated})
    less = simulate(with_bearings(BOTH | {"male": MALE | {"balance_piston": piston}})).performance
    pressure = 5e5 if stated else less.discharge_pressure
    off = 1e-3 * (pressure - less.suction_pressure)
    assert found.performance.male_axial_load - less.male_axial_load == pytest.approx(off, rel=1e-9)
    assert less.male_suction_bearing_load == found.performance.male_suction_bearing_load
    assert less.male_axial_bearing_life > found.performance.male_axial_bearing_life
    assert less.female_axial_load == found.performance.female_axial_load


# ---- life (M482–M484) ----


def test_a_life_in_hours_by_hand():
    """(C/P)^3 = 1000 million turns at 1000 rpm are 16 667 h."""
    hours = rating_life(10e3, 1e3, 3.0, 1000.0 * math.pi / 30.0, 1.0) / 3600.0
    assert hours == pytest.approx(1e9 / 60e3, rel=1e-14)


@pytest.mark.parametrize(("name", "exponent"), [("angular_contact_ball", 3.0), ("cylindrical_roller", 10.0 / 3.0)])
def test_twice_the_load_is_the_power_p_of_a_half_of_the_life(name, exponent):
    p = TYPES[name].exponent
    lives = [rating_life(100e3, load, p, 300.0, 1.0) for load in (5e3, 10e3)]
    assert lives[1] / lives[0] == pytest.approx(0.5**exponent, rel=1e-14)
    assert rating_life(100e3, 5e3, p, 600.0, 0.5) == pytest.approx(0.25 * lives[0], rel=1e-14)


def test_a_load_of_half_the_turn_damages_half_as_much():
    assert mean_load(np.array([6e3, 0.0]), 3.0) == pytest.approx(6e3 * 0.5 ** (1.0 / 3.0), rel=1e-14)
    assert mean_load(np.full(7, 6e3), 10.0 / 3.0) == pytest.approx(6e3, rel=1e-14)
    assert mean_load(np.zeros(3), 3.0) == 0.0


def test_the_equivalent_load_changes_branches_without_a_step_at_the_e_of_its_source():
    """ISO 281, single row: e = 1.14 of an angular contact bearing of 40°, 1.5 tan α of tapered rollers."""
    ball, tan = TYPES["angular_contact_ball"], math.tan(math.radians(14.0))
    X, Y = ball.radial_factor, ball.axial_factor
    assert (1.0 - X) / Y == pytest.approx(1.14, abs=0.005)  # printed to two digits
    assert (1.0 - TYPES["tapered_roller"].radial_factor) / (0.4 / tan) == pytest.approx(1.5 * tan, rel=1e-14)
    radial = np.array([1e3, 1e3, 0.0])
    found = equivalent_load(radial, np.array([1.1e3, -2e3, 1e3]), X, Y)
    assert found.tolist() == pytest.approx([1e3, 350.0 + 1140.0, 570.0], rel=1e-14)


@each_row(
    ("name", "Y", "axial", "by_hand"),
    [
        ("angular_contact_ball", None, 5.0, 10.0),  # below e = 1.14: F_r
        ("angular_contact_ball", None, 20.0, 0.35 * 10.0 + 0.57 * 20.0),
        ("angular_contact_ball_pair", None, 5.0, 10.0 + 0.55 * 5.0),  # below e = 1.14
        ("angular_contact_ball_pair", None, -11.0, 10.0 + 0.55 * 11.0),
        ("angular_contact_ball_pair", None, 12.0, 0.57 * 10.0 + 0.93 * 12.0),
        ("angular_contact_ball_pair", None, 20.0, 0.57 * 10.0 + 0.93 * 20.0),
        ("tapered_roller", 1.6, 2.0, 10.0),  # below e = 0.6/1.6 = 0.375
        ("tapered_roller", 1.6, 5.0, 0.4 * 10.0 + 1.6 * 5.0),
        ("tapered_roller_pair", 2.68, 2.0, 10.0 + 1.8 * 2.0),  # cot α = 4: Y_1 = 0.45 · 4 below e = 1.5/4
        ("tapered_roller_pair", 2.68, 3.7, 10.0 + 1.8 * 3.7),
        ("tapered_roller_pair", 2.68, 3.8, 0.67 * 10.0 + 2.68 * 3.8),
        ("tapered_roller_pair", 2.68, 9.0, 0.67 * 10.0 + 2.68 * 9.0),
        ("deep_groove_ball", 1.6, 1.0, 10.0),  # below e = 0.44/1.6
        ("deep_groove_ball", 1.6, 4.0, 0.56 * 10.0 + 1.6 * 4.0),
    ],
)
def test_an_equivalent_load_by_hand_from_the_tables_of_iso_281(name, Y, axial, by_hand):
    """Of 10 kN radial load and an axial one [kN], single rows and pairs back to back or face to face."""
    kind = TYPES[name]
    loads = np.array([10e3]), np.array([1e3 * axial])
    (found,) = equivalent_load(*loads, kind.radial_factor, Y or kind.axial_factor, kind.at_e)
    assert found == pytest.approx(1e3 * by_hand, rel=1e-12)


@pytest.mark.parametrize(
    ("angle", "e", "Y_1", "X", "Y"),
    [
        (20, 0.57, 1.09, 0.70, 1.63),
        (25, 0.68, 0.92, 0.67, 1.41),
        (30, 0.80, 0.78, 0.63, 1.24),
        (35, 0.95, 0.66, 0.60, 1.07),
        (40, 1.14, 0.55, 0.57, 0.93),
        (45, 1.34, 0.47, 0.54, 0.81),
    ],
)
def test_stated_factors_of_a_pair_of_another_angle_give_its_factor_below_e(angle, e, Y_1, X, Y):
    """ISO 281:2007, table 3, double-row angular contact ball bearings; printed to two digits."""
    at_e = TYPES["angular_contact_ball_pair"].at_e
    load = equivalent_load(np.array([1.0]), np.array([0.5 * e]), X, Y, at_e)
    assert load[0] == pytest.approx(1.0 + 0.5 * e * Y_1, abs=0.005)
    assert (at_e - X) / Y == pytest.approx(e, rel=0.01)


def test_a_set_of_equal_bearings_lives_by_their_slope():
    for count, slope in ((1, 9.0 / 8.0), (4, 10.0 / 9.0), (6, 9.0 / 8.0)):
        assert life_of_set([(7e7, slope)] * count) == pytest.approx(7e7 * count ** (-1.0 / slope), rel=1e-11)


def test_nine_of_ten_sets_of_different_bearings_are_whole_at_their_life():
    """The chance of all is the product of the chances 0.9^((L/L_i)^e_i) of each."""
    lives = [(4e7, 10.0 / 9.0), (9e7, 9.0 / 8.0), (3e8, 9.0 / 8.0), (1e12, 10.0 / 9.0)]
    L = life_of_set(lives)
    whole = math.prod(0.9 ** ((L / life) ** slope) for life, slope in lives)
    assert whole == pytest.approx(0.9, rel=1e-11)
    assert L < 4e7


def test_lives_of_a_machine_follow_from_its_loads(found):
    scene, p = with_bearings(BOTH), found.performance
    omega = scene.operation.speed
    turning = {"male": omega, "female": omega * scene.machine.male_lobes / scene.machine.female_lobes}
    every = {(rotor, end): (150e3, 10.0 / 3.0, 9.0 / 8.0) for rotor in NAMES for end in AT}
    every["male", "axial"] = 90e3, 3.0, 10.0 / 9.0
    lives = []
    for (rotor, place), (rating, exponent, slope) in every.items():
        P, life = (p[f"{rotor}_{place}_bearing_{what}"] for what in ("equivalent_load", "life"))
        assert life == pytest.approx(1e6 * 2.0 * math.pi / turning[rotor] * (rating / P) ** exponent, rel=1e-12)
        lives.append((life, slope))
    assert p.bearing_set_life == pytest.approx(life_of_set(lives), rel=1e-12)
    axial = found.cycle["male_axial_load"][:-1]
    assert p.male_axial_bearing_equivalent_load == pytest.approx(0.57 * np.mean(axial**3) ** (1.0 / 3.0), rel=2e-3)
    radial, thrust = (found.cycle[f"female_{name}"][:-1] for name in ("discharge_bearing_load", "axial_load"))
    combined = np.maximum(radial, 0.4 * radial + 1.6 * thrust)
    assert combined.max() > radial.max()  # the thrust counts here
    mean = np.mean(combined ** (10.0 / 3.0)) ** 0.3
    assert p.female_discharge_bearing_equivalent_load == pytest.approx(mean, rel=2e-3)


def test_a_deep_groove_bearing_holds_a_thrust_that_changes_sides():
    groove = RADIAL["discharge"] | {"type": "deep_groove_ball", "axial_factor": 1.6}
    male = {"thrust": "discharge", "suction": RADIAL["suction"], "discharge": groove}
    result = simulate(with_bearings(PLAIN | {"male": male | {"balance_piston": {"area": "104 cm^2"}}}))
    thrust = result.cycle["male_axial_load"][:-1]
    assert thrust.min() < 0.0 < thrust.max() and not [each for each in result.warnings if "changes sides" in each]


def test_a_pair_carries_the_thrust_below_e_and_holds_it_either_way():
    """A discharge bearing that carries radial load and thrust, whose piston takes about half of it."""
    pair = RADIAL["discharge"] | {"type": "angular_contact_ball_pair"}
    male = {"thrust": "discharge", "suction": RADIAL["suction"], "discharge": pair}
    bearings = PLAIN | {"male": male | {"balance_piston": {"area": "104 cm^2"}}}
    result = simulate(with_bearings(bearings))
    radial, thrust = (result.cycle[f"male_{name}"][:-1] for name in ("discharge_bearing_load", "axial_load"))
    assert thrust.min() < 0.0 < thrust.max() and not [each for each in result.warnings if "changes sides" in each]
    size = np.abs(thrust)
    P = np.where(size <= 1.14 * radial, radial + 0.55 * size, 0.57 * radial + 0.93 * size)
    assert (size < 1.14 * radial).any()
    mean = np.mean(P**3) ** (1.0 / 3.0)
    assert result.performance.male_discharge_bearing_equivalent_load == pytest.approx(mean, rel=4e-3)  # read at degrees


def test_a_life_factor_multiplies_the_life(found):
    longer = MALE | {"axial": {"rating": "90 kN", "life_factor": 2.5}}
    p = simulate(with_bearings(BOTH | {"male": longer})).performance
    assert p.male_axial_bearing_life == pytest.approx(2.5 * found.performance.male_axial_bearing_life, rel=1e-12)
    assert p.bearing_set_life > found.performance.bearing_set_life


def test_people_read_and_ask_for_lives_in_hours():
    assert figure_text("bearing_set_life", 4e4 * 3600.0) == "40000 h"
    assert read_figure("bearing_set_life", "40000 h", "--for") == 4e4 * 3600.0


def test_only_what_is_named_has_figures():
    """A bearing without a rating has loads and no life; a rotor that is not named has neither."""
    bare = {end: {"distance": "40 mm"} for end in AT}
    p = simulate(with_bearings(PLAIN | {"male": bare})).performance
    assert "male_suction_bearing_equivalent_load" in p and "male_axial_load_peak" in p
    assert not [name for name in p if "life" in name or "male_axial_bearing" in name]
    assert not [name for name in p if name.startswith("female") and "bearing" in name]


# ---- warnings and faults ----


@each_row(
    ("changes", "words"),
    [
        ({"axial": {"rating": "2 kN"}}, ("above half of its rating", "a larger effects.bearings.male.axial.rating")),
        ({"balance_piston": {"area": "300 cm^2"}}, ("kN more than its thrust", "reduce effects.bearings.male.balance")),
        (
            {"balance_piston": {"area": "104 cm^2"}},
            ("changes sides within a turn, from -", "(reduce effects.bearings.male.balance_piston.area, or use a sec"),
        ),
    ],
)
def test_an_unlikely_bearing_is_told(changes, words):
    (told,) = simulate(with_bearings(PLAIN | {"male": MALE | changes})).warnings
    assert all(each in told for each in words)


@each_row(
    ("male", "words"),
    [
        ({"suction": {"rating": "9 kN"}}, "male.suction.distance: is missing (write distance: … mm"),
        ({"suction": {"distance": "-5 mm"}}, "male.suction.distance: '-5 mm' is out of range (it must be at least 0"),
        ({"suction": {"distance": "9 m"}}, "male.suction.distance: 9000 mm is 56.2 rotor diameters, which is imposs"),
        ({"axial": {"rating": "-1 kN"}}, "male.axial.rating: '-1 kN' is out of range (it must be greater than 0 kN)"),
        ({"axial": {"type": "cylindrical_roller"}}, "male.axial.type: cylindrical_roller carries no thrust (choose"),
        ({"axial": {"type": "tapered_roller"}}, "male.axial.axial_factor: is missing (write Y of the tapered_roller"),
        ({"axial": {"life_factor": 2}}, "male.axial.life_factor: applies only beside a rating"),
        ({"thrust": "discharge"}, "male.axial: carries nothing, since thrust: discharge is chosen (remove one"),
        (
            {"suction": {"distance": "4 cm", "axial_factor": 1}},
            "male.suction.axial_factor: applies only to thrust: suction (remove it, or write that)",
        ),
    ],
)
def test_a_fault_is_found_with_its_remedy(male, words):
    with pytest.raises(SceneError) as caught:
        with_bearings(PLAIN | {"male": MALE | male})
    assert f"effects.bearings.{words}" in str(caught.value)


@each_row(
    ("changes", "words"),
    [
        (
            {"female": None},
            "effects.bearings.female: is missing (life_of_set needs both rotors; write its bearings)",
        ),
        ({"male": RADIAL}, "male.axial: is missing (write its rating; life_of_set needs the bearing of the thrust)"),
        (
            {"male": MALE | {"axial": {}}},
            "male.axial.rating: is missing (write rating: … kN; life_of_set needs",
        ),
        (
            {"shaft_diameter": None},
            "effects.bearings.shaft_diameter: is missing (male.axial needs it, as no gas presses on a shaft; write",
        ),
        ({"load": "stated"}, "effects.bearings.male: applies only to rotors, and stated is chosen (remove it)"),
    ],
)
def test_a_set_needs_all_its_bearings_and_the_loads_of_rotors(changes, words):
    with pytest.raises(SceneError) as caught:
        with_bearings(BOTH | changes)
    assert words in str(caught.value)
