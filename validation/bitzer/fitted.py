"""The machine fitted to three of Bitzer's conditions: what it predicts elsewhere, and where volumetric efficiency goes.

Fitted by `screwsim calibrate validation/bitzer/machine.fit.yaml -o validation/bitzer/fitted`; here only computed again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from screwsim.outputs import Figures, ledger_entries
from screwsim.scene import load, with_values
from screwsim.study.calibration import read_fit
from screwsim.study.calibration.fit import Point
from screwsim.study.validation import Row, Series, ValidationPoint, compared, equal, solved

FIGURES = {"volumetric_efficiency": ("volumetric", 1.5), "isentropic_efficiency": ("isentropic", 3.0)}
BASIS = "the source gives none; see above"
ENDS = (2.45, 8.18)  # pressure ratios between which the loss of volumetric efficiency is compared
GAPS = ("tip_leakage", "interlobe_leakage", "blow_hole", "end_face_leakage", "shaft_leakage")
SEALED, DEAREST = 1e-4, 5
AGAIN = "ends_fitted"  # of ends.fit.yaml
SET_AS_MAKER = "end faces as a maker sets them, gas and oil through blow-holes at one speed, fitted again"


def machine(here: Path) -> Path:
    """Return the scene of the fitted machine."""
    return here / "fitted" / "scene.yaml"


def points(here: Path) -> tuple[Point, ...]:
    """Return the points of the fit and those that it predicts."""
    return read_fit(here / "machine.fit.yaml").points


def at(here: Path, point: Point, **changes: float) -> Figures:
    """Return the figures of the fitted machine at a point."""
    values = {**point.values, **{path.replace("__", "."): value for path, value in changes.items()}}
    return solved(machine(here), values=values).performance


def compared_points(here: Path) -> list[ValidationPoint]:
    """Return both efficiencies at every point beside the source's, which states no uncertainty."""
    found: list[ValidationPoint] = []
    for one in points(here):
        scene = with_values(load(machine(here)), dict(one.values))
        theirs = {figure: one.measured[figure].value for figure in FIGURES}
        result = solved(machine(here), values=dict(one.values))
        found += compared("bitzer", one.name, scene, result, theirs, fitted=one.fitted)
    return found


def rows(here: Path) -> list[Row]:
    """Return every point of the fit and of the prediction, then what the fit says and where the losses go."""
    found = {point.name: at(here, point) for point in points(here)}
    compared = [row for point in points(here) for row in _point_rows(point, found[point.name])]
    return [*compared, *_fit_rows(here), *_loss_rows(here), _ledger_row(here), *_again_rows(here, found)]


def _point_rows(point: Point, found: Figures) -> list[Row]:
    lines = []
    for figure, (text, limit) in FIGURES.items():
        ours, theirs = 100.0 * found[figure], 100.0 * point.measured[figure].value
        kind, how = ("calibrated", "fitted") if point.fitted else ("published", "predicted")
        name = f"{point.name} °C" if "/" in point.name else point.name
        note = f"{how}; {ours - theirs:+.1f} points"
        quantity = f"fitted machine, {name}: {text}"
        lines.append(equal(quantity, ours, theirs, limit, kind, unit="%", basis=BASIS, note=note))
    return lines


def _fit_rows(here: Path) -> list[Row]:
    """Return the parameters as the stored fit has them."""
    told = json.loads((here / "fitted" / "fit.json").read_text(encoding="utf-8"))
    fit = read_fit(here / "machine.fit.yaml")
    lines = []
    for parameter in fit.parameters:
        each, unit = told["parameters"][parameter.path], _unit(parameter.path)
        factor = unit[0]
        error = each["standard_error_scaled"]
        good = f"{factor * each['as_good_from']:.4g} … {factor * each['as_good_to']:.4g}"
        note = f"bounds {factor * each['from']:.4g} … {factor * each['to']:.4g}; fits as good from other starts: {good}"
        value = factor * each["value"]
        border = each["at_bound"] and f"at the {each['at_bound']} bound; "
        basis = "± standard error of the fit"
        uncertainty = None if error is None else factor * error
        row = Row(parameter.path, value, None, "calibrated", "no verdict", unit[1], uncertainty, basis, border + note)
        lines.append(row)
    return lines


def _unit(path: str) -> tuple[float, str]:
    """Return factor and unit in which a parameter is shown."""
    endings = {"gap": (1e6, "µm"), "opens": (180.0 / np.pi, "°"), "area": (1e6, "mm²")}
    return endings.get(path.rpartition(".")[2], (1.0, ""))


