"""Display of results in Python and notebooks: figures as text [SI] and HTML, and as tables of other libraries."""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from html import escape
from typing import Any, NamedTuple, TypeVar

from screwsim.outputs.customary import digits, printed_celsius, scale
from screwsim.outputs.declared import DIFFERENCE

Key = TypeVar("Key")
Member = TypeVar("Member")
ANGLE = "angle"
MOST_CHARACTERS = 100  # largest number of characters of a meaning or a cell, in text
MOST_ROWS, MOST_HTML_ROWS = 10, 60  # largest number of rows of a table, in text and in HTML
_UNIT_PART = re.compile(r"([A-Za-z]+)([0-9]*)")
MOST_COLUMNS, MOST_HTML_COLUMNS = 5, 12


class ShownFigure(NamedTuple):
    """A figure to show: value and unit (SI, CF style), meaning, the unit people write, whether it is in percent."""

    name: str
    value: float | str | None
    units: str
    long_name: str
    shown: str = ""
    percent: bool = False


class Value(float):
    """A figure returned by attribute access: a number [SI] that knows its `units` (CF style) and meaning, `long_name`.

    It prints as the plain number; its `repr` gives unit, customary unit and meaning.
    """

    units: str
    long_name: str
    _about: ShownFigure

    def __new__(cls, value: float, about: ShownFigure) -> Value:
        """Make a number from a value and its description."""
        made = super().__new__(cls, value)
        made.units, made.long_name, made._about = about.units, about.long_name, about
        return made

    def __repr__(self) -> str:
        about = self._about._replace(value=float(self))
        usual = customary(about)
        number = f"{float(self)!r} {_printed_unit(self.units)}".rstrip()
        return f"{number} ({usual}), {self.long_name}" if usual else f"{number}, {self.long_name}"

    def __str__(self) -> str:
        return float.__repr__(self)

    def __reduce__(self) -> tuple[type[Value], tuple[float, ShownFigure]]:
        return Value, (float(self), self._about)


class About(NamedTuple):
    """Description of an object: a heading, sentences, and a table."""

    heading: str
    notes: Sequence[str] = ()
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[str]] = ()


class Brief:
    """Base class of objects too large to print whole: a few lines in text, a table in notebooks."""

    def _about(self) -> About:
        """Return the description of the object."""
        raise NotImplementedError

    def __repr__(self) -> str:
        heading, notes, columns, rows = self._about()
        kept = (columns, *rows[:MOST_ROWS]) if rows else ()
        cells = [[_short(cell) for cell in row[:MOST_COLUMNS]] for row in kept]
        more = _left_out(len(rows) - MOST_ROWS, len(columns) - MOST_COLUMNS)
        return "\n".join([heading, *map(_short, notes), *aligned(cells), *more])

    def _repr_html_(self) -> str:
        heading, notes, columns, rows = self._about()
        shown = [[escape(cell) for cell in row[:MOST_HTML_COLUMNS]] for row in rows[:MOST_HTML_ROWS]]
        more = _left_out(len(rows) - MOST_HTML_ROWS, len(columns) - MOST_HTML_COLUMNS)
        return _html(heading, [*notes, *more], columns[:MOST_HTML_COLUMNS], shown)


def aligned(rows: Sequence[Sequence[str]], left: Container[int] | None = None) -> list[str]:
    """Return rows of cells as lines: columns two spaces apart, those of `left` (all) aligned left, the others right."""
    columns = []
    for i, cells in enumerate(zip(*rows, strict=True)):
        width = max(map(len, cells))
        columns.append([cell.ljust(width) if left is None or i in left else cell.rjust(width) for cell in cells])
    return ["  ".join(line).rstrip() for line in zip(*columns, strict=True)]


def picked(record: object, *names: str, **renamed: str) -> dict[str, Any]:
    """Return attributes of a record by name, as JSON takes them: mappings as dicts, tuples as lists.

    `renamed` are attributes under other keys.
    """
    plain = {key: getattr(record, name) for key, name in (dict(zip(names, names, strict=True)) | renamed).items()}
    plain |= {name: dict(value) for name, value in plain.items() if isinstance(value, Mapping)}
    return plain | {name: list(value) for name, value in plain.items() if type(value) is tuple}


# words of a path that stand for it, fewest first
_SHORTENED: tuple[Callable[[list[str]], list[str]], ...] = (
    lambda words: words[-1:],
    lambda words: words[-2:],
    lambda words: [words[0], words[-1]],
)


