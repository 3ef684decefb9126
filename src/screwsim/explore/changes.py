"""Changes that a page may make to a scene: numbers, choices and effects; never a file, a module or a text.

As a change comes from a browser, it is read as a value of its field and written again: no text of a page ever becomes
YAML.
"""

import json
import shlex
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from screwsim.effects.base import Effect
from screwsim.inputs.declare import KINDS
from screwsim.results.schema import named_files
from screwsim.scene import Scene, load
from screwsim.scene.fields import FIXED, Leaf, leaf_paths
from screwsim.scene.left_out import suitable_effects
from screwsim.scene.load import files_with_bases
from screwsim.scene.tolerances import tolerance_text
from screwsim.scene.units import Refused
from screwsim.scene.values import convert, shown, text_of
from screwsim.scene.write import quoted
from screwsim.study.scene_files import lines_of, put
from screwsim.study.sweep.agreement import FileWatch

# kinds of fields; only the command may state a fluid, a file or a word
CHANGEABLE_KINDS = {*KINDS, "number", "count", "choice"}
LONGEST_VALUE = 60  # characters of a value
MOST_CHANGES = 400  # most changes at once


@dataclass(frozen=True)
class SceneArguments:
    """The command's arguments: a scene's file, overrides including the effects left out; and the resulting scene.

    Two watches guard the scene's own files, and those that it names, user-defined modules among them.
    """

    file: str
    overrides: tuple[str, ...]
    scene: Scene
    watches: tuple[FileWatch, ...] = field(default=(), compare=False)

    def changed(self) -> str:
        """Return in words which file has changed since the scene was opened, and the remedy; '' where none has."""
        path = next((path for watch in self.watches for path in watch.changed()), "")
        remedy = "end screwsim explore and start it again"
        return f"{path} has changed since this page was made ({remedy})" if path else ""


@dataclass(frozen=True)
class Changes:
    """A page's request: values by dotted path, as users write them, and effects that are on or off."""

    values: Mapping[str, Any]
    effects: Mapping[str, bool]


def read_changes(raw: Any) -> Changes:
    """Return the changes sent by a page ({set: {path: value}, effects: {name: true}}); raise Refused."""
    if not isinstance(raw, dict) or not raw.keys() <= {"set", "effects"}:
        raise Refused("the settings are not a mapping of set and effects (reload the page)")
    values, effects = raw.get("set", {}), raw.get("effects", {})
    if not isinstance(values, dict) or not isinstance(effects, dict) or len(values) + len(effects) > MOST_CHANGES:
        raise Refused(f"set and effects are not mappings, or hold more than {MOST_CHANGES} changes (reload the page)")
    if not all(isinstance(effect, bool) for effect in effects.values()):
        raise Refused("an effect is neither on nor off: true or false (reload the page)")
    if not all(map(str.isprintable, (*values, *effects))):  # half a character could not even be reported
        raise Refused("a name in the settings has unprintable characters (reload the page)")
    return Changes(values, effects)


def open_base(file: str, overrides: Iterable[str] = (), without: Iterable[str] = ()) -> SceneArguments:
    """Return the scene that a command names, without its sweep; raise SceneError and UsageError as `load` does."""
    overrides, without = tuple(overrides), tuple(without)
    own = _watched(files_with_bases(file))  # before they are read: no answer may come from later contents
    scene = load(file, [*overrides, "sweep=null"], without)
    modules = [path for name in scene.own if (path := getattr(sys.modules.get(name), "__file__", None))]
    watches = (own, _watched([*named_files(scene).values(), *modules]))
    return SceneArguments(file, (*overrides, *(f"effects.{name}=off" for name in without)), scene, watches)


def _watched(paths: Iterable[str]) -> FileWatch:
    return FileWatch({path: path for path in paths})


def possible_effects(scene: Scene) -> dict[str, Effect]:
    """Return the effects that a page may switch on: those of the scene, and the catalogue's that fit its machine."""
    return {name: active.effect for name, active in scene.effects.items()} | suitable_effects(scene)


def active_effects(scene: Scene, effects: Mapping[str, bool]) -> dict[str, Effect]:
    """Return the effects that are on with these switches; raise Refused for one that a page may not switch."""
    known = possible_effects(scene)
    for name in effects:
        if name not in known:
            raise Refused(f"effects.{name[:LONGEST_VALUE]}: a page can switch the effects of this machine only")
    return {name: effect for name, effect in known.items() if effects.get(name, name in scene.effects)}


