"""A map as a table: figures on a grid of inputs, refined until independent check points are met.

The nodes of an axis double where leaving out every second one gives the largest error. The stated error is the largest
at points drawn in the box (a scrambled Sobol sequence) and simulated for this purpose; for a table from a file, which
has no such points, it is that of leaving out every second node, and so of a coarser table.
"""

from __future__ import annotations

import itertools
import math
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.export.hermite import Array, evaluate, grid_of, points_of, with_middles
from screwsim.export.inputs import (
    FIGURES,
    Input,
    check_names,
    evenly_spaced_nodes,
    followers_of,
    followers_text,
    input_of,
    plain,
    title_on_one_line,
    with_followers,
)
from screwsim.export.map_table import MapTable
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figure
from screwsim.results import Results, open_results
from screwsim.results.schema import Axis, quantities_along
from screwsim.results.warning_kinds import kinds_of, warnings_of_cases
from screwsim.scene import Scene, scene_text, without_sweep
from screwsim.scene.types import Joint
from screwsim.study.asked.varied import Varied
from screwsim.study.pool.progress import Progress
from screwsim.study.stages.store import chain_text, save_chain
from screwsim.study.sweep import run_sweep
from screwsim.study.sweep.stages import sweep_stages

CHECK_POINTS = 32  # check points drawn
SAFETY_SHARE = 0.7  # of the requested error: required at the check points, so that other points meet the requested one
FEW_INPUTS = 2  # up to so many, each axis begins with five nodes, beyond with three
LEAST_SCALE = 0.1  # of the largest value: least scale of relative errors
TEMPERATURE_SCALE = 100.0  # [K] scale of errors of temperatures
TITLE_SEPARATOR = "; SI units; error between the nodes "  # in the first line of a table as text
FEW_NODES = 4  # number of nodes of an axis up to which no error is estimated from it


def scales(outputs: Sequence[Figure], values: Array) -> Array:
    """Return the scale of relative errors of values (…, outputs): their size, limited below; 100 K for temperatures."""
    size = np.abs(values)
    largest = np.nanmax(size.reshape(-1, size.shape[-1]), axis=0)
    found = np.maximum(size, LEAST_SCALE * largest)
    kelvin = np.array([output.units == "K" for output in outputs])
    return np.where(kelvin, TEMPERATURE_SCALE, np.where(found > 0.0, found, 1.0))


def tabulated_map(
    scene: Varied,
    inputs: Sequence[Input],
    outputs: Sequence[Figure],
    wanted: float,
    *,
    most: int = 5000,
    jobs: int | None,
    progress: Callable[[], Progress] | None = None,
    simulate: Any = None,
) -> MapTable:
    """Return the map of a scene, or of two stages, over its inputs.

    Its error at the check points is at most `SAFETY_SHARE` times `wanted`. At most `most` nodes are simulated; a table
    that remains coarser because of them says so (`MapTable.met`). Raise UsageError where nothing closes.
    """
    check_names(inputs, outputs)
    head = title_on_one_line(scene.title), tuple(inputs), tuple(outputs)
    text = _text(without_sweep(scene))
    solve = _Solver(scene, outputs, jobs, progress, simulate)
    nodes = [evenly_spaced_nodes(variable, 5 if len(inputs) <= FEW_INPUTS else 3) for variable in inputs]
    points = _drawn_check_points(inputs)
    known = solve.grid(inputs, nodes)
    at_points, sound_points = solve.points(inputs, points)
    while True:
        values, sound = known
        if not sound.any():
            why = solve.why or "choose other ranges"
            raise UsageError(f"no map: none of {sound.size} points closed ({why})")
        table = MapTable(*head, grid_of(nodes, values, sound), wanted, text)
        errors, checked, open_ = _errors(table, points, at_points, sound_points)
        if checked and max(errors) <= SAFETY_SHARE * wanted:
            break
        apart = [np.max(_axis_error(nodes, values, sound, outputs, axis)[0]) for axis in range(len(nodes))]
        axis = int(np.argmax(apart))  # few nodes give large errors
        x = nodes[axis]
        finer = with_middles(x)
        if math.prod(len(x) if i != axis else len(finer) for i, x in enumerate(nodes)) > most:
            break
        known = _inserted(solve, inputs, nodes, axis, finer, known)
        nodes[axis] = finer
    if not checked:
        why = f"no test point lies among closed ones: {int(sound.sum())} of {sound.size} nodes closed ({solve.why})"
        raise UsageError(f"no map: {why}")
    how = f"largest at {checked} random points inside, simulated as a check"
    how += f" (at {open_} more no cycle closed, although it did at all surrounding nodes)" if open_ else ""
    found = replace(table, outputs=_with_signs(outputs, values[sound]), errors=tuple(errors), checked=checked, how=how)
    return replace(found, cases=solve.cases, why=solve.why, warnings=kinds_of(solve.warnings))


