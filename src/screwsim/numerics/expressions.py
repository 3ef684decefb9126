"""Expressions as syntax trees: the pieces that `derivative` assembles from a kernel's source."""

import ast
import copy
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from screwsim.numerics.kernel import nodes

FLAT = {"floor", "ceil", "trunc"}  # functions of math whose derivative is zero
Expression = ast.expr
Slopes = dict[str, Expression]  # by variable, within a statement


def read(text: str, **parts: Expression) -> Expression:
    """Return an expression from its text, with names in it replaced by other expressions."""

    class Put(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> Any:
            return copy.deepcopy(parts.get(node.id, node))

    return Put().visit(ast.parse(text, mode="eval").body)


# derivative of each function of math, and of abs, by its argument u, where v is its value
SLOPES = {
    "sqrt": "0.5 / v if v > 0.0 else 0.0",
    "exp": "v",
    "expm1": "v + 1.0",
    "log": "1.0 / u",
    "log1p": "1.0 / (1.0 + u)",
    "log10": "0.4342944819032518 / u",
    "sin": "math.cos(u)",
    "cos": "-math.sin(u)",
    "tan": "1.0 + v * v",
    "atan": "1.0 / (1.0 + u * u)",
    "asin": "1.0 / math.sqrt(1.0 - u * u)",
    "acos": "-1.0 / math.sqrt(1.0 - u * u)",
    "sinh": "math.cosh(u)",
    "cosh": "math.sinh(u)",
    "tanh": "1.0 - v * v",
    **dict.fromkeys(("fabs", "abs"), "1.0 if u >= 0.0 else -1.0"),
    "cbrt": "1.0 / (3.0 * v * v)",
    "erf": "1.1283791670955126 * math.exp(-u * u)",
}
# those by both arguments u and w of functions of two
SLOPES_OF_TWO = {
    "atan2": ("w / (u * u + w * w)", "-u / (u * u + w * w)"),
    "hypot": ("u / v", "w / v"),
}


def each(slope: Callable[[str], Expression | None], *known: Slopes) -> Slopes:
    """Return {variable: slope(variable)} for every variable of some derivatives, leaving out None."""
    names = dict.fromkeys([name for some in known for name in some])
    return {name: found for name in names if (found := slope(name)) is not None}


def assigned(body: Sequence[ast.stmt]) -> Iterator[tuple[list[str], Expression]]:
    """Yield the names that each assignment of a body sets, or each loop, and its value."""
    for node in body:
        for part in nodes(node):
            if isinstance(part, ast.Assign):
                stored = [one for target in part.targets for one in nodes(target) if isinstance(one, ast.Name)]
                yield [one.id for one in stored if isinstance(one.ctx, ast.Store)], part.value  # no index of an array
            elif isinstance(part, ast.AugAssign) and isinstance(part.target, ast.Name):
                yield [part.target.id], ast.BinOp(ast.Name(part.target.id, ast.Load()), part.op, part.value)
            elif isinstance(part, ast.For):
                values = part.iter.elts if isinstance(part.iter, ast.Tuple) else [part.iter]
                yield from (pair for value in values for pair in matched(part.target, value))


def matched(target: Expression, value: Expression) -> Iterator[tuple[list[str], Expression]]:
    """Yield the names that a loop sets, each with its value where that is written out."""
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and len(target.elts) == len(value.elts):
        for one, item in zip(target.elts, value.elts, strict=True):
            yield from matched(one, item)
    else:
        yield [one.id for one in nodes(target) if isinstance(one, ast.Name)], value


def choice_of(node: ast.BoolOp) -> ast.IfExp:
    """Return `and` or `or` as the choice that it is: its first value if that decides, else what the others give."""
    first, *others = node.values
    other = others[0] if len(others) == 1 else ast.BoolOp(node.op, others)
    return ast.IfExp(first, other, first) if isinstance(node.op, ast.And) else ast.IfExp(first, first, other)


def name_of(node: ast.Call) -> str:
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def assign(name: str, value: Expression) -> ast.stmt:
    return ast.Assign([ast.Name(name, ast.Store())], value)


def target_of(names: Sequence[str]) -> Expression:
    found: list[Expression] = [ast.Name(name, ast.Store()) for name in names]
    return found[0] if len(found) == 1 else ast.Tuple(found, ast.Store())


def _is(node: Expression | None, value: float) -> bool:
    return isinstance(node, ast.Constant) and node.value == value


def is_unit(node: Expression) -> bool:
    """Tell whether an expression is the constant 1 or -1."""
    return _is(node, 1.0) or (isinstance(node, ast.UnaryOp) and _is(node.operand, 1.0))


def slope_name(name: str, seed: str) -> str:
    """Return the name of a variable's derivative by a seed."""
    return f"{name}__{seed}"


def negative(node: Expression) -> Expression:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return node.operand
    return ast.UnaryOp(ast.USub(), node)


def added(a: Expression | None, b: Expression | None, minus: bool = False) -> Expression | None:
    """Return a + b, or a − b, of derivatives, either of which may be None for zero."""
    if b is None:
        return a
    if a is None:
        return negative(b) if minus else b
    if isinstance(b, ast.UnaryOp) and isinstance(b.op, ast.USub):
        b, minus = b.operand, not minus
    return ast.BinOp(a, ast.Sub() if minus else ast.Add(), b)


def product(slope: Expression | None, factor: Expression | None) -> Expression | None:
    """Return a derivative times a factor, without factors of one; None where either is None for zero."""
    if slope is None or factor is None:
        return None
    if _is(slope, 1.0):
        return factor
    if isinstance(slope, ast.UnaryOp) and _is(slope.operand, 1.0):
        return negative(factor)
    return slope if _is(factor, 1.0) else ast.BinOp(slope, ast.Mult(), factor)
