"""Functions of a text in LLVM IR, and which are compiled together because one calls the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from screwsim.codegen.emit import Emitter
from screwsim.codegen.kinds import INTEGER, INTEGERS, NOTHING, TRUTH, TRUTHS, Kind, Value, words_in, words_of
from screwsim.codegen.program import CannotCompile, Program, constant, constant_array

if TYPE_CHECKING:
    from screwsim.codegen.operations import Operations

FAULT = "@fault = internal global i64 0"
_Key = tuple[str, tuple[Kind, ...]]  # name of a function, and kinds of its arguments


@dataclass
class _Written:
    """A function written for given kinds of arguments, and what it needs: functions, constants, declarations."""

    symbol: str
    text: str = ""
    returned: Kind | None = None  # None while it is written
    faulty: bool = False  # whether it may return `guards.NONE_SUCH`
    calls: dict[_Key, None] = field(default_factory=dict)
    arrays: dict[str, None] = field(default_factory=dict)
    declared: dict[str, None] = field(default_factory=dict)


class Writer(Protocol):
    """Interface of an object that writes a function; the kind returned is known once it is `written`."""

    @property
    def returns(self) -> Kind | None:
        """The kind that the function returns."""
        ...

    def written(self, symbol: str) -> str:
        """Return the function's text."""
        ...

    @property
    def faulty(self) -> bool:
        """Whether something in it can fail (`codegen.guards`)."""
        ...


