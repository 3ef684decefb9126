"""What engineers state: displacement, families of rotors, volume ratio, tip speed, gauge pressures."""

import math

import numpy as np
import pytest
from each_row import each_row
from folders import CONFIGS

import screwsim
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.machine.kinds import kind_of
from screwsim.scene import case, scene_text
from screwsim.scene.types import STANDARD_ATMOSPHERE

ROTORS = """\
machine:
  displacement: {flow: 600 m^3/h, at: 2950 rpm}
  built_in_volume_ratio: 3
  profile: {family: b}
  volume: {law: profile}
  suction_port: {law: profile}
  discharge_port: {law: profile}
gas: {fluid: Air}
operation:
  speed: 3000 rpm
  suction: {pressure: 1 bar, temperature: 293 K}
  discharge: {pressure: 8 bar}
effects: {suction_port: , discharge_port: , tip_leakage: {gap: 40 um}}
"""
PAPER = """\
machine:
  rotor_diameter: 160 mm
  rotor_length: 176 mm
  built_in_volume_ratio: 2.9
  volume: {max: 528 cm^3, phi_A: 65 deg}
  suction_port: {area: 290 cm^2, phi_B: 60 deg}
  discharge_port: {area: 44 cm^2}
gas: {fluid: Air}
operation:
  speed: 3000 rpm
  suction: {pressure: 1 bar, temperature: 293 K}
  discharge: {pressure: 8 bar}
effects: {suction_port: , discharge_port: }
"""


def geometry(scene):
    return kind_of(scene.machine).geometry(scene.machine)


def volume_at(scene, angle):
    return float(geometry(scene).volume_law().along(np.array([angle]))[0][0])


def volume_ratio(scene):
    """Return the ratio that the laws have: of volumes at the angles of closing and opening, not as stated."""
    found = geometry(scene)
    return volume_at(scene, found.injection_angle) / volume_at(scene, found.discharge_opens)


def refusals(text, *overrides):
    with pytest.raises(SceneError) as refused:
        screwsim.loads(text, "x.yaml", overrides=overrides)
    return [line.partition(": ")[2] for line in refused.value.lines]


@pytest.mark.parametrize("family", ["a", "b", "c"])
def test_rotors_of_a_family_displace_what_is_stated(family):
    scene = screwsim.loads(ROTORS, overrides=[f"machine.profile.family={family}"])
    machine = scene.machine
    swept = geometry(scene).swept_volume * machine.male_lobes
    assert swept * 2950 / 60 * 3600 == pytest.approx(600.0, rel=1e-6)  # m³/h; tables of V are good to 1e-9 of V_max
    assert machine.rotor_length == pytest.approx(1.1 * machine.rotor_diameter)


def test_a_family_is_the_shipped_machine_at_its_diameter():
    text = ROTORS.replace("displacement: {flow: 600 m^3/h, at: 2950 rpm}", "rotor_diameter: 160 mm")
    ours = screwsim.loads(text).machine
    shipped = screwsim.load(CONFIGS / "rotors" / "b.yaml").machine
    lengths = (
        "centre_distance",
        "female_diameter",
        "male_tip_radius",
        "female_tip_radius",
        "flank_radius",
        "root_radius",
    )
    for name in (*lengths, "wrap_angle", "pressure_angle"):
        assert getattr(ours.profile, name) == pytest.approx(getattr(shipped.profile, name), rel=1e-12), name
    assert (ours.rotor_length, ours.male_lobes) == (pytest.approx(shipped.rotor_length), shipped.male_lobes)


def test_a_stated_length_is_kept_beside_a_displacement():
    scene = screwsim.loads(ROTORS, overrides=["machine.rotor_length=250 mm"])
    swept = geometry(scene).swept_volume * scene.machine.male_lobes
    assert scene.machine.rotor_length == 0.25
    assert swept * 2950 / 60 * 3600 == pytest.approx(600.0, rel=1e-6)


