"""Random fits of the paper's machine, and the same problem in numpy: residuals, slopes, priors, places.

A fit has one to three unknowns, each free, with a prior of its own, or with a tolerance in the scene (±, percent, ×/÷,
correlated with another); some are spaced in the logarithm, some have a path that follows. Its points are those of a
machine with known parameters, with noise.
"""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.scene import Scene, load, value_at, with_values
from screwsim.simulate import simulate
from screwsim.study.calibration.fit import GROUP_CORRELATION

BASE = Path(__file__).resolve().parents[2] / "configs" / "paper" / "point.yaml"
GAPS = "effects.tip_leakage.gap", "effects.interlobe_leakage.gap", "effects.end_face_leakage.gap"
BARE = "effects.mechanical.fraction", "oil_supply.ratio", "effects.hydromechanical.acceleration_factor"
PATHS = (*GAPS, "effects.blow_hole.area", "effects.oil_heat.droplet_radius", *BARE)
FINE = ["numerics.accuracy=1e-5"]
SPEED, PRESSURE = "operation.speed", "operation.discharge.pressure"
RPM, MICRO, ZERO_CELSIUS = math.pi / 30.0, 1e-6, 273.15
FIGURES = {"gas_mass_flow": ("kg/h", 1.0 / 3600.0), "shaft_power": ("kW", 1e3), "discharge_temperature": ("degC", 1.0)}
NOISE, NOISE_KELVIN = 0.006, 0.7  # standard uncertainty: of a figure, of a temperature [K]
STEP = 0.005  # of the bounds' distance, to each side, of slopes

Array = np.ndarray
Measured = dict[str, tuple[float, float]]  # value and standard uncertainty [SI] by figure


class Prior(NamedTuple):
    """Normal prior [SI]; logarithmic: of the logarithm about that of the mean."""

    mean: float
    deviation: float
    logarithmic: bool = False

    def off(self, value: float) -> float:
        """Return by how many deviations a value is off."""
        return (math.log(value / self.mean) if self.logarithmic else value - self.mean) / self.deviation


class Unknown(NamedTuple):
    """One parameter of a fit: bounds [SI], prior, how it is written in the scene, and a path that follows it."""

    path: str
    low: float
    high: float
    logarithmic: bool
    prior: Prior | None
    tolerance: str = ""  # in the scene
    stated: str = ""  # prior of the fit: 'own', 'none'
    tie: tuple[str, float, float] | None = None  # path, factor, offset [m]

    def value(self, place: float) -> float:
        """Return the value [SI] at a place 0 … 1."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** place
        return self.low + (self.high - self.low) * place

    def place(self, value: float) -> float:
        """Return the place of a value [SI]."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def slope(self, value: float) -> float:
        """Return the derivative of the value by the place."""
        return value * math.log(self.high / self.low) if self.logarithmic else self.high - self.low


class DrawnFit(NamedTuple):
    """A fit in `x.fit.yaml` of a folder: unknowns, those correlated, true values, points with conditions [SI]."""

    unknowns: tuple[Unknown, ...]
    together: tuple[int, ...]
    truth: dict[str, float]
    points: list[tuple[dict[str, float], Measured]]
    text: str

    def changes(self, values: dict[str, float]) -> dict[str, float]:
        """Return the values of all paths that values of the unknowns change."""
        found = dict(values)
        for each in self.unknowns:
            if each.tie is not None:
                found[each.tie[0]] = each.tie[1] * values[each.path] + each.tie[2]
        return found


def written(path: str, value: float) -> str:
    """Return a value [SI] with its unit."""
    unit = "" if path in BARE else "mm^2" if path.endswith("area") else "um"
    return f"{value if path in BARE else value / MICRO:.9g} {unit}".strip()


def typed(path: str, value: float) -> Any:
    """Return a value [SI] as YAML takes it."""
    return float(written(path, value)) if path in BARE else written(path, value)


def put(tree: dict[str, Any], path: str, text: str) -> None:
    """Put a text into a nested dict under a dotted path."""
    *above, last = path.split(".")
    for key in above:
        tree = tree.setdefault(key, {})
    tree[last] = text


