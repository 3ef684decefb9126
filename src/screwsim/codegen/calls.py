"""Calls of machine code: Python arguments are passed as words of eight bytes, results are returned likewise.

Since a call itself takes only microseconds, addresses of arrays are remembered and kinds are represented by numbers.
"""

from __future__ import annotations

import ctypes
import struct
import threading
import weakref
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from screwsim.codegen.kinds import FLOAT, INTEGER, TRUTH, Kind, array

MOST_KNOWN = 512  # largest number of arrays whose addresses are remembered
MOST_AXES = 3
KINDS: list[Kind] = [FLOAT, INTEGER, TRUTH]  # kinds by their number
_FLOAT, _INTEGER, _TRUTH = range(3)
_FLOATS, _INTEGERS = np.dtype(np.float64), np.dtype(np.int64)
known: dict[int, tuple[weakref.ref[np.ndarray], int, tuple[int, ...]]] = {}  # by id: kind and words of an array
_contexts: dict[tuple[Any, ...], int] = {}
_adding = threading.Lock()
for _of in (FLOAT, INTEGER):
    KINDS += [array(_of, axes) for axes in range(1, MOST_AXES + 1)]


class Context(tuple[Any, ...]):
    """A tuple of arrays, unnamed or named, that is passed to many calls: its words are determined once."""

    number: int
    words: tuple[float, ...]

    def __new__(cls, arrays: tuple[Any, ...]) -> Context:
        kinds: list[int] = []
        words: list[float] = []
        take(arrays, kinds, words)
        found = super().__new__(cls, arrays)
        found.number, found.words = kinds[0], tuple(words)
        for name, each in zip(KINDS[found.number].names, arrays, strict=False):
            setattr(found, name, each)
        return found


def take(argument: Any, kinds: list[int], words: list[float]) -> None:
    """Append the number of an argument's kind, and its words; raise TypeError where compiled code cannot read it."""
    what = type(argument)
    if what is np.ndarray:
        found = known.get(id(argument))
        if found is None or found[0]() is not argument:
            found = _look_at(argument)
        kinds.append(found[1])
        words.extend(found[2])
    elif what is float:
        kinds.append(_FLOAT)
        words.append(argument)
    elif what is int:
        kinds.append(_INTEGER)
        words.append(argument)
    elif what is Context:
        kinds.append(argument.number)
        words.extend(argument.words)
    elif isinstance(argument, tuple):
        inner: list[int] = []
        for each in argument:
            take(each, inner, words)
        names = getattr(argument, "_fields", ())
        key = (names, *inner)
        number = _contexts.get(key)
        kinds.append(_added(key, names, inner) if number is None else number)
    else:
        kinds.append(_number(argument))
        words.append(float(argument) if kinds[-1] == _FLOAT else int(argument))


def _added(key: tuple[Any, ...], names: tuple[str, ...], inner: Sequence[int]) -> int:
    """Return the number of a new kind of context, which another thread may have added just now."""
    with _adding:
        if key not in _contexts:
            KINDS.append(Kind("c", tuple(KINDS[one] for one in inner), names=names))
            _contexts[key] = len(KINDS) - 1
        return _contexts[key]


def copied(arrays: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return copies of arrays of float64 or int64 in one block; their addresses are known from the first call on."""
    block = np.empty(sum([each.size for each in arrays]))
    address, at = ctypes.addressof(ctypes.c_char.from_buffer(block)), 0  # type: ignore[arg-type]
    if len(known) >= MOST_KNOWN - len(arrays):
        known.clear()
    copies = []
    for each in arrays:
        floats, size = each.dtype is _FLOATS or each.dtype == _FLOATS, each.size
        part = block[at : at + size] if floats else block[at : at + size].view(np.int64)
        part = part if each.ndim == 1 else part.reshape(each.shape)
        part[...] = each
        number = _TRUTH + each.ndim + (0 if floats else MOST_AXES)
        known[id(part)] = weakref.ref(part), number, (address + 8 * at, *each.shape)
        copies.append(part)
        at += size
    return copies


def _number(argument: Any) -> int:
    if isinstance(argument, bool | np.bool_):
        return _TRUTH
    if isinstance(argument, int | np.integer):
        return _INTEGER
    if isinstance(argument, float | np.floating):
        return _FLOAT
    raise TypeError(f"a compiled function takes numbers, arrays and tuples of arrays, not {type(argument).__name__}")


def _look_at(table: np.ndarray) -> tuple[weakref.ref[np.ndarray], int, tuple[int, ...]]:
    of, axes, flags = table.dtype, table.ndim, table.flags
    floats = of is _FLOATS or of == _FLOATS  # the first test is quick and nearly always true
    if not (floats or of == _INTEGERS) or not flags.c_contiguous or not flags.aligned or not 0 < axes <= MOST_AXES:
        raise TypeError(f"a compiled function takes whole arrays of float64 or int64, not {of} of {table.shape}")
    number = _TRUTH + axes + (0 if floats else MOST_AXES)
    if flags.writeable and table.size:
        address = ctypes.addressof(ctypes.c_char.from_buffer(table))  # type: ignore[arg-type]
    else:
        address = table.ctypes.data  # the same address, slower
    found = weakref.ref(table), number, (address, *table.shape)
    if len(known) >= MOST_KNOWN:
        known.clear()
    known[id(table)] = found
    return found


class Variant:
    """A function compiled for given kinds of arguments; called with their words."""

    def __init__(self, entry: Callable[[Any, Any], int], kinds: Sequence[Kind], returned: str) -> None:
        self._entry = entry
        self._pack = struct.Struct("".join(_format(kind) for kind in kinds)).pack
        self._letters = returned.removeprefix("t").strip("()").replace("n", "")
        self._tuple = returned.startswith("t")
        results = struct.Struct("".join("d" if letter == "f" else "q" for letter in self._letters))
        self._unpack, self._room = results.unpack, ctypes.c_char * results.size
        self._truths = "b" in self._letters

    def __call__(self, words: Sequence[float]) -> Any:
        out = self._room() if self._letters else None
        if self._entry(self._pack(*words), out):
            raise IndexError("an index beyond its array")
        if out is None:
            return None
        found = self._unpack(out)
        if self._truths:
            found = tuple(bool(one) if letter == "b" else one for one, letter in zip(found, self._letters, strict=True))
        return found if self._tuple else found[0]


def _format(kind: Kind) -> str:
    if kind.name == "c":
        return "".join(_format(inner) for inner in kind.of)
    return "d" if kind == FLOAT else "q" * len(kind.parts)