def test_the_scene_is_written_as_it_was_stated_and_reads_back():
    for text in (ROTORS, PAPER, ROTORS.replace("speed: 3000 rpm", "tip_speed: 25 m/s")):
        scene = screwsim.loads(text)
        again = screwsim.loads(scene.text)
        assert again == screwsim.loads(again.text)
        assert again.machine == scene.machine and again.operation == scene.operation
    assert "rotor_diameter" not in screwsim.loads(ROTORS).text and "opens" not in screwsim.loads(PAPER).text


def test_a_sweep_over_the_displacement_makes_other_rotors():
    axis = "sweep.machine.displacement.flow=[300 m^3/h, 2400 m^3/h]"
    scene = screwsim.loads(ROTORS, overrides=[axis])
    small, large = (case(scene, index) for index in (0, 1))
    assert large.machine.rotor_diameter / small.machine.rotor_diameter == pytest.approx(2.0)  # the cube root of 8
    assert large.machine.profile.centre_distance == pytest.approx(0.8 * large.machine.rotor_diameter)
    assert screwsim.loads(scene_text(large)).machine == large.machine


def test_the_displacement_of_a_law_of_the_paper_is_its_volume():
    changes = ["machine.volume.max=null", "machine.displacement={flow: 600 m^3/h, at: 2950 rpm}"]
    machine = screwsim.loads(PAPER, overrides=changes).machine
    assert machine.volume.max * 4 * 2950 / 60 * 3600 == pytest.approx(600.0)


@each_row("ratio", [1.3, 2.0, 2.9, 4.5, 7.0])
def test_the_paper_law_opens_where_the_volume_has_fallen_to_the_ratio(ratio):
    scene = screwsim.loads(PAPER, overrides=[f"machine.built_in_volume_ratio={ratio}"])
    assert volume_ratio(scene) == pytest.approx(ratio, rel=1e-9)
    port = scene.machine.discharge_port
    assert port.opens < port.phi_C < 0.5 * (port.opens + 4 * math.pi)
    figure = geometry(scene).built_in_volume_ratio(lambda at: volume_at(scene, at))
    assert figure == pytest.approx(ratio, rel=1e-9)


def test_the_paper_law_reaches_into_its_last_branch():
    """V below the inflection at 720° − φ_A: the other branch of M15."""
    changes = ["machine.volume.phi_A=200 deg", "machine.built_in_volume_ratio=5"]
    scene = screwsim.loads(PAPER, overrides=changes)
    assert scene.machine.discharge_port.opens > 4 * math.pi - math.radians(200.0)
    assert volume_ratio(scene) == pytest.approx(5.0, rel=1e-9)


def test_a_sweep_over_the_ratio_moves_the_port_of_the_paper():
    scene = screwsim.loads(PAPER, overrides=["sweep.machine.built_in_volume_ratio=[2.2, 3.6]"])
    first, last = (case(scene, index) for index in (0, 1))
    assert (volume_ratio(first), volume_ratio(last)) == (pytest.approx(2.2), pytest.approx(3.6))


def test_tip_speed_states_the_speed_also_of_rotors_that_follow():
    scene = screwsim.loads(ROTORS.replace("speed: 3000 rpm", "tip_speed: 25 m/s"))
    assert scene.machine.surface_speed(scene.operation.speed) == pytest.approx(25.0)
    swept = screwsim.loads(
        PAPER.replace("speed: 3000 rpm", "tip_speed: 25 m/s"),
        overrides=["sweep={machine.rotor_diameter: [120 mm, 240 mm]}"],
    )
    for index in (0, 1):
        one = case(swept, index)
        assert one.operation.speed * one.machine.rotor_diameter / 2 == pytest.approx(25.0)


