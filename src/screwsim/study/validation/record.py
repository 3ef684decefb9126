"""What a comparison says: rows with a verdict, and panels of its figure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

KINDS = {
    "exact": "against a closed form or an identity",
    "cross-code": "against another program or another writing of the same equations",
    "published": "against a paper, a manufacturer or an experiment",
    "calibrated": "a number to which the machine was fitted: no evidence",
    "estimate": "the size of what the model leaves out: nothing to hold it against",
}
VERDICTS = ("holds", "fails", "no verdict")
JUDGED = ("exact", "cross-code", "published")  # kinds that are evidence


class NotRun(Exception):
    """Say in one line why a source could not be compared."""


@dataclass(frozen=True)
class Row:
    """One quantity: ours and theirs, numbers in `unit` or words, how sure the source is, and what that means.

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
            raise ValueError(f"{self.quantity}: kind {self.kind!r} is none of {', '.join(KINDS)}")
        if self.verdict not in VERDICTS:
            raise ValueError(f"{self.quantity}: verdict {self.verdict!r} is none of {', '.join(VERDICTS)}")


@dataclass(frozen=True)
class Series:
    """One curve or set of points of a figure; `theirs` are drawn as points with error bars, ours as lines.

    With `upper` it is a band from y to there, in the colour of the curve at the same place among ours.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    theirs: bool = False
    error: float | None = None
    points: bool = False  # ours, as separate points
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
class Compared:
    """One figure of one point of a machine, ours and the source's in SI units, with their standard uncertainties.

    `inputs` is that of ours by the tolerances of the scene, `stated` the source's own: None where nobody states one.
    `fitted` points are those that a parameter was fitted to. `at` are the conditions (`study.model_error`).
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
    """What one source says and what we compute; `about` says in a sentence or two how to read it.

    `points` are what of it states the error of the model, figure by figure.
    """

    title: str
    citation: str
    about: str
    rows: Sequence[Row]
    panels: Sequence[Panel] = ()
    points: Sequence[Compared] = ()


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
    """Return the row of a number: holds within the uncertainty, fails outside it, no verdict where there is none.

    `comparable` is False where the source is about another machine: the difference is shown, and nothing is concluded.
    """
    verdict = "no verdict"
    if uncertainty is not None and comparable:
        verdict = "holds" if abs(ours - theirs) <= uncertainty else "fails"
    return Row(quantity, float(ours), float(theirs), kind, verdict, unit, uncertainty, basis, note)


def trend(quantity: str, ours: str, theirs: str, holds: bool, *, note: str = "", kind: str = "published") -> Row:
    """Return the row of something told in words: a sign, an order, a saturation."""
    return Row(quantity, ours, theirs, kind, "holds" if holds else "fails", note=note)


def shown(value: float | str | None, digits: int = 4) -> str:
    """Return a value of a row as people read it."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    return f"{value:.{digits}g}"