def _with_signs(outputs: Sequence[Figure], values: Array) -> tuple[Figure, ...]:
    """Return the outputs; the meaning of a power that is below zero throughout `values`, as of an expander, says so."""
    given = [output.units == "W" and bool(np.all(values[:, i] < 0.0)) for i, output in enumerate(outputs)]
    sign = "; below zero: given off"
    return tuple(
        replace(each, long_name=each.long_name + sign) if less else each
        for each, less in zip(outputs, given, strict=True)
    )


def table_of(results: Results, figures: Sequence[str] | None = None) -> MapTable:
    """Return the map in a sweep's results file, over all its axes; raise UsageError where there is none."""
    if not results.axis_list:
        raise UsageError(f"{results.path}: holds no grid (a map needs a sweep over one or more axes)")
    varied = [axis for axis in results.axis_list if len(axis.values) > 1]
    if not varied:
        raise UsageError(f"{results.path}: varies nothing, as each axis has one value (export a sweep over more)")
    axes = [axis.joined[0] if axis.joined else axis for axis in varied]
    refuse_words(results, varied)
    inputs = [_input_of(results, axis, whole.joined[1:]) for axis, whole in zip(axes, varied, strict=True)]
    orders = [np.argsort(np.asarray(axis.values, float)) for axis in axes]
    names = figures or [name for name in FIGURES if name in results.figures]
    outputs = [results.figure(name) for name in names]
    check_names(inputs, outputs)

    def sorted_grid(column: Any) -> np.ndarray:
        """Return a column of the results on the grid of the axes, each in ascending order."""
        return np.asarray(column).reshape([len(axis.values) for axis in axes])[np.ix_(*orders)]

    values = np.stack([sorted_grid(results.performance[output.name]) for output in outputs], axis=-1)
    sound = (sorted_grid(results.status) == "ok") & np.isfinite(values).all(axis=-1)
    if not sound.any():
        raise UsageError(f"{results.path}: none of its cases closed")
    across = zip(inputs, axes, orders, strict=True)
    nodes = [variable.coordinate(np.asarray(axis.values, float)[order]) for variable, axis, order in across]
    errors, checked = _errors_of_leaving_out(nodes, values, sound, outputs)
    how = f"largest at {checked} nodes when every second one of an axis is left out: for a table twice as coarse"
    how = how if checked else "unknown, as no axis has five values"
    head = title_on_one_line(results.attributes["title"]), tuple(inputs), _with_signs(outputs, values[sound])
    grid, why, warnings = grid_of(nodes, values, sound), _first_reason(results), kinds_of(warnings_of_cases(results))
    text = _documents(results.scene_yaml, {name: each.scene_yaml for name, each in results.stages.items()})
    return MapTable(*head, grid, None, text, errors, checked, how, sound.size, why, warnings)


def _first_reason(results: Results) -> str:
    """Return why the first case without a closed cycle has none; empty where all have one."""
    cases = zip(np.ravel(results.status), np.ravel(results.messages), strict=True)
    return next((str(why) for status, why in cases if status != "ok" and why), "")


def _first_lack(results: Results, outputs: Sequence[Figure]) -> str:
    """Return that no case has one of the outputs; empty where each has a value."""
    absent = next((output.name for output in outputs if output.name not in results.figures), "")
    return f"they have no {absent}; choose another --figure" if absent else ""


def _input_of(results: Results, axis: Axis, others: Sequence[Axis]) -> Input:
    """Return the input that an axis of a sweep is.

    What varies together with it (`others`) follows it; raise UsageError where it has not one value for each.
    """
    ends = np.min(axis.values), np.max(axis.values)
    found = input_of(axis.path, axis.units, axis.long_name, ends, float(axis.values[0]))
    numbers = {each.path: each.values for each in others}
    followers = followers_of(axis.values, numbers) if others else ()
    if followers is None:
        what = f"{axis.path} varies together with {' and '.join(numbers)}, but does not rise or fall throughout"
        raise UsageError(f"{results.path}: holds no grid: {what} (a map needs axes of their own)")
    return with_followers(found, followers)


