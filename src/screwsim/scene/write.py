"""A scene as YAML: canonical, each value with its unit, in the order of the schema; or as a dict states it.

Reading the canonical text gives the same scene.
"""

import json
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from screwsim.inputs.declare import ReplaceableDefault, is_derived
from screwsim.inputs.faults import UsageError
from screwsim.scene.fields import Leaf, Section, leaves_of, scene_section, section_of
from screwsim.scene.grid import Swept, dimensions
from screwsim.scene.tolerances import together_text, tolerance_text
from screwsim.scene.types import Sample, Scene
from screwsim.scene.values import text_of

DICT_NAME = "<dict>"  # takes the place of a file name in messages


def scene_text(scene: Scene) -> str:
    """Return the YAML text that, together with its curve files, reproduces the scene.

    Absent values are left out, and those that follow from others or that another value may replace; other defaults are
    written.
    """
    lines = list(_section(scene_section(scene.machine.kind), scene, scene, ("", "")))
    lines.append("effects:" if scene.effects else "effects: {}")
    for name, active in scene.effects.items():
        at = "    ", f"effects.{name}."
        parameters = list(_section(section_of(type(active.parameters)), active.parameters, scene, at))
        lines += [f"  {_key(name)}:" if parameters else f"  {_key(name)}: {{}}", *parameters]
    lines += together_text(scene)
    lines += sweep_lines(scene, leaves_of(scene).__getitem__)
    return "\n".join(lines) + "\n"


def sweep_lines(swept: Swept, leaf_of: Callable[[str], Leaf]) -> Iterator[str]:
    """Yield the lines of a sweep, none without one; `leaf_of` gives the description of a path."""

    def listed(path: str) -> str:
        return f"{path}: [{', '.join(_scalar(leaf_of(path), value, '.') for value in swept.sweep[path])}]"

    if swept.sweep:
        yield "sweep:"
    zipped = [each.joint for each in dimensions(swept) if each.joint and each.joint.sample is None]
    for dimension in dimensions(swept):
        joint = dimension.joint
        if joint is None:
            yield f"  {listed(dimension.name)}"
        elif joint.sample is not None:
            yield from _sample(joint.sample, leaf_of)
        elif joint is zipped[0]:
            yield "  zip:"
            for group in zipped:
                yield from (f"  {'  ' if number else '- '}{listed(path)}" for number, path in enumerate(group.paths))


def _sample(sample: Sample, leaf_of: Callable[[str], Leaf]) -> Iterator[str]:
    """Yield how a sample is drawn, not its values: the seed reproduces them."""
    yield f"  sample:\n    kind: {sample.kind}\n    count: {sample.count}\n    seed: {sample.seed}\n    over:"
    for path, (kind, *values) in sample.over:
        texts = [_scalar(leaf_of(path), value, ".") for value in values]
        if kind == "any":
            yield f"      {path}: [{', '.join(texts)}]"
        else:
            yield f"      {path}: {{from: {texts[0]}, to: {texts[1]}, spacing: {kind}}}"


def _section(section: Section, value: Any, scene: Scene, at: tuple[str, str]) -> Iterator[str]:
    """Yield the lines of a section; `at` is their indent and the prefix of the paths of its values."""
    indent, above = at
    for name, item in section.fields.items():
        part = getattr(value, name)
        if part is None or is_derived(part) or isinstance(part, ReplaceableDefault):
            continue
        if isinstance(item, Section):
            inner = list(_section(item, part, scene, (indent + "  ", f"{above}{name}.")))
            yield f"{indent}{name}:" if inner else f"{indent}{name}: {{}}"
            yield from inner
        else:
            tolerance = scene.uncertain.get(f"{above}{name}")
            spread = "" if tolerance is None else tolerance_text(item, tolerance)
            yield f"{indent}{name}: {_scalar(item, part, scene.folder)}{spread}"


def _scalar(leaf: Leaf, value: Any, folder: str) -> str:
    if leaf.kind == "file":
        return quoted(relative_to(value, folder))
    if leaf.kind == "fluid" and not isinstance(value, str):
        return f"[{', '.join(map(quoted, value))}]"
    return quoted(value) if leaf.kind in ("word", "fluid") else text_of(leaf, value)


def relative_to(path: str, folder: str) -> str:
    """Return a path relative to a folder; where that is on another drive, the path itself."""
    try:
        return os.path.relpath(path, folder)
    except ValueError:  # another drive
        return path


def _key(name: str) -> str:
    return name if name.replace("_", "").replace(".", "").isalnum() else quoted(name)


def quoted(text: str) -> str:
    """Return a double-quoted YAML scalar."""
    return '"' + "".join(_escaped(letter) for letter in text) + '"'


def _escaped(letter: str) -> str:
    if letter in '"\\':
        return "\\" + letter
    code = ord(letter)
    if 0x20 <= code < 0x7F:
        return letter
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def yaml_text(given: Mapping[str, Any]) -> str:
    """Return a dict as YAML, one key a line, so that faults have a line; raise UsageError for what no file can hold."""
    lines: list[str] = []
    _write(given, "", "", lines)
    return "\n".join(lines) + "\n"


def _write(given: Mapping[str, Any], indent: str, path: str, lines: list[str]) -> None:
    for name, value in given.items():
        below = f"{path}.{name}" if path else str(name)
        if isinstance(value, Mapping) and value:
            lines.append(f"{indent}{json.dumps(str(name))}:")
            _write(value, indent + "  ", below, lines)
        else:
            lines.append(f"{indent}{json.dumps(str(name))}: {flow_text(value, below)}")


def flow_text(value: Any, path: str) -> str:
    """Return a value as YAML in one line; raise UsageError for a type that no file can hold."""
    try:
        return json.dumps(value, default=_plain, ensure_ascii=False, allow_nan=False)
    except (TypeError, ValueError):
        what = f"{str(value)[:40]} ({type(value).__name__}) cannot be written into a scene"
        raise UsageError(f"{path}: {what} (pass a number, a text such as '3000 rpm', a list or a dict)") from None


def _plain(value: Any) -> Any:
    """Return a numpy number or array, or a path, as a type that JSON knows; raise TypeError for anything else."""
    if hasattr(value, "tolist"):
        return value.tolist()
    return os.fspath(value)
