"""Rows of a name and its text in two columns that fit a terminal, and the values of a section in words."""

import textwrap
from typing import Any

from screwsim.inputs.declare import FoundWithCycle, is_derived
from screwsim.scene.fields import Leaf, section_of
from screwsim.scene.units import customary_unit, readable_quantity, to_customary
from screwsim.scene.values import text_of

WIDTH = 79
NAME_WIDTH = 20
NO_BREAK = "\u00a0"  # keeps a name, its value and its unit on one line


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
            texts.append(f"{name} {_text(leaf, value)}{mark}".replace(" ", NO_BREAK))
    return ", ".join(texts)


def _text(leaf: Leaf, value: Any) -> str:
    if leaf.dimension is not None and is_derived(value):  # its digits were not written by a user
        return f"{to_customary(leaf.dimension, value):.6g} {customary_unit(leaf.dimension)}"
    return (
        text_of(leaf, value)
        if leaf.dimension is None or isinstance(value, FoundWithCycle)
        else readable_quantity(leaf.dimension, value)
    )