def test_gauge_pressures_are_over_the_standard_atmosphere_or_what_is_stated():
    gauge = [f"operation.discharge.pressure={text}" for text in ("7 bar(g)", "7 barg", "0.7 MPag", "700 kPa(g)")]
    for change in gauge:
        assert screwsim.loads(PAPER, overrides=[change]).operation.discharge.pressure == pytest.approx(
            7e5 + STANDARD_ATMOSPHERE
        )
    psi = screwsim.loads(PAPER, overrides=["operation.discharge.pressure=100 psig"]).operation.discharge.pressure
    assert psi == pytest.approx(100 * 6894.757 + STANDARD_ATMOSPHERE, rel=1e-6)  # the pound-force to seven digits
    high = ["operation.discharge.pressure=7 bar(g)", "operation.ambient_pressure=0.8 bar"]
    scene = screwsim.loads(PAPER, overrides=high)
    assert scene.operation.discharge.pressure == pytest.approx(7.8e5)
    swept = screwsim.loads(PAPER, overrides=[high[1], "sweep.operation.discharge.pressure=[6 bar(g), 7 bar(g)]"])
    assert swept.sweep["operation.discharge.pressure"] == pytest.approx((6.8e5, 7.8e5))
    assert screwsim.loads(scene.text).operation.discharge.pressure == scene.operation.discharge.pressure


@pytest.mark.parametrize(
    "stated", ["1 baar", "1", "1 bar(g)", "0.1 bar(g)", "-1 bar", "99 bar", "[1 bar]", "1 bar ± 1 %"]
)
def test_of_a_badly_stated_ambient_pressure_no_gauge_pressure_complains(stated):
    gauge = ["operation.suction.pressure=-0.01 bar(g)", "operation.discharge.pressure=7 bar(g)"]
    (line,) = refusals(PAPER, *gauge, f"operation.ambient_pressure={stated}")
    assert line.startswith("operation.ambient_pressure: ")


def test_gauge_pressures_follow_an_ambient_pressure_that_python_changes():
    """As with --set: they are read anew from what was written, also after another change."""
    at, p_d = "operation.ambient_pressure", "operation.discharge.pressure"
    scene = screwsim.loads(PAPER, overrides=[f"{p_d}=7 bar(g)", f"{at}=1 bar"])
    assert scene.with_({at: "0.8 bar"}).operation.discharge.pressure == pytest.approx(7.8e5)
    later = scene.with_(operation__speed="1000 rpm").with_({at: "0.8 bar"})
    assert later.operation.discharge.pressure == pytest.approx(7.8e5)
    own = scene.with_({at: "0.8 bar", "operation.discharge": {"pressure": "9 bar"}})
    assert own.operation.discharge.pressure == pytest.approx(9e5)
    assert scene.with_(operation__speed="1000 rpm").operation.discharge.pressure == scene.operation.discharge.pressure


ZIPPED = "[{operation.speed: [900 rpm, 1000 rpm], operation.discharge.pressure: [6 bar(g), 7 bar(g)]}]"
SAMPLED = "{kind: sobol, count: 4, seed: 1, over: {operation.discharge.pressure: {from: 6 bar(g), to: 7 bar(g)}}}"


@pytest.mark.parametrize(
    ("written", "path"),
    [
        ("operation.discharge.pressure=7 bar(g) ± 0.1 bar", "operation.discharge.pressure"),
        ("sweep.operation.discharge.pressure=[6 bar(g), 7 bar(g)]", "sweep.operation.discharge.pressure"),
        (f"sweep.zip={ZIPPED}", "sweep.zip"),
        (f"sweep.sample={SAMPLED}", "sweep.sample"),
        (f"sweep.sample={SAMPLED.replace('{from: 6 bar(g), to: 7 bar(g)}', '[6 bar(g), 7 bar(g)]')}", "sweep.sample"),
    ],
)
def test_gauge_pressures_that_cannot_be_read_anew_are_told(written, path):
    scene = screwsim.loads(PAPER, overrides=[written])
    told = f"with_: operation.ambient_pressure: {path} was read relative to the former one (state it anew as well)"
    with pytest.raises(UsageError) as refusal:
        scene.with_({"operation.ambient_pressure": "0.8 bar"})
    assert str(refusal.value) == told
    assert scene.with_(operation__speed="1000 rpm").uncertain == scene.uncertain
    at, _, stated = written.partition("=")
    anew = scene.with_({"operation.ambient_pressure": "0.8 bar", at: stated})
    over = screwsim.loads(PAPER, overrides=[written, "operation.ambient_pressure=0.8 bar"])
    assert (anew.operation.discharge, anew.sweep) == (over.operation.discharge, over.sweep)


