"""Refusals and warnings of an engineer's day, as a person reads them in a terminal.

Others are read where their command is tested: `new` (tests/template), `find` and `optimize` (test_seek), sheets
(tests/study/test_refrigeration_sheet), rotors (test_rotors), sweeps and results (test_warned), states that cannot be
(test_impossible), pages and figures (tests/report).
"""

import pytest
from folders import CONFIGS, ROOT

from screwsim.cli import exit_code
from screwsim.machine.rotors.export import profile_csv
from screwsim.report.trace import case_title
from screwsim.results import open_results
from screwsim.study.validation import sibling

PLAIN = str(ROOT / "tests" / "plain" / "r134a.yaml")
COMPACT = str(CONFIGS / "r134a" / "compact.yaml")
B = str(CONFIGS / "rotors" / "b.yaml")
PAPER = str(CONFIGS / "paper" / "point.yaml")


def told(capsys, *arguments):
    """Return the exit code, and the words of stdout and of stderr."""
    code = exit_code([str(each) for each in arguments])
    out, err = capsys.readouterr()
    return code, " ".join(out.split()), err


def changed(*changes):
    return [part for each in changes for part in ("--set", each)]


LATE = "effects.economizer={temperature: auto, opens: 640 deg, closes: 690 deg, area: 1 cm^2}"
HOT = ("oil_supply.ratio=null", "oil_supply.discharge_temperature=600 K")
HOT += ("effects.separator={cooler: {outlet_temperature: 42 degC}}",)
IDLE = "effects.liquid_injection={opens: 480 deg, closes: 560 deg, area: 20 mm^2, discharge_temperature: 150 degC}"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            (LATE, "numerics.accuracy=0.01"),  # the words are those of any accuracy, in a quarter of the time
            "warning: at no economizer temperature does the port draw as much vapour as the liquid gives off: at 39.5 "
            "degC, the highest, it draws 0 times that (a larger port, or one that opens earlier)",
        ),
        (HOT, "warning: no oil flow brings the mixture to 326.9 degC: with "),
        (
            ("gas.two_phase=equilibrium", IDLE),
            "warning: the liquid injection valve stays shut: without liquid the discharge is at ",
        ),
        (("oil_supply.temperature=316 K",), "R134a condenses on it at the discharge pressure"),
    ],
    ids=["economizer", "oil flow", "injected liquid", "cold oil"],
)
def test_what_finds_no_equilibrium_or_hardly_can_be_is_a_warning_of_run(changes, words, capsys):
    code, out, _ = told(capsys, "run", COMPACT, *changed(*changes))
    assert code == 0 and words in out
    assert out.index("status: ok, with ") < out.index("warning: ") < out.index("figure ")


def test_a_machine_with_a_part_of_its_leaks_says_so_in_a_line_and_what_is_not_simulated_in_another(capsys):
    left = [part for name in ("blow_hole", "interlobe_leakage", "end_face_leakage") for part in ("--without", name)]
    code, out, _ = told(capsys, "run", PLAIN, *left)
    leaks, _, others = out.partition("leaks simulated: ")[2].partition(" not simulated: ")
    assert code == 0 and leaks == (
        "tip only; typical scenes name interlobe_leakage, blow_hole, end_face_leakage and shaft_leakage, too"
    )
    assert others.endswith("(screwsim explain says what each is)") and out.count("not simulated") == 1


