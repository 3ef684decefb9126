"""Loops of a user's own kernels that may never end: refused where that is certain, limited otherwise.

Compiled code cannot be interrupted from within, and a cycle that waits for it prints nothing. A `while` whose condition
reads nothing that the loop changes, and that nothing leaves, is refused. Every other one, in a kernel that returns a
single number, counts its iterations. Beyond `MOST_ROUNDS` in one call it raises an error while the machine is built;
compiled it returns NaN, which fails the case with a message that names effect and angle. An integrator, which returns
several values, may take as many steps as it likes.
"""

import ast
from collections.abc import Callable
from typing import Any

MOST_ROUNDS = 100_000  # iterations of a call's `while` loops, 0.1 ms in all; a law is called 10 000 times
ROUNDS = "rounds_of_its_loops"


def bounded(function: Callable[..., Any], source: str, returns_one: Callable[[str], bool]) -> tuple[Any, str]:
    """Return a kernel's function and text with its `while` loops limited; unchanged where there is nothing to limit.

    `returns_one` tells whether a function that the kernel calls returns a single number. Beyond the limit the function
    raises RuntimeError, and the text returns NaN. Raise TypeError for a loop that cannot end.
    """
    first = function.__code__.co_firstlineno
    tree = ast.parse(source)
    node = tree.body[0]
    loops = [each for each in ast.walk(tree) if isinstance(each, ast.While)]
    if not loops or not isinstance(node, ast.FunctionDef):
        return function, source
    for loop in loops:
        if _endless(loop):
            what = f"its loop in line {first + loop.lineno - 1} never ends, nothing in it changes its condition"
            raise TypeError(f"kernel {node.name}: {what}")
    returned = [each.value for each in ast.walk(node) if isinstance(each, ast.Return)]
    if not returned or not all(_one_number(each, returns_one) for each in returned) or function.__code__.co_freevars:
        return function, source
    node.decorator_list = []
    node.body.insert(int(ast.get_docstring(node) is not None), *ast.parse(f"{ROUNDS} = 0").body)
    inside = [loop.body for loop in loops]
    for loop, body in zip(loops, inside, strict=True):
        loop.body = [*_counted("return math.nan"), *body]
    text = ast.unparse(ast.fix_missing_locations(tree)) + "\n"
    for loop, body in zip(loops, inside, strict=True):
        what = f"its loop in line {first + loop.lineno - 1} goes round more than {MOST_ROUNDS} times"
        loop.body = [*_counted(f"raise RuntimeError({f'kernel {node.name}: {what}'!r})"), *body]
    space: dict[str, Any] = {}
    ast.increment_lineno(ast.fix_missing_locations(tree), first - 1)
    exec(compile(tree, function.__code__.co_filename, "exec"), function.__globals__, space)
    return space[node.name], text


def _counted(otherwise: str) -> list[ast.stmt]:
    """Return statements that count an iteration, and execute `otherwise` beyond the limit."""
    return ast.parse(f"{ROUNDS} += 1\nif {ROUNDS} > {MOST_ROUNDS}:\n    {otherwise}").body


def _endless(loop: ast.While) -> bool:
    """Tell whether nothing leaves a loop, and nothing in it changes what its condition reads."""
    inside = [node for each in loop.body for node in ast.walk(each)]
    if any(isinstance(node, ast.Return | ast.Break | ast.Raise) for node in inside):
        return False
    condition = list(ast.walk(loop.test))
    if isinstance(loop.test, ast.Constant):
        return bool(loop.test.value)
    if any(isinstance(node, ast.Call | ast.Subscript | ast.Attribute) for node in condition):
        return False  # the condition may change elsewhere
    read = {node.id for node in condition if isinstance(node, ast.Name)}
    changed = {node.id for node in inside if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    return not read & changed


def _one_number(returned: ast.expr | None, returns_one: Callable[[str], bool]) -> bool:
    """Tell whether an expression is certainly a single float."""
    match returned:
        case ast.Constant(value=float()) | ast.BinOp() | ast.UnaryOp(operand=ast.BinOp() | ast.Name()) | ast.Name():
            return True
        case ast.Call(func=ast.Attribute(value=ast.Name(id="math"))):
            return True
        case ast.Call(func=ast.Name(id=name)):
            return returns_one(name)
        case ast.IfExp(body=yes, orelse=no):
            return _one_number(yes, returns_one) and _one_number(no, returns_one)
    return False
