"""What a misuse of the command answers: its exit code, and one line with the remedy on stderr."""

import errno

import pytest

from screwsim import cli
from screwsim.inputs.faults import MOST_LINES

OWN = """\
from dataclasses import dataclass

from screwsim.effects.base import Effect, FlowPath
from screwsim.numerics.kernel import kernel


@dataclass(frozen=True)
class Parameters:
    pass


@kernel
def area(phi):
    return 1e-6


def build(parameters, machine):
    return [FlowPath(to="nowhere", area=area, values={}, breakpoints=())]


EFFECT = Effect(name="hole", title="", equations=(), source="", parameters=Parameters, build=build)
"""


def test_unknown_effect_is_a_bad_scene_at_its_line(folder, command):
    text = (folder / "small.yaml").read_text().replace("tip_leakage", "tip_leackage")
    (folder / "bad.yaml").write_text(text)
    answer = command("run", "bad.yaml")
    line = 1 + text.splitlines().index("  tip_leackage: {gap: 50 um}")
    message = f"bad.yaml:{line}:3: effects.tip_leackage: is not known; did you mean 'tip_leakage'?\n"
    assert answer == (3, "", message)


def test_bad_unit_is_a_bad_scene_at_its_column(folder, command):
    (folder / "bad.yaml").write_text("base: small.yaml\nmachine:\n  rotor_diameter: 160 bar\n")
    answer = command("explain", "bad.yaml")
    message = "bad.yaml:3:19: machine.rotor_diameter: '160 bar' is not a length (write e.g. '128 mm')\n"
    assert answer == (3, "", message)


def test_every_fault_has_a_line(folder, command):
    (folder / "bad.yaml").write_text("base: small.yaml\nmachine:\n  rotor_diameter: 1\noperation:\n  speed: 50 Hz\n")
    answer = command("sweep", "bad.yaml")
    assert answer.code == 3
    assert [line.split(": ")[0] for line in answer.err.splitlines()] == ["bad.yaml:3:19", "bad.yaml:5:10"]


def test_of_very_many_faults_the_first_are_told_and_the_others_counted(folder, command):
    (folder / "bad.yaml").write_text("base: small.yaml\n" + "".join(f"key{i}: 1\n" for i in range(MOST_LINES + 7)))
    code, out, err = command("run", "bad.yaml")
    first, *_, last = lines = err.splitlines()
    assert (code, out, len(lines)) == (3, "", MOST_LINES + 1)
    assert first.startswith("bad.yaml:2:1: key0: is not known") and last == "… and 7 more faults (fix these first)"


def test_missing_file_is_a_bad_scene(folder, command):
    answer = command("run", "nowhere.yaml")
    assert (answer.code, answer.out) == (3, "")
    assert answer.err.startswith("nowhere.yaml")
    assert answer.err.endswith(
        "cannot be read: No such file or directory (name an existing scene file, saved as UTF-8)\n"
    )


def test_override_is_checked_like_the_file(folder, command):
    answer = command("run", "small.yaml", "--set", "operation.speed=1000")
    assert answer.code == 3
    assert "operation.speed: 1000 has no unit (write e.g. '3000 rpm')" in answer.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("run", "small.yaml", "--set", "operation.speed"),
            "--set operation.speed: is not PATH=VALUE (write e.g. --set operation.speed='1000 rpm')\n",
        ),
        (
            ("run", "small.yaml", "--without", "blow_hole"),
            "--without blow_hole: that effect is not active in this scene "
            "(active: suction_port, discharge_port, tip_leakage)\n",
        ),
        (
            ("sweep", "small.yaml"),
            "small.yaml: has no sweep (add a sweep: block, or --set 'sweep.operation.speed=[1000 rpm, 3000 rpm]'; "
            "one point is simulated by screwsim run)\n",
        ),
        (
            ("sweep", "swept.yaml", "--scheduler", "nowhere.json"),
            "nowhere.json: is neither an address nor a file (give tcp://HOST:PORT, or the file that "
            "`dask scheduler --scheduler-file FILE` writes)\n",
        ),
        (
            ("sweep", "swept.yaml", "--scheduler", "s.json", "--jobs", "2"),
            "--jobs counts workers on this machine; a --scheduler has its own (remove one of the two)\n",
        ),
    ],
)
def test_usage_error_is_one_line(folder, command, arguments, message):
    assert command(*arguments) == (2, "", message)


@pytest.mark.parametrize(
    "arguments",
    [
        ("rum",),
        ("run",),
        ("run", "small.yaml", "--jason"),
        ("sweep", "swept.yaml", "--jobs", "0"),
        ("sweep", "swept.yaml", "--case-limit", "0"),
        (),
    ],
)
def test_arguments_without_sense_are_usage_errors(folder, command, arguments):
    answer = command(*arguments)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("Usage: screwsim")


def _fail(*_: object, **__: object) -> None:
    raise ZeroDivisionError("float division\nby zero")


def test_internal_error_is_told_without_traceback(folder, command, monkeypatch):
    monkeypatch.setattr(cli.options, "loaded_scene", _fail)
    monkeypatch.delenv("SCREWSIM_DEBUG", raising=False)
    answer = command("explain", "small.yaml")
    assert (answer.code, answer.out) == (1, "")
    first, second = answer.err.splitlines()
    assert first == "internal error: ZeroDivisionError: float division by zero"
    assert "please report it" in second


