"""A compressor map: the ten-coefficient polynomial of AHRI 540 and EN 12900, fitted to the points of a sweep.

X = C1 + C2 S + C3 D + C4 S² + C5 S D + C6 D² + C7 S³ + C8 D S² + C9 S D² + C10 D³, with S the evaporating and D the
condensing temperature in °C, and X in SI units.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.results import Results
from screwsim.scene.conventions import other_convention
from screwsim.scene.grid import FLUID
from screwsim.scene.operation import CONDENSING, EVAPORATING, QUALITY, SUBCOOLING, SUPERHEAT, SUPERHEAT_S
from screwsim.scene.types import COVERAGE
from screwsim.study.asked.figures import figure_named
from screwsim.study.stages.axes import names_of

Array = np.ndarray

TERMS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))  # powers of S and D
FORMULA = "X = C1 + C2 S + C3 D + C4 S² + C5 S D + C6 D² + C7 S³ + C8 D S² + C9 S D² + C10 D³"
COEFFICIENT_NAMES = tuple(f"C{number}" for number in range(1, len(TERMS) + 1))
SHAFT, ELECTRICAL = "shaft_power", "electrical_power"
USUAL_FIGURES = ("gas_mass_flow", "cooling_capacity")  # besides the power
VALUES = 4  # distinct temperatures that a cubic needs
MOST_SHOWN = 8  # points that are left out, in words
WORST_CONDITION = 1e6  # of the fit in centred and scaled temperatures; a full grid has about 10
_CONDITIONS = (SUPERHEAT, SUBCOOLING, QUALITY, SUPERHEAT_S, "oil_supply.temperature", "oil_supply.ratio")


@dataclass(frozen=True)
class PolynomialFit:
    """Coefficients of one figure, and its errors over the points, relative to their values.

    `left_out` is the largest error at a point when it is left out of the fit; None where too few points remain.
    `by_inputs` is half of the 95 % interval by the tolerances of the inputs, the mean over the points; None without
    tolerances.
    """

    coefficients: tuple[float, ...]
    largest: float
    rms: float
    left_out: float | None
    by_inputs: float | None = None

    def in_fahrenheit(self, factor: float) -> tuple[float, ...]:
        """Return the coefficients for °F from those for °C, for the figure times a factor."""
        scaled, powers = np.zeros((4, 4)), _powers(32.0, 1.8)
        for (i, j), c in zip(TERMS, self.coefficients, strict=True):
            for k, m in np.ndindex(i + 1, j + 1):
                scaled[k, m] += factor * c * powers[i, k] * powers[j, m]
        return tuple(float(scaled[term]) for term in TERMS)


@dataclass(frozen=True)
class MissingPoint:
    """A point of the sweep that a map has to do without: evaporating and condensing temperature [°C], and why."""

    S: float
    D: float
    why: str


@dataclass(frozen=True)
class PerformanceMap:
    """A map at one point of the other axes (`values`, SI); `message` says why there is none.

    `envelope` holds the corners (S, D) [°C] of the convex hull of the points, anticlockwise; `not_ok` is the number of
    points without a solution, which are left out. `condition` is that of the fit in scaled temperatures. `missing` are
    all points that are left out, those that lack a figure as well.
    """

    values: Mapping[str, Any]
    message: str = ""
    points: int = 0
    not_ok: int = 0
    condition: float | None = None
    envelope: tuple[tuple[float, float], ...] = ()
    fits: Mapping[str, PolynomialFit] = field(default_factory=dict)
    missing: tuple[MissingPoint, ...] = ()

    @property
    def missing_in_words(self) -> str:
        """How many points of the sweep are left out, where they lie, and why the first is; empty where none is."""
        if not self.missing:
            return ""
        places = [f"({each.S:g}, {each.D:g})" for each in self.missing[:MOST_SHOWN]]
        more = ", …" if len(self.missing) > MOST_SHOWN else ""
        count = "1 point of the sweep is" if len(self.missing) == 1 else f"{len(self.missing)} points of the sweep are"
        which = "it" if len(self.missing) == 1 else "the first"
        return (
            f"{count} left out, (S, D) {', '.join(places)}{more} °C; {which}: {' '.join(self.missing[0].why.split())}"
        )

    def inside(self, S: Any, D: Any) -> Array:
        """Return where the envelope covers evaporating and condensing temperatures [°C]."""
        S, D = np.broadcast_arrays(np.asarray(S, float), np.asarray(D, float))
        inside = np.full(S.shape, bool(self.envelope))
        for (s, d), (s_next, d_next) in itertools.pairwise([*self.envelope, *self.envelope[:1]]):
            side = (s_next - s) * (D - d) - (d_next - d) * (S - s)
            inside &= side >= -1e-9 * math.hypot(s_next - s, d_next - d)
        return inside

    def other_convention(self, fluid: str) -> str:
        """Return that the map's condensing temperatures are not those of the standards; empty where they are."""
        middle = 0.5 * (min(D for _, D in self.envelope) + max(D for _, D in self.envelope))
        return other_convention(str(self.values.get(FLUID, fluid)), middle + ZERO_CELSIUS, "D")

    def evaluate(self, figure: str, S: Any, D: Any) -> np.ma.MaskedArray:
        """Return a figure [SI] at temperatures [°C], masked outside the envelope."""
        S, D = np.broadcast_arrays(np.asarray(S, float), np.asarray(D, float))
        found = polynomial(self.fits[figure].coefficients, S, D)
        return np.ma.array(found, mask=~self.inside(S, D))