def refuse_words(results: Results, axes: Iterable[Axis]) -> None:
    """Raise UsageError where one of some axes of a sweep, or what varies along it, has words for values."""
    for one in quantities_along(axes):
        if one.values.dtype.kind != "f":
            what = f"{one.path} has values that are no numbers (export a sweep of one of them)"
            raise UsageError(f"{results.path}: {what}")


def _drawn_check_points(inputs: Sequence[Input]) -> Array:
    """Return the check points in the box [SI] (n, inputs); always the same for the same box."""
    from scipy.stats import qmc

    shares = qmc.Sobol(len(inputs), rng=1).random(CHECK_POINTS)
    columns = []
    for one, share in zip(inputs, shares.T, strict=True):
        low, high = float(one.coordinate(one.low)), float(one.coordinate(one.high))
        columns.append(one.at(low + share * (high - low)))
    return np.column_stack(columns)


def _errors(table: MapTable, points: Array, values: Array, sound: Array) -> tuple[list[float], int, int]:
    """Return each output's largest error at inside points that closed, and how many inside points did, and did not."""
    found, inside = table(points)
    there = inside & sound
    not_closed = int((inside & ~sound).sum())
    if not there.any():
        return [math.inf], 0, not_closed
    relative = np.abs(found - values)[there] / scales(table.outputs, np.where(sound[:, None], values, np.nan))[there]
    return [float(each) for each in relative.max(axis=0)], int(there.sum()), not_closed


def _errors_of_leaving_out(
    nodes: Sequence[Array], values: Array, sound: Array, outputs: Sequence[Figure]
) -> tuple[tuple[float, ...], int]:
    """Return the largest errors from leaving out every second node of each axis that has five or more; their number."""
    tested = [axis for axis, x in enumerate(nodes) if len(x) > FEW_NODES]
    found = [_axis_error(nodes, values, sound, outputs, axis) for axis in tested]
    errors, count = [errors for errors, number in found if number], sum(number for _, number in found)
    return tuple(np.max(errors, axis=0).tolist()) if errors else (math.nan,) * len(outputs), count


def _axis_error(
    nodes: Sequence[Array], values: Array, sound: Array, outputs: Sequence[Figure], axis: int
) -> tuple[Array, int]:
    """Return the errors of the outputs at nodes of an axis left out of a table of every second one; their number."""
    kept = np.unique([*range(0, len(nodes[axis]), 2), len(nodes[axis]) - 1])
    dropped = np.setdiff1d(np.arange(len(nodes[axis])), kept)
    coarse = [x[kept] if i == axis else x for i, x in enumerate(nodes)]
    grid = grid_of(coarse, np.take(values, kept, axis), np.take(sound, kept, axis))
    found, inside = evaluate(grid, points_of([x[dropped] if i == axis else x for i, x in enumerate(nodes)]))
    there = inside & np.take(sound, dropped, axis).ravel()
    true = np.take(values, dropped, axis).reshape(-1, len(outputs))
    if not there.any():
        return np.zeros(len(outputs)), 0
    size = scales(outputs, np.where(sound[..., None], values, np.nan))
    scale = np.take(size, dropped, axis).reshape(-1, len(outputs))
    return np.max(np.abs(found - true)[there] / scale[there], axis=0), int(there.sum())


