"""Families of curves from the grid of a sweep: the choice of the x axis and of the curve parameter; their optima."""

import itertools
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from screwsim.numerics.parabola import summit
from screwsim.report import quantities
from screwsim.report.quantities import EFFICIENCIES, choice_words, is_numeric, short, shown_axis, shown_figure, value_of
from screwsim.results import Results
from screwsim.results.left_out import left_out_words, parts_left_out
from screwsim.results.schema import Axis
from screwsim.results.table import TOGETHER
from screwsim.results.warning_kinds import cases_with_warnings
from screwsim.scene.operation import SPEED, is_condition
from screwsim.scene.types import COVERAGE

RATIO, FLUID = "oil_supply.ratio", "gas.fluid"
FEWEST = 2  # least number of points of a curve
_ARC = 41  # points of a drawn parabola
_SHORT_HEADING = 12  # longest heading, in characters, above numeric labels
_VARIES = 0.01  # relative variation along the speed from which an oil ratio is an outcome


class Curve(NamedTuple):
    """One curve in shown units: `at` has the values of the sweep's axis, `closed` is False for a case not closed.

    `warned` is True where a case closed with a warning. Points are in the order of the axis, reversed where x decreases
    along it. `low` and `high` are the ends of the 95 % interval due to the tolerances of the inputs, NaN without them.
    """

    text: str
    x: np.ndarray
    y: np.ndarray
    closed: np.ndarray
    at: np.ndarray
    warned: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def banded(self) -> bool:
        """Whether any point has an interval due to the inputs."""
        return bool(np.isfinite(self.low).any())


class Family(NamedTuple):
    """The curves of a figure: of which sweep, over which axis x, by which axis (None: a single curve).

    All other axes are held at `held` {axis: index}, which `constant` says in words and `suffix` in the figure's name.
    """

    results: Results
    x: int
    by: int | None
    held: Mapping[int, int] = MappingProxyType({})
    constant: str = ""
    suffix: str = ""

    @property
    def x_axis(self) -> Axis:
        """Axis x of the sweep."""
        return self.results.axis_list[self.x]

    @property
    def by_axis(self) -> Axis | None:
        """Axis that distinguishes the curves."""
        return None if self.by is None else self.results.axis_list[self.by]

    @property
    def chosen(self) -> bool:
        """Whether one chooses the values of axis x, so that curves over it have optima."""
        return not is_condition(self.x_axis.path)

    def part(self, values: Any) -> np.ndarray:
        """Return the values of the cases that are drawn, on the axes that are not held."""
        return np.asarray(values)[tuple(self.held.get(i, slice(None)) for i in range(np.ndim(values)))]

    def rows(self, values: Any) -> np.ndarray:
        """Return the values of the cases that are drawn as an array (curves, x)."""
        part = self.part(values)
        return (part.T if self.by is not None and self.x < self.by else part).reshape(-1, len(self.x_axis.values))


def efficiency_name(results: Results) -> str | None:
    """Return the efficiency with more values, isothermal before isentropic; None where neither has any."""
    found = {name: int(np.isfinite(results.performance[name]).sum()) for name in EFFICIENCIES}
    best = max(EFFICIENCIES, key=lambda name: found[name])  # of equal ones the first
    return best if found[best] else None


def is_joint_sample(results: Results) -> bool:
    """Tell whether several quantities vary together (a sample, a list of cases), so that there are no curves."""
    return any(axis.joined for axis in results.axis_list)


def family_of(results: Results, by_fluid: bool = True) -> Family | None:
    """Return the curves over the oil ratio, else over the longest numeric axis; None without one.

    With `by_fluid` they are distinguished by the fluid, if it varies.
    """
    axes = results.axis_list
    lengths = [len(axis.values) if is_numeric(axis) else 0 for axis in axes]
    if not axes or max(lengths) < FEWEST or is_joint_sample(results):
        return None
    return _family(results, _preferred(axes, lengths, RATIO), by_fluid)


