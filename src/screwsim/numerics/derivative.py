"""Derivatives of kernels, generated from their source: forward mode, statement by statement, branch by branch.

`tangent(kernel, by)` returns a kernel with the same arguments that returns the value and its derivatives by the named
ones. Statements that do not depend on these are copied; a branch is differentiated where it stands, so that a kink has
the slope of the side that the kernel itself takes. Any argument can be a seed: a state, or a number of the scene.

A kernel may assign, branch, loop, unpack, call kernels and the functions of `math`, and read arrays. Derivatives are
tested against differences for all kernels of scalars (tests/numerics/test_derivative.py).

Within a statement the derivatives by its variables come first, and those by the seeds follow through these: a
statement's own partial derivatives are computed once, however many seeds there are.

Source: A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, chs. 3 (forward mode) and 10.2
(statement-level preaccumulation).
"""

import ast
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from typing import Any

from screwsim.numerics.expressions import (
    Expression,
    Slopes,
    added,
    assign,
    assigned,
    is_unit,
    product,
    slope_name,
    target_of,
)
from screwsim.numerics.kernel import Kernel, nodes, parsed, unparsed, written
from screwsim.numerics.partials import Active, Partials, find_active, seeds_of


@lru_cache(maxsize=256)
def tangent(item: Kernel, by: tuple[str, ...]) -> Kernel:
    """Return the kernel that returns a kernel's value and its derivatives by some of its arguments.

    For a kernel that returns several values: first all of them, then their derivatives by the first named argument,
    then those by the second, and so on. Raises TypeError, which names the kernel, for source that cannot be
    differentiated.
    """
    missing = [name for name in by if name not in item.arguments]
    if missing or not by:
        raise TypeError(f"kernel {item.__name__} has no argument {', '.join(missing) or 'to be differentiated by'}")
    function = parsed(item.source).body[0]
    assert isinstance(function, ast.FunctionDef)
    text, uses = _OfKernel(item, function, by).written()
    own = "user_" if item.flat_name.startswith("user_") else ""
    return written(text, f"{own}slopes_of_{item.__name__}", uses)


