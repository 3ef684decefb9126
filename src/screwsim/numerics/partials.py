"""Expressions with their partial derivatives by the variables in them: operators, choices, functions, kernels."""

import ast
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

from screwsim.numerics.expressions import (
    FLAT,
    SLOPES,
    SLOPES_OF_TWO,
    Expression,
    Slopes,
    added,
    assign,
    choice_of,
    each,
    is_unit,
    name_of,
    negative,
    product,
    read,
    target_of,
)
from screwsim.numerics.kernel import Kernel, Slot, math_spelling, nodes, parsed

Active = dict[str, tuple[str, ...]]  # the seeds on which each variable depends, in their order


class Partials:
    """Differentiates the expressions of one text by the variables in them.

    `active` holds the seeds on which variables depend, `known` the meaning of the text's names, `taken` the names in
    use, `local` those that the text sets; `tangent` makes the kernel of a called kernel's derivatives, and `uses`
    collects these.
    """

    def __init__(
        self,
        name: str,
        known: Mapping[str, Any],
        active: Active,
        taken: set[str],
        local: Collection[str],
        tangent: Callable[[Kernel, tuple[str, ...]], Kernel],
    ) -> None:
        self.name, self.known, self.active, self.taken, self.tangent = name, known, active, taken, tangent
        self.local = local
        self.uses: dict[str, Any] = {}
        self._count = 0

    def fresh(self, stem: str) -> str:
        """Return a name that is not in use."""
        self._count += 1
        name = f"{stem}_{self._count}"
        while name in self.taken:
            self._count += 1
            name = f"{stem}_{self._count}"
        self.taken.add(name)
        return name

    def fail(self, what: str) -> TypeError:
        """Return the error that names the kernel and the part that cannot be differentiated."""
        return TypeError(f"kernel {self.name} cannot be differentiated: {what}")

    def expression(self, node: Expression, before: list[ast.stmt]) -> tuple[Expression, Slopes]:
        """Return an expression and its derivatives by its variables; common parts are set in statements `before`."""
        if not any(self.active.get(name) for name in variables_of(node)):
            return node, {}
        match node:
            case ast.Name(id=name):
                return node, {name: ast.Constant(1.0)}
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                value, slopes = self.expression(operand, before)
                return ast.UnaryOp(ast.USub(), value), {name: negative(one) for name, one in slopes.items()}
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.expression(operand, before)
            case ast.BinOp(left=left, op=op, right=right):
                return self._operation(left, op, right, before)
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return self._choice(test, body, orelse, before)
            case ast.BoolOp():
                return self.expression(choice_of(node), before)
            case ast.Call():
                return self._call(node, before)
            case ast.Subscript(value=ast.Call() as call, slice=ast.Constant(value=int(index))):
                return self.values(call, before, self.returned(call))[index]
        raise self.fail(f"it has {ast.unparse(node)!r}")

    def kept(self, value: Expression, before: list[ast.stmt], stem: str = "part") -> Expression:
        """Return an expression that may be repeated: a name or a constant."""
        if isinstance(value, ast.Name | ast.Constant) or is_unit(value):
            return value
        name = stem if "_by_" in stem and stem not in self.taken else self.fresh(stem)
        before.append(assign(name, value))
        return ast.Name(name, ast.Load())

    def _operation(
        self, left: Expression, op: ast.operator, right: Expression, before: list[ast.stmt]
    ) -> tuple[Expression, Slopes]:
        (a, da), (b, db) = self.expression(left, before), self.expression(right, before)
        if isinstance(op, ast.Add | ast.Sub):
            minus = isinstance(op, ast.Sub)
            return ast.BinOp(a, op, b), each(lambda name: added(da.get(name), db.get(name), minus), da, db)
        a, b = self.kept(a, before), self.kept(b, before)
        if isinstance(op, ast.Mult):
            return ast.BinOp(a, op, b), each(
                lambda name: added(product(da.get(name), b), product(db.get(name), a)), da, db
            )
        if isinstance(op, ast.Div):
            over = self.kept(read("1.0 / b", b=b), before, "over")
            value = self.kept(ast.BinOp(a, op, b), before)
            return value, each(
                lambda name: product(added(da.get(name), product(db.get(name), value), True), over), da, db
            )
        if isinstance(op, ast.Pow):
            return self._power(a, da, b, db, before)
        raise self.fail(f"it has the operator {type(op).__name__}")

    def _power(
        self, a: Expression, da: Slopes, b: Expression, db: Slopes, before: list[ast.stmt]
    ) -> tuple[Expression, Slopes]:
        value = self.kept(ast.BinOp(a, ast.Pow(), b), before)
        slope = "b * a ** (b - 1.0)"
        if isinstance(b, ast.Name) and b.id in self.local:  # such as the number of an iteration
            slope += " if b != 0.0 else 0.0"
        by_a = self.kept(read(slope, a=a, b=b), before) if da else None
        by_b = self.kept(read("v * math.log(a)", a=a, v=value), before) if db else None
        return value, each(lambda name: added(product(da.get(name), by_a), product(db.get(name), by_b)), da, db)

    def _choice(
        self, test: Expression, body: Expression, orelse: Expression, before: list[ast.stmt]
    ) -> tuple[Expression, Slopes]:
        """Return the value of a conditional expression; only the branch that is taken is evaluated."""
        name = self.fresh("part")
        ways: list[list[ast.stmt]] = [[], []]
        found = [self.expression(side, way) for side, way in zip((body, orelse), ways, strict=True)]
        variables = list(dict.fromkeys([one for _, slopes in found for one in slopes]))
        for (value, slopes), way in zip(found, ways, strict=True):
            way += [assign(f"{name}_by_{one}", slopes.get(one) or ast.Constant(0.0)) for one in variables]
            way.append(assign(name, value))
        before.append(ast.If(test, *ways))
        return ast.Name(name, ast.Load()), {one: ast.Name(f"{name}_by_{one}", ast.Load()) for one in variables}

    def _call(self, node: ast.Call, before: list[ast.stmt]) -> tuple[Expression, Slopes]:
        name = name_of(node)
        if (isinstance(node.func, ast.Attribute) or name == "abs") and name in SLOPES and len(node.args) == 1:
            value, slopes = self.expression(node.args[0], before)
            u = self.kept(value, before)
            v = self.kept(ast.Call(node.func, [u], []), before)
            by = self.kept(read(SLOPES[name], u=u, v=v), before)
            return v, each(lambda name: product(slopes[name], by), slopes)
        if isinstance(node.func, ast.Attribute) and name in SLOPES_OF_TWO and len(node.args) == 2:
            return self._of_two(node, before)
        if isinstance(node.func, ast.Attribute) and name == "pow":
            return self._operation(node.args[0], ast.Pow(), node.args[1], before)
        if isinstance(node.func, ast.Name) and name == "float":
            return self.expression(node.args[0], before)
        if isinstance(node.func, ast.Name) and name in ("min", "max") and len(node.args) > 1:
            return self._extreme(name, node.args, before)
        return self.values(node, before, 1)[0]

    def _of_two(self, node: ast.Call, before: list[ast.stmt]) -> tuple[Expression, Slopes]:
        (u, du), (w, dw) = (self.expression(each, before) for each in node.args)
        u, w = self.kept(u, before), self.kept(w, before)
        v = self.kept(ast.Call(node.func, [u, w], []), before)
        by_u, by_w = (
            self.kept(read(text, u=u, v=v, w=w), before) if slopes else None
            for text, slopes in zip(SLOPES_OF_TWO[name_of(node)], (du, dw), strict=True)
        )
        return v, each(lambda name: added(product(du.get(name), by_u), product(dw.get(name), by_w)), du, dw)

    def _extreme(self, name: str, arguments: Sequence[Expression], before: list[ast.stmt]) -> tuple[Expression, Slopes]:
        """Return the smallest or largest of several expressions, for equal ones the first, as in Python."""
        first, *others = arguments
        if len(others) > 1:
            others = [ast.Call(ast.Name(name, ast.Load()), others, [])]
        a, b = (self.expression(each, before) for each in (first, others[0]))
        (a, da), (b, db) = ((self.kept(value, before), slopes) for value, slopes in (a, b))
        test = self.kept(read("b > a" if name == "max" else "b < a", a=a, b=b), before, "other")
        value = self.kept(ast.IfExp(test, b, a), before)
        none = ast.Constant(0.0)
        return value, each(lambda one: ast.IfExp(test, db.get(one) or none, da.get(one) or none), da, db)

    def values(self, node: Expression, before: list[ast.stmt], count: int) -> list[tuple[Expression, Slopes]]:
        """Return the values that a call of a kernel returns, and their derivatives."""
        seeded = bool(seeds_of(node, self.active))
        names = [self.fresh("part") for _ in range(count)]
        plain = [ast.Name(name, ast.Load()) for name in names]
        if not seeded:
            before.append(ast.Assign([target_of(names)], node))
            return [(one, {}) for one in plain]
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name):
            raise self.fail(f"it has {ast.unparse(node)!r}")
        called = self.known.get(node.func.id)
        if isinstance(called, Slot):
            raise self.fail(f"{node.func.id} exists only inside a generated module")
        if not isinstance(called, Kernel) or node.keywords:
            raise self.fail(f"it calls {ast.unparse(node.func)}{math_spelling(called)}")
        found = [self.expression(argument, before) for argument in node.args]
        moving = [(name, slopes) for name, (_, slopes) in zip(called.arguments, found, strict=True) if slopes]
        by = tuple(name for name, _ in moving)
        alias = "_by_".join([node.func.id, "_".join(by)])  # two kernels may have the same name of their own
        found_as = self.tangent(called, by)
        if alias in self.taken or self.uses.get(alias, found_as) is not found_as:  # by a, b and by a_b
            alias = self.fresh(alias)
        self.uses[alias] = found_as
        parts = [[self.fresh("by") for _ in range(count)] for _ in moving]
        call = ast.Call(ast.Name(alias, ast.Load()), [value for value, _ in found], [])
        before.append(ast.Assign([target_of([*names, *(name for some in parts for name in some)])], call))

        def slope(k: int, name: str) -> Expression | None:
            total: Expression | None = None
            for (_, slopes), some in zip(moving, parts, strict=True):
                total = added(total, product(slopes.get(name), ast.Name(some[k], ast.Load())))
            return total

        every = [slopes for _, slopes in moving]
        return [(one, each(lambda name, k=k: slope(k, name), *every)) for k, one in enumerate(plain)]

    def returned(self, node: Expression) -> int:
        """Return the number of values that an expression gives: a tuple, a call of a kernel, or a choice of these."""
        return _returned(node, self.known)


