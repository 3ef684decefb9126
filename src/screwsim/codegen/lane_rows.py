"""Reads histories of all lanes a row at a time: adjacent numbers are loaded together and transposed into lanes.

Gathering eight numbers for eight lanes takes as long as eight loads of eight numbers each. So, while
`numerics.history.read` interpolates one column after the other, this does eight columns of one lane at once, lane by
lane. Each number results from the same operations in the same order, so that no bit differs.
"""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

from screwsim.codegen.kinds import FLOATS, INTEGERS, LANES, NOTHING, Kind
from screwsim.codegen.lane_operations import MASK, REAL, WHOLE
from screwsim.codegen.program import float_text
from screwsim.numerics.history import NUDGE

if TYPE_CHECKING:
    from screwsim.codegen.library import Library

LOCATE, READ = "history__locate", "history__read"  # names of functions of `numerics.history` in a text
_ONE = Kind("f")
_TIMES = Kind("v", (_ONE,), 1)
KINDS = {
    LOCATE: (FLOATS, FLOATS, _TIMES, INTEGERS, INTEGERS),
    READ: (FLOATS, _TIMES, Kind("v", (_ONE,), 3), INTEGERS, Kind("p", (_ONE,), 1)),
}
PLACES = f"<{LANES} x ptr>"
NONE = f"{WHOLE} zeroinitializer"
LOAD = f"@llvm.masked.load.v{LANES}f64.p0"
STORE = f"@llvm.masked.store.v{LANES}f64.p0"
OF_READ = (
    f"{MASK} %mask, {REAL} %phi, {PLACES} %times, i64 %n_times, "
    f"{PLACES} %dense, i64 %n_dense, i64 %n_rows, i64 %n_columns, {WHOLE} %step, ptr %into, i64 %n"
)
OF_LOCATE = f"{MASK} %mask, {REAL} %phi, {REAL} %middle, {PLACES} %times, i64 %n_times, {WHOLE} %steps, {WHOLE} %hint"
FEW = 2  # number of columns up to which they are read one by one
ROWS = 4  # rows of a step in the history: values at both ends, c3, c4


class Rows:
    """Writes a function for all lanes, with `written` as an emitter has it."""

    returns: Kind | None = NOTHING
    faulty = False

    def __init__(self, library: Library) -> None:
        self.library = library
        self.lines: list[str] = []
        self.numbers = count()

    def written(self, symbol: str) -> str:
        """Return the function's text."""
        raise NotImplementedError

    def new(self, what: str) -> str:
        found = f"%r{next(self.numbers)}"
        self.lines.append(f"  {found} = {what}")
        return found

    def ends(self, step: str) -> tuple[str, str]:
        """Return the times at both ends of each lane's step, which are adjacent in memory."""
        pairs = []
        for lane in range(LANES):
            base = self.new(f"extractelement {PLACES} %times, i64 {lane}")
            at = self.new(f"extractelement {WHOLE} {step}, i64 {lane}")
            place = self.new(f"getelementptr inbounds double, ptr {base}, i64 {at}")
            pairs.append(self.new(f"load <2 x double>, ptr {place}, align 8"))
        size = 2
        while len(pairs) > 1:
            places = ", ".join(f"i32 {k}" for k in range(2 * size))
            joined = []
            for one, other in zip(pairs[::2], pairs[1::2], strict=True):
                both = f"<{size} x double> {one}, <{size} x double> {other}"
                joined.append(self.new(f"shufflevector {both}, <{2 * size} x i32> <{places}>"))
            pairs, size = joined, 2 * size
        whole = f"<{size} x double>"
        found = []
        for end in (0, 1):
            places = ", ".join(f"i32 {2 * lane + end}" for lane in range(LANES))
            found.append(self.new(f"shufflevector {whole} {pairs[0]}, {whole} poison, <{LANES} x i32> <{places}>"))
        return found[0], found[1]

    def any_of(self, mask: str) -> str:
        return self.new(f"icmp ne i{LANES} {self.new(f'bitcast {MASK} {mask} to i{LANES}')}, 0")


