"""Output of `screwsim calibrate`, printed and written."""

import math
import os
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from screwsim.figures.engineering import shown_name
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.outputs.display import grouped, picked
from screwsim.printing import write_json
from screwsim.printing.fitted_points import lines_of_points, pictures
from screwsim.printing.tables import (
    print_scene_title,
    print_table,
    print_text,
    print_wrapped,
    shown_chance,
)
from screwsim.report.style import write_all
from screwsim.results.atomic import make_folder, write_text
from screwsim.results.protection import protect_other_json, protect_other_text
from screwsim.results.warning_kinds import kinds_of
from screwsim.scene import conventions
from screwsim.screen import say
from screwsim.study.asked.inputs import WITHOUT_ZERO, in_customary, shown_number, shown_value, unit_of_change
from screwsim.study.asked.varied import leaf_of, value_at
from screwsim.study.calibration.fit import TOLERANCE_REMEDY, Parameter, Prior
from screwsim.study.calibration.hypotheses import LEAST_CHANCE, chance_of_misfit
from screwsim.study.calibration.identifiability import CORRELATED, NOTHING, WEAK_VALUE
from screwsim.study.calibration.other_inputs import errors_by_inputs
from screwsim.study.calibration.solve import Calibration, ComparedMeasurement
from screwsim.study.scene_files import FITTED_LINE, fitted_text, refuse_base
from screwsim.study.uncertainty.spreads import not_included

SCENE, DOCUMENT = "scene.yaml", "fit.json"
# share of chi squared that at most one number in ten, or one of fewer than twenty, makes up, if it is named
MOST_OF_MISFIT, OUTLIERS_OF = 0.5, 10
FACTOR_FROM = 2.0  # change of a parameter from which on it is told as a factor
_HALF_INTERVAL = "taken as half of a 95 % interval, two standard deviations (prior: none omits it)"


def calibration_document(found: Calibration) -> dict[str, Any]:
    """Return what `calibrate --json` prints, in SI units."""
    known, other = found.certainty, conventions.of_scene(found.fit.scene)
    return {
        "title": found.fit.title,
        **({"convention": other} if other else {}),
        "scene": os.path.relpath(found.fit.scene_file),
        **picked(found, "status", "message"),
        "accuracy": found.fit.scene.numerics.accuracy,
        "parameters": {each.path: _parameter(found, index, each) for index, each in enumerate(found.fit.parameters)},
        "other_inputs": [
            {"paths": list(each.paths), "changes": dict(zip(found.values, each.changes, strict=True))}
            for each in found.shifts
        ],
        "left_out": dict(found.left_out),
        "misread_units": list(found.misread),
        "correlation": None if known is None else known.correlation,
        "singular_values": None if known is None else known.singular,
        "not_told_apart": [] if known is None else [asdict(each) for each in known.open],
        **picked(found, "chi_squared", degrees_of_freedom="freedom", scale_of_standard_errors="scale"),
        **picked(found, as_good_within="margin", as_good_starts="as_good"),
        "starts": [asdict(each) | {"cost": each.cost if each.cost < float("inf") else None} for each in found.starts],
        "points": [_compared(each) for each in found.compared],
        "points_without_solution": found.reasons,
        "warnings": {name: list(texts) for name, texts in found.warnings.items()},
        "seed": found.fit.seed,
        **picked(found, "solutions", failed_solutions="failed", jacobians="jacobians"),
        "slopes": {path: why or "exact" for path, why in found.methods.items()},
    }


def _parameter(found: Calibration, index: int, parameter: Parameter) -> dict[str, Any]:
    known, low_high = found.certainty, spread(found, index)
    error = None if known is None else known.errors[index]
    groups = (group for group in found.fit.together if index in group)
    return {
        "value": found.values.get(parameter.path),
        "standard_error": error,
        "standard_error_scaled": None if error is None else error * found.scale,
        "standard_error_by_other_inputs": None if error is None or not found.shifts else _by_inputs(found)[index],
        "from": parameter.low,
        "to": parameter.high,
        "at_bound": "" if known is None else known.border[index],
        "as_good_from": low_high[0],
        "as_good_to": low_high[1],
        "prior": None if parameter.prior is None else _prior(parameter.prior),
        "errs_together_with": [found.fit.parameters[i].path for group in groups for i in group if i != index],
    }


