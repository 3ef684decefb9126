"""Finished cases are used again only for the scene, code, modules and files that made them, by content."""

import importlib
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import apart
import h5py
import pytest
from result_fakes import GRID, SCENE, fake_simulate, scene
from sweep_fakes import StopAfter, assert_same, forbidden, grid_scene, sweep_of_mine

from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors import rotors
from screwsim.numerics import sources
from screwsim.results import identity, open_results
from screwsim.results.schema import identity_of
from screwsim.scene import loads
from screwsim.study.sweep import run_sweep
from screwsim.study.sweep.agreement import FileWatch, requirements_of, what_differs
from screwsim.study.sweep.cases import run_packed


def test_values_of_a_scene_are_texts_wherever_they_stand_in_it():
    text = "uncertainty: {correlated: [[a.gap, b.gap], [c]]}\nsteps: [1, {to: 2, over: [3]}]\n"
    values = {"uncertainty.correlated": "[[a.gap, b.gap], [c]]", "steps": "[1, {to: 2, over: [3]}]"}
    for name in ("a.h5", "b.h5"):
        assert identity.scene_values(text, name) == values


EFFECT = """\
from dataclasses import dataclass
from screwsim.inputs.declare import quantity
from screwsim.effects.base import Effect
from {package} import shared

@dataclass(frozen=True)
class Parameters:
    area: float = quantity("area", "of a hole", 1e-6, gt=0.0)

def build(parameters, machine):
    return []

EFFECT = Effect(name="mine", title="a hole", equations=("M12",), source="none", parameters=Parameters, build=build)
"""
AREAS = "angle_deg,area_m2\n0,0\n300,{}\n600,0\n"


@pytest.fixture
def package(tmp_path, monkeypatch) -> Path:
    """Make a package of own effects in the working folder."""
    folder = tmp_path / "identity_effects"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "shared.py").write_text("FACTOR = 1.0\n")
    (folder / "mine.py").write_text(EFFECT.format(package="identity_effects"))
    monkeypatch.chdir(tmp_path)
    return folder


def swept(chunks: int) -> str:
    """Sweep in a process of its own, stopped after some chunks; return what it says."""
    done = apart.ended(sweep_of_mine, chunks)
    assert done.code == 0, done.err
    return done.out.strip()


def test_an_edited_effect_of_ones_own_is_refused_until_it_is_as_before(package, tmp_path):
    files = "mine.py", "shared.py", "__init__.py"
    assert swept(1) == "stopped"
    for file in files:
        with edited(package / file):
            told = swept(99)
        assert f"out.h5.parts: holds results of this scene, but identity_effects/{file} has changed since; " in told
        assert told.endswith("; choose another -o to keep them (--restart computes them again)") and "\n" not in told
    assert int(swept(99)) > 0
    for file in files:
        with edited(package / file):
            told = swept(99)
        assert told.startswith(f"out.h5: holds results of this scene, but identity_effects/{file} has changed since")


@contextmanager
def edited(file: Path) -> Iterator[None]:
    """Add a line to a file, and take it away afterwards."""
    before = file.read_text()
    file.write_text(before + "# other\n")
    yield
    file.write_text(before)


def test_an_effect_that_another_import_made_anew_is_noted_anew(package, monkeypatch):
    monkeypatch.syspath_prepend(str(package.parent))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # a cache of the second's resolution would hide the edit
    own = loads(SCENE + "  identity_effects.mine:\n" + GRID)
    first = identity_of(own)
    (package / "mine.py").write_text(EFFECT.format(package="identity_effects") + "OTHER = 1\n")
    assert identity_of(own) == first  # it goes on with what it has imported
    importlib.reload(sys.modules["identity_effects.mine"])
    assert identity.differences(first, identity_of(own)) == "identity_effects/mine.py has changed since"
    for name in ("identity_effects.mine", "identity_effects.shared", "identity_effects"):
        del sys.modules[name]


def test_only_modules_of_the_users_own_are_noted(package, monkeypatch):
    monkeypatch.syspath_prepend(str(package.parent))
    (package.parent / "helpers.py").write_text("import json, numpy.linalg\n")
    (package / "mine.py").write_text(
        "import helpers\nfrom . import shared\nimport screwsim.inputs.faults, scipy.optimize\n"
    )
    importlib.invalidate_caches()
    importlib.import_module("identity_effects.mine")
    sources.record_module("identity_effects.mine", object())
    found = set(sources.recorded["identity_effects.mine"].digests)
    own = {f"identity_effects/{file}" for file in ("__init__.py", "mine.py", "shared.py")}
    assert found == own | {"helpers.py"}
    for name in ("identity_effects.mine", "identity_effects.shared", "identity_effects", "helpers"):
        del sys.modules[name]


