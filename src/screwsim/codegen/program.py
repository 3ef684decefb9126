"""A text of kernels, read: its functions and its constants."""

from __future__ import annotations

import ast
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from screwsim.codegen.kinds import FLOAT, INTEGER, TRUTH, Kind, Value, array
from screwsim.numerics.kernel import nodes, parsed


class CannotCompile(TypeError):
    """A text holds what is not compiled: where, and what."""


@dataclass
class Program:
    """Functions and constants of a text, by name."""

    functions: dict[str, ast.FunctionDef] = field(default_factory=dict)
    constants: dict[str, Any] = field(default_factory=dict)
    _assigned: dict[str, set[str]] = field(default_factory=dict)

    def assigned_in(self, function: str) -> set[str]:
        """Return the names that a function gives values."""
        if function not in self._assigned:
            found = (each for each in nodes(self.functions[function]) if isinstance(each, ast.Name))
            self._assigned[function] = {each.id for each in found if isinstance(each.ctx, ast.Store)}
        return self._assigned[function]


def read(text: str) -> Program:
    """Return what a text holds; raise CannotCompile for anything but imports, constants and functions."""
    found = Program()
    for node in parsed(text).body:
        match node:
            case ast.FunctionDef(name=name):
                found.functions[name] = node
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                found.constants[name] = _constant(value)
            case ast.Import() | ast.ImportFrom() | ast.Expr(value=ast.Constant()):
                pass
            case _:
                raise CannotCompile(f"line {node.lineno}: {ast.unparse(node).splitlines()[0]!r} is not compiled")
    return found


def _constant(node: ast.expr) -> Any:
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "np.array":
        return np.array(ast.literal_eval(node.args[0]))
    return ast.literal_eval(node)


def float_text(value: float) -> str:
    """Return a float in LLVM's language: its bits."""
    return f"0x{struct.unpack('>Q', struct.pack('>d', value))[0]:016X}"


def constant(value: Any) -> Value:
    """Return a number as a value."""
    if isinstance(value, bool):
        return Value(TRUTH, ("true" if value else "false",), value)
    if isinstance(value, int):
        return Value(INTEGER, (str(value),), value)
    return Value(FLOAT, (float_text(value),), value)


def constant_array(name: str, table: np.ndarray) -> tuple[Value, str]:
    """Return an array of constants as a value, and its definition."""
    whole = np.issubdtype(table.dtype, np.integer)
    kind: Kind = array(INTEGER if whole else FLOAT, table.ndim)
    of = "i64" if whole else "double"
    items = ", ".join(f"{of} {int(one) if whole else float_text(float(one))}" for one in table.ravel())
    text = f"@{name} = internal unnamed_addr constant [{table.size} x {of}] [{items}]"
    return Value(kind, (f"@{name}", *(str(n) for n in table.shape))), text
