"""What holds for all tests."""

from hypothesis import HealthCheck, settings

settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])  # no wall times
settings.load_profile("any machine")