MUCH = "Unable to allocate 3.73 TiB for an array with shape (512, 1000000000) and data type float64"


@pytest.mark.parametrize(
    ("error", "told", "more"),
    [
        (MemoryError(), "", ""),
        (OSError(errno.ENOMEM, "Cannot allocate memory"), "", ""),
        (MemoryError(MUCH), f": {MUCH}", "; where it is more than the machine has, ask for less"),
    ],
)
def test_a_lack_of_memory_is_told_with_what_to_do(folder, command, monkeypatch, error, told, more):
    def refused(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(cli.options, "loaded_scene", refused)
    monkeypatch.delenv("SCREWSIM_DEBUG", raising=False)
    answer = command("explain", "small.yaml")
    assert (answer.code, answer.out) == (2, "")
    (line,) = answer.err.splitlines()
    assert line.startswith(f"the system gives this process no more memory{told} (end other programs, ")
    assert line.endswith(f"or use fewer --jobs{more})")
    monkeypatch.setenv("SCREWSIM_DEBUG", "1")
    shown = command("explain", "small.yaml").err.splitlines()
    assert shown[0] == "Traceback (most recent call last):" and shown[-1] == line


def test_debugging_shows_the_traceback(folder, command, monkeypatch):
    monkeypatch.setattr(cli.options, "loaded_scene", _fail)
    monkeypatch.setenv("SCREWSIM_DEBUG", "1")
    answer = command("explain", "small.yaml")
    assert answer.code == 1
    assert answer.err.startswith("Traceback")


@pytest.mark.parametrize(
    ("given", "hint"),
    [
        (("sweep", "swept.yaml"), "; the same command begins anew, as no block was finished"),
        (("sweep", "begun.yaml"), "; the same command resumes the sweep"),
        (("sweep", "swept.yaml", "-oresults/begun.h5"), "; the same command resumes the sweep"),
        (("explain", "small.yaml"), ""),
    ],
)
def test_interrupt_has_its_own_code(folder, command, monkeypatch, given, hint):
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(cli.options, "loaded_scene", interrupt)
    (folder / "results" / "begun.h5.parts").mkdir(parents=True)
    answer = command(*given)
    assert (answer.code, answer.out) == (130, "")
    assert answer.err == f"interrupted{hint}\n"


def test_file_of_another_scene_is_refused(folder, command):
    (folder / "out.h5").write_bytes(b"not HDF5")
    answer = command("sweep", "swept.yaml", "-o", "out.h5")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("out.h5: is not an HDF5 file")


def test_unknown_fluid_is_a_bad_scene(folder, command):
    answer = command("run", "small.yaml", "--set", "gas.fluid=r134A")
    message = "gas.fluid: 'r134A' is not a fluid or predefined blend of CoolProp; did you mean 'R134a'?"
    assert answer == (3, "", f"--set gas.fluid=r134A: {message}\n")


def test_no_saturation_at_the_pressure_is_a_bad_scene(folder, command):
    changes = ["operation.suction={pressure: 50 bar, superheat: 5 K, temperature: null}"]
    changes += ["operation.discharge.pressure=60 bar"]
    answer = command("explain", "small.yaml", *(word for change in changes for word in ("--set", change)))
    assert (answer.code, answer.out) == (3, "")
    assert "operation.suction.superheat: R134a has no saturation at the suction pressure 50 bar" in answer.err


def test_an_effect_of_ones_own_that_cannot_be_built_is_told_by_its_name(folder, command):
    (folder / "own_holes").mkdir()
    (folder / "own_holes" / "hole.py").write_text(OWN)
    (folder / "holed.yaml").write_text("base: small.yaml\neffects: {own_holes.hole: {}}\n")
    for name in ("run", "explain"):
        answer = command(name, "holed.yaml")
        assert answer.code == 2
        assert answer.err.startswith("effects.own_holes.hole: cannot be built or compiled (TypeError: ")
        assert "'nowhere'" in answer.err and answer.err.endswith("fix that module\n")


def test_openings_beyond_the_life_are_told(folder, command):
    for name, text in (
        ("slide_valve", "{position: 1, slot_area: 1 cm^2, closes: 900 deg}"),
        ("bypass", "{source: chamber, area: 1 cm^2, opens: 700 deg, passage: 90 deg}"),
    ):
        (folder / "late.yaml").write_text(f"base: small.yaml\neffects:\n  {name}: {text}\n")
        answer = command("run", "late.yaml")
        assert answer.code in (2, 3)
        assert f"effects.{name}" in answer.err and len(answer.err.splitlines()) == 1


@pytest.mark.parametrize("verb", ["run", "sweep"])
def test_a_name_that_no_disk_takes_is_a_wrong_use(verb, folder, command):
    scene = "swept.yaml" if verb == "sweep" else "small.yaml"
    answer = command(verb, scene, "-o", "x" * 300 + ".h5")
    assert answer.code == 2
    assert "File name too long (" in answer.err.splitlines()[-1]
