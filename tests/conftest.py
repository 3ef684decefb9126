"""What holds for all tests."""

import os
import signal
from pathlib import Path

from hypothesis import HealthCheck, settings

settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])  # no wall times
settings.load_profile("any machine")

# what tests compile is kept for all runs, in the checkout where no folder is named
os.environ.setdefault("SCREWSIM_CACHE", str(Path(__file__).parents[1] / ".pytest_cache" / "screwsim"))

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as a shell's job in the background; commands inherit it
    signal.signal(signal.SIGINT, signal.default_int_handler)
