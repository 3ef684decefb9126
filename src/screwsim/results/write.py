"""Results to HDF5: one file, written beside and renamed, so that it is whole or not there."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.outputs import CYCLE, NUMERICS_TEXT, STATUSES, Figures, Result, cycle_variable, ledger_variable
from screwsim.results.atomic import make_folder, replacing
from screwsim.results.guarded import GuardedFile
from screwsim.results.knock_out import write_knock_out
from screwsim.results.netcdf import (
    Layout,
    Selection,
    chunks_of,
    flag_attributes,
    number_attributes,
    set_attributes,
    text_lines,
)
from screwsim.results.schema import (
    Axis,
    axes_of,
    figure_variable,
    numeric_inputs,
    root_attributes,
    variable_name,
)
from screwsim.results.table import (
    GROUPS,
    NOT_COMPUTED,
    TEXTS,
    InMemory,
    Table,
    Tables,
    ledger_names,
    ledger_of,
    regrouped,
    renumbered,
    rows_of,
    same_angles,
    table_of,
    trace_names,
)
from screwsim.scene.types import Scene

# the format of HDF5 1.8 allows attributes (the scene) beyond 64 KiB; netCDF-4 keeps the order of creation
_FORMAT: dict[str, Any] = {"libver": ("v108", "v108"), "track_order": True}
_NO_CACHE: dict[str, Any] = {
    "rdcc_nbytes": 0
}  # every chunk is written once and whole; HDF5 would keep 8 MiB of each variable
_CASE_TEXTS = {
    "message": "why the case failed or did not close, and the remedy",
    "warnings": "warnings, one a line",
    "notes": "why a figure of a simulated effect has no value, one a line",
}


@dataclass(frozen=True)
class _Names:
    """What all tables together have: effects, states, the different texts, angles, names of traces and ledger."""

    effects: tuple[str, ...]
    states: tuple[str, ...]
    words: dict[str, tuple[str, ...]]
    angle: np.ndarray
    traces: tuple[str, ...]
    ledger: tuple[str, ...]


@dataclass(frozen=True)
class _Column:
    """A variable of the file that is written piece by piece, and its values (cases, …) of a table."""

    data: Any
    values: Callable[[Table], np.ndarray]


def save(path: str | Path, scene: Scene, results: Result | Sequence[Result], command: str = "run") -> None:
    """Write one result, or those of all cases of the scene's sweep (last axis fastest), to an HDF5 file.

    Of one result the knock-out is written, too, where there is one.
    The cycle is kept for one result, and for a sweep when the scene says `output.keep: cycle`. An existing file
    is replaced. Raise UsageError in one line when the system refuses; the old file stays then.
    """
    if isinstance(results, Result):
        one = InMemory(table_of([results], keep_cycle=True))
        write_tables(Path(path), scene, (), one, command, knock_out=results.knock_out)
    else:
        table = table_of(results, keep_cycle=scene.output.keep == "cycle")
        write_tables(Path(path), scene, axes_of(scene), InMemory(table), command)


def write_tables(
    path: Path,
    scene: Scene,
    axes: Sequence[Axis],
    source: Tables,
    command: str,
    folder: Path | None = None,
    knock_out: Sequence[Figures] = (),
) -> None:
    """Write the results of all cases on the axes, chunk by chunk: no more than one chunk of each is in memory.

    The temporary file lies in `folder` (default: beside `path`).
    """
    import h5py

    cases = math.prod(len(axis.values) for axis in axes)
    if cases != source.cases:
        raise ValueError(f"{source.cases} results for {cases} cases")
    make_folder(path.parent)
    with replacing(path, folder) as temporary, closing(GuardedFile(temporary)) as target:
        with h5py.File(target, "w", **_FORMAT, **_NO_CACHE) as file:
            for _ in _write(file, scene, axes, source, command, knock_out):
                target.check()
        target.check()


def _write(
    file: Any, scene: Scene, axes: Sequence[Axis], source: Tables, command: str, knock_out: Sequence[Figures]
) -> Iterator[None]:
    """Write the file; yield after each chunk of cases."""
    names = _names(source)
    stated = {"effects": ", ".join(names.effects), "states": ", ".join(names.states)}
    set_attributes(file, root_attributes(scene, command) | stated)
    layout = Layout(file)
    shape = tuple(len(axis.values) for axis in axes)
    _write_inputs(layout, scene, axes)
    columns = [column for group in GROUPS for column in _figures(layout, group, axes, names)]
    traces = list(_cycle(layout, axes, names)) if names.traces else []
    columns += _ledger(layout, axes, names) if names.ledger else []
    yield from _fill(columns, shape, shape, source.tables(traces=False))
    if traces:
        yield from _fill(traces, shape, (*shape, names.angle.size), source.tables(traces=True))
    if knock_out:
        write_knock_out(layout, knock_out)


def _names(source: Tables) -> _Names:
    effects: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    angle = np.empty(0)
    words: dict[str, set[str]] = {name: set() for name in TEXTS}
    traces: dict[str, None] = {}
    ledger: dict[str, None] = {}
    for head in source.heads():
        effects, states = effects or head.effects, states or head.states
        if angle.size and head.angle.size:
            same_angles(angle, head.angle)
        angle = angle if angle.size else head.angle
        for name in TEXTS:
            words[name].update(map(text_lines, head.texts[name].words))
        traces |= dict.fromkeys(head.traces)
        ledger |= dict.fromkeys(head.ledger)
    sorted_words = {name: tuple(sorted(found)) for name, found in words.items()}
    return _Names(effects, states, sorted_words, angle, trace_names(traces), ledger_names(ledger))


def _fill(
    columns: Sequence[_Column], shape: tuple[int, ...], full: tuple[int, ...], tables: Iterator[Table]
) -> Iterator[None]:
    """Write columns over cases of `shape` chunk by chunk, those of a variable of the shape `full`."""
    places = list(_places(shape, chunks_of(full)[: len(shape)]))
    pieces = regrouped(tables, (size for _, size, _ in places))
    for (first, _, part), table in zip(places, pieces, strict=True):
        selection = Selection(full, first, part)
        for column in columns:
            selection.write(column.data, column.values(table))
        yield


def _places(shape: tuple[int, ...], chunk: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], int, tuple[int, ...]]]:
    """Yield (place of its first case, number of cases, shape) of each chunk, in the order of the cases."""
    split = next((index for index, size in enumerate(chunk) if size > 1), len(shape) - 1)
    if not shape:
        yield (), 1, ()
        return
    inner = shape[split + 1 :]
    for outer in np.ndindex(*shape[:split]):
        for start in range(0, shape[split], chunk[split]):
            size = min(chunk[split], shape[split] - start)
            part = (*(1 for _ in outer), size, *inner)
            yield (*outer, start, *(0 for _ in inner)), size * math.prod(inner), part


def _group(layout: Layout, name: str, axes: Sequence[Axis]) -> tuple[Any, list[str], tuple[int, ...]]:
    """Make a group with its own copy of the axes; return it, the dimensions' names and the shape of a figure."""
    group = layout.group(name)
    for axis in axes:
        values, about = _coordinate(axis)
        layout.coordinate(group, axis.name, values, about)
    for axis in axes:
        for inner in axis.joined:
            values, about = _coordinate(inner)
            layout.variable(group, inner.name, values, (axis.name,), about)
    return group, [axis.name for axis in axes], tuple(len(axis.values) for axis in axes)