def _inserted(
    solve: _Solver, inputs: Sequence[Input], nodes: Sequence[Array], axis: int, finer: Array, known: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return values and soundness on the grid refined along one axis; only the nodes between are simulated."""
    between = finer[1::2]
    fresh = solve.grid(inputs, [between if i == axis else x for i, x in enumerate(nodes)])
    merged = []
    for old, new in zip(known, fresh, strict=True):
        both = np.concatenate([old, new], axis=axis)
        order = np.argsort(np.concatenate([nodes[axis], between]), kind="stable")
        merged.append(np.take(both, order, axis=axis))
    return merged[0], merged[1]


@contextmanager
def temporary_results(scene: Varied, **options: Any) -> Iterator[Results]:
    """Give the results of a sweep, whose file is removed at the end; `options` are those of the function that runs it.

    That is `run_sweep` for a scene, and `sweep_stages` for two stages.
    """
    with tempfile.TemporaryDirectory(prefix="screwsim-") as folder:
        path = Path(folder) / "map.h5"
        if isinstance(scene, Scene):
            run_sweep(replace(scene, text=_text(scene)), path, **options)
        else:
            save_chain(path, scene, sweep_stages(scene, warm=True, **options), "sweep")
        yield open_results(path)


@dataclass
class _Solver:
    """Simulates grids and points of a scene, counts cases, and keeps the first reason for a failure."""

    scene: Varied
    outputs: Sequence[Figure]
    jobs: int | None
    progress: Callable[[], Progress] | None
    simulate: Any
    cases: int = 0
    why: str = ""
    warnings: list[list[str]] = field(default_factory=list)

    def grid(self, inputs: Sequence[Input], nodes: Sequence[Array]) -> tuple[Array, Array]:
        """Return values (nodes …, outputs) and which nodes closed."""
        each = {variable.name: variable.swept(variable.at(u)) for variable, u in zip(inputs, nodes, strict=True)}
        sweep = {path: values for one in each.values() for path, values in one.items()}
        joints = tuple(Joint(name, tuple(one)) for name, one in each.items() if len(one) > 1)
        return self._swept(replace(self.scene, sweep=sweep, joints=joints), tuple(map(len, nodes)))

    def points(self, inputs: Sequence[Input], points: Array) -> tuple[Array, Array]:
        """Return values (points, outputs) and which of them closed."""
        each = (variable.swept(points[:, i]) for i, variable in enumerate(inputs))
        sweep = {path: values for one in each for path, values in one.items()}
        joint = Joint("case", tuple(sweep))
        return self._swept(replace(self.scene, sweep=sweep, joints=(joint,)), (len(points),))

    def _swept(self, scene: Varied, shape: tuple[int, ...]) -> tuple[Array, Array]:
        options = {} if self.simulate is None else {"simulate": self.simulate}
        told = None if self.progress is None else self.progress()
        with temporary_results(scene, jobs=self.jobs, progress=told, **options) as results:
            self.cases += math.prod(shape)
            self.warnings += warnings_of_cases(results)
            nothing = np.full(shape, np.nan)
            columns = [np.reshape(results.performance.get(output.name, nothing), shape) for output in self.outputs]
            values = np.stack(columns, axis=-1)
            sound = (results.status.reshape(shape) == "ok") & np.isfinite(values).all(axis=-1)
            if not sound.all() and not self.why:
                self.why = _first_reason(results) or _first_lack(results, self.outputs)
        return values, sound


def _text(scene: Varied) -> str:
    """Return the text of a scene, or of two stages."""
    if isinstance(scene, Scene):
        return scene_text(scene)
    return _documents(chain_text(scene), {name: scene_text(each) for name, each in scene.by_stage.items()})


def _documents(text: str, stages: Mapping[str, str]) -> str:
    """Return the text of a scene; of two stages that of their file and of both scenes, as YAML documents."""
    return "".join([text, *(f"---\n# {name}.yaml\n{own}" for name, own in stages.items())])


def csv_table(table: MapTable) -> str:
    """Return the rows of all nodes, the last input fastest; `closed` is 0 where a cycle did not close."""
    heads = [f"{each.name} [{plain(each.units)}]" for each in (*table.inputs, *table.outputs)]
    linear = f"linear interpolation differs from the cubic by up to {linear_difference(table):.2g}"
    error = f"{table.error_in_words}; {linear}"
    lines = [f"# {table.title}{TITLE_SEPARATOR}{error}{followers_text(table.inputs)}"]
    lines.append(",".join([*heads, "closed"]))
    nodes = table.nodes
    values = table.grid.data[(0,) * len(nodes)]
    for place in itertools.product(*(range(len(x)) for x in nodes)):
        closed = bool(table.grid.sound[place])
        at = [f"{x[i]:.12g}" for x, i in zip(nodes, place, strict=True)]
        figures = [f"{value:.12g}" if closed else "" for value in values[place]]
        lines.append(",".join([*at, *figures, str(int(closed))]))
    return "\n".join(lines) + "\n"


def linear_difference(table: MapTable) -> float:
    """Return the largest difference of linear interpolation of the nodes from the map, relative as its errors are.

    It is that at the middles of cells and of their sides. Most readers of a plain table interpolate so.
    """
    from scipy.interpolate import RegularGridInterpolator

    nodes = table.nodes
    x = points_of([with_middles(each) for each in nodes])
    ours, inside = table(x)
    size = scales(table.outputs, np.where(inside[:, None], ours, np.nan))
    straight = RegularGridInterpolator(nodes, table.grid.data[(0,) * len(nodes)])(x)
    return float(np.max(np.abs(straight - ours)[inside] / size[inside], initial=0.0))
