"""What holds for all tests."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])  # no wall times
settings.load_profile("any machine")

# what tests compile is kept for all runs, in the checkout where no folder is named
os.environ.setdefault("SCREWSIM_CACHE", str(Path(__file__).parents[1] / ".pytest_cache" / "screwsim"))

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as a shell's job in the background; commands inherit it
    signal.signal(signal.SIGINT, signal.default_int_handler)

SOURCES = str(Path(__file__).parents[1] / "src")
NAMES = ("SCREWSIM_CACHE", "SCREWSIM_PRIVATE_CACHE", "XDG_CACHE_HOME")


@pytest.fixture
def python() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Return a function that runs a text in a new Python, with no cache named but by `variables` (None: unset)."""

    def call(text: str, **variables: str | None) -> subprocess.CompletedProcess[str]:
        inherited = {name: value for name, value in os.environ.items() if name not in NAMES}
        changed = inherited | {"PYTHONPATH": SOURCES} | variables
        environment = {name: value for name, value in changed.items() if value is not None}
        return subprocess.run([sys.executable, "-c", text], env=environment, capture_output=True, text=True)

    return call
