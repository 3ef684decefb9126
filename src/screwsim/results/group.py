"""A group of a results file: its variables by name, each read on demand, with their meanings."""

from collections.abc import ItemsView, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import KNOCK_OUT_STATUSES, STATUSES, Variable
from screwsim.results import stored
from screwsim.results.netcdf import SEPARATOR
from screwsim.results.stored import REMEDY, MalformedFile, opened

_LONG_TEXTS = 1 << 24  # characters; beyond this texts are objects, since numpy pads every text to the longest
# the coordinate that a group has of its own
OWN = {"cycle": "angle", "knock_out": "effect", "contributions": "contributor", "derivatives": "number"}


class NoVariable(UsageError, KeyError):
    """Error for a variable that a file does not have."""

    def __str__(self) -> str:
        return str(self.args[0])


class Group(Mapping[str, np.ndarray]):
    """Variables of one group by name, arrays on the axes of the sweep; each is read once, on demand.

    Where the group has a coordinate of its own (`OWN`), a pair selects one label: `["shaft_power", "operation.speed"]`.
    Texts are str, numbers as stored: NaN is a missing value, `status` an index into `outputs.STATUSES`.
    """

    def __init__(
        self, path: Path, name: str, about: Mapping[str, Variable], scales: Mapping[str, str], stage: str = ""
    ) -> None:
        self.name = name
        self._stage = stage  # of two: the group within which this one lies
        self.about = about  # unit and meaning of each variable
        self.scales = scales  # of errors: the scale to which each is relative, as text
        self._path = path
        self._read: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str | tuple[str, str]) -> np.ndarray:
        if isinstance(name, tuple):
            return self._labelled(*name)
        if name not in self.about:
            has = ", ".join(self.about) or "nothing"
            raise NoVariable(f"{self._path}: {self.name} has no {name!r}; it has {has} ({REMEDY})")
        self.take((name,))
        return self._read[name]

    def take(self, names: Iterable[str]) -> None:
        """Read several variables with the file opened once, as opening takes as long as reading one variable."""
        missing = [name for name in names if name not in self._read]
        if missing:
            with opened(self._path) as file:
                group = self._of(file)
                self._read |= {name: values_of(group, name) for name in missing}

    def _of(self, file: Any) -> Any:
        """Return the group in an open file."""
        return stored.member(stored.stage_of(file, self._stage), self.name, dataset=False)

    def __contains__(self, name: object) -> bool:
        return name in self.about or (isinstance(name, tuple) and super().__contains__(name))

    def items(self) -> ItemsView[str, np.ndarray]:
        """Return names and values, all read at once."""
        self.take(self.about)
        return super().items()

    def _labelled(self, name: str, label: str) -> np.ndarray:
        """Return a variable at one label of the group's own coordinate, such as an input or a number."""
        own = OWN.get(self.name)
        labels = [] if own is None or own not in self.about else [str(each) for each in self[own]]
        if label not in labels:
            has = ", ".join(labels) or "no labels"
            raise NoVariable(f"{self._path}: {self.name} has no {label!r}; it has {has} ({REMEDY})")
        return self[name][..., labels.index(label)]

    def texts_at(self, name: str, cases: np.ndarray) -> list[str]:
        """Return a variable's texts for given case numbers (last axis fastest), without building those of all cases."""
        words, numbers = self.texts(name)
        return [words[number] for number in numbers[cases]]

    def texts(self, name: str) -> tuple[list[str], np.ndarray]:
        """Return the distinct texts of a variable, and the index of each case's text (cases,), last axis fastest."""
        with opened(self._path) as file:
            group = self._of(file)
            if not stored.has(group, f"{name}_text"):
                return [str(values_of(group, name))], np.zeros(1, np.int32)
            words = _words(group, name)
            return words, _in_range(stored.member(group, name), len(words)).ravel()

    def __iter__(self) -> Iterator[str]:
        return iter(self.about)

    def __len__(self) -> int:
        return len(self.about)

    def part(self, name: str, index: tuple[slice, ...]) -> np.ndarray:
        """Return a slice of a numeric variable, read from the file at once and not cached."""
        with opened(self._path) as file:
            return stored.values(stored.member(self._of(file), name), index)


def values_of(group: Any, name: str) -> np.ndarray:
    """Return a variable; texts as str, also those that are stored as indices into `<name>_text`."""
    data = stored.member(group, name)
    if stored.is_scale(data) and stored.has_attribute(data, "labels"):
        return labels_of(data)
    if stored.has(group, f"{name}_text"):
        words = _words(group, name)
        values = _in_range(data, len(words))
        large = values.size * max(map(len, words)) > _LONG_TEXTS
        return np.array(words, object if large else np.str_)[values]
    if name == "status":
        first, words = (0, KNOCK_OUT_STATUSES) if group.name.endswith("/knock_out") else (-1, STATUSES)
        return _in_range(data, len(words), first)
    return stored.values(data) if stored.is_numbers(data) else np.array(stored.characters(data))


def _in_range(data: Any, count: int, first: int = 0) -> np.ndarray:
    """Return a variable of indices of words; raise MalformedFile if any is outside `first` (0 or -1) to `count` - 1."""
    values = stored.values(data)
    if values.dtype.kind not in "iu" or (values.size and not first <= values.min() <= values.max() < count):
        raise MalformedFile(f"is damaged: {data.name} refers to texts that are missing")
    return values


def labels_of(data: Any) -> np.ndarray:
    """Return the words of a coordinate that stores their indices."""
    labels = np.array(stored.text_attribute(data, "labels").split("\n"))
    return labels[_in_range(data, len(labels))]


def _words(group: Any, name: str) -> list[str]:
    return stored.characters(stored.member(group, f"{name}_text")).split(SEPARATOR)
