"""What a scene may contain, read from the declared dataclasses: sections, leaves (single inputs) and dotted paths."""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

from screwsim.effects import catalogue
from screwsim.inputs.declare import KINDS, LEAF, Leaf
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import names_containing, nearest, paths_ending_in
from screwsim.machine.kinds import MACHINES, TWIN_SCREW, find_machine
from screwsim.scene.types import Scene
from screwsim.scene.units import Gauge, Refused

# parts of a scene that are not plain sections
NOT_SECTIONS = ("effects", "sweep", "joints", "text", "folder", "losses", "uncertain", "correlated", "model_error")
SWEEPABLE = {*KINDS, "number", "count", "choice", "fluid"}
AMBIENT = "operation.ambient_pressure"
FIXED = {"machine.kind", AMBIENT}  # another scene; gauge pressures depend on the ambient one
MEANT = {  # other words for keys, some of which are keys of another section
    **dict.fromkeys(("refrigerant", "gas.name", "gas.gas", "gas.refrigerant", "gas.working_fluid"), "gas.fluid"),
    **dict.fromkeys(("lubricant", "oil.fluid", "oil.oil", "oil.type", "oil.grade"), "oil.name"),
}
_MANY = 4  # most paths that a message lists


@dataclass(frozen=True)
class Section:
    """A mapping of inputs that becomes the dataclass `type`."""

    type: type
    required: bool
    fields: Mapping[str, Leaf | Section]
    doc: str


@cache
def section_of(cls: type, required: bool = True) -> Section:
    """Return the description of a dataclass whose fields are all declared; raise TypeError for a field that is not."""
    hints = typing.get_type_hints(cls) | ({"machine": MACHINES[TWIN_SCREW].settings} if cls is Scene else {})
    fields = {
        item.name: _describe(cls, item, hints[item.name])
        for item in dataclasses.fields(cls)
        if not (cls is Scene and item.name in NOT_SECTIONS)
    }
    if "title" in fields:  # users write the title first
        fields = {"title": fields.pop("title"), **fields}
    return Section(cls, required, fields, (cls.__doc__ or "").strip().splitlines()[0] if cls.__doc__ else "")


def _describe(cls: type, item: Any, hint: Any) -> Leaf | Section:
    if LEAF in item.metadata:
        return item.metadata[LEAF]
    optional = isinstance(hint, types.UnionType) or typing.get_origin(hint) is typing.Union
    inner = [part for part in typing.get_args(hint) if part is not type(None)] if optional else [hint]
    if not inner or not all(dataclasses.is_dataclass(part) for part in inner):
        raise TypeError(f"{cls.__module__}.{cls.__name__}.{item.name} is not declared (use screwsim.inputs.declare)")
    defaulted = item.default is not dataclasses.MISSING and item.default is not None
    return section_of(typing.cast(type, inner[0]), not optional and not defaulted)


@cache
def scene_section(kind: str = TWIN_SCREW) -> Section:
    """Return the sections of a scene with that kind of machine, without `effects` and `sweep`."""
    section, machine = section_of(Scene), section_of(find_machine(kind).settings)
    named = machine.fields["kind"]
    assert isinstance(named, Leaf)
    options = (*MACHINES, kind) if "." in kind else tuple(MACHINES)
    every = dataclasses.replace(named, limits={**named.limits, "options": options})
    machine = dataclasses.replace(machine, fields={**machine.fields, "kind": every})
    return dataclasses.replace(section, fields={**section.fields, "machine": machine})


def _leaves(section: Section, path: str) -> Iterable[tuple[str, Leaf]]:
    for name, item in section.fields.items():
        below = f"{path}{name}"
        if isinstance(item, Leaf):
            yield below, item
        else:
            yield from _leaves(item, f"{below}.")


def leaf_paths(parameters: Mapping[str, type], kind: str = TWIN_SCREW) -> dict[str, Leaf]:
    """Return {dotted path: leaf} of a scene with that kind of machine and the given effects.

    `parameters` is {name: type of their parameters}.
    """
    found = dict(_scene_leaves(kind))
    for name, cls in parameters.items():
        found.update(_effect_leaves(name, cls))
    return found


def catalogue_leaves(kind: str = TWIN_SCREW) -> dict[str, Leaf]:
    """Return {dotted path: leaf} of a scene with that kind of machine and every effect of the catalogue."""
    return leaf_paths({name: effect.parameters for name, effect in catalogue().items()}, kind)


@cache
def _scene_leaves(kind: str) -> Mapping[str, Leaf]:
    return dict(_leaves(scene_section(kind), ""))


@cache
def _effect_leaves(name: str, cls: type) -> Mapping[str, Leaf]:
    return dict(_leaves(section_of(cls), f"effects.{name}."))


def leaves_of(scene: Scene) -> dict[str, Leaf]:
    """Return {dotted path: leaf} of a scene, with the effects that are on in it."""
    return leaf_paths({name: type(active.parameters) for name, active in scene.effects.items()}, scene.machine.kind)


def varies(path: str, leaf: Leaf) -> bool:
    """Tell whether an input may be varied by a sweep."""
    return leaf.kind in SWEEPABLE and path not in FIXED