class Library:
    """Functions of a program in LLVM IR, each written once; with `checks` every index is kept within its array.

    `outside` are addresses of functions of this process that the program calls with numbers and arrays; they return
    nothing. `known` are arguments of an entry, by position, that are the same whole numbers in every call.
    """

    known: Mapping[int, int] = MappingProxyType({})
    lanes = 1  # numbers in a result
    aligned = ""  # alignment of what is read and written, where it is not that of its type

    def __init__(self, program: Program, outside: Mapping[str, int] | None = None, checks: bool = False) -> None:
        self.program, self.outside, self.checks = program, outside or {}, checks
        self._functions: dict[_Key, _Written] = {}
        self._open: list[_Written] = []  # functions being written, each called by the one before
        self._arrays: dict[str, tuple[Value, str]] = {}

    def declare(self, line: str) -> None:
        self._open[-1].declared[line] = None

    def constant(self, name: str) -> Value | None:
        """Return a constant of the text; None where none has this name."""
        value: Any = self.program.constants.get(name)
        if isinstance(value, np.ndarray):
            if name not in self._arrays:
                self._arrays[name] = constant_array(name, value)
            self._open[-1].arrays[name] = None
            return self._arrays[name][0]
        return None if value is None else constant(value)

    def emitter(self, name: str, kinds: tuple[Kind, ...]) -> Writer:
        """Return the writer of a function."""
        return Emitter(self, name, kinds)

    def function(self, name: str, kinds: tuple[Kind, ...]) -> tuple[str, Kind]:
        """Return the symbol of a function for kinds of arguments, and the kind that it returns."""
        key = (name, kinds)
        if self._open:
            self._open[-1].calls[key] = None
        if key not in self._functions:
            found = self._functions[key] = _Written(f"{name}.{len(self._functions)}")
            self._open.append(found)
            try:
                emitter = self.emitter(name, kinds)
                found.text = emitter.written(found.symbol)
                found.returned = emitter.returns or NOTHING
                found.faulty = emitter.faulty
            except CannotCompile:
                del self._functions[key]
                raise
            finally:
                self._open.pop()
        found = self._functions[key]
        if found.returned is None:
            raise CannotCompile(f"{name} calls itself, which is not compiled")
        return found.symbol, found.returned

    def may_fail(self, name: str, values: Sequence[Value]) -> bool:
        """Tell whether something in a written function can fail, so that it returns no number."""
        return self._functions[name, tuple(value.kind for value in values)].faulty

    def checked(self, writer: Operations, place: Value, size: str) -> Value:
        """Return an index; with checks, one kept within its array, after code that records a fault where it was not."""
        if not self.checks:
            return place
        bad = writer.new(f"icmp uge i64 {place.parts[0]}, {size}")
        held = writer.new("load i64, ptr @fault")
        writer.add(f"store i64 {writer.new(f'select i1 {bad}, i64 1, i64 {held}')}, ptr @fault")
        return Value(INTEGER, (writer.new(f"select i1 {bad}, i64 0, i64 {place.parts[0]}"),))

    def entry(self, name: str, kinds: tuple[Kind, ...], symbol: str) -> tuple[Kind, str]:
        """Return the kind and text of the entry `symbol(in, out)` that Python calls, with all functions that it calls.

        Arguments and results are words of 8 bytes; the words of known arguments are not read.
        """
        lines, given = self.beside()
        at = len(given)
        for k, kind in enumerate(kinds):
            if kind.name == "c":
                lines.append(f"  %c{k} = getelementptr i64, ptr %in, i64 {at}")
                given.append(f"ptr %c{k}")
                at += words_of(kind)
                continue
            if k in self.known:
                assert kind == INTEGER
                given.append(f"i64 {self.known[k]}")
                at += 1
                continue
            for i, part in enumerate(kind.parts):
                lines.append(f"  %p{k}.{i} = getelementptr i64, ptr %in, i64 {at}")
                lines.append(f"  %a{k}.{i} = load {part}, ptr %p{k}.{i}{self.aligned}")
                given.append(f"{part} %a{k}.{i}")
                at += words_in(part)
        called, returned = self.function(name, kinds)
        call = f"call {returned.returned} @{called}({', '.join(given)})"
        lines.append(f"  {call}" if returned == NOTHING else f"  %r = {call}")
        numbers = returned.of if returned.name == "t" else (returned,) if returned != NOTHING else ()
        for i, kind in enumerate(numbers):
            value = f"%r{i}"
            lines.append(f"  %o{i} = getelementptr i64, ptr %out, i64 {self.lanes * i}")
            if returned.name == "t":
                lines.append(f"  {value} = extractvalue {returned.returned} %r, {i}")
            else:
                value = "%r"
            if kind in (TRUTH, TRUTHS):
                whole = INTEGER if kind == TRUTH else INTEGERS
                lines.append(f"  %w{i} = zext {kind.parts[0]} {value} to {whole.parts[0]}")
                value, kind = f"%w{i}", whole
            lines.append(f"  store {kind.parts[0]} {value}, ptr %o{i}{self.aligned}")
        if self.checks:
            lines += ["  %f = load i64, ptr @fault", "  store i64 0, ptr @fault", "  ret i64 %f"]
        else:
            lines.append("  ret i64 0")
        if not all(words_of(kind) == self.lanes for kind in numbers):
            what = "an array, which Python cannot take" if self.lanes == 1 else "what is the same for all lanes"
            raise TypeError(f"{name} returns {what}")
        return returned, self._whole_text((name, kinds), symbol, lines)

    def beside(self) -> tuple[list[str], list[str]]:
        """Return the lines with which an entry begins, and the arguments that they read, a word each."""
        return [], []

    def _whole_text(self, key: _Key, symbol: str, lines: list[str]) -> str:
        """Return the text of an entry, given its lines, with all functions that it calls."""
        call = "\n".join([f'define i64 @"{symbol}"(ptr %in, ptr %out) nounwind {{', *lines, "}"])
        found: dict[_Key, _Written] = {}
        left = [key]
        while left:
            one = left.pop()
            if one not in found:
                found[one] = self._functions[one]
                left += found[one].calls
        used = list(found.values())
        arrays = {array: self._arrays[array][1] for one in used for array in one.arrays}
        declared = {line: None for one in used for line in one.declared}
        texts = [FAULT, *arrays.values(), *declared, *(one.text for one in used), call, "!0 = !{}"]
        return "\n".join(texts) + "\n"
