"""Let the tests import `flat`, whatever the import mode; a new Python that compiles into a folder."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import screwsim

sys.path.insert(0, str(Path(__file__).parent))
NAMES = ("SCREWSIM_CACHE", "SCREWSIM_PRIVATE_CACHE", "XDG_CACHE_HOME")


@pytest.fixture
def python() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Return a function that runs a text in a new Python, with no cache named but by `variables` (None: unset)."""

    def call(text: str, **variables: str | None) -> subprocess.CompletedProcess[str]:
        inherited = {name: value for name, value in os.environ.items() if name not in NAMES}
        changed = inherited | {"PYTHONPATH": str(Path(screwsim.__file__).parents[1])} | variables
        environment = {name: value for name, value in changed.items() if value is not None}
        return subprocess.run([sys.executable, "-c", text], env=environment, capture_output=True, text=True)

    return call
