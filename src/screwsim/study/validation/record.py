"""Record of a comparison: rows with verdicts, panels of its figure; its table as text, and a summary line."""

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from screwsim.figures import declared
from screwsim.figures.engineering import shown_name
from screwsim.scene.model_errors import range_text

KINDS = {
    "exact": "against a closed form or an identity",
    "cross-code": "against another program or another writing of the same equations",
    "published": "against a paper, a manufacturer or an experiment",
    "calibrated": "a number that the machine was fitted to: no evidence",
    "estimate": "the size of what the model leaves out: nothing to compare with",
}
VERDICTS = ("holds", "fails", "no verdict")
JUDGED = ("exact", "cross-code", "published")  # kinds that are evidence
WIDTH = 120
_COLUMNS = (("quantity", 56), ("ours", 11), ("theirs", 11), ("±", 9), ("unit", 7), ("kind", 10), ("verdict", 10))
_INDENT = "    "


class NotRun(Exception):
    """Error with the reason, in one line, why a source could not be compared."""


@dataclass(frozen=True)
class Row:
    """One quantity: computed and reference value, numbers in `unit` or words, with uncertainty and verdict.

    `uncertainty` is in `unit` (for exact and cross-code rows it is the tolerance), None where the source gives none;
    `basis` says where it comes from.
    """

    quantity: str
    ours: float | str | None
    theirs: float | str | None
    kind: str
    verdict: str
    unit: str = ""
    uncertainty: float | None = None
    basis: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"{self.quantity}: kind {self.kind!r} is not one of {', '.join(KINDS)}")
        if self.verdict not in VERDICTS:
            raise ValueError(f"{self.quantity}: verdict {self.verdict!r} is not one of {', '.join(VERDICTS)}")


@dataclass(frozen=True)
class Series:
    """One curve or set of points of a figure; `theirs` are drawn as points with error bars, ours as lines.

    With `upper` it is a band from y to there, in the colour of the curve at the same position among ours.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    theirs: bool = False
    error: float | None = None
    points: bool = False  # our values, drawn as separate points
    upper: Sequence[float] | None = None


@dataclass(frozen=True)
class Panel:
    """One pair of axes of a figure."""

    x_label: str
    y_label: str
    series: Sequence[Series]
    log_x: bool = False
    log_y: bool = False


@dataclass(frozen=True)
class ValidationPoint:
    """One figure at one point of a machine, ours and the source's in SI units, with their standard uncertainties.

    `inputs` is ours due to the tolerances of the scene, `stated` the source's own: None where it is not stated.
    `fitted` points are those to which a parameter was fitted. `at` are the conditions (`uncertainty.model_error`).
    """

    machine: str
    name: str
    figure: str
    ours: float
    theirs: float
    numerical: float | None
    inputs: float | None
    stated: float | None
    fitted: bool
    at: Mapping[str, Any]


@dataclass(frozen=True)
class Comparison:
    """Comparison of one source with computed values; `about` (Markdown) says how to read it and what was found.

    `points` are those from which the model error follows, figure by figure.
    """

    title: str
    citation: str
    about: str
    rows: Sequence[Row]
    panels: Sequence[Panel] = ()
    points: Sequence[ValidationPoint] = ()


def equal(
    quantity: str,
    ours: float,
    theirs: float,
    uncertainty: float | None,
    kind: str,
    *,
    unit: str = "",
    basis: str = "",
    note: str = "",
    comparable: bool = True,
) -> Row:
    """Return the row of a number: holds within the uncertainty, fails outside it, no verdict without one.

    `comparable` is False where the source is about another machine: the difference is shown without a conclusion.
    """
    verdict = "no verdict"
    if uncertainty is not None and comparable:
        verdict = "holds" if abs(ours - theirs) <= uncertainty else "fails"
    return Row(quantity, float(ours), float(theirs), kind, verdict, unit, uncertainty, basis, note)


def trend(quantity: str, ours: str, theirs: str, holds: bool, *, note: str = "") -> Row:
    """Return the row of a published statement in words: a sign, an order, a saturation."""
    return Row(quantity, ours, theirs, "published", "holds" if holds else "fails", note=note)


def value_text(value: float | str | None, digits: int = 4) -> str:
    """Return a value of a row as text."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    return f"{value:.{digits}g}"


