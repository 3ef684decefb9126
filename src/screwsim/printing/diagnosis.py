"""Output of `screwsim diagnose`."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from screwsim.outputs.display import picked
from screwsim.printing.tables import (
    print_left_out,
    print_scene_title,
    print_table,
    print_text,
    print_wrapped,
    shown_chance,
)
from screwsim.screen import say
from screwsim.study.asked.inputs import CELSIUS, in_customary, shown_number, shown_value, unit_of_change
from screwsim.study.calibration.diagnosis import Diagnosis
from screwsim.study.calibration.hypotheses import (
    INTERVAL_LEVEL,
    LEAST_CHANCE,
    LIKELY_PROBABILITY,
    NO_CHANGE,
    Change,
    Hypothesis,
)
from screwsim.study.calibration.identifiability import BOUND_DISTANCE
from screwsim.study.uncertainty.spreads import not_included

NOTHING_CHANGED = "nothing changed"
ANY_VALUE = "any"  # value of a parameter about which the points say almost nothing
LEAST_PROBABILITY_IN_WORDS = 0.01  # probability above which a hypothesis is put into words, ...
MOST_IN_WORDS = 4  # ... and how many are at most


def diagnosis_document(found: Diagnosis) -> dict[str, Any]:
    """Return what `diagnose --json` prints, in SI units."""
    return {
        "title": found.fit.title,
        **picked(found, "status", "message"),
        "level": INTERVAL_LEVEL,
        **picked(found, "unchanged", odds_of_two_changes_against_one="odds"),
        "hypotheses": [_hypothesis(hypothesis) for hypothesis in found.hypotheses],
        "changed": found.changed,
        "not_told_apart": [each._asdict() for each in found.alike],
        **picked(found, told_next_to_nothing_of="untold", probability_of_a_misfit_as_large="chance"),
        **picked(found, uncertain_inputs="inputs", points_without_solution="reasons"),
        "left_out": dict(found.left_out),
        "misread_units": list(found.misread),
        **picked(found, "solutions", failed_solutions="failed"),
    }


def _hypothesis(each: Hypothesis) -> dict[str, Any]:
    own = ("probability", "log_evidence", "misfit", "freedom", "value", "change", "low", "high", "linear", "also")
    return {"path": each.path or None, **picked(each, *own), "changes": [one._asdict() for one in each.changes]}


def print_diagnosis(found: Diagnosis) -> None:
    """Print the hypotheses, the most probable first, and what the points cannot distinguish."""
    fit = found.fit
    print_scene_title(fit.title or fit.scene.title)
    points = fit.fitted
    figures = sum(len(point.measured) for point in points)
    count = f"{len(points)} points, {figures} measured figures, {found.solutions} solutions"
    count += f", {found.failed} without figures" if found.failed else ""
    print_text(f"{Path(fit.scene_file).name}; {count}")
    print_left_out(found.reasons)
    if not found.hypotheses:
        print_text(f"{found.status}: {found.message}")
        return
    say()
    heads = ["what changed", "probable", "by", f"{INTERVAL_LEVEL:.0%} interval", "now", "", "misfit"]
    shown = [each for each in found.hypotheses if len(each.changes) < 2 or each.probability > LIKELY_PROBABILITY]
    print_table(heads, [row for each in shown for row in _rows(found, each)], 1)
    say()
    print_wrapped(_findings(found))


def _rows(found: Diagnosis, each: Hypothesis) -> Iterator[list[str]]:
    """Yield the row of a hypothesis; for one of two changes, a row for each."""
    beside = [_probability(each.probability), f"{each.misfit:.3g}"]
    if each.path == NO_CHANGE:
        yield [NOTHING_CHANGED, beside[0], "", "", "", "", beside[1]]
    for number, change in enumerate(each.changes):
        name = "+ " * (number > 0) + _name(found, change.path)
        mark = " *" if each.linear and number + 1 == len(each.changes) else ""
        per, unit = unit_of_change(found.fit.scene, change.path, change.value)
        low, high = (f"{per * by:+.2g}" for by in (change.low, change.high))
        probability, misfit = ("", "") if number else beside
        value, own = _value(found, change.path, change.value)
        sizes = [f"{per * change.change:+.3g}", f"{low} … {high}", value, own]
        if change.path in found.untold:
            sizes = [ANY_VALUE, f"{low} … {high}", "", unit]
        yield [name + mark, probability, *sizes, misfit]


def _value(found: Diagnosis, path: str, value: float) -> tuple[str, str]:
    """Return a value [SI] of a path in the unit of its changes, and that unit; a temperature in °C."""
    if in_customary(found.fit.scene, path, value)[1] == CELSIUS:
        return shown_number(found.fit.scene, path, value), CELSIUS
    per, unit = unit_of_change(found.fit.scene, path, value)
    return f"{per * value:.4g}", unit


def _amount(found: Diagnosis, change: Change) -> str:
    """Return by how much a parameter has changed; any amount, if the points say nothing about it."""
    if change.path in found.untold:
        return f"{ANY_VALUE} amount"
    per, unit = unit_of_change(found.fit.scene, change.path, change.value)
    return f"{per * change.change:+.3g} {unit}".strip()


def _hypothesis_text(found: Diagnosis, hypothesis: Hypothesis) -> str:
    """Return a hypothesis in a few words, with its probability."""
    parts = [f"{_name(found, change.path)} {_amount(found, change)}" for change in hypothesis.changes]
    return f"{' and '.join(parts) or NOTHING_CHANGED}: {_probability(hypothesis.probability)}"


def _name(found: Diagnosis, path: str) -> str:
    return found.fit.short_names()[path]


def _probability(value: float) -> str:
    if value < 1e-4:
        return "< 0.01 %"
    return "> 99.99 %" if value > 0.9999 else f"{100.0 * value:.3g} %" if value < 0.9995 else f"{100.0 * value:.2f} %"


def _findings(found: Diagnosis) -> Iterator[str]:
    """Yield what the hypotheses say in words: the most probable ones, what the points cannot tell, and warnings."""
    best, *others = found.hypotheses
    amounts = [f"{change.path} has changed by {_amount(found, change)}" for change in best.changes]
    what = " and ".join(amounts[:1] + [text.replace(" has changed", "") for text in amounts[1:]])
    yield f"most probable: {what or NOTHING_CHANGED} ({_probability(best.probability)})"
    yield from _changes_at_bounds(found, best)
    probable = [other for other in others if other.probability > LEAST_PROBABILITY_IN_WORDS]
    if probable:
        yield f"then {'; '.join(_hypothesis_text(found, each) for each in probable[:MOST_IN_WORDS])}"
    pairs = [hypothesis for hypothesis in found.hypotheses if len(hypothesis.changes) == 2]
    if pairs:
        yield from _pairs_of_changes(found, pairs)
    yield from _other_values(found)
    for each in found.alike:
        yield (
            f"indistinguishable: {each.first} and {each.second}: their changes affect all points alike, within "
            f"{each.off:.2g} uncertainties (screwsim plan finds points that separate them)"
        )
    for path in found.untold:
        yield f"warning: the points hardly constrain {path}: any value within its bounds fits as well"
    if found.chance is not None and found.chance < LEAST_CHANCE:
        yield (
            f"warning: the best misfit is {best.misfit:.4g} of {best.freedom} degrees of freedom, which chance alone "
            f"produces in {shown_chance(found.chance)} of all cases: {'more than two' if pairs else 'several'} "
            f"have changed, something else did, or the uncertainties are too small"
        )
    beside = f"; {', '.join(found.inputs)} known to within their tolerances and priors" if found.inputs else ""
    yield from (f"warning: {text}" for text in found.misread)
    yield f"misfit: chi squared at the best estimate of each{beside}"
    yield from (f"warning: {text}" for text in not_included(found.left_out))
    if any(hypothesis.linear for hypothesis in found.hypotheses):
        yield "* from the slopes of the unchanged machine only (improbable, or no other solution was found)"


def _changes_at_bounds(found: Diagnosis, best: Hypothesis) -> Iterator[str]:
    parameters = {parameter.path: parameter for parameter in found.fit.parameters}
    for change in best.changes:
        parameter = parameters[change.path]
        for end, bound in (("lower", parameter.low), ("upper", parameter.high)):
            if abs(change.value - bound) <= BOUND_DISTANCE * (parameter.high - parameter.low):
                at = shown_value(found.fit.scene, change.path, bound, 4)
                yield f"warning: {change.path} is at its {end} bound, {at}; it may have changed by more"


def _pairs_of_changes(found: Diagnosis, pairs: Sequence[Hypothesis]) -> Iterator[str]:
    """Yield what is known of each parameter alone or with another, and how many pairs were considered."""
    likely = {path: chance for path, chance in found.changed.items() if chance > LEAST_PROBABILITY_IN_WORDS}
    if likely and found.hypotheses[0].path != NO_CHANGE:
        changed = [f"{_name(found, path)} {_probability(chance)}" for path, chance in likely.items()]
        yield f"changed, alone or with another: {', '.join(changed)}"
    hidden = [pair.probability for pair in pairs if pair.probability <= LIKELY_PROBABILITY]
    shown = f", of which {len(hidden)} are not shown: {_probability(sum(hidden))} together" if hidden else ""
    count = "1 pair of changes was" if len(pairs) == 1 else f"{len(pairs)} pairs of changes were"
    yield f"{count} considered{shown}; two changes at once are a priori {found.odds:g} times as probable as one"


def _other_values(found: Diagnosis) -> Iterator[str]:
    """Yield the other values of a parameter that fit nearly as well as its best."""
    for hypothesis in found.hypotheses:
        if hypothesis.also and hypothesis.probability > LIKELY_PROBABILITY and hypothesis.path not in found.untold:
            values = ", ".join(" ".join(_value(found, hypothesis.path, each)).strip() for each in hypothesis.also)
            yield f"{hypothesis.path} = {values} fits nearly as well as its best value"
