"""Comparison of two results files: common points, figures against their numerical errors, scenes, statuses."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs.display import About, Brief
from screwsim.results import Results
from screwsim.results.identity import scene_values
from screwsim.results.schema import variable_name
from screwsim.results.table import TOGETHER
from screwsim.scene.types import COVERAGE

Array = np.ndarray

SAME_VALUE = 1e-9  # relative distance below which values of an axis are the same
ERROR_MULTIPLE = 2.0  # multiple of both estimated errors together that counts as numerical error
ROUNDING = 1e-12  # relative rounding of figures
TOLERANCE_SIGNS = ("±", "×/÷")  # as a scene's canonical text has them
MOST_CHANGES = 20  # changed statuses that are listed


@dataclass(frozen=True)
class FigureChange:
    """Change of one figure [SI] from A to B over the common points that are ok in both.

    `a`, `b`, `error` (both estimated errors together, absolute) and `at` are those of the point whose change is largest
    relative to the allowed one; `beyond` counts the points that exceed it; `only_a`, `only_b` those where only one file
    has the figure. `inputs` is half of the 95 % interval of the change there by the tolerances of both scenes, whose
    inputs are off alike; None where no tolerance is stated, or the part of one is unknown.
    """

    figure: str
    points: int
    beyond: int
    only_a: int = 0
    only_b: int = 0
    a: float | None = None
    b: float | None = None
    change: float | None = None
    relative: float | None = None
    error: float | None = None
    at: Mapping[str, Any] | None = None
    inputs: float | None = None


@dataclass(frozen=True)
class StatusChange:
    """A common point whose status differs."""

    at: Mapping[str, Any]
    a: str
    b: str


@dataclass(frozen=True, repr=False)
class Comparison(Brief):
    """Two files: numbers of points, differences of the scenes {path: (A, B)} as texts, figures, statuses.

    `compared` counts the common points that are ok in both files: only these have figures to compare.
    """

    common: int
    compared: int
    only_a: int
    only_b: int
    scene: Mapping[str, tuple[str | None, str | None]]
    figures: tuple[FigureChange, ...]
    status_changes: int
    first_status_changes: tuple[StatusChange, ...]

    @property
    def equal(self) -> bool:
        """Whether statuses and figures agree at all common points; False where no point has figures."""
        odd = any(figure.beyond or figure.only_a or figure.only_b for figure in self.figures)
        return not odd and not self.status_changes and self.compared > 0

    def _about(self) -> About:
        points = {"in common": self.common, "ok in both": self.compared, "only in A": self.only_a}
        counts = ", ".join(f"{count} {what}" for what, count in (points | {"only in B": self.only_b}).items())
        notes = [f"points: {counts}"]
        notes += [f"scenes differ by {', '.join(self.scene)}"] if self.scene else []
        notes += [f"the status of {self.status_changes} points differs"] if self.status_changes else []
        rows = [_cells(figure) for figure in self.figures]
        columns = ("figure [SI]", "A", "B", "error of both", "differ")
        return About(f"Comparison: {'equal' if self.equal else 'different'} within errors", notes, columns, rows)


def _cells(each: FigureChange) -> tuple[str, ...]:
    only = [f"{count} only in {side}" for side, count in (("A", each.only_a), ("B", each.only_b)) if count]
    values = ("" if value is None else f"{value:.6g}" for value in (each.a, each.b, each.error))
    return (each.figure, *values, ", ".join([f"{each.beyond} of {each.points}", *only]))


def compare(a: Results, b: Results, tolerance: float = 0.0) -> Comparison:
    """Return the differences from A to B.

    A figure agrees where its change is within CERTAIN times the sum of both estimated errors, or within `tolerance`,
    relative to the larger value. Raise UsageError when no point is common.
    """
    if not 0.0 <= tolerance < math.inf:
        raise UsageError(f"--tolerance {tolerance:g}: is not a relative tolerance (write e.g. 1e-6)")
    sides, places = _joined(a, b)
    (in_a, flat_a, status_a), (in_b, flat_b, status_b) = ((each.cases, each.scene, each.status) for each in sides)
    ok = (status_a == "ok") & (status_b == "ok")

    def point(number: int) -> dict[str, Any]:
        """Return the values [SI] of the varied paths at a common point."""
        return {path: column[number].item() for path, column in places.items()}

    changed = np.flatnonzero(status_a != status_b)
    first = (StatusChange(point(i), str(status_a[i]), str(status_b[i])) for i in changed[:MOST_CHANGES])
    names = dict.fromkeys((*_figures(a), *_figures(b)))
    figures = (_change(name, sides, ok, point, tolerance) for name in names)
    sides_of = {path: (flat_a.get(path), flat_b.get(path)) for path in (*flat_a, *flat_b)}
    return Comparison(
        len(in_a),
        int(np.count_nonzero(ok)),
        math.prod(a.shape) - len(np.unique(in_a)),
        math.prod(b.shape) - len(np.unique(in_b)),
        {path: both for path, both in sides_of.items() if path not in places and both[0] != both[1]},
        tuple(figure for figure in figures if figure is not None),
        len(changed),
        tuple(first),
    )


class CommonPoints(NamedTuple):
    """Common points of two files: the varied paths and their values [SI], figures [SI] of both, and their errors.

    A figure missing in a file or a case is NaN; errors are absolute, those of both files together.
    """

    places: Mapping[str, Array]
    status: tuple[Array, Array]
    figures: Mapping[str, tuple[Array, Array, Array]]


def common_points(a: Results, b: Results) -> CommonPoints:
    """Return all figures at the points that both files have; raise UsageError when there are none."""
    sides, places = _joined(a, b)
    figures = {}
    for name in dict.fromkeys((*_figures(a), *_figures(b))):
        one, other = (side.values(name) for side in sides)
        if np.isfinite(one).any() or np.isfinite(other).any():
            there = all(name in _figures(each) for each in (a, b))
            error = sides[0].errors(name) + sides[1].errors(name) if there else np.full(len(one), np.nan)
            figures[name] = one, other, error
    return CommonPoints(places, (sides[0].status, sides[1].status), figures)


def _figures(results: Results) -> dict[str, None]:
    """Return the names of a file's figures, of two stages also those of each with its name before them."""
    own = (f"{stage}_{name}" for stage, each in results.stages.items() for name in each.error)
    return dict.fromkeys((*results.error, *own))


