"""Functions for points computed side by side: each written like one of `emit`, with a mask of active lanes.

Where lanes take different branches, those that take a branch run while the others wait; a loop runs until none of its
lanes is left. So each lane computes what it would compute alone, operation by operation: no bit of its results depends
on the other lanes. An assignment changes a variable only in the lanes that are active; other lanes keep their values.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import NamedTuple

from screwsim.codegen import lane_math, lane_rows
from screwsim.codegen.emit import Emitter
from screwsim.codegen.kinds import INTEGER, INTEGERS, LANES, OF_LANES, TRUTH, TRUTHS, Kind, Value
from screwsim.codegen.lane_expressions import LaneExpressions
from screwsim.codegen.lane_operations import MASK, NONE_OF_THEM, WHOLE
from screwsim.codegen.library import Library, Writer
from screwsim.codegen.program import Program, read
from screwsim.numerics.kernel import nodes


class _Loop(NamedTuple):
    """Memory of two masks: lanes that continue a loop, and lanes that continue after it (have not returned)."""

    inside: str
    after: str


class LaneEmitter(LaneExpressions, Emitter):
    """Writes one function for all lanes; `split` counts the enclosing branches in which lanes are separated."""

    def __init__(self, library: Library, name: str, arguments: Sequence[Kind]) -> None:
        Emitter.__init__(self, library, name, arguments)
        returns = [each for each in nodes(self.node) if isinstance(each, ast.Return)]
        self.leaves = len(returns) > 1 or (bool(returns) and returns[0] is not self.node.body[-1])
        self.split, self.ended = 0, False

    def _end(self, returned: Kind) -> None:
        self.jump("out")
        self.start("out")
        slots = zip(returned.parts, self.results, strict=True)
        self.give_back(returned, [self.new(f"load {part}, ptr {slot}") for part, slot in slots])

    def _write(self) -> str:
        self.results: list[str] = []
        self.lane_loops: list[_Loop] = []
        self.sums, self.of_table = {}, {}
        self.split, self.ended = 0, False
        return super()._write()

    def _parameters(self) -> str:
        self.slots.append(f"  %m = alloca {MASK}")
        self.add(f"store {MASK} %mask, ptr %m")
        return ", ".join(each for each in (f"{MASK} %mask", super()._parameters()) if each)

    # ---- variables -------------------------------------------------------------------------------------------------

    def store(self, name: str, value: Value, node: ast.AST) -> None:
        """Assign a value to a variable in the active lanes."""
        if self.split and self.own:
            self.of_numbers(value, node)
        super().store(name, self.laned(value) if self.split and self.apart else self.floating(value), node)

    remembers = False  # what is stored depends on the lanes that are active
    apart = True  # whether the stored value may differ between lanes

    def _put(self, part: str, register: str, place: str, masked: bool | None = None) -> None:
        if (self.split > 0 if masked is None else masked) and part[0] == "<":
            before = self.new(f"load {part}, ptr {place}")
            register = self.new(f"select {MASK} {self.mask()}, {part} {register}, {part} {before}")
        self.add(f"store {part} {register}, ptr {place}")

    def masks(self, first: str) -> str:
        """Return memory for a mask."""
        slot = self.slot(MASK)
        self.add(f"store {MASK} {first}, ptr {slot}")
        return slot

    # ---- statements ------------------------------------------------------------------------------------------------

    def body(self, statements: Sequence[ast.stmt]) -> None:
        for each in statements:
            if self.closed or self.ended:
                return
            self.statement(each)

    def inside(self, statements: Sequence[ast.stmt]) -> None:
        super().inside(statements)
        self.ended = False

    def apart_inside(self, statements: Sequence[ast.stmt]) -> None:
        self.split += 1
        self.inside(statements)
        self.split -= 1

    def statement(self, node: ast.stmt) -> None:
        if isinstance(node, ast.Break | ast.Continue):
            gone, loop = self.mask(), self.lane_loops[-1]
            if isinstance(node, ast.Break):
                self._drop(gone, loop.inside)
            self.set_mask(NONE_OF_THEM)
            self.ended = True
        else:
            super().statement(node)

    def _drop(self, gone: str, slot: str) -> None:
        left = self.without(self.new(f"load {MASK}, ptr {slot}"), gone)
        self.add(f"store {MASK} {left}, ptr {slot}")

    def augment(self, node: ast.AugAssign) -> None:
        value = self.operation(node.op, self.expression(node.target), self.expression(node.value), node)
        self.assign(node.target, value)

    def _if(self, test: Value, body: Sequence[ast.stmt], orelse: Sequence[ast.stmt]) -> None:
        if test.known is not None or test.kind == TRUTH:
            super()._if(test, body, orelse)
            return
        leaves = _leaves([*body, *orelse])
        before = self.mask()
        those, others = self.both(before, test.parts[0]), self.without(before, test.parts[0])
        left = self.masks(NONE_OF_THEM) if leaves else ""
        then, other, work, after = self.labels("then", "else", "work", "after")
        self.set_mask(those)
        self.branch(self.any_of(those), then, other)
        self.start(then)
        self.apart_inside(body)
        if leaves:
            self.add(f"store {MASK} {self.mask()}, ptr {left}")
        self.jump(other)
        self.start(other)
        self.set_mask(others)
        if orelse:
            self.branch(self.any_of(others), work, after)
            self.start(work)
            self.apart_inside(orelse)
            self.jump(after)
            self.start(after)
        if leaves:
            before = self.new(f"or {MASK} {self.mask()}, {self.new(f'load {MASK}, ptr {left}')}")
        self.set_mask(before)

    def _begin_loop(self) -> _Loop:
        now = self.mask()
        loop = _Loop(self.masks(now), self.masks(now))
        self.lane_loops.append(loop)
        return loop

    def _end_loop(self, loop: _Loop) -> None:
        self.lane_loops.pop()
        self.set_mask(self.new(f"load {MASK}, ptr {loop.after}"))

    def _go_on(self, loop: _Loop) -> str:
        """Activate the lanes that have not left a loop; return their mask."""
        now = self.new(f"load {MASK}, ptr {loop.inside}")
        self.set_mask(now)
        return now

    def _repeat(self, test: Callable[[], str], body: Callable[[], None]) -> None:
        """Write a loop that runs while any of its lanes is left; `test` writes which go on."""
        loop = self._begin_loop()
        head, inside, after = self.labels("head", "inside", "after")
        self.jump(head)
        self.start(head)
        going = self.both(self._go_on(loop), test())
        self.add(f"store {MASK} {going}, ptr {loop.inside}")
        self.set_mask(going)
        self.branch(self.any_of(going), inside, after)
        self.start(inside)
        self.split += 1
        body()
        self.split -= 1
        self.jump(head)
        self.start(after)
        self._end_loop(loop)

    def _while(self, test: ast.expr, body: Sequence[ast.stmt]) -> None:
        self._repeat(lambda: self.as_kind(self.truth(test), TRUTHS).parts[0], lambda: self.inside(body))

    def _for(self, name: str, bounds: Sequence[ast.expr], node: ast.For) -> None:
        found = self._bounds(bounds, node)
        if INTEGERS in (found[0].kind, found[1].kind):
            self._count_apart(name, found, node)
        elif _leaves(node.body):
            loop = self._begin_loop()
            self.split += 1
            self._count(name, found, node, lambda: self.any_of(self._go_on(loop)))
            self.split -= 1
            self._end_loop(loop)
        else:
            self._count(name, found, node)

    def store_counter(self, name: str, value: Value, node: ast.For) -> None:
        self.apart = name in self.outliving  # lanes leave the loop with different numbers
        super().store_counter(name, value, node)
        self.apart = True

    def _count_apart(self, name: str, bounds: tuple[Value, Value, int], node: ast.For) -> None:
        """Write a loop whose number of iterations differs between lanes."""
        first, last, step = bounds
        counter, last_one = self.slot(WHOLE), self.as_whole(last)
        self.add(f"store {WHOLE} {self.as_whole(first)}, ptr {counter}")

        def more() -> str:
            now = self.new(f"load {WHOLE}, ptr {counter}")
            return self.new(f"icmp {'slt' if step > 0 else 'sgt'} {WHOLE} {now}, {last_one}")

        def turn() -> None:
            now = self.new(f"load {WHOLE}, ptr {counter}")
            self.store_counter(name, Value(INTEGERS, (now,)), node)
            self.inside(node.body)
            self.add(f"store {WHOLE} {self.new(f'add {WHOLE} {now}, splat (i64 {step})')}, ptr {counter}")

        self._repeat(more, turn)

    def _for_each(self, target: ast.expr, elements: Sequence[ast.expr], node: ast.For) -> None:
        leaves = _leaves(node.body)
        loop, values = self._begin_loop() if leaves else None, self._elements(elements, node)
        for _ in elements:
            self.depth += 1
            self.split += leaves
            self.assign(target, next(values))
            self.inside(node.body)
            self.split -= leaves
            self.depth -= 1
            if loop is not None:
                self._go_on(loop)
        if loop is not None:
            self._end_loop(loop)

    def _return(self, value: Value, node: ast.Return) -> None:
        value = self.laned(value) if self.split else self.floating(value)
        value = self._returned(value, node)
        if self.leaves:
            self.of_numbers(value, node)
        if not self.results or self.again:
            self.results = [self.slot(part) for part in value.kind.parts]
        for part, register, slot in zip(value.kind.parts, value.parts, self.results, strict=True):
            self._put(part, register, slot, self.leaves)
        if not self.split:
            self.jump("out")
            return
        gone = self.mask()
        for loop in self.lane_loops:
            self._drop(gone, loop.inside)
            self._drop(gone, loop.after)
        self.set_mask(NONE_OF_THEM)
        self.ended = True

    # ---- calls -----------------------------------------------------------------------------------------------------

    def _kernel(self, name: str, values: Sequence[Value]) -> Value:
        return super()._kernel(name, [self.floating(value) for value in values])

    def beside(self) -> list[str]:
        return [f"{MASK} {self.mask()}"]

    def memory(self, kind: Kind, total: Value, cleared: bool, node: ast.Call) -> tuple[str, Kind]:
        """Return the address of stack memory for so many numbers of all lanes, and the kind of array there."""
        if total.kind != INTEGER or cleared:
            raise self.fail(node, "lanes have arrays of one size, and fill them themselves")
        part, count = OF_LANES[kind.of[0]].parts[0], total.parts[0]
        known = total.known is not None
        at = self.slot(f"{part}, i64 {count}") if known else self.new(f"alloca {part}, i64 {count}, align 64")
        return at, Kind("p", kind.of, kind.axes)


def _leaves(statements: Sequence[ast.stmt]) -> bool:
    """Tell whether lanes may leave the block that surrounds statements."""
    return any(isinstance(each, ast.Return | ast.Break | ast.Continue) for each in nodes(*statements))


class LaneLibrary(Library):
    """A library whose functions compute all lanes at once; what differs between lanes takes one word for each."""

    lanes, aligned = LANES, ", align 8"

    def __init__(self, program: Program) -> None:
        written = read(lane_math.texts())
        functions = written.functions.and_those_of(program.functions)
        super().__init__(Program(functions, written.constants | program.constants))

    def emitter(self, name: str, kinds: tuple[Kind, ...]) -> Writer:
        if lane_rows.KINDS.get(name) == kinds:
            return lane_rows.WRITERS[name](self)
        return LaneEmitter(self, name, kinds)

    def beside(self) -> tuple[list[str], list[str]]:
        """Return what `Library.beside` does: the first word has one bit for each active lane."""
        bits, mask = f"  %bits = load i{LANES}, ptr %in", f"  %mask = bitcast i{LANES} %bits to {MASK}"
        return [bits, mask], [f"{MASK} %mask"]
