"""A scene as a program is given it: a path, a dict, YAML text, or a scene; and the same scene with other values."""

import os
from collections.abc import Iterable, Mapping
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.scene.load import load, loads
from screwsim.scene.mapped import flow
from screwsim.scene.types import Scene
from screwsim.scene.write import scene_text

_TAKES = "a path, a dict as in the file, YAML text, or a Scene of screwsim.load"


def scene_of(given: Any) -> Scene:
    """Return the scene that is meant by a path, a dict, a YAML text or a scene itself.

    A text is YAML where it has more than one line, or a colon or brace and names no file. Files that a dict or a text
    names are found from where the program runs. Raise `SceneError` with all faults, `UsageError` for anything else.
    """
    if isinstance(given, Scene):
        return given
    if isinstance(given, str) and _is_text(given):
        return loads(given)
    if isinstance(given, str | os.PathLike | Mapping):
        return load(given)
    raise UsageError(f"{type(given).__name__} is no scene (pass {_TAKES})")


def _is_text(given: str) -> bool:
    if "\n" in given:
        return True
    return (": " in given or given.lstrip().startswith("{")) and not os.path.exists(given)


def changed(scene: Scene, values: Mapping[str, Any], without: Iterable[str] = ()) -> Scene:
    """Return the scene with other values at dotted paths, read and checked as `--set` does; and without some effects.

    A text is read as in a file ('3000 rpm', 'off'), None takes a value out. Raise `SceneError` or `UsageError`.
    """
    texts = {path: value if isinstance(value, str) else flow(value, path) for path, value in values.items()}
    overrides = [f"{path}={text}" for path, text in texts.items()]
    return loads(scene.text or scene_text(scene), "<scene>", scene.folder, overrides, without, told="with_: ")
