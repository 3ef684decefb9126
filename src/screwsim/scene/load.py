"""Load a scene: file, base, overrides, typed sections and cross-checks; all faults are reported together."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from shlex import quote
from typing import Any

from screwsim.effects import catalogue
from screwsim.inputs.arguments import FILE, TEXT, Kind, as_list, checked_arguments
from screwsim.inputs.faults import Fault, UsageError
from screwsim.inputs.suggestions import did_you_mean, nearest
from screwsim.inputs.textfiles import MOST_YAML, Unreadable, read_text, shipped_name
from screwsim.machine.kinds import MACHINES, TWIN_SCREW
from screwsim.scene.checks import check_files, cross_check
from screwsim.scene.derived_values import with_derived_values
from screwsim.scene.fields import gauge_texts, leaf_paths, scene_section
from screwsim.scene.file_kinds import other_file
from screwsim.scene.model_errors import BLOCK, read_model_error
from screwsim.scene.sections import find_kind, read_ambient, read_effects, read_section
from screwsim.scene.sweep import read_sweep
from screwsim.scene.tolerances import WrittenTolerance, read_tolerances, split_tolerances
from screwsim.scene.types import FixedDict, Scene
from screwsim.scene.units import gauge_pressures_over
from screwsim.scene.values import shown
from screwsim.scene.write import DICT_NAME, flow_text, scene_text, yaml_text
from screwsim.scene.yaml_tree import (
    OVERRIDE,
    LocatedFault,
    LocatedFaults,
    Node,
    Position,
    child_of,
    compose,
    merge,
    one_line,
    pointer,
)

SET = "--set "  # prefix of an override in messages
LONGEST_TOLD = 80  # characters of an override that messages repeat; of a longer mapping or list the path alone
MOST_BASES = 32  # longest chain of bases
SceneLike = Scene | str | os.PathLike[str] | Mapping[str, Any]  # what `scene_of` takes
_SCENES = "a path, a dict as in the file, YAML text, or a Scene of screwsim.load"
FILE_OR_DICT = Kind(
    lambda given: isinstance(given, Mapping) or FILE.holds(given), "neither the path of a file nor a dict"
)


def scene_of(given: Any) -> Scene:
    """Return the scene given as a path, a dict, YAML text, or a scene itself.

    A text counts as YAML if it has more than one line, or if it has a colon or brace and is not the name of a file.
    Files named in a dict or a text are relative to the working directory. Raise `SceneError` with all faults, and
    `UsageError` for anything else.
    """
    if isinstance(given, Scene):
        return given
    if isinstance(given, str):
        yaml = (": " in given or given.lstrip().startswith("{")) and not os.path.exists(given)
        return loads(given) if "\n" in given or yaml else load(given)
    if isinstance(given, os.PathLike | Mapping):
        return load(given)
    raise UsageError(f"{type(given).__name__} is not a scene (pass {_SCENES})")


def changed_scene(scene: Scene, values: Mapping[str, Any], without: Iterable[str] = ()) -> Scene:
    """Return the scene with other values at dotted paths, read and checked as by `--set`, and without some effects.

    A text is read as in a file ('3000 rpm', 'off'); None removes a value. Raise `SceneError` or `UsageError`.
    """
    texts = {path: value if isinstance(value, str) else flow_text(value, path) for path, value in values.items()}
    texts |= gauge_texts(scene, (*values, *(f"effects.{name}" for name in without)))
    overrides = [f"{path}={text}" for path, text in texts.items()]
    return loads(scene.text or scene_text(scene), "<scene>", scene.folder, overrides, without, told="with_: ")


@checked_arguments(path=FILE_OR_DICT, stage=TEXT)
def load(
    path: str | os.PathLike[str] | Mapping[str, Any],
    overrides: Iterable[str] = (),
    without: Iterable[str] = (),
    stage: str = "",
) -> Scene:
    """Return the scene of a YAML file or a dict, with `PATH=VALUE` overrides applied and the named effects removed.

    `stage` is put before the path of an override in messages, as the user wrote it ('first.'). Raise `SceneError` with
    one line for each fault, and `UsageError` for an override or an effect's name that makes no sense.
    """
    if isinstance(path, Mapping):
        return loads(yaml_text(path), DICT_NAME, overrides=overrides, without=without)
    name = shipped_name(path)
    problems = LocatedFaults()
    start = Position.start_of(name)
    root = _read_file(name, start, (os.path.realpath(name),), problems)
    return _finish(root, start, overrides, without, problems, stage)


@checked_arguments(text=TEXT, name=TEXT, folder=FILE, told=TEXT)
def loads(
    text: str,
    name: str = "<text>",
    folder: str = ".",
    overrides: Iterable[str] = (),
    without: Iterable[str] = (),
    told: str = SET,
) -> Scene:
    """Return the scene of a YAML text; files and a base are relative to `folder`.

    `told` is put before an override in messages about its faults.
    """
    problems = LocatedFaults()
    start = Position(0, name, folder=os.path.abspath(folder))
    return _finish(_read_text(text, start, (), problems), start, overrides, without, problems, told=told)


def _finish(
    root: Node | None,
    start: Position,
    overrides: Iterable[str],
    without: Iterable[str],
    problems: LocatedFaults,
    stage: str = "",
    told: str = SET,
) -> Scene:
    overrides, without = as_list(overrides), as_list(without)  # they may be iterators, or a single text
    if root is None:
        raise problems.error()
    for number, override in enumerate(overrides):
        there = replace(start, rank=OVERRIDE + number, line=0, column=0)
        root = _override(root, override, there, problems, told + stage)
    root = _remove(root, without)
    root, given = split_tolerances(root)
    root, ambient = read_ambient(root, problems)
    with gauge_pressures_over(ambient):
        scene = _read(root, given, start.folder, problems)
    if problems or scene is None:
        raise LocatedFaults(_of_stage(problem, stage) for problem in problems).error()
    return replace(scene, text=scene_text(scene))


def _of_stage(problem: LocatedFault, stage: str) -> LocatedFault:
    """Return a fault of an override with its paths as written for a stage; any other fault unchanged."""
    if not stage or problem.place.rank < OVERRIDE:
        return problem
    what = re.sub(r"(?<=did you mean ')(?=[a-z_]+\.)", stage, problem.what)
    return replace(problem, path=f"{stage}{problem.path}", what=what)


def _read_file(
    name: str, start: Position, trail: tuple[str, ...], problems: LocatedFaults, at: LocatedFault | None = None
) -> Node | None:
    """Return the tree of a file and its bases; `at` says where and how it was named, `trail` which files led to it."""
    try:
        text = read_text(name, MOST_YAML)
    except Unreadable as error:
        what = f"cannot be read: {error} (name an existing scene file, saved as UTF-8)"
        if error.hdf5:
            what = (
                "is a file of results, not a scene "
                f"(screwsim scene {quote(name)} -o again.yaml writes the scene that it contains)"
            )
        elif at is None and os.path.isfile(f"{name}.yaml"):
            what = f"cannot be read: {error} (there is {name}.yaml)"
        elif at is None and (near := _near_file(name)) is not None:
            what = f"cannot be read: {error}; did you mean '{near}'?"
        there = start.at(error.line, error.column)
        problems.append(LocatedFault(there, "", what) if at is None else replace(at, what=f"{at.what} {what}"))
        return None
    return _read_text(text, start, trail, problems)


def _near_file(name: str) -> str | None:
    """Return the scene file whose name is nearest to that of a missing file in its folder; None without one."""
    folder, own = os.path.split(name)
    if os.path.lexists(name) or not os.path.isdir(folder or "."):
        return None
    near = nearest(own, [each for each in os.listdir(folder or ".") if each.endswith((".yaml", ".yml"))])
    return None if near is None else os.path.join(folder, near)


def _read_text(text: str, start: Position, trail: tuple[str, ...], problems: LocatedFaults) -> Node | None:
    """Return the tree of a text merged over its base, or None after a fault was added."""
    before = len(problems)
    root = compose(text, start, problems)
    if root is None:
        if len(problems) == before:
            needed = [name for name, item in scene_section().fields.items() if item.required]
            problems.add(start, "", f"is empty (write at least {', '.join(needed)})")
        return None
    if not isinstance(root.value, dict):
        problems.add(root.place, "", f"is {shown(root.value)}, not a mapping (write lines such as machine: …)")
        return None
    other = other_file(root.value, start.source)
    if other is not None:
        problems.add(root.place, "", other)
        return None
    content = dict(root.value)
    base = content.pop("base", None)
    above = replace(root, value=content)
    if base is None or base.value is None:
        return above
    below = _read_base(base, trail, problems)
    return None if below is None else merge(below, above)  # without the base, nearly all keys would be reported missing


def _read_base(node: Node, trail: tuple[str, ...], problems: LocatedFaults) -> Node | None:
    if not isinstance(node.value, str):
        problems.add(node.place, "base", f"{shown(node.value)} is not the name of a file (write e.g. point.yaml)")
        return None
    path = os.path.join(node.place.folder, node.value)
    real = os.path.realpath(path)
    at = LocatedFault(node.place, "base", shown(node.value))
    if real in trail or len(trail) > MOST_BASES:
        again = "is based on this file again" if real in trail else f"is the base of more than {MOST_BASES} files"
        problems.add(node.place, "base", f"{at.what} {again} (a chain of bases must end)")
        return None
    if not os.path.lexists(path):
        remedy = f"name a scene file as seen from the folder of this one, {os.path.abspath(node.place.folder)}"
        problems.add(node.place, "base", f"{at.what} does not exist ({remedy})")
        return None
    source = os.path.normpath(os.path.join(os.path.dirname(node.place.source), node.value))
    start = Position(node.place.rank + 1, source, folder=os.path.dirname(os.path.abspath(path)))
    return _read_file(path, start, (*trail, real), problems, at)


def files_with_bases(file: str) -> list[str]:
    """Return the paths of a scene's file and its bases, as far as they can be read."""
    found: list[str] = []
    path: str | None = shipped_name(file)
    while path is not None and path not in found:
        found.append(path)
        path = _base_of(path)
    return found


