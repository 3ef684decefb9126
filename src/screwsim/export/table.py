"""A map as a table: figures on a grid of inputs, made finer until points that it was not made from are met.

Nodes of an axis double where leaving out every second one errs most. The error that is stated is the largest at points
drawn in the box (a scrambled Sobol sequence) and simulated for that alone; of a table from a file, which has no such
points, that of leaving out every second node, and so of a coarser table.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.export.hermite import Array, Grid, evaluate, grid_of
from screwsim.export.inputs import Input, Output, check_names, input_name, one_line, output_of, spread
from screwsim.inputs.faults import UsageError
from screwsim.results import Results, open_results
from screwsim.scene import Scene, scene_text
from screwsim.scene.types import Joint
from screwsim.study.progress import Progress
from screwsim.study.sweep import run_sweep

CHECKS = 32  # points that are drawn
SAFE = 0.7  # of the error that is asked for: met at the points that are drawn, so that others meet that asked for
FEW_INPUTS = 2  # up to so many an axis begins with five nodes, beyond with three
LEAST_SCALE = 0.1  # of the largest value: what errors of small ones are relative to
KELVIN = 100.0  # what errors of temperatures are relative to [K]
TOO_FEW = 4  # sound points below which nothing is stated


@dataclass(frozen=True, eq=False)
class Table:
    """A map: `grid` over the inputs' coordinates; `errors` of each output, relative, and how they were found.

    `cases` were simulated, `not_ok` of the nodes have no closed cycle; `met` tells whether the error asked for is kept.
    """

    title: str
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    grid: Grid
    errors: tuple[float, ...]
    checked: int
    how: str
    cases: int
    not_ok: int
    wanted: float | None
    scene_yaml: str
    about: dict[str, Any] = field(default_factory=dict)

    @property
    def error(self) -> float:
        """The largest of the errors."""
        return max(self.errors)

    @property
    def error_in_words(self) -> str:
        """The largest of the errors and how it was found; where it is not known, why."""
        return f"{self.error:.2g}, {self.how}" if math.isfinite(self.error) else self.how

    @property
    def met(self) -> bool:
        return self.wanted is None or self.error <= self.wanted

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """Return the outputs [SI] at inputs (n, inputs) [SI], and whether each point is inside."""
        x = np.atleast_2d(np.asarray(x, float))
        clipped = np.column_stack([np.clip(x[:, i], one.low, one.high) for i, one in enumerate(self.inputs)])
        outside = np.any(np.abs(x - clipped) > 1e-9 * np.abs(clipped), axis=1)
        u = np.column_stack([one.coordinate(clipped[:, i]) for i, one in enumerate(self.inputs)])
        values, inside = evaluate(self.grid, u)
        return values, inside & ~outside


def scales(outputs: Sequence[Output], values: Array) -> Array:
    """Return what errors of values (…, outputs) are relative to: their size, 100 K for temperatures."""
    size = np.abs(values)
    largest = np.nanmax(size.reshape(-1, size.shape[-1]), axis=0)
    found = np.maximum(size, LEAST_SCALE * largest)
    kelvin = np.array([each.units == "K" for each in outputs])
    return np.where(kelvin, KELVIN, np.where(found > 0.0, found, 1.0))


Solve = Callable[[dict[str, Array], bool], tuple[Array, Array]]  # {path: values}, together? -> values, sound


def tabulate(
    scene: Scene,
    inputs: Sequence[Input],
    outputs: Sequence[Output],
    wanted: float,
    *,
    most: int = 5000,
    jobs: int | None = None,
    progress: Callable[[], Progress] | None = None,
    simulate: Any = None,
) -> Table:
    """Return the map of a scene whose error at points drawn is at most `SAFE` times the wanted one, of `most` cases.

    Raise UsageError where nothing closes; a table that stays coarser for `most` says so (`Table.met`).
    """
    check_names(inputs, outputs)
    solve = _Solver(scene, outputs, jobs, progress, simulate)
    nodes = [spread(one, 5 if len(inputs) <= FEW_INPUTS else 3) for one in inputs]
    points = _drawn(inputs)
    known = solve.grid(inputs, nodes)
    at_points, sound_points = solve.points(inputs, points)
    while True:
        values, sound = known
        if not sound.any():
            why = solve.why or "choose other ranges"
            raise UsageError(f"no map: of {sound.size} points 0 closed ({why})")
        table = _table(scene, inputs, outputs, nodes, values, sound, wanted)
        errors, checked, open_ = _errors(table, points, at_points, sound_points)
        if checked and max(errors) <= SAFE * wanted:
            break
        axis = _coarsest(nodes, values, sound, outputs)
        x = nodes[axis]
        finer = np.sort(np.concatenate([x, 0.5 * (x[1:] + x[:-1])]))
        if math.prod(len(x) if i != axis else len(finer) for i, x in enumerate(nodes)) > most:
            break
        known = _inserted(solve, inputs, nodes, axis, finer, known)
        nodes[axis] = finer
    if not checked:
        why = f"no point drawn lies among closed ones: {int(sound.sum())} of {sound.size} nodes closed ({solve.why})"
        raise UsageError(f"no map: {why}")
    how = f"largest at {checked} points drawn inside and simulated for it"
    how += f" (at {open_} more no cycle closed, though it did at all nodes around)" if open_ else ""
    return replace(table, errors=tuple(errors), checked=checked, how=how, cases=solve.cases)


def table_of(results: Results, figures: Sequence[str] | None = None) -> Table:
    """Return the map that a file of a sweep holds, over all its axes; raise UsageError where it holds none."""
    if not results.axis_list or any(axis.joined for axis in results.axis_list):
        raise UsageError(
            f"{results.path}: holds no grid (a map needs a sweep over one axis or more, none of them joined)"
        )
    axes = [axis for axis in results.axis_list if len(axis.values) > 1]
    if not axes:
        raise UsageError(f"{results.path}: varies nothing: each axis has one value (export a sweep over more)")
    if any(axis.values.dtype.kind != "f" for axis in axes):
        raise UsageError(f"{results.path}: has an axis of words (export a sweep of one of them)")
    inputs, orders = [], []
    for axis in axes:
        values = np.asarray(axis.values, float)
        orders.append(np.argsort(values))
        low, high = float(values.min()), float(values.max())
        log = axis.units == "Pa" and high >= 2.0 * low > 0.0
        inputs.append(
            Input(axis.path, input_name(axis.path), axis.units, axis.long_name, low, high, float(values[0]), log)
        )
    outputs = [output_of(name, {name: results.figure(name)}) for name in figures or _usual(results)]
    check_names(inputs, outputs)
    shape = tuple(len(axis.values) for axis in axes)
    columns = [np.asarray(results.performance[each.name]).reshape(shape)[np.ix_(*orders)] for each in outputs]
    values = np.stack(columns, axis=-1)
    sound = (results.status.reshape(shape)[np.ix_(*orders)] == "ok") & np.isfinite(values).all(axis=-1)
    if not sound.any():
        raise UsageError(f"{results.path}: no case of it closed")
    nodes = [
        one.coordinate(np.asarray(axis.values, float)[order])
        for one, axis, order in zip(inputs, axes, orders, strict=True)
    ]
    table = _table(None, inputs, outputs, nodes, values, sound, None)
    errors, checked = _left_out(nodes, values, sound, outputs)
    how = f"largest at {checked} nodes left out in turn, every second one of an axis: of a table twice as coarse"
    how = how if checked else "not known, as no axis has five values"
    title, yaml = one_line(results.attributes["title"]), results.scene_yaml
    return replace(table, title=title, scene_yaml=yaml, errors=errors, checked=checked, how=how, cases=sound.size)


def _usual(results: Results) -> list[str]:
    from screwsim.export.inputs import FIGURES

    return [name for name in FIGURES if name in results.figures]


def _table(
    scene: Scene | None,
    inputs: Sequence[Input],
    outputs: Sequence[Output],
    nodes: Sequence[Array],
    values: Array,
    sound: Array,
    wanted: float | None,
) -> Table:
    grid = grid_of(nodes, values, sound)
    title = "" if scene is None else one_line(scene.title)
    text = "" if scene is None else scene_text(replace(scene, sweep={}, joints=()))
    not_ok = int((~sound).sum())
    return Table(title, tuple(inputs), tuple(outputs), grid, (math.inf,), 0, "", 0, not_ok, wanted, text)


def _drawn(inputs: Sequence[Input]) -> Array:
    """Return points in the box [SI] (n, inputs); the same again for the same box."""
    from scipy.stats import qmc

    shares = qmc.Sobol(len(inputs), rng=1).random(CHECKS)
    ends = [(float(one.coordinate(one.low)), float(one.coordinate(one.high))) for one in inputs]
    columns = [
        one.at(low + share * (high - low)) for one, (low, high), share in zip(inputs, ends, shares.T, strict=True)
    ]
    return np.column_stack(columns)


def _errors(table: Table, points: Array, values: Array, sound: Array) -> tuple[list[float], int, int]:
    """Return the largest error of each output at points that closed and lie inside, how many closed, and did not."""
    found, inside = table(points)
    there = inside & sound
    not_closed = int((inside & ~sound).sum())
    if not there.any():
        return [math.inf], 0, not_closed
    relative = np.abs(found - values)[there] / scales(table.outputs, np.where(sound[:, None], values, np.nan))[there]
    return [float(each) for each in relative.max(axis=0)], int(there.sum()), not_closed


def _left_out(
    nodes: Sequence[Array], values: Array, sound: Array, outputs: Sequence[Output]
) -> tuple[tuple[float, ...], int]:
    """Return the largest errors of leaving out every second node of each axis that has five or more."""
    each = [_axis_error(nodes, values, sound, outputs, axis) for axis, x in enumerate(nodes) if len(x) > TOO_FEW]
    each = [one for one in each if one[1]]
    if not each:
        return (math.nan,) * len(outputs), 0
    return tuple(float(e) for e in np.max([one[0] for one in each], axis=0)), sum(one[1] for one in each)


def _axis_error(
    nodes: Sequence[Array], values: Array, sound: Array, outputs: Sequence[Output], axis: int
) -> tuple[Array, int]:
    """Return the errors of the outputs at nodes of an axis that a table of every second one was not made from."""
    kept = np.unique([*range(0, len(nodes[axis]), 2), len(nodes[axis]) - 1])
    dropped = np.setdiff1d(np.arange(len(nodes[axis])), kept)
    coarse = [x[kept] if i == axis else x for i, x in enumerate(nodes)]
    grid = grid_of(coarse, np.take(values, kept, axis), np.take(sound, kept, axis))
    mesh = np.meshgrid(*[x[dropped] if i == axis else x for i, x in enumerate(nodes)], indexing="ij")
    found, inside = evaluate(grid, np.column_stack([each.ravel() for each in mesh]))
    there = inside & np.take(sound, dropped, axis).ravel()
    true = np.take(values, dropped, axis).reshape(-1, len(outputs))
    if not there.any():
        return np.zeros(len(outputs)), 0
    size = scales(outputs, np.where(sound[..., None], values, np.nan))
    scale = np.take(size, dropped, axis).reshape(-1, len(outputs))
    return np.max(np.abs(found - true)[there] / scale[there], axis=0), int(there.sum())


def _coarsest(nodes: Sequence[Array], values: Array, sound: Array, outputs: Sequence[Output]) -> int:
    """Return the axis along which leaving out nodes errs most; one of few nodes counts as its errors are, larger."""
    return int(np.argmax([np.max(_axis_error(nodes, values, sound, outputs, axis)[0]) for axis in range(len(nodes))]))


def _inserted(
    solve: _Solver, inputs: Sequence[Input], nodes: Sequence[Array], axis: int, finer: Array, known: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return values and soundness on the grid with the nodes between those of an axis, which alone are simulated."""
    between = finer[1::2]
    fresh = solve.grid(inputs, [between if i == axis else x for i, x in enumerate(nodes)])
    merged = []
    for old, new in zip(known, fresh, strict=True):
        both = np.concatenate([old, new], axis=axis)
        order = np.argsort(np.concatenate([nodes[axis], between]), kind="stable")
        merged.append(np.take(both, order, axis=axis))
    return merged[0], merged[1]


