"""What a user's kernel may say gives Python's numbers: compiled, and in lanes that take different ways."""

import math
import random
import re

import numpy as np
import pytest
from lanes_of_text import ALL, HEADER, in_lanes
from random_kernels import kernel_of, numbers_of, texts

from screwsim.codegen.kinds import LANES
from screwsim.codegen.modules import Module, load, module_name
from screwsim.codegen.program import CannotCompile
from screwsim.numerics.derivative import tangent
from screwsim.numerics.kernel import flatten, kernel

TABLES = """
TABLE = np.array([1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0])
SQUARE = np.array([[1.0, 2.0, 4.0], [8.0, 9.0, 10.0]])
WHOLES = np.array([3, 1, 2])
"""
# loops whose counter, or what a loop sets, is read behind them
COUNTERS = {
    "for, break": """
    for i in range(20):
        x += 0.3
        if x > y:
            break
    return x + i
""",
    "for, break, set before": """
    i = -5
    for i in range(int(abs(3.0 * y))):
        x += 0.5
        if x > 1.5:
            break
    return x + 10.0 * i
""",
    "for in a branch": """
    i = 7
    if x > y:
        for i in range(3):
            x += 0.1 * i
    return x + i
""",
    "for, continue": """
    n = 0
    for i in range(9):
        x += 0.3
        if x < y:
            continue
        n += i
        if n > 9:
            break
    return n + 100.0 * i
""",
    "for down, over a lane's range": """
    s = 0.0
    for i in range(int(abs(3.0 * y)) + 1, int(abs(x)), -1):
        s += i
        if s > 5.0:
            break
    return s
""",
    "while, break": """
    i = 0
    while i < 20 and not x > 4.0:
        x += 0.3
        if x > y:
            break
        i += 1
    return x + i
""",
    "nested, inner counter": """
    j = 0
    for i in range(6):
        for j in range(i):
            x += 0.2
        if x > y:
            break
    return x + 10.0 * j + 100.0 * i
""",
    "nested, both left": """
    c = 0
    for i in range(4):
        for j in range(5):
            if j > x + i:
                break
            if x * j > 3.0 - y:
                continue
            for k in range(3):
                c += 1
                if c > 6 + y:
                    break
        if i * j > 6:
            break
    return float(c + 100 * i + 1000 * j)
""",
    "nested, one name": """
    s = 0.0
    for i in range(3):
        for i in range(5):
            if x + i > y:
                break
        s += i
    return s + 10.0 * i
""",
    "read when the next one begins": """
    s, i = 0.0, 0
    while s < 9.0:
        s += 1.0 + i
        for i in range(4):
            if x + i > y:
                break
    return s + i
""",
    "counts on": """
    for i in range(5):
        if x + 0.3 * i > y:
            break
    n = 0
    while i < 7:
        i += 1
        if x * i > 6.0:
            continue
        for j in range(i, 0, -2):
            n += j
            if j * x > 2.0:
                break
    return n + 0.1 * i
""",
    "as bound, in a tuple, handed on": """
    for i in range(4):
        if x + i > y:
            break
    n = 0
    for k in range(i + 1):
        n += k
    best = (i, x)
    for k in range(6):
        z = math.sin(k * x + y)
        if z > best[1]:
            best = (k, z)
        if z < -0.9:
            break
    return square(i) + 10.0 * best[0] + best[1] + 100.0 * n + k
""",
    "as index": """
    for i in range(5):
        if x + 0.4 * i > y:
            break
    return TABLE[i] + TABLE[i + 1] * x + SQUARE[i % 2, i // 2]
""",
    "return from the depth": """
    for i in range(4):
        for t in (x, y, 0.5):
            for k in range(3):
                if t * k > y:
                    return t * k + i
                if t > 1.0 and k == 1:
                    break
                if t < -1.0:
                    continue
                x += 0.05 * k
        if x > 1.5:
            break
    return x + i
""",
    "no round, another kind before": """
    for y in range(int(x + 1.0)):
        if y > 1:
            break
    return float(y)
""",
    "name of an argument": """
    s = 0.0
    for x in range(4):
        s += x * y
        if s > 2.0:
            break
    return s + x
""",
    "counter changed in the loop": """
    s = 0
    for i in range(6):
        i = 2 * i
        if x + i > y:
            i += 1
        s += i
    return s + 100.0 * i
""",
}
OTHERS = {
    "values of a loop that sets them": """
    s = y
    for t in (x, s, 0.5):
        s = s + t
        for u, k in ((s, 1), (t, int(x))):
            t = u * k
            if t > 2.0:
                break
    return s + t
""",
    "and, or of numbers": """
    i = int(x)
    a = i and y
    b = (i > 0) and y
    c = x or y or 3
    d = (x > 0.0 or y > 0.0) and (x and y)
    flag = x > y
    g = flag and i
    if i and y or flag and not a:
        g = g + 1
    while c and c < 5.0:
        c = c + 1.0
    return a + 2.0 * b + 4.0 * c + 8.0 * d + (not (i and flag)) + 16.0 * g
""",
    "tuples in branches": """
    if x > y:
        t = (x, 1)
    elif y > 0.0:
        t = (2, y)
    else:
        t = (0.5, 0.25)
    a, b = t
    a, b = b, a
    c, d = (x, 1) if x > 0.0 else (y, 2)
    return a + 2 * b + t[-1] + (c if d == 1 else -c)
""",
    "augmented in branches": """
    a, b = 1, 2.0
    if x > y:
        a += 1
        b *= x
        if x > 1.0:
            a -= 5
            b /= 3
    else:
        b -= a
        a *= 3
    c = d = a
    d += 1
    return a + b + c - 3 * d
""",
    "truths and wholes": """
    b = x > y or y > 1.0
    i, j = int(5.0 * x), int(3.0 * y) or 1
    s = x * b + (y > 0.0) - (not b) - (-(x > y))
    s += i // j + 10 * (i % j) + i / j + i // 3 + i % 3 + i // -3 + i % -2
    return s + int(-y) + 100 * math.floor(x) + max(x, i, 0) - 2 * min(i, y, 1)
""",
    "from the end of an array": """
    i = -1 if x > y else 1
    return TABLE[i] + SQUARE[i][i] + SQUARE[-1][-2] + SQUARE[i, -i] + TABLE[-i - 1]
""",
    "a loop that only returns end": """
    n = 0
    while True:
        n += 1
        m = 0
        while m < n:
            m += 1
            if x + 0.1 * m * n > y:
                return n + 0.1 * m
            if m > 3:
                break
        if n > 7:
            return -1.0
""",
    "slices": """
    n, last = 0, 0.0
    for i in range(9):
        part = TABLE[i - 3 : i]
        n += part.shape[0] + TABLE[i:2].shape[0] + SQUARE[-i:].shape[0]
        for k in range(part.shape[0]):
            last += part[k] * x
    tail = TABLE[5:12]
    return n + last + 100.0 * tail.shape[0] + tail[-1] + SQUARE[1:][0, 2] + TABLE[3:-9].shape[0] + TABLE[9:].shape[0]
""",
    "chained": """
    return 1.0 if -1.0 <= x < y != 0.5 < 2.0 else 0.0
""",
}