def distinct_words(paths: Iterable[str]) -> list[list[str]]:
    """Return the words that tell paths apart: the last, else the last two, the first (a stage) and last, or all."""
    every, found = [path.split(".") for path in paths], []
    for own in every:
        alike = [each for each in every if each[-1] == own[-1]]
        choice = next((some for some in _SHORTENED if len({tuple(some(each)) for each in alike}) == len(alike)), list)
        found.append(choice(own))
    return found


def grouped(pairs: Iterable[tuple[Key, Member]]) -> dict[Key, list[Member]]:
    """Return the second parts of pairs by the first ones, in their order."""
    found: dict[Key, list[Member]] = {}
    for key, member in pairs:
        found.setdefault(key, []).append(member)
    return found


def _left_out(rows: int, columns: int) -> list[str]:
    words = [f"{count} more {what}" for count, what in ((rows, "rows"), (columns, "columns")) if count > 0]
    return [f"… {' and '.join(words)}"] if words else []


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= MOST_CHARACTERS else f"{line[: MOST_CHARACTERS - 1]}…"


def value_text(figure: ShownFigure) -> str:
    """Return a figure's value in its customary unit, else in SI."""
    return customary(figure) or _value(figure)


def _printed_unit(units: str) -> str:
    """Return a unit as people write it, also that of a temperature difference."""
    return "K" if units == DIFFERENCE else si_unit(units)


def si_unit(units: str) -> str:
    """Return a unit in CF style as people write it: 'kg s-1' gives kg/s, '1' an empty text."""
    if units == "1":
        return ""
    above = [part for part in units.split() if not part.rstrip("0123456789").endswith("-")]
    below = [part.replace("-1", "").replace("-", "") for part in units.split() if part not in above]
    if not below:
        return units
    under = " ".join(below)
    return f"{' '.join(above) or '1'}/{f'({under})' if len(below) > 1 else under}"


def cf_unit(units: str) -> str:
    """Return a unit in CF style, also one as scenes have it: 'W/(m^2 K)' gives 'W m-2 K-1', 'kg s-1' itself."""
    above, _, below = units.replace("^", "").partition("/")
    under = [f"{name}-{power or 1}" for name, power in _UNIT_PART.findall(below)]
    return " ".join([*(above.split() if above != "1" or not under else []), *under])


def customary(figure: ShownFigure) -> str:
    """Return a value in its customary unit; empty where that is the SI unit."""
    if figure.value is None or isinstance(figure.value, str):
        return ""
    if figure.percent:
        return f"{digits(100.0 * figure.value)} %"
    if figure.units == "K":
        return f"{printed_celsius(figure.value)} °C"
    factor, unit = scale(figure.shown or figure.units, abs(figure.value))
    return "" if unit in (figure.units, _printed_unit(figure.units)) else f"{digits(factor * figure.value)} {unit}"


def table_text(figures: Sequence[ShownFigure]) -> str:
    """Return one line for each figure: name, value with its SI unit, meaning."""
    return "\n".join(aligned([(each.name, _value(each), each.long_name[:MOST_CHARACTERS]) for each in figures]))


def _value(figure: ShownFigure) -> str:
    if figure.value is None or isinstance(figure.value, str):
        return figure.value or "none"
    return f"{figure.value:.6g} {_printed_unit(figure.units)}".rstrip()


def table_html(heading: str, notes: Iterable[str], figures: Sequence[ShownFigure]) -> str:
    """Return a heading, notes and a table of figures as an HTML fragment that takes the colours of its page."""
    rows = [
        [f"<code>{escape(each.name)}</code>", escape(_value(each)), escape(customary(each)), escape(each.long_name)]
        for each in figures
    ]
    return _html(heading, notes, ("figure", "SI", "customary", "meaning"), rows)


def _html(heading: str, notes: Iterable[str], columns: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    cell = "text-align: left; padding: 0 1em 0 0"
    lines = ["".join(f"<td style='{cell}'>{text}</td>" for text in row) for row in rows]
    head = "".join(f"<th style='{cell}'>{escape(word)}</th>" for word in columns)
    said = "".join(f"<p>{escape(text)}</p>" for text in notes)
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>" if lines else ""
    return f"<div><p><b>{escape(heading)}</b></p>{said}{table}</div>"


def library(name: str) -> Any:
    """Return an optional library; raise ImportError that says how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"{name} is not installed (pip install 'screwsim[{name}]')") from error
