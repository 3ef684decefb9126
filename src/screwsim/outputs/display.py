"""Results as Python and notebooks show them: a table of figures as text [SI], and as HTML with customary units too."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import NamedTuple

from screwsim.outputs.customary import ZERO_CELSIUS, digits, scale

MOST_LETTERS = 100  # of a meaning in text


class Shown(NamedTuple):
    """One figure to show: value and unit (SI, CF style), meaning, the unit people write, whether it is in percent."""

    name: str
    value: float | None
    units: str
    long_name: str
    shown: str = ""
    percent: bool = False


def si_unit(units: str) -> str:
    """Return a unit in CF style as people write it: 'kg s-1' is kg/s, '1' nothing."""
    if units == "1":
        return ""
    above = [part for part in units.split() if not part.rstrip("0123456789").endswith("-")]
    below = [part.replace("-1", "").replace("-", "") for part in units.split() if part not in above]
    if not below:
        return units
    under = " ".join(below)
    return f"{' '.join(above) or '1'}/{f'({under})' if len(below) > 1 else under}"


def customary(figure: Shown) -> str:
    """Return a value in the unit in which people write it; empty where that is the SI unit."""
    if figure.value is None:
        return ""
    if figure.percent:
        return f"{digits(100.0 * figure.value)} %"
    if figure.units == "K":
        return f"{figure.value - ZERO_CELSIUS:.2f} °C"
    factor, unit = scale(figure.shown or figure.units, abs(figure.value))
    return "" if unit in (figure.units, si_unit(figure.units)) else f"{digits(factor * figure.value)} {unit}"


def table_text(figures: Sequence[Shown]) -> str:
    """Return a line a figure: name, value with its SI unit, meaning."""
    values = [_value(each) for each in figures]
    names, widths = max((len(each.name) for each in figures), default=0), max(map(len, values), default=0)
    return "\n".join(
        f"{each.name:<{names}}  {value:<{widths}}  {each.long_name[:MOST_LETTERS]}".rstrip()
        for each, value in zip(figures, values, strict=True)
    )


def _value(figure: Shown) -> str:
    return "none" if figure.value is None else f"{figure.value:.6g} {si_unit(figure.units)}".rstrip()


def table_html(heading: str, notes: Iterable[str], figures: Sequence[Shown]) -> str:
    """Return a heading, notes and a table of figures as a piece of HTML that takes the colours of its page."""
    cell = "text-align: left; padding: 0 1em 0 0"
    rows = [
        f"<tr><td style='{cell}'><code>{escape(each.name)}</code></td><td style='{cell}'>{escape(_value(each))}</td>"
        f"<td style='{cell}'>{escape(customary(each))}</td><td style='{cell}'>{escape(each.long_name)}</td></tr>"
        for each in figures
    ]
    head = "".join(f"<th style='{cell}'>{word}</th>" for word in ("figure", "SI", "customary", "meaning"))
    said = "".join(f"<p>{escape(text)}</p>" for text in notes)
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>" if rows else ""
    return f"<div><p><b>{escape(heading)}</b></p>{said}{table}</div>"
