"""An object of a frozen dataclass with other values: what `dataclasses.replace` does, in a fifth of its time.

That asks each field of the kind what it is, every time, and calls an `__init__` that sets one value after the other.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cache
from typing import Any, TypeVar

Kind = TypeVar("Kind")


@cache
def _plain(kind: type) -> dict[str, None] | None:
    """Return the fields of a kind whose values are all that its objects are made of; None where that is not so."""
    every, slots = fields(kind), any(vars(one).get("__slots__") for one in kind.__mro__)  # type: ignore[arg-type]
    made = vars(kind)["__dataclass_params__"].init and not hasattr(kind, "__post_init__")
    if slots or not made or not all(each.init for each in every):
        return None
    return dict.fromkeys(each.name for each in every)


def changed(of: Kind, **values: Any) -> Kind:
    """Return an object with other values of some fields."""
    kind = type(of)
    names = _plain(kind)
    if names is None or not values.keys() <= names.keys():
        return replace(of, **values)  # type: ignore[type-var]
    found, own = object.__new__(kind), of.__dict__
    into = found.__dict__
    for name in names:  # no more: what was found `once` of the other does not stand in it
        into[name] = own[name]
    into.update(values)
    return found