def _values_of_scene(results: Results) -> dict[str, str]:
    """Return {dotted path: text} of a file's scene; of two stages both scenes', with the stage before the path."""
    found = scene_values(results.scene_yaml, str(results.path), ("sweep", "title", "stages"))
    for stage, each in results.stages.items():
        found |= {f"{stage}.{path}": text for path, text in _values_of_scene(each).items()}
    return found


def matched(a: Sequence[Array], b: Sequence[Array], rows: tuple[int, int]) -> tuple[Array, Array]:
    """Return the rows of a and of b, in the order of a, that have the same values in all columns.

    A sample may have a point several times: the first of a goes with the first of b, and so on; where one side has
    fewer, its last one goes with the others. However many columns vary together, no code outgrows its integer: after
    each column they are numbered anew.
    """
    codes = np.zeros(sum(rows), np.int64)
    for column_a, column_b in zip(a, b, strict=True):
        own = np.concatenate(_coded(column_a, column_b))
        codes = np.unique(codes * (1 + own.max()) + own, return_inverse=True)[1]
    codes_a, codes_b = codes[: rows[0]], codes[rows[0] :]
    mine, partners = _partners(codes_a, codes_b)
    others, theirs = _partners(codes_b, codes_a)
    repeated = ~np.isin(others, partners)  # of b, where a has the point less often
    in_a, in_b = np.concatenate([mine, theirs[repeated]]), np.concatenate([partners, others[repeated]])
    order = np.argsort(in_a, kind="stable")
    return in_a[order], in_b[order]


def _partners(codes: Array, others: Array) -> tuple[Array, Array]:
    """Return the rows whose code is among the others, and for each the row there: as many-th of that code, or last."""
    own, theirs = np.argsort(codes, kind="stable"), np.argsort(others, kind="stable")
    rank = np.empty(len(codes), np.int64)
    rank[own] = np.arange(len(codes)) - np.searchsorted(codes[own], codes[own])
    first, end = (np.searchsorted(others[theirs], codes, side) for side in ("left", "right"))
    found = np.flatnonzero(end > first)
    return found, theirs[np.minimum(first + rank, end - 1)[found]]


def _column(results: Results, path: str, flat: Mapping[str, str]) -> Array:
    """Return the value of a path in every case, flattened; the scene's value where the path is not varied."""
    if path in results.varied:
        return results.along(path).ravel()
    name = variable_name(path)
    value: Any = results.inputs[name] if name in results.inputs else flat.get(path)
    if value is None or (isinstance(value, np.ndarray) and np.isnan(value)):
        what = f"has no {path}, over which the other file is swept"
        raise UsageError(f"{results.path}: {what} (compare files that both have it)")
    return np.full(math.prod(results.shape), value)


def _coded(a: Array, b: Array) -> tuple[Array, Array]:
    """Return integer codes that are equal where values are: numbers within SAME, texts exactly."""
    both = np.concatenate([a, b])
    if both.dtype.kind not in "fiu":
        codes = np.unique(both.astype(np.str_), return_inverse=True)[1]
        return codes[: len(a)], codes[len(a) :]
    order = np.argsort(both, kind="stable")
    ordered = both[order]
    steps = np.diff(ordered) > SAME_VALUE * np.maximum(np.abs(ordered[1:]), np.abs(ordered[:-1]))
    codes = np.empty(len(both), np.int64)
    codes[order] = np.concatenate([[0], np.cumsum(steps)])
    return codes[: len(a)], codes[len(a) :]


