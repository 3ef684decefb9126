"""Scenes found by a study as files: the base and the paths that differ from it, or where needed the whole scene."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from screwsim.effects import catalogue
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.results.atomic import make_folder, protect_others, write_text
from screwsim.scene import Scene, leaf_of, loads, scene_text
from screwsim.scene.values import text_of
from screwsim.scene.write import quoted
from screwsim.study.calibration.scene import keys, lines_of, put

FIRST_LINE = "# Found by: screwsim "  # start of a scene that a study wrote
SIZE_PATHS = {"machine.displacement.flow", "machine.rotor_diameter", "machine.rotor_length", "machine.volume.max"}


def check_scene_file(path: Path, option: str = "-o") -> None:
    """Raise UsageError where no scene may be written: wrong suffix, or an existing file that no study wrote."""
    if path.suffix.lower() not in (".yaml", ".yml"):
        good = path.with_suffix(".yaml")
        raise UsageError(f"{option} {path}: a scene file must end in .yaml (write {option} {good})")
    protect_others(path, FIRST_LINE.encode())


def write_found(
    path: Path,
    found: Scene,
    values: Mapping[str, float],
    file: str,
    overrides: Sequence[str],
    without: Sequence[str],
    told: str,
) -> str:
    """Write the scene `found` with `values` [SI] over a scene file and its overrides, and return the path.

    `told` says in the first line what wrote the file: 'find x.yaml; …'.
    """
    make_folder(path.parent)
    head = f"{FIRST_LINE}{' '.join(told.split())}\n"
    sizes = [f"{path} = {text_of(leaf_of(found, path), value)}" for path, value in values.items() if path in SIZE_PATHS]
    if sizes:  # the title may state another size
        found = replace(found, title="; ".join(filter(None, (found.title, f"resized: {', '.join(sizes)}"))))
    text = head + _text_over_base(found, values, file, overrides, without, path.parent)
    if not _is_same_scene(text, found, path.parent):
        text = head + scene_text(replace(found, folder=os.path.abspath(path.parent)))
    return write_text(path, text)


def _text_over_base(
    found: Scene, values: Mapping[str, float], file: str, overrides: Sequence[str], without: Sequence[str], folder: Path
) -> str:
    tree: dict[str, Any] = {}
    for override in overrides:
        path, _, value = override.partition("=")
        if not path.strip().startswith("sweep"):
            _put_text(tree, path.strip(), _yaml(value))
    for name in without:
        tree.setdefault("effects", {})[name] = "off"
    for path, value in values.items():
        _put_text(tree, path, text_of(leaf_of(found, path), value))
    if not SIZE_PATHS.isdisjoint(values):
        _put_text(tree, "title", quoted(found.title))
    lines = [f"base: {quoted(os.path.relpath(os.path.realpath(file), os.path.realpath(folder)))}", "sweep: null"]
    return "\n".join([*lines, *lines_of(tree)]) + "\n"


def _yaml(text: str) -> str:
    """Return the text of an override as a YAML value; without brackets it is never a mapping or a list."""
    bare = text.strip()
    plain = bare[:1] in ("{", "[", '"', "'") or (": " not in bare and " #" not in bare and not bare.startswith("- "))
    return (bare or "null") if plain else quoted(bare)


def _put_text(tree: dict[str, Any], path: str, text: str) -> None:
    effect = path.removeprefix("effects.")
    put(tree, ["effects", effect] if effect != path and effect in catalogue() else keys(path), text)


def _is_same_scene(text: str, found: Scene, folder: Path) -> bool:
    """Return whether a text yields the same scene."""
    try:
        again = loads(text, folder=str(folder))
    except (SceneError, UsageError):
        return False
    return scene_text(replace(again, folder=found.folder)) == scene_text(found)
