"""Many points in one call: their turns side by side in the lanes of a core (`together`), or on a GPU (`on_device`)."""

from screwsim.batch.tasks import simulate_courses, together, warm_up

__all__ = ["simulate_courses", "together", "warm_up"]
