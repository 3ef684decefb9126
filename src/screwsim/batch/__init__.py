"""Many points in one call: turns are integrated side by side in the lanes of a core (`together`), or on a GPU."""

from screwsim.batch.tasks import prepare_for_gpu, simulate_courses, together, warm_up

__all__ = ["prepare_for_gpu", "simulate_courses", "together", "warm_up"]