@pytest.mark.parametrize(
    ("scene", "change", "words"),
    [
        (
            B,
            "operation.tip_speed=20 m/s",
            "operation.tip_speed: is given as well as operation.speed, which it states already",
        ),
        (
            B,
            "machine.displacement={flow: 9 m^3/min, at: 2950 rpm}",
            "machine.displacement: needs machine.profile.family: this profile states the size of its rotors by",
        ),
        (
            B,
            "machine.rotor_diameter=300 mm",
            "it lies inside a rotor and leaves no shaft (choose a larger one; to change",
        ),
        (B, "machine.built_in_volume_ratio=40", "40 leaves no opening for the discharge port (choose a smaller ratio)"),
        (B, "operation.condensing_temperature=1 degC", "operation.condensing_temperature: "),
        (
            PAPER,
            "machine.built_in_volume_ratio=3",
            "machine.discharge_port.opens: is given as well as machine.built_in",
        ),
        (
            PAPER,
            "oil_supply.orifice_count=3",
            "oil_supply.orifice_count: applies only to kind: displacement (remove it, or",
        ),
        (
            PAPER,
            "oil_supply.line={pressure_loss: 1 bar, flow: 30 L/min}",
            "with kind: pump the pump overcomes the loss (write it under effects.oil_pump)",
        ),
        (PAPER, "effects.motor.rated_powr=5 kW", "rated_powr: is not known; did you mean 'rated_power'?"),
        (PAPER, "operation.discharge.pressure=7", "operation.discharge.pressure: 7 has no unit (write e.g."),
    ],
)
def test_what_is_stated_twice_or_contradicts_is_refused_in_a_line_for_each(scene, change, words, capsys):
    code, out, err = told(capsys, "run", scene, "--set", change)
    assert (code, out) == (3, "") and "Traceback" not in err
    assert words in err
    assert all(": " in line and line.endswith((")", "?")) for line in err.splitlines())  # what, and the remedy


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Return a scene of rotors (b) at 100 mm as points with a micrometre of noise."""
    measured_rotors = sibling(ROOT / "docs" / "tools" / "measured_rotors.py")
    folder = tmp_path_factory.mktemp("measured")
    (folder / "lobe.csv").write_text(profile_csv(*measured_rotors.measured(measured_rotors.exact("b"), 1)))
    none = ", ".join(f"{name}: null" for name in ("male_tip_radius", "female_tip_radius", "flank_radius"))
    (folder / "scene.yaml").write_text(
        f"base: {B}\nmachine:\n  rotor_diameter: 100 mm\n  rotor_length: 110 mm\n  profile: {{kind: points, file: "
        f"lobe.csv, tolerance: 4 um, centre_distance: 80 mm, female_diameter: 100 mm, {none}, pressure_angle: null, "
        "root_radius: null}\n"
    )
    return folder / "scene.yaml"


def test_measured_points_are_shown_with_what_was_changed_of_them(measured, capsys):
    code, out, err = told(capsys, "rotors", measured)
    assert (code, err) == (0, "")
    assert " points; the faired curve misses them by " in out.partition("measured points: ")[2]
    assert " um at most, " in out and " um RMS" in out


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            "tolerance=0 um",
            "so that there is no contact (undercut, or noise: set machine.profile.tolerance, or change the curve",
        ),
        ("tolerance=1 mm", "machine.profile.tolerance: only 10 points lie 7 mm apart (7 tolerances), 20 are needed"),
    ],
)
def test_messages_of_measured_points_name_keys_of_points(measured, change, words, capsys):
    code, out, err = told(capsys, "run", measured, "--set", f"machine.profile.{change}")
    assert (code, out) == (3, "") and words in err and len(err.splitlines()) == 1
    assert "tip_radius" not in err and "flank_radius" not in err


def test_a_key_of_another_kind_of_profile_is_not_ignored_unsaid(measured, capsys):
    code, out, _ = told(capsys, "run", measured, "--set", "machine.profile.root_radius=1 mm")
    assert code == 0
    assert "warning: machine.profile.root_radius: applies only to kind: rack, and kind: points does not read it" in out


def test_plot_says_that_the_case_failed_whose_cycle_is_compared_with_measured_pressures(tmp_path, capsys):
    results, points = str(tmp_path / "kept.h5"), tmp_path / "p.csv"
    assert told(capsys, "run", COMPACT, "--set", "effects.motor.rated_power=5 kW", "-o", results)[0] == 4
    points.write_text("angle [deg],pressure [bar]\n450,1.55\n600,6.3\n")
    code, out, _ = told(capsys, "plot", results, "-o", tmp_path / "figures", "--measured", points)
    assert code == 0 and out.startswith("status: failed; the motor's load is ") and "computed minus measured" in out
    assert case_title(open_results(results), ()).startswith("failed")


def test_plot_says_with_which_case_measured_pressures_are_compared_and_takes_another(tmp_path, capsys):
    results, points = str(tmp_path / "kept.h5"), tmp_path / "p.csv"
    swept = ("--set", "sweep.operation.speed=[1000 rpm, 3000 rpm]", "--set", "output.keep=cycle")
    assert told(capsys, "sweep", PAPER, *swept, "-o", results, "--jobs", "1")[0] == 0
    points.write_text("angle_deg,pressure_bar\n450,1.55\n600,6.3\n")
    plot = ("plot", results, "-o", tmp_path / "figures", "--measured", points)
    code, out, _ = told(capsys, *plot)
    assert code == 0
    assert "at operation.speed = 3000 rpm, the best case (--at PATH=VALUE chooses another) computed minus" in out
    best = out.partition("computed minus measured ")[2].partition("bar,")[0]
    code, out, _ = told(capsys, *plot, "--at", "operation.speed=1000 rpm")
    assert code == 0 and "at operation.speed = 1000 rpm computed minus" in out
    assert out.partition("computed minus measured ")[2].partition("bar,")[0] != best
    assert told(capsys, *plot, "--at", "operation.speed=2000 rpm") == (
        2,
        "",
        "operation.speed: there is no case at 2000 rpm (there are 1000 rpm, 3000 rpm)\n",
    )
