"""Numbers written in ways that programs read differently: what may be meant, and how to write it.

`1,5` has a decimal comma and `1,000,000` separators of thousands, but `3,000` may be either, and whoever takes it for
the wrong one is off by a factor of a thousand. All readings are reported, and none is used.
"""

import re
import unicodedata
from typing import NamedTuple

_SPACES = " \u00a0\u202f\u2009\u2007"  # plain, no-break, narrow no-break, thin, figure
_DIVIDERS = f"{_SPACES}'’_"  # separate thousands, nothing else
_AMBIGUOUS_MARKS = ",·"  # separate thousands or decimals
_MINUS, _PLUS = "−–—－﹣", "＋"
_LOOKALIKES = {"．": ".", "，": ",", "٫": ",", "٬": "'"}
_QUOTES = "“”„‟«»″"
LONGEST_NUMBER = 200  # most characters of a text examined as a number; the patterns would be slow on more
_NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)"
_GROUPED = re.compile(rf"([+-]?)([0-9][0-9.{_AMBIGUOUS_MARKS}{_DIVIDERS}]*[0-9])((?:[eE][+-]?[0-9]+)?)(.*)", re.DOTALL)
_POWER = re.compile(rf"({_NUMBER})\s*[x×*·]\s*10\s*(?:\^|\*\*)\s*\(?([+-]?[0-9]{{1,3}})\)?(?![0-9])\s*(.*)", re.DOTALL)
_SUPERSCRIPT = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+")
_RAISED = re.compile(r"(10\s*)([⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)")
_RANGE = re.compile(rf"{_NUMBER}[^0-9/+]*?(\.\.+|…|–|—| - |±|\+/-| to )\s*{_NUMBER}.*", re.DOTALL)
_FRACTION = re.compile(r"([+-]?)([0-9]*)\s*([¼½¾⅐-⅞])\s*(.*)", re.DOTALL)
_QUOTIENT = re.compile(rf"({_NUMBER})\s*/\s*([0-9]*[1-9][0-9]*)\s*(.*)", re.DOTALL)
_ABOUT = re.compile(r"(?:~|≈|=|ca\.?|approx\.?|about)\s*([+-]?[0-9.].*)", re.DOTALL | re.IGNORECASE)


class OddNumber(NamedTuple):
    """What is odd about a number, and texts that state its possible readings; none where no single number is meant."""

    what: str
    readings: tuple[str, ...] = ()
    lead: str = "write"


def odd_number(text: str, unit: str = "") -> OddNumber | None:
    """Return what is odd about a text that begins like a number; `unit` completes readings that have no unit."""
    text = text.strip()
    if len(text) > LONGEST_NUMBER:
        return None
    quoted = text.strip(_QUOTES).strip()
    if quoted != text and quoted[:1].isdecimal():
        return OddNumber("has typographic quotes", _with_unit(quoted, "", unit))
    plain = _plain(text)
    single, several, about = _single(plain), _RANGE.fullmatch(plain), _ABOUT.fullmatch(plain)
    if single is not None:
        what, number, rest = single
        return OddNumber(what, _with_unit(number, rest, unit))
    if several is not None:
        return OddNumber("states more than one number" if several[1] in ("±", "+/-") else "is a range")
    if about is not None:
        return OddNumber("contains more than a number", _with_unit(about[1], "", unit))
    grouped = _grouped(plain, unit)
    if grouped is not None or plain == text:
        return grouped
    return OddNumber("has a sign or digits that are not ASCII", _with_unit(plain, "", unit))


def odd_number_text(odd: OddNumber, quote: str = "'") -> str:
    """Return what is odd and its remedy, as worded in a message."""
    readings = [f"{quote}{reading}{quote}" for reading in odd.readings]
    if not readings:
        return f"{odd.what} (write one number: digits, and a point before decimals)"
    other = f", or {readings[1]} if decimals are meant" if len(readings) > 1 else ""
    return f"{odd.what} ({odd.lead} {readings[0]}{other})"


