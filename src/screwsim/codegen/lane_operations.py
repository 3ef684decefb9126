"""Operations for all lanes at once, as `operations` writes them for one: numbers are vectors, differences are masked.

A whole number that is the same in all lanes (loop indices, places in arrays) stays a scalar. A float never does, except
a literal of the text.
"""

import ast
from collections.abc import Callable, Sequence

from screwsim.codegen.expressions import Expressions
from screwsim.codegen.kinds import (
    ADDRESSES,
    FLOAT,
    FLOATS,
    INTEGER,
    INTEGERS,
    LANES,
    OF_LANES,
    OF_ONE,
    TRUTH,
    TRUTHS,
    Kind,
    Value,
    floating,
    joined,
    laned,
)
from screwsim.codegen.operations import BY_FLOATS, BY_INTEGERS, COMPARED, LARGEST_POWER, OF_TWO, OWN, ROUNDED
from screwsim.codegen.program import constant, float_text

REAL, WHOLE, MASK = FLOATS.parts[0], INTEGERS.parts[0], TRUTHS.parts[0]
NONE_OF_THEM, ALL_OF_THEM = "zeroinitializer", "splat (i1 true)"
VECTORED = ("sqrt", "fabs", "copysign", "floor", "ceil")  # vector instructions of the processor
WRITTEN = {  # kernels of `codegen.lane_math` that replace functions of `math`
    "exp": "exp_of_lanes",
    "expm1": "expm1_of_lanes",
    "log": "log_of_lanes",
    "pow": "power_of_lanes",
}
EACH = tuple(range(LANES))
POWERS_OF_TWO = tuple(1 << n for n in range(63))