def drawn_unknown(random: np.random.Generator, scene: Scene, path: str, grouped: bool) -> Unknown:
    """Return a random unknown; a grouped one has a tolerance."""
    value = float(value_at(scene, path))
    low, high, logarithmic = 0.4 * value, 2.2 * value, bool(random.random() < 0.35)
    kinds = ("percent", "factor") if grouped else ("free", "own", "size", "percent", "factor", "none")
    kind, prior, tolerance, stated = str(random.choice(kinds)), None, "", ""
    if kind == "own":
        prior = Prior(random.uniform(1.2 * low, 0.8 * high), value * random.uniform(0.03, 0.4))
        stated = "own"
    elif kind == "factor":
        factor = round(float(random.uniform(1.1, 2.2)), 3)
        prior, tolerance = Prior(value, 0.5 * math.log(factor), True), f"{written(path, value)} ×/÷ {factor}"
    elif kind != "free":
        percent = round(float(random.uniform(5.0, 50.0)), 2)
        half = 0.01 * percent * value
        behind = f"{percent} %" if kind == "percent" else written(path, half)
        tolerance = f"{written(path, value)} ± {behind}"
        prior, stated = (None, "none") if kind == "none" else (Prior(value, 0.5 * half), "")
    return Unknown(path, low, high, logarithmic, prior, tolerance, stated)


def drawn_fit(random: np.random.Generator, folder: Path, most: int = 3) -> DrawnFit:
    """Write a random fit with its scene and points into a folder."""
    base = load(BASE)
    count, group = int(random.integers(1, most + 1)), ()
    paths = [str(each) for each in random.choice(PATHS, count, replace=False)]
    if count > 1 and random.random() < 0.35:
        group = tuple(str(each) for each in random.choice(GAPS, 2, replace=False))
        paths = [*group, *(path for path in paths if path not in group)][:count]
    unknowns = [drawn_unknown(random, base, path, path in group) for path in paths]
    left = [path for path in GAPS if path not in paths]
    if paths[0] in GAPS and left and random.random() < 0.4:
        unknowns[0] = unknowns[0]._replace(tie=(left[0], random.uniform(0.5, 2.0), random.uniform(0.0, 5.0) * MICRO))
    tree: dict[str, Any] = {"base": str(BASE)}
    for each in unknowns:
        if each.tolerance:
            put(tree, each.path, each.tolerance)
    if group:
        tree["uncertainty"] = {"correlated": [list(group)]}
    (folder / "scene.yaml").write_text(json.dumps(tree), encoding="utf-8")
    truth = {each.path: each.value(random.uniform(0.15, 0.85)) for each in unknowns}
    fit = DrawnFit(tuple(unknowns), tuple(range(len(group))), truth, [], _text(random, unknowns))
    (folder / "x.fit.yaml").write_text(fit.text, encoding="utf-8")
    _measure(random, folder, fit)
    return fit._replace(text=f"{fit.text} scene {tree}")


def _text(random: np.random.Generator, unknowns: list[Unknown]) -> str:
    spec: dict[str, Any] = {}
    for each in unknowns:
        one: dict[str, Any] = {"from": typed(each.path, each.low), "to": typed(each.path, each.high)}
        one |= {"spacing": "log"} if each.logarithmic else {}
        if each.stated == "own" and each.prior is not None:
            one["prior"] = {name: typed(each.path, getattr(each.prior, name)) for name in ("mean", "deviation")}
        elif each.stated:
            one["prior"] = each.stated
        if each.tie is not None:
            path, factor, offset = each.tie
            one["also"] = {path: {"factor": factor, "offset": written(path, offset)}}
        spec[each.path] = one
    fit = {"scene": "scene.yaml", "data": "points.csv", "parameters": spec, "starts": int(random.integers(1, 4))}
    return json.dumps(fit | {"slopes": str(random.choice(["differences", "differences", "exact"]))})


