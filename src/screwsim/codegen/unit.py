"""Functions of a text that are compiled together, because one calls the other, in LLVM's language."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.codegen.emit import Emitter
from screwsim.codegen.kinds import FLOAT, INTEGER, NOTHING, TRUTH, Kind, Value
from screwsim.codegen.program import CannotCompile, Program, constant, constant_array

if TYPE_CHECKING:
    import ast

    from screwsim.codegen.operations import Operations

FAULT = "@fault = internal global i64 0"


class Unit:
    """Collects what functions of a program become; with `checks` every index is held within its array.

    `outside` are addresses of functions of this process that the program calls, with numbers and arrays, for nothing.
    """

    def __init__(self, program: Program, outside: Mapping[str, int] | None = None, checks: bool = False) -> None:
        self.program, self.outside, self.checks = program, outside or {}, checks
        self._functions: dict[tuple[str, tuple[Kind, ...]], tuple[str, Kind] | None] = {}
        self._texts: list[str] = []
        self._arrays: dict[str, tuple[Value, str]] = {}
        self._declared: dict[str, None] = {}

    def declare(self, line: str) -> None:
        self._declared[line] = None

    def constant(self, name: str) -> Value | None:
        """Return a constant of the text; None where none has this name."""
        value: Any = self.program.constants.get(name)
        if isinstance(value, np.ndarray):
            if name not in self._arrays:
                self._arrays[name] = constant_array(name, value)
            return self._arrays[name][0]
        return None if value is None else constant(value)

    def function(self, name: str, kinds: tuple[Kind, ...]) -> tuple[str, Kind]:
        """Return the symbol of a function for kinds of arguments, and the kind of what it returns."""
        key = (name, kinds)
        if key not in self._functions:
            self._functions[key] = None
            emitter = Emitter(self, name, kinds)
            symbol = f"{name}.{len(self._functions)}"
            self._texts.append(emitter.written(symbol))
            self._functions[key] = symbol, emitter.returns or NOTHING
        found = self._functions[key]
        if found is None:
            raise CannotCompile(f"{name} calls itself, which is not compiled")
        return found

    def checked(self, writer: Operations, place: str, size: str, node: ast.AST) -> str:
        """Return an index; with checks one that is within its array, and a note of one that was not."""
        if not self.checks:
            return place
        bad = writer.new(f"icmp uge i64 {place}, {size}")
        held = writer.new("load i64, ptr @fault")
        writer.add(f"store i64 {writer.new(f'select i1 {bad}, i64 1, i64 {held}')}, ptr @fault")
        return writer.new(f"select i1 {bad}, i64 0, i64 {place}")

    def entry(self, name: str, kinds: Sequence[Kind], symbol: str) -> Kind:
        """Write what Python calls, `symbol(in, out)`: arguments and results are words of 8 bytes; return its kind."""
        given, lines, at = [], [], 0
        for k, kind in enumerate(kinds):
            if kind.name == "c":
                lines.append(f"  %c{k} = getelementptr i64, ptr %in, i64 {at}")
                given.append(f"ptr %c{k}")
                at += sum(len(inner.parts) for inner in kind.of)
                continue
            for i, part in enumerate(kind.parts):
                lines.append(f"  %p{k}.{i} = getelementptr i64, ptr %in, i64 {at}")
                lines.append(f"  %a{k}.{i} = load {part}, ptr %p{k}.{i}")
                given.append(f"{part} %a{k}.{i}")
                at += 1
        called, returned = self.function(name, tuple(kinds))
        call = f"call {returned.returned} @{called}({', '.join(given)})"
        lines.append(f"  {call}" if returned == NOTHING else f"  %r = {call}")
        scalars = returned.of if returned.name == "t" else (returned,) if returned != NOTHING else ()
        for i, kind in enumerate(scalars):
            value = f"%r{i}"
            lines.append(f"  %o{i} = getelementptr i64, ptr %out, i64 {i}")
            if returned.name == "t":
                lines.append(f"  {value} = extractvalue {returned.returned} %r, {i}")
            else:
                value = "%r"
            if kind == TRUTH:
                lines.append(f"  %w{i} = zext i1 {value} to i64")
                value, kind = f"%w{i}", INTEGER
            lines.append(f"  store {kind.parts[0]} {value}, ptr %o{i}")
        if self.checks:
            lines += ["  %f = load i64, ptr @fault", "  store i64 0, ptr @fault", "  ret i64 %f"]
        else:
            lines.append("  ret i64 0")
        self._texts.append("\n".join([f'define i64 @"{symbol}"(ptr %in, ptr %out) nounwind {{', *lines, "}"]))
        assert all(kind in (FLOAT, INTEGER, TRUTH) for kind in scalars)
        return returned

    def text(self) -> str:
        """Return all that was written."""
        fault = [FAULT] if self.checks else []
        arrays = [text for _, text in self._arrays.values()]
        return "\n".join([*fault, *arrays, *self._declared, *self._texts, "!0 = !{}"]) + "\n"
