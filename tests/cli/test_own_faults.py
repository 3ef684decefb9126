"""An effect of the user's own that ends or kills the program, or fails, is told as its fault."""

import subprocess
import sys
from pathlib import Path

import apart
import pytest

import screwsim.simulate  # noqa: F401 - the module, not the function of that name
from screwsim.numerics.trial import how_it_died
from screwsim.results import open_results

OWN = """\
import os
from dataclasses import dataclass
from screwsim.inputs.declare import number
from screwsim.effects.base import Effect, PowerLoss
{on_import}

@dataclass(frozen=True)
class Parameters:
    size: float = number("of nothing", 1.0)

def power(known):
    {in_power}
    return 1.0

def check(parameters, scene):
    if scene.operation.speed > 250.0:
        {in_check}
    return []

def build(parameters, machine):
    {in_build}
    return [PowerLoss("mechanical_power", power)]

EFFECT = Effect(
    name="end", title="", equations=(), source="", parameters=Parameters, build=build, check=check
)
"""
PLACES = ("on_import", "in_power", "in_check", "in_build")
HOME = "own_ends"


@pytest.fixture
def own(folder, request):
    """Return a function that writes an effect with words at some places; each test has a package of its own."""
    package = f"{HOME}_{abs(hash(request.node.name))}"
    (folder / package).mkdir()

    def write(**words: str) -> str:
        text = OWN.format(**dict.fromkeys(PLACES, "pass") | words)
        (folder / package / "end.py").write_text(text)
        (folder / "ended.yaml").write_text(f"base: small.yaml\neffects: {{{package}.end: {{}}}}\n")
        grid = "sweep: {operation.speed: [2000 rpm, 3000 rpm]}\n"
        (folder / "ends.yaml").write_text("base: ended.yaml\n" + grid)
        return f"{package}.end"

    yield write
    for name in [name for name in sys.modules if name.startswith(package)]:
        del sys.modules[name]
    sys.path[:] = [path for path in sys.path if Path(path) != folder]


@pytest.mark.parametrize("end", ["import sys; sys.exit(0)", "raise SystemExit", "exit()"])
def test_an_end_on_import_is_a_fault_of_the_scene(end, own, command):
    name = own(on_import=end)
    for verb in (["run"], ["explain"], ["sweep", "--set", "sweep.operation.speed=[1000 rpm, 2000 rpm]"]):
        answer = command(verb[0], "ended.yaml", *verb[1:])
        assert (answer.code, answer.out) == (3, "")
        assert len(answer.err.splitlines()) == 1
        assert f": effects.{name}: cannot be imported (it ends the program, by SystemExit" in answer.err


WRONG = {
    "a key that is not there": ("KEYS = {}['size']", "(KeyError: 'size')"),
    "a limit of a field that there is not": (
        "from screwsim.inputs.declare import quantity\nSIZE = quantity('area', 'of nothing', usual='10 mm^2')",
        "(TypeError: usual: no such keyword of a declared field; known: gt, ge, lt, le, hardly, "
        "remedy, otherwise, auto)",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_wrong_in_it_on_import_is_a_fault_of_the_scene(wrong, own, command):
    text, told = WRONG[wrong]
    name = own(on_import=text)
    answer = command("run", "ended.yaml")
    assert (answer.code, answer.out) == (3, "")
    assert f": effects.{name}: fails on import {told}; fix that module" in answer.err


def test_a_death_on_import_is_a_fault_of_the_scene(own, folder, new_python):
    name = own(on_import="os._exit(0)")
    answer = new_python("-m", "screwsim", "run", "ended.yaml")
    assert (answer.returncode, answer.stdout) == (3, "")
    [line] = answer.stderr.splitlines()
    assert f": effects.{name}: cannot be imported (a process that imported it died with exit code 0)" in line


def test_an_end_while_it_is_built_is_told(own, command):
    name = own(in_build="raise SystemExit(0)")
    for verb in ("run", "explain"):
        answer = command(verb, "ended.yaml")
        assert (answer.code, answer.out) == (2, "")
        assert answer.err.startswith(f"effects.{name}: cannot be built or compiled (SystemExit: ")


@pytest.mark.parametrize(
    ("end", "told"), [("raise SystemExit(0)", "ends the program (SystemExit: 0)"), ("1 / 0", "fails (ZeroDivision")]
)
def test_an_end_of_a_case_fails_it(end, told, own, command, folder):
    name = own(in_power=end)
    answer = command("run", "ended.yaml")
    assert answer.code == 4 and f"effects.{name}: {told}" in " ".join(answer.out.split())
    answer = command("sweep", "ends.yaml", "-o", "ends.h5", "--jobs", "2")
    assert answer.code == 4 and "2 cases: 0 ok, 2 failed" in answer.out
    assert all(message.startswith(f"effects.{name}: {told}") for message in open_results("ends.h5").messages)


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_an_end_of_a_check_fails_its_case(jobs, own, command):
    own(in_check="raise SystemExit(0)")
    answer = command("sweep", "ends.yaml", "-o", "ends.h5", "--jobs", jobs, "--set", "operation.speed=2000 rpm")
    assert answer.code == 4 and "2 cases: 1 ok, 1 failed" in answer.out
    assert "SystemExit: 0" in answer.out


@pytest.mark.parametrize(
    ("place", "death", "how"),
    [
        ("in_build", "os._exit(0)", "with exit code 0"),
        ("in_power", "os._exit(3)", "with exit code 3"),
        ("in_power", "os.kill(os.getpid(), 11)", "by signal 11 (SIGSEGV)"),
    ],
)
@pytest.mark.parametrize("verb", ["run", "sweep"])
def test_a_death_of_the_process_is_told_with_the_effects_of_ones_own(verb, place, death, how, own, folder):
    name = own(**{place: death})
    answer = apart.ended(apart.command, verb, "ends.yaml" if verb == "sweep" else "ended.yaml", "-o", "out.h5")
    assert (answer.code, answer.out) == (2, "")
    [line] = answer.err.splitlines()
    assert line.startswith(f"effects.{name}: a process that built, compiled and ran them died {how}; fix the module")
    assert not Path("out.h5").exists()


def test_a_scene_without_own_effects_has_no_child(folder, command, monkeypatch):
    monkeypatch.setattr(sys.modules["screwsim.simulate"], "how_it_died", lambda call: "unwanted")
    assert command("run", "small.yaml").code == 0


def test_own_effects_are_tried_once(own, command, monkeypatch):
    own()
    calls = []
    monkeypatch.setattr(sys.modules["screwsim.simulate"], "how_it_died", lambda call: calls.append(call) or "")
    assert command("run", "ended.yaml").code == 0
    assert command("run", "ended.yaml").code == 0
    assert len(calls) == 1


def test_an_exception_is_no_death():
    assert how_it_died(lambda: 1 / 0) == "" == how_it_died(lambda: None) == how_it_died(sys.exit)


ENDLESS = """\
import os, time
from screwsim.numerics.trial import how_it_died
how_it_died(lambda: (os.write(2, f"{os.getpid()}\\n".encode()), time.sleep(600)))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="no child is tried")
def test_what_is_tried_ends_with_the_program_that_tries_it():
    with subprocess.Popen([sys.executable, "-c", ENDLESS], stderr=subprocess.PIPE, text=True) as program:
        assert program.stderr is not None
        assert int(program.stderr.readline()) != program.pid
        program.kill()
        assert program.stderr.read() == ""  # the end of its last writer, the child