def _by_inputs(found: Calibration) -> tuple[float, ...]:
    return errors_by_inputs(found.shifts, len(found.fit.parameters))


def _prior(prior: Prior) -> dict[str, Any]:
    """Return a prior; the deviation of a lognormal one is that of the logarithm."""
    return {
        "mean": prior.mean,
        "deviation": prior.deviation,
        "distribution": "lognormal" if prior.logarithmic else "normal",
        "stated_in": "scene" if prior.of_scene else "fit",
    }


def _compared(each: ComparedMeasurement) -> dict[str, Any]:
    return {
        "point": each.point.name,
        "fitted": each.point.fitted,
        "conditions": dict(each.point.values),
        "figure": each.figure,
        **picked(each.measured, measured="value", uncertainty="uncertainty"),
        **picked(each, "ours", residual_over_uncertainty="residual"),
    }


def spread(found: Calibration, index: int) -> tuple[float | None, float | None]:
    """Return the lowest and highest value [SI] of a parameter among the equally good fits."""
    parameter = found.fit.parameters[index]
    values = [parameter.value(found.starts[number].places[index]) for number in found.as_good]
    values += [found.values[parameter.path]] if values else []  # the best start continues from where it ended
    return (min(values), max(values)) if values else (None, None)


def print_calibration(found: Calibration) -> None:
    """Print the parameters, their uncertainty, the residuals, and what the data leave undetermined."""
    print_scene_title(found.fit.title or found.fit.scene.title)
    count = f"{found.solutions} solutions" + (f", {found.failed} without figures" if found.failed else "")
    print_text(f"{len(found.starts)} starts, seed {found.fit.seed}, {count}, {found.jacobians} Jacobians")
    print_wrapped(_methods(found))
    if other := conventions.of_scene(found.fit.scene):
        print_text(other)
    if found.message:
        print_text(f"{found.status}: {found.message}")
    if not found.values:
        return
    say()
    heads = ["", "value", "± standard error", "as good"]
    rows = [_row(found, index, parameter) for index, parameter in enumerate(found.fit.parameters)]
    if found.shifts:
        heads.insert(3, "± by other inputs")
        for index, row in enumerate(rows):
            row.insert(3, _width_by_inputs(found, index))
    tolerances = [_tolerance(found, parameter) for parameter in found.fit.parameters]
    if any(tolerances):
        heads.append(TOLERANCE_REMEDY)
        rows = [[*row, cell] for row, cell in zip(rows, tolerances, strict=True)]
    print_table(heads, rows, 1)
    if any(tolerances):
        print_text(f"{TOLERANCE_REMEDY}: {_HALF_INTERVAL}")
    print_text(f"changed from the scene's values: {', '.join(_changes(found))}")
    print_wrapped(_other_inputs(found))
    for group in found.fit.together:
        paths = ", ".join(found.fit.parameters[i].path for i in group)
        print_text(f"too large or too small together, by the scene's uncertainty.correlated: {paths}")
    say()
    say("\n".join(lines_of_points(found.compared)))
    say()
    print_wrapped((*_quality(found), *_warnings(found)))


def _methods(found: Calibration) -> Iterator[str]:
    """Yield how the slopes by the parameters were found, with parameters of the same method together."""
    names = found.fit.short_names()
    for why, some in grouped((why, names[path]) for path, why in found.methods.items()).items():
        which = "" if len(some) == len(names) else f" of {', '.join(some)}"
        yield f"slopes{which}: " + (f"differences ({why})" if why else "exact")


def _row(found: Calibration, index: int, parameter: Parameter) -> list[str]:
    scene, path = found.fit.scene, parameter.path
    known = found.certainty
    error = None if known is None else known.errors[index]
    width = ""
    if error is not None:
        width = f"{error * found.scale * _per_unit(found, parameter):.2g}"
    elif known is not None:
        width = f"{known.border[index]} bound" if known.border[index] else "not determined"
    low, high = spread(found, index)
    good = "" if low is None or high is None else " … ".join(shown_number(scene, path, each, 3) for each in (low, high))
    return [found.fit.short_names()[path], shown_value(scene, path, found.values[path], 4), width, good]


