"""Export: what the commands of all formats share; each is a file for another tool, in a module of its kind."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from screwsim.cli.declare import argument, option
from screwsim.cli.options import progress_bar
from screwsim.screen import say

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from screwsim.export.inputs import Input
    from screwsim.study.asked.varied import Varied


app = typer.Typer(
    help="Write files for other tools: FMU, maps for system simulation, rotor loads.",
    no_args_is_help=True,
    suggest_commands=False,
    rich_markup_mode=None,
)

SOURCE = argument("SCENE|OUT.h5", "A scene or two stages to simulate, or the results file of a sweep.")
RANGES = option(
    "PATH=LOW..HIGH", "An input of the map and its range (default: the scene's sweep); repeatable.", "--over"
)
BAR = partial(progress_bar, "export")


def announce_map(scene: Varied, inputs: Sequence[Input]) -> None:
    from screwsim.study.asked.inputs import shown_range

    ranges = []
    for one in inputs:
        others = (f"{path} {shown_range(scene, path, values[0], values[-1])}" for path, _, values in one.follows)
        together = " with ".join((shown_range(scene, one.path, one.low, one.high), *others))
        ranges.append(f"{one.name} {together}")
    say(f"export: simulating a map over {', '.join(ranges)}", err=True)


def announced_after(check: Callable[[Varied, Sequence[Input]], object]) -> Callable[[Varied, Sequence[Input]], None]:
    """Return a function that announces a map once it has passed a check."""

    def announce(scene: Varied, inputs: Sequence[Input]) -> None:
        check(scene, inputs)
        announce_map(scene, inputs)

    return announce


def write_content(output: Path, content: str | dict) -> str:
    """Write a text, or a document as JSON; return the path."""
    from screwsim.printing import write_json
    from screwsim.results.atomic import make_folder, write_text

    make_folder(output.parent)
    return write_text(output, content) if isinstance(content, str) else write_json(content, output)
