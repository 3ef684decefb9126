"""The text of syntax trees as `ast.unparse` writes it, in a fraction of its time: for statements as kernels have them.

Whatever is not among these is left to `ast.unparse`.
"""

import ast
from collections.abc import Sequence

# how tightly an expression holds together, from a choice to a name
_CHOICE, _OR, _AND, _NOT, _COMPARED, _PART, _, _, _, _SUM, _TERM, _FACTOR, _POWER, _ATOM = range(14)
_OPERATORS: dict[type, tuple[str, int]] = {
    ast.Add: (" + ", _SUM),
    ast.Sub: (" - ", _SUM),
    ast.Mult: (" * ", _TERM),
    ast.Div: (" / ", _TERM),
    ast.FloorDiv: (" // ", _TERM),
    ast.Mod: (" % ", _TERM),
}
_AUGMENTED = {kind: f" {text.strip()}= " for kind, (text, _) in _OPERATORS.items()}
_COMPARISONS = {ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}


class _Other(Exception):
    """A node that is not written here."""


def lines_of(node: ast.stmt) -> list[str]:
    """Return the lines of a statement."""
    found: list[str] = []
    try:
        _statement(node, "", found)
    except _Other:
        for each in ast.walk(node):
            if isinstance(each, ast.stmt):
                each.lineno = 0  # the only position that `ast.unparse` needs, which a tree built here lacks
        return ast.unparse(node).splitlines()
    return found


def text_of(node: ast.expr) -> str:
    """Return the text of an expression."""
    try:
        return _expression(node, _CHOICE)
    except _Other:
        return ast.unparse(node)


def _statement(node: ast.stmt, edge: str, found: list[str]) -> None:
    kind = type(node)
    if kind is ast.Assign:
        targets = "".join([f"{_target(each)} = " for each in node.targets])  # type: ignore[attr-defined]
        found.append(f"{edge}{targets}{_expression(node.value, _CHOICE)}")  # type: ignore[attr-defined]
        return
    match node:
        case ast.AugAssign(target=target, op=op, value=value) if type(op) in _AUGMENTED:
            found.append(f"{edge}{_expression(target, _CHOICE)}{_AUGMENTED[type(op)]}{_expression(value, _CHOICE)}")
        case ast.If():
            _if(node, edge, found)
        case ast.For(target=ast.Name(id=name), iter=values, body=body, orelse=[]):
            found.append(f"{edge}for {name} in {_expression(values, _CHOICE)}:")
            _body(body, edge, found)
        case ast.While(test=test, body=body, orelse=[]):
            found.append(f"{edge}while {_expression(test, _CHOICE)}:")
            _body(body, edge, found)
        case ast.Return(value=value):
            found.append(f"{edge}return" + ("" if value is None else f" {_expression(value, _CHOICE)}"))
        case ast.Expr(value=ast.Call() as call):
            found.append(f"{edge}{_expression(call, _CHOICE)}")
        case ast.FunctionDef(
            name=name, args=ast.arguments(args=arguments, defaults=[]), body=body, decorator_list=[]
        ) if not ast.get_docstring(node, clean=False):
            found.append(f"{edge}def {name}({', '.join([each.arg for each in arguments])}):")
            _body(body, edge, found)
        case ast.Pass():
            found.append(f"{edge}pass")
        case ast.Break():
            found.append(f"{edge}break")
        case ast.Continue():
            found.append(f"{edge}continue")
        case _:
            raise _Other


def _body(body: Sequence[ast.stmt], edge: str, found: list[str]) -> None:
    for each in body:
        _statement(each, f"{edge}    ", found)


def _if(node: ast.If, edge: str, found: list[str]) -> None:
    head = "if"
    while True:
        found.append(f"{edge}{head} {_expression(node.test, _CHOICE)}:")
        _body(node.body, edge, found)
        match node.orelse:
            case [ast.If() as node]:
                head = "elif"
            case []:
                return
            case other:
                found.append(f"{edge}else:")
                _body(other, edge, found)
                return


def _target(node: ast.expr) -> str:
    if type(node) is ast.Tuple and len(node.elts) > 1:
        return ", ".join([_expression(each, _CHOICE) for each in node.elts])
    return _expression(node, _CHOICE)


def _expression(node: ast.expr, hold: int) -> str:
    """Return the text of an expression, in parentheses where it holds together less tightly than asked."""
    kind = type(node)
    if kind is ast.Name:
        return node.id  # type: ignore[attr-defined]
    if kind is ast.BinOp:
        return _operation(node, hold)  # type: ignore[arg-type]
    match node:
        case ast.Constant(value=bool() | int() as value):
            return repr(value)
        case ast.Constant(value=float() as value) if abs(value) < float("inf"):
            return repr(value)
        case ast.UnaryOp(op=ast.USub() | ast.UAdd() as op, operand=operand):
            text = f"{'-' if type(op) is ast.USub else '+'}{_expression(operand, _FACTOR)}"
            return f"({text})" if hold > _FACTOR else text
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            text = f"not {_expression(operand, _NOT)}"
            return f"({text})" if hold > _NOT else text
        case ast.Subscript(value=of, slice=ast.Tuple(elts=[_, *_] as indices)):
            inside = [_expression(each, _CHOICE) for each in indices]
            return (
                f"{_expression(of, _ATOM)}[{inside[0]},]"
                if len(inside) == 1
                else (f"{_expression(of, _ATOM)}[{', '.join(inside)}]")
            )
        case ast.Subscript(value=of, slice=index):
            return f"{_expression(of, _ATOM)}[{_expression(index, _CHOICE)}]"
        case ast.Call(func=function, args=arguments, keywords=[]):
            inside = ", ".join([_expression(each, _CHOICE) for each in arguments])
            return f"{_expression(function, _ATOM)}({inside})"
        case ast.Attribute(value=ast.Name(id=of), attr=name):
            return f"{of}.{name}"
        case ast.Compare(left=left, ops=ops, comparators=others) if all(type(op) in _COMPARISONS for op in ops):
            parts = [_expression(left, _PART)]
            for op, each in zip(ops, others, strict=True):
                parts += [_COMPARISONS[type(op)], _expression(each, _PART)]
            text = " ".join(parts)
            return f"({text})" if hold > _COMPARED else text
        case ast.BoolOp(op=op, values=values):
            word, own = (" and ", _AND) if isinstance(op, ast.And) else (" or ", _OR)
            text = word.join([_expression(each, own + k) for k, each in enumerate(values, 1)])
            return f"({text})" if hold > own else text
        case ast.IfExp(test=test, body=body, orelse=other):
            text = f"{_expression(body, _OR)} if {_expression(test, _OR)} else {_expression(other, _CHOICE)}"
            return f"({text})" if hold > _CHOICE else text
        case ast.Tuple(elts=[_, _, *_] as elements):
            return f"({', '.join([_expression(each, _CHOICE) for each in elements])})"
    raise _Other


def _operation(node: ast.BinOp, hold: int) -> str:
    found = _OPERATORS.get(type(node.op))
    if found is not None:
        sign, own = found
        text = f"{_expression(node.left, own)}{sign}{_expression(node.right, own + 1)}"
    elif type(node.op) is ast.Pow:
        own = _POWER
        text = f"{_expression(node.left, _ATOM)} ** {_expression(node.right, _POWER)}"
    else:
        raise _Other
    return f"({text})" if hold > own else text
