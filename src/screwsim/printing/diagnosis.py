"""What `screwsim diagnose` prints."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from screwsim.printing.fits import print_left_out, print_title
from screwsim.printing.tables import plain_table, wrapped
from screwsim.screen import say
from screwsim.study.calibration.diagnosis import CHANCE, LEVEL, LIKELY, NONE, Diagnosis, Hypothesis
from screwsim.study.inputs import unit_of_change

NOTHING = "nothing changed"


def diagnosis_document(found: Diagnosis) -> dict[str, Any]:
    """Return what `diagnose --json` prints; SI units."""
    return {
        "title": found.fit.title,
        "status": found.status,
        "message": found.message,
        "level": LEVEL,
        "unchanged": dict(found.unchanged),
        "hypotheses": [asdict(each) | {"path": each.path or None} for each in found.hypotheses],
        "not_told_apart": [each._asdict() for each in found.alike],
        "probability_of_a_misfit_as_large": found.chance,
        "uncertain_inputs": list(found.inputs),
        "points_without_solution": dict(found.reasons),
        "solutions": found.solutions,
        "failed_solutions": found.failed,
    }


def print_diagnosis(found: Diagnosis) -> None:
    """Print the hypotheses, the most probable first, and what the points do not tell apart."""
    fit = found.fit
    print_title(fit)
    points = [point for point in fit.points if point.fitted]
    figures = sum(len(point.measured) for point in points)
    count = f"{len(points)} points, {figures} measured figures, {found.solutions} solutions"
    say(
        wrapped(f"{Path(fit.scene_file).name}; {count}" + (f", {found.failed} without figures" if found.failed else ""))
    )
    print_left_out(found.reasons)
    if not found.hypotheses:
        say(wrapped(f"{found.status}: {found.message}"))
        return
    say()
    heads = ["what changed", "probability", "by", f"{LEVEL:.0%} interval", "now", "", "misfit"]
    say("\n".join(plain_table(heads, [_row(found, each) for each in found.hypotheses], 1)))
    say()
    for line in _told(found):
        say(wrapped(line))


def _row(found: Diagnosis, each: Hypothesis) -> list[str]:
    probability = _probability(each.probability)
    misfit = f"{each.misfit:.3g}"
    if each.path == NONE or each.value is None:
        return [NOTHING, probability, "", "", "", "", misfit]
    name = _name(found, each.path) + (" *" if each.linear else "")
    per, unit = unit_of_change(found.fit.scene, each.path, each.value)
    low, high = (f"{per * (by or 0.0):+.2g}" for by in (each.low, each.high))
    return [
        name,
        probability,
        f"{per * (each.change or 0.0):+.3g}",
        f"{low} … {high}",
        f"{per * each.value:.4g}",
        unit,
        misfit,
    ]


def _change(found: Diagnosis, each: Hypothesis) -> str:
    per, unit = unit_of_change(found.fit.scene, each.path, each.value or 0.0)
    return f"{per * (each.change or 0.0):+.3g} {unit}".strip()


def _name(found: Diagnosis, path: str) -> str:
    names = dict(zip((each.path for each in found.fit.parameters), found.fit.short_names(), strict=True))
    return names[path]


def _probability(value: float) -> str:
    return "< 0.0001" if value < 1e-4 else "> 0.9999" if value > 0.9999 else f"{value:.4f}"


def _told(found: Diagnosis) -> Iterator[str]:
    best = found.hypotheses[0]
    what = NOTHING if best.path == NONE else f"{best.path} has changed by {_change(found, best)}"
    yield f"most probable: {what} ({_probability(best.probability)})"
    for each in found.hypotheses:
        if each.also and each.probability > LIKELY:
            per, unit = unit_of_change(found.fit.scene, each.path, each.value or 0.0)
            values = ", ".join(f"{per * value:.4g} {unit}".strip() for value in each.also)
            yield f"{each.path} = {values} fits nearly as well as the best of its values"
    for each in found.alike:
        yield (
            f"not told apart: {each.first} and {each.second}: their changes make the same of all points together, "
            f"within {each.off:.2g} uncertainties (screwsim plan says which points would tell)"
        )
    if found.chance is not None and found.chance < CHANCE:
        yield (
            f"warning: the best misfit is {best.misfit:.4g} of {best.freedom} degrees of freedom, which chance makes "
            f"in {found.chance:.1g} of all cases: several have changed, or something else, or the uncertainties are "
            "too small"
        )
    beside = f"; {', '.join(found.inputs)} known as tolerances and priors say" if found.inputs else ""
    yield f"misfit: chi squared at the best estimate of each{beside}"
    if any(each.linear for each in found.hypotheses):
        yield "* by the slopes of the unchanged machine alone (hardly probable, or without another solution)"
