"""A text is written once; an edit of anything that it is made of, or of what writes it, makes another."""

import math
import os
import re
import shutil
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

import screwsim
from screwsim.build.parts import build_parts
from screwsim.fluid import nozzle
from screwsim.numerics import folder, kept_text, sources, store
from screwsim.numerics.kernel import Kernel, flatten, kernel, kernels_digest
from screwsim.scene import load

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


@pytest.mark.parametrize(
    "content", [b"", b"a text of another program", zlib.compress(b"\xff")], ids=["empty", "other", "bytes"]
)
def test_what_is_no_text_is_written_anew(here, content):
    """Even under the right name and with a sound digest."""
    found(Counted())
    (kept,) = here.iterdir()
    store.keep(kept.name, content)
    assert found(Counted("whole")) == "whole"
    assert found(Counted("again")) == "whole"


@pytest.mark.skipif(os.name != "posix", reason="modes of POSIX")
def test_a_text_that_others_could_have_put_there_is_not_read(here, tmp_path, monkeypatch):
    found(Counted("ours"))
    here.chmod(0o777)
    monkeypatch.setenv(folder.PRIVATE, folder.NOWHERE)
    assert found(Counted("written again")) == "written again"
    here.chmod(0o700)
    assert found(Counted("written again")) == "ours"


def test_code_that_was_edited_after_this_process_began_keeps_and_reads_nothing(here, monkeypatch):
    """A notebook that goes on with what it imported would else leave the old code's text under the new code's name."""
    found(Counted("of the edited code"))
    with monkeypatch.context() as patch:
        patch.setattr(screwsim, "BEGAN", Path(sources.__file__).stat().st_ctime)
        sources.folders_digest.cache_clear()
        assert found(Counted("of the old")) == "of the old"
    sources.folders_digest.cache_clear()
    assert found(Counted("written again")) == "of the edited code"


SPACE = outer.function.__globals__
EDITS = {
    "a constant that a kernel below reads": lambda patch: patch.setitem(SPACE, "SCALE", 2.5),
    "the text of a kernel below": lambda patch: patch.setattr(inner, "source", "def inner(x):\n    return x\n"),
    "its own text": lambda patch: patch.setattr(outer, "source", "def outer(x):\n    return inner(x) - 1.0\n"),
}


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_an_edit_of_a_kernel_or_of_all_it_uses_makes_another(monkeypatch, edit):
    before, text = kernels_digest((outer,)), flatten((outer,))
    edit(monkeypatch)
    assert flatten((outer,)) != text
    assert kernels_digest((outer,)) != before


def test_what_no_kernel_uses_makes_no_other(monkeypatch):
    before = kernels_digest((outer,))
    monkeypatch.setitem(outer.function.__globals__, "BESIDE", 4.0)
    assert kernels_digest((outer,)) == before


def test_the_digest_of_folders_is_that_of_the_texts_in_them(tmp_path, monkeypatch):
    package = tmp_path / "package"
    for name in ("numerics", "model/network", "cli"):
        (package / name).mkdir(parents=True)
    (package / "model" / "network" / "flows.py").write_text("A = 1\n")
    monkeypatch.setattr(sources, "__file__", str(package / "numerics" / "sources.py"))
    monkeypatch.setattr(screwsim, "BEGAN", math.inf)
    first = sources.folders_digest.__wrapped__("model", "numerics")
    (package / "cli" / "words.py").write_text("B = 1\n")
    assert sources.folders_digest.__wrapped__("model", "numerics") == first
    (package / "model" / "network" / "flows.py").write_text("A = 2\n")
    assert sources.folders_digest.__wrapped__("model", "numerics") != first


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


def test_another_process_writes_no_text_of_a_combination_again_and_an_edited_package_does(tmp_path, monkeypatch):
    root = Path(__file__).parents[2]
    point = root / "configs" / "paper" / "point.yaml"
    build_parts(load(point))  # CoolProp answers, or has: to import it takes longer than all of this
    known, here = folder.cache_folder().glob("coolprop-*"), tmp_path / "cache"
    here.mkdir(mode=0o700)
    for file in known:
        shutil.copy(file, here)
    monkeypatch.setenv(folder.CHOSEN, str(here))
    shutil.copytree(root / "src" / "screwsim", tmp_path / "screwsim", ignore=shutil.ignore_patterns("__pycache__"))

    def texts(how):
        command = [sys.executable, "-c", COMPOSED, str(point), how]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    first, again = texts("free"), texts("forbidden")
    assert again.returncode == 0 and again.stdout == first.stdout != ""
    edited = tmp_path / "screwsim" / "model" / "network" / "chamber.py"
    edited.write_text(edited.read_text() + "\nEDITED = True\n")
    assert "written again" in texts("forbidden").stderr


OUTSIDE = """
import sys
import screwsim.model.module_text
print(*sorted(name for name in sys.modules if name.startswith("screwsim.")))
"""


def test_all_code_that_writes_texts_lies_in_the_folders_whose_digest_counts(python):
    """What they take from elsewhere are kernels, which are spelled themselves."""
    imported = python(OUTSIDE).stdout.split()
    others = {name for name in imported if name.split(".")[1] not in ("model", "numerics")}
    assert others == {"screwsim.fluid", "screwsim.fluid.nozzle"}
    writers = (Path(sys.modules[name].__file__) for name in imported if name.startswith("screwsim.model."))
    taken = {name for path in writers for name in re.findall(r"nozzle(?:\.| import )(\w+)", path.read_text())}
    assert taken and all(isinstance(getattr(nozzle, name), Kernel) for name in taken)
