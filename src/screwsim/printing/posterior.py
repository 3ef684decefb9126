"""Output of `screwsim calibrate --posterior` and `--predict`, printed and written."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np

from screwsim.figures import declared
from screwsim.figures.engineering import reading_unit, shown_name
from screwsim.outputs.customary import digits
from screwsim.outputs.display import grouped, picked
from screwsim.printing.tables import print_left_out, print_table, print_text, print_wrapped
from screwsim.report.calibration import ParameterSample, pairs_figure
from screwsim.report.style import write_all
from screwsim.results.atomic import write_csv
from screwsim.results.protection import protect_other_heads
from screwsim.scene import leaf_of
from screwsim.scene.grid import unit_of
from screwsim.screen import say
from screwsim.study.asked.inputs import in_customary, shown_number, shown_value, unit_of_change
from screwsim.study.calibration.answers import LEVEL, Posterior, Predictions, PredictiveCheck
from screwsim.study.calibration.fit import Fit
from screwsim.study.calibration.other_inputs import errors_by_inputs, other_inputs
from screwsim.study.calibration.posterior import UNDETERMINED_SHARE
from screwsim.study.calibration.solve import Calibration
from screwsim.study.columns import Column, protect_other_columns, write_columns

PREDICTIONS, WIDTH = "predictions of a calibration's posterior", "discrepancy_"
SAMPLES, PREDICTED, PAIRS = "posterior.csv", "predicted.h5", "posterior"
BESIDE = "± by other inputs"
QUALITY = {"largest_emulator_error_over_uncertainty": "off", "solutions": "solutions", "failed_solutions": "failed"}
_PARTS = {
    "median": "median of what would be measured",
    "low": f"lower end of the {LEVEL:.0%} interval",
    "high": f"upper end of the {LEVEL:.0%} interval",
    "parameters": "standard deviation from the parameters",
    "discrepancy": "standard deviation from the model's discrepancy",
    "measuring": "standard deviation from the measurement",
    "polynomials": "standard deviation from the polynomials that replace the model",
    "measured": "measured value",
}


def posterior_document(found: Posterior) -> dict[str, Any]:
    """Return the posterior as a part of the document of `calibrate --json`, in SI units."""
    return {
        **picked(found, "status", "message"),
        "level": LEVEL,
        "taken_as_exact": [path for group in other_inputs(found.fit) for path in group],
        "parameters": {parameter.name: parameter.__dict__ for parameter in found.parameters},
        "discrepancies": {discrepancy.name: discrepancy.__dict__ for discrepancy in found.discrepancies},
        "predicted": [each.__dict__ | {"inside": each.inside} for each in found.predicted],
        **picked(found, "r_hat", autocorrelation_time="autocorrelation"),
        **picked(found, "steps", effective_samples="effective", **QUALITY),
        **({} if found.predictions is None else {"predictions": _predictions(found.predictions)}),
    }


def _predictions(found: Predictions) -> dict[str, Any]:
    at = {point.name: {"conditions": dict(point.values)} for point in found.points}
    return {
        **picked(found, "status", "message"),
        "points": [each.__dict__ | {"inside": each.inside} | at[each.point] for each in found.figures],
        **picked(found, points_without_solution="reasons", **QUALITY),
    }


def print_posterior(fit: Calibration, found: Posterior) -> None:
    """Print the intervals of parameters and discrepancies, the predicted points, and the quality of the chains."""
    say()
    if found.message:
        print_text(f"posterior {found.status}: {found.message}")
    if not found.parameters:
        return
    scene = fit.fit.scene
    rows, beside = [], _half_by_inputs(fit)
    for index, parameter in enumerate(found.parameters):
        low, high = (shown_number(scene, parameter.name, value) for value in (parameter.low, parameter.high))
        share = "" if parameter.of_prior is None else f"{parameter.of_prior:.2f}"
        row = [parameter.name, shown_value(scene, parameter.name, parameter.median, 4), f"{low} … {high}", share]
        rows.append([*row, beside[index]] if beside else row)
    print_table(["posterior", "median", f"{LEVEL:.0%} interval", "of prior", *[BESIDE] * bool(beside)], rows, 1)
    if beside:
        what = f"half of the {LEVEL:.0%} interval by the tolerances of inputs that are not fitted"
        print_text(f"{BESIDE}: {what}, linear, on top of the interval before it (as the root of the sum of squares)")
    say()
    rows = [[shown_name(discrepancy.name), *_width(found, discrepancy.name)] for discrepancy in found.discrepancies]
    print_table(["model discrepancy", "median", f"up to ({(1 + LEVEL) / 2:.0%})"], rows, 1)
    say()
    rows = [_row(each) for each in found.predicted]
    print_table(["point", "figure", "measured", f"predicted, {LEVEL:.0%}", ""], rows, 2)
    print_wrapped(_notes(found))
    if found.predictions is not None:
        print_predictions(found.predictions)


def print_predictions(found: Predictions) -> None:
    """Print what would be measured at other points, figure by figure, and the sources of its uncertainty."""
    say()
    if found.message:
        print_text(f"predictions {found.status}: {found.message}")
    print_left_out(found.reasons)
    rows = []
    for name, of in grouped((figure.figure, figure) for figure in found.figures).items():
        factor, unit, zero = reading_unit(declared(name), max(abs(each.median) for each in of))
        rows.append([f"{shown_name(name)} [{unit}]" if unit else shown_name(name), *[""] * 5])
        for each in of:
            low, high = (digits(factor * value - zero) for value in (each.low, each.high))
            sizes = (f"{factor * size:.2g}" for size in (each.parameters, each.discrepancy, each.measuring))
            beside = "" if each.measured is None else digits(factor * each.measured - zero)
            mark = " outside" if each.inside is False else ""
            rows.append([f"  {each.point}", f"{low} … {high}", *sizes, beside + mark])
    if not rows:
        return
    measured = [figure for figure in found.figures if figure.measured is not None]
    heads = ["predicted", f"{LEVEL:.0%} interval", "by parameters", "by the model", "by measuring", "measured"]
    width = len(heads) if measured else len(heads) - 1
    print_table(heads[:width], [row[:width] for row in rows], 1)
    if measured:
        say(f"{sum(bool(each.inside) for each in measured)} of {len(measured)} measured inside")
    off = "" if found.off is None else f"; polynomials off by at most {found.off:.2g} uncertainties at draws solved"
    print_text(f"by …: standard deviations, whose squares add up; {found.solutions} solutions{off}")


def write_predictions(fit: Fit, found: Predictions, folder: Path) -> list[str]:
    """Write what would be measured to an HDF5 file, one row per point, in SI units; return the path."""
    names = list(dict.fromkeys(each.point for each in found.figures))
    if not names:
        return []
    known = {(each.point, each.figure): each for each in found.figures}
    points = [point for point in found.points if point.name in names]
    columns = {"point": Column(names, "", "name of the point")}
    for path in dict.fromkeys(path for point in points for path in point.values):
        kind = leaf_of(fit.scene, path).dimension
        units = "1" if kind is None else kind.si
        columns[path] = Column([point.values.get(path) for point in points], units, f"condition {path}")
    for figure in dict.fromkeys(each.figure for each in found.figures):
        of, units = [known[name, figure] for name in names], declared(figure).units
        for end, meaning in _PARTS.items():
            values = [getattr(each, end) for each in of]
            if any(value is not None for value in values):
                columns[f"{figure}_{end}"] = Column(values, units, f"{meaning} of {figure}")
    path = folder / PREDICTED
    write_columns(path, PREDICTIONS, columns)
    return [str(path)]


def _half_by_inputs(fit: Calibration) -> list[str]:
    """Return by parameter half of the interval by other inputs' tolerances; '' at a bound, nothing without any."""
    if not fit.shifts:
        return []
    errors = errors_by_inputs(fit.shifts, len(fit.fit.parameters))
    halves = NormalDist().inv_cdf(0.5 * (1.0 + LEVEL)) * np.array(errors)
    found = []
    for parameter, half in zip(fit.fit.parameters, halves.tolist(), strict=True):
        per, unit = unit_of_change(fit.fit.scene, parameter.path, fit.values[parameter.path])
        found.append(f"{per * half:.2g} {unit}".strip() if half else "")
    return found


