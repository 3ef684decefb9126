"""Operations for all lanes at once, as `operations` writes them for one: numbers are vectors, differences are masked.

A whole number that is the same in all lanes (loop indices, places in arrays) stays a scalar. A float never does, except
a literal of the text.
"""

import ast
from collections.abc import Sequence

from screwsim.codegen.expressions import Expressions
from screwsim.codegen.kinds import (
    ADDRESSES,
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
from screwsim.codegen.operations import OF_TWO, OWN, ROUNDED
from screwsim.codegen.program import CannotCompile, constant, float_text

REAL, WHOLE, MASK = FLOATS.parts[0], INTEGERS.parts[0], TRUTHS.parts[0]
NONE_OF_THEM, ALL_OF_THEM = "zeroinitializer", "splat (i1 true)"
VECTORED = ("sqrt", "fabs", "copysign", "floor", "ceil")  # vector instructions of the processor
WRITTEN = {  # kernels of `codegen.lane_math` that replace functions of `math`
    "exp": "exp_of_lanes",
    "expm1": "expm1_of_lanes",
    "log": "log_of_lanes",
    "pow": "power_of_lanes",
}
ANY_POWER = "power_of_any"  # in a text with kernels of a user's own, whose bases may be below zero
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

    def conditions(self) -> Kind:
        return TRUTHS

    def active(self, where: Value) -> str:
        return self.both(self.mask(), self.as_kind(where, TRUTHS).parts[0])

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

    def of_numbers(self, value: Value, node: ast.AST) -> None:
        """Fail for an array, of which lanes that take different ways cannot have different ones."""
        if any(part[0] != "<" for part in laned(value.kind).parts):
            raise self.fail(node, "lanes cannot choose between arrays")

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

    def common(self, what: str, values: Sequence[Value], node: ast.AST) -> Kind:
        found = super().common(what, [Value(OF_ONE.get(value.kind, value.kind), ()) for value in values], node)
        return found if found == INTEGER and all(value.kind in OF_LANES for value in values) else OF_LANES[found]

    def operation(self, op: ast.operator, a: Value, b: Value, node: ast.AST) -> Value:
        found = super().operation(op, a, b, node)
        if isinstance(op, ast.Add) and found.kind == a.kind == INTEGERS and b.known is not None:
            self.sums[found.parts[0]] = a.parts[0], int(b.known)
        return found

    def _divided(self, rest: bool, a: Value, b: Value, kind: Kind, node: ast.AST) -> Value:
        if kind == INTEGERS and b.known is None:  # inactive lanes divide by 1
            y = self.as_whole(b)
            y = self.new(f"select {MASK} {self.mask()}, {WHOLE} {y}, {WHOLE} splat (i64 1)")
            b = Value(kind, (y,))
        elif kind == INTEGERS and not rest and b.known in POWERS_OF_TWO:
            places = POWERS_OF_TWO.index(b.known)
            return Value(kind, (self.new(f"ashr {WHOLE} {self.as_whole(a)}, splat (i64 {places})"),))
        return super()._divided(rest, a, b, kind, node)

    def remainder(self, x: str, y: str) -> str:
        return self.called("fmod", [Value(FLOATS, (x,)), Value(FLOATS, (y,))]).parts[0]

    # ---- functions -------------------------------------------------------------------------------------------------

    def called(self, function: str, values: Sequence[Value]) -> Value:
        given = [self.as_kind(value, FLOATS) for value in values]
        if function in WRITTEN:
            own_power = function == "pow" and self.library.program.has_own
            return self._kernel(ANY_POWER if own_power else WRITTEN[function], given)
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

    def chosen(self, where: Value, one: Value, other: Value) -> Value:
        """Return the first value in the lanes `where`, the second in the others: numbers, or tuples of numbers."""
        if where.kind == TRUTHS:
            one, other = self.laned(one), self.laned(other)
            kind = joined(one.kind, other.kind)
            if kind is None:
                raise CannotCompile(f"lanes cannot choose between {one.kind} and {other.kind}")
            one, other = self.as_kind(one, kind), self.as_kind(other, kind)
        return super().chosen(where, one, other)

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
