"""What all commands that are given a fit print of it."""

from collections.abc import Mapping

from screwsim.printing.tables import say_title, wrapped
from screwsim.screen import say
from screwsim.study.calibration.fit import Fit


def print_title(fit: Fit) -> None:
    """Print the title of a fit, or else that of its scene, where one has any."""
    say_title(fit.title or fit.scene.title)


def print_left_out(reasons: Mapping[str, str]) -> None:
    """Print the points without a solution, and why they have none."""
    for name, reason in reasons.items():
        say(wrapped(f"left out, no solution at {name}: {reason}"))
