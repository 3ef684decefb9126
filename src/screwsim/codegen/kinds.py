"""Kinds of values in compiled text (number, array, tuple) and the LLVM types of the registers that hold them.

Where points are computed side by side (`codegen.lanes`), a number may be a vector with one value for each lane. An
array may be shared by all lanes, may hold vectors (`p`), or may be a different one for each lane: `v` with an address
for each lane, `w` a part of a `p` that begins at a different place for each lane.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

NAMED = 4  # number of registers from which on a struct has a name
LANES = 8  # points computed side by side: floats in the widest registers of today's processors
_kinds: dict[tuple[Any, ...], Kind] = {}


@dataclass(frozen=True, eq=False)
class Kind:
    """Kind of a value, by a letter.

    For one number or object: `f` float64, `i` int64, `b` bool, `n` nothing, `a` array, `t` tuple, `c` context. For all
    lanes: `F`, `I`, `B` vectors of numbers, and `p`, `v`, `w` arrays (described in the module).

    A context is a tuple that the caller keeps, in memory that does not change. There is only one object of each kind,
    so that kinds are compared by identity, which the compiler does for each operation.
    """

    name: str
    of: tuple[Kind, ...] = ()
    axes: int = 0
    names: tuple[str, ...] = ()  # names of a context's items, if they have any

    def __new__(cls, name: str, of: tuple[Kind, ...] = (), axes: int = 0, names: tuple[str, ...] = ()) -> Kind:
        key = name, of, axes, names
        return _kinds.get(key) or _kinds.setdefault(key, super().__new__(cls))

    def __str__(self) -> str:
        inside = "".join(str(each) for each in self.of)
        return f"{self.name}{self.axes or ''}{f'({inside})' if self.of else ''}"

    @cached_property
    def parts(self) -> tuple[str, ...]:
        """LLVM types of the registers that hold a value."""
        if self.name in ARRAYS:
            first = "ptr" if self.name in "ap" else ADDRESSES
            return (first, *("i64" for _ in range(self.axes)))
        if self.name == "t":
            return tuple(part for each in self.of for part in each.parts)
        return (_REGISTERS[self.name],) if self.name != "n" else ()

    @cached_property
    def returned(self) -> str:
        """LLVM type that a function with a result of this kind returns."""
        if self.name == "n":
            return "void"
        if self.name not in "apvwt":
            return self.parts[0]
        return f"%t{zlib.crc32(self._struct.encode()):x}" if len(self.parts) > NAMED else self._struct

    @property
    def _struct(self) -> str:
        return "{" + ", ".join(self.parts) + "}"

    @property
    def definition(self) -> str:
        """Definition of that type, where it has a name: it is written for each item of a value."""
        return f"{self.returned} = type {self._struct}" if self.returned.startswith("%") else ""


ARRAYS = "apvw"
LANED = "FIBpvw"
ADDRESSES = f"<{LANES} x ptr>"
_REGISTERS = {"f": "double", "i": "i64", "b": "i1", "c": "ptr"}
_REGISTERS |= {name.upper(): f"<{LANES} x {one}>" for name, one in _REGISTERS.items() if name != "c"}
FLOAT, INTEGER, TRUTH, NOTHING = Kind("f"), Kind("i"), Kind("b"), Kind("n")
FLOATS, INTEGERS, TRUTHS = Kind("F"), Kind("I"), Kind("B")  # vectors of all lanes
NUMBERS = (TRUTH, INTEGER, FLOAT)  # each can hold those before it
OF_LANES = {TRUTH: TRUTHS, INTEGER: INTEGERS, FLOAT: FLOATS}
OF_ONE = {many: one for one, many in OF_LANES.items()}


def condition_of(kind: Kind) -> Kind:
    """Return the kind of a condition on numbers of a kind."""
    return TRUTHS if kind in OF_ONE else TRUTH


def array(of: Kind, axes: int) -> Kind:
    return Kind("a", (of,), axes)


def row_of(kind: Kind) -> Kind:
    """Return the kind of an array's items along its first axis."""
    return kind.of[0] if kind.axes == 1 else Kind(kind.name, kind.of, kind.axes - 1)


def joined(one: Kind, other: Kind) -> Kind | None:
    """Return the kind that can hold both kinds; None where none can."""
    if one == other:
        return one
    if one in NUMBERS and other in NUMBERS:
        return max(one, other, key=NUMBERS.index)
    if OF_ONE.get(one, one) in NUMBERS and OF_ONE.get(other, other) in NUMBERS:  # a vector, if either is one
        return OF_LANES[max(OF_ONE.get(one, one), OF_ONE.get(other, other), key=NUMBERS.index)]
    if one.name == other.name == "t" and len(one.of) == len(other.of):
        inner = [joined(a, b) for a, b in zip(one.of, other.of, strict=True)]
        return None if None in inner else Kind("t", tuple(each for each in inner if each is not None))
    return None


def words_of(kind: Kind) -> int:
    """Return the number of 8-byte words of an argument."""
    if kind.name == "c":
        return sum(words_of(each) for each in kind.of)
    return sum(map(words_in, kind.parts))


def words_in(part: str) -> int:
    """Return the number of 8-byte words of a register."""
    return LANES if part[0] == "<" else 1


def laned(kind: Kind) -> Kind:
    """Return the kind in which every number is a vector of all lanes."""
    if kind.name == "t":
        return Kind("t", tuple(laned(each) for each in kind.of))
    return OF_LANES.get(kind, kind)


def floating(kind: Kind) -> Kind:
    """Return the kind in which every float is a vector of all lanes."""
    if kind.name == "t":
        return Kind("t", tuple(floating(each) for each in kind.of))
    return FLOATS if kind == FLOAT else kind


class Value(NamedTuple):
    """A value in registers; `known` is its number, if that is a compile-time constant."""

    kind: Kind
    parts: tuple[str, ...]
    known: Any = None

    def items(self) -> list[Value]:
        """Return the items of a tuple."""
        found, at = [], 0
        for kind in self.kind.of:
            count = len(kind.parts)
            found.append(Value(kind, self.parts[at : at + count]))
            at += count
        return found