def outcome_family(results: Results) -> Family | None:
    """Return the curves over the speed if the oil ratio is an outcome that varies along it; else None.

    A package is shown over its speed, by which its flow is controlled.
    """
    axes, found = results.axis_list, results.performance
    paths = [axis.path for axis in axes]
    if SPEED not in paths or RATIO in paths or is_joint_sample(results):
        return None
    if "oil_ratio" not in found or "package_input_power" in found:
        return None
    place = paths.index(SPEED)
    ratio = np.moveaxis(results.performance["oil_ratio"], place, -1)
    finite = np.where(np.isfinite(ratio), ratio, np.nan).reshape(-1, ratio.shape[-1])
    finite = finite[np.isfinite(finite).sum(axis=1) >= FEWEST]
    if not len(finite):
        return None
    span = np.nanmax(finite, axis=1) - np.nanmin(finite, axis=1)
    varies = np.any(span > _VARIES * np.nanmax(np.abs(finite), axis=1))
    return _family(results, place) if varies else None


def _family(results: Results, x: int, by_fluid: bool = True) -> Family:
    axes = results.axis_list
    others = [i for i, axis in enumerate(axes) if i != x and len(axis.values) > 1]
    lengths = [len(axis.values) if i in others else 0 for i, axis in enumerate(axes)]
    usual = _preferred(axes, lengths, SPEED) if others else None
    by = next((i for i in others if by_fluid and axes[i].path == FLUID), usual)  # all fluids in one figure
    return Family(results, x, by)


def _preferred(axes: tuple[Axis, ...], lengths: list[int], path: str) -> int:
    """Return the index of the axis with that path if it is long enough, else of the longest axis."""
    long_enough = (i for i, axis in enumerate(axes) if axis.path == path and lengths[i] >= FEWEST)
    return next(long_enough, int(np.argmax(lengths)))


def slices(family: Family) -> Iterator[Family]:
    """Yield the curves of each figure, one figure per value of the other axes."""
    axes = family.results.axis_list
    rest = [i for i in range(len(axes)) if i not in (family.x, family.by)]
    for number, indices in enumerate(itertools.product(*(range(len(axes[i].values)) for i in rest)), start=1):
        held = dict(zip(rest, indices, strict=True))
        constant = ", ".join(value_of(axes[i], index) for i, index in held.items())
        yield family._replace(held=held, constant=constant, suffix=f"_{number}" if constant else "")


def curves_of(
    family: Family, y_name: str, x_name: str | None = None, shown: quantities.Display | None = None
) -> list[Curve]:
    """Return the curves of one figure: `y_name` over the axis x, or over the figure `x_name`; `shown` as given, if so.

    Cases without a value are left out, and so are curves of fewer than two points. A figure that no case calls for has
    no curves.
    """
    results, axis = family.results, family.x_axis
    if y_name not in results.performance:
        return []
    shown, values = shown or shown_figure(results, y_name), results.performance[y_name]
    half = COVERAGE * results.uncertainty[y_name] if y_name in results.uncertainty else np.full(results.shape, np.nan)
    y, low, high = (family.rows(shown.of(each)) for each in (values, values - half, values + half))
    at = np.broadcast_to(shown_axis(axis).of(axis.values), y.shape)
    x = at if x_name is None else family.rows(shown_figure(results, x_name).of(results.performance[x_name]))
    closed, failed = (family.rows(np.asarray(results.status) == word) for word in ("ok", "failed"))
    warned = family.rows(cases_with_warnings(results)) & closed
    curves = []
    for i, text in enumerate(_texts(family)):
        kept = np.flatnonzero(np.isfinite(x[i]) & np.isfinite(y[i]) & ~failed[i])
        kept = kept[np.argsort(at[i][kept], kind="stable")]
        if len(kept) < FEWEST:
            continue
        kept = kept if x[i][kept[-1]] >= x[i][kept[0]] else kept[::-1]
        columns = (x, y, closed, at, warned, low, high)
        curves.append(Curve(text, *(column[i][kept] for column in columns)))
    return curves


