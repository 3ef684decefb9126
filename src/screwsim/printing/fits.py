"""Output shared by all commands that take a fit."""

from collections.abc import Mapping

from screwsim.printing.tables import print_scene_title, wrapped
from screwsim.screen import say
from screwsim.study.calibration.fit import Fit


def print_title(fit: Fit) -> None:
    """Print the title of a fit, or else that of its scene, if it has one."""
    print_scene_title(fit.title or fit.scene.title)


def print_left_out(reasons: Mapping[str, str]) -> None:
    """Print the points without a solution, and the reasons."""
    for name, reason in reasons.items():
        say(wrapped(f"left out: {name} has no solution: {reason}"))