class Forward:
    """Differentiates statements by seeds; `active` holds the seeds on which each variable depends.

    `given` are derivatives that are stated rather than generated, by variable and seed; `held` variables depend on
    nothing.
    """

    def __init__(
        self,
        name: str,
        body: Sequence[ast.stmt],
        by: tuple[str, ...],
        known: Mapping[str, Any],
        given: Mapping[tuple[str, str], Expression] | None = None,
        held: Collection[str] = (),
    ) -> None:
        self.name, self.by, self.known, self.given, self.held = name, by, known, given or {}, held
        self.active: Active = {name: (name,) for name in by}
        for name in dict.fromkeys(name for name, _ in self.given):
            self.active[name] = tuple(seed for seed in by if (name, seed) in self.given or name == seed)
        self.plain: dict[tuple[str, str], Expression] = {}  # derivatives that are always 1 or -1
        taken = {node.id for node in nodes(*body) if isinstance(node, ast.Name)} | set(by)
        self.pairs = list(assigned(body))
        names = Counter(name for some, _ in self.pairs for name in some)
        self.once = {name for name, times in names.items() if times == 1}
        self.whole = set(by) & set(names)  # seeds that are reassigned, and so are variables like others
        self.once -= self.whole
        find_active(self.active, self.pairs, by, self.given, held)
        self.tail = ""  # of the names of derivatives
        self._partials = Partials(name, known, self.active, taken, names, tangent)
        self.uses = self._partials.uses  # kernels that the new statements call, by name

    def _slope_name(self, name: str, seed: str) -> str:
        return slope_name(name, seed) + self.tail

    def statements(self, body: Sequence[ast.stmt]) -> list[ast.stmt]:
        """Return the statements together with the derivatives of all variables that they set."""
        return [new for statement in body for new in self._statement(statement)]

    def slope(self, name: str, seed: str) -> Expression | None:
        """Return the derivative of a variable by a seed; None where it is zero."""
        if seed not in self.active.get(name, ()):
            return None
        if name == seed and name not in self.whole:
            return ast.Constant(1.0)
        if (name, seed) in self.plain:
            return self.plain[name, seed]
        return ast.Name(self._slope_name(name, seed), ast.Load())

    def _statement(self, node: ast.stmt) -> list[ast.stmt]:
        match node:
            case ast.Expr(value=ast.Constant()):
                return []  # the docstring
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                return self._assignment(name, value)
            case ast.Assign(targets=[ast.Tuple(elts=targets)], value=value):
                return self._unpacking(targets, value)
            case ast.Assign(targets=[ast.Name(id=name), *others], value=value):
                same = (ast.Assign([each], ast.Name(name, ast.Load())) for each in others)
                return [*self._assignment(name, value), *(new for each in same for new in self._statement(each))]
            case ast.AugAssign(target=ast.Name(id=name), op=op, value=value):
                return self._assignment(name, ast.BinOp(ast.Name(name, ast.Load()), op, value))
            case ast.If(test=test, body=body, orelse=orelse):
                return [ast.If(test, self.statements(body), self.statements(orelse))]
            case ast.For(target=target, iter=ast.Tuple(elts=elements), body=body, orelse=[]):
                return self._over_elements(target, elements, body)
            case ast.For(target=ast.Name(id=name) as target, iter=values, body=body, orelse=[]):
                none = [assign(self._slope_name(name, seed), ast.Constant(0.0)) for seed in self.active.get(name, ())]
                return [ast.For(target, values, [*none, *self.statements(body)], [])]
            case ast.While(test=test, body=body, orelse=[]):
                return [ast.While(test, self.statements(body), [])]
            case ast.Return(value=value) if value is not None:
                return self._return(value)
            case ast.Break() | ast.Continue() | ast.Pass():
                return [node]
        raise self._partials.fail(f"it has {ast.unparse(node).splitlines()[0]!r}")

    def _assignment(self, name: str, value: Expression) -> list[ast.stmt]:
        """Return statements that set a variable and, first, its derivatives, which may need its old value."""
        before: list[ast.stmt] = []
        plain, slopes = self._partials.expression(value, before)
        found = self._by_seeds(slopes, self.active.get(name, ()), before, name)
        own: list[ast.stmt] = []
        after: list[ast.stmt] = []
        for seed, slope in found.items():
            if (name, seed) in self.given:  # a given derivative may depend on the new value
                after.append(assign(self._slope_name(name, seed), self.given[name, seed]))
            elif name in self.once and is_unit(slope):
                self.plain[name, seed] = slope
            else:
                own.append(assign(self._slope_name(name, seed), slope))
        return [*before, *own, assign(name, plain), *after]

    def _by_seeds(self, slopes: Slopes, seeds: Sequence[str], before: list[ast.stmt], stem: str) -> Slopes:
        """Return the derivatives by each seed, by the chain rule over the variables of a statement."""
        if len(seeds) > 1:
            slopes = {name: self._partials.kept(slope, before, f"{stem}_by_{name}") for name, slope in slopes.items()}
        found: Slopes = {}
        for seed in seeds:
            total: Expression | None = None
            for name, slope in slopes.items():
                total = added(total, product(self.slope(name, seed), slope))
            found[seed] = total or ast.Constant(0.0)
        return found

    def _unpacking(self, targets: Sequence[Expression], value: Expression) -> list[ast.stmt]:
        if isinstance(value, ast.IfExp) and seeds_of(value, self.active):
            return [ast.If(value.test, *(self._unpacking(targets, side) for side in (value.body, value.orelse)))]
        names, before = self._names(targets), list[ast.stmt]()
        found = self._items(value, before, len(names))
        new: list[tuple[str, Expression]] = []
        for name, (plain, slopes) in zip(names, found, strict=True):
            by_seeds = self._by_seeds(slopes, self.active.get(name, ()), before, name)
            new += [(self._slope_name(name, seed), slope) for seed, slope in by_seeds.items()]
            new.append((name, plain))
        behind = [{*slopes} & {*names[:k]} for k, (_, slopes) in enumerate(found)]
        if isinstance(value, ast.Tuple) or any(behind):  # it may swap variables: all is read before anything is set
            new = [(name, self._held(one, before)) for name, one in new]
        return before + [assign(name, one) for name, one in new]

    def _over_elements(
        self, target: Expression, elements: Sequence[Expression], body: Sequence[ast.stmt]
    ) -> list[ast.stmt]:
        """Return a loop over given values, each with its derivatives by the seeds on which the variable depends."""
        names, before = self._names(target.elts if isinstance(target, ast.Tuple) else [target]), list[ast.stmt]()
        seeds = {name: self.active.get(name, ()) for name in names}
        if not any(seeds.values()):
            return [ast.For(target, ast.Tuple([*elements], ast.Load()), self.statements(body), [])]
        rows: list[Expression] = []
        for element in elements:
            single = not isinstance(target, ast.Tuple)
            found = [self._partials.expression(element, before)] if single else self._items(element, before, len(names))
            row: list[Expression] = []
            for name, (plain, slopes) in zip(names, found, strict=True):
                row += [plain, *self._by_seeds(slopes, seeds[name], before, name).values()]
            rows.append(ast.Tuple([self._held(each, before) for each in row], ast.Load()))
        every = [each for name in names for each in (name, *(self._slope_name(name, seed) for seed in seeds[name]))]
        return [*before, ast.For(target_of(every), ast.Tuple(rows, ast.Load()), self.statements(body), [])]

    def _names(self, targets: Sequence[Expression]) -> list[str]:
        names = [target.id for target in targets if isinstance(target, ast.Name)]
        if len(names) < len(targets):
            raise self._partials.fail(f"it unpacks into {ast.unparse(targets[0])!r}")
        return names

    def _items(self, value: Expression, before: list[ast.stmt], count: int) -> list[tuple[Expression, Slopes]]:
        """Return the items of a tuple that is written out or returned by a kernel, with their derivatives."""
        if isinstance(value, ast.Tuple):
            return [self._partials.expression(one, before) for one in value.elts]
        return self._partials.values(value, before, count)

    def _held(self, value: Expression, before: list[ast.stmt]) -> Expression:
        """Return a name that keeps an expression's value whatever is set behind."""
        keep = self._partials.fresh("new")
        before.append(assign(keep, value))
        return ast.Name(keep, ast.Load())

    def _return(self, value: Expression) -> list[ast.stmt]:
        if isinstance(value, ast.IfExp) and self._partials.returned(value) > 1:
            return [ast.If(value.test, self._return(value.body), self._return(value.orelse))]
        before: list[ast.stmt] = []
        if isinstance(value, ast.Tuple):
            found = [self._partials.expression(one, before) for one in value.elts]
        elif isinstance(value, ast.Call) and self._partials.returned(value) > 1:
            found = self._partials.values(value, before, self._partials.returned(value))
        else:
            found = [self._partials.expression(value, before)]
        stems = [self.name if len(found) == 1 else f"{self.name}_{i}" for i in range(len(found))]
        by_seeds = [self._by_seeds(one[1], self.by, before, stem) for one, stem in zip(found, stems, strict=True)]
        slopes = [one[seed] for seed in self.by for one in by_seeds]
        return [*before, ast.Return(ast.Tuple([*(plain for plain, _ in found), *slopes], ast.Load()))]


