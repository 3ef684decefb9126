"""Arithmetic, comparisons, elements of arrays and functions of `math` in LLVM IR."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from screwsim.codegen.kinds import (
    ARRAYS,
    FLOAT,
    FLOATS,
    INTEGER,
    INTEGERS,
    NUMBERS,
    OF_ONE,
    TRUTH,
    TRUTHS,
    Kind,
    Value,
    condition_of,
    words_in,
    words_of,
)
from screwsim.codegen.program import called_name, constant

if TYPE_CHECKING:
    from screwsim.codegen.library import Library
    from screwsim.codegen.program import CannotCompile

BY_FLOATS = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
BY_INTEGERS = {ast.Add: "add nsw", ast.Sub: "sub nsw", ast.Mult: "mul nsw"}
# in lanes that are not active integers may overflow
BY_KIND: dict[Kind, dict[type, str]] = {FLOAT: BY_FLOATS, FLOATS: BY_FLOATS, INTEGER: BY_INTEGERS}
BY_KIND[INTEGERS] = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul"}
TRUE = {TRUTH: "true", TRUTHS: "splat (i1 true)"}
SAME_BITS = {FLOAT: INTEGER, INTEGER: FLOAT, FLOATS: INTEGERS, INTEGERS: FLOATS}
FOLDED: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
COMPARED: dict[type, tuple[str, str, Callable[[Any, Any], bool]]] = {
    ast.Eq: ("eq", "oeq", operator.eq),
    ast.NotEq: ("ne", "une", operator.ne),
    ast.Lt: ("slt", "olt", operator.lt),
    ast.LtE: ("sle", "ole", operator.le),
    ast.Gt: ("sgt", "ogt", operator.gt),
    ast.GtE: ("sge", "oge", operator.ge),
}
LARGEST_POWER = 64  # largest integer exponent that is multiplied out
# functions of one or two floats: intrinsics of LLVM, and those of the C library
OWN = {name: f"llvm.{name}.f64" for name in ("sqrt", "exp", "log", "log10", "log2", "sin", "cos", "pow", "copysign")}
OWN |= {"fabs": "llvm.fabs.f64"}
LIBRARY = ("expm1", "log1p", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "atan2", "hypot", "cbrt", "erf")
LIBRARY += ("fmod",)
ROUNDED = {"floor": "llvm.floor.f64", "ceil": "llvm.ceil.f64"}
OF_TWO = ("pow", "copysign", "atan2", "hypot", "fmod")


class Operations:
    """Part of an emitter that writes operators and functions; `lines` are those of the block being written."""

    library: Library
    lines: list[str]
    count: int
    block: str
    closed: bool
    own: bool  # whether the function is of a user's module

    def fail(self, node: ast.AST, what: str) -> CannotCompile:
        raise NotImplementedError

    # ---- lines and blocks ------------------------------------------------------------------------------------------

    def add(self, line: str) -> None:
        self.lines.append("  " + line)

    def new(self, operation: str) -> str:
        """Write an operation; return the register of its result."""
        self.count += 1
        register = f"%v{self.count}"
        self.lines.append(f"  {register} = {operation}")
        return register

    def labels(self, *stems: str) -> list[str]:
        self.count += 1
        return [f"{stem}{self.count}" for stem in stems]

    def start(self, label: str) -> None:
        self.lines.append(f"{label}:")
        self.block, self.closed = label, False

    def jump(self, label: str) -> None:
        if not self.closed:
            self.add(f"br label %{label}")
        self.closed = True

    def branch(self, test: Value, then: str, other: str) -> None:
        self.add(f"br i1 {test.parts[0]}, label %{then}, label %{other}")
        self.closed = True

    # ---- kinds -----------------------------------------------------------------------------------------------------

    def as_kind(self, value: Value, kind: Kind) -> Value:
        """Return a value converted to another kind."""
        if value.kind == kind:
            return value
        if kind.name == "t":
            items = [self.as_kind(one, inner) for one, inner in zip(value.items(), kind.of, strict=True)]
            return Value(kind, tuple(part for one in items for part in one.parts))
        if value.known is not None:
            return constant(float(value.known) if kind == FLOAT else int(value.known))
        if value.kind == FLOAT:  # stored in an array of integers
            return Value(INTEGER, (self.new(f"fptosi double {value.parts[0]} to i64"),))
        if value.kind == TRUTH:
            how = "zext i1 {} to i64" if kind == INTEGER else "uitofp i1 {} to double"
            return Value(kind, (self.new(how.format(value.parts[0])),))
        return Value(FLOAT, (self.new(f"sitofp i64 {value.parts[0]} to double"),))

    def as_float(self, value: Value) -> str:
        return self.as_kind(value, FLOAT).parts[0]

    def whole(self, value: Value, node: ast.AST) -> Value:
        if value.kind not in (INTEGER, TRUTH):
            raise self.fail(node, f"{value.kind} is no whole number")
        return self.as_kind(value, INTEGER)

    def items(self, value: Value) -> list[Value]:
        """Return the items of a tuple or a context."""
        if value.kind.name == "c":
            return [self.of_context(value, k) for k in range(len(value.kind.of))]
        return value.items()

    def of_context(self, value: Value, k: int) -> Value:
        """Return one item of a context, read from memory that does not change."""
        kind = value.kind.of[k]
        at, parts = sum(words_of(each) for each in value.kind.of[:k]), []
        for part in kind.parts:
            place = self.new(f"getelementptr inbounds i64, ptr {value.parts[0]}, i64 {at}")
            parts.append(self.new(f"load {part}, ptr {place}{self.library.aligned}, !invariant.load !0"))
            at += words_in(part)
        return Value(kind, tuple(parts))

    # ---- operators -------------------------------------------------------------------------------------------------

    def common(self, what: str, values: Sequence[Value], node: ast.AST) -> Kind:
        """Return the kind of number in which values are computed together; where one is no number, fail at `what`."""
        kinds = [value.kind for value in values]
        if not all(kind in NUMBERS for kind in kinds):
            raise self.fail(node, f"{what} of {' and '.join(map(str, kinds))} is not compiled")
        return FLOAT if FLOAT in kinds else INTEGER

    def operation(self, op: ast.operator, a: Value, b: Value, node: ast.AST) -> Value:
        """Return the result of an operator on two numbers."""
        what = type(op)
        kind = self.common(what.__name__, (a, b), node)
        if what is ast.Pow:
            return self._power(a, b, node)
        if kind == INTEGER and a.known is not None and b.known is not None and what in FOLDED:
            return constant(int(FOLDED[what](a.known, b.known)))
        if what is ast.FloorDiv or what is ast.Mod:
            return self._divided(what is ast.Mod, a, b, kind, node)
        if what is ast.Div:
            kind = FLOATS if kind in OF_ONE else FLOAT
        if what not in BY_KIND[kind]:
            raise self.fail(node, f"{what.__name__} is not compiled")
        x, y = self.as_kind(a, kind).parts[0], self.as_kind(b, kind).parts[0]
        return Value(kind, (self.new(f"{BY_KIND[kind][what]} {kind.parts[0]} {x}, {y}"),))

    def _divided(self, rest: bool, a: Value, b: Value, kind: Kind, node: ast.AST) -> Value:
        """Return quotient or remainder as Python defines them: with the quotient rounded down."""
        x, y, part = self.as_kind(a, kind).parts[0], self.as_kind(b, kind).parts[0], kind.parts[0]
        truth = condition_of(kind).parts[0]
        if kind in (FLOAT, FLOATS):
            if not rest:
                raise self.fail(node, "// of floats is not compiled; use math.floor")
            left = self.remainder(x, y)
            other = self.new(f"fcmp olt {part} {self.new(f'fmul {part} {left}, {y}')}, zeroinitializer")
            more = self.new(f"fadd {part} {left}, {y}")
            return Value(kind, (self.new(f"select {truth} {other}, {part} {more}, {part} {left}"),))
        left = self.new(f"srem {part} {x}, {y}")
        apart = self.new(f"icmp slt {part} {self.new(f'xor {part} {left}, {y}')}, zeroinitializer")
        other = self.new(f"and {truth} {apart}, {self.new(f'icmp ne {part} {left}, zeroinitializer')}")
        if rest:
            more = self.new(f"add {part} {left}, {y}")
            return Value(kind, (self.new(f"select {truth} {other}, {part} {more}, {part} {left}"),))
        quotient, less = self.new(f"sdiv {part} {x}, {y}"), self.new(f"zext {truth} {other} to {part}")
        return Value(kind, (self.new(f"sub {part} {quotient}, {less}"),))

    def remainder(self, x: str, y: str) -> str:
        """Return the remainder of a division of floats, with the quotient rounded towards zero."""
        return self.new(f"frem double {x}, {y}")

    def _power(self, a: Value, b: Value, node: ast.AST) -> Value:
        if b.kind == INTEGER and isinstance(b.known, int) and abs(b.known) <= LARGEST_POWER:
            return self._multiplied(a, b.known)
        if not {FLOAT, FLOATS} & {a.kind, b.kind}:
            raise self.fail(node, "an integer to the power of another is not compiled")
        return self.called("pow", [a, b])

    def _multiplied(self, a: Value, exponent: int) -> Value:
        left, square, whole = abs(exponent), a, None
        while left:
            if left & 1:
                whole = square if whole is None else self.operation(ast.Mult(), whole, square, ast.Pass())
            left >>= 1
            if left:
                square = self.operation(ast.Mult(), square, square, ast.Pass())
        whole = whole or constant(1.0 if a.kind in (FLOAT, FLOATS) else 1)
        return whole if exponent >= 0 else self.operation(ast.Div(), constant(1.0), whole, ast.Pass())

    def signed(self, op: ast.unaryop, value: Value, node: ast.AST) -> Value:
        """Return a number, or its negative."""
        kind = self.common(type(op).__name__, (value,), node)
        if not isinstance(op, ast.USub | ast.UAdd):
            raise self.fail(node, f"{type(op).__name__} of {value.kind} is not compiled")
        if value.known is not None:
            return constant(-value.known if isinstance(op, ast.USub) else +value.known)
        value = self.as_kind(value, kind)
        if isinstance(op, ast.UAdd):
            return value
        part = kind.parts[0]
        how = f"fneg {part}" if kind in (FLOAT, FLOATS) else f"{BY_KIND[kind][ast.Sub]} {part} zeroinitializer,"
        return Value(kind, (self.new(f"{how} {value.parts[0]}"),))

    def negated(self, value: Value) -> Value:
        """Return whether a condition does not hold."""
        if value.known is not None:
            return constant(not value.known)
        return Value(value.kind, (self.new(f"xor {value.kind.parts[0]} {value.parts[0]}, {TRUE[value.kind]}"),))

    def compare(self, op: ast.cmpop, a: Value, b: Value, node: ast.AST) -> Value:
        """Return whether a comparison of two numbers holds."""
        kind = self.common(type(op).__name__, (a, b), node)
        if type(op) not in COMPARED:
            raise self.fail(node, f"{type(op).__name__} of {a.kind} and {b.kind} is not compiled")
        whole, floating, known = COMPARED[type(op)]
        if a.known is not None and b.known is not None:
            return constant(bool(known(a.known, b.known)))
        how = f"fcmp {floating}" if kind in (FLOAT, FLOATS) else f"icmp {whole}"
        x, y = self.as_kind(a, kind).parts[0], self.as_kind(b, kind).parts[0]
        return Value(condition_of(kind), (self.new(f"{how} {kind.parts[0]} {x}, {y}"),))

    def chosen(self, where: Value, one: Value, other: Value) -> Value:
        """Return the first of two values of a kind where a condition holds, the second elsewhere."""
        if where.known is not None:  # so that what is chosen of constants is one
            return one if where.known else other
        test = f"{where.kind.parts[0]} {where.parts[0]}"
        parts = zip(one.kind.parts, one.parts, other.parts, strict=True)
        return Value(one.kind, tuple(self.new(f"select {test}, {part} {a}, {part} {b}") for part, a, b in parts))

    # ---- elements --------------------------------------------------------------------------------------------------

    def expression(self, node: ast.expr) -> Value:
        raise NotImplementedError

    def element(self, of: Value, index: ast.expr, node: ast.AST) -> tuple[str, Kind]:
        """Return the address of an array's element, and the kind of array that begins there."""
        indices = index.elts if isinstance(index, ast.Tuple) else [index]
        if of.kind.name not in ARRAYS or len(indices) != of.kind.axes:
            raise self.fail(node, f"{len(indices)} indices of {of.kind} are not compiled")
        at: Value | None = None
        for each, size in zip(indices, of.parts[1:], strict=True):
            length, k = Value(INTEGER, (size,)), self.whole(self.expression(each), node)
            k = self.library.checked(self, self.from_start(k, length, node), size)
            at = k if at is None else self.operation(ast.Add(), self.operation(ast.Mult(), at, length, node), k, node)
        assert at is not None
        return self.moved(of, at)

    def from_start(self, k: Value, length: Value, node: ast.AST) -> Value:
        """Return an index counted from an array's start, where it may count from its end."""
        return self.operation(ast.Add(), length, k, node) if k.known is not None and k.known < 0 else k

    def moved(self, of: Value, at: Value) -> tuple[str, Kind]:
        """Return the address a number of elements further on, and the kind of array that begins there."""
        one = of.kind.of[0].parts[0]
        return self.new(f"getelementptr inbounds {one}, ptr {of.parts[0]}, i64 {at.parts[0]}"), of.kind

    def read(self, place: str, kind: Kind) -> Value:
        """Return the value at an address, the first element of an array."""
        of = kind.of[0]
        return Value(of, (self.new(f"load {of.parts[0]}, ptr {place}"),))

    def write(self, place: str, kind: Kind, value: Value) -> None:
        """Store a value at an address, as the first element of an array."""
        of = kind.of[0]
        self.add(f"store {of.parts[0]} {self.as_kind(value, of).parts[0]}, ptr {place}")

    # ---- functions -------------------------------------------------------------------------------------------------

    def builtin(self, name: str) -> Callable[[Sequence[Value], ast.Call], Value] | None:
        """Return the writer of calls of a function that is not a kernel; None where it is unknown."""
        plain = {
            "abs": self._abs,
            "min": self._extreme,
            "max": self._extreme,
            "int": self._int,
            "float": self._float,
            "len": self._length,
            "bits_of": self._same_bits,  # see `codegen.lane_math`
            "of_bits": self._same_bits,
        }
        function = name.removeprefix("math.")
        if name == function or not (function in OWN or function in LIBRARY or function in ROUNDED):
            return plain.get(name)
        if function in ROUNDED:
            return lambda values, node: self._int([self.called(function, values)], node)
        return lambda values, node: self.called(function, values)

    @staticmethod
    def takes(name: str, count: int) -> bool:
        """Tell whether a function that is not a kernel takes so many numbers."""
        if name in ("min", "max"):
            return count > 1
        return count == (2 if name.removeprefix("math.") in OF_TWO else 1)

    def called(self, function: str, values: Sequence[Value]) -> Value:
        """Return the value of a function of one or two floats."""
        name = OWN.get(function) or ROUNDED.get(function) or function
        count = 2 if function in OF_TWO else 1
        self.library.declare(
            f"declare double @{name}({', '.join(['double'] * count)}) nounwind willreturn memory(none)"
        )
        given = ", ".join(f"double {self.as_float(value)}" for value in values)
        return Value(FLOAT, (self.new(f"call double @{name}({given})"),))

    def _abs(self, values: Sequence[Value], node: ast.Call) -> Value:
        if values[0].kind in (FLOAT, FLOATS):
            return self.called("fabs", values)
        value = self.whole(values[0], node)
        below = self.compare(ast.Lt(), value, constant(0), node)
        return self.chosen(below, self.signed(ast.USub(), value, node), value)

    def _extreme(self, values: Sequence[Value], node: ast.Call) -> Value:
        """Return the smallest or largest value, the first of equal ones."""
        name = called_name(node.func)
        op, kind = ast.Gt() if name == "max" else ast.Lt(), self.common(name, values, node)
        best = self.as_kind(values[0], kind)
        for value in values[1:]:
            other = self.as_kind(value, kind)
            best = self.chosen(self.compare(op, other, best, node), other, best)
        return best

    def _int(self, values: Sequence[Value], node: ast.Call) -> Value:
        kind = self.common("int", values, node)
        return self.as_kind(values[0], INTEGERS if kind in OF_ONE else INTEGER)

    def _float(self, values: Sequence[Value], node: ast.Call) -> Value:
        return self.as_kind(values[0], self.common("float", (*values, constant(0.0)), node))

    def _same_bits(self, values: Sequence[Value], node: ast.AST) -> Value:
        """Return the integer with the bits of a float, or the float with those of an integer."""
        kind = self.common("bits", values, node)
        found, value = SAME_BITS[kind], self.as_kind(values[0], kind)
        return Value(found, (self.new(f"bitcast {kind.parts[0]} {value.parts[0]} to {found.parts[0]}"),))

    def _length(self, values: Sequence[Value], node: ast.Call) -> Value:
        return Value(INTEGER, (values[0].parts[1],))
