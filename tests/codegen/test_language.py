"""Compiled text gives what Python gives: the same bits, statement by statement, function by function."""

import math
import random
import re

import numpy as np
import pytest
from each_row import each_row

from screwsim.codegen.modules import Module, load
from screwsim.codegen.program import CannotCompile

HEADER = "import math\nimport numpy as np\n"


def both(text, name="f"):
    """Return the function of a text as Python runs it, and as it is compiled with checks of every index."""
    names = {}
    exec(HEADER + text, names)
    return names[name], getattr(Module("test", HEADER + text, checks=True), name)


def agree(text, *calls):
    plain, compiled = both(text)
    for arguments in calls:
        expected, found = plain(*arguments), compiled(*arguments)
        assert found == expected and type(found) is type(expected), (arguments, expected, found)


NUMBERS = [(-2.5, 3.0), (0.0, 1.0), (7.25, -0.5), (1e-300, 1e300), (4.0, 4.0)]
EXPRESSIONS = (
    "x + y * x - y / (x + 10.0)",
    "-x if x > y else +y",
    "abs(x) ** 2 + x ** 3 + (x + 5.0) ** -1 + (x * x) ** 0.5",
    "(1.0 + x * x) ** y if abs(y) < 10.0 else 0.0",
    "max(x, y) - min(x, y, 0.5)",
    "1.0 if 0.0 < x <= y or y == 4.0 and not x > 3.0 else 2.0",
    "math.sqrt(abs(x)) + math.exp(-abs(x)) + math.log(abs(x) + 1.0)",
    "math.sin(x) + math.cos(x) + math.tan(x) + math.atan2(x, y) + math.hypot(x, 1.0)",
    "math.expm1(x / (1.0 + abs(x))) + math.log1p(abs(x)) + math.tanh(x)",
    "float(math.floor(x / (1.0 + abs(x)))) + math.ceil(x / (1.0 + abs(x)))",
    "(x + 8.0) % 3.0 + (x - 8.0) % -3.0",
    "math.pi * x if x < math.inf else math.e",
)


@each_row("expression", EXPRESSIONS)
def test_expressions_of_floats(expression):
    agree(f"def f(x, y):\n    return float({expression})\n", *NUMBERS)


@each_row("expression", ["i // j", "i % j", "i * j - i", "abs(i) + max(i, j)", "i ** 3", "int(i / j)"])
def test_expressions_of_integers(expression):
    agree(f"def f(i, j):\n    return {expression}\n", *[(i, j) for i in range(-7, 8) for j in (-3, -1, 2, 5)])


CONSTANTS = """
def f(n, x):
    total = 0.0
    for i in range(n):
        part = np.zeros(max(2, 3))
        part[min(-1, 2)] = x
        total += float(part[2])
    for i in range(0, n, max(1, 2)):
        total += i
    return total + float(n ** max(2, 1))
"""


def test_the_larger_of_constants_is_a_constant():
    """As the size of an array, an index from its end, a step and a power, which have to be known to the compiler."""
    agree(CONSTANTS, (5, 0.5), (1000, 0.5))


LOOPS = """
SMALL = 3
TABLE = np.array([[1.0, 2.0], [3.0, 4.0]])
WHOLE = np.array([4, 5, 6])

def f(n, x):
    total = 0
    for i in range(n):
        if i == 2:
            continue
        if i > 6:
            break
        for k in range(SMALL, 0, -1):
            total += x * i * k + WHOLE[k - 1]
    j = 0
    while j < 2:
        for side in (-1.0, 1.0):
            if side > 0.0 and j == 1:
                continue
            total += side * TABLE[j, 1] - TABLE[j][0]
        j += 1
    return total, j, total > 3.0
"""


def test_loops_branches_and_what_becomes_a_float_later():
    agree(LOOPS, *[(n, x) for n in (0, 1, 5, 20) for x in (0.1, -3.0)])


ARRAYS = """
def fill(row, value):
    row[0] = value
    row[-1] += 2.0 * value
    return row.shape[0], len(row)

def f(context, a, counts):
    b, _unused, c = context
    n, m = a.shape
    own = np.empty((n, 2))
    clear = np.zeros(3)
    for i in range(n):
        own[i, 0] = i
        own[i, 1] = clear[i % 3] + b[i]
        fill(a[i], own[i, 1] + context[2][0])
    whole = b if n > 1 else c
    fill(whole[1:], 5.0)
    tail = c[1:3]
    tail[0], tail[1] = tail[1], tail[0]
    counts[0] += n * m
    x = 2.7
    x = int(x)
    total = 0.0
    for i in range(n):
        if i == 0:
            late = 0.0
        total += late
        late = own[i, 1]
    return fill(b, 1.0)[1] + counts[x - 1] + total
"""