def _plain(text: str) -> str:
    """Return a text with ASCII digits, point and sign."""
    digits = "".join(
        str(unicodedata.decimal(letter)) if letter.isdecimal() else _LOOKALIKES.get(letter, letter) for letter in text
    )
    first = "-" if digits[:1] in tuple(_MINUS) else "+" if digits[:1] in tuple(_PLUS) else digits[:1]
    digits = first + digits[1:]
    return re.sub(rf"(?<=[0-9][eE])[{_MINUS}](?=[0-9])", "-", digits)


def _with_unit(number: str, rest: str, unit: str) -> tuple[str, ...]:
    rest = rest.strip() or ("" if re.search("[^0-9.eE+-]", number) else unit)
    return (f"{number} {rest}".strip(),)


def _single(text: str) -> tuple[str, str, str] | None:
    """Return what is odd about a single number, its usual form and what stands behind it; None for any other text."""
    match = re.fullmatch(r"([+-])\s+([0-9.].*)", text, re.DOTALL)
    if match is not None:
        return "has a space after its sign", match[1] + match[2], ""
    match = _FRACTION.fullmatch(text)
    if match is not None:
        value = float(match[2] or 0) + unicodedata.numeric(match[3])
        return "is a fraction", f"{match[1].removeprefix('+')}{value:.6g}", match[4]
    match = _QUOTIENT.fullmatch(text)
    if match is not None:
        return "is a fraction", f"{float(match[1]) / float(match[2]):.6g}", match[3]
    match = _POWER.fullmatch(_RAISED.sub(lambda raised: f"{raised[1]}^{raised[2].translate(_SUPERSCRIPT)}", text))
    return None if match is None else ("is a product", f"{match[1]}e{int(match[2])}", match[3])


def _grouped(text: str, unit: str) -> OddNumber | None:
    """Return the readings of a number with marks between its digits; None if there are no such marks."""
    match = _GROUPED.fullmatch(text)
    if match is None or re.fullmatch(r"[0-9]+(\.[0-9]+)?", match[2]):
        return None
    sign, body, power, rest = match.groups()
    found = [_with_unit(f"{sign}{number}{power}", rest, unit)[0] for number in _readings(body)]
    last = re.findall(r"[^0-9]", body)[-1]
    lead = "write" if rest.strip() or not unit else "write e.g."  # the unit is a guess
    if len(found) == 2:
        return OddNumber(
            f"has a {'comma' if last == ',' else 'dot'} that may separate thousands or decimals", tuple(found), lead
        )
    if not found:
        return OddNumber("is not one number")
    if re.fullmatch(r"[0-9]+,[0-9]+", body) and "." in found[0]:
        return OddNumber("has a decimal comma", tuple(found), "write a point, e.g.")
    return OddNumber("has marks between its digits", tuple(found), lead)


def _readings(body: str) -> list[str]:
    """Return the possible values of digits with marks between them: as separators of thousands, and of decimals."""
    parts, marks = re.split(r"[^0-9]", body), re.findall(r"[^0-9]", body)
    found = []
    if _groups(parts, marks):
        found.append("".join(parts))
    whole = len(marks) == 1 or (marks[-1] not in marks[:-1] and _groups(parts[:-1], marks[:-1]))
    if marks[-1] in f".{_AMBIGUOUS_MARKS}" and whole:
        found.append("".join(parts[:-1]) + "." + (parts[-1].rstrip("0") or "0" if found else parts[-1]))
    return [number.removesuffix(".0") for number in found]


def _groups(parts: list[str], marks: list[str]) -> bool:
    """Tell whether digits are grouped in thousands, all by the same mark."""
    first, *others = parts
    inner = all(len(part) == 3 for part in others)
    return inner and 1 <= len(first) <= 3 and first[0] != "0" and len(set(marks)) == 1