def _beside(axes: Sequence[Axis]) -> dict[str, str]:
    """Return the attribute that names the coordinates beside the dimensions' own (CF, section 5)."""
    names = " ".join(inner.name for axis in axes for inner in axis.joined)
    return {"coordinates": names} if names else {}


def _coordinate(axis: Axis) -> tuple[np.ndarray, dict[str, Any]]:
    """Return the coordinate of an axis; texts are numbered, their words kept in the attributes."""
    about: dict[str, Any] = {"units": axis.units, "long_name": axis.long_name, "path": axis.path}
    if axis.values.dtype.kind != "U":
        return axis.values, about
    words = [str(word) for word in axis.values]
    different = list(dict.fromkeys(words))
    about |= flag_attributes(different, axis.long_name) | {"labels": "\n".join(different)}
    return np.array([different.index(word) for word in words], np.int8), about


def _write_inputs(layout: Layout, scene: Scene, axes: Sequence[Axis]) -> None:
    """Write the axes, and every other numeric input of the base scene."""
    group, _, _ = _group(layout, "inputs", axes)
    for path, variable, value in numeric_inputs(scene):
        name = variable_name(path)
        if name not in group:
            about = number_attributes(variable) | {"path": path}
            layout.variable(group, name, np.array(value), (), about)


def _figures(layout: Layout, name: str, axes: Sequence[Axis], names: _Names) -> Iterator[_Column]:
    """Make the variables of a group of figures."""
    group, dimensions, shape = _group(layout, name, axes)
    beside = _beside(axes)
    if name == "performance":
        about = flag_attributes(STATUSES, "how the case ended", NOT_COMPUTED) | beside
        yield _Column(layout.empty(group, "status", shape, np.int8, dimensions, about), lambda table: table.status)
    for figure in GROUPS[name]:
        about = number_attributes(figure_variable(name, figure)) | beside
        data = layout.empty(group, figure, shape, float, dimensions, about)
        yield _Column(data, lambda table, figure=figure: table.column(name, figure))
    for text, long_name in {"performance": _CASE_TEXTS, "numerics": NUMERICS_TEXT}.get(name, {}).items():
        data = layout.texts(group, text, names.words[text], shape, dimensions, long_name)
        if data is not None:
            set_attributes(data, beside)
            yield _Column(data, _numbers(text, names.words[text]))


def _numbers(name: str, words: Sequence[str]) -> Callable[[Table], np.ndarray]:
    """Return what gives the numbers of a table's texts in `words`."""
    place = {word: index for index, word in enumerate(words)}

    def numbers(table: Table) -> np.ndarray:
        texts = table.texts[name]
        return renumbered(texts._replace(words=tuple(map(text_lines, texts.words))), place)

    return numbers


def _cycle(layout: Layout, axes: Sequence[Axis], names: _Names) -> Iterator[_Column]:
    """Make the variables of the traces."""
    group, dimensions, shape = _group(layout, "cycle", axes)
    points = names.angle.size
    layout.coordinate(group, "angle", names.angle, CYCLE["angle"]._asdict())
    for name in names.traces:
        about = number_attributes(cycle_variable(name)) | _beside(axes)
        data = layout.empty(group, name, (*shape, points), float, (*dimensions, "angle"), about)
        yield _Column(data, lambda table, name=name: rows_of(table, name, points))


def _ledger(layout: Layout, axes: Sequence[Axis], names: _Names) -> Iterator[_Column]:
    group, dimensions, shape = _group(layout, "ledger", axes)
    for name in names.ledger:
        about = number_attributes(ledger_variable(name)) | _beside(axes)
        data = layout.empty(group, name, shape, float, dimensions, about)
        yield _Column(data, lambda table, name=name: ledger_of(table, name))