def _width(found: Posterior, name: str) -> list[str]:
    """Return median and upper end of a discrepancy's width, relative to the figure; for temperatures in kelvin."""
    size = max(abs(each.measured) for each in found.predicted if each.figure == name)
    spread = next(discrepancy for discrepancy in found.discrepancies if discrepancy.name == name)
    if declared(name).units == "K":
        return [f"{spread.median:.2g} K", f"{spread.high:.2g} K"]
    return [f"{100.0 * spread.median / size:.2g} %", f"{100.0 * spread.high / size:.2g} %"]


def _row(each: PredictiveCheck) -> list[str]:
    factor, unit, zero = reading_unit(declared(each.figure), each.measured)
    measured, low, high = (digits(factor * value - zero) for value in (each.measured, each.low, each.high))
    name = each.point + ("" if each.fitted else " *")
    mark = "" if each.inside else " outside"
    return [name, shown_name(each.figure), f"{measured} {unit}".strip(), f"{low} … {high}", mark]


def _notes(found: Posterior) -> Iterator[str]:
    if not all(each.fitted for each in found.predicted):
        checked = [each for each in found.predicted if not each.fitted]
        yield f"* not fitted: {sum(each.inside for each in checked)} of {len(checked)} inside"
    untold = [parameter.name for parameter in found.parameters if (parameter.of_prior or 0.0) > UNDETERMINED_SHARE]
    if untold:
        yield (
            f"the points do not constrain {', '.join(untold)}: as wide as the prior (of prior: width over that of "
            f"the prior)"
        )
    if exact := [path for group in other_inputs(found.fit) for path in group]:
        yield (
            f"warning: intervals take {', '.join(exact)} as exact, although the scene states tolerances (make them "
            f"parameters of the fit; the tolerances are their priors)"
        )
    off = "" if found.off is None else f"; polynomials off by at most {found.off:.2g} uncertainties at draws solved"
    yield (
        f"{found.steps} steps, R-hat {found.r_hat:.3f}, autocorrelation {found.autocorrelation:.0f} steps, "
        f"{found.effective:.0f} effective samples, {found.solutions} solutions{off}"
    )