def _loss_rows(here: Path) -> list[Row]:
    """Return how the loss of volumetric efficiency grows with the pressure ratio, and what each gap makes of it."""
    low, high = (next(p for p in points(here) if p.name == f"pi = {ratio:.2f}") for ratio in ENDS)
    theirs = [1.0 - p.measured["volumetric_efficiency"].value for p in (low, high)]
    base = [at(here, p).volumetric_efficiency for p in (low, high)]
    ours = [1.0 - value for value in base]
    span = f"from pi = {ENDS[0]:g} to {ENDS[1]:g}"
    lines = [
        equal(
            f"growth of the volumetric loss 1 − λ {span}",
            ours[1] / ours[0],
            theirs[1] / theirs[0],
            0.2 * theirs[1] / theirs[0],
            "published",
            basis="20 %: a loss of the source in proportion to pi would grow 3.3-fold",
            note="of the leaks that past the shafts alone sees the discharge pressure all the time",
        )
    ]
    for gap in GAPS:
        sealed = {f"effects__{gap}__flow_coefficient": SEALED}
        lost = [
            100.0 * (at(here, p, **sealed).volumetric_efficiency - λ) for p, λ in zip((low, high), base, strict=True)
        ]
        quantity = f"fitted machine: λ lost to {gap.replace('_', ' ')}"
        text = f"{lost[0]:.2f} and {lost[1]:.2f} points"
        lines.append(Row(quantity, text, None, "estimate", "no verdict", note=f"pi = {ENDS[0]:g} and {ENDS[1]:g}"))
    return lines


def _ledger_row(here: Path) -> Row:
    """Return where the shaft power goes at both ends: the dearest effects."""
    told = []
    for ratio in ENDS:
        point = next(p for p in points(here) if p.name == f"pi = {ratio:.2f}")
        ledger = solved(machine(here), values=dict(point.values), trace=True).ledger
        entries = {name: float(e["exergy_destroyed"]) for name, e in ledger_entries(ledger).items()}
        dearest = sorted(entries.items(), key=lambda item: -item[1])[:DEAREST]
        shares = (f"{name.replace('_', ' ')} {100.0 * size / ledger['shaft_power']:.1f}" for name, size in dearest)
        told.append(f"pi = {ratio:g}: {', '.join(shares)}")
    quantity = "fitted machine: exergy destroyed, % of the shaft power"
    return Row(quantity, "; ".join(told), None, "estimate", "no verdict", note="ledger of screwsim run")


def _again_rows(here: Path, found: Mapping[str, Figures]) -> list[Row]:
    """Return how far the fit is off where it predicts, and so of one with end faces as a maker sets them."""
    again = here / AGAIN / "scene.yaml"
    other = {point.name: solved(again, values=dict(point.values)).performance for point in points(here)}
    named = {"fitted machine": found, f"tried: {SET_AS_MAKER}": other}
    told = json.loads((here / AGAIN / "fit.json").read_text(encoding="utf-8"))["parameters"]
    values = ", ".join(
        f"{path.removeprefix('effects.')} {each['value'] * _unit(path)[0]:.4g} {_unit(path)[1]}".strip()
        for path, each in told.items()
    )
    lines = []
    for name, figures in named.items():
        off = [
            [100.0 * (figures[point.name][figure] - point.measured[figure].value) for figure in FIGURES]
            for point in points(here)
            if not point.fitted
        ]
        filled, work = np.sqrt(np.mean(np.square(off), axis=0))
        quantity = f"{name}: rms of λ/η_s at the {len(off)} points that are predicted"
        note = values if figures is other else ""
        lines.append(Row(quantity, f"{filled:.2f}/{work:.2f} points", None, "estimate", "no verdict", note=note))
    return lines


def series(here: Path, figure: str) -> tuple[Series, Series]:
    """Return the fitted machine over the pressure ratio: the sweep, and the points of the fit."""
    sweep = [p for p in points(here) if "/" not in p.name]
    curve = [at(here, p) for p in sweep]
    fitted = [(at(here, p), p) for p in points(here) if p.fitted]
    ratios = [f.discharge_pressure / f.suction_pressure for f in curve]
    name = "fitted machine"
    marks = [f.discharge_pressure / f.suction_pressure for f, _ in fitted]
    return (
        Series(name, ratios, [100.0 * f[figure] for f in curve]),
        Series("the points of its fit", marks, [100.0 * f[figure] for f, _ in fitted], points=True),
    )
