"""What is published runs by itself: a wheel, installed where nothing of the checkout is, has the scenes and sources."""

import email
import json
import os
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest
from markdown_it import MarkdownIt
from packaging.metadata import Metadata

import screwsim
from screwsim.inputs.textfiles import CONFIGS, shipped_name, shipped_root

ROOT = Path(__file__).parents[2]
pytestmark = [pytest.mark.slow, pytest.mark.around]


def build(kind: str, root: Path, folder: Path) -> None:
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(folder)]
    subprocess.run(command, cwd=root, check=True, capture_output=True)


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory) -> Path:
    """Return the folder of the unpacked source distribution."""
    folder = tmp_path_factory.mktemp("sdist")
    build("sdist", ROOT, folder)
    (packed,) = folder.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        archive.extractall(folder, filter="data")
    return folder / packed.name.removesuffix(".tar.gz")


@pytest.fixture(scope="module")
def site(unpacked, tmp_path_factory) -> Path:
    """Return a folder with nothing but the installed wheel, which was built of the source distribution."""
    folder = tmp_path_factory.mktemp("wheel")
    build("wheel", unpacked, folder)
    (wheel,) = folder.glob("*.whl")
    alone = ("--no-deps", "--no-index", "--no-compile", "--disable-pip-version-check", "-q")
    command = [sys.executable, "-m", "pip", "install", *alone, "--target", str(folder / "site"), str(wheel)]
    subprocess.run(command, check=True, capture_output=True)
    return folder / "site"


@pytest.fixture
def command(site, tmp_path):
    """Return a function that runs the installed package's command in an empty folder."""

    def call(*arguments: str) -> subprocess.CompletedProcess[str]:
        environment = os.environ | {"PYTHONPATH": str(site)}
        whole = [sys.executable, "-m", "screwsim", *arguments]
        return subprocess.run(whole, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)

    return call


def test_shipped_scenes_run_from_an_empty_folder(command, site, tmp_path):
    done = command("run", "configs/paper/point.yaml", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "ok"
    told = command("explain", "configs/two_stage/plant.stages.yaml")
    assert told.returncode == 0 and "stages" in told.stdout.lower()
    where = [sys.executable, "-c", "import screwsim; print(screwsim.__file__)"]
    environment = os.environ | {"PYTHONPATH": str(site)}
    done = subprocess.run(where, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.startswith(str(site))


def test_validation_runs_from_an_empty_folder(command):
    done = command("validate", "limits", "--json", "--jobs", "1")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["sources"]["limits"]["status"] == "ok"


def test_a_scene_that_is_there_comes_before_a_shipped_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = "configs/paper/point.yaml"
    assert shipped_name(name) == str(shipped_root() / name)
    assert shipped_name(f"{CONFIGS}/none.yaml") == f"{CONFIGS}/none.yaml" and shipped_name("point.yaml") == "point.yaml"
    assert shipped_name("configs/../pyproject.toml") == "configs/../pyproject.toml"
    (tmp_path / "configs" / "paper").mkdir(parents=True)
    (tmp_path / name).write_text("mine")
    assert shipped_name(name) == name


def test_metadata_says_what_it_is(site):
    (file,) = site.glob("*.dist-info/METADATA")
    told = email.message_from_string(file.read_text(encoding="utf-8"))
    assert told["Name"] == "screwsim" and told["License-Expression"] == "BSD-3-Clause"
    assert told["Requires-Python"] == ">=3.11" and told["Description-Content-Type"] == "text/markdown"
    assert {"pandas", "xarray", "report", "dask"} <= set(told.get_all("Provides-Extra"))
    assert "screwsim = screwsim.__main__:main" in (file.parent / "entry_points.txt").read_text()
    for name in ("py.typed", "export/c/map.c", "shipped/validation/limits/compare.py", "report/page/page.css"):
        assert (site / "screwsim" / name).exists(), name


def test_metadata_are_what_an_index_takes(site, unpacked):
    (file,) = site.glob("*.dist-info/METADATA")
    told = Metadata.from_email(file.read_bytes(), validate=True)  # raises for what an index refuses
    assert str(told.version) == screwsim.__version__ == unpacked.name.removeprefix("screwsim-")
    assert told.summary and told.author and told.keywords and told.license_files == ["LICENSE"]
    assert (file.parent / "licenses" / "LICENSE").read_text() == (ROOT / "LICENSE").read_text()
    assert {needed.name.lower() for needed in told.requires_dist or []} >= {"coolprop", "numpy", "scipy"}
    of_source = Metadata.from_email((unpacked / "PKG-INFO").read_bytes(), validate=True)
    assert of_source.version == told.version and of_source.description == told.description
    page = MarkdownIt().render(told.description or "")
    assert page.startswith("<h1>") and page.count("<pre>") >= 1 and "```" not in page


def test_what_is_installed_tells_its_version_without_a_repository(command, site):
    done = command("--version")
    assert done.stdout == f"screwsim {screwsim.__version__}\n"
    assert (site / "bin").is_dir() or (site / "Scripts").is_dir()  # the command itself


def test_the_source_distribution_is_the_checkout(unpacked):
    for name in ("CHANGELOG.md", "CITATION.cff", "LICENSE", "README.md", "constraints.txt", "scripts/test"):
        assert (unpacked / name).read_bytes() == (ROOT / name).read_bytes(), name
    for folder in ("src/screwsim", "tests", "configs", "docs", "validation", "benchmarks"):
        there, here = ({file.relative_to(root) for file in (root / folder).rglob("*.py")} for root in (unpacked, ROOT))
        assert there == here, folder
