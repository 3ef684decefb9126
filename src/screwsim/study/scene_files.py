"""Scenes found or fitted by a study as files: the base and the paths that differ from it, or the whole scene."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from screwsim.effects import catalogue
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.results.atomic import check_writable, make_folder, protect_others, write_text
from screwsim.scene import Scene, leaf_of, loads, scene_text
from screwsim.scene.fields import effect_keys
from screwsim.scene.load import files_with_bases
from screwsim.scene.values import text_of
from screwsim.scene.write import quoted, relative_to
from screwsim.study.asked.inputs import shown_value

if TYPE_CHECKING:
    from screwsim.study.calibration.solve import Calibration
    from screwsim.study.stages.chain import StageChain

FIRST_LINE = "# Found by: screwsim "  # start of a scene that a study wrote
SIZE_PATHS = {"machine.displacement.flow", "machine.rotor_diameter", "machine.rotor_length", "machine.volume.max"}
VALUE_DIGITS = 7  # of a fitted value: far below its error
FITTED_LINE = "# Fitted by: screwsim calibrate"  # start of a scene that a calibration wrote


def check_scene_file(path: Path, option: str, own: str = "") -> None:
    """Raise UsageError where no scene may be written: wrong suffix, a file that no study wrote, or a refused place.

    A base of the scene file `own` is such a place: the scene would become another one, or its own base.
    """
    if path.suffix.lower() not in (".yaml", ".yml"):
        good = path.with_suffix(".yaml")
        raise UsageError(f"{option} {path}: a scene file must end in .yaml (write {option} {good})")
    protect_others(path, FIRST_LINE.encode())
    if own:
        refuse_base(path, own, f"{option} {path}")
    check_writable(path)


def refuse_base(path: Path, own: str, where: str) -> None:
    """Raise UsageError where a file that would be written is a base of the scene file `own`."""
    if os.path.realpath(path) in map(os.path.realpath, files_with_bases(own)[1:]):
        raise UsageError(f"{where}: {own} is based on this file (choose another name)")


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

    It is written whole where it replaces that scene file, which is then no base, and where it is another one than over
    it. `told` says in the first line what wrote the file: 'find x.yaml; …'.
    """
    make_folder(path.parent)
    head, found = _first_line(told), _with_sizes(found, values)
    text = head + _text_over_base(found, values, file, overrides, without, path.parent)
    if os.path.realpath(path) == os.path.realpath(file) or not _is_same_scene(text, found, path.parent):
        text = head + scene_text(replace(found, folder=os.path.abspath(path.parent)))
    return write_text(path, text)


def files_of_stages(path: Path) -> dict[str, Path]:
    """Return the files of both scenes beside that of two stages, by stage: x_first.yaml beside x.stages.yaml."""
    from screwsim.study.stages.axes import STAGE_NAMES

    return {stage: path.with_name(f"{_stem(path)}_{stage}.yaml") for stage in STAGE_NAMES}


def check_found_stages(path: Path, option: str) -> None:
    """Raise UsageError where two stages cannot be written, or where another two-stage file names the same scenes."""
    scenes = files_of_stages(path)
    for file in (path, *scenes.values()):
        check_scene_file(file, option)
    first, *_ = scenes.values()
    endings = (f"{stages}{suffix}" for stages in ("", ".stages") for suffix in (".yaml", ".yml"))
    for other in (path.with_name(f"{_stem(path)}{ending}") for ending in endings):
        if other != path and _names(other, first.name):
            raise UsageError(f"{option} {path}: would replace {first}, which {other} names (choose another name)")


def _names(file: Path, name: str) -> bool:
    """Return whether the text of a file, if it can be read, contains a name."""
    try:
        return name in file.read_text("utf-8", errors="replace")
    except OSError:
        return False


def write_found_stages(path: Path, found: StageChain, values: Mapping[str, float], told: str) -> list[str]:
    """Write two stages `found` with `values` [SI], each scene whole in a file beside `path`; return all paths."""
    from screwsim.study.stages.store import chain_text

    make_folder(path.parent)
    head = _first_line(told)
    texts = {path: chain_text(found, f"{_stem(path)}_")}
    for stage, file in files_of_stages(path).items():
        own = {name.removeprefix(f"{stage}."): each for name, each in values.items() if name.startswith(f"{stage}.")}
        scene = _with_sizes(found.by_stage[stage], own)
        texts[file] = scene_text(replace(scene, sweep={}, joints=(), folder=os.path.abspath(path.parent)))
    return [write_text(file, head + text) for file, text in texts.items()]


