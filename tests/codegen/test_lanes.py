"""Lanes: each does what the text says of its own numbers, whatever the others do beside it."""

import math

import numpy as np
import pytest
from each_row import each_row
from lanes_of_text import ALL, HEADER, in_lanes

from screwsim.codegen import lane_math, lane_rows
from screwsim.codegen.kinds import FLOATS, INTEGERS, LANES, Kind
from screwsim.codegen.modules import load
from screwsim.codegen.program import CannotCompile
from screwsim.numerics import history
from screwsim.numerics.kernel import flatten

RNG = np.random.default_rng(7)


def plain(text, name="f"):
    names = {}
    exec(HEADER + text, names)
    return names[name]


READ_HISTORY = """

def f(phi, middle, times, dense, steps, hint, out):
    i = history__locate(phi, middle, times, steps, hint)
    history__read(phi, times, dense, i, out)
    return float(i)
"""
# what lanes may do apart from each other; without exp, log and powers, whose bits are not those of the C library
TEXTS = {
    "branches": """
def f(x, y):
    z = 0.0
    if x > y:
        z = x - y
        if z > 1.0:
            z = 1.0 / z
    elif x < 0.0:
        z = -x
    else:
        y = 2.0 * y
    return z + y
""",
    "returns": """
def f(x, y):
    if x > y:
        return x
    for k in range(5):
        x += 0.5 * k
        if x > y:
            return x + k
    return y
""",
    "breaks": """
def f(x, y):
    k = 0
    while True:
        k += 1
        if k == 3:
            continue
        x += 0.25 * k
        if x > y or k > 9:
            break
    return x * k
""",
    "counts": """
def f(x, y):
    s = 0.0
    for k in range(int(4.0 + x), 9):
        for j in range(k):
            if j == 4:
                break
            s += j * y
    return s
""",
    "choices": """
def f(x, y):
    p = max(x, y, 0.25) - min(x, y) if x > 0.0 and not y > 1.0 else abs(x)
    return p if -1.0 < p <= 2.0 or x == y else math.sqrt(p)
""",
    "wholes": """
def f(x, y):
    i = int(8.0 * x)
    j = int(3.0 + y * y)
    return float(i // j + i % j - abs(i) + i // 4 + max(i, j)) + (x + 9.0) % 2.5
""",
    "arrays": """
TABLE = np.array([[1.0, 2.0, 4.0], [8.0, 16.0, 32.0]])
def g(row, k):
    return row[k] + row[-1]
def f(x, y):
    a = np.empty((2, 3))
    for i in range(2):
        for j in range(3):
            a[i, j] = TABLE[i, j] * x
    k = 1 if y > 0.0 else 0
    a[k, 2] = y
    if y > 1.0:
        a[1 - k, k] += 1.0
    return g(a[k], 1) + g(a[1], k) + TABLE[k, k] + a[0, 0]
""",
    "tables": """
TABLE = np.array([0.5, 1.5, -2.5, 3.5, 4.5, -5.5, 6.5, 7.5])
WHOLES = np.array([3, 1, 4, 1, 5, 9])
def f(x, y):
    i = min(max(int(2.0 * x), 0), 4)
    s = TABLE[i] + TABLE[i + 3] * (y + TABLE[i + 1]) - TABLE[i + 1 + 1]
    if y > 0.0:
        s += TABLE[WHOLES[i + 1] - 1 + -1] if WHOLES[i + 1] > 1 else TABLE[7]
    return s + TABLE[int(y) - int(y) + 2]
""",
    "chains": """
def g(x):
    return math.sqrt(x) + 1.0
def f(x, y):
    s = 0.0
    if 0.0 <= x < g(abs(y)) <= 2.4 != y:
        s = 1.0
    return s + (2.0 if y < x < g(x * x) else x)
""",
    "library": """
def f(x, y):
    return math.sin(x) + math.sinh(y) if x > y else math.tanh(x) + math.copysign(2.0, y)
""",
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_each_lane_gives_the_bits_that_python_gives(text):
    alone = plain(text)
    for _ in range(40):
        x, y = RNG.uniform(-2.0, 3.0, (2, LANES))
        y[0] = x[0]
        assert in_lanes(text, x, y)[0].tolist() == [alone(a, b) for a, b in zip(x.tolist(), y.tolist(), strict=True)]


@each_row("text", TEXTS.values(), ids=TEXTS)
def test_no_bit_of_a_lane_depends_on_the_others(text):
    x, y = RNG.uniform(-2.0, 3.0, (2, LANES))
    together = in_lanes(text, x, y)[0]
    for lane in range(LANES):
        others = RNG.uniform(-2.0, 3.0, (2, LANES))
        others[:, lane] = x[lane], y[lane]
        assert in_lanes(text, *others)[0, lane] == together[lane]
        others[:, np.arange(LANES) != lane] = np.nan
        assert in_lanes(text, *others, mask=1 << lane)[0, lane] == together[lane]


def spacings(found, exact):
    """Return the largest error in units of the last place."""
    return np.max(np.abs(found - exact) / np.spacing(np.abs(exact)))


# errors as stated in `codegen.lane_math`; the C library's own are half a unit and a little
@pytest.mark.parametrize(("name", "low", "high", "most"), [
    ("exp", -707.0, 709.0, 2.0), ("exp", -1.0, 1.0, 2.0),
    ("expm1", -700.0, 709.0, 2.5), ("expm1", -1.0, 1.0, 2.5), ("expm1", -1e-3, 1e-3, 2.0),
    ("log", 1e-307, 1e300, 2.0), ("log", 1e-3, 3.0, 3.0), ("log", 0.99, 1.01, 3.0),
])  # fmt: skip
def test_exponential_and_logarithm_are_right_to_the_last_digits(name, low, high, most):
    x = RNG.uniform(low, high, (200, LANES))
    found = np.array([in_lanes(f"def f(x):\n    return math.{name}(x)\n", row)[0] for row in x])
    assert spacings(found, getattr(np, name)(x)) <= most


def test_a_power_errs_by_the_logarithm_of_itself():
    x, y = RNG.uniform(0.1, 30.0, (200, LANES)), RNG.uniform(-9.0, 9.0, (200, LANES))
    found = np.array([in_lanes("def f(x, y):\n    return x ** y\n", *row)[0] for row in zip(x, y, strict=True)])
    exact = x**y
    assert np.all(np.abs(found / exact - 1.0) <= 2.3e-16 * (2.0 + 2.0 * np.abs(np.log(exact))))


def test_exponential_and_logarithm_at_their_ends():
    ends = [0.0, -800.0, 800.0, math.nan, math.inf, -math.inf, -708.5, 1.0]
    found = in_lanes("def f(x):\n    return math.exp(x)\n", ends)[0]
    np.testing.assert_array_equal(found[:7], [1.0, 0.0, math.inf, math.nan, math.inf, 0.0, 0.0])
    found = in_lanes("def f(x):\n    return math.expm1(x)\n", ends)[0]
    np.testing.assert_array_equal(found[:7], [0.0, -1.0, math.inf, math.nan, math.inf, -1.0, -1.0])
    found = in_lanes(
        "def f(x):\n    return math.log(x)\n", [0.0, -1.0, 1e-310, math.nan, math.inf, -math.inf, 1.0, 2.0]
    )
    np.testing.assert_array_equal(found[0, :7], [-math.inf, math.nan, -math.inf, math.nan, math.inf, math.nan, 0.0])


@pytest.mark.parametrize("name", ["exp", "expm1", "log"])
def test_the_functions_of_lanes_run_as_python_and_give_the_same_bits(name):
    x = RNG.uniform(0.01, 20.0, LANES)
    function = getattr(lane_math, f"{name}_of_lanes")
    found = in_lanes(f"def f(x):\n    return math.{name}(x)\n", x)[0]
    assert found.tolist() == [function(one) for one in x.tolist()]


def test_arrays_of_each_lane_and_arrays_side_by_side_are_written_where_lanes_are_at_work():
    text = "def f(a, b, x):\n    a[1] = 2.0 * a[0] + x\n    b[int(x)] += x\n    return x\n"
    one = Kind("f")
    entry = load(HEADER + text, "lanes").of_lanes("f", (Kind("p", (one,), 1), Kind("v", (one,), 1), FLOATS))
    beside, apart, x = np.ones((2, LANES)), [np.zeros(LANES + 1) for _ in range(LANES)], np.arange(1.0, LANES + 1.0)
    mask = 0b1011
    words = [mask, beside.ctypes.data, 2, *(each.ctypes.data for each in apart), LANES + 1, *x.view(np.int64)]
    given, out = np.array(words, np.int64), np.zeros(LANES)
    entry(given.ctypes.data, out.ctypes.data)
    works = np.array([bool(mask >> lane & 1) for lane in range(LANES)])
    assert beside[1].tolist() == np.where(works, 2.0 + x, 1.0).tolist()
    for lane, each in enumerate(apart):
        assert each[lane + 1] == (x[lane] if works[lane] else 0.0) and np.count_nonzero(each) == works[lane]


@pytest.mark.parametrize("columns", [1, 4, 8, 9, 19])  # a few by themselves, in one block, beside one
def test_histories_of_lanes_are_found_and_read_with_the_bits_of_one(columns):
    called = flatten((history.locate, history.read), {})
    text = "\n\n".join(called.values()) + READ_HISTORY
    times_of, dense_of, room_of = (Kind(name, (Kind("f"),), axes) for name, axes in (("v", 1), ("v", 3), ("p", 1)))
    kinds = (FLOATS, FLOATS, times_of, dense_of, INTEGERS, INTEGERS, room_of)
    entry = load(HEADER + text, "lanes").of_lanes("f", kinds)
    assert lane_rows.KINDS.keys() <= called.keys()
    for _ in range(30):
        steps = RNG.integers(1, 9, LANES)
        times = [np.cumsum(RNG.uniform(0.01, 0.4, 12)) for _ in range(LANES)]
        dense = [RNG.normal(size=(11, 4, columns)) for _ in range(LANES)]
        phi = np.array([RNG.uniform(t[0] - 0.05, t[n] + 0.05) for t, n in zip(times, steps, strict=True)])
        phi[0] = times[0][1]  # on a boundary: the middle decides
        middle, hints, mask = phi + RNG.choice([-0.1, 0.1], LANES), RNG.integers(0, 12, LANES), RNG.integers(1, ALL + 1)
        room, out = np.full((columns, LANES), -7.0), np.zeros(LANES)
        words = [mask, *phi.view(np.int64), *middle.view(np.int64)]
        words += [*(each.ctypes.data for each in times), 12, *(each.ctypes.data for each in dense), 11, 4, columns]
        given = np.array([*words, *steps, *hints, room.ctypes.data, columns], np.int64)
        entry(given.ctypes.data, out.ctypes.data)
        for lane in range(LANES):
            alone = np.full(columns, -7.0)
            if mask >> lane & 1:
                i = history.locate(phi[lane], middle[lane], times[lane], steps[lane], hints[lane])
                history.read(phi[lane], times[lane], dense[lane], i, alone)
                assert out[lane] == i
            assert room[:, lane].tolist() == alone.tolist()


def test_what_lanes_cannot_do_is_refused_with_its_line():
    with pytest.raises(CannotCompile, match=r"f: lanes have arrays of one size.*np.empty\(int\(x\)\)"):
        in_lanes("def f(x):\n    a = np.empty(int(x))\n    a[0] = x\n    return a[0]\n", np.ones(LANES))
