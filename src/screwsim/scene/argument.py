"""A scene from whatever a program passes (a path, a dict, YAML text, a scene); and a scene with some values changed."""

import os
from collections.abc import Iterable, Mapping
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.scene.load import load, loads
from screwsim.scene.types import Scene
from screwsim.scene.write import flow_text, scene_text

_TAKES = "a path, a dict as in the file, YAML text, or a Scene of screwsim.load"


def scene_of(given: Any) -> Scene:
    """Return the scene given as a path, a dict, YAML text, or a scene itself.

    A text counts as YAML if it has more than one line, or if it has a colon or brace and is not the name of a file.
    Files named in a dict or a text are relative to the working directory. Raise `SceneError` with all faults, and
    `UsageError` for anything else.
    """
    if isinstance(given, Scene):
        return given
    if isinstance(given, str) and _is_text(given):
        return loads(given)
    if isinstance(given, str | os.PathLike | Mapping):
        return load(given)
    raise UsageError(f"{type(given).__name__} is not a scene (pass {_TAKES})")


def _is_text(given: str) -> bool:
    if "\n" in given:
        return True
    return (": " in given or given.lstrip().startswith("{")) and not os.path.exists(given)


def changed_scene(scene: Scene, values: Mapping[str, Any], without: Iterable[str] = ()) -> Scene:
    """Return the scene with other values at dotted paths, read and checked as by `--set`, and without some effects.

    A text is read as in a file ('3000 rpm', 'off'); None removes a value. Raise `SceneError` or `UsageError`.
    """
    texts = {path: value if isinstance(value, str) else flow_text(value, path) for path, value in values.items()}
    overrides = [f"{path}={text}" for path, text in texts.items()]
    return loads(scene.text or scene_text(scene), "<scene>", scene.folder, overrides, without, told="with_: ")