HELPERS = """
def user_m__square(i):
    return i * i

def user_m__at(i):
    return TABLE[i]

def user_m__row(i):
    return SQUARE[i]

def user_m__parts(i, j):
    return i // j, i % j, TABLE[i]

def user_m__wholes(i, j):
    return WHOLES[i + j]
"""


def own(body):
    """Return the text of a user's kernel of x and y, and of what calls it."""
    called = re.sub(r"\b(square|at|row|parts|wholes)\(", r"user_m__\1(", body)
    return f"{TABLES}{HELPERS}\ndef user_m__law(x, y):{called}\n\ndef f(x, y):\n    return user_m__law(x, y)\n"


def checked(text):
    """Return the module of a text, compiled with checks of every index."""
    return Module(module_name(text, "statements"), HEADER + text, checks=True)


def compare(text, rng, rounds, rel=0.0, name="f", results=1):
    """Compare a function of a text with what Python makes of it, one by one and in lanes, some of them at rest."""
    names = {}
    exec(HEADER + text, names)
    compiled = getattr(checked(text), name)
    for _ in range(rounds):
        x, y = rng.uniform(-2.0, 3.0, (2, LANES))
        x[1], y[2], y[3] = 0.0, 1.0, x[3]
        mask = int(rng.integers(1, ALL + 1))
        pairs = list(zip(x.tolist(), y.tolist(), strict=True))
        together = in_lanes(text, x, y, mask=mask, results=results, name=name)
        for lane, pair in enumerate(pairs):
            expected = numbers_of(names[name], *pair)
            if expected is not None:
                assert numbers_of(compiled, *pair) == pytest.approx(expected, rel=rel, abs=rel), pair
                assert not mask >> lane & 1 or together[:, lane] == pytest.approx(expected, rel=rel, abs=rel), pair


