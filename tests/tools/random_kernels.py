"""Random texts of kernels: statements of all kinds that compiled text may hold, in loops that end.

A text is a function `f(x, y)` and two that it calls: `g` returns a number, `h` a pair. Counters `i`, `j`, `k` are
always whole; other variables may be numbers of both kinds, counters of loops, and values that a loop goes over. There
are no powers, exponentials or logarithms, whose last bits are not those of Python.
"""

import random
from collections.abc import Callable
from typing import Any

import numpy as np

from screwsim.numerics.kernel import Kernel, written

NUMBERS = [0.5, -1.25, 2.0, 0.75, -0.3, 1.1, 3.0]
COUNTERS = ("i", "j", "k")
FLOATS = ("a", "b", "c", "x", "y")
LEAVE = ("break", "break", "continue", "return")
RANGES = ("3", "4", "2, 6", "5, 0, -1", "0")
LARGEST = 1e12  # numbers beyond are not compared


def numbers_of(function: Callable[..., Any], *arguments: float) -> tuple[float, ...] | None:
    """Return the numbers that a function returns; None where there are none, or large ones."""
    try:
        found = function(*arguments)
    except (ZeroDivisionError, OverflowError, ValueError):
        return None
    numbers = found if isinstance(found, tuple) else (found,)
    return numbers if all(not isinstance(each, complex) and abs(each) < LARGEST for each in numbers) else None


def texts(draw: random.Random) -> str:
    """Return the text of `f` and of what it calls."""
    return "\n".join([f"TABLE = np.array({NUMBERS})\n", *each_text(draw).values()])


def each_text(draw: random.Random) -> dict[str, str]:
    """Return the texts of the three functions by name, callees first."""
    return {
        "g": _Function(draw, False, 20).text("g"),
        "h": _Function(draw, False, 8).text("h", pair=True),
        "f": _Function(draw, True, 30).text("f"),
    }


def kernel_of(draw: random.Random) -> Kernel:
    """Return the kernel `f`."""
    uses: dict[str, Any] = {"TABLE": np.array(NUMBERS)}
    for name, text in each_text(draw).items():
        uses[name] = written(
            text, "random", {key: each for key, each in uses.items() if f"{key}(" in text or key == "TABLE"}
        )
    return uses["f"]


