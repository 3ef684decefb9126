"""What `screwsim calibrate --posterior` prints and writes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from screwsim.engineering import digits, figure_scales, shown_name
from screwsim.figures import declared
from screwsim.printing.tables import plain_table, wrapped
from screwsim.results.atomic import write_csv
from screwsim.scene.units import ZERO_CELSIUS
from screwsim.screen import say
from screwsim.study.calibration.posterior import LEVEL, UNTOLD, Posterior, Predicted
from screwsim.study.calibration.solve import Calibration
from screwsim.study.inputs import in_customary

SAMPLES = "posterior.csv"


def posterior_document(found: Posterior) -> dict[str, Any]:
    """Return the posterior as a part of the document of `calibrate --json`; SI units."""
    return {
        "status": found.status,
        "message": found.message,
        "level": LEVEL,
        "parameters": {each.name: each.__dict__ for each in found.parameters},
        "discrepancies": {each.name: each.__dict__ for each in found.discrepancies},
        "predicted": [each.__dict__ | {"inside": each.inside} for each in found.predicted],
        "r_hat": found.r_hat,
        "autocorrelation_time": found.autocorrelation,
        "steps": found.steps,
        "effective_samples": found.effective,
        "largest_emulator_error_over_uncertainty": found.off,
        "solutions": found.solutions,
        "failed_solutions": found.failed,
    }


def print_posterior(fit: Calibration, found: Posterior) -> None:
    """Print the intervals of parameters and discrepancies, the predictions of points, and what the chains are worth."""
    say()
    if found.message:
        say(wrapped(f"posterior {found.status}: {found.message}"))
    if not found.parameters:
        return
    scene = fit.fit.scene
    rows = []
    for each in found.parameters:
        low, median, high = (in_customary(scene, each.name, value) for value in (each.low, each.median, each.high))
        share = "" if each.of_prior is None else f"{each.of_prior:.2f}"
        rows.append([each.name, f"{median[0]:.4g} {median[1]}".strip(), f"{low[0]:.4g} … {high[0]:.4g}", share])
    say("\n".join(plain_table(["posterior", "median", f"{LEVEL:.0%} interval", "of prior"], rows, 1)))
    say()
    rows = [[shown_name(each.name), *_width(found, each.name)] for each in found.discrepancies]
    say("\n".join(plain_table(["what the model cannot follow", "median", f"up to ({(1 + LEVEL) / 2:.0%})"], rows, 1)))
    say()
    rows = [_row(each) for each in found.predicted]
    say("\n".join(plain_table(["point", "figure", "measured", f"predicted, {LEVEL:.0%}", ""], rows, 2)))
    for line in _notes(found):
        say(wrapped(line))


def _width(found: Posterior, name: str) -> list[str]:
    """Return median and upper end of a discrepancy's width, over the figure's size; of temperatures in kelvins."""
    size = max(abs(each.measured) for each in found.predicted if each.figure == name)
    spread = next(each for each in found.discrepancies if each.name == name)
    if declared(name).units == "K":
        return [f"{spread.median:.2g} K", f"{spread.high:.2g} K"]
    return [f"{100.0 * spread.median / size:.2g} %", f"{100.0 * spread.high / size:.2g} %"]


def _row(each: Predicted) -> list[str]:
    about, zero = declared(each.figure), 0.0
    scales = ((f, unit) for least, f, unit in figure_scales(about) if abs(each.measured) >= least)
    factor, unit = next(scales, (1.0, ""))
    if about.units == "K":
        factor, unit, zero = 1.0, "°C", ZERO_CELSIUS
    measured, low, high = (digits(factor * value - zero) for value in (each.measured, each.low, each.high))
    name = each.point + ("" if each.fitted else " *")
    mark = "" if each.inside else " outside"
    return [name, shown_name(each.figure), f"{measured} {unit}".strip(), f"{low} … {high}", mark]


def _notes(found: Posterior) -> Iterator[str]:
    if not all(each.fitted for each in found.predicted):
        checked = [each for each in found.predicted if not each.fitted]
        yield f"* not fitted: {sum(each.inside for each in checked)} of {len(checked)} inside"
    untold = [each.name for each in found.parameters if (each.of_prior or 0.0) > UNTOLD]
    if untold:
        yield f"the points do not tell {', '.join(untold)}: as wide as before (of prior: width over that of the prior)"
    off = "" if found.off is None else f"; polynomials off by at most {found.off:.2g} uncertainties at draws solved"
    yield (
        f"{found.steps} steps, R-hat {found.r_hat:.3f}, autocorrelation {found.autocorrelation:.0f} steps, "
        f"{found.effective:.0f} effective samples, {found.solutions} solutions{off}"
    )


def write_posterior(fit: Calibration, found: Posterior, folder: Path) -> list[str]:
    """Write the samples, a row each, SI units; return the path."""
    if found.samples is None or found.widths is None:
        return []
    names = [each.path for each in fit.fit.parameters]
    widths = [f"discrepancy_{each.name} [{declared(each.name).units}]" for each in found.discrepancies]
    rows = ([*a, *b] for a, b in zip(found.samples.tolist(), found.widths.tolist(), strict=True))
    return [write_csv(folder / SAMPLES, [*names, *widths], rows)]
