"""What is published runs by itself: a wheel, unpacked where nothing of the checkout is, has the scenes and sources."""

import email
import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from screwsim.textfiles import CONFIGS, shipped, shipped_root

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """Return a folder with the unpacked wheel."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


@pytest.fixture
def command(site, tmp_path):
    """Return a function that runs the unpacked package's command in an empty folder."""

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
    assert shipped(name) == str(shipped_root() / name)
    assert shipped(f"{CONFIGS}/none.yaml") == f"{CONFIGS}/none.yaml" and shipped("point.yaml") == "point.yaml"
    assert shipped("configs/../pyproject.toml") == "configs/../pyproject.toml"
    (tmp_path / "configs" / "paper").mkdir(parents=True)
    (tmp_path / name).write_text("mine")
    assert shipped(name) == name


def test_metadata_says_what_it_is(site):
    (file,) = site.glob("*.dist-info/METADATA")
    told = email.message_from_string(file.read_text(encoding="utf-8"))
    assert told["Name"] == "screwsim" and told["License-Expression"] == "BSD-3-Clause"
    assert told["Requires-Python"] == ">=3.11" and told["Description-Content-Type"] == "text/markdown"
    assert {"pandas", "xarray", "report", "dask"} <= set(told.get_all("Provides-Extra"))
    assert "screwsim = screwsim.__main__:main" in (file.parent / "entry_points.txt").read_text()
    for name in ("py.typed", "export/c/map.c", "shipped/validation/limits/compare.py", "report/page/page.css"):
        assert (site / "screwsim" / name).exists(), name