@pytest.mark.parametrize("body", [*COUNTERS.values(), *OTHERS.values()], ids=[*COUNTERS, *OTHERS])
def test_compiled_and_in_lanes_a_kernel_gives_the_bits_of_python(body):
    compare(own(body), np.random.default_rng(5), 12)


POWERS = """
    n, m = 2.0, int(y)
    s = (x + 0.001) ** m + 2 ** y + x ** n + (x - y) ** 3.0 + abs(x) ** -1.5 if x else 0.0
    for k in range(5):
        s += y * x ** k
    if y < 1.0:
        n = 0.0
    return s + max(x, 0.0) ** n
"""


def test_a_power_in_lanes_is_that_of_any_base():
    """To the rounding that `codegen.lane_math` states; also of nothing, and below zero to a whole exponent."""
    compare(own(POWERS), np.random.default_rng(5), 12, rel=1e-13)


@pytest.mark.parametrize("seed", range(12))
def test_random_kernels_give_the_bits_of_python(seed):
    compare(texts(random.Random(seed)), np.random.default_rng(seed), 4)


ARRAYS = {
    "a row in a branch": """
    row = SQUARE[0]
    if x > y:
        row = SQUARE[1]
    return row[2] * x
""",
    "a row in a loop": """
    for i in range(2):
        row = SQUARE[i]
        if row[0] > x:
            break
    return row[1] * x
""",
    "one of two": """
    row = TABLE if x > y else SQUARE[0]
    return row[1] * x
""",
    "in a tuple": """
    t = (TABLE, 1)
    if x > y:
        t = (SQUARE[1], 2)
    return t[0][1] * t[1] * x
""",
}


@pytest.mark.parametrize("body", ARRAYS.values(), ids=ARRAYS)
def test_lanes_refuse_what_chooses_between_arrays(body):
    """So that such points are computed one by one, which gives the bits of Python."""
    names = {}
    exec(HEADER + own(body), names)
    compiled = checked(own(body)).f
    for pair in np.random.default_rng(5).uniform(-2.0, 3.0, (20, 2)).tolist():
        assert compiled(*pair) == names["f"](*pair)
    with pytest.raises(CannotCompile, match="user_m__law: lanes cannot choose between arrays"):
        in_lanes(own(body), np.ones(LANES), np.ones(LANES))


@pytest.mark.parametrize("seed", range(0, 12, 2))
def test_derivatives_of_random_kernels_have_the_bits_of_python(seed):
    both = tangent(kernel_of(random.Random(seed)), ("x", "y"))
    text = "\n\n".join(flatten((both,)).values()) + "\n"
    compare(text, np.random.default_rng(seed), 2, name=both.flat_name, results=3)


