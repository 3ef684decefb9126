"""All keys of a scene, or of some effects: unit, default, range, meaning, the scene's value; sections in words."""

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from screwsim.effects import catalogue, find_effect
from screwsim.effects.base import Effect
from screwsim.inputs.declare import FoundWithCycle, is_derived
from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import kind_of
from screwsim.scene.fields import Leaf, section_of, unknown_key, value_at
from screwsim.scene.keys import ABSENT, SECTIONS, Key, effect_keys_of, section_keys
from screwsim.scene.types import Scene
from screwsim.scene.units import customary_unit, readable_quantity, to_customary
from screwsim.scene.values import text_of

WIDTH = 79
NAME_WIDTH = 20
NO_BREAK = "\u00a0"  # keeps a name, its value and its unit on one line


def parameters(scene: Scene, names: Sequence[str] = ()) -> str:
    """Return the keys of the named sections and effects; without names, all that the scene's machine can have.

    A name may continue to one key (`tip_leakage.gap`). Raise UsageError for an unknown name.
    """
    kind = scene.machine.kind
    fitting = {name: effect for name, effect in catalogue().items() if effect.fits(kind_of(scene.machine))}
    known = fitting | {name: active.effect for name, active in scene.effects.items()}
    asked = [name.removeprefix("effects.") for name in names] or [*SECTIONS, *known]
    return "\n\n".join("\n".join(_section_or_effect(scene, name, known, kind)) for name in asked)


def _section_or_effect(scene: Scene, name: str, known: dict[str, Effect], kind: str) -> Iterator[str]:
    head, _, rest = name.partition(".")
    if rest and (head in SECTIONS or head in known):
        heading, *_ = _section_or_effect(scene, head, known, kind)
        yield heading
        section = head in SECTIONS
        keys = list(section_keys(head, kind) if section else effect_keys_of(head, known[head], kind))
        asked = [key for key in keys if key.path == rest or key.path.startswith(f"{rest}.")]
        if not asked:
            raise UsageError(f"--parameters {head}.{rest}: {unknown_key(rest, [key.path for key in keys])}")
        yield from _rows(scene, head if section else f"effects.{head}", asked)
        return
    if name in SECTIONS:
        yield f"{name}{_absent_section(scene, name)}"
        yield from _rows(scene, name, section_keys(name, kind))
        return
    if name not in known and name in catalogue():
        raise UsageError(
            f"--parameters {name}: is not an effect of a {kind} (screwsim explain lists the possible ones)"
        )
    if name not in known and "." not in name:
        raise UsageError(f"--parameters {name}: {unknown_key(name, [*SECTIONS, *known])}")
    effect = known.get(name) or _own_keys(name)
    state = "simulated" if name in scene.effects else "left out"
    yield f"effects.{name} ({state}): {effect.title}"
    yield from _rows(scene, f"effects.{name}", effect_keys_of(name, effect, kind))


def _own_keys(name: str) -> Effect:
    try:
        return find_effect(name)
    except (KeyError, ImportError) as error:
        raise UsageError(f"--parameters {name}: cannot be imported ({error})") from None


def _absent_section(scene: Scene, name: str) -> str:
    return " (not in this scene)" if getattr(scene, name) is None else ""


def _rows(scene: Scene, under: str, keys: Iterable[Key]) -> Iterator[str]:
    """Yield a row on each key, ending with the scene's value."""
    none = True
    for key in keys:
        none = False
        about = [key.meaning, f"unit: {key.unit}", f"default: {key.default}"]
        about += [] if key.range == ABSENT else [f"range: {key.range}"]
        yield row(key.path, "; ".join([*about, *_scene_value(scene, f"{under}.{key.path}", key)]))
    if none:
        yield "  no keys"


def _scene_value(scene: Scene, path: str, key: Key) -> Iterator[str]:
    value = value_at(scene, path)
    if value is None or value == "":
        return
    kind = key.leaf.dimension
    found = kind is None or isinstance(value, FoundWithCycle)
    text = text_of(key.leaf, value) if found or kind is None else readable_quantity(kind, value)
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
            texts.append(f"{name} {_value_text(leaf, value)}{mark}".replace(" ", NO_BREAK))
    return ", ".join(texts)


def _value_text(leaf: Leaf, value: Any) -> str:
    if leaf.dimension is not None and is_derived(value):  # its digits were not written by a user
        return f"{to_customary(leaf.dimension, value):.6g} {customary_unit(leaf.dimension)}"
    return (
        text_of(leaf, value)
        if leaf.dimension is None or isinstance(value, FoundWithCycle)
        else readable_quantity(leaf.dimension, value)
    )