class _FileAtCommonPoints:
    """Figures of one file at the common points."""

    def __init__(self, results: Results, cases: Array, scene: Mapping[str, str]) -> None:
        self._results, self.cases, self.scene = results, cases, scene
        self.status = results.status.ravel()[cases]
        self._accuracy = np.nan_to_num(results.accuracy)
        self._toleranced = any(sign in text for text in scene.values() for sign in TOLERANCE_SIGNS)

    def values(self, name: str) -> Array:
        """Return a figure [SI], NaN where it is missing; an axis of the same name in the file has its values."""
        of, own = self._results.holder(name)
        if own in of.performance:
            return of.performance[own].ravel()[self.cases]
        path = next((path for path in self._results.varied if variable_name(path) == name), None)
        if path is None:
            return np.full(len(self.cases), np.nan)
        return self._results.along(path).ravel()[self.cases].astype(float)

    def errors(self, name: str) -> Array:
        """Return the estimated absolute error of a figure; from the wanted accuracy where nothing was estimated."""
        of, own = self._results.holder(name)
        if own not in of.performance:  # an axis, or missing
            return np.zeros(len(self.cases))
        return self._results.absolute_error(name, self._accuracy).ravel()[self.cases]

    def contributions(self, name: str, number: int) -> dict[frozenset[str], float] | None:
        """Return the change [SI] of a figure at a common point by one standard uncertainty of each input.

        The inputs are sets of paths that err together; none where no tolerance is stated. Return None where tolerances
        are stated and the change by one of them is unknown.
        """
        of, own = self._results.holder(name)
        group = of.contributions
        if own not in group:
            return None if self._toleranced else {}
        row = group[own].reshape(-1, group[own].shape[-1])[self.cases[number]]
        if np.isnan(row).any():
            return None
        inputs = (frozenset(label.split(TOGETHER)) for label in group["contributor"].tolist())
        return dict(zip(inputs, row.tolist(), strict=True))


Sides = tuple[_FileAtCommonPoints, _FileAtCommonPoints]


def _joined(a: Results, b: Results) -> tuple[Sides, dict[str, Array]]:
    """Return both files at their common points, and the values of each varied path there."""
    paths = list(dict.fromkeys([*a.varied, *b.varied]))
    flat_a, flat_b = _values_of_scene(a), _values_of_scene(b)
    columns_a, columns_b = ([_column(each, path, flat) for path in paths] for each, flat in ((a, flat_a), (b, flat_b)))
    in_a, in_b = matched(columns_a, columns_b, (math.prod(a.shape), math.prod(b.shape)))
    if not len(in_a):
        what = f"{', '.join(paths)} {'differs' if len(paths) == 1 else 'differ'} (sweep over common values)"
        raise UsageError(f"{a.path} and {b.path} have no point in common: {what}")
    places = {path: column[in_a] for path, column in zip(paths, columns_a, strict=True)}
    return (_FileAtCommonPoints(a, in_a, flat_a), _FileAtCommonPoints(b, in_b, flat_b)), places


def _change(
    name: str, sides: Sides, ok: Array, point: Callable[[int], dict[str, Any]], tolerance: float
) -> FigureChange | None:
    """Return the change of one figure; None where neither file has values of it at the common points."""
    a, b = (side.values(name) for side in sides)
    has_a, has_b = np.isfinite(a) & ok, np.isfinite(b) & ok
    only_a, only_b = (int(np.count_nonzero(one & ~other)) for one, other in ((has_a, has_b), (has_b, has_a)))
    both = np.flatnonzero(has_a & has_b)
    if not len(both):
        return FigureChange(name, 0, 0, only_a, only_b) if only_a or only_b else None
    change, size = (b - a)[both], np.maximum(np.abs(a), np.abs(b))[both]
    error = (sides[0].errors(name) + sides[1].errors(name))[both]
    allowed = np.maximum(ERROR_MULTIPLE * error, max(tolerance, ROUNDING) * size)
    over = np.abs(change) / np.maximum(allowed, 1e-300)
    worst = int(np.argmax(over))
    value_a, value_b = float(a[both[worst]]), float(b[both[worst]])
    relative = (value_b - value_a) / abs(value_a) if value_a else None
    changes = (value_a, value_b, value_b - value_a, relative, float(error[worst]), point(both[worst]))
    inputs = _uncertainty_of_change(*(side.contributions(name, both[worst]) for side in sides))
    beyond = int(np.count_nonzero(over > 1.0))
    return FigureChange(name, len(both), beyond, only_a, only_b, *changes, inputs)


def _uncertainty_of_change(
    a: Mapping[frozenset[str], float] | None, b: Mapping[frozenset[str], float] | None
) -> float | None:
    """Return half of the 95 % interval of a change by the inputs of both sides; None without any, or if unknown.

    Inputs that err together in one file are taken together in the other, too, and are off alike in both.
    """
    if a is None or b is None or not (a or b):
        return None
    groups: list[frozenset[str]] = []
    for paths in (*a, *b):
        joined = [each for each in groups if each & paths]
        groups = [each for each in groups if not each & paths] + [paths.union(*joined)]
    sums = ([sum(by for paths, by in side.items() if paths <= group) for group in groups] for side in (a, b))
    return COVERAGE * math.dist(*sums)