class Locator(Rows):
    """Writes `numerics.history.locate`: most lanes find their step where they found it before."""

    returns: Kind | None = INTEGERS

    def written(self, symbol: str) -> str:
        nudge = f"splat (double {float_text(NUDGE)})"
        after, before = self.new(f"fadd {REAL} %phi, {nudge}"), self.new(f"fsub {REAL} %phi, {nudge}")
        ahead = self.new(f"fcmp ogt {REAL} %middle, %phi")
        x = self.new(f"select {MASK} {ahead}, {REAL} {after}, {REAL} {before}")
        beyond = self.new(f"fadd {REAL} {x}, splat (double {float_text(0.5)})")
        last = self.new(f"sub {WHOLE} %steps, splat (i64 1)")
        held = self.new(f"icmp slt {WHOLE} %hint, %steps")
        held = self.new(f"select {MASK} %mask, {MASK} {held}, {MASK} zeroinitializer")
        step = self.new(f"select {MASK} {held}, {WHOLE} %hint, {NONE}")
        first, second = self.ends(step)
        far = self.new(f"fcmp ogt {REAL} {first}, {beyond}")
        step = self.new(f"select {MASK} {far}, {NONE}, {WHOLE} {step}")
        self.lines.append(f"  br i1 {self.any_of(far)}, label %again, label %up")
        self.lines.append("again:")
        others = self.ends(step)
        self.lines.append("  br label %up")
        coming = [("entry", step, first, second), ("again", step, *others)]
        on = f"icmp slt {WHOLE} %i.up, {last}", f"fcmp ole {REAL} %e1.up, {x}"
        self._go("up", "down", coming, on, "add")
        coming = [("up", "%i.up", "%e0.up", "%e1.up")]
        on = f"icmp sgt {WHOLE} %i.down, zeroinitializer", f"fcmp ogt {REAL} %e0.down, {x}"
        self._go("down", "out", coming, on, "sub")
        head = f"define internal {WHOLE} @{symbol}({OF_LOCATE}) nounwind {{\nentry:"
        return "\n".join([head, *self.lines, "out:", f"  ret {WHOLE} %i.down", "}"])

    def _go(
        self, block: str, after: str, coming: list[tuple[str, str, str, str]], on: tuple[str, str], how: str
    ) -> None:
        """Write a loop in which lanes move one step at a time while both conditions hold."""
        at = len(self.lines) + 1
        self.lines.append(f"{block}:")
        one, other = (self.new(each) for each in on)
        both = self.new(f"select {MASK} {one}, {MASK} {other}, {MASK} zeroinitializer")
        both = self.new(f"select {MASK} %mask, {MASK} {both}, {MASK} zeroinitializer")
        more = self.new(f"zext {MASK} {both} to {WHOLE}")
        self.lines.append(f"  br i1 {self.any_of(both)}, label %{block}.on, label %{after}")
        self.lines.append(f"{block}.on:")
        step = self.new(f"{how} {WHOLE} %i.{block}, {more}")
        ends = self.ends(step)
        self.lines.append(f"  br label %{block}")
        coming = [*coming, (f"{block}.on", step, *ends)]
        for name, part, k in ((f"%e1.{block}", REAL, 3), (f"%e0.{block}", REAL, 2), (f"%i.{block}", WHOLE, 1)):
            ways = ", ".join(f"[ {each[k]}, %{each[0]} ]" for each in coming)
            self.lines.insert(at, f"  {name} = phi {part} {ways}")