def gauge_texts(scene: Scene, changed: Collection[str]) -> dict[str, str]:
    """Return {path: text} of gauge pressures as they were written, but for those at or below paths that are `changed`.

    So they follow a changed ambient pressure. Raise UsageError where one on an axis or with a tolerance would not.
    """
    known = {path: [value] for path in leaves_of(scene) if isinstance(value := value_at(scene, path), Gauge)}
    for path, values in _swept(scene):
        known.setdefault(path, []).extend(each for each in values if isinstance(each, Gauge))
    below = tuple(f"{path}." for path in changed)
    known = {path: values for path, values in known.items() if values and not f"{path}.".startswith(below)}
    fixed = [path for path in known if path in scene.uncertain or path.startswith("sweep.")]
    if fixed and AMBIENT in changed:
        raise UsageError(f"with_: {AMBIENT}: {fixed[0]} was read relative to the former one (state it anew as well)")
    return {path: values[0].written for path, values in known.items() if path not in fixed}


def _swept(scene: Scene) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """Yield (path, numbers) of a sweep as it is stated: axes, those zipped, and what a sample is drawn from."""
    joint_of = {path: joint for joint in scene.joints for path in joint.paths}
    for path, axis in scene.sweep.items():
        joint = joint_of.get(path)
        if joint is None:
            yield f"sweep.{path}", axis
        elif joint.sample is None:
            yield "sweep.zip", axis
        else:
            yield "sweep.sample", dict(joint.sample.over)[path]


def effect_keys(path: str, names: Iterable[str]) -> tuple[str, list[str]]:
    """Return (effect, keys below it) of a path `effects.…`; the effect is one of `names`, which may contain dots."""
    rest = path.removeprefix("effects.")
    name = max((each for each in names if rest.startswith(f"{each}.")), key=len, default=rest.rpartition(".")[0])
    return name, rest[len(name) + 1 :].split(".")


_split_effect = lru_cache(maxsize=4096)(effect_keys)  # sizes are looked up in every case of a sweep


def value_at(scene: Scene, path: str) -> Any:
    """Return the value [SI] at a dotted path, None where an optional section or value is absent."""
    value: Any = scene
    if path.startswith("effects."):
        effect, keys = _split_effect(path, tuple(scene.effects))
        active = scene.effects.get(effect)
        value = None if active is None else active.parameters
    else:
        keys = path.split(".")
    for name in keys:
        value = None if value is None else getattr(value, name)
    return value


def sweep_leaf(
    path: str, parameters: Mapping[str, type], kind: str, before: str = "", fixed: tuple[str, ...] = ()
) -> Leaf:
    """Return the leaf of a path that may be varied; raise `Refused`.

    `before` stands before the paths that a refusal names, and those that begin with `fixed` are not offered.
    """
    leaves = leaf_paths(parameters, kind)
    leaf = leaves.get(path)
    if leaf is not None and varies(path, leaf):
        return leaf
    if leaf is not None:
        raise Refused("cannot be varied (only quantities, numbers, choices and the fluid can)")
    head, _, rest = path.partition(".")
    inactive = next((name for name in catalogue() if rest == name or rest.startswith(f"{name}.")), None)
    if head == "effects" and inactive is not None and inactive not in parameters:
        raise Refused(f"the effect {inactive} is not active (name it under effects, or remove this axis)")
    below = [name for name in leaves if name.startswith(f"{path}.")]
    if below:
        raise Refused(f"is a section, not a value (write e.g. {before}{below[0]})")
    options = [name for name, item in leaves.items() if varies(name, item) and not name.startswith(fixed)]
    raise Refused(unknown_key(path, options, "a dotted path of the scene", before=before))


def unknown_key(
    name: str, options: Iterable[str], otherwise: str = "", paths: Iterable[str] = (), before: str = ""
) -> str:
    """Return 'is not known' with a suggestion where the intended name is clear, else with the names that are known.

    `paths` are those of the whole scene; those that end in `name` are listed. Without `paths` the options take their
    place. `before` stands before whole names.
    """
    options = list(options)
    if (meant := MEANT.get(name)) in options:
        return f"is not known; did you mean '{before}{meant}'?"
    elsewhere = paths_ending_in(name, paths or options)
    near = elsewhere[0] if len(elsewhere) == 1 else None if elsewhere else nearest(name, options)
    if near is not None:
        return f"is not known; did you mean '{before}{near}'?"
    if elsewhere:
        more, some = ", …" if len(elsewhere) > _MANY else "", (f"{before}{each}" for each in elsewhere[:_MANY])
        return f"is not known; there are {', '.join(some)}{more} (write the whole path)"
    parts = names_containing(name, options)
    if 0 < len(parts) <= _MANY:
        named = ", ".join(f"{before}{each}" for each in parts)
        return f"is not known; there {'is' if len(parts) == 1 else 'are'} {named} (write the whole name)"
    beside = [option for option in options if option.rpartition(".")[0] == name.rpartition(".")[0] != ""]
    if beside:
        return f"is not known; known there: {', '.join(option.rpartition('.')[2] for option in beside)}"
    return f"is not known (use {otherwise})" if otherwise else f"is not known; known here: {', '.join(options) or '-'}"


def stray_key(name: str, options: Iterable[str], paths: Iterable[str] = (), section: str = "") -> str:
    """Return what is wrong with an unknown key of a section in a file; `paths` are those of the whole scene."""
    if (meant := MEANT.get(f"{section}.{name}" if section else name)) is not None:
        return f"is not known; did you mean '{meant.removeprefix(f'{section}.')}'?"
    if name[:1].isdigit():
        return "is not a name (in { } and [ ] a comma begins another entry; write decimals with a point)"
    if "." in name and name in paths:
        above, _, last = name.rpartition(".")
        return f"is a path, which only --set and sweep take (here write {last} under {above.replace('.', ', under ')})"
    return unknown_key(name, options, paths=paths)