def _base_of(path: str) -> str | None:
    """Return the path of the base of a scene's file; None where it has none."""
    try:
        root = compose(read_text(path, MOST_YAML), Position(0, path), LocatedFaults())
    except Unreadable:
        return None
    base = root.value.get("base") if root is not None and isinstance(root.value, dict) else None
    if base is None or not isinstance(base.value, str):
        return None
    return os.path.normpath(os.path.join(os.path.dirname(path), base.value))


def _override(root: Node, override: str, place: Position, problems: LocatedFaults, told: str) -> Node:
    """Return the tree changed by one `PATH=VALUE`; `told` is put before the override in messages."""
    path, equals, text = override.partition("=")
    path = path.strip()
    if not equals or not all(part.strip() for part in path.split(".")):
        example = f"{told}operation.speed='1000 rpm'"
        raise UsageError(f"{told}{one_line(override)}: is not PATH=VALUE (write e.g. {example})")
    if path == "base":
        raise UsageError(f"{told}base=…: a base must be stated in the file (write it there, or name the other scene)")
    whole = len(override) <= LONGEST_TOLD or text.lstrip()[:1] not in ("{", "[")
    place = replace(place, source=f"{told}{override if whole else f'{path}=…'}")
    node = _override_value(text, place, path, problems)
    if node is None:
        return root
    keys = _keys(root, path, node)
    there = child_of(root, *keys)
    if node.value == {} and there is not None and isinstance(there.value, dict) and there.value:
        out = "off" if path.startswith("effects.") else "null"
        what = f"{{}} changes nothing, as it is merged into what is there (write {out} to remove that)"
        problems.add(place, path, what)
    for name in reversed(keys):
        node = Node({name: node}, place, place)
    return merge(root, node)