FAILS = {
    "index": "\n    return TABLE[int(4.0 * x)] * y\n",
    "rows": "\n    return SQUARE[int(x)][int(2.0 * y)] + SQUARE[int(y), int(x)]\n",
    "of whole numbers": "\n    return WHOLES[int(2.0 * x)]\n",
    "in a branch, of no matter": """
    z = 0.0
    if x > y:
        z = TABLE[int(6.0 * y)]
    return x if z > 1.0 else y
""",
    "in a loop": """
    for i in range(12):
        if TABLE[i] * 0.03 > x:
            break
    return x + i
""",
    "only where both hold": "\n    return 1.0 if x > 0.0 and TABLE[int(5.0 * x)] > y else 2.0\n",
    "quotient": "\n    return 0.5 + int(9.0 * x) // int(y)\n",
    "remainder": "\n    j = int(y)\n    return 0.5 if 7 % j == 0 else 2.0\n",
    "by a truth": "\n    return 0.5 + int(9.0 * x) // (x > y)\n",
    "in a helper": "\n    return 1.0 if at(int(6.0 * x)) > y else 2.0\n",
    "in one of its values": "\n    a, b, c = parts(int(2.0 * x), int(y))\n    return 1.0 if a > b else 2.0\n",
    "in whole numbers": "\n    return max(wholes(int(x), int(y)), 2)\n",
    "slice, item": "\n    s = TABLE[4:]\n    return s[int(3.0 * abs(x))] + TABLE[9:][int(x)] if x > y else s[int(x)]\n",
    "int": "\n    return 1.0 + min(int(math.inf if x > y else x), 3)\n",
    "floor": "\n    return 1.0 + min(math.floor(math.inf - math.inf if x > y else x), 3)\n",
}
NONE = (IndexError, ZeroDivisionError, OverflowError, ValueError)


@pytest.mark.parametrize("body", FAILS.values(), ids=FAILS)
def test_what_python_refuses_is_no_number(body):
    """Nor where what was read, divided or rounded is only compared; other lanes keep their numbers."""
    names = {}
    exec(HEADER + own(body), names)
    compiled, rng, failed = load(HEADER + own(body), "statements").f, np.random.default_rng(7), 0
    for _ in range(6):
        x, y = rng.uniform(-2.0, 3.0, (2, LANES))
        mask = int(rng.integers(1, ALL + 1))
        together = in_lanes(own(body), x, y, mask=mask)[0]
        for lane, pair in enumerate(zip(x.tolist(), y.tolist(), strict=True)):
            try:
                expected = float(names["f"](*pair))
            except NONE:
                expected, failed = math.nan, failed + 1
            assert compiled(*pair) == pytest.approx(expected, rel=0.0, abs=0.0, nan_ok=True), pair
            if mask >> lane & 1:
                assert together[lane] == pytest.approx(expected, rel=0.0, abs=0.0, nan_ok=True), pair
    assert 0 < failed < 6 * LANES


MORE_THAN_64_BITS = {
    "product": "i = int(x)\n    for k in range(60):\n        i = i * 3\n    return 1.0 if i > 0 else 2.0",
    "power": "return 1.0 if int(1e7 * x) ** 3 > 0 else 2.0",
    "sum": "return 1.0 if int(9e18) + int(9e17 * x) > 0 else 2.0",
    "difference": "return 1.0 if -int(9e18) - int(9e17 * x) > 0 else 2.0",
    "int": "return 1.0 if int(1e19 * x) > 0 else 2.0",
}


