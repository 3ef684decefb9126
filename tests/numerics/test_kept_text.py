"""A text is written once; an edit of anything that it is made of, or of what writes it, makes another."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from screwsim.numerics import folder, kept_text, sources
from screwsim.numerics.kernel import flatten, kernel, spelled

SCALE = 2.0
BESIDE = 3.0


@kernel
def inner(x):
    return SCALE * x


@kernel
def outer(x):
    return inner(x) + 1.0


class Counted:
    """Writes a text, and counts how often."""

    def __init__(self, text="text"):
        self.text, self.times = text, 0

    def __call__(self):
        self.times += 1
        return self.text


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Name a folder of this test as the cache; return it."""
    monkeypatch.setenv(folder.CHOSEN, str(tmp_path / "cache"))
    return tmp_path / "cache"


def found(write, of=("named", 1)):
    return kept_text.kept_text(("numerics",), (outer,), of, write)


def test_a_text_is_written_once(here):
    write = Counted()
    assert [found(write), found(write)] == ["text", "text"]
    assert write.times == 1


def test_what_it_is_made_of_makes_another(here):
    found(Counted())
    other = Counted("other")
    assert found(other, of=("named", 2)) == "other" and other.times == 1


def test_what_a_crash_left_of_it_is_written_anew(here):
    found(Counted())
    (kept,) = here.iterdir()
    kept.write_bytes(kept.read_bytes()[:-1])
    assert found(Counted("whole")) == "whole"


SPACE = outer.function.__globals__
EDITS = {
    "a constant that a kernel below reads": lambda patch: patch.setitem(SPACE, "SCALE", 2.5),
    "the text of a kernel below": lambda patch: patch.setattr(inner, "source", "def inner(x):\n    return x\n"),
    "its own text": lambda patch: patch.setattr(outer, "source", "def outer(x):\n    return inner(x) - 1.0\n"),
}


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_an_edit_of_a_kernel_or_of_all_it_uses_makes_another(monkeypatch, edit):
    before, text = spelled((outer,)), flatten((outer,))
    edit(monkeypatch)
    assert flatten((outer,)) != text
    assert spelled((outer,)) != before


def test_what_no_kernel_uses_makes_no_other(monkeypatch):
    before = spelled((outer,))
    monkeypatch.setitem(outer.function.__globals__, "BESIDE", 4.0)
    assert spelled((outer,)) == before


def test_the_digest_of_folders_is_that_of_the_texts_in_them(tmp_path, monkeypatch):
    package = tmp_path / "package"
    for name in ("numerics", "model/network", "cli"):
        (package / name).mkdir(parents=True)
    (package / "model" / "network" / "flows.py").write_text("A = 1\n")
    monkeypatch.setattr(sources, "__file__", str(package / "numerics" / "sources.py"))
    first = sources.of_folders.__wrapped__("model", "numerics")
    (package / "cli" / "words.py").write_text("B = 1\n")
    assert sources.of_folders.__wrapped__("model", "numerics") == first
    (package / "model" / "network" / "flows.py").write_text("A = 2\n")
    assert sources.of_folders.__wrapped__("model", "numerics") != first


COMPOSED = """
import sys
from screwsim.scene import load
from screwsim.build.parts import build_parts
from screwsim.model import module_text
from screwsim.model.compose import compose

if sys.argv[2] == "forbidden":
    def none(*_):
        raise AssertionError("written again")
    module_text._written = none
composition = compose(build_parts(load(sys.argv[1])))
print(composition.text, composition.together())
"""


def test_another_process_writes_no_text_of_a_combination_again_and_an_edited_package_does(here, tmp_path):
    root = Path(__file__).parents[2]
    shutil.copytree(root / "src" / "screwsim", tmp_path / "screwsim", ignore=shutil.ignore_patterns("__pycache__"))

    def texts(how):
        command = [sys.executable, "-c", COMPOSED, str(root / "configs" / "paper" / "point.yaml"), how]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    first, again = texts("free"), texts("forbidden")
    assert again.returncode == 0 and again.stdout == first.stdout != ""
    edited = tmp_path / "screwsim" / "model" / "network" / "chamber.py"
    edited.write_text(edited.read_text() + "\nEDITED = True\n")
    assert "written again" in texts("forbidden").stderr