def _override_value(text: str, place: Position, path: str, problems: LocatedFaults) -> Node | None:
    before = len(problems)
    node = compose(text, place, problems, path)
    if len(problems) > before:
        return None
    if node is None:
        return Node(None, place, place)
    if isinstance(node.value, dict | list) and text.lstrip()[:1] not in ("{", "["):
        return Node(text, place, place)  # 'a: b' and '- a' are plain text here
    return replace(node, key=place)


def _keys(root: Node, path: str, value: Node) -> list[str]:
    """Return the keys of a dotted path: names of user-defined effects have dots, and paths after `sweep.` are one key.

    So are those inside a sample; other keys of a sample are separate.
    """
    head, _, rest = path.partition(".")
    if head == "sweep" and rest:
        return path.split(".", 3 if rest.startswith("sample.") else 1)
    if head != "effects" or "." not in rest or rest.partition(".")[0] in catalogue():
        return path.split(".")
    if child_of(root, "effects", rest) is not None or isinstance(value.value, dict):
        return [head, rest]
    name, _, parameter = rest.rpartition(".")
    return [head, name, parameter]


def _remove(root: Node, without: Iterable[str]) -> Node:
    """Return the tree without the named effects."""
    effects = root.value.get("effects")
    named = dict(effects.value) if effects is not None and isinstance(effects.value, dict) else {}
    for name in without:
        if name not in named:
            raise UsageError(f"--without {name}: {_not_active(name, list(named))}")
        del named[name]
    if not without or effects is None:
        return root
    return replace(root, value={**root.value, "effects": replace(effects, value=named)})


