"""The netCDF-4 layout in HDF5: dimensions as dimension scales, texts as characters.

Source: Unidata, "NetCDF-4 Format" (appendix C of the netCDF user's guide). Octave reads no strings of variable
length, so there are none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from screwsim.outputs import Variable
from screwsim.outputs.display import cf_unit

_COMPRESS_FROM = 4096  # [byte] below this a chunk's index costs more than compression saves
_CHUNK = 262144  # [byte]
_ITEM = 8  # [byte] same size for all types, so that the chunks of all variables cover the same cases
# name prescribed by the format for such a scale
_BARE_DIMENSION = "This is a netCDF dimension but not a netCDF variable.{:10d}"
SEPARATOR = "\n\n"  # separates the texts of a sweep
_TEXT_LIMIT = 2000  # [byte]


def set_attributes(target: Any, attributes: Mapping[str, Any]) -> None:
    """Write new attributes; texts get a fixed length and UTF-8.

    This calls HDF5 directly: a file has hundreds of attributes, and h5py's checks take longer than the writing.
    """
    from h5py import h5a  # pyrefly: ignore[missing-module-attribute] - compiled, without types

    for name, value in attributes.items():
        if isinstance(value, str):
            data = np.array(value.encode() or b"\0")  # HDF5 allows no length of zero
            kind = _text_type(data.itemsize)
        else:
            data = np.asarray(np.int32(value) if isinstance(value, int) else value)
            kind = _number_type(data.dtype.str)
        attribute = h5a.create(target.id, name.encode(), kind, _space(data.shape))
        attribute.write(data, mtype=kind)


@cache
def _text_type(length: int) -> Any:
    import h5py

    return h5py.h5t.py_create(h5py.string_dtype("utf-8", length), logical=True)


@cache
def _number_type(name: str) -> Any:
    from h5py import h5t

    return h5t.py_create(np.dtype(name), logical=True)


@cache
def _space(shape: tuple[int, ...]) -> Any:
    from h5py import h5s

    return h5s.create_simple(shape)


class FileVariable(NamedTuple):
    """A variable as HDF5's own identifier, since an h5py dataset takes as long to create as HDF5's."""

    id: Any

    def write(self, values: Any) -> None:
        """Write all values."""
        found = np.asarray(values)
        whole = _space(found.shape)
        self.id.write(whole, whole, np.ascontiguousarray(found))


class Layout:
    """Writes groups, dimensions and variables into an open HDF5 file, and counts the file's dimensions."""

    def __init__(self, file: Any, ids: Iterator[int] | None = None) -> None:
        self.file = file
        self._ids = count() if ids is None else ids
        self._scales: dict[tuple[int, str], Any] = {}  # by group and name
        self._kinds: dict[tuple[Any, ...], tuple[Any, Any, Any]] = {}  # type, space and storage of similar variables

    def group(self, name: str) -> Any:
        """Create a group that remembers the order of its members, as netCDF-4 does."""
        return self.file.create_group(name, track_order=True)

    def within(self, name: str) -> Layout:
        """Create a group, and return the layout of groups within it, whose dimensions count on."""
        return Layout(self.group(name), self._ids)

    def coordinate(self, group: Any, name: str, values: np.ndarray, about: Mapping[str, Any]) -> None:
        """Create a dimension with its coordinate variable."""
        data = group.create_dataset(name, data=values, **_storage(values.shape))
        set_attributes(data, about)
        self._scale(group, data, name)

    def labelled(self, group: Any, name: str, labels: Sequence[str], long_name: str) -> None:
        """Create a dimension whose coordinate numbers the labels, which are listed in its attribute `labels`."""
        about = flag_attributes(labels, long_name) | {"labels": "\n".join(labels)}
        self.coordinate(group, name, np.arange(len(labels), dtype=flag_type(len(labels))), about)

    def dimension(self, group: Any, name: str, size: int) -> None:
        """Create a dimension without values, unless the group has it already."""
        if name not in group:
            self._scale(group, group.create_dataset(name, (size,), ">f4"), name, _BARE_DIMENSION.format(size))

    def _scale(self, group: Any, data: Any, name: str, shown: str | None = None) -> None:
        data.make_scale(shown or name)
        set_attributes(data, {"_Netcdf4Dimid": next(self._ids)})
        self._scales[group.id.id, name] = data.id

    def variable(
        self, group: Any, name: str, values: np.ndarray, dimensions: Sequence[str], about: Mapping[str, Any]
    ) -> None:
        """Create a variable over existing dimensions of the group; `_FillValue` of `about` must have its type."""
        self.empty(group, name, values.shape, values.dtype, dimensions, about).write(values)

    def empty(
        self, group: Any, name: str, shape: tuple[int, ...], dtype: Any, dimensions: Sequence[str], about: Mapping
    ) -> FileVariable:
        """Create a variable whose values are written later, and return it."""
        from h5py import h5ds  # pyrefly: ignore[missing-module-attribute]

        data = self._made(group, name, shape, np.dtype(dtype), about.get("_FillValue"))
        set_attributes(data, about)
        for index, dimension in enumerate(dimensions):
            h5ds.attach_scale(data.id, self._scales[group.id.id, dimension], index)
        return data

    def _made(self, group: Any, name: str, shape: tuple[int, ...], dtype: np.dtype, fill: Any) -> FileVariable:
        """Create a dataset with the properties of the first one of its kind, which h5py creates."""
        from h5py import h5d  # pyrefly: ignore[missing-module-attribute]

        kind = shape, dtype.str, None if fill is None else fill.tobytes()
        if kind in self._kinds:
            return FileVariable(h5d.create(group.id, name.encode(), *self._kinds[kind]))
        data = group.create_dataset(name, shape, dtype, fillvalue=fill, **_storage(shape))
        self._kinds[kind] = data.id.get_type(), data.id.get_space(), data.id.get_create_plist()
        return FileVariable(data.id)

    def texts(
        self, group: Any, name: str, words: Sequence[str], shape: tuple[int, ...], dimensions: Sequence[str], about: str
    ) -> Any:
        """Create a variable of texts; `words` are the distinct ones.

        A single text is stored as its characters, an array as indices into `<name>_text`, which is returned to be
        written later. Octave, netCDF 4.9 and xarray all read only single characters along one dimension: Octave stops
        at two, and the netCDF library crashes on longer strings.
        """
        if not dimensions:
            return self.characters(group, name, words[0], about)
        self.characters(group, f"{name}_text", SEPARATOR.join(words), f"{about} (texts, a blank line between)")
        numbers = {"units": "1", "long_name": f"{about} (number of the text, from 0, in {name}_text)"}
        return self.empty(group, name, shape, np.int32, dimensions, numbers)

    def characters(self, group: Any, name: str, text: str, long_name: str) -> None:
        """Create a variable that holds one text."""
        characters = np.frombuffer(text.encode() or b"\0", "S1")
        length = f"string{characters.size}"
        self.dimension(group, length, characters.size)
        about = {"units": "1", "long_name": long_name, "_Encoding": "utf-8"}
        self.variable(group, name, characters, (length,), about)


