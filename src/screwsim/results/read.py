"""Results from HDF5: figures by name, read when asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.faults import UsageError
from screwsim.outputs import STATUSES, Variable
from screwsim.results.netcdf import SEPARATOR
from screwsim.results.schema import SCHEMA, Axis

_LONG_TEXTS = 1 << 24  # letters; more texts than that come as objects, for numpy gives each the room of the longest
_OPTIONAL = ("cycle", "ledger", "knock_out")  # the first two come with traces, the last where it was asked for
_REMEDY = "give a file that `screwsim run` or `screwsim sweep` wrote"


class Group(Mapping[str, np.ndarray]):
    """Variables of one group by name, arrays on the axes of the sweep; each is read once, when it is asked for.

    Texts come as str, numbers as stored: NaN is where there is none, `status` is an index of `outputs.STATUSES`.
    """

    def __init__(self, path: Path, name: str, about: Mapping[str, Variable]) -> None:
        self.name = name
        self.about = about  # unit and meaning of each variable
        self._path = path
        self._read: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.about:
            raise KeyError(f"{self.name} has no {name!r}; it has {', '.join(self.about) or 'nothing'}")
        if name not in self._read:
            with _opened(self._path) as file:
                self._read[name] = _values(file[self.name], name)
        return self._read[name]

    def texts_at(self, name: str, cases: np.ndarray) -> list[str]:
        """Return a text of some cases, by their numbers (last axis fastest), without making those of all."""
        with _opened(self._path) as file:
            group = file[self.name]
            if f"{name}_text" not in group:
                return [str(_values(group, name))] * len(cases)
            words = _words(group, name)
            return [words[number] for number in group[name][()].ravel()[cases]]

    def __iter__(self) -> Iterator[str]:
        return iter(self.about)

    def __len__(self) -> int:
        return len(self.about)

    def part(self, name: str, index: tuple[slice, ...]) -> np.ndarray:
        """Return a part of a variable of numbers, read from the file now and not kept."""
        with _opened(self._path) as file:
            return np.asarray(file[self.name][name][index])


@dataclass(frozen=True)
class Results:
    """A results file: `axes` {dotted path: values [SI] or texts}, and one mapping a group."""

    path: Path
    attributes: Mapping[str, Any]
    axis_list: tuple[Axis, ...]
    inputs: Group
    performance: Group
    balance: Group
    error: Group
    numerics: Group
    cycle: Group  # with `angle`; empty unless the traces were kept
    ledger: Group  # empty unless the traces were kept
    knock_out: Group  # over `effect`; empty unless it was asked for, of one run

    @property
    def scene_yaml(self) -> str:
        """The scene's text, overrides included."""
        return self.attributes["scene_yaml"]

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """Values of each axis by its dotted path, in the order of the dimensions (`varied` has joined paths too)."""
        return {axis.path: axis.values for axis in self.axis_list}

    @property
    def varied(self) -> dict[str, tuple[int, np.ndarray]]:
        """Dimension and values along it of every path that the sweep varies, those that vary together too."""
        found = {}
        for number, axis in enumerate(self.axis_list):
            found |= {inner.path: (number, inner.values) for inner in axis.joined or (axis,)}
        return found

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values on each axis; () for one run."""
        return tuple(len(axis.values) for axis in self.axis_list)

    @cached_property
    def status(self) -> np.ndarray:
        """Status of each case as a word."""
        return np.array([*STATUSES, "not_computed"])[self.performance["status"]]

    @property
    def messages(self) -> np.ndarray:
        """Why each case failed or did not close; empty where it did neither."""
        return self.performance["message"]

    def to_xarray(self, group: str | None = "performance") -> Any:
        """Return one group as an xarray.Dataset; None: all in one, names of other groups with their prefix."""
        from screwsim.results.dataset import dataset

        return dataset(self, group)


def open_results(path: str | Path) -> Results:
    """Return the results in a file; raise UsageError, in one line, when it is not a results file of ours."""
    path = Path(path)
    with _opened(path) as file:
        attributes = _root(path, file)
        try:
            return _results(path, file, attributes)
        except KeyError as error:
            raise UsageError(f"{path}: is not a complete results file: {error.args[0]} ({_REMEDY})") from error


def read_attributes(path: Path) -> dict[str, Any]:
    """Return the attributes of a results file alone; raise UsageError as `open_results`."""
    with _opened(path) as file:
        return _root(path, file)


def count_statuses(path: Path) -> tuple[int, ...]:
    """Return how many cases of a results file ended in each of `outputs.STATUSES`."""
    with _opened(path) as file:
        status = file["performance/status"][()]
    return tuple(int(np.count_nonzero(status == index)) for index in range(len(STATUSES)))


def _results(path: Path, file: Any, attributes: Mapping[str, Any]) -> Results:
    axes = _axes(file["performance"])
    names = tuple(inner.name for axis in axes for inner in (axis, *axis.joined))
    groups = ("inputs", "performance", "balance", "error", "numerics", *_OPTIONAL)
    return Results(path, attributes, axes, *(_group(path, file, name, names) for name in groups))


def _group(path: Path, file: Any, name: str, axes: tuple[str, ...]) -> Group:
    if name in _OPTIONAL and name not in file:
        return Group(path, name, {})
    left_out = axes if name != "inputs" else tuple(each for each in axes if file[name][each].is_scale)
    return Group(path, name, _about_all(file[name], left_out))


def _axes(group: Any) -> tuple[Axis, ...]:
    """Return the axes of a group with what varies along each."""
    coordinates = [data for data in group.values() if "path" in data.attrs]
    joined = [data for data in coordinates if not data.is_scale]
    return tuple(
        _axis(scale)._replace(joined=tuple(_axis(data) for data in joined if data.dims[0][0] == scale))
        for scale in coordinates
        if scale.is_scale
    )


def _about_all(group: Any, axes: tuple[str, ...]) -> dict[str, Variable]:
    """Return unit and meaning of the variables that are no axis, no texts of numbers, no bare dimension."""
    texts = {f"{name}_text" for name in group}
    return {
        name: _about(data)
        for name, data in group.items()
        if name not in axes and name not in texts and "units" in data.attrs
    }


def _about(data: Any) -> Variable:
    return Variable(_text(data.attrs["units"]), _text(data.attrs["long_name"]))


def _axis(data: Any) -> Axis:
    values = _labelled(data) if "labels" in data.attrs else data[()]
    return Axis(_text(data.attrs["path"]), values, *_about(data))


def _values(group: Any, name: str) -> np.ndarray:
    """Return a variable; texts as str, also those that are stored as numbers of a text in `<name>_text`."""
    values = np.asarray(group[name][()])
    if group[name].is_scale and "labels" in group[name].attrs:
        return _labelled(group[name])
    if f"{name}_text" in group:
        words = _words(group, name)
        large = values.size * max(map(len, words)) > _LONG_TEXTS
        return np.array(words, object if large else np.str_)[values]
    return np.array(_string(values)) if values.dtype.kind == "S" else values


def _labelled(data: Any) -> np.ndarray:
    return np.array(_text(data.attrs["labels"]).split("\n"))[data[()]]


def _words(group: Any, name: str) -> list[str]:
    return _string(group[f"{name}_text"][()]).split(SEPARATOR)


def _string(characters: np.ndarray) -> str:
    return characters.tobytes().decode().rstrip("\0")


def _text(value: Any) -> Any:
    return value.decode() if isinstance(value, bytes) else value


def _root(path: Path, file: Any) -> dict[str, Any]:
    """Return the attributes of a file that this version can read."""
    if "screwsim_schema" not in file.attrs:
        raise UsageError(f"{path}: is an HDF5 file of another program ({_REMEDY})")
    attributes = {name: _text(value) for name, value in file.attrs.items()}
    schema = int(attributes["screwsim_schema"])
    if schema > SCHEMA:
        source = attributes.get("source", "a newer screwsim")
        raise UsageError(f"{path}: was written by {source} in schema {schema}, newer than {SCHEMA} (update screwsim)")
    return attributes


def _opened(path: Path) -> Any:
    """Open an HDF5 file to read; raise UsageError with what is wrong with it."""
    import h5py

    if not path.exists():
        raise UsageError(f"{path}: there is no such file ({_REMEDY})")
    if path.is_dir():
        raise UsageError(f"{path}: is a folder ({_REMEDY})")
    try:
        with path.open("rb"):
            pass
        if not h5py.is_hdf5(path):
            raise UsageError(f"{path}: is not an HDF5 file ({_REMEDY})")
        return h5py.File(path, "r")
    except OSError as error:
        why = "may not be read" if isinstance(error, PermissionError) else "is damaged or cut short"
        raise UsageError(f"{path}: {why} (write it again, or {_REMEDY})") from error
