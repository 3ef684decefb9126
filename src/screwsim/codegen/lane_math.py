"""Exponential, logarithm and power for all lanes: kernels of plain arithmetic, which a processor computes side by side.

Each is a series. The errors are up to two units in the last place for exp and exp − 1 and two for log; for a power, as
many as the whole part of exponent times logarithm, and one more. `bits_of` and `of_bits` convert a float to the integer
with the same 64 bits and back.
"""

import math
import struct
from collections.abc import Callable
from typing import Any

from screwsim.numerics.kernel import Kernel, Slot, flatten, kernel

PER_LN2 = 1.0 / math.log(2.0)
LN2_HIGH = 0.6931471803691238  # its last bits are zero, so that its multiples are exact
LN2_LOW = 1.9082149292705877e-10
SHIFTED = 6755399441055744.0  # 1.5 * 2**52: adding a float rounds it to a whole number, held in the last bits
LEAST, MOST = -708.0, 709.0  # arguments below which exp is taken as zero, above which as infinite
ROOT_HALF = 4604544271217802188  # bits of √(1/2)
SMALL = 2.2250738585072014e-308  # smallest float of full precision; positive values below count as zero
E2, E3, E4, E5, E6, E7 = (1.0 / math.factorial(i) for i in range(2, 8))
E8, E9, E10, E11, E12, E13 = (1.0 / math.factorial(i) for i in range(8, 14))
A3, A5, A7, A9, A11 = (2.0 / i for i in range(3, 13, 2))
A13, A15, A17, A19, A21 = (2.0 / i for i in range(13, 23, 2))


class _OfBits(Slot):
    """A function built into the compiler."""

    def __init__(self, name: str, function: Callable[[Any], Any]) -> None:
        super().__init__(name)
        self.function = function

    def __call__(self, *given: Any) -> Any:
        return self.function(*given)


def _bits(x: float) -> int:
    return struct.unpack("<q", struct.pack("<d", x))[0]


def _float(i: int) -> float:
    return struct.unpack("<d", struct.pack("<Q", i % (1 << 64)))[0]


bits_of = _OfBits("bits_of", _bits)
of_bits = _OfBits("of_bits", _float)


@kernel
def less_one(r):
    """Return exp(r) − 1 for |r| ≤ ln(2)/2."""
    r2 = r * r
    r4 = r2 * r2
    a = E2 + r * E3 + r2 * (E4 + r * E5)
    b = E6 + r * E7 + r2 * (E8 + r * E9)
    c = E10 + r * E11 + r2 * (E12 + r * E13)
    return r + r2 * (a + r4 * (b + r4 * c))


@kernel
def exp_of_lanes(x):
    """Return the exponential: 2^n times a polynomial for a remainder within ±ln(2)/2."""
    held = min(max(x, LEAST), MOST)
    shifted = held * PER_LN2 + SHIFTED
    n = shifted - SHIFTED
    r = (held - n * LN2_HIGH) - n * LN2_LOW
    p = 1.0 + less_one(r)
    found = of_bits(bits_of(p) + int(n) * 4503599627370496)
    found = 0.0 if x < LEAST else found
    found = math.inf if x > MOST else found
    return x if x != x else found


@kernel
def expm1_of_lanes(x):
    """Return exp(x) − 1: 2^n times exp(r) − 1 of the remainder r, plus 2^n − 1."""
    held = min(max(x, LEAST), MOST)
    shifted = held * PER_LN2 + SHIFTED
    n = shifted - SHIFTED
    r = (held - n * LN2_HIGH) - n * LN2_LOW
    scale = of_bits(4607182418800017408 + int(n) * 4503599627370496)
    found = scale * less_one(r) + (scale - 1.0)
    found = -1.0 if x < LEAST else found
    found = math.inf if x > MOST else found
    return x if x != x else found


@kernel
def log_of_lanes(x):
    """Return the logarithm: that of a power of two plus that of the remaining factor between √(1/2) and √2."""
    bits = bits_of(x)
    k = (bits - ROOT_HALF) // 4503599627370496
    m = of_bits(bits - k * 4503599627370496)
    s = (m - 1.0) / (m + 1.0)
    z = s * s
    z2 = z * z
    z4 = z2 * z2
    a = A3 + z * A5 + z2 * (A7 + z * A9)
    b = A11 + z * A13 + z2 * (A15 + z * A17)
    c = A19 + z * A21
    found = k * LN2_HIGH + (2.0 * s + (s * (z * (a + z4 * (b + z4 * c))) + k * LN2_LOW))
    found = (-math.inf if x >= 0.0 else math.nan) if x < SMALL else found
    return found if x < math.inf else x


@kernel
def power_of_lanes(x, y):
    """Return x^y for x > 0, and 0^y for x = 0."""
    return exp_of_lanes(y * log_of_lanes(x))


@kernel
def power_of_any(x, y):
    """Return x^y for |y| < 2^51: 1 for y = 0, and for x < 0 a number where y is whole.

    As the C library does for normal numbers and results, without the sign of a zero.
    """
    found = power_of_lanes(abs(x), y)
    whole, half = (y + SHIFTED) - SHIFTED, (0.5 * y + SHIFTED) - SHIFTED
    signed = (found if half == 0.5 * y else -found) if whole == y else math.nan
    found = signed if x < 0.0 else found
    return 1.0 if y == 0.0 else found


KERNELS: tuple[Kernel, ...] = (less_one, exp_of_lanes, expm1_of_lanes, log_of_lanes, power_of_lanes, power_of_any)


def texts(*more: Kernel) -> str:
    """Return these functions, and more that use them, as a text, under the names by which the compiler calls them."""
    kernels = (*KERNELS, *more)
    text = "\n\n".join(flatten(kernels, {"bits_of": "bits_of", "of_bits": "of_bits"}).values())
    for each in kernels:
        text = text.replace(each.flat_name, each.__name__)
    return text
