"""Powers of one variable in generated text: each written once, by multiplication of others where that is possible."""

from collections.abc import Iterable
from fractions import Fraction

MANY = 4  # number of decimal exponents above which they are built digit by digit
CLOSE = 1e-12  # distance below which two exponents are one


class Powers:
    """Writes `x_3 = x_1 * x_2` and the like into `lines`, and names a power of `variable` by its exponent.

    Whole, half, quarter and eighth exponents cost multiplications and square roots. Any other is exp(t ln x), unless it
    is the product of two powers that exist; but where there are many decimal exponents they are built digit by digit,
    x^2.46 = x^2 (x^0.1)^4 (x^0.01)^6, which costs an exponential for each decimal place, and at most about ten
    roundings.
    """

    def __init__(self, lines: list[str], variable: str, inverse: str, logarithm: str) -> None:
        self.lines, self.variable, self.logarithm = lines, variable, logarithm
        self.by_digits = False
        self.known: dict[Fraction, str] = {Fraction(0): "1.0", Fraction(1): variable, Fraction(-1): inverse}

    def write(self, exponents: Iterable[float]) -> None:
        """Write all these powers, in an order in which small ones serve the larger."""
        wanted = sorted({_exact(value) for value in exponents}, key=lambda e: (not _dyadic(e), abs(e), e))
        self.by_digits = sum(not _dyadic(e) for e in wanted) > MANY
        for exponent in wanted:
            self._make(exponent)

    def name(self, exponent: float) -> str:
        """Return the variable that holds x^exponent, writing it first if necessary."""
        return self._make(_exact(exponent))

    def cheap(self, exponent: float) -> bool:
        """Tell whether the power needs no exponential function."""
        e = _exact(exponent)
        return e in self.known or _dyadic(e)

    def _make(self, e: Fraction) -> str:
        if e in self.known:
            return self.known[e]
        pair = self._pair(e)
        if pair is not None:
            return self._set(e, f"{self.known[pair[0]]} * {self.known[pair[1]]}")
        if self.by_digits and not _dyadic(e) and 1000 % e.denominator == 0:
            return self._from_digits(e)
        if not _dyadic(e):
            return self._set(e, f"math.exp({float(e)!r} * {self.logarithm})")
        if -1 < e < 0:
            return self._set(e, f"{self._make(1 + e)} * {self.known[Fraction(-1)]}")
        if 0 < e < 1 and e.numerator == 1:
            return self._set(e, f"math.sqrt({self._make(2 * e)})")
        if 0 < e < 1:
            one = Fraction(1, e.denominator)
            return self._set(e, f"{self._make(one)} * {self._make(e - one)}")
        sign = 1 if e > 0 else -1
        whole, part = divmod(abs(e), 1)
        if part:
            return self._set(e, f"{self._make(sign * Fraction(whole))} * {self._make(sign * part)}")
        half = whole // 2
        return self._set(e, f"{self._make(sign * Fraction(half))} * {self._make(sign * Fraction(whole - half))}")

    def _from_digits(self, e: Fraction) -> str:
        whole, rest = divmod(e, 1)
        digits = f"{int(rest * 1000):03d}"
        parts = [self._make(Fraction(whole))] if whole else []
        parts += [self._digit(int(digit), 10 ** (k + 1)) for k, digit in enumerate(digits) if digit != "0"]
        return self.known.get(e) or self._set(e, " * ".join(parts))

    def _digit(self, digit: int, scale: int) -> str:
        e = Fraction(digit, scale)
        if e in self.known:
            return self.known[e]
        if digit == 1:
            return self._set(e, f"math.exp({float(e)!r} * {self.logarithm})")
        half = digit // 2
        return self._set(e, f"{self._digit(half, scale)} * {self._digit(digit - half, scale)}")

    def _pair(self, e: Fraction) -> tuple[Fraction, Fraction] | None:
        for first in self.known:
            if first and e - first in self.known and e != first:
                return first, e - first
        return None

    def _set(self, e: Fraction, text: str) -> str:
        name = f"{self.variable}_{str(e).replace('/', 'o').replace('-', 'm')}"
        self.lines.append(f"{name} = {text}")
        self.known[e] = name
        return name


def _exact(value: float) -> Fraction:
    near = Fraction(value).limit_denominator(100000)
    return near if abs(float(near) - value) < CLOSE else Fraction(value)


def _dyadic(e: Fraction) -> bool:
    return e.denominator in (1, 2, 4, 8)
