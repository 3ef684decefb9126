"""Mutated texts: scenes, fits, stages and tables with letters, numbers, nesting, aliases and cells that are odd."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

NUMBERS = ("1e309", "-1e309", "0", "-0.0", ".inf", "-.inf", ".nan", "NaN", "0x10", "1_000", "1e-400", "9" * 400, "1,5")
NUMBERS += (
    "１２",
    "٣",
    "1e99999999999",
    "--1",
    "+",
    "",
    "1 2",
    "1e3e3",
    "0b2",
    "1.2.3",
    "'5'",
    "true",
    "null",
    "~",
    "{}",
)
WORDS = (
    "\x00",
    "\x1b[31m",
    '"\\ud83d"',
    '"\\ud83d\\ude00"',
    '"\\0"',
    "\u202e",
    "😀",
    "\ufeff",
    "\t",
    "---",
    "...",
    "\x85",
)
WORDS += ("&a", "*a", "<<: *a", "!!python/object/apply:os.system ['false']", "!!binary '//'", "!!set {a}", "!<x> y")
WORDS += (
    "%YAML 1.1",
    "? [a, b]",
    "? ",
    "- ",
    ": ",
    "[",
    "]",
    "{",
    "}",
    "|",
    ">",
    "'",
    '"',
    "#",
    "\r",
    "\x7f",
    "@",
    "`",
)
WORDS += (
    "../secret.txt",
    "/dev/zero",
    "/etc/passwd",
    "pipe",
    ".",
    "\\x1b",
    "\u2028",
    "trap.effect",
    "this.s",
    "my-package.x",
)

Random = np.random.Generator


def _pick(options, random: Random):
    return options[int(random.integers(len(options)))]


def _lines(text: str, random: Random) -> tuple[list[str], int]:
    lines = text.split("\n")
    return lines, int(random.integers(len(lines)))


def letters(text: str, random: Random) -> str:
    """Change, leave out or add some letters."""
    found = list(text)
    for _ in range(int(random.integers(1, 8))):
        at = int(random.integers(len(found)))
        kind = int(random.integers(3))
        if kind == 0:
            found[at] = chr(int(random.choice([9, 10, 32, 34, 39, 44, 58, 91, 123, 0x1B, 0x7F, 0x85, 0x2028, 0x1F600])))
        elif kind == 1:
            del found[at : at + int(random.integers(1, 6))]
        else:
            found[at:at] = found[at : at + int(random.integers(1, 20))]
        found = found or [" "]
    return "".join(found)


def lines(text: str, random: Random) -> str:
    """Leave out, repeat, exchange or indent lines, or cut the text."""
    found, at = _lines(text, random)
    other = int(random.integers(len(found)))
    kind = int(random.integers(5))
    if kind == 0:
        del found[at]
    elif kind == 1:
        found.insert(other, found[at])
    elif kind == 2:
        found[at], found[other] = found[other], found[at]
    elif kind == 3:
        found[at] = " " * int(random.integers(1, 5)) + found[at]
    else:
        return text[: int(random.integers(1, len(text)))]
    return "\n".join(found)


def words(text: str, random: Random) -> str:
    """Put an odd word somewhere, mostly where a value stands."""
    found, at = _lines(text, random)
    word = _pick(WORDS, random)
    head, colon, value = found[at].partition(": ")
    found[at] = f"{head}{colon}{word}" if colon and random.random() < 0.6 else f"{found[at]}{word}{value}"
    return "\n".join(found)


def numbers(text: str, random: Random) -> str:
    """Put an odd number in the place of one."""
    places = list(re.finditer(r"-?\d+(\.\d+)?(e-?\d+)?", text))
    if not places:
        return letters(text, random)
    for place in sorted(random.choice(len(places), size=min(2, len(places)), replace=False))[::-1]:
        start, end = places[place].span()
        text = text[:start] + _pick(NUMBERS, random) + text[end:]
    return text


def scaled(text: str, random: Random) -> str:
    """Multiply some numbers by as much as still may pass, so that what comes after reading is reached, too."""
    places = list(re.finditer(r"(?<![\w.])\d+(\.\d+)?(?![\w.])", text))
    parts, end = [], len(text)
    for place in places[::-1]:
        if random.random() < 0.1:
            factor = float(_pick((0.0, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 10.0, 1e3, 1e-3), random))
            parts += [text[place.end() : end], f"{float(place[0]) * factor:.6g}"]
            end = place.start()
    return "".join([text[:end], *parts[::-1]])


def swapped(text: str, random: Random) -> str:
    """Put a mapping, a list or a scalar in the place of a value of another kind."""
    found, at = _lines(text, random)
    head, colon, _ = found[at].partition(":")
    values = ("[]", "{}", "[1, 2]", "{a: b}", "null", "5", "text", "[[1], {a: [2]}]", "true", "'x: y'", "off", "[{}]")
    found[at] = f"{head}: {_pick(values, random)}" if colon else found[at] + _pick(values, random)
    return "\n".join(found)


def nested(text: str, random: Random) -> str:
    """Nest a value deeply, by brackets, braces, dashes or lines."""
    found, at = _lines(text, random)
    head, colon, _ = found[at].partition(":")
    deep = int(_pick((6, 30, 34, 100, 330, 331, 1000, 5000), random))
    indent = " " * (len(head) - len(head.lstrip()) + 1)
    below = "\n".join(f"{indent}{' ' * level}a:" for level in range(min(deep, 600)))
    shapes = (
        "[" * deep + "]" * deep,
        "{a: " * deep + "}" * deep,
        "[" * deep,
        "\n" + below,
        "? " * deep,
        "\n- " + "- " * deep,
    )
    found[at] = f"{head}: {_pick(shapes, random)}" if colon else found[at]
    return "\n".join(found)


def aliased(text: str, random: Random) -> str:
    """Add anchors that stand for each other many times over, or for themselves; with a base, both sides have them."""
    deep, wide = int(_pick((3, 9, 30, 60), random)), int(_pick((2, 9, 40), random))
    listed = random.random() < 0.5
    rows = []
    for level in range(deep):
        inner = [f"*a{level - 1}"] * wide if level else ["x"] * wide
        pairs = ", ".join(f"k{i}: {each}" for i, each in enumerate(inner))
        rows.append(f"a{level}: &a{level} " + (f"[{', '.join(inner)}]" if listed else f"{{{pairs}}}"))
    kind = int(random.integers(4))
    bomb = "\n".join(rows)
    if kind == 0:
        return f"{text}\n{bomb}\n"
    if kind == 1:
        return f"base: bomb.yaml\n{text}\n{bomb}\n"
    found, at = _lines(text, random)
    head, colon, _ = found[at].partition(":")
    name = "self" if kind == 2 else f"a{deep - 1}"
    found[at] = f"{head}: &self [*self, {{b: *self}}]" if kind == 2 else f"{head}: *{name}" if colon else found[at]
    return (bomb + "\n" if kind == 3 else "") + "\n".join(found)


def based(text: str, random: Random) -> str:
    """Name a base, a table or an effect that is none."""
    names = (
        ".",
        "pipe",
        "/dev/zero",
        "/dev/stdin",
        "nowhere.yaml",
        '"a\\0b"',
        "secret.txt",
        "bomb.yaml",
        "[a]",
        "''",
        "{}",
    )
    names += ("self.yaml", "pipe/x", "/proc/self/mem", "a\x1bb", "~", "x" * 5000)
    name = _pick(names, random)
    kind = int(random.integers(4))
    if kind == 0:
        return f"base: {name}\n{text}"
    if kind == 1:
        return re.sub(r"\b[\w.]+\.(csv|yaml)\b", lambda _: name, text)
    effect = _pick(
        ("trap.effect", "trap", "os.path", "this.s", "my-package.effect", "a..b", ".a", "a b.c", "é.ü"), random
    )
    if kind == 2:
        return text.replace("effects:", f"effects:\n  {effect}:", 1)
    return f"{text}\nmachine: {{volume: {{law: table, file: {name}}}}}\n"


YAML: tuple[Callable[[str, Random], str], ...] = (letters, lines, words, numbers, swapped, nested, aliased, based)
YAML += (scaled, scaled, lines)


def cells(text: str, random: Random) -> str:
    """Add, leave out or exchange cells, or separators."""
    found, at = _lines(text, random)
    parts = found[at].split(",")
    kind = int(random.integers(8))
    place = int(random.integers(len(parts)))
    if kind == 0:
        parts.insert(place, _pick(("", "0", "x", " "), random))
    elif kind == 1:
        del parts[place]
    elif kind == 2:
        parts[place] = _pick((*NUMBERS, '"', '"a', '""', "a\x1b[31m", "\x00", "-1", "1e-310", "1;5"), random)
    elif kind == 3:
        return text.replace(",", _pick((";", "\t", " ", ",,", ", ,"), random))
    elif kind == 4:
        return text.replace(".", ",")
    elif kind == 5:
        parts[place] = "1" * int(_pick((5000, 131_071, 131_073, 1_000_000), random))
    elif kind == 6:
        return "\n".join([found[0], *sorted(found[1:], key=lambda _: random.random())])
    else:
        parts[place] = parts[0]
    found[at] = ",".join(parts)
    return "\n".join(found)


def constant(text: str, random: Random) -> str:
    """Make a column one number, or leave few rows, or very many."""
    kind = int(random.integers(4))
    rows = text.split("\n")
    if kind == 0:
        return rows[0] + "\n" + "\n".join(rows[1 : int(random.integers(1, 5))])
    if kind == 1:
        number = _pick(("0", "1e-300", "1e300", "5e-324", "nan"), random)
        return "\n".join(rows[:1] + [re.sub(r",[^,]*$", f",{number}", row) for row in rows[1:]])
    if kind == 2:
        return text + rows[-2] * 2 + ("\n" + (rows[-2] or "1,2")) * int(_pick((3, 90_000, 250_000), random))
    return "\ufeff" + text.replace("\n", _pick(("\r", "\r\n", "\n\n", "\n#\n", "\x0b", "\x85"), random))


CSV: tuple[Callable[[str, Random], str], ...] = (letters, lines, words, numbers, cells, cells, constant, scaled, scaled)


def encoded(text: str, random: Random) -> bytes:
    """Return a text as bytes, seldom in an encoding that it should not have, or with bytes that are no letters."""
    share = random.random()
    if share < 0.03:
        return text.encode("utf-16", "surrogatepass")
    raw = text.encode("utf-8", "surrogatepass")
    if share < 0.06:
        at = int(random.integers(len(raw) + 1))
        return raw[:at] + _pick((b"\xff", b"\xed\xa0\x80", b"\xc0\x80", b"\x00" * 9, b"\xf5"), random) + raw[at:]
    return raw