def polynomial(coefficients: Sequence[float], S: Array, D: Array) -> Array:
    """Return the polynomial at temperatures [°C], inside the envelope or not."""
    return sum((c * S**i * D**j for c, (i, j) in zip(coefficients, TERMS, strict=True)), np.zeros(np.shape(S)))


def usual_figures(results: Results) -> tuple[str, ...]:
    """Return the figures that are mapped by default: the power that is paid for, flow and capacity.

    EN 12900 and AHRI 540 rate a compressor with its motor by the electrical power, an open one by that of its shaft.
    """
    return (ELECTRICAL if ELECTRICAL in results.performance else SHAFT, *USUAL_FIGURES)


def performance_maps(results: Results, figures: Sequence[str] = ()) -> list[PerformanceMap]:
    """Return a map for each point of the axes other than both temperatures; raise UsageError where none is possible."""
    figures = figures or usual_figures(results)
    figures = tuple(dict.fromkeys(figure_named(text, results.figures, results.error) for text in figures))
    varied, temperatures = results.varied, temperature_paths(bool(results.stages))
    missing = [path for path in temperatures if path not in varied]
    if missing:
        remedy = f"--set 'sweep.{missing[0]}=[…]' for screwsim sweep"
        remedy = f"{missing[0]}: […] under sweep: in the two-stage file" if results.stages else remedy
        raise UsageError(
            f"{results.path}: has no axis {' and '.join(missing)} (a map needs a sweep over both with {VALUES} values "
            f"each or more, e.g. {remedy})"
        )
    maps = [_map(results, figures, values, cases) for values, cases in _groups(results, varied)]
    if all(each.message for each in maps):
        raise UsageError(f"{results.path}: {maps[0].message}")
    return maps


def temperature_paths(two: bool) -> tuple[str, str]:
    """Return the paths of evaporating and condensing temperature in a scene, or in two stages in series."""
    (evaporating,), (condensing,) = (names_of(path, two) for path in (EVAPORATING, CONDENSING))
    return evaporating, condensing


def conditions(results: Results) -> dict[str, float]:
    """Return the other conditions of the map [SI]: superheat, subcooling, the oil."""
    every = (each for path in _CONDITIONS for each in names_of(path, bool(results.stages)))
    names = {path: path.replace(".", "_") for path in every}
    found = {path: results.inputs[name] for path, name in names.items() if name in results.inputs}
    return {path: float(value) for path, value in found.items() if value.shape == () and np.isfinite(value)}


def followers(results: Results) -> list[dict[str, Any]]:
    """Return the paths that vary together with a temperature: `values` [SI] `at` those of the other path, `of`."""
    both = temperature_paths(bool(results.stages))
    own = {results.varied[path][0]: path for path in both}
    return [
        {"path": path, "of": own[axis], "at": results.varied[own[axis]][1].tolist(), "values": values.tolist()}
        for path, (axis, values) in results.varied.items()
        if axis in own and path not in both
    ]


def _groups(results: Results, varied: Mapping[str, tuple[int, Array]]) -> Iterator[tuple[dict[str, Any], Array]]:
    """Yield the values of the other axes with the indices of the cases there."""
    shape = results.shape
    own = {varied[path][0] for path in temperature_paths(bool(results.stages))}
    others = [number for number in range(len(shape)) if number not in own]
    numbers = np.arange(math.prod(shape)).reshape(shape)
    for places in itertools.product(*(range(shape[number]) for number in others)):
        at = dict(zip(others, places, strict=True))
        values = {path: column[at[number]] for path, (number, column) in varied.items() if number in at}
        yield values, numbers[tuple(at.get(number, slice(None)) for number in range(len(shape)))].ravel()


