"""Parser of a text of kernels: its functions and its constants."""

from __future__ import annotations

import ast
import re
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from screwsim.codegen.kinds import FLOAT, INTEGER, TRUTH, Kind, Value, array
from screwsim.numerics.kernel import nodes, parsed


class CannotCompile(TypeError):
    """A text contains something that cannot be compiled: says where and what."""


FUNCTION = re.compile(r"^def (\w+)", re.MULTILINE)
BEHIND = re.compile(r"^(?=[^\s)#])", re.MULTILINE)  # end of a function: next line neither indented, `)` nor #


class Functions(Mapping[str, ast.FunctionDef]):
    """Functions of a text by name, each parsed when first needed: of most texts only a part is compiled."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        self._texts, self._read = dict(texts), dict[str, ast.FunctionDef]()

    def __getitem__(self, name: str) -> ast.FunctionDef:
        if name not in self._read:
            [node] = parsed(self._texts[name]).body
            assert isinstance(node, ast.FunctionDef)
            self._read[name] = node
        return self._read[name]

    def __contains__(self, name: object) -> bool:
        return name in self._texts

    def __iter__(self) -> Iterator[str]:
        return iter(self._texts)

    def __len__(self) -> int:
        return len(self._texts)

    def and_those_of(self, other: Functions) -> Functions:
        """Return these functions with those of another, which replace functions of the same names."""
        return Functions(self._texts | other._texts)


@dataclass
class Program:
    """Functions and constants of a text, by name."""

    functions: Functions = field(default_factory=lambda: Functions({}))
    constants: dict[str, Any] = field(default_factory=dict)
    _assigned: dict[str, set[str]] = field(default_factory=dict)
    _outliving: dict[str, set[str]] = field(default_factory=dict)

    def assigned_in(self, function: str) -> set[str]:
        """Return the names that a function assigns."""
        if function not in self._assigned:
            found = (each for each in nodes(self.functions[function]) if isinstance(each, ast.Name))
            self._assigned[function] = {each.id for each in found if isinstance(each.ctx, ast.Store)}
        return self._assigned[function]

    def outliving_in(self, function: str) -> set[str]:
        """Return the counters of a function's loops that are read elsewhere than in the loop that counts."""
        if function not in self._outliving:
            self._outliving[function] = _outliving(self.functions[function])
        return self._outliving[function]

    @cached_property
    def has_own(self) -> bool:
        """Whether kernels of a user's own are among the functions."""
        return any(name.startswith("user_") for name in self.functions)


def _outliving(function: ast.FunctionDef) -> set[str]:
    every = nodes(function)
    loops: dict[str, list[ast.For]] = {}
    for node in every:
        if isinstance(node, ast.For) and isinstance(node.target, ast.Name):
            loops.setdefault(node.target.id, []).append(node)
    found = set[str]()
    for name, own in loops.items():
        inside = {id(node) for loop in own for node in nodes(*loop.body)}
        nested = any(id(loop) in inside for loop in own)
        if nested or any(_reads(node, name) and id(node) not in inside for node in every):
            found.add(name)
    return found


def _reads(node: ast.AST, name: str) -> bool:
    if isinstance(node, ast.AugAssign):
        return isinstance(node.target, ast.Name) and node.target.id == name
    return isinstance(node, ast.Name) and node.id == name and isinstance(node.ctx, ast.Load)


def read(text: str) -> Program:
    """Return the functions and constants of a text.

    Raise CannotCompile for anything but imports, constants and functions.
    """
    functions, others, at = dict[str, str](), list[tuple[int, str]](), 0
    for head in FUNCTION.finditer(text):
        if head.start() < at:
            continue
        others.append((at, text[at : head.start()]))
        behind = BEHIND.search(text, head.end())
        at = behind.start() if behind else len(text)
        functions[head[1]] = text[head.start() : at]
    others.append((at, text[at:]))
    found = Program(Functions(functions))
    for begin, other in others:
        _read_others(found, other, text.count("\n", 0, begin) if other.strip() else 0)
    return found


def _read_others(found: Program, text: str, lines_before: int) -> None:
    """Read the text between functions."""
    for node in parsed(text).body if text.strip() else ():
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                found.constants[name] = _constant(value)
            case ast.Import() | ast.ImportFrom() | ast.Expr(value=ast.Constant()):
                pass
            case _:
                line = lines_before + node.lineno
                raise CannotCompile(f"line {line}: {ast.unparse(node).splitlines()[0]!r} is not compiled")


def _constant(node: ast.expr) -> Any:
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "np.array":
        return np.array(ast.literal_eval(node.args[0]))
    return ast.literal_eval(node)


def called_name(node: ast.expr) -> str:
    """Return the text of what is called: `name` or `module.name`, without Python's unparser, which is slow."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return f"{node.value.id}.{node.attr}"
    return ast.unparse(node)


def float_text(value: float) -> str:
    """Return a float in LLVM IR: its bits."""
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
