"""All keys of a scene in words: unit, default, range and meaning, for `explain --parameters` and the reference page.

They come from the declarations by which scenes are read, and from the bounds on sizes (`machine.protocol.Size`).
"""

import dataclasses
import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from screwsim.effects.base import Effect
from screwsim.inputs.declare import UNBOUNDED
from screwsim.machine.kinds import find_machine
from screwsim.machine.protocol import Size
from screwsim.scene.fields import Leaf, Section, scene_section, section_of
from screwsim.scene.sizes import sizes_of_effect
from screwsim.scene.units import customary_unit, readable_quantity
from screwsim.scene.values import text_of

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
    can = [f"{sign}{_text(leaf, leaf.limits[name])}" for name, sign in _SIGNS.items() if name in leaf.limits]
    usual = [] if leaf.hardly == UNBOUNDED else [f"usual {_span(*(_text(leaf, end) for end in leaf.hardly))}"]
    if size is not None:
        low, high = size.usual
        ends = (f"{low:g}" if low > 0.0 else "", f"{high:g}" if high < _WHOLE else "")
        usual += [f"usual {_span(*ends)} {size.what}"] if any(ends) else []
    can += ["or auto"] if leaf.auto else []
    return "; ".join([", ".join(can), *usual] if can else usual) or ABSENT


def _text(leaf: Leaf, end: float | None) -> str:
    if end is None:
        return ""
    return text_of(leaf, end) if leaf.dimension is None else readable_quantity(leaf.dimension, end)


def _span(low: str, high: str) -> str:
    return f"{low} to {high}" if low and high else f"≥ {low}" if low else f"≤ {high}"
