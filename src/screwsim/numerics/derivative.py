"""Derivatives of kernels, made from their source: forward mode, statement by statement, branch by branch.

`tangent(kernel, by)` returns a kernel of the same arguments that returns the value and its derivatives by the named
ones. What does not depend on them is left as it stands; a branch is differentiated where it runs, so that a kink has
the slope of the side that the kernel itself takes. Any argument can be a seed: states today, a scene's numbers as well.

A kernel may assign, branch, loop, unpack, call kernels and the functions of `math`, and read arrays; it may not write
into one. Derivatives are tested against differences for all kernels of scalars (tests/numerics/test_derivative.py).

Within a statement the derivatives by the variables in it come first, and each argument's through these: a statement's
own derivatives are worked out once, however many arguments there are.

Source: A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, chs. 3 (forward mode) and 10.2
(statement-level preaccumulation).
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from typing import Any

from screwsim.numerics.expressions import (
    FLAT,
    SLOPES,
    Expression,
    Slopes,
    added,
    assign,
    assigned,
    each,
    is_unit,
    name_of,
    negative,
    product,
    read,
    targets,
)
from screwsim.numerics.kernel import Kernel, Slot, nodes, parsed, unparsed, written


@lru_cache(maxsize=256)
def tangent(item: Kernel, by: tuple[str, ...]) -> Kernel:
    """Return the kernel that returns a kernel's value and its derivatives by arguments of it.

    Of a kernel that returns several values: all of them, then their derivatives by the first argument named, then those
    by the second. It is compiled into its callers where the kernel is, or where that is asked for. Raises TypeError,
    which names the kernel, for what cannot be differentiated.
    """
    missing = [name for name in by if name not in item.arguments]
    if missing or not by:
        raise TypeError(f"kernel {item.__name__} has no argument {', '.join(missing) or 'to be differentiated by'}")
    function = parsed(item.source).body[0]
    assert isinstance(function, ast.FunctionDef)
    text, uses = _OfKernel(item, function, by).written()
    return written(text, f"slopes_of_{item.__name__}", uses)


class Forward:
    """Differentiates statements by seeds; `active` holds which variables depend on which of them.

    `given` are derivatives that are not made but stated, by variable and seed; what is `held` depends on nothing.
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
        self.uses: dict[str, Any] = {}
        self.count = 0
        self.active: dict[str, tuple[str, ...]] = {name: (name,) for name in by}
        for name in dict.fromkeys(name for name, _ in self.given):
            self.active[name] = tuple(seed for seed in by if (name, seed) in self.given or name == seed)
        self.plain: dict[tuple[str, str], Expression] = {}  # derivatives that are 1 or -1 wherever they are read
        self.taken = {node.id for node in nodes(*body) if isinstance(node, ast.Name)} | set(by)
        self.pairs = list(assigned(body))
        names = [name for some, _ in self.pairs for name in some]
        self.once = {name for name in names if names.count(name) == 1}
        self.whole = set(by) & set(names)  # seeds that are assigned to: variables like others
        self.once -= self.whole
        self._find_active()

    def statements(self, body: Sequence[ast.stmt]) -> list[ast.stmt]:
        """Return the statements with the derivatives of all that they set."""
        return [new for statement in body for new in self._statement(statement)]

    def slope(self, name: str, seed: str) -> Expression | None:
        """Return the derivative of a variable by a seed; None where that is nothing."""
        if seed not in self.active.get(name, ()):
            return None
        if name == seed and name not in self.whole:
            return ast.Constant(1.0)
        if (name, seed) in self.plain:
            return self.plain[name, seed]
        return ast.Name(self._slope_name(name, seed), ast.Load())

    # ---- what depends on what ----------------------------------------------------------------------------------

    def _find_active(self) -> None:
        """Let every variable depend on what any assignment to it depends on, until nothing is added."""
        while True:
            before = dict(self.active)
            for names, value in self.pairs:
                found_in = self._seeds(value)
                for name in names:
                    if name in self.held:
                        continue
                    seeds = found_in | {seed for seed in self.by if (name, seed) in self.given}
                    have = self.active.get(name, ())
                    found = tuple(seed for seed in self.by if seed in have or seed in seeds)
                    if found:
                        self.active[name] = found
            if self.active == before:
                return

    def _seeds(self, node: ast.AST) -> set[str]:
        """Return the arguments on which an expression depends; what decides a branch or an index does not count."""
        if isinstance(node, ast.Name):
            return set(self.active.get(node.id, ()))
        if isinstance(node, ast.Compare | ast.BoolOp):
            return set()
        if isinstance(node, ast.Subscript):
            return self._seeds(node.value)
        if isinstance(node, ast.IfExp):
            return self._seeds(node.body) | self._seeds(node.orelse)
        if isinstance(node, ast.Call) and name_of(node) in FLAT | {"int", "len", "range"}:
            return set()
        parts = node.args if isinstance(node, ast.Call) else ast.iter_child_nodes(node)
        return set().union(*(self._seeds(part) for part in parts))

    # ---- text --------------------------------------------------------------------------------------------------

    def _fresh(self, stem: str) -> str:
        self.count += 1
        name = f"{stem}_{self.count}"
        while name in self.taken:
            self.count += 1
            name = f"{stem}_{self.count}"
        self.taken.add(name)
        return name

    @staticmethod
    def _slope_name(name: str, seed: str) -> str:
        return f"{name}__{seed}"

    def _fail(self, what: str) -> TypeError:
        return TypeError(f"kernel {self.name} cannot be differentiated: {what}")

    # ---- statements --------------------------------------------------------------------------------------------

    def _statement(self, node: ast.stmt) -> list[ast.stmt]:
        match node:
            case ast.Expr(value=ast.Constant()):
                return []  # the docstring
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                return self._assignment(name, value)
            case ast.Assign(targets=[ast.Tuple(elts=targets)], value=value):
                return self._unpacking(targets, value)
            case ast.AugAssign(target=ast.Name(id=name), op=op, value=value):
                return self._assignment(name, ast.BinOp(ast.Name(name, ast.Load()), op, value))
            case ast.If(test=test, body=body, orelse=orelse):
                return [ast.If(test, self.statements(body), self.statements(orelse))]
            case ast.For(target=target, iter=values, body=body, orelse=[]):
                return [ast.For(target, values, self.statements(body), [])]
            case ast.While(test=test, body=body, orelse=[]):
                return [ast.While(test, self.statements(body), [])]
            case ast.Return(value=value) if value is not None:
                return self._return(value)
            case ast.Break() | ast.Continue() | ast.Pass():
                return [node]
        raise self._fail(f"it has {ast.unparse(node).splitlines()[0]!r}")

    def _assignment(self, name: str, value: Expression) -> list[ast.stmt]:
        """Return statements that set a variable and its derivatives; these first, as they may need its old value."""
        before: list[ast.stmt] = []
        plain, slopes = self._expression(value, before)
        found = self._by_seeds(slopes, self.active.get(name, ()), before, name)
        own: list[ast.stmt] = []
        after: list[ast.stmt] = []
        for seed, slope in found.items():
            if (name, seed) in self.given:  # which may be stated by the new value
                after.append(assign(self._slope_name(name, seed), self.given[name, seed]))
            elif name in self.once and is_unit(slope):
                self.plain[name, seed] = slope
            else:
                own.append(assign(self._slope_name(name, seed), slope))
        return [*before, *own, assign(name, plain), *after]

    def _by_seeds(self, slopes: Slopes, seeds: Sequence[str], before: list[ast.stmt], stem: str) -> Slopes:
        """Return the derivative by each seed, through the variables of a statement."""
        if len(seeds) > 1:
            slopes = {name: self._kept(slope, before, f"{stem}_by_{name}") for name, slope in slopes.items()}
        found: Slopes = {}
        for seed in seeds:
            total: Expression | None = None
            for name, slope in slopes.items():
                total = added(total, product(self.slope(name, seed), slope))
            found[seed] = total or ast.Constant(0.0)
        return found

    def _unpacking(self, targets: Sequence[Expression], value: Expression) -> list[ast.stmt]:
        names = [target.id for target in targets if isinstance(target, ast.Name)]
        if len(names) < len(targets):
            raise self._fail(f"it unpacks into {ast.unparse(targets[0])!r}")
        before: list[ast.stmt] = []
        if isinstance(value, ast.Tuple):
            found = [self._expression(one, before) for one in value.elts]
        else:
            found = self._values(value, before, len(names))
        new: list[tuple[str, Expression]] = []
        for name, (plain, slopes) in zip(names, found, strict=True):
            by_seeds = self._by_seeds(slopes, self.active.get(name, ()), before, name)
            new += [(self._slope_name(name, seed), slope) for seed, slope in by_seeds.items()]
            new.append((name, plain))
        if isinstance(value, ast.Tuple):  # which may exchange variables: all is read before anything is set
            held = [(name, self._fresh("new")) for name, _ in new]
            before += [assign(keep, slope) for (_, keep), (_, slope) in zip(held, new, strict=True)]
            new = [(name, ast.Name(keep, ast.Load())) for name, keep in held]
        return before + [assign(name, one) for name, one in new]

    def _return(self, value: Expression) -> list[ast.stmt]:
        before: list[ast.stmt] = []
        if isinstance(value, ast.Tuple):
            found = [self._expression(one, before) for one in value.elts]
        elif isinstance(value, ast.Call) and self._seeds(value) and self._returned(value) > 1:
            found = self._values(value, before, self._returned(value))
        else:
            found = [self._expression(value, before)]
        stems = [self.name if len(found) == 1 else f"{self.name}_{i}" for i in range(len(found))]
        by_seeds = [self._by_seeds(one[1], self.by, before, stem) for one, stem in zip(found, stems, strict=True)]
        slopes = [one[seed] for seed in self.by for one in by_seeds]
        return [*before, ast.Return(ast.Tuple([*(plain for plain, _ in found), *slopes], ast.Load()))]

    # ---- expressions -------------------------------------------------------------------------------------------

    def _expression(self, node: Expression, before: list[ast.stmt]) -> tuple[Expression, Slopes]:
        """Return an expression and its derivatives by its variables; what both need is set in statements before."""
        if not self._seeds(node):
            return node, {}
        match node:
            case ast.Name(id=name):
                return node, {name: ast.Constant(1.0)}
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                value, slopes = self._expression(operand, before)
                return ast.UnaryOp(ast.USub(), value), {name: negative(one) for name, one in slopes.items()}
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self._expression(operand, before)
            case ast.BinOp(left=left, op=op, right=right):
                return self._operation(left, op, right, before)
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return self._choice(test, body, orelse, before)
            case ast.Call():
                return self._call(node, before)
            case ast.Subscript(value=ast.Call() as call, slice=ast.Constant(value=int(index))):
                return self._values(call, before, self._returned(call))[index]
        raise self._fail(f"it has {ast.unparse(node)!r}")

    def _kept(self, value: Expression, before: list[ast.stmt], stem: str = "part") -> Expression:
        """Return an expression that can be read again and again: a name or a constant."""
        if isinstance(value, ast.Name | ast.Constant) or is_unit(value):
            return value
        name = stem if "_by_" in stem and stem not in self.taken else self._fresh(stem)
        before.append(assign(name, value))
        return ast.Name(name, ast.Load())

    def _operation(
        self, left: Expression, op: ast.operator, right: Expression, before: list[ast.stmt]
    ) -> tuple[Expression, Slopes]:
        (a, da), (b, db) = self._expression(left, before), self._expression(right, before)
        if isinstance(op, ast.Add | ast.Sub):
            minus = isinstance(op, ast.Sub)
            return ast.BinOp(a, op, b), each(lambda name: added(da.get(name), db.get(name), minus), da, db)
        a, b = self._kept(a, before), self._kept(b, before)
        if isinstance(op, ast.Mult):
            return ast.BinOp(a, op, b), each(
                lambda name: added(product(da.get(name), b), product(db.get(name), a)), da, db
            )
        if isinstance(op, ast.Div):
            over = self._kept(read("1.0 / b", b=b), before, "over")
            value = self._kept(ast.BinOp(a, op, b), before)
            return value, each(
                lambda name: product(added(da.get(name), product(db.get(name), value), True), over), da, db
            )
        if isinstance(op, ast.Pow):
            return self._power(a, da, b, db, before)
        raise self._fail(f"it has the operator {type(op).__name__}")

    def _power(
        self, a: Expression, da: Slopes, b: Expression, db: Slopes, before: list[ast.stmt]
    ) -> tuple[Expression, Slopes]:
        value = self._kept(ast.BinOp(a, ast.Pow(), b), before)
        by_a = self._kept(read("b * a ** (b - 1.0)", a=a, b=b), before) if da else None
        by_b = self._kept(read("v * math.log(a)", a=a, v=value), before) if db else None
        return value, each(lambda name: added(product(da.get(name), by_a), product(db.get(name), by_b)), da, db)

    def _choice(
        self, test: Expression, body: Expression, orelse: Expression, before: list[ast.stmt]
    ) -> tuple[Expression, Slopes]:
        """Return what one of two expressions gives; only the one that is taken is evaluated."""
        name = self._fresh("part")
        ways: list[list[ast.stmt]] = [[], []]
        found = [self._expression(side, way) for side, way in zip((body, orelse), ways, strict=True)]
        variables = list(dict.fromkeys([one for _, slopes in found for one in slopes]))
        for (value, slopes), way in zip(found, ways, strict=True):
            way += [assign(f"{name}_by_{one}", slopes.get(one) or ast.Constant(0.0)) for one in variables]
            way.append(assign(name, value))
        before.append(ast.If(test, *ways))
        return ast.Name(name, ast.Load()), {one: ast.Name(f"{name}_by_{one}", ast.Load()) for one in variables}

    # ---- calls -------------------------------------------------------------------------------------------------

    def _call(self, node: ast.Call, before: list[ast.stmt]) -> tuple[Expression, Slopes]:
        name = name_of(node)
        if isinstance(node.func, ast.Attribute) and name in SLOPES:
            value, slopes = self._expression(node.args[0], before)
            u = self._kept(value, before)
            v = self._kept(ast.Call(node.func, [u], []), before)
            by = self._kept(read(SLOPES[name], u=u, v=v), before)
            return v, each(lambda name: product(slopes[name], by), slopes)
        if isinstance(node.func, ast.Attribute) and name == "pow":
            return self._operation(node.args[0], ast.Pow(), node.args[1], before)
        if isinstance(node.func, ast.Name) and name == "float":
            return self._expression(node.args[0], before)
        if isinstance(node.func, ast.Name) and name == "abs":
            value, slopes = self._expression(node.args[0], before)
            u = self._kept(value, before)
            by = self._kept(read("1.0 if u >= 0.0 else -1.0", u=u), before)
            return ast.Call(node.func, [u], []), each(lambda name: product(slopes[name], by), slopes)
        if isinstance(node.func, ast.Name) and name in ("min", "max") and len(node.args) > 1:
            return self._extreme(name, node.args, before)
        return self._values(node, before, 1)[0]

    def _extreme(self, name: str, arguments: Sequence[Expression], before: list[ast.stmt]) -> tuple[Expression, Slopes]:
        """Return the least or largest of several, as Python takes it: the first of equal ones."""
        first, *others = arguments
        if len(others) > 1:
            others = [ast.Call(ast.Name(name, ast.Load()), others, [])]
        a, b = (self._expression(each, before) for each in (first, others[0]))
        (a, da), (b, db) = ((self._kept(value, before), slopes) for value, slopes in (a, b))
        test = self._kept(read("b > a" if name == "max" else "b < a", a=a, b=b), before, "other")
        value = self._kept(ast.IfExp(test, b, a), before)
        none = ast.Constant(0.0)
        return value, each(lambda one: ast.IfExp(test, db.get(one) or none, da.get(one) or none), da, db)

    def _values(self, node: Expression, before: list[ast.stmt], count: int) -> list[tuple[Expression, Slopes]]:
        """Return the values that a kernel's call gives, and their derivatives."""
        seeded = bool(self._seeds(node))
        names = [self._fresh("part") for _ in range(count)]
        plain = [ast.Name(name, ast.Load()) for name in names]
        if not seeded:
            before.append(ast.Assign([targets(names)], node))
            return [(one, {}) for one in plain]
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name):
            raise self._fail(f"it has {ast.unparse(node)!r}")
        called = self.known.get(node.func.id)
        if isinstance(called, Slot):
            raise self._fail(f"{node.func.id} exists only inside a generated module")
        if not isinstance(called, Kernel) or node.keywords:
            raise self._fail(f"it calls {ast.unparse(node.func)}")
        found = [self._expression(argument, before) for argument in node.args]
        moving = [(name, slopes) for name, (_, slopes) in zip(called.arguments, found, strict=True) if slopes]
        by = tuple(name for name, _ in moving)
        alias = "_by_".join([node.func.id, "_".join(by)])  # two kernels may have one name of their own
        self.uses[alias] = tangent(called, by)
        parts = [[self._fresh("by") for _ in range(count)] for _ in moving]
        call = ast.Call(ast.Name(alias, ast.Load()), [value for value, _ in found], [])
        before.append(ast.Assign([targets([*names, *(name for some in parts for name in some)])], call))

        def slope(k: int, name: str) -> Expression | None:
            total: Expression | None = None
            for (_, slopes), some in zip(moving, parts, strict=True):
                total = added(total, product(slopes.get(name), ast.Name(some[k], ast.Load())))
            return total

        every = [slopes for _, slopes in moving]
        return [(one, each(lambda name, k=k: slope(k, name), *every)) for k, one in enumerate(plain)]

    def _returned(self, node: ast.Call) -> int:
        """Return how many values a kernel gives."""
        called = self.known.get(node.func.id) if isinstance(node.func, ast.Name) else None
        if not isinstance(called, Kernel):
            return 1
        returns = [one.value for one in nodes(parsed(called.source)) if isinstance(one, ast.Return)]
        return len(returns[0].elts) if returns and isinstance(returns[0], ast.Tuple) else 1


class _OfKernel(Forward):
    """Differentiates one kernel by arguments of it."""

    def __init__(self, item: Kernel, function: ast.FunctionDef, by: tuple[str, ...]) -> None:
        super().__init__(item.__name__, function.body, by, item.function.__globals__)
        self.taken |= set(item.arguments)
        self.item, self.body = item, function.body
        self.whole = {name for names, _ in self.pairs for name in names} & set(item.arguments)
        self.once -= self.whole

    def written(self) -> tuple[str, dict[str, Any]]:
        """Return the text of the tangent, and what it uses."""
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
        for module in ("math", "np"):  # which every text has
            self.uses.pop(module, None)
        return unparsed(function) + "\n", self.uses