class LaneOperations(Expressions):
    """Operators and functions for numbers of all lanes; `mask` shows which lanes are active."""

    sums: dict[str, tuple[str, int]]  # registers that are another register plus a literal
    of_table: dict[str, tuple[str, str, int]]  # addresses of items of a constant table: its name, index, and offset

    def mask(self) -> str:
        """Return the mask of active lanes."""
        return self.new(f"load {MASK}, ptr %m")

    def both(self, one: str, other: str) -> str:
        """Return where both hold; the second may be anything where the first does not hold."""
        return self.new(f"select {MASK} {one}, {MASK} {other}, {MASK} {NONE_OF_THEM}")

    def without(self, one: str, other: str) -> str:
        """Return where the first holds and the second does not."""
        return self.both(one, self.new(f"xor {MASK} {other}, {ALL_OF_THEM}"))

    def any_of(self, mask: str) -> Value:
        """Return whether any lane is active."""
        return Value(TRUTH, (self.new(f"icmp ne i{LANES} {self.new(f'bitcast {MASK} {mask} to i{LANES}')}, 0"),))

    # ---- kinds -----------------------------------------------------------------------------------------------------

    def splat(self, part: str, register: str) -> str:
        """Return one register's value in all lanes."""
        if register[0] not in "%":
            return f"splat ({part} {register})"
        one = self.new(f"insertelement <{LANES} x {part}> poison, {part} {register}, i64 0")
        nought = f"<{LANES} x i32> zeroinitializer"
        return self.new(f"shufflevector <{LANES} x {part}> {one}, <{LANES} x {part}> poison, {nought}")

    def laned(self, value: Value) -> Value:
        """Return a value in which every number is a vector of all lanes."""
        return self.as_kind(value, laned(value.kind))

    def floating(self, value: Value) -> Value:
        """Return a value in which every float is a vector of all lanes."""
        return self.as_kind(value, floating(value.kind))

    def as_kind(self, value: Value, kind: Kind) -> Value:
        if value.kind == kind or kind.name not in "FIB":
            return super().as_kind(value, kind)
        if value.kind in OF_LANES:
            one = super().as_kind(value, OF_ONE[kind])
            return Value(kind, (self.splat(one.kind.parts[0], one.parts[0]),))
        given, register = value.kind.parts[0], value.parts[0]
        if kind == INTEGERS and value.kind == FLOATS:
            kept = self.new(f"select {MASK} {self.mask()}, {REAL} {register}, {REAL} zeroinitializer")
            return Value(kind, (self.new(f"fptosi {REAL} {kept} to {WHOLE}"),))
        how = "zext" if kind == INTEGERS else ("uitofp" if value.kind == TRUTHS else "sitofp")
        return Value(kind, (self.new(f"{how} {given} {register} to {kind.parts[0]}"),))

    def as_float(self, value: Value) -> str:
        return self.as_kind(value, FLOATS).parts[0]

    def as_whole(self, value: Value) -> str:
        return self.as_kind(value, INTEGERS).parts[0]

    def whole(self, value: Value, node: ast.AST) -> Value:
        if value.kind in (INTEGERS, TRUTHS):
            return self.as_kind(value, INTEGERS)
        return super().whole(value, node)

    # ---- operators -------------------------------------------------------------------------------------------------

    def operation(self, op: ast.operator, a: Value, b: Value, node: ast.AST) -> Value:
        if isinstance(op, ast.Pow):
            if b.kind == INTEGER and isinstance(b.known, int) and abs(b.known) <= LARGEST_POWER:
                return self._multiplied(self.floating(a), b.known)
            return self.called("pow", [a, b])
        for value in (a, b):
            if value.kind not in OF_LANES and value.kind not in OF_ONE:
                raise self.fail(node, f"{type(op).__name__} of {a.kind} and {b.kind} is not compiled")
        if _whole(a) and _whole(b) and not isinstance(op, ast.Div):
            if a.kind in OF_LANES and b.kind in OF_LANES:
                return super().operation(op, a, b, node)
            return self._by_wholes(op, self.as_whole(a), b, node)
        if isinstance(op, ast.Mod):
            return self._rest(self.as_float(a), self.as_float(b))
        if type(op) not in BY_FLOATS:
            if isinstance(op, ast.FloorDiv):
                raise self.fail(node, "// of floats is not compiled; use math.floor")
            raise self.fail(node, f"{type(op).__name__} is not compiled")
        return Value(FLOATS, (self.new(f"{BY_FLOATS[type(op)]} {REAL} {self.as_float(a)}, {self.as_float(b)}"),))

    def _by_wholes(self, op: ast.operator, x: str, b: Value, node: ast.AST) -> Value:
        if type(op) in BY_INTEGERS:
            how = BY_INTEGERS[type(op)].partition(" ")[0]
            found = self.new(f"{how} {WHOLE} {x}, {self.as_whole(b)}")
            if isinstance(op, ast.Add) and b.known is not None:
                self.sums[found] = x, int(b.known)
            return Value(INTEGERS, (found,))
        if not isinstance(op, ast.FloorDiv | ast.Mod):
            raise self.fail(node, f"{type(op).__name__} is not compiled")
        if isinstance(op, ast.FloorDiv) and b.known in POWERS_OF_TWO:
            return Value(INTEGERS, (self.new(f"ashr {WHOLE} {x}, splat (i64 {POWERS_OF_TWO.index(b.known)})"),))
        y = self.as_whole(b)
        if b.known is None:  # inactive lanes divide by 1
            y = self.new(f"select {MASK} {self.mask()}, {WHOLE} {y}, {WHOLE} splat (i64 1)")
        left = self.new(f"srem {WHOLE} {x}, {y}")
        apart = self.new(f"icmp slt {WHOLE} {self.new(f'xor {WHOLE} {left}, {y}')}, zeroinitializer")
        other = self.new(f"and {MASK} {apart}, {self.new(f'icmp ne {WHOLE} {left}, zeroinitializer')}")
        if isinstance(op, ast.Mod):
            more = self.new(f"add {WHOLE} {left}, {y}")
            return Value(INTEGERS, (self.new(f"select {MASK} {other}, {WHOLE} {more}, {WHOLE} {left}"),))
        quotient, less = self.new(f"sdiv {WHOLE} {x}, {y}"), self.new(f"zext {MASK} {other} to {WHOLE}")
        return Value(INTEGERS, (self.new(f"sub {WHOLE} {quotient}, {less}"),))

    def _rest(self, x: str, y: str) -> Value:
        """Return the remainder of a division as Python defines it: with the quotient rounded down."""
        left = self.called("fmod", [Value(FLOATS, (x,)), Value(FLOATS, (y,))]).parts[0]
        other = self.new(f"fcmp olt {REAL} {self.new(f'fmul {REAL} {left}, {y}')}, zeroinitializer")
        more = self.new(f"fadd {REAL} {left}, {y}")
        return Value(FLOATS, (self.new(f"select {MASK} {other}, {REAL} {more}, {REAL} {left}"),))

    def signed(self, op: ast.unaryop, value: Value, node: ast.AST) -> Value:
        if value.kind not in OF_ONE or isinstance(op, ast.UAdd):
            return super().signed(op, value, node)
        if value.kind == FLOATS:
            return Value(FLOATS, (self.new(f"fneg {REAL} {value.parts[0]}"),))
        return Value(INTEGERS, (self.new(f"sub {WHOLE} zeroinitializer, {self.as_whole(value)}"),))

    def negated(self, value: Value) -> Value:
        if value.kind != TRUTHS:
            return super().negated(value)
        return Value(TRUTHS, (self.new(f"xor {MASK} {value.parts[0]}, {ALL_OF_THEM}"),))

    def compare(self, op: ast.cmpop, a: Value, b: Value, node: ast.AST) -> Value:
        known = a.known is not None and b.known is not None
        if known or (_whole(a) and _whole(b) and a.kind in OF_LANES and b.kind in OF_LANES):
            return super().compare(op, a, b, node)
        if type(op) not in COMPARED:
            raise self.fail(node, f"{type(op).__name__} is not compiled")
        whole, floating, _ = COMPARED[type(op)]
        if _whole(a) and _whole(b):
            return Value(TRUTHS, (self.new(f"icmp {whole} {WHOLE} {self.as_whole(a)}, {self.as_whole(b)}"),))
        return Value(TRUTHS, (self.new(f"fcmp {floating} {REAL} {self.as_float(a)}, {self.as_float(b)}"),))

    # ---- functions -------------------------------------------------------------------------------------------------

    def builtin(self, name: str) -> Callable[[Sequence[Value], ast.Call], Value] | None:
        plain = {"bits_of": (FLOATS, INTEGERS), "of_bits": (INTEGERS, FLOATS)}  # used only in `codegen.lane_math`
        if name in plain:
            given, found = plain[name]
            return lambda values, node: Value(found, (self._as_bits(values[0], given, found),))
        return super().builtin(name)

    def _as_bits(self, value: Value, given: Kind, found: Kind) -> str:
        return self.new(f"bitcast {given.parts[0]} {self.as_kind(value, given).parts[0]} to {found.parts[0]}")

    def called(self, function: str, values: Sequence[Value]) -> Value:
        given = [self.as_kind(value, FLOATS) for value in values]
        if function in WRITTEN:
            return self._kernel(WRITTEN[function], given)
        name = OWN.get(function) or ROUNDED.get(function) or function
        if function in VECTORED:
            name = name.replace(".f64", f".v{LANES}f64")
            self.library.declare(f"declare {REAL} @{name}({', '.join([REAL] * len(given))}) nounwind")
            return Value(
                FLOATS, (self.new(f"call {REAL} @{name}({', '.join(f'{REAL} {each.parts[0]}' for each in given)})"),)
            )
        return self._one_by_one(name, given, 2 if function in OF_TWO else 1)

    def _one_by_one(self, name: str, given: Sequence[Value], count: int) -> Value:
        """Return a function's values, computed lane by lane; inactive lanes compute that of 1."""
        self.library.declare(
            f"declare double @{name}({', '.join(['double'] * count)}) nounwind willreturn memory(none)"
        )
        mask, found = self.mask(), "poison"
        kept = [
            self.new(f"select {MASK} {mask}, {REAL} {each.parts[0]}, {REAL} splat (double {float_text(1.0)})")
            for each in given
        ]
        for lane in EACH:
            ones = [self.new(f"extractelement {REAL} {each}, i64 {lane}") for each in kept]
            one = self.new(f"call double @{name}({', '.join(f'double {each}' for each in ones)})")
            found = self.new(f"insertelement {REAL} {found}, double {one}, i64 {lane}")
        return Value(FLOATS, (found,))

    def _abs(self, values: Sequence[Value], node: ast.Call) -> Value:
        if values[0].kind in (FLOAT, FLOATS):
            return self.called("fabs", values)
        if values[0].kind in OF_LANES:
            return super()._abs(values, node)
        below = self.compare(ast.Lt(), values[0], constant(0), node)
        return self.chosen(below.parts[0], self.signed(ast.USub(), values[0], node), values[0])

    def _extreme(self, values: Sequence[Value], node: ast.Call) -> Value:
        if all(value.kind in (INTEGER, TRUTH) for value in values) or all(value.known is not None for value in values):
            return super()._extreme(values, node)
        op: ast.cmpop = ast.Gt() if ast.unparse(node.func) == "max" else ast.Lt()
        best = self.laned(values[0])
        for value in values[1:]:
            other = self.laned(value)
            better = self.compare(op, other, best, node)
            best = self.chosen(better.parts[0], other, best)
        return best

    def chosen(self, where: str, one: Value, other: Value) -> Value:
        """Return the first value in the lanes `where`, the second in the others: numbers, or tuples of numbers."""
        one, other = self.laned(one), self.laned(other)
        kind = joined(one.kind, other.kind)
        if kind is None:
            raise TypeError(f"it is {one.kind} or {other.kind}")
        one, other = self.as_kind(one, kind), self.as_kind(other, kind)
        parts = zip(kind.parts, one.parts, other.parts, strict=True)
        return Value(kind, tuple(self.new(f"select {MASK} {where}, {part} {a}, {part} {b}") for part, a, b in parts))

    def _int(self, values: Sequence[Value], node: ast.Call) -> Value:
        if values[0].kind in (FLOAT, FLOATS):
            return self.as_kind(self.laned(values[0]), INTEGERS)
        return self.whole(values[0], node)

    def _float(self, values: Sequence[Value], node: ast.Call) -> Value:
        return self.as_kind(values[0], FLOATS)

    # ---- elements --------------------------------------------------------------------------------------------------

    def moved(self, of: Value, at: Value) -> tuple[str, Kind]:
        """Return the address a number of elements further on: one address, or (`v`) one for each lane."""
        one, name = of.kind.of[0].parts[0], of.kind.name
        uniform = at.kind in OF_LANES
        where = f"i64 {self.as_kind(at, INTEGER).parts[0]}" if uniform else f"{WHOLE} {self.as_whole(at)}"
        base = f"ptr {of.parts[0]}" if name in "ap" else f"{ADDRESSES} {of.parts[0]}"
        if name == "p" and uniform:
            return self.new(f"getelementptr inbounds <{LANES} x {one}>, {base}, {where}"), of.kind
        if name == "a" and uniform:
            return self.new(f"getelementptr inbounds {one}, {base}, {where}"), of.kind
        if name in "pw":  # elements of one lane are LANES numbers apart
            count = self.operation(ast.Mult(), at, constant(LANES), ast.Pass())
            where = f"{count.kind.parts[0]} {count.parts[0]}"
        if name == "p":
            lanes = ", ".join(f"i64 {lane}" for lane in EACH)
            base = f"{ADDRESSES} {self.new(f'getelementptr inbounds {one}, {base}, <{LANES} x i64> <{lanes}>')}"
        found = self.new(f"getelementptr inbounds {one}, {base}, {where}")
        if of.parts[0][0] == "@" and of.kind.axes == 1:
            register, more = self.sums.get(self.as_whole(at), (self.as_whole(at), 0))
            if abs(more) < int(of.parts[1]):
                self.of_table[found] = of.parts[0], register, more
        return found, Kind({"a": "v", "v": "v", "p": "w", "w": "w"}[name], of.kind.of, of.kind.axes)

    def read(self, place: str, kind: Kind) -> Value:
        """Return the value at an address; undefined in inactive lanes."""
        of = kind.of[0]
        if kind.name == "a":
            return self.floating(Value(of, (self.new(f"load {of.parts[0]}, ptr {place}"),)))
        many = OF_LANES[of]
        part = many.parts[0]
        if kind.name == "p":
            return Value(many, (self.new(f"load {part}, ptr {place}, align 8"),))
        if place in self.of_table:
            return Value(many, (self._looked_up(of.parts[0], *self.of_table[place]),))
        name = f"llvm.masked.gather.v{LANES}{of.name}64.v{LANES}p0"
        self.library.declare(f"declare {part} @{name}({ADDRESSES}, i32, {MASK}, {part})")
        given = f"{ADDRESSES} {place}, i32 8, {MASK} {self.mask()}, {part} zeroinitializer"
        return Value(many, (self.new(f"call {part} @{name}({given})"),))

    def _looked_up(self, one: str, table: str, at: str, more: int) -> str:
        """Return numbers of a constant table, loaded one for each lane, which is faster than a gather.

        For indices that differ only by a literal the lanes are extracted once.
        """
        held = self.new(f"select {MASK} {self.mask()}, {WHOLE} {at}, {WHOLE} splat (i64 {max(0, -more)})")
        found = "poison"
        for lane in EACH:
            first = self.new(f"extractelement {WHOLE} {held}, i64 {lane}")
            place = self.new(f"getelementptr {one}, ptr {table}, i64 {first}")
            place = self.new(f"getelementptr {one}, ptr {place}, i64 {more}")
            number = self.new(f"load {one}, ptr {place}, align 8, !invariant.load !0")
            found = self.new(f"insertelement <{LANES} x {one}> {found}, {one} {number}, i64 {lane}")
        return found

    def write(self, place: str, kind: Kind, value: Value) -> None:
        """Store a value in the active lanes."""
        many = OF_LANES[kind.of[0]]
        part, register, mask = many.parts[0], self.as_kind(value, many).parts[0], self.mask()
        if kind.name == "p":
            before = self.new(f"load {part}, ptr {place}, align 8")
            after = self.new(f"select {MASK} {mask}, {part} {register}, {part} {before}")
            self.add(f"store {part} {after}, ptr {place}, align 8")
            return
        name = f"llvm.masked.scatter.v{LANES}{kind.of[0].name}64.v{LANES}p0"
        self.library.declare(f"declare void @{name}({part}, {ADDRESSES}, i32, {MASK})")
        self.add(f"call void @{name}({part} {register}, {ADDRESSES} {place}, i32 8, {MASK} {mask})")


def _whole(value: Value) -> bool:
    return value.kind in (INTEGER, TRUTH, INTEGERS, TRUTHS)