def test_a_file_counts_by_its_content_alone(tmp_path):
    text = SCENE.replace("gap: 50 um", "gap: 50 um, area_file: area.csv") + GRID
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "area.csv").write_text(AREAS.format(1e-6))
    one, two = (loads(text, folder=str(tmp_path / name)) for name in ("one", "two"))
    assert identity_of(one) == identity_of(two)
    with pytest.raises(KeyboardInterrupt):
        run_sweep(one, tmp_path / "out.h5", jobs=1, simulate=fake_simulate, progress=StopAfter(1))
    stamp = (tmp_path / "one/area.csv").stat()
    (tmp_path / "one/area.csv").write_text(AREAS.format(2e-6))
    os.utime(tmp_path / "one/area.csv", ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    with pytest.raises(UsageError, match=r"out\.h5\.parts: .*, but area\.csv has changed since; choose another -o"):
        run_sweep(one, tmp_path / "out.h5", jobs=1, simulate=forbidden)
    assert run_sweep(two, tmp_path / "out.h5", jobs=1, simulate=fake_simulate).reused > 0


@pytest.mark.parametrize(
    ("where", "what", "told"),
    [
        (
            "screwsim.results.identity.installed_version",
            lambda *_: "7.2",
            r"CoolProp \S+ wrote it, this is 7\.2, llvmlite",
        ),
        ("screwsim.numerics.sources.package_digest", lambda: "other", r"from different sources of screwsim 0\.1\.0;"),
    ],
)
def test_other_libraries_and_other_sources_are_refused_until_a_restart(where, what, told, tmp_path, monkeypatch):
    output = tmp_path / "out.h5"
    run_sweep(grid_scene(), output, jobs=1, simulate=fake_simulate)
    before = output.read_bytes()
    monkeypatch.setattr(where, what)
    with pytest.raises(UsageError, match=told):
        run_sweep(grid_scene(), output, jobs=1, simulate=forbidden)
    assert output.read_bytes() == before
    assert run_sweep(grid_scene(), output, jobs=1, restart=True, simulate=fake_simulate).reused == 0


def test_the_digest_of_the_package_is_that_of_its_texts_that_compute(tmp_path, monkeypatch):
    package = tmp_path / "package"
    (package / "numerics").mkdir(parents=True)
    (package / "cli").mkdir()
    (package / "model.py").write_text("A = 1\n")
    monkeypatch.setattr(sources, "__file__", str(package / "numerics" / "sources.py"))
    first = sources.package_digest.__wrapped__()
    (package / "cli" / "words.py").write_text("B = 1\n")
    assert sources.package_digest.__wrapped__() == first
    (package / "model.py").write_text("A = 2\n")
    assert sources.package_digest.__wrapped__() != first


def old_file(output: Path) -> None:
    """Make a file as it was written when nothing was noted of what results depend on."""
    run_sweep(grid_scene(), output, jobs=1, simulate=fake_simulate)
    with h5py.File(output, "r+") as file:
        del file.attrs["screwsim_identity"]


def test_a_file_without_an_identity_is_read_but_not_resumed(tmp_path):
    old_file(tmp_path / "out.h5")
    assert open_results(tmp_path / "out.h5").performance["shaft_power"].shape == (3, 40)
    with pytest.raises(UsageError, match=r"from a screwsim 0\.1\.0 that did not record its code and input files"):
        run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, simulate=forbidden)
    assert run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, restart=True, simulate=fake_simulate).reused == 0


def test_parts_without_an_identity_are_not_resumed(tmp_path):
    output = tmp_path / "out.h5"
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, simulate=fake_simulate, progress=StopAfter(1))
    manifest = output.with_name("out.h5.parts") / "sweep.json"
    about = json.loads(manifest.read_text())
    manifest.write_text(json.dumps({"scene_sha256": about["scene_sha256"], "fingerprint": "", "version": "0.1.0"}))
    with pytest.raises(UsageError, match=r"out\.h5\.parts: .* that did not record its code and input files"):
        run_sweep(grid_scene(), output, jobs=1, simulate=forbidden)