def protect_other_samples(folder: Path) -> None:
    """Raise UsageError where a folder has a foreign file under the name of a posterior's samples or predictions."""
    # paths of parameters, then widths
    protect_other_heads(folder / SAMPLES, lambda heads: all("." in head or head.startswith(WIDTH) for head in heads))
    protect_other_columns(folder / PREDICTED, PREDICTIONS)


def write_posterior(fit: Calibration, found: Posterior, folder: Path) -> list[str]:
    """Write the samples, one per row in SI units, the figure of pairs and the predictions; return the paths."""
    if found.samples is None or found.widths is None:
        return []
    names = [_head(parameter.path, unit_of(leaf_of(fit.fit.scene, parameter.path))) for parameter in fit.fit.parameters]
    widths = [_head(f"{WIDTH}{each.name}", declared(each.name).units) for each in found.discrepancies]
    rows = ([*a, *b] for a, b in zip(found.samples.tolist(), found.widths.tolist(), strict=True))
    written = [write_csv(folder / SAMPLES, [*names, *widths], rows)]
    parameters = [_parameter_samples(fit, found, i) for i in range(len(names))]
    written += write_all({PAIRS: partial(pairs_figure, parameters, LEVEL)}, folder)
    return written if found.predictions is None else written + write_predictions(fit.fit, found.predictions, folder)


def _head(name: str, units: str) -> str:
    return name if units in ("1", "") else f"{name} [{units}]"


def _parameter_samples(fit: Calibration, found: Posterior, number: int) -> ParameterSample:
    """Return a parameter for drawing, in its customary unit."""
    scene, spread = fit.fit.scene, found.parameters[number]
    ends = np.array([spread.low, spread.high])
    known = (in_customary(scene, spread.name, value)[0] for value in ends.tolist())
    unit = in_customary(scene, spread.name, spread.median)[1]
    per, zero = np.polyfit(ends, list(known), 1)
    if unit == "mm" and spread.median < 1e-3:
        per, zero, unit = 1e6, 0.0, "um"
    name = fit.fit.short_names()[spread.name].replace("_", " ").replace(".", " ")
    label = f"{name} ({unit.replace('um', 'µm')})" if unit else name
    assert found.samples is not None
    low, high = per * ends + zero
    return ParameterSample(label, per * found.samples[:, number] + zero, float(low), float(high))