class _OfKernel(Forward):
    """Differentiates one kernel by some of its arguments."""

    def __init__(self, item: Kernel, function: ast.FunctionDef, by: tuple[str, ...]) -> None:
        super().__init__(item.__name__, function.body, by, item.function.__globals__)
        self._partials.taken.update(item.arguments)
        while self._partials.taken & {self._slope_name(name, seed) for name, by in self.active.items() for seed in by}:
            self.tail += "_"
        self.item, self.body = item, function.body
        self.whole = {name for names, _ in self.pairs for name in names} & set(item.arguments)
        self.once -= self.whole

    def written(self) -> tuple[str, dict[str, Any]]:
        """Return the text of the tangent, and the kernels and constants that it uses."""
        first = [
            assign(self._slope_name(name, seed), ast.Constant(float(name == seed)))
            for name in self.item.arguments
            if name in self.whole
            for seed in self.active.get(name, ())
        ]
        function = ast.FunctionDef(
            name="_by_".join([self.name, "_".join(self.by)]),
            args=ast.arguments([], [ast.arg(one) for one in self.item.arguments], None, [], [], None, []),
            body=first + self.statements(self.body),
            decorator_list=[],
        )
        for node in nodes(function):
            if isinstance(node, ast.Name) and node.id in self.known and node.id not in self.uses:
                self.uses[node.id] = self.known[node.id]
        for module in ("math", "np"):  # available in every text
            self.uses.pop(module, None)
        return unparsed(function) + "\n", self.uses
