"""Frozen dataclasses whose values are written into a new object all at once, and copies of such objects with changes.

The `__init__` of a frozen dataclass sets each value through `object.__setattr__`, which takes three times as long as
writing them into its dictionary. But once the dictionary of an object has been accessed, reading its values becomes
slower (Python 3.11: 23 ns instead of 6 ns each), unless it has more than 30 of them. So `fast_init` is for objects that
are made for every point and not read a hundred times, or that have many values, or values found `once`, which go into
the dictionary anyway.

`with_changes` does the same as `dataclasses.replace` in a fifth of the time: that inspects every field each time, and
calls an `__init__` that sets one value after the other.
"""

from collections.abc import Callable
from dataclasses import MISSING, fields, replace
from functools import cache
from typing import Any, TypeVar

Kind = TypeVar("Kind")


@cache
def _plain(kind: type) -> dict[str, None] | None:
    """Return the fields of a class whose objects consist of nothing else; None for other classes."""
    every, slots = fields(kind), any(vars(one).get("__slots__") for one in kind.__mro__)  # type: ignore[arg-type]
    made = vars(kind)["__dataclass_params__"].init and not hasattr(kind, "__post_init__")
    if slots or not made or not all(each.init for each in every):
        return None
    return dict.fromkeys(each.name for each in every)


def with_changes(of: Kind, /, **values: Any) -> Kind:
    """Return a copy of an object with other values of some fields."""
    kind = type(of)
    names = _plain(kind)
    if names is None or not values.keys() <= names.keys():
        return replace(of, **values)  # type: ignore[type-var]
    found, own = object.__new__(kind), of.__dict__
    into = found.__dict__
    for name in names:  # fields only: values that the original found `once` are not copied
        into[name] = own[name]
    into.update(values)
    return found


def fast_init(kind: type[Kind]) -> type[Kind]:
    """Give a frozen dataclass an `__init__` with the same parameters that writes all values at once."""
    known: dict[str, Any] = {"__name__": kind.__module__}
    parameters, lines = [], ["    values = self.__dict__"]
    for number, one in enumerate(fields(kind)):  # type: ignore[arg-type]
        name, default = one.name, f"default_{number}"
        known[default] = one.default if one.default_factory is MISSING else one.default_factory
        given = one.default is not MISSING or one.default_factory is not MISSING
        parameters.append(f"{name}={default}" if given else name)
        value = name if one.default_factory is MISSING else f"{default}() if {name} is {default} else {name}"
        lines.append(f"    values[{name!r}] = {value}")
    if hasattr(kind, "__post_init__"):
        lines.append("    self.__post_init__()")
    exec(f"def __init__(self, {', '.join(parameters)}):\n" + "\n".join(lines), known)
    made: Callable[..., None] = known["__init__"]
    made.__annotations__, made.__qualname__ = kind.__init__.__annotations__, f"{kind.__qualname__}.__init__"
    setattr(kind, "__init__", made)  # noqa: B010 - a plain assignment fails the type checker
    return kind