class _Solver:
    """Simulates grids and points of a scene, counting cases; keeps why the first failed."""

    def __init__(
        self,
        scene: Scene,
        outputs: Sequence[Output],
        jobs: int | None,
        progress: Callable[[], Progress] | None,
        simulate: Any,
    ) -> None:
        self._scene, self._outputs, self._jobs = scene, outputs, jobs
        self._progress, self._simulate = progress, simulate
        self.cases, self.why = 0, ""

    def grid(self, inputs: Sequence[Input], nodes: Sequence[Array]) -> tuple[Array, Array]:
        """Return values (nodes …, outputs) and which nodes closed."""
        sweep = {one.path: tuple(map(float, one.at(u))) for one, u in zip(inputs, nodes, strict=True)}
        return self._swept(replace(self._scene, sweep=sweep, joints=()), tuple(map(len, nodes)))

    def points(self, inputs: Sequence[Input], points: Array) -> tuple[Array, Array]:
        """Return values (points, outputs) and which of them closed."""
        sweep = {one.path: tuple(map(float, points[:, i])) for i, one in enumerate(inputs)}
        joint = Joint("case", tuple(sweep))
        return self._swept(replace(self._scene, sweep=sweep, joints=(joint,)), (len(points),))

    def _swept(self, scene: Scene, shape: tuple[int, ...]) -> tuple[Array, Array]:
        whole = replace(scene, text=scene_text(replace(scene, text="")))
        options = {} if self._simulate is None else {"simulate": self._simulate}
        with tempfile.TemporaryDirectory(prefix="screwsim-") as folder:
            path = Path(folder) / "map.h5"
            told = None if self._progress is None else self._progress()
            run_sweep(whole, path, jobs=self._jobs, progress=told, **options)
            results = open_results(path)
            self.cases += math.prod(shape)
            nothing = np.full(shape, np.nan)
            columns = [np.reshape(results.performance.get(each.name, nothing), shape) for each in self._outputs]
            values = np.stack(columns, axis=-1)
            sound = (results.status.reshape(shape) == "ok") & np.isfinite(values).all(axis=-1)
            if not sound.all() and not self.why:
                self.why = next((text for text in results.messages.ravel() if text), "")
        return values, sound