def _returned(node: Expression | None, known: Mapping[str, Any]) -> int:
    if isinstance(node, ast.Tuple):
        return len(node.elts)
    if isinstance(node, ast.IfExp):
        return _returned(node.body, known)
    called = known.get(node.func.id) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else None
    if not isinstance(called, Kernel):
        return 1
    returns = [one.value for one in nodes(parsed(called.source)) if isinstance(one, ast.Return)]
    return _returned(returns[0], called.function.__globals__) if returns else 1


def find_active(
    active: Active,
    pairs: Sequence[tuple[list[str], Expression]],
    by: tuple[str, ...],
    given: Collection[tuple[str, str]],
    held: Collection[str],
) -> None:
    """Extend `active`: a variable depends on every seed on which an assignment to it depends, until nothing changes."""
    read = [(names, list(variables_of(value))) for names, value in pairs]
    while True:
        before = dict(active)
        for names, variables in read:
            found_in = {seed for name in variables for seed in active.get(name, ())}
            for name in names:
                if name in held:
                    continue
                seeds = found_in | {seed for seed in by if (name, seed) in given}
                have = active.get(name, ())
                found = tuple(seed for seed in by if seed in have or seed in seeds)
                if found:
                    active[name] = found
        if active == before:
            return


def variables_of(node: ast.AST) -> Iterator[str]:
    """Yield the variables through which an expression can depend on seeds: none of conditions and indices."""
    left: list[Any] = [node]
    for part in left:  # grows
        kind = type(part)
        if kind is ast.Name:
            yield part.id
        elif kind is ast.BinOp:
            left += (part.left, part.right)
        elif kind is ast.Subscript:
            left.append(part.value)
        elif kind is ast.IfExp:
            left += (part.body, part.orelse)
        elif kind is ast.Call:
            left += () if name_of(part) in FLAT | {"int", "len", "range"} else part.args
        elif kind is ast.BoolOp:  # gives one of its values
            left += part.values
        elif kind not in (ast.Constant, ast.Compare) and not (kind is ast.UnaryOp and type(part.op) is ast.Not):
            left += ast.iter_child_nodes(part)


def seeds_of(node: ast.AST, active: Mapping[str, tuple[str, ...]]) -> set[str]:
    """Return the seeds on which an expression depends, ignoring conditions and indices."""
    return {seed for name in variables_of(node) for seed in active.get(name, ())}