def left_out(family: Family, curves: list[Curve]) -> str:
    """Return the note on cases missing from the figure; empty if all are shown."""
    return missing_words(family.part(family.results.status).size, sum(len(curve.x) for curve in curves))


def missing_words(cases: int, shown: int) -> str:
    """Return the note on cases without a result; empty if all are shown."""
    return f"{cases - shown} of {cases} cases without a result left out" if shown < cases else ""


def doubtful(curves: list[Curve]) -> tuple[int, int]:
    """Return the numbers of cases shown that did not close, and that closed with a warning."""
    flags = [(~curve.closed, curve.warned) for curve in curves]
    not_closed, warned = (sum(int(np.count_nonzero(each[i])) for each in flags) for i in (0, 1))
    return not_closed, warned


def band_words(results: Results, curves: list[Curve]) -> str:
    """Return the explanation of the bands around curves; empty without any."""
    if not any(curve.banded for curve in curves):
        return ""
    labels = results.contributions["contributor"].tolist()
    count = sum(len(label.split(TOGETHER)) for label in labels)
    whose = f"tolerances of {count} inputs" if count > 1 else "tolerance of one input"
    places = np.flatnonzero(parts_left_out(results).reshape(-1, len(labels)).any(axis=0))
    lost = left_out_words([labels[place] for place in places])
    return f"band: 95 % interval by the {whose} alone{f', in some cases {lost}' if lost else ''}"


def _texts(family: Family) -> list[str]:
    axis = family.by_axis
    if axis is None:
        return [""]
    if not is_numeric(axis):
        return [str(value) for value in axis.values]
    return [short(shown_axis(axis).of(value)) for value in axis.values]


def curves_heading(family: Family) -> tuple[str, str]:
    """Return the heading of the curves' labels (with its unit), and a note that replaces it if it is too long."""
    axis = family.by_axis
    if axis is None:
        return "", ""
    words = shown_axis(axis).quantity if is_numeric(axis) else choice_words(axis)
    return (words, "") if "$" in words or len(words) <= _SHORT_HEADING else ("", f"along the curves: {words}")


def optimum(x: np.ndarray, y: np.ndarray) -> tuple[float, float] | None:
    """Return the maximum of y by a parabola in ln x through the three highest points; None unless it is interior.

    These are the highest point and its neighbours; x replaces ln x where it is not positive.
    """
    best = int(np.argmax(y))
    if not 0 < best < len(x) - 1:
        return None
    u, v, log = _near_top(x, y)
    if np.any(np.diff(u) <= 0.0):
        return None
    at, peak = summit(u, v)
    return (float(np.exp(at)) if log else at), peak


def optimum_arc(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the parabola in ln x with its maximum at `optimum`, between the highest point's neighbours; else None.

    Where points are far apart it shows why the optimum is not on the straight lines between them.
    """
    if optimum(x, y) is None:
        return None
    u, v, log = _near_top(x, y)
    places = np.linspace(u[0], u[2], _ARC)
    return (np.exp(places) if log else places), np.polynomial.Polynomial.fit(u, v, 2)(places)


def _near_top(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Return ln x (x where it is not positive) and y at the highest point and its neighbours; whether it is ln x."""
    near = slice(int(np.argmax(y)) - 1, int(np.argmax(y)) + 2)
    log = bool(np.all(x[near] > 0.0))
    return np.log(x[near]) if log else x[near], y[near], log


def is_log(x: np.ndarray) -> bool:
    """Tell whether values belong on a logarithmic axis: all positive, with a range of more than a factor of 8."""
    return bool(np.all(x > 0.0) and np.max(x) > 8.0 * np.min(x))
