"""Load a scene: file, base, overrides, typed sections, cross-checks; every fault at once."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace

from screwsim.effects import catalogue
from screwsim.faults import Fault, SceneError, UsageError
from screwsim.machine.kinds import MACHINES, TWIN_SCREW
from screwsim.scene.checks import check_files, cross_check
from screwsim.scene.fields import scene_section
from screwsim.scene.sections import read_effects, read_section
from screwsim.scene.sweep import read_sweep
from screwsim.scene.types import Scene
from screwsim.scene.values import shown
from screwsim.scene.write import scene_text
from screwsim.scene.yaml_tree import Node, Place, Problem, compose, merge, one_line, pointer

OVERRIDE = 1_000_000  # rank of the first override: after all files


def load(path: str | os.PathLike[str], overrides: Iterable[str] = (), without: Iterable[str] = ()) -> Scene:
    """Return the scene of a YAML file, changed by `PATH=VALUE` overrides and without the named effects.

    Raises `SceneError` with one line a fault, `UsageError` for an override or effect name that makes no sense.
    """
    name = os.fspath(path)
    problems: list[Problem] = []
    start = Place(0, name, folder=os.path.dirname(os.path.abspath(name)))
    root = _read_file(name, start, (os.path.realpath(name),), problems)
    return _finish(root, start, overrides, without, problems)


def loads(
    text: str, name: str = "<text>", folder: str = ".", overrides: Iterable[str] = (), without: Iterable[str] = ()
) -> Scene:
    """Return the scene of a YAML text; files and a base are found relative to `folder`."""
    problems: list[Problem] = []
    start = Place(0, name, folder=os.path.abspath(folder))
    return _finish(_read_text(text, start, (), problems), start, overrides, without, problems)


def _finish(
    root: Node | None, start: Place, overrides: Iterable[str], without: Iterable[str], problems: list[Problem]
) -> Scene:
    overrides, without = list(overrides), list(without)  # they may be iterators
    if root is None:
        raise SceneError([str(problem) for problem in sorted(set(problems), key=_order)])
    for number, override in enumerate(overrides):
        root = _override(root, override, replace(start, rank=OVERRIDE + number, line=0, column=0), problems)
    scene = _typed(_remove(root, without), start.folder, problems)
    if problems or scene is None:
        unique = list(dict.fromkeys(problems))
        raise SceneError([str(problem) for problem in sorted(unique, key=_order)])
    return replace(scene, text=scene_text(scene))


def _order(problem: Problem) -> Place:
    return problem.place


def _read_file(
    name: str, start: Place, trail: tuple[str, ...], problems: list[Problem], at: Problem | None = None
) -> Node | None:
    """Return the tree of a file and its bases; `at` says where and how it was named, `trail` the files on the way."""
    try:
        with open(name, encoding="utf-8-sig") as stream:
            text = stream.read()
    except (OSError, ValueError) as error:  # ValueError: not UTF-8, or a name with a null character
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        what = f"cannot be read: {reason} (name an existing scene file, saved as UTF-8)"
        problems.append(Problem(start, "", what) if at is None else replace(at, what=f"{at.what} {what}"))
        return None
    return _read_text(text, start, trail, problems)


def _read_text(text: str, start: Place, trail: tuple[str, ...], problems: list[Problem]) -> Node | None:
    """Return the tree of a text merged over its base, or None after a fault was added."""
    before = len(problems)
    root = compose(text, start, problems)
    if root is None:
        if len(problems) == before:
            problems.append(Problem(start, "", f"is empty (write at least {', '.join(_required())})"))
        return None
    if not isinstance(root.value, dict):
        what = f"is {shown(root.value)}, not a mapping (write lines such as machine: …)"
        problems.append(Problem(root.place, "", what))
        return None
    content = dict(root.value)
    base = content.pop("base", None)
    above = replace(root, value=content)
    if base is None or base.value is None:
        return above
    below = _read_base(base, trail, problems)
    return above if below is None else merge(below, above)


def _required() -> list[str]:
    return [name for name, item in scene_section().fields.items() if item.required]


def _read_base(node: Node, trail: tuple[str, ...], problems: list[Problem]) -> Node | None:
    at = Problem(node.place, "base", "")
    if not isinstance(node.value, str):
        problems.append(replace(at, what=f"{shown(node.value)} is not the name of a file (write e.g. point.yaml)"))
        return None
    path = os.path.join(node.place.folder, node.value)
    real = os.path.realpath(path)
    at = replace(at, what=shown(node.value))
    if real in trail:
        problems.append(replace(at, what=f"{at.what} is based on this file again (a chain of bases must end)"))
        return None
    source = os.path.normpath(os.path.join(os.path.dirname(node.place.source), node.value))
    start = Place(node.place.rank + 1, source, folder=os.path.dirname(os.path.abspath(path)))
    return _read_file(path, start, (*trail, real), problems, at)


def _override(root: Node, override: str, place: Place, problems: list[Problem]) -> Node:
    """Return the tree changed by one `PATH=VALUE`."""
    path, equals, text = override.partition("=")
    path = path.strip()
    if not equals or not all(part.strip() for part in path.split(".")):
        raise UsageError(f"--set {one_line(override)}: is not PATH=VALUE (write e.g. --set operation.speed='1000 rpm')")
    if path == "base":
        raise UsageError("--set base=…: a base belongs into the file (write it there, or name the other scene)")
    place = replace(place, source=f"--set {override}")
    node = _override_value(text, place, path, problems)
    if node is None:
        return root
    for name in reversed(_keys(root, path, node)):
        node = Node({name: node}, place, place)
    return merge(root, node)


def _override_value(text: str, place: Place, path: str, problems: list[Problem]) -> Node | None:
    before = len(problems)
    node = compose(text, place, problems, path)
    if len(problems) > before:
        return None
    if node is None:
        return Node(None, place, place)
    if isinstance(node.value, dict | list) and text.lstrip()[:1] not in ("{", "["):
        return Node(text, place, place)  # 'a: b' and '- a' are words here
    return replace(node, key=place)


def _keys(root: Node, path: str, value: Node) -> list[str]:
    """Return the keys of a dotted path: all after `sweep.` is one key, and names of own effects have dots."""
    head, _, rest = path.partition(".")
    if head == "sweep" and rest:
        return [head, *_sweep_keys(rest)]
    if head != "effects" or "." not in rest or rest.partition(".")[0] in catalogue():
        return path.split(".")
    effects = root.value.get("effects")
    named = effects.value if effects is not None and isinstance(effects.value, dict) else {}
    if rest in named or isinstance(value.value, dict):
        return [head, rest]
    name, _, parameter = rest.rpartition(".")
    return [head, name, parameter]


def _sweep_keys(rest: str) -> list[str]:
    """Return the keys after `sweep.`: a path is one key, also that of a sample; else those of the sample."""
    if not rest.startswith("sample."):
        return [rest]
    first, *inner = rest.removeprefix("sample.").split(".", 1)
    return ["sample", first, *inner]


def _remove(root: Node, without: Iterable[str]) -> Node:
    """Return the tree without the named effects."""
    effects = root.value.get("effects")
    named = dict(effects.value) if effects is not None and isinstance(effects.value, dict) else {}
    for name in without:
        if name not in named:
            active = ", ".join(named) or "none"
            raise UsageError(f"--without {name}: that effect is not active in this scene (active: {active})")
        del named[name]
    if not without or effects is None:
        return root
    return replace(root, value={**root.value, "effects": replace(effects, value=named)})


def _machine_kind(root: Node) -> str:
    """Return the kind of machine that a tree names; the default where it names none, or none that there is."""
    machine = root.value.get("machine")
    named = machine.value.get("kind") if machine is not None and isinstance(machine.value, dict) else None
    return named.value if named is not None and named.value in tuple(MACHINES) else TWIN_SCREW


def _typed(root: Node, folder: str, problems: list[Problem]) -> Scene | None:
    """Return the typed scene, or None after faults were added; cross-checks wait until every field is valid."""
    kind = _machine_kind(root)
    scene = read_section(scene_section(kind), root, "", problems, also=("base", "effects", "sweep"))
    effects = read_effects(root.value.get("effects"), problems)
    sweep, joints = read_sweep(root.value.get("sweep"), root, effects, kind, problems)
    if problems or scene is None:
        return None
    scene = replace(scene, effects=effects, sweep=sweep, joints=joints, folder=folder)
    faults: list[Fault] = [*cross_check(scene), *check_files(scene)]
    problems += [Problem(pointer(root, fault.path), fault.path, fault.what) for fault in faults]
    return scene