class Selection:
    """A block of values in variables of one shape, from the index `first` on; later dimensions are taken completely."""

    def __init__(self, shape: tuple[int, ...], first: tuple[int, ...], block: tuple[int, ...]) -> None:
        from h5py import h5s

        size = (*block, *shape[len(block) :])
        self._memory, self._file = h5s.create_simple(size), h5s.create_simple(shape)
        if shape:
            self._file.select_hyperslab((*first, *(0 for _ in shape[len(block) :])), size)

    def write(self, data: Any, values: np.ndarray) -> None:
        """Write the values of the block into a variable, in C order."""
        data.id.write(self._memory, self._file, np.ascontiguousarray(values))


def number_attributes(variable: Variable) -> dict[str, Any]:
    """Return the attributes of a numeric variable, its unit in CF style; NaN marks missing values."""
    return {"units": cf_unit(variable.units), "long_name": variable.long_name, "_FillValue": np.float64(np.nan)}


def flag_type(count: int) -> type[np.signedinteger[Any]]:
    """Return the type for numbering so many words: int8 as long as it suffices."""
    return np.int8 if count <= 128 else np.int32


def flag_attributes(words: Sequence[str], long_name: str, fill: int | None = None) -> dict[str, Any]:
    """Return the attributes of a variable of `flag_type` whose values 0, 1, … stand for words (CF, section 3.5)."""
    about: dict[str, Any] = {
        "units": "1",
        "long_name": long_name,
        "flag_values": np.arange(len(words), dtype=flag_type(len(words))),
        "flag_meanings": " ".join(word.replace(" ", "_") for word in words),
    }
    return about if fill is None else about | {"_FillValue": np.int8(fill)}


def text_lines(text: str) -> str:
    """Return a text as stored: without empty lines, and cut between characters to the byte limit."""
    raw = text.encode()
    cut = text if len(raw) <= _TEXT_LIMIT else raw[: _TEXT_LIMIT - 3].decode(errors="ignore") + "…"
    return "\n".join(line for line in cut.splitlines() if line.strip())


def chunks_of(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Return the chunk shape of a variable: later dimensions stay whole, so a chunk is a run of consecutive values."""
    chunks = list(shape)
    for index in range(len(chunks)):
        while math.prod(chunks) * _ITEM > _CHUNK and chunks[index] > 1:
            chunks[index] = -(-chunks[index] // 2)
    return tuple(chunks)


def _storage(shape: tuple[int, ...]) -> dict[str, Any]:
    """Return the storage options of an array: small ones are contiguous, others chunked and compressed."""
    if math.prod(shape) * _ITEM < _COMPRESS_FROM:
        return {}
    return {"chunks": chunks_of(shape), "compression": "gzip", "compression_opts": 4, "shuffle": True}