REMOVE = "remove one of the two; null drops a base's value"


@each_row(
    ("text", "overrides", "told"),
    [
        (
            ROTORS,
            ["machine.rotor_diameter=160 mm"],
            f"machine.rotor_diameter: is given as well as machine.displacement, which states it already ({REMOVE})",
        ),
        (
            ROTORS,
            ["machine.profile.root_radius=3 mm"],
            "machine.profile.root_radius: is given as well as machine.profile.family, whose rotors follow from "
            f"rotor_diameter ({REMOVE})",
        ),
        (
            ROTORS,
            ["machine.male_lobes=5"],
            "machine.male_lobes: is given as well as machine.profile.family: b, which has 4 (remove it)",
        ),
        (
            ROTORS,
            ["machine.profile.kind=circular"],
            "machine.profile.kind: is given as well as machine.profile.family: b, which is rack (remove it)",
        ),
        (
            ROTORS.replace("speed: 3000", "tip_speed: 20 m/s\n  speed: 3000"),
            [],
            f"operation.tip_speed: is given as well as operation.speed, which it states already ({REMOVE})",
        ),
        (
            ROTORS.replace("speed: 3000 rpm", "tip_speed: 20 m/s"),
            ["sweep.operation.speed=[1000 rpm, 2000 rpm]"],
            "sweep.operation.speed: has no meaning with operation.tip_speed (vary that one, or state the speed)",
        ),
        (
            ROTORS,
            ["sweep.operation.tip_speed=[20 m/s, 25 m/s]"],
            "sweep.operation.tip_speed: has no meaning with operation.speed (vary that one, or state the tip speed in "
            "its place)",
        ),
        (
            PAPER,
            ["machine.displacement={flow: 600 m^3/h, at: 2950 rpm}"],
            f"machine.volume.max: is given as well as machine.displacement, which states it already ({REMOVE})",
        ),
        (
            PAPER,
            ["machine.discharge_port.opens=620 deg"],
            "machine.discharge_port.opens: is given as well as machine.built_in_volume_ratio, from which it follows "
            f"({REMOVE})",
        ),
        (
            PAPER,
            ["machine.discharge_port=null", "effects.discharge_port=off"],
            "machine.built_in_volume_ratio: needs the section machine.discharge_port, which it opens (write it, or "
            "remove this)",
        ),
        (
            PAPER,
            ["machine.built_in_volume_ratio=900"],
            "machine.built_in_volume_ratio: 900 leaves the port less than 10 deg before the end of discharge (choose a "
            "smaller ratio)",
        ),
        (
            PAPER,
            ["machine.volume.max=null"],
            "machine.volume.max: is missing (write e.g. max: 500 cm^3; swept volume of one chamber)",
        ),
        (
            PAPER,
            ["operation.ambient_pressure=0.1 bar(g)"],
            "operation.ambient_pressure: '0.1 bar(g)' is a gauge pressure (write the absolute pressure, e.g. '2 bar')",
        ),
    ],
)
def test_what_is_stated_twice_or_cannot_be_kept_is_refused_in_one_line(text, overrides, told):
    found = refusals(text, *overrides)
    assert any(line.endswith(told) for line in found), found


def test_a_displacement_of_rotors_that_are_stated_by_lengths_is_refused(tmp_path):
    (tmp_path / "x.yaml").write_text(
        f"base: {CONFIGS / 'rotors' / 'b.yaml'}\nmachine:\n  displacement: {{flow: 9 m^3/min, at: 2950 rpm}}\n"
    )
    with pytest.raises(SceneError, match=r"needs machine.profile.family: this profile states the size"):
        screwsim.load(tmp_path / "x.yaml")


def test_pistons_have_no_tips():
    with pytest.raises(
        SceneError, match=r"operation.tip_speed: applies only to screw rotors, which a slider_crank does not have"
    ):
        screwsim.load(CONFIGS / "slider_crank" / "air.yaml", ["operation.tip_speed=5 m/s", "operation.speed=null"])
