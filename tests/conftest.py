"""What holds for all tests."""

import signal

from hypothesis import HealthCheck, settings

settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])  # no wall times
settings.load_profile("any machine")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as a shell's job in the background; commands inherit it
    signal.signal(signal.SIGINT, signal.default_int_handler)
