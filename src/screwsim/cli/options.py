"""What several commands share: exit codes, arguments and options, and the scene that they name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from screwsim.faults import UsageError

if TYPE_CHECKING:
    from screwsim.scene import Scene

OK, INTERNAL, USAGE, BAD_SCENE, NOT_ALL_OK, INTERRUPTED = 0, 1, 2, 3, 4, 130

SceneFile = Annotated[str, typer.Argument(metavar="SCENE", help="The scene, a YAML file.", show_default=False)]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="PATH=VALUE", help="Change one path, e.g. operation.speed='1000 rpm'."),
]
Without = Annotated[list[str] | None, typer.Option(metavar="EFFECT", help="Leave an effect out.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout, nothing else.")]
Jobs = Annotated[int | None, typer.Option(min=1, metavar="N", help="Worker processes (default: all cores).")]


def loaded(scene_file: str, overrides: Sequence[str] | None, without: Sequence[str] | None) -> Scene:
    """Return the scene of a command."""
    from screwsim.scene import load

    return load(scene_file, overrides or (), without or ())


def check_place(output: Path) -> None:
    """Raise UsageError where a run's results would replace anything but those of a run."""
    from screwsim.results import open_results
    from screwsim.results.atomic import HDF5, keep_others

    keep_others(output, HDF5)
    if output.exists() and open_results(output).shape:
        raise UsageError(f"{output}: holds results of a sweep (choose another -o, or remove it)")


def base_point(scene: Scene) -> Scene:
    """Return the scene without its sweep, as it is stored beside the result."""
    if not scene.sweep:
        return scene
    from screwsim.scene import scene_text

    base = replace(scene, sweep={})
    return replace(base, text=scene_text(base))
