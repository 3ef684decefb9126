"""A small scene in a folder of its own, and Python run anew."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from small_scene import SCENE

import screwsim

OILED = """\
oil: {density: 1000 kg/m^3, heat_capacity: 2 kJ/(kg K), transport: paper}
oil_supply: {kind: pump, ratio: 3, temperature: 293 K}
effects:
  oil_heat: {droplet_radius: 100 um, heat_transfer_coefficient: 500 W/(m^2 K)}
"""


def furnish(place: Path) -> Path:
    """Write small.yaml, swept.yaml and oiled.yaml into a folder."""
    (place / "small.yaml").write_text(SCENE)
    (place / "swept.yaml").write_text("base: small.yaml\nsweep:\n  operation.speed: [2000 rpm, 3000 rpm]\n")
    (place / "oiled.yaml").write_text("base: small.yaml\n" + OILED)
    return place


@pytest.fixture(scope="session")
def furnished() -> Callable[[Path], Path]:
    """Return the function that writes those scenes into a folder, and returns it."""
    return furnish


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder with small.yaml, swept.yaml and oiled.yaml."""
    monkeypatch.chdir(tmp_path)
    return furnish(tmp_path)


@pytest.fixture
def new_python() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Return a function that runs a new Python, with the cache of these tests, in which the package is found."""

    def call(*arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
        path = str(Path(screwsim.__file__).parents[1])
        environment = os.environ | {"PYTHONPATH": path} | variables
        return subprocess.run([sys.executable, *arguments], env=environment, capture_output=True, text=True)

    return call
