"""Guards in kernels of a user's own: what Python would refuse gives NaN, and the case fails.

That is an index beyond an array, a division of whole numbers by zero, and `int` of infinity or NaN. A whole number
beyond 64 bits, which Python would take, is another.

A kernel where one of these may happen notes that it did, and then returns `NONE_SUCH` for every float; a kernel of a
user's own that calls it finds that NaN by its bits, and notes it, too, whatever it makes of the value.
"""

import ast
from collections.abc import Sequence

from screwsim.codegen.kinds import (
    FLOAT,
    FLOATS,
    INTEGER,
    INTEGERS,
    LANES,
    NUMBERS,
    OF_ONE,
    TRUTH,
    Kind,
    Value,
    condition_of,
    joined,
)
from screwsim.codegen.operations import Operations
from screwsim.codegen.program import constant

NONE_SUCH = 0x7FF8_0000_0FA0_17ED  # bits of a NaN that no arithmetic makes
BEYOND = 2.0**63  # smallest float that is no integer of 64 bits
LEAST = -(2**63)
CHECKED: dict[type, str] = {ast.Add: "sadd", ast.Sub: "ssub", ast.Mult: "smul"}


class Guards(Operations):
    """Part of an emitter that keeps a user's kernel from reading and dividing what is not there."""

    fault = ""  # memory of whether something failed; '' in a kernel where nothing can
    faulty = False  # whether something in the kernel can fail
    again: bool  # whether the function has to be written again
    slots: list[str]

    def slot(self, part: str) -> str:
        """Return stack memory for one register."""
        raise NotImplementedError

    def begin_guards(self) -> None:
        """Begin the function with nothing failed."""
        self.fault = ""
        if self.faulty:
            part = self.conditions().parts[0]
            self.fault = self.slot(part)
            self.slots.append(f"  store {part} zeroinitializer, ptr {self.fault}")

    def conditions(self) -> Kind:
        """Return the kind of condition that may differ between points computed together."""
        return TRUTH

    def active(self, where: Value) -> str:
        """Return where a condition holds in a point that is computed."""
        return where.parts[0]

    def note(self, where: Value) -> Value:
        """Note that the kernel has no value where a condition holds; return the condition."""
        if where.known is not None:
            return where
        if not self.fault:
            self.faulty = self.again = True
            return where
        part, now = self.conditions().parts[0], self.active(where)
        before = self.new(f"load {part}, ptr {self.fault}")
        self.add(f"store {part} {self.new(f'or {part} {before}, {now}')}, ptr {self.fault}")
        return where

    def kind_to_return(self, kind: Kind, node: ast.AST) -> Kind:
        """Return the kind in which a value can be returned: where something can fail, one that can be NaN."""
        if not self.faulty or kind in (FLOAT, FLOATS):
            return kind
        if OF_ONE.get(kind, kind) in NUMBERS:
            return joined(kind, FLOAT) or kind
        if kind.name != "t" or not {FLOAT, FLOATS} & {*kind.of}:
            raise self.fail(node, "an index, a division or int() may fail here, and no float is returned to show it")
        return kind

    def or_none(self, value: Value) -> Value:
        """Return a value whose floats are NaN where something failed."""
        if not self.fault:
            return value
        if value.kind.name == "t":
            items = [self.or_none(each) for each in value.items()]
            return Value(value.kind, tuple(part for each in items for part in each.parts))
        if value.kind not in (FLOAT, FLOATS):
            return value
        kind = self.conditions()
        failed = Value(kind, (self.new(f"load {kind.parts[0]}, ptr {self.fault}"),))
        return self.chosen(failed, Value(FLOAT, (f"0x{NONE_SUCH:016X}",)), value)

    def note_of_call(self, value: Value) -> None:
        """Note that what a called kernel of a user's own returned is none."""
        items = value.items() if value.kind.name == "t" else [value]
        number = next(each for each in items if each.kind in (FLOAT, FLOATS))
        bits = self._same_bits([number], ast.Pass())
        self.note(self.compare(ast.Eq(), bits, constant(NONE_SUCH), ast.Pass()))

    # ---- whole numbers ---------------------------------------------------------------------------------------------

    def operation(self, op: ast.operator, a: Value, b: Value, node: ast.AST) -> Value:
        what = type(op)
        if self.own and what in (ast.FloorDiv, ast.Mod, *CHECKED):
            kind = self.common(what.__name__, (a, b), node)
            if kind in (INTEGER, INTEGERS) and what not in CHECKED:
                b = self._divisor(a, b, node)
            elif kind in (INTEGER, INTEGERS) and (a.known is None or b.known is None):
                return self._within_64_bits(CHECKED[what], a, b, kind)
        return super().operation(op, a, b, node)

    def _within_64_bits(self, how: str, a: Value, b: Value, kind: Kind) -> Value:
        """Return a sum, difference or product of whole numbers, and note where it has more than 64 bits."""
        part, over = kind.parts[0], condition_of(kind)
        name = f"llvm.{how}.with.overflow.{'i64' if kind == INTEGER else f'v{LANES}i64'}"
        both = f"{{{part}, {over.parts[0]}}}"
        self.library.declare(f"declare {both} @{name}({part}, {part})")
        x, y = (self.as_kind(each, kind).parts[0] for each in (a, b))
        found = self.new(f"call {both} @{name}({part} {x}, {part} {y})")
        self.note(Value(over, (self.new(f"extractvalue {both} {found}, 1"),)))
        return Value(kind, (self.new(f"extractvalue {both} {found}, 0"),))

    def as_kind(self, value: Value, kind: Kind) -> Value:
        if self.own and kind in (INTEGER, INTEGERS) and not LEAST <= (value.known or 0) < -LEAST:
            raise self.fail(ast.Constant(value.known), "a whole number of more than 64 bits")
        return super().as_kind(value, kind)

    def _divisor(self, a: Value, b: Value, node: ast.AST) -> Value:
        """Return a divisor, 1 where it is zero or the quotient is beyond 64 bits, which end a process."""
        b = self.whole(b, node)
        if b.known is not None and b.known != -1:
            if not b.known:
                raise self.fail(node, "a division by zero")
            return b
        whole = INTEGERS if INTEGERS in (a.kind, b.kind) else INTEGER
        least = self.compare(ast.Eq(), self.as_kind(a, whole), constant(LEAST), node)
        bad = self.compare(ast.Eq(), b, constant(0), node)
        for one in (bad, self.chosen(least, self.compare(ast.Eq(), b, constant(-1), node), constant(False))):
            b = self.chosen(self.note(one), constant(1), b)
        return b

    def _int(self, values: Sequence[Value], node: ast.Call) -> Value:
        value = values[0]
        if self.own and value.kind in (FLOAT, FLOATS) and value.known is None:
            above = self.compare(ast.GtE(), value, constant(-BEYOND), node)
            held = self.chosen(above, self.compare(ast.Lt(), value, constant(BEYOND), node), constant(False))
            value = self.chosen(self.note(self.negated(held)), constant(0.0), value)
        return super()._int([value], node)

    # ---- places in arrays ------------------------------------------------------------------------------------------

    def length_of(self, size: str) -> Value:
        """Return the length of an array's axis."""
        return constant(int(size)) if size.isdigit() else Value(INTEGER, (size,))

    def from_start(self, k: Value, length: Value, node: ast.AST) -> Value:
        """Return an index counted from an array's start; in a kernel of a user's own, 0 where it is beyond the array.

        Only there a variable may be below zero; ours are written so that none is.
        """
        if not self.own:
            return super().from_start(k, length, node)
        length = self.length_of(length.parts[0])
        k = self._counted(k, length, node)
        for beyond in (self.compare(ast.Lt(), k, constant(0), node), self.compare(ast.GtE(), k, length, node)):
            if beyond.known:
                raise self.fail(node, f"an index beyond the {length.parts[0]} items of the array")
            k = self.chosen(self.note(beyond), constant(0), k)
        return k

    def _counted(self, k: Value, length: Value, node: ast.AST) -> Value:
        """Return a place counted from an array's start, where it may count from its end."""
        below = self.compare(ast.Lt(), k, constant(0), node)
        return k if below.known is False else self.chosen(below, super().operation(ast.Add(), k, length, node), k)

    def within(self, first: Value, last: Value, size: str, node: ast.AST) -> tuple[Value, Value, Value]:
        """Return begin, end and length of a slice of a user's array as Python cuts it; an empty one begins inside."""
        length = self.length_of(size)
        first, last = (self._held(self._counted(k, length, node), length, node) for k in (first, last))
        count = self._held(self.operation(ast.Sub(), last, first, node), length, node)
        return self._held(first, self.operation(ast.Sub(), length, constant(1), node), node), last, count

    def _held(self, k: Value, most: Value, node: ast.AST) -> Value:
        """Return a number held between a largest one and 0, which comes last."""
        k = self.chosen(self.compare(ast.Gt(), k, most, node), most, k)
        return self.chosen(self.compare(ast.Lt(), k, constant(0), node), constant(0), k)
