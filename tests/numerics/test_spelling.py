"""Trees are spelled so that Python reads the same trees again, as `ast.unparse` does; that one writes what is left."""

import ast
import random

import pytest
from each_row import each_row

from screwsim.numerics import spelling
from screwsim.numerics.spelling import lines_of, text_of

STATEMENTS = (
    "a = b = x",
    "a, b = f(x, y[i, j + 1], z[0])",
    "y[at + S_T] += -x",
    "a -= (b, c)[0]",
    "def f(x, y):\n    if x > 0.0:\n        return x\n    elif y:\n        pass\n    else:\n        return (x, -y)",
    "if x:\n    return",
    "while True:\n    if x < 1e-300 or not y:\n        break\n    else:\n        if z:\n            continue",
    "for i in range(0, N, 2):\n    f(i)",
)
LEFT = (  # what is not written here
    "(a,) = x",
    'def f(x):\n    """Return x."""\n    return x',
    "for a, b in ((1, 2), (3, 4)):\n    f(a, b)",
    "x = y[1:n] if a is b else [c]",
    "x = f(a, b=1) @ c",
    "x = 1e999",
)


def same(text, tree):
    return ast.dump(ast.parse(text)) == ast.dump(ast.parse(ast.unparse(tree)))


@each_row("text", STATEMENTS + LEFT)
def test_statements_are_read_again(text):
    [tree] = ast.parse(text).body
    assert same("\n".join(lines_of(tree)), tree)


@each_row("text", STATEMENTS)
def test_what_kernels_are_made_of_is_written_here(text, monkeypatch):
    [tree] = ast.parse(text).body
    monkeypatch.setattr(spelling.ast, "unparse", None)
    assert lines_of(tree)


@pytest.mark.parametrize("text", LEFT)
def test_a_tree_built_without_lines_is_left_as_well(text):
    [tree] = ast.parse(text).body
    bare = ast.parse(text).body[0]
    for node in ast.walk(bare):
        if isinstance(node, ast.stmt):
            del node.lineno
    assert same("\n".join(lines_of(bare)), tree)


def any_tree(draw, depth):
    """Return a random expression of operators that hold together more and less tightly."""
    if depth == 0:
        return draw.choice([ast.Name("x", ast.Load()), ast.Constant(2), ast.Constant(0.5), ast.Constant(True)])

    def inner():
        return any_tree(draw, depth - 1 - draw.randrange(2) if depth > 1 else 0)

    two = [ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow]
    kinds = {
        "two": lambda: ast.BinOp(inner(), draw.choice(two)(), inner()),
        "one": lambda: ast.UnaryOp(draw.choice([ast.USub, ast.UAdd, ast.Not])(), inner()),
        "compared": lambda: ast.Compare(
            inner(), [draw.choice([ast.Lt, ast.Eq, ast.GtE])(), ast.Gt()], [inner(), inner()]
        ),
        "both": lambda: ast.BoolOp(draw.choice([ast.And, ast.Or])(), [inner() for _ in range(draw.randint(2, 5))]),
        "choice": lambda: ast.IfExp(inner(), inner(), inner()),
        "call": lambda: ast.Call(ast.Attribute(ast.Name("math", ast.Load()), "f", ast.Load()), [inner(), inner()], []),
        "part": lambda: ast.Subscript(inner(), ast.Tuple([inner(), inner()], ast.Load()), ast.Load()),
        "tuple": lambda: ast.Tuple([inner(), inner()], ast.Load()),
    }
    return kinds[draw.choice([*["two"] * 5, *kinds])]()


def test_expressions_have_the_parentheses_that_they_need():
    draw = random.Random(7)
    for _ in range(1500):
        tree = any_tree(draw, 4)
        assert ast.dump(ast.parse(text_of(tree), mode="eval").body) == ast.dump(tree), ast.unparse(tree)