def _map(results: Results, figures: Sequence[str], values: Mapping[str, Any], cases: Array) -> PerformanceMap:
    nothing = np.full(results.shape, np.nan)
    columns = {figure: results.performance.get(figure, nothing).ravel()[cases] for figure in figures}
    # rounded: 258.15 K less 273.15 K is not quite -15 °C
    temperatures = (results.along(path) for path in temperature_paths(bool(results.stages)))
    S, D = (np.round(T - ZERO_CELSIUS, 9).ravel()[cases] for T in temperatures)
    good = results.status.ravel()[cases] == "ok"
    not_ok = int(np.count_nonzero(~good))
    whys = np.where(good, "", results.messages.ravel()[cases]).astype(object)
    for figure, column in columns.items():
        known = np.isfinite(column) & (column != 0.0)
        whys[good & ~known] = f"has no {figure}"
        good = good & known
    missing = tuple(MissingPoint(float(S[i]), float(D[i]), str(whys[i])) for i in np.flatnonzero(~good))
    S, D = S[good], D[good]
    message = _why_no_fit(S, D, len(cases))
    if message:
        none = [figure for figure in figures if figure not in results.figures]
        message += f"; the file has no {' and no '.join(none)}" if none else ""
        return PerformanceMap(values, message, len(S), not_ok, missing=missing)
    design = DesignMatrix(S, D)
    if design.condition > WORST_CONDITION:
        message = (
            f"the {len(S)} points do not determine the ten coefficients (condition {design.condition:.1e}; spread "
            "them over both temperatures, not along a line)"
        )
        return PerformanceMap(values, message, len(S), not_ok, design.condition, missing=missing)
    fits = {
        figure: replace(design.fit(column[good]), by_inputs=_by_inputs(results, figure, cases[good], column[good]))
        for figure, column in columns.items()
    }
    return PerformanceMap(values, "", len(S), not_ok, design.condition, _convex_hull(S, D), fits, missing)


def _by_inputs(results: Results, figure: str, cases: Array, values: Array) -> float | None:
    """Return the mean over cases of half of a figure's 95 % interval by the inputs, relative; None where unknown."""
    if figure not in results.uncertainty:
        return None
    shares = COVERAGE * results.uncertainty[figure].ravel()[cases] / np.abs(values)
    known = shares[np.isfinite(shares)]
    return float(np.mean(known)) if len(known) else None


def _why_no_fit(S: Array, D: Array, cases: int) -> str:
    """Return why no map can be fitted to points, with the remedy; empty when one can."""
    if len(S) < len(TERMS):
        return (
            f"{len(S)} of {cases} points are ok and have all figures; ten coefficients need {len(TERMS)} or more (add "
            "values to the axes)"
        )
    for name, values in (("evaporating", S), ("condensing", D)):
        count = len(np.unique(values))
        if count < VALUES:
            return f"has {count} {name} temperatures that are ok; a cubic needs {VALUES} (add values to that axis)"
    return ""


class DesignMatrix:
    """Least-squares problem in temperatures centred and scaled to −1 … 1."""

    def __init__(self, S: Array, D: Array) -> None:
        self._scales = [(0.5 * (T.max() + T.min()), 0.5 * (T.max() - T.min())) for T in (S, D)]
        u, v = ((T - middle) / half for T, (middle, half) in zip((S, D), self._scales, strict=True))
        self._matrix = np.column_stack([u**i * v**j for i, j in TERMS])
        self.condition = float(np.linalg.cond(self._matrix))

    def fit(self, values: Array) -> PolynomialFit:
        """Return the coefficients, in °C, that fit values best."""
        scaled, *_ = np.linalg.lstsq(self._matrix, values, rcond=None)
        errors = (self._matrix @ scaled - values) / values
        q, _ = np.linalg.qr(self._matrix)
        free = 1.0 - np.sum(q**2, axis=1)  # 1 − leverage of each point
        left_out = float(np.max(np.abs(errors / free))) if np.all(free > 1e-6) else None
        rms = math.sqrt(float(np.mean(errors**2)))
        table = np.zeros((4, 4))
        for coefficient, term in zip(scaled, TERMS, strict=True):
            table[term] = coefficient
        S, D = (_powers(middle, half) for middle, half in self._scales)
        table = S.T @ table @ D
        return PolynomialFit(tuple(float(table[term]) for term in TERMS), float(np.max(np.abs(errors))), rms, left_out)


def _powers(middle: float, half: float) -> Array:
    """Return the coefficients of T⁰ … T³ (columns) in ((T − middle) / half)⁰ … ³ (rows)."""
    table = np.zeros((4, 4))
    for n, k in itertools.product(range(4), repeat=2):
        table[n, k] = math.comb(n, k) * (-middle) ** max(n - k, 0) / half**n
    return table


def _convex_hull(S: Array, D: Array) -> tuple[tuple[float, float], ...]:
    from scipy.spatial import ConvexHull

    points = np.column_stack([S, D])
    return tuple((float(s), float(d)) for s, d in points[ConvexHull(points).vertices])