def _table_line(cells: Mapping[str, str]) -> str:
    return " ".join(f"{cells[name]:<{width}}" for name, width in _COLUMNS).rstrip()


def row_text(row: Mapping[str, Any]) -> list[str]:
    """Return the lines of one row; text too long for its column goes below."""
    uncertainty = value_text(row["uncertainty"], 2)
    cells = {**row, "ours": value_text(row["ours"]), "theirs": value_text(row["theirs"]), "±": uncertainty}
    widths, below = dict(_COLUMNS), []
    for name in ("ours", "theirs"):
        if len(cells[name]) > widths[name]:
            below.append(f"{name}: {cells[name]}")
            cells[name] = "below"
    first, *more = textwrap.wrap(row["quantity"], widths["quantity"], subsequent_indent="  ")
    text = [_table_line({**cells, "quantity": first}), *more]
    for part in (*below, row["basis"], row["note"]):
        text += textwrap.wrap(part, WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT)
    return text


def source_text(name: str, source: Mapping[str, Any]) -> str:
    """Return one source as text."""
    if source["status"] != "ok":
        return f"{name}: not run: {source['reason']}"
    lines = [f"{name}: {source['title']}", *textwrap.wrap(source["citation"], WIDTH - 2, initial_indent="  ")]
    lines.append(_table_line({column: column for column, _ in _COLUMNS}))
    for row in source["rows"]:
        lines += row_text(row)
    return "\n".join(lines)


def errors_report(errors: Mapping[str, Any]) -> str:
    """Return the model error by machine and figure, as ASME V&V 20 states it."""
    lines = ["error of the model: E = ours - theirs; at all points it lies between the ends (E ± 2 u_val, ASME V&V 20)"]
    for name, error in errors.items():
        lines += textwrap.wrap(f"{name}: {range_text(error['range'])}", WIDTH)
        for figure, told in error["figures"].items():
            lines += _error_lines(figure, told)
    lines.append("a scene that resembles one of them refers to it by name: uncertainty: {model: NAME}")
    return "\n".join(lines)


def _error_lines(figure: str, told: Mapping[str, Any]) -> list[str]:
    about = declared(figure)
    factor, unit = (1.0, "K") if about.units == "K" else (100.0, "%" if told["relative"] else "points")
    lines = []
    for kind, words in (("held_out", "held out"), ("fitted", "fitted to, no evidence")):
        one = told[kind]
        if one is not None:
            low, high, mean = (f"{factor * one[end]:+.1f}" for end in ("low", "high", "mean"))
            lines.append(f"  {shown_name(figure)}: {low} … {high} {unit}, mean {mean}: {one['points']} points {words}")
    missing = told["not_stated"]
    return [*lines, *([f"    without {', '.join(missing)}, which the source does not state"] if missing else [])]


def summary(document: Mapping[str, Any]) -> str:
    """Return the counts of the verdicts, in one sentence."""
    rows = [row for source in document["sources"].values() for row in source["rows"]]
    judged = [row for row in rows if row["kind"] in JUDGED and row["verdict"] != "no verdict"]
    held = sum(row["verdict"] == "holds" for row in judged)
    open_rows = sum(row["kind"] in JUDGED and row["verdict"] == "no verdict" for row in rows)
    other = len(rows) - len(judged) - open_rows
    return (
        f"{held} of {len(judged)} judged comparisons hold, {len(judged) - held} fail; {open_rows} have no verdict; "
        f"{other} are fitted or estimates, which are no evidence"
    )


def report(document: Mapping[str, Any]) -> str:
    """Return the whole table."""
    parts = [source_text(name, source) for name, source in document["sources"].items()]
    return "\n\n".join([*parts, summary(document)])