class _Function:
    """Draws a function; `left` is the number of statements after which no more branches and loops begin."""

    def __init__(self, draw: random.Random, calls: bool, left: int) -> None:
        self.draw, self.calls, self.left = draw, calls, left
        self.lines: list[str] = []
        self.loops = self.whiles = 0

    def text(self, name: str, pair: bool = False) -> str:
        self.pair = pair
        for line in ("a = x * 0.5", "b = 0.25", "c = y", *(f"{each} = {self.draw.randrange(3)}" for each in COUNTERS)):
            self.add(1, line)
        self.block(3, 1, self.draw.choice([2, 3, 4]))
        self.add(1, self.returned())
        return "\n".join([f"def {name}(x, y):", *self.lines, ""])

    def add(self, indent: int, line: str) -> None:
        self.lines.append("    " * indent + line)

    def returned(self) -> str:
        if self.pair:
            return f"return {self.number(1)}, {self.number(1)}"
        return f"return math.sin({self.number(2)} + a + 2.0 * b + c) + 0.1 * (i + 3 * j + 7 * k)"

    # ---- expressions -----------------------------------------------------------------------------------------------

    def number(self, depth: int) -> str:
        """Return an expression of numbers."""
        if depth <= 0:
            return self.draw.choice([*FLOATS, "x", "y", "a", "0.5", "1.5", "2"])
        a, b, whole = self.number(depth - 1), self.number(depth - 1), self.whole(depth - 1)
        ways = [
            *(f"({a} + {b})", f"({a} - {b})", f"({a} * {b})", f"({a} * {b})", f"({a} / (1.5 + abs({b})))", f"(-{a})"),
            *(f"math.sin({a})", f"abs({a})", f"float({whole})", f"TABLE[{whole} % 7]"),
            *(f"({a} if {self.condition(depth - 1)} else {b})", f"max({a}, {b})", f"min({a}, {b}, {self.number(0)})"),
            *(f"({a} and {b})", f"({a} or {b})"),
            *((f"g({a}, {b})", f"h({a}, {b})[0]", f"h({b}, {a})[1]") if self.calls else ()),
        ]
        return self.draw.choice(ways)

    def whole(self, depth: int) -> str:
        """Return an expression of whole numbers."""
        if depth <= 0:
            return self.draw.choice([*COUNTERS, "2", "3"])
        a, b = self.whole(depth - 1), self.whole(depth - 1)
        ways = [
            *(f"({a} + {b})", f"({a} - {b})", f"({a} * {b})", f"abs({a})", *COUNTERS),
            *(f"({a} // {self.draw.choice([2, 3, -4])})", f"({a} % {self.draw.choice([3, 5])})"),
            *(f"int(3.0 * math.sin({self.number(depth - 1)}))", f"({a} if {self.condition(depth - 1)} else {b})"),
        ]
        return self.draw.choice(ways)

    def condition(self, depth: int) -> str:
        a, b, c = self.number(depth), self.number(depth), self.number(0)
        ways = [
            *(f"{a} {sign} {b}" for sign in ("<", ">", "<=", ">=")),
            *(f"{c} < {a} < {self.number(0)}", f"not {c} > {self.number(0)}", f"({self.whole(0)} % 2)"),
            f"{self.whole(depth)} {self.draw.choice(['==', '!=', '<', '>'])} {self.whole(depth)}",
        ]
        if depth > 0:
            ways.append(f"({self.condition(depth - 1)} {self.draw.choice(['and', 'or'])} {self.condition(depth - 1)})")
        return self.draw.choice(ways)

    def value(self) -> str:
        found = self.number(self.draw.choice([1, 2, 2, 3]))
        return f"math.sin({found})" if self.draw.random() < 0.4 else found

    # ---- statements ------------------------------------------------------------------------------------------------

    def block(self, depth: int, indent: int, count: int) -> None:
        for _ in range(count):
            self.left -= 1
            way = self.draw.random()
            if depth <= 0 or self.left <= 0 or way < 0.4:
                self.add(indent, self.assignment())
            elif way < 0.6:
                self.branch(depth, indent)
            else:
                self.loop(depth, indent)

    def assignment(self) -> str:
        one, other = self.draw.sample(FLOATS, 2)
        counter = self.draw.choice(COUNTERS)
        ways = [
            *(f"{one} = {self.value()}", f"{one} = {self.value()}", f"{one} = {other} = {self.value()}"),
            *(f"{one} {self.draw.choice(['+=', '-=', '*='])} math.sin({self.value()})", f"{counter} += 1"),
            *(f"{counter} = ({self.whole(2)}) % {self.draw.choice([4, 9])}",),
            f"{one}, {other} = {self.value()}, {self.value()}",
            *((f"{one}, {other} = h({self.number(1)}, {self.number(1)})",) if self.calls else ()),
        ]
        return self.draw.choice(ways)

    def branch(self, depth: int, indent: int) -> None:
        heads = [f"if {self.condition(2)}:"]
        heads += [f"elif {self.condition(1)}:"] * (self.draw.random() < 0.3) + ["else:"] * (self.draw.random() < 0.5)
        for head in heads:
            self.add(indent, head)
            self.block(depth - 1, indent + 1, 1)
            if self.loops and self.draw.random() < 0.35:
                self.add(indent + 1, self.draw.choice(LEAVE[:3]))
            elif self.draw.random() < 0.1:
                self.add(indent + 1, self.returned())

    def loop(self, depth: int, indent: int) -> None:
        self.loops += 1
        one, other = self.draw.sample(FLOATS, 2)
        way = self.draw.random()
        if way < 0.45:
            counter = self.draw.choice([*COUNTERS, *COUNTERS, one])
            bound = self.draw.choice([*RANGES, f"({self.whole(1)}) % 4", f"1, ({self.whole(1)}) % 5"])
            self.add(indent, f"for {counter} in range({bound}):")
        elif way < 0.6:
            self.add(indent, f"for {one} in ({self.number(1)}, {self.number(1)}, {self.number(0)}):")
        elif way < 0.75:
            pairs = ", ".join(f"({self.number(1)}, {self.number(0)})" for _ in range(2))
            self.add(indent, f"for {one}, {other} in ({pairs}):")
        else:
            self.whiles += 1
            rounds = f"rounds_{self.whiles}"
            self.add(indent, f"{rounds} = 0")
            self.add(indent, f"while {self.draw.choice(['True', f'{rounds} < 4 and {self.condition(1)}'])}:")
            for line in (f"{rounds} += 1", f"if {rounds} > 6:", "    break"):
                self.add(indent + 1, line)
        self.block(depth - 1, indent + 1, self.draw.choice([1, 2]))
        if self.draw.random() < 0.7:
            self.add(indent + 1, f"if {self.condition(1)}:")
            leave = self.draw.choice(LEAVE)
            self.add(indent + 2, self.returned() if leave == "return" else leave)
            if self.draw.random() < 0.6:
                self.add(indent + 1, self.assignment())
        self.loops -= 1