def test_arrays_are_read_written_sliced_and_passed_on():
    plain, compiled = both(ARRAYS)
    results = []
    for function in (plain, compiled):
        parts = np.arange(4.0), np.ones(2), np.array([3.0, 1.0, 2.0])
        a, counts = np.arange(8.0).reshape(4, 2), np.array([7, 8])
        results.append((function(parts, a, counts), [part.tolist() for part in (*parts, a, counts)]))
    assert results[0] == results[1]


def test_random_expressions_give_the_bits_of_python():
    draw = random.Random(1)

    def expression(depth):
        if depth == 0:
            return draw.choice(["x", "y", "z", "0.5", "3.0"])
        a, b = expression(depth - 1), expression(depth - 1)
        kind = draw.randrange(6)
        if kind == 0:
            return f"({a} if {b} > 0.25 else {b})"
        if kind == 1:
            return f"max({a}, {b})"
        return f"({a} {'+-*/'[kind - 2]} {b})"

    text = "".join(f"    t{i} = {expression(4)}\n" for i in range(40))
    plain, compiled = both(f"def f(x, y, z):\n{text}    return {', '.join(f't{i}' for i in range(40))}\n")
    for _ in range(50):
        arguments = [draw.uniform(-2.0, 2.0) for _ in range(3)]
        try:
            expected = plain(*arguments)
        except ZeroDivisionError:
            continue
        assert compiled(*arguments) == expected


def test_an_index_beyond_its_array_is_told_with_checks():
    _, compiled = both("def f(a, i):\n    a[i] = 1.0\n    return a[0]\n")
    assert compiled(np.zeros(2), 1) == 0.0
    with pytest.raises(IndexError, match="beyond its array"):
        compiled(np.zeros(2), 2)
    assert compiled(np.zeros(2), 0) == 1.0


REFUSED = {
    "with x:\n        return 1.0": "this is not compiled, in 'with x:'",
    "return open(x)": "open is not compiled, in 'open(x)'",
    "return unknown": "unknown is not known",
    "return {1: x}": "this is not compiled",
    "y = nothing(x)\n    return y": "y is given nothing",
    "return x[0]": "1 indices of f are not compiled",
    "return TABLE[x]": "f is no whole number",
    "return x, y": "y is not known",
    "if x > 0.0:\n        y = 1.0\n    else:\n        y = TABLE\n    return 1.0": "y is f here and a1(f) there",
    "return f(x)": "f calls itself",
    "if 1 > 2:\n        y = 1.0\n    return y": "y is not known",
    "while y < x:\n        x = 0.5 * x\n    return y\n    y = 2.0": "y is not known",
    "return math.sqrt(x, key=1)": "arguments by name are not compiled",
    "return 2.0 // x": "// of floats is not compiled",
    "if x > 0.0:\n        return x": "it may end without a return",
    "for i in range(3):\n        return x": "it may end without a return",
    "while x > 0.0:\n        return x": "it may end without a return",
}


@each_row("body", REFUSED)
def test_what_is_not_compiled_is_refused_with_its_place(body):
    text = HEADER + f"TABLE = np.array([1.0, 2.0])\n\ndef nothing(x):\n    x = 1.0\n\ndef f(x):\n    {body}\n"
    with pytest.raises(CannotCompile, match=re.escape(REFUSED[body])):
        load(text, "test").f(1.0)


def test_a_text_of_more_than_functions_and_constants_is_refused():
    with pytest.raises(CannotCompile, match="line 1: 'del math' is not compiled"):
        load("del math\ndef f(x):\n    return x\n", "test").f(1.0)
    with pytest.raises(AttributeError, match="has no function 'g'"):
        load("def f(x):\n    return x\n", "test").g(1.0)


@each_row("given", [np.zeros(4)[::2], np.zeros((2, 2)).T, np.zeros(3, np.float32), np.array(1.0), "text", None])
def test_what_compiled_code_cannot_read_is_refused(given):
    with pytest.raises(TypeError, match="a compiled function takes"):
        load("def f(x):\n    return 1.0\n", "test").f(given)


def test_numbers_of_all_sorts_are_taken():
    f = load("def f(x):\n    return 2 * x\n", "test").f
    assert [f(1.5), f(np.float64(1.5)), f(np.int64(3)), f(3), f(True)] == [3.0, 3.0, 6, 6, 2]
    assert math.isnan(f(math.nan))


def test_an_array_is_found_where_it_is_now():
    """What takes the place of an array that is gone has its id, and not its numbers."""
    f = load("def f(a):\n    return a[0] + a.shape[0]\n", "test").f
    for size in range(1, 2000):
        a = np.full(size % 7 + 1, float(size))
        assert f(a) == size + size % 7 + 1
