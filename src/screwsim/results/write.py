"""Results to HDF5: one file, written beside and renamed, so that it is whole or not there."""

from __future__ import annotations

import errno
import math
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.outputs import CYCLE, NUMERICS_TEXT, STATUSES, Result, Variable, cycle_variable, ledger_variable
from screwsim.results.atomic import make_folder, replacing
from screwsim.results.netcdf import Layout, flag_attributes, number_attributes, set_attributes
from screwsim.results.schema import (
    Axis,
    axes_of,
    figure_variable,
    numeric_inputs,
    root_attributes,
    variable_name,
)
from screwsim.results.table import GROUPS, NOT_COMPUTED, Table, table_of
from screwsim.scene.types import Scene

_IN_MEMORY = 1 << 29  # [byte] larger files are written to the disk straight away
# the format of HDF5 1.8 allows attributes (the scene) beyond 64 KiB; netCDF-4 keeps the order of creation
_FORMAT: dict[str, Any] = {"libver": ("v108", "v108"), "track_order": True}
_CASE_TEXTS = {
    "message": "why the case failed or did not close, and the remedy",
    "warnings": "warnings, one a line",
    "notes": "why a figure of a simulated effect has no value, one a line",
}


def save(path: str | Path, scene: Scene, results: Result | Sequence[Result], command: str = "run") -> None:
    """Write one result, or those of all cases of the scene's sweep (last axis fastest), to an HDF5 file.

    The cycle is kept for one result, and for a sweep when the scene says `output.keep: cycle`. An existing file
    is replaced. Raise UsageError in one line when the system refuses; the old file stays then.
    """
    if isinstance(results, Result):
        table, axes = table_of([results], keep_cycle=True), ()
    else:
        table, axes = table_of(results, keep_cycle=scene.output.keep == "cycle"), axes_of(scene)
    write_table(Path(path), scene, axes, table, command)


def write_table(
    path: Path, scene: Scene, axes: Sequence[Axis], table: Table, command: str, folder: Path | None = None
) -> None:
    """Write the results of all cases on the axes; the temporary file lies in `folder` (default: beside `path`)."""
    import h5py

    cases = math.prod(len(axis.values) for axis in axes)
    if cases != len(table):
        raise ValueError(f"{len(table)} results for {cases} cases")
    make_folder(path.parent)
    with replacing(path, folder) as temporary:
        if _size(table) <= _IN_MEMORY:
            temporary.write_bytes(_image(scene, axes, table, command))
            return
        _need_room(temporary.parent, _size(table))
        with h5py.File(temporary, "w", **_FORMAT) as file:
            _write(file, scene, axes, table, command)


def _size(table: Table) -> int:
    """Return about how many bytes the results take uncompressed."""
    return 2 * table.figures.nbytes + 8 * len(table) * table.angle.size * len(table.traces) + 100_000


def _image(scene: Scene, axes: Sequence[Axis], table: Table, command: str) -> bytes:
    """Return the file as bytes made in memory: HDF5 1.14 can crash the process when its own writing fails."""
    import h5py

    with h5py.File("image", "w", driver="core", backing_store=False, **_FORMAT) as file:
        _write(file, scene, axes, table, command)
        file.flush()
        return file.id.get_file_image()


def _need_room(folder: Path, size: int) -> None:
    free = shutil.disk_usage(folder).free
    if free < size:
        raise OSError(errno.ENOSPC, f"{size / 1e9:.1f} GB wanted, {free / 1e9:.1f} GB free")


def _write(file: Any, scene: Scene, axes: Sequence[Axis], table: Table, command: str) -> None:
    stated = {"effects": ", ".join(table.effects), "states": ", ".join(table.states)}
    set_attributes(file, root_attributes(scene, command) | stated)
    layout = Layout(file)
    _write_inputs(layout, scene, axes)
    for group in GROUPS:
        _write_figures(layout, group, axes, table)
    if table.traces:
        _write_cycle(layout, axes, table)
    if table.ledger:
        _write_ledger(layout, axes, table)


def _group(layout: Layout, name: str, axes: Sequence[Axis]) -> tuple[Any, list[str], tuple[int, ...]]:
    """Make a group with its own copy of the axes; return it, the dimensions' names and the shape of a figure."""
    group = layout.group(name)
    for axis in axes:
        values, about = _coordinate(axis)
        layout.coordinate(group, axis.name, values, about)
    return group, [axis.name for axis in axes], tuple(len(axis.values) for axis in axes)


def _coordinate(axis: Axis) -> tuple[np.ndarray, dict[str, Any]]:
    """Return the coordinate of an axis; texts are numbered, their words kept in the attributes."""
    about: dict[str, Any] = {"units": axis.units, "long_name": axis.long_name, "path": axis.path}
    if axis.values.dtype.kind != "U":
        return axis.values, about
    words = [str(word) for word in axis.values]
    about |= flag_attributes(words, axis.long_name) | {"labels": "\n".join(words)}
    return np.arange(len(words), dtype=np.int8), about


def _write_inputs(layout: Layout, scene: Scene, axes: Sequence[Axis]) -> None:
    """Write the axes, and every other numeric input of the base scene."""
    group, _, _ = _group(layout, "inputs", axes)
    for path, variable, value in numeric_inputs(scene):
        name = variable_name(path)
        if name not in group:
            about = number_attributes(variable) | {"path": path}
            layout.variable(group, name, np.array(value), (), about)


def _write_figures(layout: Layout, name: str, axes: Sequence[Axis], table: Table) -> None:
    group, dimensions, shape = _group(layout, name, axes)
    if name == "performance":
        about = flag_attributes(STATUSES, "how the case ended", NOT_COMPUTED)
        layout.variable(group, "status", table.status.reshape(shape), dimensions, about)
    for figure in GROUPS[name]:
        about = number_attributes(figure_variable(name, figure))
        layout.variable(group, figure, table.column(name, figure).reshape(shape), dimensions, about)
    for text, long_name in {"performance": _CASE_TEXTS, "numerics": NUMERICS_TEXT}.get(name, {}).items():
        layout.texts(group, text, table.texts[text].reshape(shape), dimensions, long_name)


def _write_cycle(layout: Layout, axes: Sequence[Axis], table: Table) -> None:
    """Write the traces one after the other: only one is in memory when `table.traces` reads from disk."""
    group, dimensions, shape = _group(layout, "cycle", axes)
    angle: Variable = CYCLE["angle"]
    layout.coordinate(group, "angle", table.angle, {"units": angle.units, "long_name": angle.long_name})
    for name in table.traces:
        values = table.traces[name].reshape(*shape, table.angle.size)
        layout.variable(group, name, values, (*dimensions, "angle"), number_attributes(cycle_variable(name)))


def _write_ledger(layout: Layout, axes: Sequence[Axis], table: Table) -> None:
    group, dimensions, shape = _group(layout, "ledger", axes)
    for name, values in table.ledger.items():
        layout.variable(group, name, values.reshape(shape), dimensions, number_attributes(ledger_variable(name)))