def _not_active(name: str, named: list[str]) -> str:
    active = ", ".join(named) or "none"
    if "," in name and all(part.strip() in named for part in name.split(",")):
        return f"takes one effect at a time (write {' '.join(f'--without {part.strip()}' for part in name.split(','))})"
    hint = did_you_mean(name.removeprefix("effects."), named)
    return f"that effect is not active in this scene{hint} (active: {active})"


def _machine_kind(root: Node, problems: LocatedFaults) -> str:
    """Return the machine kind that a tree names; the default where it names none, or one that does not exist."""
    named = child_of(root, "machine", "kind")
    name = named.value if named is not None else None
    if named is None or not isinstance(name, str) or "." not in name:
        return name if name in tuple(MACHINES) else TWIN_SCREW
    with problems.at(named.place, "machine.kind", f"{shown(name)} "):
        find_kind(name)
        return name
    return TWIN_SCREW


def _paths(root: Node, kind: str) -> list[str]:
    """Return all valid paths: those of sections and values, known effects, and the parameters of active effects."""
    effects = root.value.get("effects")
    named = effects.value if effects is not None and isinstance(effects.value, dict) else {}
    known = catalogue()
    leaves = leaf_paths({name: known[name].parameters for name in named if name in known}, kind)
    above = [path[:place] for path in leaves for place, letter in enumerate(path) if letter == "."]
    return list(dict.fromkeys([*leaves, *above, *(f"effects.{name}" for name in known)]))


def _read(root: Node, given: Mapping[str, WrittenTolerance], folder: str, problems: LocatedFaults) -> Scene | None:
    """Return the typed scene, or None after faults were added; cross-checks wait until every field is valid."""
    kind = _machine_kind(root, problems)
    paths = _paths(root, kind)
    scene = read_section(scene_section(kind), root, "", problems, ("base", "effects", "sweep", BLOCK), paths)
    # faults of a machine of unknown kind may be no faults of the kind that is meant
    first = next((problem for problem in problems if problem.path == "machine.kind"), None)
    if first is not None:
        problems[:] = [problem for problem in problems if not problem.path.startswith("machine.") or problem is first]
    effects = read_effects(root.value.get("effects"), problems)
    sweep, joints = read_sweep(root.value.get("sweep"), root, effects, kind, problems)
    if problems or scene is None:
        return None
    scene = with_derived_values(
        replace(scene, effects=FixedDict(effects), sweep=FixedDict(sweep), joints=joints, folder=folder)
    )
    uncertain, correlated = read_tolerances(given, root, scene, problems)
    named = read_model_error(root.value.get(BLOCK), problems)
    scene = replace(scene, uncertain=FixedDict(uncertain), correlated=correlated, model_error=named)
    faults: list[Fault] = [*cross_check(scene), *check_files(scene)]
    problems += [LocatedFault(pointer(root, fault.path), fault.path, fault.what) for fault in faults]
    return scene