def _width_by_inputs(found: Calibration, index: int) -> str:
    """Return the standard error of a parameter by other inputs, in the unit of its value; '' at a bound."""
    if found.certainty is None or found.certainty.errors[index] is None:
        return ""
    return f"{_by_inputs(found)[index] * _per_unit(found, found.fit.parameters[index]):.2g}"


def _other_inputs(found: Calibration) -> Iterator[str]:
    """Yield what the errors by other inputs are, and the input that contributes most to that of each parameter."""
    if not found.shifts:
        return
    most = []
    for index, name in enumerate(found.fit.short_names().values()):
        whole = _by_inputs(found)[index] ** 2
        largest = max(found.shifts, key=lambda shift: abs(shift.changes[index]))
        if whole:
            share = largest.changes[index] ** 2 / whole
            most.append(f"{name} by {' + '.join(largest.paths)} ({share:.0%} of its variance)")
    yield (
        "by other inputs: standard error by the tolerances of inputs that are not fitted, off by the same at all "
        "points, on top of the one before it (as the root of the sum of squares)"
        + (f"; most of it: {', '.join(most)}" if most else "")
    )


def _changes(found: Calibration) -> Iterator[str]:
    """Yield by how much each parameter differs from the scene's value: a factor, a percentage, or a difference."""
    scene = found.fit.scene
    for path, name in found.fit.short_names().items():
        value, start = found.values[path], value_at(scene, path)
        if not isinstance(start, int | float):
            yield f"{name} (not stated there)"
            continue
        kind = leaf_of(scene, path).dimension
        ratio = value / start if start else math.nan
        if not ratio > 0.0 or (kind is not None and kind.name in WITHOUT_ZERO):
            per, unit = unit_of_change(scene, path, value)
            yield f"{name} {per * (value - start):+.3g} {unit}".rstrip()
        elif 1.0 / FACTOR_FROM < ratio < FACTOR_FROM:
            yield f"{name} {ratio - 1.0:+.1%}"
        else:
            yield f"{name} × {ratio:.3g}"


def _tolerance(found: Calibration, parameter: Parameter) -> str:
    """Return the tolerance that constrains a parameter, in the unit of its value, or that one is left out; else ''."""
    prior, path = parameter.prior, parameter.path
    if prior is None or not prior.of_scene:
        return "none (left out)" if parameter.unheld and path in found.fit.scene.uncertain else ""
    mean = shown_number(found.fit.scene, path, prior.mean)
    if prior.logarithmic:
        return f"{mean} ×/÷ {prior.tolerance:.3g}"
    return f"{mean} ± {prior.tolerance * _per_unit(found, parameter):.3g}"


def _per_unit(found: Calibration, parameter: Parameter) -> float:
    """Return the number of customary units per SI unit, for differences of values."""
    ends = [in_customary(found.fit.scene, parameter.path, each)[0] for each in (parameter.low, parameter.high)]
    return (ends[1] - ends[0]) / (parameter.high - parameter.low)


def _quality(found: Calibration) -> Iterator[str]:
    if found.chi_squared is None:
        return
    per = f", {found.chi_squared / found.freedom:.3g} per degree of freedom" if found.freedom > 0 else ""
    yield f"chi squared {found.chi_squared:.4g} with {found.freedom} degrees of freedom{per}"
    if found.scale > 1.0:
        chance = chance_of_misfit(found.chi_squared, found.freedom)
        doubt = "; the model or the uncertainties do not suit the data" if chance < LEAST_CHANCE else ""
        yield (
            f"the residuals exceed the stated uncertainties, which chance alone does in {shown_chance(chance)} of all "
            f"cases{doubt}; standard errors are multiplied by {found.scale:.3g}"
        )
        if doubt:
            yield from found.misread
            yield from _outliers(found, found.chi_squared)
    ends = f"{len(found.as_good)} of {len(found.starts)} starts"
    yield f"as good: {ends}, which end within {found.margin:.3g} of the best chi squared (68 % of the joint region)"