def changeable_fields(scene: Scene, effects: Mapping[str, Effect]) -> dict[str, Leaf]:
    """Return the fields that a page may change, by dotted path, with the given effects on."""
    leaves = leaf_paths({name: effect.parameters for name, effect in effects.items()}, scene.machine.kind)
    return {path: leaf for path, leaf in leaves.items() if leaf.kind in CHANGEABLE_KINDS and path not in FIXED}


def overrides_of(base: SceneArguments, changes: Changes) -> list[str]:
    """Return the changes as PATH=VALUE of `--set`, each value as the program itself writes it; raise Refused.

    Values of effects that are off are ignored. A value that has a tolerance in the scene keeps it.
    """
    on = active_effects(base.scene, changes.effects)
    leaves, found = changeable_fields(base.scene, on), []
    for name, wanted in changes.effects.items():
        if wanted != (name in base.scene.effects):
            found.append(f"effects.{name}={'{}' if wanted else 'off'}")
    off = [f"effects.{name}." for name in possible_effects(base.scene) if name not in on]
    for path, raw in changes.values.items():
        if not path.startswith(tuple(off)):
            found.append(f"{path}={_value(leaves.get(path), path, raw)}{_tolerance(base.scene, leaves, path, raw)}")
    return found


def _tolerance(scene: Scene, leaves: Mapping[str, Leaf], path: str, raw: Any) -> str:
    """Return the tolerance that a value has in the scene, as written after the value in YAML."""
    known = scene.uncertain.get(path)
    return "" if known is None or raw is None else tolerance_text(leaves[path], known)


def _value(leaf: Leaf | None, path: str, raw: Any) -> str:
    """Return a value as YAML text; raise Refused."""
    if leaf is None:
        raise Refused(f"{path[:LONGEST_VALUE]}: a page can change numbers, choices and effects of the scene only")
    if raw is None:
        return "null"
    if isinstance(raw, str) and len(raw) > LONGEST_VALUE:
        raise Refused(f"{path}: has more than {LONGEST_VALUE} characters")
    if leaf.kind == "choice" and raw not in leaf.limits["options"]:
        raise Refused(f"{path}: {shown(raw)} is not an option (choose from: {', '.join(leaf.limits['options'])})")
    try:
        return text_of(leaf, convert(leaf, raw))
    except Refused as refusal:
        raise Refused(f"{path}: {refusal}") from None


def scene_of(base: SceneArguments, overrides: Iterable[str]) -> Scene:
    """Return the scene with these changes, as loaded by `screwsim run`."""
    return load(base.file, [*_all_overrides(base, overrides), "sweep=null"])


def _all_overrides(base: SceneArguments, overrides: Iterable[str]) -> list[str]:
    """Return the overrides of the command and of a page, each path once, as `--set` takes it.

    An effect switched on by the page is no longer off; a mapping is merged into what the command gives.
    """
    later = list(overrides)
    again = {each for each in base.overrides if each.endswith("=off") and each.replace("=off", "={}") in later}
    kept = [each for each in later if each.replace("={}", "=off") not in again]
    replaced = {each.partition("=")[0] for each in kept if not each.endswith("}")}
    left = [each for each in base.overrides if each not in again and each.partition("=")[0].strip() not in replaced]
    return [*left, *kept]


def shell_command(base: SceneArguments, overrides: Iterable[str]) -> str:
    """Return the shell command for the same simulation."""
    words = ["screwsim", "run", base.file]
    for override in _all_overrides(base, overrides):
        words += ["--set", override]
    return shlex.join(words)


def python_text(base: SceneArguments, overrides: Iterable[str]) -> str:
    """Return the Python code for the same simulation."""
    every = _all_overrides(base, overrides)
    inner = "".join(f"\n    {json.dumps(each, ensure_ascii=False)}," for each in every)
    sets = f", [{inner}\n]" if every else ""
    called = f"screwsim.load({json.dumps(base.file, ensure_ascii=False)}{sets})"
    return f"import screwsim\n\nscene = {called}\nresult = screwsim.simulate(scene)\nprint(result.performance)\n"


def yaml_text(base: SceneArguments, overrides: Iterable[str]) -> str:
    """Return a scene file of its own: the command's scene as base, by its full path, and the changes."""
    tree: dict[str, Any] = {}
    for override in _all_overrides(base, overrides):
        path, _, value = override.partition("=")
        put(tree, path.strip(), {} if value.strip() == "{}" else value, base.scene.effects)
    lines = [f"base: {quoted(str(Path(base.file).resolve()))}", *lines_of(tree)]
    return "\n".join(lines) + "\n"