@pytest.mark.parametrize("body", MORE_THAN_64_BITS.values(), ids=MORE_THAN_64_BITS)
def test_a_whole_number_of_more_than_64_bits_is_none(body):
    text = own(f"\n    {body}\n")
    compiled, x = load(HEADER + text, "statements").f, np.arange(LANES) % 2 + 0.0
    assert compiled(0.0, 1.0) in (1.0, 2.0)
    assert math.isnan(compiled(1.0, 1.0))
    assert np.isnan(in_lanes(text, x, x)[0]).tolist() == [False, True] * (LANES // 2)


def test_a_quotient_beyond_64_bits_is_no_number():
    text = own("\n    return 1.0 if int(x) // (int(y) - 2) > 0 else 2.0\n")
    least = -(2.0**63)
    assert math.isnan(load(HEADER + text, "statements").f(least, 1.0))
    found = in_lanes(text, np.full(LANES, least), np.arange(LANES) % 2 + 0.0)[0]
    assert np.isnan(found).tolist() == [False, True] * (LANES // 2)


STEPS = np.array([0.5, 2.0, 3.0])


@kernel
def stepped(x, y):
    return STEPS[int(x)] * x * y


def test_derivatives_of_what_python_refuses_are_no_numbers():
    both = tangent(stepped, ("x", "y"))
    compiled = getattr(load(HEADER + "\n\n".join(flatten((both,)).values()) + "\n", "statements"), both.flat_name)
    assert compiled(1.5, 2.0) == both(1.5, 2.0) == (6.0, 4.0, 3.0)
    assert all(map(math.isnan, compiled(3.5, 2.0)))


REFUSED = {
    "for i in range(3):\n        x += i\n    else:\n        x = 0.0\n    return x": "`else` of a loop is not compiled",
    "while x < 3.0:\n        x += 1.0\n    else:\n        x = 0.0\n    return x": "`else` of a loop is not compiled",
    "return math.log(x, 2.0)": "math.log of 2 numbers is not compiled, in 'math.log(x, 2.0)'",
    "return math.hypot(x, 2.0, 1.0)": "math.hypot of 3 numbers is not compiled",
    "return max(x)": "max of 1 numbers is not compiled",
    "return TABLE[-2:][0] * x": "this slice is not compiled",
}


@pytest.mark.parametrize("body", REFUSED)
def test_what_is_not_compiled_is_refused_alone_and_in_lanes(body):
    text = f"{TABLES}\ndef f(x):\n    {body}\n"
    with pytest.raises(CannotCompile, match=REFUSED[body].replace("(", r"\(").replace(")", r"\)")):
        load(HEADER + text, "statements").f(1.0)
    with pytest.raises(CannotCompile, match=REFUSED[body].replace("(", r"\(").replace(")", r"\)")):
        in_lanes(text, np.ones(LANES))


REFUSED_TO_USERS = {
    "TABLE[0] = x\n    return x": "a kernel of one's own changes no arrays; use numbers and tuples, in 'TABLE[0]'",
    "SQUARE[1][0] += x\n    return x": "changes no arrays",
    "a = np.zeros(2)\n    return a[0]": "makes no arrays; use numbers, tuples and arrays of the module",
    "a = np.empty((2, 2))\n    return x": "makes no arrays",
    "return TABLE[7] * x": "an index beyond the 7 items of the array, in 'TABLE[7]'",
    "return SQUARE[0][-4] * x": "an index beyond the 3 items of the array",
    "t = (x, 1.0)\n    return t[2]": "an index beyond the 2 items of the tuple, in 't[2]'",
    "return 1.0 + int(x) // 0": "a division by zero, in 'int(x) // 0'",
    "return 1.0 + 7 % 0": "a division by zero, in '7 % 0'",
    "return 1.0 * (int(x) * 10**20)": "a whole number of more than 64 bits, in '100000000000000000000'",
    "return 1.0 if int(x) < 2**64 else 2.0": "a whole number of more than 64 bits, in '18446744073709551616'",
    "return row(int(x))[0]": "no float is returned to show it, in 'return SQUARE[i]'",
    "return int(x), 1": "int() may fail here, and no float is returned to show it, in 'return (int(x), 1)'",
}


@pytest.mark.parametrize("body", REFUSED_TO_USERS)
def test_what_a_users_kernel_may_not_do_is_refused_alone_and_in_lanes(body):
    text, told = own(f"\n    {body}\n"), "user_m__(law|row): .*" + re.escape(REFUSED_TO_USERS[body])
    with pytest.raises(CannotCompile, match=told):
        load(HEADER + text, "statements").f(1.0, 2.0)
    with pytest.raises(CannotCompile, match=told):
        in_lanes(text, np.ones(LANES), np.ones(LANES))
