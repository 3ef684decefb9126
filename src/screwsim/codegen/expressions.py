"""Expressions of a text in LLVM IR: names, conditional expressions, elements and parts of arrays, calls of kernels."""

import ast
import math
from collections.abc import Callable, Sequence

from screwsim.codegen.guards import Guards
from screwsim.codegen.kinds import (
    ARRAYS,
    FLOAT,
    INTEGER,
    NOTHING,
    NUMBERS,
    OF_ONE,
    TRUTH,
    TRUTHS,
    Kind,
    Value,
    array,
    joined,
    row_of,
)
from screwsim.codegen.program import called_name, constant
from screwsim.numerics.expressions import choice_of

NONE = Value(NOTHING, ())
EMPTY = {"np.empty": False, "np.zeros": True}


def is_condition(node: ast.expr) -> bool:
    """Tell whether the text of an expression says that its value is a truth."""
    if isinstance(node, ast.BoolOp):
        return all(map(is_condition, node.values))
    return isinstance(node, ast.Compare) or (isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not))


class Expressions(Guards):
    """Part of an emitter that writes expressions; it knows the variables."""

    def load(self, name: str, node: ast.AST) -> Value:
        """Return the value of a variable or a constant."""
        raise NotImplementedError

    def slot(self, part: str) -> str:
        """Return stack memory for one register."""
        raise NotImplementedError

    def expression(self, node: ast.expr) -> Value:
        if type(node) is ast.Name:  # nearly all nodes are one of these two
            return self.load(node.id, node)
        if type(node) is ast.BinOp:
            return self.operation(node.op, self.expression(node.left), self.expression(node.right), node)
        match node:
            case ast.Constant(value=bool() | int() | float() as value):
                return constant(value)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return self.negated(self.truth(operand))
            case ast.UnaryOp(op=op, operand=operand):
                return self.signed(op, self.expression(operand), node)
            case ast.BoolOp(values=values) if all(map(is_condition, values)):
                return self.truth(node)
            case ast.BoolOp():
                return self.expression(choice_of(node))
            case ast.Compare(left=left, ops=ops, comparators=others):
                return self._compared(left, ops, others, node)
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return self._choice(test, body, orelse, node)
            case ast.Tuple(elts=elements):
                found = [self.expression(each) for each in elements]
                kind = Kind("t", tuple(each.kind for each in found))
                return Value(kind, tuple(part for each in found for part in each.parts))
            case ast.Subscript(value=of, slice=index):
                return self._subscript(self.expression(of), index, node)
            case ast.Attribute(value=ast.Name(id="math"), attr="inf" | "pi" | "e" | "nan" as name):
                return constant(getattr(math, name))
            case ast.Attribute(value=of, attr=name):
                return self._attribute(self.expression(of), name, node)
            case ast.Call():
                return self._call(node)
        raise self.fail(node, "this is not compiled")

    def _attribute(self, of: Value, name: str, node: ast.expr) -> Value:
        """Return an array's shape, or the item of a context with a given name."""
        if of.kind.name in ARRAYS and name == "shape":
            return Value(Kind("t", (INTEGER,) * of.kind.axes), of.parts[1:])
        if name not in of.kind.names:
            raise self.fail(node, f"{of.kind} has no {name}")
        return self.of_context(of, of.kind.names.index(name))

    def truth(self, node: ast.expr) -> Value:
        if isinstance(node, ast.BoolOp):
            return self._both(isinstance(node.op, ast.And), node.values)
        value = self.expression(node)
        if value.kind in (TRUTH, TRUTHS):
            return value
        if value.kind not in NUMBERS and value.kind not in OF_ONE:
            raise self.fail(node, f"{value.kind} is no condition")
        return self.compare(ast.NotEq(), value, constant(0), node)

    def _both(self, every: bool, nodes: Sequence[ast.expr]) -> Value:
        """Return whether all conditions hold, or any.

        Later ones are evaluated only where earlier ones do not decide.
        """
        after, met = self.labels("after")[0], []
        for k, node in enumerate(nodes):
            value = self.truth(node)
            if value.known is not None and k < len(nodes) - 1:
                if bool(value.known) is every:
                    continue
                nodes, k = nodes[: k + 1], k
            if k == len(nodes) - 1:
                if not met:
                    return value
                met.append((value.parts[0], self.block))
                self.jump(after)
                break
            following = self.labels("more")[0]
            met.append(("false" if every else "true", self.block))
            self.branch(value, *((following, after) if every else (after, following)))
            self.start(following)
        self.start(after)
        return Value(TRUTH, (self.new("phi i1 " + ", ".join(f"[{one}, %{block}]" for one, block in met)),))

    def _compared(self, left: ast.expr, ops: Sequence[ast.cmpop], others: Sequence[ast.expr], node: ast.expr) -> Value:
        values = [self.expression(each) for each in (left, *others)]
        found = [self.compare(op, a, b, node) for op, a, b in zip(ops, values, values[1:], strict=False)]
        whole = found[0]
        for each in found[1:]:
            whole = Value(TRUTH, (self.new(f"and i1 {whole.parts[0]}, {each.parts[0]}"),))
        return whole

    def _choice(self, test: ast.expr, body: ast.expr, orelse: ast.expr, node: ast.expr) -> Value:
        decided = self.truth(test)
        if decided.known is not None:
            return self.expression(body if decided.known else orelse)
        then, other, after = self.labels("then", "else", "after")
        self.branch(decided, then, other)
        before, ways = self.lines, []
        for label, side in ((then, body), (other, orelse)):
            self.lines = []
            self.start(label)
            value = self.expression(side)
            ways.append((value, self.lines, self.block))
        kind = joined(ways[0][0].kind, ways[1][0].kind)
        if kind is None:
            raise self.fail(node, f"it is {ways[0][0].kind} or {ways[1][0].kind}")
        ends = []
        for value, lines, block in ways:
            self.lines, self.block, self.closed = lines, block, False
            ends.append((self.as_kind(value, kind).parts, block))
            self.jump(after)
            before += self.lines
        self.lines = before
        self.start(after)
        parts = []
        for i, part in enumerate(kind.parts):
            parts.append(self.new(f"phi {part} " + ", ".join(f"[{found[i]}, %{block}]" for found, block in ends)))
        return Value(kind, tuple(parts))

    def _subscript(self, of: Value, index: ast.expr, node: ast.expr) -> Value:
        if of.kind.name in "tc":
            k = self.expression(index).known
            if not isinstance(k, int):
                raise self.fail(node, "a tuple's index must be a number of the text")
            if not -len(of.kind.of) <= k < len(of.kind.of):
                raise self.fail(node, f"an index beyond the {len(of.kind.of)} items of the tuple")
            return self.of_context(of, k) if of.kind.name == "c" else of.items()[k]
        if isinstance(index, ast.Slice):
            return self._slice(of, index, node)
        if self.count_of(index) < of.kind.axes:
            return self._row(of, index, node)
        return self.read(*self.element(of, index, node))

    @staticmethod
    def count_of(index: ast.expr) -> int:
        return len(index.elts) if isinstance(index, ast.Tuple) else 1

    def _row(self, of: Value, index: ast.expr, node: ast.expr) -> Value:
        if isinstance(index, ast.Tuple):
            value = of
            for each in index.elts:
                value = self._row(value, each, node)
            return value
        row = self.from_start(self.whole(self.expression(index), node), Value(INTEGER, (of.parts[1],)), node)
        at, kind = self._row_begins(of, row, node)
        return Value(row_of(kind), (at, *of.parts[2:]))

    def _row_begins(self, of: Value, row: Value, node: ast.expr) -> tuple[str, Kind]:
        """Return the address of a row of an array, and the kind of array that begins there."""
        for size in of.parts[2:]:
            row = self.operation(ast.Mult(), row, Value(INTEGER, (size,)), node)
        return self.moved(of, row)

    def _slice(self, of: Value, index: ast.Slice, node: ast.expr) -> Value:
        if index.step is not None or of.kind.name not in ARRAYS:
            raise self.fail(node, "this slice is not compiled")
        first = constant(0) if index.lower is None else self.whole(self.expression(index.lower), node)
        last = Value(INTEGER, (of.parts[1],))
        last = last if index.upper is None else self.whole(self.expression(index.upper), node)
        count = None
        if self.own:
            first, last, count = self.within(first, last, of.parts[1], node)
        at, kind = self._row_begins(of, first, node)
        if any(end.known is not None and end.known < 0 for end in (first, last)):
            raise self.fail(node, "this slice is not compiled")
        count = count or self.operation(ast.Sub(), last, first, node)
        if count.kind != INTEGER:
            raise self.fail(node, "lanes cannot take parts of different length")
        return Value(kind, (at, count.parts[0], *of.parts[2:]))

    # ---- calls -----------------------------------------------------------------------------------------------------

    def _call(self, node: ast.Call) -> Value:
        if node.keywords:
            raise self.fail(node, "arguments by name are not compiled")
        name = called_name(node.func)
        if name in EMPTY:
            return self._room(node, EMPTY[name])
        values = [self.expression(each) for each in node.args]
        if name in self.library.program.functions:
            return self._kernel(name, values)
        if name in self.library.outside:
            given = ", ".join(f"{value.kind.parts[0]} {value.parts[0]}" for value in values)
            self.add(f"call void inttoptr (i64 {self.library.outside[name]} to ptr)({given})")
            return NONE
        known: Callable[..., Value] | None = self.builtin(name)
        if known is None:
            raise self.fail(node, f"{name} is not compiled")
        if not self.takes(name, len(values)):
            raise self.fail(node, f"{name} of {len(values)} numbers is not compiled")
        return known(values, node)

    def _kernel(self, name: str, values: Sequence[Value]) -> Value:
        symbol, returned = self.library.function(name, tuple(value.kind for value in values))
        given = [f"{part} {one}" for value in values for part, one in zip(value.kind.parts, value.parts, strict=True)]
        call = f"call {returned.returned} @{symbol}({', '.join([*self.beside(), *given])})"
        if returned == NOTHING:
            self.add(call)
            return NONE
        found, parts = self.new(call), range(len(returned.parts))
        if returned.name not in f"{ARRAYS}t":
            value = Value(returned, (found,))
        else:
            value = Value(returned, tuple(self.new(f"extractvalue {returned.returned} {found}, {i}") for i in parts))
        if self.own and self.library.may_fail(name, values):
            self.note_of_call(value)
        return value

    def beside(self) -> list[str]:
        """Return the arguments that every kernel takes before its own."""
        return []

    def _room(self, node: ast.Call, cleared: bool) -> Value:
        """Return an array in the function's stack memory, which ends with the function."""
        if self.own:
            raise self.fail(node, "a kernel of one's own makes no arrays; use numbers, tuples and arrays of the module")
        shape = node.args[0].elts if isinstance(node.args[0], ast.Tuple) else [node.args[0]]
        sizes = [self.whole(self.expression(each), each) for each in shape]
        whole = len(node.args) > 1 and ast.unparse(node.args[1]) == "np.int64"
        total = sizes[0]
        for size in sizes[1:]:
            total = self.operation(ast.Mult(), total, size, node)
        at, kind = self.memory(array(INTEGER if whole else FLOAT, len(sizes)), total, cleared, node)
        return Value(kind, (at, *(size.parts[0] for size in sizes)))

    def memory(self, kind: Kind, total: Value, cleared: bool, node: ast.Call) -> tuple[str, Kind]:
        """Return the address of stack memory for so many numbers, and the kind of array there."""
        part, count = kind.of[0].parts[0], total.parts[0]
        known = count.isdigit()
        at = self.slot(f"{part}, i64 {count}") if known else self.new(f"alloca {part}, i64 {count}, align 16")
        if cleared:
            count = self.new(f"mul nsw i64 {count}, 8")
            self.library.declare("declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)")
            self.add(f"call void @llvm.memset.p0.i64(ptr {at}, i8 0, i64 {count}, i1 false)")
        return at, kind