def _measure(random: np.random.Generator, folder: Path, fit: DrawnFit) -> None:
    """Add points of the true machine with noise to the fit, and write them."""
    machine = with_values(load(folder / "scene.yaml", FINE), fit.changes(fit.truth))
    used, rows = [name for name in FIGURES if random.random() < 0.75] or ["gas_mass_flow"], []
    for number in range(int(random.choice([2, 3, 5]))):
        rpm, bar = float(f"{random.uniform(600.0, 4000.0):.6g}"), float(f"{random.uniform(7.0, 13.0):.5g}")
        at = {SPEED: rpm * RPM, PRESSURE: 1e5 * bar}
        figures = simulate(with_values(machine, at), trace=False).performance
        row: dict[str, Any] = {"name": f"p{number}", f"{SPEED} [rpm]": rpm, f"{PRESSURE} [bar]": bar}
        measured: Measured = {}
        for name in used:
            unit, size = FIGURES[name]
            zero = ZERO_CELSIUS if unit == "degC" else 0.0
            deviation = NOISE_KELVIN if zero else NOISE * figures[name]
            value = f"{(figures[name] + deviation * random.standard_normal() - zero) / size:.10g}"
            width = f"{2.0 * deviation / size:.9g}"
            row[f"{name} [{unit}]"], row[f"{name}_uncertainty [{'K' if zero else unit}] (k=2)"] = value, width
            measured[name] = float(value) * size + zero, 0.5 * float(width) * size
        rows.append(row)
        fit.points.append((at, measured))
    with (folder / "points.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]))
        table.writeheader()
        table.writerows(rows)


class OwnModel:
    """Residuals of a fit and its priors over the places of the unknowns, written anew."""

    def __init__(self, fit: DrawnFit, folder: Path) -> None:
        self.fit, self.scene = fit, load(folder / "scene.yaml", FINE)
        self.measured = np.array([each for _, figures in fit.points for each in figures.values()])
        self.names = [name for _, figures in fit.points for name in figures]
        self.held = [i for i, each in enumerate(fit.unknowns) if each.prior is not None]
        correlation = np.eye(len(self.held))
        rows = [self.held.index(i) for i in fit.together]
        correlation[np.ix_(rows, rows)] = GROUP_CORRELATION
        np.fill_diagonal(correlation, 1.0)
        self.whitener = np.linalg.inv(np.linalg.cholesky(correlation))

    def values(self, places: Array) -> Array:
        """Return the values [SI] at places."""
        return np.array([each.value(float(u)) for each, u in zip(self.fit.unknowns, places, strict=True)])

    def places(self, values: Array) -> Array:
        """Return the places of values [SI]."""
        return np.array([each.place(float(x)) for each, x in zip(self.fit.unknowns, values, strict=True)])

    def figures(self, values: Array) -> Array:
        """Return the measured figures of all points."""
        paths = [each.path for each in self.fit.unknowns]
        machine = with_values(self.scene, self.fit.changes(dict(zip(paths, map(float, values), strict=True))))
        found = []
        for at, measured in self.fit.points:
            figures = simulate(with_values(machine, at), trace=False).performance
            found += [figures[name] for name in measured]
        return np.array(found, float)

    def off(self, values: Array) -> Array:
        """Return by how much values are off their priors, decorrelated, in standard deviations."""
        priors = [(self.fit.unknowns[i].prior, values[i]) for i in self.held]
        return self.whitener @ np.array([prior.off(float(x)) for prior, x in priors if prior is not None])

    def residuals(self, places: Array) -> Array:
        """Return the residuals of points and priors."""
        values = self.values(places)
        return np.concatenate([(self.figures(values) - self.measured[:, 0]) / self.measured[:, 1], self.off(values)])

    def slopes(self, places: Array) -> Array:
        """Return the slopes of the residuals over the places."""
        columns = []
        for i in range(len(places)):
            low, high = np.array(places), np.array(places)
            low[i], high[i] = max(0.0, places[i] - STEP), min(1.0, places[i] + STEP)
            columns.append((self.residuals(high) - self.residuals(low)) / (high[i] - low[i]))
        return np.column_stack(columns)