def _stem(path: Path) -> str:
    return path.stem.removesuffix(".stages") or path.stem


def _first_line(told: str) -> str:
    return f"{FIRST_LINE}{' '.join(told.split())}\n"


def _with_sizes(found: Scene, values: Mapping[str, float]) -> Scene:
    """Return a scene that tells in its title the sizes found, as the title may state others."""
    sizes = [f"{path} = {text_of(leaf_of(found, path), value)}" for path, value in values.items() if path in SIZE_PATHS]
    if not sizes:
        return found
    return replace(found, title="; ".join(filter(None, (found.title, f"resized: {', '.join(sizes)}"))))


def _text_over_base(
    found: Scene, values: Mapping[str, float], file: str, overrides: Sequence[str], without: Sequence[str], folder: Path
) -> str:
    tree: dict[str, Any] = {}
    for override in overrides:
        path, _, value = override.partition("=")
        if not path.strip().startswith("sweep"):
            put(tree, path.strip(), _yaml(value), found.effects)
    for name in without:
        tree.setdefault("effects", {})[name] = "off"
    for path, value in values.items():
        put(tree, path, text_of(leaf_of(found, path), value), found.effects)
    if not SIZE_PATHS.isdisjoint(values):
        tree["title"] = quoted(found.title)
    lines = [f"base: {quoted(relative_to(os.path.realpath(file), os.path.realpath(folder)))}", "sweep: null"]
    return "\n".join([*lines, *lines_of(tree)]) + "\n"


def _yaml(text: str) -> str:
    """Return the text of an override as a YAML value; without brackets it is never a mapping or a list."""
    bare = text.strip()
    plain = bare[:1] in ("{", "[", '"', "'") or (": " not in bare and " #" not in bare and not bare.startswith("- "))
    return (bare or "null") if plain else quoted(bare)


def _is_same_scene(text: str, found: Scene, folder: Path) -> bool:
    """Return whether a text yields the same scene."""
    try:
        again = loads(text, folder=str(folder))
    except (SceneError, UsageError):
        return False
    return scene_text(replace(again, folder=found.folder)) == scene_text(found)


def fitted_text(found: Calibration, folder: Path) -> str:
    """Return the YAML text of the fitted machine, to be written into a folder."""
    fit = found.fit
    tree: dict[str, Any] = {}
    for path, value in fit.changes(found.values).items():
        text = shown_value(fit.scene, path, value, VALUE_DIGITS).replace("°C", "degC")
        put(tree, path, text, fit.scene.effects)
    title = fit.title or fit.scene.title
    lines = [
        f"{FITTED_LINE} {os.path.basename(fit.name)}; {quality_in_words(found)}.",
        f"title: {quoted(f'{title}, fitted' if title else 'fitted')}",
        f"base: {quoted(relative_to(os.path.realpath(fit.scene_file), os.path.realpath(folder)))}",
        *lines_of(tree),
    ]
    return "\n".join(lines) + "\n"


def quality_in_words(found: Calibration) -> str:
    """Return the quality of the fit, in a few words."""
    text = f"chi squared {found.chi_squared:.3g} with {found.freedom} degrees of freedom"
    text += f", {len(found.fit.fitted)} points"
    return text if found.status == "ok" else f"{text}; {found.status}"


def _keys(path: str, effects: Iterable[str]) -> list[str]:
    if not path.startswith("effects."):
        return path.split(".")
    names, own = {*catalogue(), *effects}, path.removeprefix("effects.")
    name, below = (own, []) if own in names else effect_keys(path, names)
    return ["effects", name, *below]


def put(tree: dict[str, Any], path: str, text: str | dict[str, Any], effects: Iterable[str]) -> None:
    """Put a text into a tree under the keys of a dotted path.

    Names of the scene's own `effects` may contain dots. A text on the way gives place to a mapping, {} keeps one.
    """
    *above, last = _keys(path, effects)
    for name in above:
        if not isinstance(tree.get(name), dict):
            tree[name] = {}
        tree = tree[name]
    if text or not isinstance(tree.get(last), dict):
        tree[last] = text


def lines_of(tree: Mapping[str, Any], indent: str = "") -> Iterator[str]:
    """Yield the lines of a tree of texts as YAML."""
    for name, item in tree.items():
        if isinstance(item, dict) and item:
            yield f"{indent}{name}:"
            yield from lines_of(item, indent + "  ")
        else:
            yield f"{indent}{name}: {item}"