def _outliers(found: Calibration, chi_squared: float) -> Iterator[str]:
    """Yield the few numbers, or the one, that make up most of chi squared: often they are mistakes of the table."""
    fitted = [(each, each.residual) for each in found.compared if each.point.fitted and each.residual is not None]
    largest = sorted(fitted, key=lambda pair: -abs(pair[1]))[: max(len(fitted) // OUTLIERS_OF, 1)]
    count, share = 0, 0.0
    while count < len(largest) and share < MOST_OF_MISFIT:
        share += largest[count][1] ** 2 / chi_squared
        count += 1
    if share >= MOST_OF_MISFIT and found.freedom > 1:  # of one degree of freedom all residuals tell the same
        named = ", ".join(f"{each.point.name}: {shown_name(each.figure)} {off:+.3g} σ" for each, off in largest[:count])
        yield (
            f"{share:.0%} of chi squared comes from {count} of {len(fitted)} numbers ({named}): check "
            f"{'them' if count > 1 else 'it'}; a point with check in the column use is predicted and not fitted"
        )


def _warnings(found: Calibration) -> Iterator[str]:
    known = found.certainty
    for name, reason in found.reasons.items():
        yield f"{name} has no solution: {reason}"
    yield from (f"warning: {text}" for text in not_included(found.left_out))
    for count, text in kinds_of(found.warnings.values()):
        first = next(name for name, texts in found.warnings.items() if text in texts)
        others = f" and {counted(count - 1, 'other point')}" if count > 1 else ""
        yield f"warning at {first}{others}: {text}"
    if known is None:
        return
    for parameter, border in zip(found.fit.parameters, known.border, strict=True):
        if border:
            bound = parameter.low if border == "lower" else parameter.high
            shown = shown_value(found.fit.scene, parameter.path, bound, 4)
            yield f"warning: {parameter.path} is at its {border} bound, {shown}; a better fit may lie beyond it"
    for each in known.open:
        along = (
            f" (a standard error along it is {each.span:.2g} of the bounds' distance)" if each.span < NOTHING else ""
        )
        yield f"warning: {each.says}{along}"
    if any(not each.strength >= WEAK_VALUE for each in known.open):
        yield (
            f"a combination is not determined if its singular value (scaled slopes) is below {WEAK_VALUE:g} of the "
            f"largest; two parameters are not distinguished if |r| is above {CORRELATED:g} (fix one, add data, or "
            "state a prior)"
        )
    yield from _correlations(found)


def _correlations(found: Calibration) -> Iterator[str]:
    known = found.certainty
    names = list(found.fit.short_names().values())
    if known is None or len(names) < 2:
        return
    below = ((i, j, r) for i, row in enumerate(known.correlation) for j, r in enumerate(row[:i]) if r is not None)
    pairs = [(abs(r), f"{names[j]}, {names[i]} {r:+.2f}") for i, j, r in below]
    if pairs:
        strongest = [text for _, text in sorted(pairs, reverse=True)[:4]]
        yield f"strongest correlations: {'; '.join(strongest)}"


def check_folder(folder: Path, scene_file: str) -> None:
    """Raise UsageError where a folder has a foreign file, or the fit's own scene, under the name of what is written."""
    protect_other_text({folder / SCENE: FITTED_LINE})
    if os.path.realpath(folder / SCENE) == os.path.realpath(scene_file):
        raise UsageError(f"-o {folder}: {folder / SCENE} is the scene of the fit itself (name another folder)")
    refuse_base(folder / SCENE, scene_file, str(folder / SCENE))
    protect_other_json(folder / DOCUMENT, "parameters", "chi_squared", "starts")


def write_calibration(found: Calibration, folder: Path) -> list[str]:
    """Write the fitted scene, the document and the figure of residuals; return the paths."""
    make_folder(folder)
    written = [write_json(calibration_document(found), folder / DOCUMENT)]
    if found.values:
        written.append(write_text(folder / SCENE, fitted_text(found, folder)))
        written += write_all(pictures(found), folder)
    return written
