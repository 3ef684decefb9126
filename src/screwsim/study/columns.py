"""Results of a study on disk: named columns with units, as a table or HDF5."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.figures import declared
from screwsim.inputs.workbooks import TABLES
from screwsim.outputs import Variable
from screwsim.results.atomic import make_folder, replacing
from screwsim.results.guarded import new_hdf5
from screwsim.results.netcdf import Layout, number_attributes, set_attributes, text_lines
from screwsim.results.protection import protect_other_hdf5, protect_other_heads
from screwsim.results.schema import variable_name
from screwsim.results.tables import write_table
from screwsim.scene.fields import Leaf
from screwsim.scene.grid import unit_of
from screwsim.version import version


class Column(NamedTuple):
    """One column of numbers [units] or texts; None for a missing value."""

    values: Sequence[Any]
    units: str
    long_name: str


def input_column(leaf: Leaf, values: Sequence[Any]) -> Column:
    """Return the column of an input's values [SI], or texts."""
    return Column(values, unit_of(leaf) or "1", leaf.doc)


def figure_column(name: str, values: Sequence[Any]) -> Column:
    """Return the column of a figure's values [SI]."""
    return Column(values, declared(name).units, declared(name).long_name)


def error_column(name: str, values: Sequence[Any]) -> Column:
    """Return the column of a figure's estimated errors [SI]."""
    return Column(values, declared(name).units, "its estimated numerical error, absolute")


def protect_other_columns(path: Path, title: str, *names: str) -> None:
    """Raise UsageError where the file at `path` does not hold such columns, as measured data: it would be lost.

    A table of a study has the columns `names`, an HDF5 file a title that begins with `title`.
    """
    if path.suffix.lower() not in TABLES:
        protect_other_hdf5(path, "title", title)
    else:
        protect_other_heads(path, lambda heads: set(names) <= {head.partition(" [")[0] for head in heads})


def write_columns(path: Path, title: str, columns: Mapping[str, Column]) -> None:
    """Write columns of equal length: a table with the units in its first line, or HDF5 with the layout of netCDF-4."""
    make_folder(path.parent)
    if path.suffix.lower() in TABLES:
        heads = (f"{name} [{each.units}]" if each.units not in ("1", "") else name for name, each in columns.items())
        rows = zip(*(column.values for column in columns.values()), strict=True)
        write_table(path, heads, (["" if value is None else value for value in row] for row in rows))
        return
    with replacing(path) as temporary:
        _write_hdf5(temporary, title, columns)


def _write_hdf5(path: Path, title: str, columns: Mapping[str, Column]) -> None:
    with new_hdf5(path, libver=("v108", "v108"), track_order=True) as file:
        set_attributes(file, {"Conventions": "CF-1.11", "title": title, "source": f"screwsim {version()}"})
        layout = Layout(file)
        layout.dimension(file, "row", len(next(iter(columns.values())).values))
        for name, each in columns.items():
            if any(isinstance(value, str) for value in each.values):
                texts = [text_lines("" if value is None else value) for value in each.values]
                words, numbers = np.unique(texts, return_inverse=True)
                data = layout.texts(file, variable_name(name), list(words), (len(texts),), ("row",), each.long_name)
                data.write(numbers)
                continue
            numbers = np.array([np.nan if value is None else value for value in each.values], float)
            about = number_attributes(Variable(each.units, each.long_name))
            layout.variable(file, variable_name(name), numbers, ("row",), about)
