"""All keys of a scene, or of some effects, in words: unit, default, range, meaning, and the scene's value.

They come from the declarations by which scenes are read, and from the bounds on sizes (`machine.protocol.Size`), for
`explain --parameters` and the reference page.
"""

import dataclasses
import math
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from screwsim.effects import catalogue, find_effect
from screwsim.effects.base import Effect
from screwsim.inputs.declare import UNBOUNDED, FoundWithCycle, is_derived
from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import find_machine
from screwsim.machine.protocol import Size
from screwsim.scene.fields import Leaf, Section, scene_section, section_of, unknown_key, value_at
from screwsim.scene.left_out import machine_in_words, suitable_effects
from screwsim.scene.sizes import sizes_of_effect
from screwsim.scene.types import Scene
from screwsim.scene.units import customary_unit, readable_quantity, to_customary
from screwsim.scene.values import text_of

WIDTH = 79
NAME_WIDTH = 20
NO_BREAK = "\u00a0"  # keeps a name, its value and its unit on one line
ABSENT, REQUIRED = "–", "required"
SECTIONS = ("machine", "gas", "operation", "oil", "oil_supply", "numerics", "output")
_SIGNS = {"gt": "> ", "ge": "≥ ", "lt": "< ", "le": "≤ "}
_PLAIN = {"number": "number", "count": "whole number", "file": "file", "fluid": "name, or names"}
_WHOLE = math.inf


class Key(NamedTuple):
    """One key: its path below the section, and in words the unit, the default, the range and the meaning."""

    path: str
    unit: str
    default: str
    range: str
    meaning: str
    leaf: Leaf


def section_keys(name: str, kind: str) -> list[Key]:
    """Return the keys of a plain section of a scene with that kind of machine."""
    section = scene_section(kind).fields[name]
    assert isinstance(section, Section)
    return list(_keys(section, "", _below(f"{name}.", find_machine(kind).sizes)))


def effect_keys_of(name: str, effect: Effect, kind: str) -> list[Key]:
    """Return the keys of an effect."""
    machine = find_machine(kind)
    sizes = (*machine.sizes, *sizes_of_effect(machine, name, effect))
    return list(_keys(section_of(effect.parameters), "", _below(f"effects.{name}.", sizes)))


def _below(prefix: str, sizes: Iterable[Size]) -> dict[str, Size]:
    """Return sizes by their paths below a prefix."""
    return {size.path.removeprefix(prefix): size for size in sizes if size.path.startswith(prefix)}


def _keys(section: Section, before: str, sizes: dict[str, Size]) -> Iterator[Key]:
    for name, item in section.fields.items():
        if isinstance(item, Section):
            yield from _keys(item, f"{before}{name}.", sizes)
        else:
            path = f"{before}{name}"
            yield Key(path, _unit(item), _default(item), _range(item, sizes.get(path)), item.doc, item)


def _unit(leaf: Leaf) -> str:
    if leaf.dimension is not None:
        return customary_unit(leaf.dimension)
    return {"choice": "word", "word": "text", "numbers": "numbers"}.get(leaf.kind, _PLAIN.get(leaf.kind, leaf.kind))


def _default(leaf: Leaf) -> str:
    if leaf.default is dataclasses.MISSING:
        return REQUIRED
    if leaf.default is None:
        return f"{REQUIRED}, or {' or '.join(leaf.otherwise)}" if leaf.otherwise else ABSENT
    return text_of(leaf, leaf.default) or ABSENT


def _range(leaf: Leaf, size: Size | None) -> str:
    """Return in words the possible range of a value, and its usual range."""
    if leaf.kind == "choice":
        own = ["a module of your own"] if leaf.limits.get("own") else []
        return ", ".join([*leaf.limits["options"], *own])
    can = [f"{sign}{_readable(leaf, leaf.limits[name])}" for name, sign in _SIGNS.items() if name in leaf.limits]
    common = ("" if end is None else _readable(leaf, end) for end in leaf.hardly)
    usual = [] if leaf.hardly == UNBOUNDED else [f"usual {_span(*common)}"]
    if size is not None:
        low, high = size.usual
        ends = (f"{low:g}" if low > 0.0 else "", f"{high:g}" if high < _WHOLE else "")
        usual += [f"usual {_span(*ends)} {size.what}"] if any(ends) else []
    can += ["or auto"] if leaf.auto else []
    return "; ".join([", ".join(can), *usual] if can else usual) or ABSENT


def _span(low: str, high: str) -> str:
    return f"{low} to {high}" if low and high else f"≥ {low}" if low else f"≤ {high}"


