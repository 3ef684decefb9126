"""Writes one function of a text, for given kinds of arguments, in LLVM IR.

Variables are kept in the function's stack memory; LLVM moves them into registers. A variable that is an integer in one
place and a float in another is a float: the function is written again until no kind widens.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from screwsim.codegen.expressions import NONE, Expressions
from screwsim.codegen.kinds import ARRAYS, FLOAT, INTEGER, NOTHING, TRUTH, Kind, Value, joined
from screwsim.codegen.program import CannotCompile, constant
from screwsim.numerics.kernel import nodes

if TYPE_CHECKING:
    from screwsim.codegen.library import Library


LONG = 1000  # number of lines beyond which a function is never inlined
MOST_PASSES = 3  # number of passes after which an unknown variable counts as never assigned


def leaves(statements: Sequence[ast.stmt]) -> bool:
    """Tell whether these statements always end in a return."""
    for each in statements:
        match each:
            case ast.Return():
                return True
            case ast.If(body=body, orelse=orelse) if leaves(body) and leaves(orelse):
                return True
            case ast.While(test=ast.Constant(value=True), body=body) if not _breaks(body):
                return True
    return False


def _breaks(statements: Sequence[ast.stmt]) -> bool:
    """Tell whether a break among these statements leaves the loop around them."""
    branches = [each for each in statements if isinstance(each, ast.If)]
    inner = any(_breaks([*each.body, *each.orelse]) for each in branches)
    return inner or any(isinstance(each, ast.Break) for each in statements)


class Emitter(Expressions):
    """Writes one function; `kinds` are those of its variables, as far as known."""

    remembers = True  # whether a variable that was set or read in a block is not read from memory again in it

    def __init__(self, library: Library, name: str, arguments: Sequence[Kind]) -> None:
        self.library, self.node, self.given = library, library.program.functions[name], tuple(arguments)
        self.kinds: dict[str, Kind] = {}
        self.wide: dict[str, Kind] = {}  # narrowest kind that a variable needs
        self.returns: Kind | None = None
        names = [each.arg for each in self.node.args.args]
        if len(names) != len(self.given):
            raise self.fail(self.node, f"{name} takes {len(names)} arguments, not {len(self.given)}")
        self.names = names
        self.own = name.startswith("user_")
        self.assigned = library.program.assigned_in(name)
        self.outliving = library.program.outliving_in(name)

    def fail(self, node: ast.AST, what: str) -> CannotCompile:
        line = ast.unparse(node).splitlines()[0]
        return CannotCompile(f"{self.node.name}: {what}, in {line[:90]!r}")

    def written(self, symbol: str) -> str:
        """Return the function's text."""
        self.passes = 1
        parameters = self._write()
        while self.again:
            self.passes += 1
            parameters = self._write()
        returned = self.returns or NOTHING
        if returned != NOTHING and not leaves(self.node.body):
            raise self.fail(self.node, "it may end without a return")
        self._end(returned)
        if returned.definition:
            self.library.declare(returned.definition)
        apart = " noinline" if len(self.lines) > LONG else ""  # compiled once, not in each of its callers
        head = f"define internal {returned.returned} @{symbol}({parameters}) nounwind{apart} {{\nentry:"
        return "\n".join([head, *self.slots, "  br label %start", "start:", *self.lines, "}"])

    def _end(self, returned: Kind) -> None:
        """Write the code after the last statement."""
        if not self.closed:
            self.add("ret void" if returned == NOTHING else f"ret {returned.returned} zeroinitializer")

    def _write(self) -> str:
        self.lines: list[str] = []
        self.slots: list[str] = []
        self.places: dict[str, tuple[str, ...]] = {}
        self.recent: dict[str, Value] = {}  # variables whose registers are known within the block
        self.count = 0
        self.block, self.closed = "start", False
        self.loops: list[tuple[str, str]] = []
        self.again, self.depth = False, 0
        self.last, self.kinds = self.kinds, {}
        self.begin_guards()
        parameters = self._parameters()
        self.body(self.node.body)
        return parameters

    def _parameters(self) -> str:
        found = []
        for k, (name, kind) in enumerate(zip(self.names, self.given, strict=True)):
            parts = [f"%a{k}.{i}" for i in range(len(kind.parts))]
            found += [f"{part} {one}" for part, one in zip(kind.parts, parts, strict=True)]
            self.store(name, Value(kind, tuple(parts)), self.node)
        return ", ".join(found)

    # ---- variables -------------------------------------------------------------------------------------------------

    def store(self, name: str, value: Value, node: ast.AST) -> None:
        """Assign a value to a variable."""
        if value.kind == NOTHING:
            raise self.fail(node, f"{name} is given nothing")
        known = self.kinds.get(name) if self.depth else None  # outside branches the kind may change
        known = known or self.wide.get(name)
        kind = joined(known or value.kind, value.kind)
        if kind is None:
            raise self.fail(node, f"{name} is {known} here and {value.kind} there")
        if kind != self.kinds.get(name):
            if self.depth and name in self.kinds:
                self.wide[name], self.again = kind, True
            self.kinds[name] = kind
            self.places.pop(name, None)
        value = self.as_kind(value, kind)
        for part, register, place in zip(kind.parts, value.parts, self._place(name), strict=True):
            self._put(part, register, place)
        if self.remembers:
            self.recent[name] = Value(kind, value.parts)

    def _put(self, part: str, register: str, place: str) -> None:
        self.add(f"store {part} {register}, ptr {place}")

    def start(self, label: str) -> None:
        super().start(label)
        self.recent.clear()

    def _place(self, name: str) -> tuple[str, ...]:
        if name not in self.places:
            self.places[name] = tuple(self.slot(part) for part in self.kinds[name].parts)
        return self.places[name]

    def slot(self, part: str) -> str:
        """Return stack memory for one register."""
        place = f"%s{len(self.slots)}"
        self.slots.append(f"  {place} = alloca {part}")
        return place

    def load(self, name: str, node: ast.AST) -> Value:
        """Return the value of a variable or a constant."""
        if name in self.recent:
            return self.recent[name]
        if name in self.kinds or name in self.last:
            kind = self.kinds.setdefault(name, self.last.get(name, FLOAT))
            parts = zip(kind.parts, self._place(name), strict=True)
            found = Value(kind, tuple([self.new(f"load {part}, ptr {place}") for part, place in parts]))
            if self.remembers:
                self.recent[name] = found
            return found
        if name in self.assigned and self.passes <= MOST_PASSES:  # read in a loop before its assignment is written
            self.again = True
            return constant(0.0)
        found = self.library.constant(name)
        if found is None or name in self.assigned:
            raise self.fail(node, f"{name} is not known")
        return found

    # ---- statements ------------------------------------------------------------------------------------------------

    def body(self, statements: Sequence[ast.stmt]) -> None:
        for each in statements:
            if self.closed:
                return  # the rest is never reached
            self.statement(each)

    def inside(self, statements: Sequence[ast.stmt]) -> None:
        """Write statements that may run never, once or repeatedly."""
        self.depth += 1
        self.body(statements)
        self.depth -= 1

    def statement(self, node: ast.stmt) -> None:
        match node:
            case ast.Assign(targets=targets, value=value):
                found = self.expression(value)
                for target in targets:
                    self.assign(target, found)
            case ast.AugAssign():
                self.augment(node)
            case ast.Expr(value=ast.Constant()) | ast.Pass():
                pass
            case ast.Expr(value=value):
                self.expression(value)
            case ast.If(test=test, body=body, orelse=orelse):
                self._if(self.truth(test), body, orelse)
            case ast.For(target=ast.Name(id=name), iter=ast.Call(func=ast.Name(id="range"), args=bounds), orelse=[]):
                self._for(name, bounds, node)
            case ast.For(target=target, iter=ast.Tuple(elts=elements), orelse=[]):
                self._for_each(target, elements, node)
            case ast.While(test=test, body=body, orelse=[]):
                self._while(test, body)
            case ast.Return(value=value):
                self._return(NONE if value is None else self.expression(value), node)
            case ast.Break() | ast.Continue():
                self.jump(self.loops[-1][isinstance(node, ast.Continue)])
            case ast.For(orelse=[_, *_]) | ast.While(orelse=[_, *_]):
                raise self.fail(node, "`else` of a loop is not compiled; test behind the loop whether it was left")
            case _:
                raise self.fail(node, "this is not compiled")

    def assign(self, target: ast.expr, value: Value) -> None:
        match target:
            case ast.Name(id=name):
                self.store(name, value, target)
            case ast.Tuple(elts=targets):
                if value.kind.name not in "tc" or len(value.kind.of) != len(targets):
                    raise self.fail(target, f"{len(targets)} names are given {value.kind}")
                items = self.items(value)
                for one, item in zip(targets, items, strict=True):
                    self.assign(one, item)
            case ast.Subscript(value=of, slice=index):
                place, kind = self.stored(of, index, target)
                self.write(place, kind, value)
            case _:
                raise self.fail(target, "this cannot be given a value")

    def stored(self, of: ast.expr, index: ast.expr, target: ast.expr) -> tuple[str, Kind]:
        """Return what `element` does of an element that is given a value."""
        if self.own:
            raise self.fail(target, "a kernel of one's own changes no arrays; use numbers and tuples")
        return self.element(self.expression(of), index, target)

    def augment(self, node: ast.AugAssign) -> None:
        """Write `+=` and the like; the address of an element is computed once."""
        target = node.target
        if not isinstance(target, ast.Subscript):
            self.assign(target, self.operation(node.op, self.expression(target), self.expression(node.value), node))
            return
        place, kind = self.stored(target.value, target.slice, target)
        before = self.read(place, kind)
        self.write(place, kind, self.operation(node.op, before, self.expression(node.value), node))

    def _if(self, test: Value, body: Sequence[ast.stmt], orelse: Sequence[ast.stmt]) -> None:
        if test.known is not None:
            self.body(body if test.known else orelse)
            return
        then, other, after = self.labels("then", "else", "after")
        self.branch(test, then, other if orelse else after)
        self.start(then)
        self.inside(body)
        self.jump(after)
        if orelse:
            self.start(other)
            self.inside(orelse)
            self.jump(after)
        self.start(after)

    def _bounds(self, bounds: Sequence[ast.expr], node: ast.For) -> tuple[Value, Value, int]:
        """Return start, stop and step of a range."""
        values = [self.whole(self.expression(each), each) for each in bounds]
        first = values[0] if len(values) > 1 else constant(0)
        last = values[0] if len(values) == 1 else values[1]
        step = values[2].known if len(values) == 3 else 1
        if not step:
            raise self.fail(node, "the step of range must be a number of the text")
        return first, last, step

    def _for(self, name: str, bounds: Sequence[ast.expr], node: ast.For) -> None:
        self._count(name, self._bounds(bounds, node), node)

    def _count(
        self, name: str, bounds: tuple[Value, Value, int], node: ast.For, also: Callable[[], Value] | None = None
    ) -> None:
        """Write a loop over whole numbers, which goes on only while `also` holds, if given."""
        first, last, step = bounds
        counter = self.slot("i64")
        self.add(f"store i64 {first.parts[0]}, ptr {counter}")
        head, inside, following, after = self.labels("head", "inside", "next", "after")
        self.jump(head)
        self.start(head)
        now = self.new(f"load i64, ptr {counter}")
        more = Value(TRUTH, (self.new(f"icmp {'slt' if step > 0 else 'sgt'} i64 {now}, {last.parts[0]}"),))
        self.branch(self.chosen(more, also(), constant(False)) if also else more, inside, after)
        self.start(inside)
        self.store_counter(name, Value(INTEGER, (now,)), node)
        self.loops.append((after, following))
        self.inside(node.body)
        self.loops.pop()
        self.jump(following)
        self.start(following)
        now = self.new(f"load i64, ptr {counter}")
        self.add(f"store i64 {self.new(f'add nsw i64 {now}, {step}')}, ptr {counter}")
        self.jump(head)
        self.start(after)

    def store_counter(self, name: str, value: Value, node: ast.For) -> None:
        """Assign the number of an iteration to the variable of a loop, which may run never."""
        within = name in self.outliving
        self.depth += within
        self.store(name, value, node)
        self.depth -= within

    def _for_each(self, target: ast.expr, elements: Sequence[ast.expr], node: ast.For) -> None:
        after, values = self.labels("after")[0], self._elements(elements, node)
        for _ in elements:
            following = self.labels("next")[0]
            self.depth += 1
            self.assign(target, next(values))
            self.loops.append((after, following))
            self.inside(node.body)
            self.depth -= 1
            self.loops.pop()
            self.jump(following)
            self.start(following)
        self.jump(after)
        self.start(after)

    def _elements(self, elements: Sequence[ast.expr], node: ast.For) -> Iterator[Value]:
        """Yield the values that a loop goes over, each written where it is used.

        Where the loop sets what they read, all are written before its first iteration.
        """
        places = [each for each in nodes(node.target, *node.body) if isinstance(getattr(each, "ctx", None), ast.Store)]
        roots = [each.value if isinstance(each, ast.Subscript) else each for each in places]
        changed = {each.id for each in roots if isinstance(each, ast.Name)}
        values = (self.expression(each) for each in elements)
        reads_them = any(isinstance(each, ast.Name) and each.id in changed for each in nodes(*elements))
        yield from list(values) if reads_them else values

    def _while(self, test: ast.expr, body: Sequence[ast.stmt]) -> None:
        head, inside, after = self.labels("head", "inside", "after")
        self.jump(head)
        self.start(head)
        self.branch(self.truth(test), inside, after)
        self.start(inside)
        self.loops.append((after, head))
        self.inside(body)
        self.loops.pop()
        self.jump(head)
        self.start(after)

    def _return(self, value: Value, node: ast.Return) -> None:
        value = self._returned(value, node)
        self.give_back(value.kind, value.parts)
        self.closed = True

    def _returned(self, value: Value, node: ast.Return) -> Value:
        """Return a returned value, converted to the kind common to all returns."""
        kind = joined(self.returns or value.kind, value.kind)
        if kind is None or "c" in (kind.name, *(each.name for each in kind.of)):
            raise self.fail(node, f"{value.kind} cannot be returned beside {self.returns}")
        kind = self.kind_to_return(kind, node)
        self.again |= kind != (self.returns or kind)
        self.returns = kind
        return self.or_none(self.as_kind(value, kind))

    def give_back(self, kind: Kind, parts: Sequence[str]) -> None:
        """Write the return of a value."""
        whole = parts[0] if parts else ""
        if kind.name in f"{ARRAYS}t":
            whole = "undef"
            for i, (part, register) in enumerate(zip(kind.parts, parts, strict=True)):
                whole = self.new(f"insertvalue {kind.returned} {whole}, {part} {register}, {i}")
        self.add(f"ret {kind.returned} {whole}".rstrip())
