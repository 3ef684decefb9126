"""A study in words: the Pareto front, one plain sentence, and tables of at most 100 columns."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from screwsim.outputs.display import aligned
from screwsim.study.accuracy.measure import MeasuredCase

if TYPE_CHECKING:
    from screwsim.study.accuracy import Study

WIDTH = 96
SUMMARY_ACCURACIES = (1e-3, 1e-4, 1e-6)  # accuracies in the sentence, where they were asked for


def sentence(study: Study) -> str:
    """Return the cost of accuracy, in one sentence made from the results."""
    solved = [each for each in study.asked if each.status == "ok"]
    told = [each for each in solved if any(math.isclose(each.asked, want) for want in SUMMARY_ACCURACIES)] or solved
    parts = []
    for each in told:
        verb = "" if parts else "costs "
        seconds = milliseconds(each.time + each.estimating_time)
        parts.append(f"{plain_power(each.asked)} {verb}{seconds} (true error {plain_power(each.error)})")
    text = ", ".join(parts) if parts else "no requested accuracy was reached"
    limit = study.limit_of_regularisation
    if limit is not None:
        accuracy = plain_power(study.accuracy)
        text += f"; the model's regularisation at the scene's accuracy of {accuracy} limits you to {plain_power(limit)}"
    return text + "."


def plain_power(value: float) -> str:
    """Return 1e-3 rather than 1e-03."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def milliseconds(seconds: float) -> str:
    """Return a time in ms with two digits."""
    ms = 1e3 * seconds
    return f"{ms:.2g} ms" if ms < 99.5 else f"{ms:.0f} ms"


def _number(value: float, form: str) -> str:
    return format(value, form) if math.isfinite(value) else "-"


def _requested_table(study: Study) -> list[str]:
    rows = [
        (
            plain_power(each.asked),
            each.status.replace("_", " "),
            each.closing,
            f"{1e3 * each.time:.3g}",
            f"{1e3 * each.estimating_time:.2g}",
            str(each.evaluations),
            _number(each.estimated, ".1e"),
            _number(each.error, ".1e"),
            _short(each.figure),
        )
        for each in study.asked
    ]
    heads = ("asked", "status", "closing", "ms", "+ ms", "RHS", "estimate", "true", "of")
    return ["Requested and reached accuracy (+ ms: for the estimate)", *aligned([heads, *rows], (1, 2, 8))]


def _short(figure: str) -> str:
    """Return a figure's name for a narrow column."""
    return figure.replace("_", " ").replace("efficiency", "eff.").replace("capacity", "cap.")


_TITLES = {
    "integrators": "Integrators, on the scene's own gas (*: no other is both faster and more accurate)",
    "back ends": "Property back ends, each against a reference of the same gas (change: in the answer)",
    "breakpoints": "Stepping onto breakpoints of the laws, at the scene's accuracy",
    "regularisation": "Width of the regularisation, relative to the default at the scene's accuracy",
    "regularisation alone": "The same with all else tight: the error from the regularisation itself",
    "closure": "Closing tolerance, relative to the default at the scene's accuracy",
    "dead volume": "Dead volume, relative to the scene's: a parameter of the machine (change: in the answer)",
}


def _part_table(study: Study, part: str, best: Sequence[MeasuredCase]) -> list[str]:
    rows, changing = [], any(math.isfinite(m.change) for m in study.measured if m.part == part)
    for each in study.measured:
        if each.part != part or each.status == "left out":
            continue
        row = [
            each.label.replace("scipy-", "scipy "),
            plain_power(each.asked),
            f"{1e3 * each.time:.3g}",
            str(each.evaluations),
            _number(each.error, ".1e"),
            _short(each.figure) if each.status == "ok" else each.status.replace("_", " "),
            _number(each.pressure_error, ".0e"),
            _number(each.temperature_error, ".0e"),
        ]
        row += [_number(each.change, ".1e")] if changing else []
        rows.append([*row, "*" if any(each is one for one in best) else ""] if part == "integrators" else row)
    heads = ["", "asked", "ms", "RHS", "error", "of", "p", "T", *(["change"] if changing else [])]
    heads += [""] if part == "integrators" else []
    return [_TITLES[part], *aligned([heads, *rows], (0, 5))] if rows else []


def _effects_table(study: Study) -> list[str]:
    rows = []
    for each in study.effects:
        cells = (
            (each.time, "+.0%"),
            (each.evaluations, "+.0%"),
            (each.efficiency, "+.2f"),
            (each.shaft_power, "+.2%"),
            (each.gas_mass_flow, "+.2%"),
            (each.discharge_temperature, "+.1f"),
            (each.cooling_capacity, "+.2%"),
            (each.cop, "+.2%"),
        )
        rows.append([each.effect.replace("_", " "), *(_number(*cell) for cell in cells)])
    if not rows:
        return []
    heads = ("effect", "time", "RHS", "eta", "power", "flow", "T_d", "capacity", "COP")
    notes = []
    for each in study.effects:
        if each.reason:
            text = f"{each.effect.replace('_', ' ')}: {each.reason}"
            notes += textwrap.wrap(text, WIDTH, initial_indent="  ", subsequent_indent="    ")
    return [
        "What each effect costs and changes, compared with leaving it out",
        "(eta: isothermal or isentropic efficiency, points; power: shaft; T_d: discharge, K;",
        "capacity, COP: where the scene states a condenser; COP of the electrical power with a motor)",
        *aligned([heads, *rows], (0,)),
        *notes,
    ]


def _size_table(study: Study) -> list[str]:
    lines = []
    if study.points:
        rows = [(str(s.size), f"{s.time:.3g}", f"{1e3 * s.time / s.size:.3g}") for s in study.points]
        heads = ("points of a sweep", "s", "ms a point")
        lines += ["Size: a whole sweep over the speed, including workers and file", *aligned([heads, *rows], (0,))]
    good = [s for s in study.lobes if not s.reason]
    if good:
        rows = [(str(s.size), f"{1e3 * s.time:.3g}", str(s.evaluations)) for s in good]
        lines += ["", "Size: male lobes", *aligned([("male lobes", "ms", "RHS"), *rows], (0,))]
    return lines


def report(study: Study) -> str:
    """Return the whole study as text."""
    reference = study.reference
    text = f"Reference: {reference.how}. "
    if math.isfinite(reference.difference):
        p, T = reference.traces_difference
        text += (
            f"{reference.second} differs by {reference.difference:.1e} "
            f"({reference.different_figure.replace('_', ' ')}), traces of p by {p:.0e}, of T by {T:.0e}: "
            "errors of about this size are those of the references."
        )
    else:
        text += f"It is not checked, because {reference.second} gave no answer."
    blocks = [[study.title] if study.title else [], textwrap.wrap(text, WIDTH), _requested_table(study)]
    best = study.front()
    blocks += [_part_table(study, part, best) for part in _TITLES]
    lines = ["What failed or was left out"]
    for name, reason in study.left_out:
        lines += textwrap.wrap(f"{name}: {reason}", WIDTH, initial_indent="- ", subsequent_indent="  ")
    blocks += [_effects_table(study), _size_table(study), lines, textwrap.wrap(sentence(study), WIDTH)]
    return "\n\n".join("\n".join(lines) for lines in blocks if lines)
