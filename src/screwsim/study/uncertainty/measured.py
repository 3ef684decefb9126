"""A measured point against a scene: how far apart they are, and which of the scene's numbers could explain it.

The difference is expressed in standard uncertainties: those of the measurement, of the scene's input tolerances and of
the numerics, combined as the root of the sum of squares. The model error is separate and stated beside them.
Explanations come from derivatives, with one number changed at a time; the scene is solved at the first of them, because
a figure that turns with a number (power over the oil ratio) may not follow its derivative that far.

Source: JCGM 100:2008 (GUM), section 5; ASME V&V 20-2009: comparison error and validation uncertainty.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from screwsim.figures import declared
from screwsim.figures.errors import error_in_unit
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.tolerances import split_coverage
from screwsim.scene.types import COVERAGE
from screwsim.scene.units import (
    NUMBER,
    gauge_pressures_over,
    is_gauge,
    not_a_difference,
    refused_at,
    tidy_unit,
    without_gauge,
)
from screwsim.scene.values import shown, within
from screwsim.study.asked.figure_units import percent_are_points
from screwsim.study.asked.figures import figure_of
from screwsim.study.asked.goals import of_ambient, read_figure, refuse_twice
from screwsim.study.asked.inputs import unit_behind
from screwsim.study.asked.varied import Varied, faults_of, leaf_of, with_values
from screwsim.study.pool.solving import results_at
from screwsim.study.uncertainty.point import sensitivities
from screwsim.study.uncertainty.slopes import Sensitivities
from screwsim.study.uncertainty.spreads import tolerances_of

OPTION, EXAMPLE = "--measured", "shaft_power=132 kW ± 2 kW"
AGREEMENT_LIMIT = 2.0  # standard uncertainties within which both agree
LARGEST_CHANGE = 0.5  # of a number: a derivative does not hold for a larger change
LARGEST_CHANGE_KELVIN = 30.0  # likewise for a temperature, half of which would be meaningless: a tenth of it
LARGEST_REMAINDER = 0.9  # a number that leaves a larger part of the differences, in squares, explains nothing
MOST_SOLVED = 8  # explanations at whose values the scene is solved
_SIGN = re.compile(r"\s*(?:±|\+/-|\+-)\s*")


class MeasuredFigure(NamedTuple):
    """A measured figure [SI] and its standard uncertainty, None where it is not stated."""

    figure: str
    value: float
    standard: float | None


class ComparedFigure(NamedTuple):
    """A figure of the scene beside its measured value [SI], with the uncertainties of their difference.

    `numerical` and `inputs` are standard uncertainties of the scene's figure, `model` both ends of the model error
    (computed less measured) where the scene names a validation that knows it. `sigma` is the difference over the
    combined standard uncertainty without the model's, None where that of the measurement is not stated.
    """

    figure: str
    value: float
    measured: MeasuredFigure
    numerical: float
    inputs: float
    model: tuple[float, float] | None
    sigma: float | None

    @property
    def off(self) -> float:
        """Computed less measured value [SI]."""
        return self.value - self.measured.value

    @property
    def within_model(self) -> bool:
        """Return whether the difference lies within the known model error."""
        return self.model is not None and self.model[0] <= self.off <= self.model[1]


class Explanation(NamedTuple):
    """A number of the scene [SI] and the value it would need to explain the differences alone.

    `left` is the part of the differences, in squares, that then remains by derivatives, `solved` that of the scene
    solved at that value, None where it was not. `tolerances` is the change over the tolerance that the scene states for
    the number, None where it states none.
    """

    path: str
    value: float
    wanted: float
    left: float
    tolerances: float | None
    solved: float | None = None


@dataclass(frozen=True)
class Comparison:
    """Measured figures beside computed ones; `none` says why figures have no value, `why` why nothing is explained.

    `dismissed` are numbers that explain by derivatives but not when the scene is solved, and what is found there.
    `weighted` says whether the differences were weighted by uncertainties; else they were by the measured values.
    """

    rows: tuple[ComparedFigure, ...]
    none: Mapping[str, str] = field(default_factory=dict)
    explanations: tuple[Explanation, ...] = ()
    weighted: bool = True
    why: str = ""
    dismissed: Mapping[str, str] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        """Return what `run --json` prints under `measured`, SI units; `expanded` is half of a 95 % interval."""
        figures = {
            row.figure: {
                "value": row.value,
                "measured": row.measured.value,
                "difference": row.off,
                "sigma": row.sigma,
                "expanded": {
                    "measured": None if row.measured.standard is None else COVERAGE * row.measured.standard,
                    "numerical": COVERAGE * row.numerical,
                    "inputs": COVERAGE * row.inputs,
                },
                "model": None if row.model is None else {"low": row.model[0], "high": row.model[1]},
            }
            for row in self.rows
        }
        explained = [explanation._asdict() for explanation in self.explanations]
        return {
            "figures": figures,
            "none": dict(self.none),
            "explanations": explained,
            "dismissed": dict(self.dismissed),
            "message": self.why,
        }


def read_measured(scene: Varied, texts: Iterable[str]) -> tuple[MeasuredFigure, ...]:
    """Return the measurements of texts FIGURE=VALUE, FIGURE=VALUE ± UNCERTAINTY or FIGURE=VALUE ± UNCERTAINTY (k=K).

    Without k the uncertainty is half of the 95 % interval. Raise UsageError in one line.
    """
    found = tuple(_read(scene, text) for text in texts)
    refuse_twice(OPTION, [each.figure for each in found])
    return found


def _read(scene: Varied, text: str) -> MeasuredFigure:
    name, equals, stated = (part.strip() for part in text.partition("="))
    value, *behind = (part.strip() for part in _SIGN.split(stated))
    bare = any(not part or part.startswith("(") for part in behind)  # no number behind ±, or (k=1) alone
    if not (name and equals and value) or len(behind) > 1 or bare:
        raise UsageError(f"{OPTION} {text}: is not FIGURE=VALUE ± UNCERTAINTY (write e.g. {OPTION} '{EXAMPLE}')")
    figure, where = figure_of(scene, name, OPTION), f"{OPTION} {text}"
    with refused_at(where):
        half, factor = split_coverage(behind[0] if behind else "", COVERAGE)
    unit = unit_behind(half)
    if unit not in ("", "%") and re.fullmatch(NUMBER, value):
        value = f"{value} {unit}"  # 132 ± 2 kW
    with gauge_pressures_over(of_ambient(scene)):
        number = read_figure(figure, value, where)
    if not math.isfinite(number):
        raise UsageError(f"{where}: {value} is not a value that can be measured")
    return MeasuredFigure(figure, number, _size(figure, number, value, half, where) / factor if behind else None)


def _size(figure: str, number: float, value: str, text: str, where: str) -> float:
    """Return an uncertainty [SI] from its text; percent are of the value, or points (`percent_are_points`)."""
    unit, own = unit_behind(text), unit_behind(value)
    if not unit and own:  # 132 kW ± 2, 90 degC ± 2
        text = f"{text} {'K' if declared(figure).units == 'K' and tidy_unit(own) == 'degC' else without_gauge(own)}"
    if tidy_unit(unit_behind(text)) in ("degC", "degF"):
        raise UsageError(f"{where}: {not_a_difference(f'the tolerance {shown(text)}')}")
    if unit == "%" and declared(figure).units == "K":
        raise UsageError(f"{where}: a percentage of a temperature depends on its zero (write kelvin, e.g. ± 2 K)")
    if unit == "%" and is_gauge(value):
        raise UsageError(f"{where}: a percentage of a gauge pressure depends on its zero (write e.g. ± 0.1 bar)")
    if unit == "%" and not percent_are_points(figure, own == "%"):
        share = re.fullmatch(rf"({NUMBER})\s*%", text)
        size = 0.01 * float(share[1]) * abs(number) if share else math.nan
    else:
        size = read_figure(figure, text, where, "uncertainty")
    if not 0.0 < size < math.inf:
        raise UsageError(f"{where}: an uncertainty must be above 0 (write e.g. {OPTION} '{EXAMPLE}')")
    return size


def compare_measured(scene: Varied, result: Result, measured: Sequence[MeasuredFigure]) -> Comparison:
    """Return measured figures beside those of a result, and which numbers could explain the differences."""
    if not result.performance:
        return Comparison((), why=f"nothing to compare, as the point has no figures: {result.told}")
    values, reasons = result.performance, result.notes
    rows = tuple(_compared(result, each) for each in measured if values.get(each.figure) is not None)
    lacking = [each.figure for each in measured if values.get(each.figure) is None]
    none = {name: reasons.get(name, "it has no value in this cycle") for name in lacking}
    if not rows or result.status != "ok":
        return Comparison(rows, none, why="" if rows else "nothing to compare")
    if all(row.sigma is not None and abs(row.sigma) <= AGREEMENT_LIMIT for row in rows):
        return Comparison(rows, none, why="nothing to explain")
    weighted = all(row.sigma is not None for row in rows)
    try:
        found = sensitivities(scene, None, [row.figure for row in rows], fine=False, progress=False, result=result)
    except UsageError as error:
        return Comparison(rows, none, weighted=weighted, why=f"no explanation can be computed: {error}")
    linear = explanations(scene, found, rows, weighted)
    solved, dismissed = _solved(scene, rows, weighted, linear[:MOST_SOLVED])
    return Comparison(rows, none, (*solved, *linear[MOST_SOLVED:]), weighted, dismissed=dismissed)


def _compared(result: Result, measured: MeasuredFigure) -> ComparedFigure:
    name, value = measured.figure, float(result.performance[measured.figure])
    inputs = result.uncertainty.get("figures", {}).get(name, {}).get("standard", 0.0)
    told = result.uncertainty.get("model", {}).get("figures", {}).get(name)
    model = None if told is None else (float(told["low"]), float(told["high"]))
    numerical = (error_in_unit(name, result.performance, result.error) or 0.0) / COVERAGE
    sigma = None
    if measured.standard is not None:
        sigma = (value - measured.value) / math.hypot(measured.standard, inputs, numerical)
    return ComparedFigure(name, value, measured, numerical, inputs, model, sigma)


def explanations(
    scene: Varied, found: Sensitivities, rows: Sequence[ComparedFigure], weighted: bool
) -> tuple[Explanation, ...]:
    """Return the numbers of which one alone could explain the differences, those that leave and change least first.

    By least squares, each difference over its standard uncertainty, or over the measured value where one has none.
    """
    scales = _scales(rows, weighted)
    off = [row.off / scale if scale else 0.0 for row, scale in zip(rows, scales, strict=True)]
    whole = sum(each * each for each in off)
    kept, uncertain = [], tolerances_of(scene).uncertain
    for path, value in found.values.items():
        slopes = [found.derivatives[row.figure].get(path, 0.0) for row in rows]
        slopes = [slope / scale if scale else 0.0 for slope, scale in zip(slopes, scales, strict=True)]
        square = sum(slope * slope for slope in slopes)
        if not square or not value or not whole:
            continue
        change = -sum(slope * each for slope, each in zip(slopes, off, strict=True)) / square
        left = sum((each + slope * change) ** 2 for slope, each in zip(slopes, off, strict=True)) / whole
        if left <= LARGEST_REMAINDER and _is_possible_change(scene, path, value, change):
            stated = uncertain.get(path)
            share = None if stated is None else change / (COVERAGE * stated.standard_at(value))
            kept.append(Explanation(path, value, value + change, left, share))
    return tuple(sorted(kept, key=lambda each: (round(each.left, 1), abs(each.wanted / each.value - 1.0))))


def _scales(rows: Sequence[ComparedFigure], weighted: bool) -> list[float]:
    """Return what each difference counts over: its standard uncertainty, or the measured value."""
    return [abs(row.off / row.sigma) if weighted and row.sigma else abs(row.measured.value) for row in rows]


def _solved(
    scene: Varied, rows: Sequence[ComparedFigure], weighted: bool, linear: Sequence[Explanation]
) -> tuple[list[Explanation], dict[str, str]]:
    """Return the explanations that hold when the scene is solved at their values, and why the others do not."""
    if not linear:
        return [], {}
    if isinstance(scene, Scene):
        scene = replace(scene, numerics=replace(scene.numerics, error="none"))
    results = results_at(scene, [{each.path: each.wanted} for each in linear])
    pairs = list(zip(rows, _scales(rows, weighted), strict=True))
    whole = sum((row.off / scale) ** 2 for row, scale in pairs if scale)
    kept, dismissed = [], {}
    for each, result in zip(linear, results, strict=True):
        values = [result.performance.get(row.figure) for row in rows]
        if result.status != "ok" or None in values:
            dismissed[each.path] = f"has no solution there: {result.told or 'a figure has no value'}"
            continue
        off = (
            (value - row.measured.value) / scale
            for (row, scale), value in zip(pairs, values, strict=True)
            if value is not None and scale
        )
        left = sum(one * one for one in off) / whole
        if left > LARGEST_REMAINDER:
            dismissed[each.path] = f"leaves {100.0 * left:.0f} % when solved, {100.0 * each.left:.0f} % by derivatives"
        else:
            kept.append(each._replace(solved=left))
    return sorted(kept, key=lambda each: (round(each.solved or 0.0, 1), abs(each.wanted / each.value - 1.0))), dismissed


def _is_possible_change(scene: Varied, path: str, value: float, change: float) -> bool:
    """Return whether a number [SI] may change this far: within reach of a derivative, its limits, and the scene."""
    leaf = leaf_of(scene, path)
    farthest = LARGEST_CHANGE_KELVIN if leaf.kind == "temperature" else LARGEST_CHANGE * abs(value)
    if abs(change) > farthest or not within(leaf, value + change):
        return False
    return not faults_of(with_values(scene, {path: value + change}))