def parameters(scene: Scene, names: Sequence[str] = ()) -> str:
    """Return the keys of the named sections and effects; without names, all that the scene's machine can have.

    A name may continue to one key (`tip_leakage.gap`). Raise UsageError for an unknown name.
    """
    kind = scene.machine.kind
    known = suitable_effects(scene) | {name: active.effect for name, active in scene.effects.items()}
    asked = [name.removeprefix("effects.") for name in names] or [*SECTIONS, *known]
    return "\n\n".join("\n".join(_section_or_effect(scene, name, known, kind)) for name in asked)


def _section_or_effect(scene: Scene, name: str, known: dict[str, Effect], kind: str) -> Iterator[str]:
    """Yield the head of a section or of an effect, and a row on each key, ending with the scene's value."""
    head, _, rest = name.partition(".")
    if head not in SECTIONS and head not in known:  # the name of a module of one's own has dots, too
        head, rest = name, ""
    if head in SECTIONS:
        under, keys = head, section_keys(head, kind)
        yield head if getattr(scene, head) is not None else f"{head} (not in this scene)"
    else:
        effect = _effect(head, known, scene)
        under, keys = f"effects.{head}", effect_keys_of(head, effect, kind)
        yield f"{under} ({'simulated' if head in scene.effects else 'left out'}): {effect.title}"
    asked = [key for key in keys if not rest or key.path == rest or key.path.startswith(f"{rest}.")]
    if rest and not asked:
        raise UsageError(f"--parameters {name}: {unknown_key(rest, [key.path for key in keys])}")
    for key in asked:
        about = [key.meaning, f"unit: {key.unit}", f"default: {key.default}"]
        about += [] if key.range == ABSENT else [f"range: {key.range}"]
        yield row(key.path, "; ".join([*about, *_scene_value(scene, f"{under}.{key.path}", key)]))
    if not keys:
        yield "  no keys"


def _effect(name: str, known: dict[str, Effect], scene: Scene) -> Effect:
    """Return an effect of that machine, or one of one's own; raise UsageError for others."""
    if name not in known and name in catalogue():
        remedy = "screwsim explain lists the possible ones"
        raise UsageError(f"--parameters {name}: is not an effect of {machine_in_words(scene)} ({remedy})")
    if name not in known and "." not in name:
        raise UsageError(f"--parameters {name}: {unknown_key(name, [*SECTIONS, *known])}")
    try:
        return known.get(name) or find_effect(name)
    except (KeyError, ImportError) as error:
        raise UsageError(f"--parameters {name}: cannot be imported ({error})") from None


def _scene_value(scene: Scene, path: str, key: Key) -> Iterator[str]:
    value = value_at(scene, path)
    if value is None or value == "":
        return
    text = _readable(key.leaf, value)
    follows = " (follows)" if is_derived(value) and text != key.default else ""
    yield f"here: {text}{follows}".replace(" ", NO_BREAK)


def row(name: str, text: str) -> str:
    """Return a name with its text wrapped in the second column."""
    head = f"  {name:<{NAME_WIDTH}}" if len(name) < NAME_WIDTH else f"  {name}\n{'':<{NAME_WIDTH + 2}}"
    first, *others = textwrap.wrap(text, WIDTH - NAME_WIDTH - 2, break_on_hyphens=False) or [""]
    return "\n".join([head + first, *(" " * (NAME_WIDTH + 2) + line for line in others)]).replace(NO_BREAK, " ")


def parameters_text(values: Any, skip: tuple[str, ...] = ("law",)) -> str:
    """Return the declared values of a section in customary units, with defaults marked and absent values left out."""
    fields = section_of(type(values)).fields
    texts = []
    for name, leaf in fields.items():
        value = getattr(values, name)
        if isinstance(leaf, Leaf) and name not in skip and value is not None:
            mark = " (default)" if not leaf.required and value == leaf.default else ""
            mark = " (follows)" if is_derived(value) and not mark else mark
            text = _readable(leaf, value)
            if leaf.dimension is not None and is_derived(value):  # its digits were not written by a user
                text = f"{to_customary(leaf.dimension, value):.6g} {customary_unit(leaf.dimension)}"
            texts.append(f"{name} {text}{mark}".replace(" ", NO_BREAK))
    return ", ".join(texts)


def _readable(leaf: Leaf, value: Any) -> str:
    as_such = leaf.dimension is None or isinstance(value, FoundWithCycle)
    return text_of(leaf, value) if as_such or leaf.dimension is None else readable_quantity(leaf.dimension, value)