class RowReader(Rows):
    """Writes `numerics.history.read`: eight columns of a lane at once."""

    def written(self, symbol: str) -> str:
        declare = self.library.declare
        declare(f"declare {REAL} {LOAD}(ptr, i32, {MASK}, {REAL})")
        declare(f"declare void {STORE}({REAL}, ptr, i32, {MASK})")
        step = self.new(f"select {MASK} %mask, {WHOLE} %step, {WHOLE} zeroinitializer")  # step 0 always exists
        theta = self._share(step)
        rest = self.new(f"fsub {REAL} splat (double 1.0), {theta}")
        stride = self.new("mul i64 %n_rows, %n_columns")
        firsts = []
        for lane in range(LANES):
            base = self.new(f"extractelement {PLACES} %dense, i64 {lane}")
            skip = self.new(f"mul i64 {self.new(f'extractelement {WHOLE} {step}, i64 {lane}')}, {stride}")
            firsts.append(self.new(f"getelementptr inbounds double, ptr {base}, i64 {skip}"))
        shares = [(self._in_all(theta, lane), self._in_all(rest, lane)) for lane in range(LANES)]
        self._branch("sgt", "%n", FEW, "columns", "left")
        self.lines += ["columns:", "  %at = phi i64 [ 0, %entry ], [ %next, %columns ]"]
        self._block(firsts, shares)
        self._branch("sgt", self.new("sub i64 %n, %next"), FEW, "columns", "left")
        self.lines += ["left:", "  %done = phi i64 [ 0, %entry ], [ %next, %columns ]"]
        self._branch("slt", "%done", "%n", "one", "out")
        self.lines += ["one:", "  %c = phi i64 [ %done, %left ], [ %c.next, %one ]"]
        self._column(firsts, theta, rest)
        self._branch("slt", "%c.next", "%n", "one", "out")
        head = f"define internal void @{symbol}({OF_READ}) nounwind {{\nentry:"
        return "\n".join([head, *self.lines, "out:", "  ret void", "}"])

    def _branch(self, how: str, one: str, other: int | str, then: str, orelse: str) -> None:
        self.lines.append(f"  br i1 {self.new(f'icmp {how} i64 {one}, {other}')}, label %{then}, label %{orelse}")

    def _share(self, step: str) -> str:
        """Return θ, the fraction of the step."""
        ends = self.ends(step)
        gone, whole = self.new(f"fsub {REAL} %phi, {ends[0]}"), self.new(f"fsub {REAL} {ends[1]}, {ends[0]}")
        return self.new(f"fdiv {REAL} {gone}, {whole}")

    def _in_all(self, vector: str, lane: int) -> str:
        """Return a register with one lane's number in all places."""
        places = ", ".join([f"i32 {lane}"] * LANES)
        return self.new(f"shufflevector {REAL} {vector}, {REAL} poison, <{LANES} x i32> <{places}>")

    def _block(self, firsts: list[str], shares: list[tuple[str, str]]) -> None:
        """Write the code that fills as many columns as there are lanes, from `%at` on."""
        left = self.new("sub i64 %n, %at")
        given = f"insertelement {WHOLE} poison, i64 {left}, i64 0"
        every = self.new(f"shufflevector {WHOLE} {self.new(given)}, {WHOLE} poison, <{LANES} x i32> zeroinitializer")
        columns = self.new(f"icmp slt {WHOLE} <{', '.join(f'i64 {k}' for k in range(LANES))}>, {every}")
        rows = [self._value(first, share, columns) for first, share in zip(firsts, shares, strict=True)]
        for k, row in enumerate(self._turned(rows)):
            there = self.new(f"icmp slt i64 {k}, {left}")
            where = self.new(f"select i1 {there}, {MASK} %mask, {MASK} zeroinitializer")
            self._put(row, self.new(f"add i64 %at, {k}"), where)
        self.lines.append(f"  %next = add i64 %at, {LANES}")

    def _put(self, row: str, column: str, where: str) -> None:
        place = self.new(f"getelementptr {REAL}, ptr %into, i64 {column}")
        self.lines.append(f"  call void {STORE}({REAL} {row}, ptr {place}, i32 8, {MASK} {where})")

    def _column(self, firsts: list[str], theta: str, rest: str) -> None:
        """Write the code that fills the column `%c`, one lane after the other."""
        parts = []
        for row in range(ROWS):
            skip, found = self.new(f"add i64 {self.new(f'mul i64 %n_columns, {row}')}, %c"), "poison"
            for lane, first in enumerate(firsts):
                place = self.new(f"getelementptr inbounds double, ptr {first}, i64 {skip}")
                number = self.new(f"load double, ptr {place}, align 8")
                found = self.new(f"insertelement {REAL} {found}, double {number}, i64 {lane}")
            parts.append(found)
        self._put(self._cubic(parts, theta, rest), "%c", "%mask")
        self.lines.append("  %c.next = add i64 %c, 1")

    def _cubic(self, parts: list[str], theta: str, rest: str) -> str:
        c = self.new(f"fadd {REAL} {parts[2]}, {self.new(f'fmul {REAL} {theta}, {parts[3]}')}")
        inner = self.new(f"fadd {REAL} {parts[1]}, {self.new(f'fmul {REAL} {rest}, {c}')}")
        one, other = self.new(f"fmul {REAL} {parts[0]}, {rest}"), self.new(f"fmul {REAL} {theta}, {inner}")
        return self.new(f"fadd {REAL} {one}, {other}")

    def _value(self, first: str, share: tuple[str, str], columns: str) -> str:
        """Return the values that `history.read` gives for one lane's columns."""
        parts = []
        for row in range(ROWS):
            skip = self.new(f"add i64 {self.new(f'mul i64 %n_columns, {row}')}, %at")
            place = self.new(f"getelementptr inbounds double, ptr {first}, i64 {skip}")
            parts.append(self.new(f"call {REAL} {LOAD}(ptr {place}, i32 8, {MASK} {columns}, {REAL} zeroinitializer)"))
        return self._cubic(parts, *share)

    def _turned(self, rows: list[str]) -> list[str]:
        """Return the transpose of rows, by exchanging halves: blocks of four, of two, of one."""
        size = LANES // 2
        while size:
            turned = list(rows)
            low = [k if not k & size else LANES + k - size for k in range(LANES)]
            high = [k + size if not k & size else LANES + k for k in range(LANES)]
            for k in range(LANES):
                if not k & size:
                    turned[k] = self._shuffled(rows[k], rows[k + size], low)
                    turned[k + size] = self._shuffled(rows[k], rows[k + size], high)
            rows, size = turned, size // 2
        return rows

    def _shuffled(self, one: str, other: str, places: list[int]) -> str:
        which = ", ".join(f"i32 {k}" for k in places)
        return self.new(f"shufflevector {REAL} {one}, {REAL} {other}, <{LANES} x i32> <{which}>")


WRITERS: dict[str, type[Rows]] = {LOCATE: Locator, READ: RowReader}