def test_a_file_says_what_it_depends_on(tmp_path):
    run_sweep(scene(SCENE + GRID), tmp_path / "out.h5", jobs=1, simulate=fake_simulate)
    found = identity.unpacked(open_results(tmp_path / "out.h5").attributes["screwsim_identity"])
    assert found == identity_of(scene(SCENE + GRID))
    assert {"screwsim", "screwsim sources", "CoolProp", "llvmlite", "numpy"} <= set(found)


def test_a_profile_file_that_keeps_its_date_is_read_again(tmp_path):
    file = tmp_path / "lobe.csv"
    file.write_text("x_mm,y_mm\n0,0\n")
    stamp = file.stat()
    first = rotors._digest(str(file))
    file.write_text("x_mm,y_mm\n0,1\n")
    os.utime(file, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    assert rotors._digest(str(file)) != first


def test_a_sweep_that_is_whole_and_the_same_is_used_again(tmp_path):
    run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, simulate=fake_simulate)
    run_sweep(grid_scene(), tmp_path / "other.h5", jobs=1, simulate=fake_simulate)
    assert run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, simulate=forbidden).reused == 120
    assert_same(tmp_path / "out.h5", tmp_path / "other.h5")


def with_area(folder: Path) -> Path:
    """Make a scene whose gap is a file, and return that."""
    (folder / "area.csv").write_text(AREAS.format(1e-6))
    return folder / "area.csv"


AREA_SCENE = SCENE.replace("gap: 50 um", "gap: 50 um, area_file: area.csv") + GRID


class Edits:
    """Progress that changes a file after some parts."""

    def __init__(self, file: Path, after: int) -> None:
        self.file, self.left = file, after

    def start(self, cases: int, reused: int) -> None: ...

    def advance(self, cases: int, failed: int) -> None:
        self.left -= 1
        if not self.left:
            self.file.write_text(AREAS.format(9e-6))

    def tick(self) -> None: ...

    def stop(self) -> None: ...


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_file_that_changes_while_the_sweep_runs_ends_it_and_no_case_of_after_is_kept(jobs, tmp_path):
    file, output = with_area(tmp_path), tmp_path / "out.h5"
    swept = loads(AREA_SCENE + "output: {keep: performance}\n", folder=str(tmp_path))
    with pytest.raises(UsageError, match=r"has another area\.csv: it was changed during the sweep") as caught:
        run_sweep(swept, output, jobs=jobs, simulate=fake_simulate, progress=Edits(file, 1))
    assert "\n" not in str(caught.value) and not output.exists()
    with pytest.raises(UsageError, match=r"area\.csv has changed since"):
        run_sweep(swept, output, jobs=jobs, simulate=forbidden)
    file.write_text(AREAS.format(1e-6))
    assert run_sweep(swept, output, jobs=jobs, simulate=fake_simulate).reused > 0


def test_a_worker_that_starts_after_a_file_changed_here_is_not_to_blame(tmp_path, monkeypatch):
    file = with_area(tmp_path)
    swept = loads(AREA_SCENE + "output: {keep: performance}\n", folder=str(tmp_path))
    monkeypatch.setattr("screwsim.study.pool.workers.start_method", lambda: "spawn")
    edits = Edits(file, 1)
    monkeypatch.setattr(edits, "start", lambda *_: edits.advance(0, 0))  # before any worker is there
    with pytest.raises(UsageError, match=r"this machine has another area\.csv: it was changed during the sweep"):
        run_sweep(swept, tmp_path / "out.h5", jobs=2, simulate=fake_simulate, progress=edits)


def test_a_file_with_a_new_date_alone_ends_no_sweep(tmp_path):
    file = with_area(tmp_path)
    swept = loads(AREA_SCENE, folder=str(tmp_path))
    watch = FileWatch(requirements_of(swept)["files"], requirements_of(swept)["identity"])
    os.utime(file, ns=(1, 1))
    watch.look()


def test_a_worker_that_differs_refuses_its_cases(tmp_path, monkeypatch):
    with_area(tmp_path)
    wanted = requirements_of(loads(AREA_SCENE, folder=str(tmp_path)))
    assert what_differs(wanted) == ""
    monkeypatch.setattr(identity, "installed_version", lambda *_: "7.2")
    with pytest.raises(UsageError, match=rf"worker {os.getpid()} has CoolProp 7\.2, not \S+, has llvmlite 7\.2, not "):
        run_packed(b"", wanted, [])
    monkeypatch.undo()
    (tmp_path / "area.csv").unlink()
    assert what_differs(wanted) == "lacks area.csv"
    assert what_differs({**wanted, "own": ["nowhere.at_all"]}).startswith("cannot import an effect of the scene: No")
