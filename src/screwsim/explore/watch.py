"""Watch over the files of the explored scene: the page shows their values, so no answer may come from later ones."""

import os
import sys
from collections.abc import Iterable

from screwsim.inputs.textfiles import MOST_YAML, Unreadable, read_text, shipped_name, stamp
from screwsim.results.identity import file_identity
from screwsim.scene.yaml_tree import Position, compose


class Watch:
    """The contents of files at its making, which comes before they are read."""

    def __init__(self, paths: Iterable[str]) -> None:
        self._stamps = {path: stamp(path) for path in paths}
        self._began = {path: _content(path) for path in self._stamps}

    def changed(self) -> str:
        """Return in words which file has another content now, and the remedy; '' where none has."""
        for path, known in self._stamps.items():
            now = stamp(path)
            if now == known:
                continue
            if _content(path) != self._began[path]:
                return f"{path} has changed since this page was made (end screwsim explore and start it again)"
            self._stamps[path] = now
        return ""


def files_of(file: str) -> list[str]:
    """Return the paths of a scene's file and its bases, as far as they can be read."""
    found: list[str] = []
    path: str | None = shipped_name(file)
    while path is not None and path not in found:
        found.append(path)
        path = _base_of(path)
    return found


def modules_of(names: Iterable[str]) -> list[str]:
    """Return the paths of imported modules."""
    return [path for name in names if (path := getattr(sys.modules.get(name), "__file__", None))]


def _base_of(path: str) -> str | None:
    """Return the path of the base of a scene's file; None where it has none."""
    try:
        root = compose(read_text(path, MOST_YAML), Position(0, path), [])
    except Unreadable:
        return None
    base = root.value.get("base") if root is not None and isinstance(root.value, dict) else None
    if base is None or not isinstance(base.value, str):
        return None
    return os.path.normpath(os.path.join(os.path.dirname(path), base.value))


def _content(path: str) -> str:
    return file_identity({path: path}).popitem()[1]
