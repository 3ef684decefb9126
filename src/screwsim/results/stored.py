"""Safe access to an HDF5 file of unknown origin: only data inside the file, of plausible sizes.

HDF5 can refer its reader elsewhere: links to other files, values kept in or mapped from other files, filters that are
loaded as programs. Results have none of these, and a file that does is refused before anything is followed.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.inputs.textfiles import irregular_kind

REMEDY = "give a file that `screwsim run` or `screwsim sweep` wrote"
MOST_ATTRIBUTE = 4_000_000  # [byte] the scene is the longest attribute
MOST_TEXTS = 256_000_000  # [byte] of the distinct texts of one variable
_FILTERS = {1, 2, 3}  # deflate, shuffle, checksum: HDF5's own
_LARGEST_COMPRESSION = 1100  # deflate compresses to no less than 1/1032
_SLACK = 4096  # [byte]
_NUMBER_KINDS = "fiu"
_LARGEST = 1e60  # in SI units
_READ_ERRORS = (OSError, RuntimeError, KeyError, ValueError, TypeError, OverflowError, AttributeError)


class MalformedFile(Exception):
    """A deviation of a file from a results file, worded to follow the file's name."""


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open an HDF5 file for reading; raise UsageError, in one line, for a fault of the file or of what is read."""
    file = _open(path)
    try:
        with file:
            yield file
    except MalformedFile as flaw:
        raise UsageError(f"{path}: {flaw} ({REMEDY})") from None
    except OSError as error:
        raise UsageError(f"{path}: is damaged or cut short (write it again, or {REMEDY})") from error
    except MemoryError as error:
        raise UsageError(f"{path}: needs more memory than is available (read part of it with xarray)") from error


def _open(path: Path) -> Any:
    import h5py

    try:
        if not path.exists():
            raise UsageError(f"{path}: there is no such file ({REMEDY})")
        what = irregular_kind(path)
        if what:
            raise UsageError(f"{path}: is {what} ({REMEDY})")
        with path.open("rb"):
            pass
        if not h5py.is_hdf5(path):
            raise UsageError(f"{path}: is not an HDF5 file ({REMEDY})")
        return h5py.File(path, "r")
    except (OSError, RuntimeError, ValueError) as error:  # ValueError: a null character in the name
        refused = isinstance(error, PermissionError)
        why = "cannot be read for lack of permission" if refused else "is damaged or cut short"
        raise UsageError(f"{path}: {why} (write it again, or {REMEDY})") from error


class _malformed_on_error:
    """Raise MalformedFile where HDF5 fails to read something, which it reports by many types of errors.

    The item is named only after a failure: asking HDF5 for a name takes as long as reading an attribute.
    """

    __slots__ = ("_item", "_name")

    def __init__(self, item: Any, name: str = "") -> None:
        self._item, self._name = item, name

    def __enter__(self) -> None: ...

    def __exit__(self, kind: Any, error: BaseException | None, trace: object) -> None:
        if isinstance(error, _READ_ERRORS):
            raise MalformedFile(f"is damaged: {_item_name(self._item, self._name)} cannot be read") from error


def _item_name(item: Any, name: str) -> str:
    """Return the position of an item: `/group/variable`, or an attribute after an @."""
    place = str(item.name)
    return f"{place}{name}" if name.startswith("@") else f"{place.rstrip('/')}/{name}" if name else place


def names(group: Any) -> list[str]:
    """Return the names in a group, in the group's order."""
    with _malformed_on_error(group):
        return [name for name in group if isinstance(name, str)]


def member(group: Any, name: str, dataset: bool = True) -> Any:
    """Return a dataset or group in the group itself; raise MalformedFile if missing, a link or of the wrong type."""
    import h5py
    from h5py import h5d, h5l, h5o  # pyrefly: ignore[missing-module-attribute] - compiled, without types

    with _malformed_on_error(group, name):
        links, known = group.id.links, name.encode()
        try:
            link = links.get_info(known)
        except _READ_ERRORS:
            if links.exists(known):
                raise
            raise MalformedFile(f"is not a complete results file: {_item_name(group, name)} is missing") from None
        if link.type != h5l.TYPE_HARD:
            raise MalformedFile(f"has a link at {_item_name(group, name)}, which may lead to other files")
        lies = h5o.open(group.id, known)
        found = h5py.Dataset(lies, readonly=True) if isinstance(lies, h5d.DatasetID) else group[name]
    if not isinstance(found, h5py.Dataset if dataset else h5py.Group):
        kind = "variable" if dataset else "group"
        raise MalformedFile(f"is not a results file: {_item_name(group, name)} is no {kind}")
    return found


def stage_of(file: Any, stage: str) -> Any:
    """Return the group of one of two stages, the file itself for ''; raise MalformedFile as `member` does."""
    return member(file, stage, dataset=False) if stage else file


def has(group: Any, name: str) -> bool:
    """Tell whether a group has a member of this name, whatever its link leads to."""
    with _malformed_on_error(group, name):
        return bool(group.id.links.exists(name.encode()))


def has_attribute(item: Any, name: str) -> bool:
    """Tell whether a group or dataset has an attribute."""
    from h5py import h5a  # pyrefly: ignore[missing-module-attribute] - compiled, without types

    with _malformed_on_error(item, f"@{name}"):
        return bool(h5a.exists(item.id, name.encode()))


def attribute(item: Any, name: str) -> Any:
    """Return an attribute that is a single text or number; raise MalformedFile for any other, or if it is missing."""
    from h5py import h5a, h5t  # pyrefly: ignore[missing-module-attribute] - compiled, without types

    try:
        found = h5a.open(item.id, name.encode())
    except _READ_ERRORS as error:
        if has_attribute(item, name):
            raise MalformedFile(f"is damaged: {_item_name(item, f'@{name}')} cannot be read") from error
        raise MalformedFile(f"is not a complete results file: {_item_name(item, f'@{name}')} is missing") from None
    with _malformed_on_error(item, f"@{name}"):
        kind, size = found.get_type(), found.get_storage_size()
        text = kind.get_class() == h5t.STRING
        one = kind.get_size() == size  # a file has hundreds of attributes, and asking for the space takes 25 % longer
        if not (one or found.get_space().get_simple_extent_npoints() == 1) or size > MOST_ATTRIBUTE:
            raise MalformedFile(f"is not a results file: {_item_name(item, f'@{name}')} is not one text or number")
        plain = text and one and not kind.is_variable_str() and kind.get_strpad() == h5t.STR_NULLPAD
        value = np.zeros(() if plain else found.shape, f"S{size}" if plain else found.dtype)
        found.read(value, kind if plain else None)  # `item.attrs[name]` would take twice as long
    value = value.item() if value.size == 1 else value
    if text:
        with _malformed_on_error(item, f"@{name}"):
            text = value.decode() if isinstance(value, bytes) else str(value)
            text.encode()
        return text
    if isinstance(value, int | float | np.integer | np.floating):
        return value
    raise MalformedFile(f"is not a results file: {_item_name(item, f'@{name}')} is neither text nor number")


def text_attribute(item: Any, name: str) -> str:
    """Return an attribute that is a text; raise MalformedFile for any other."""
    value = attribute(item, name)
    if not isinstance(value, str):
        raise MalformedFile(f"is not a results file: {item.name}@{name} is not text")
    return value


def attributes(item: Any) -> dict[str, Any]:
    """Return all attributes that are a single text or number; others are not ours."""
    with _malformed_on_error(item, "@"):
        every = [name for name in item.attrs if isinstance(name, str)]
    found = {}
    for name in every:
        try:
            found[name] = attribute(item, name)
        except MalformedFile:
            continue
    return found


def is_scale(data: Any) -> bool:
    """Tell whether a variable is a dimension or its coordinate."""
    with _malformed_on_error(data):
        return bool(data.is_scale)


def scale_of(data: Any) -> Any:
    """Return the coordinate along which a one-dimensional variable lies; raise MalformedFile if there is none."""
    with _malformed_on_error(data):
        if data.ndim != 1 or len(data.dims[0]) != 1:
            raise MalformedFile(f"is not a results file: {data.name} lies along no coordinate")
        return data.dims[0][0]


def shape(data: Any) -> tuple[int, ...]:
    """Return the shape of a variable; raise MalformedFile if it has none."""
    with _malformed_on_error(data):
        found = data.shape
    if found is None:
        raise MalformedFile(f"is not a results file: {data.name} has no values")
    return tuple(int(size) for size in found)


def is_numbers(data: Any) -> bool:
    """Tell whether a variable holds plain numbers; raise MalformedFile if neither these nor single characters."""
    with _malformed_on_error(data):
        kind = data.dtype
    if kind.kind in _NUMBER_KINDS and kind.itemsize <= 8:
        return True
    if kind.kind == "S" and kind.itemsize == 1:
        return False
    raise MalformedFile(f"is not a results file: {data.name} holds neither numbers nor characters")


def values(data: Any, index: Any = ()) -> np.ndarray:
    """Return the values of a variable, or a part of them; raise MalformedFile if they are not in the file itself."""
    is_numbers(data)
    _check_storage(data)
    with _malformed_on_error(data):
        found = np.asarray(data[index])
    if found.dtype.kind == "f" and np.any(np.isfinite(found) & (np.abs(found) > _LARGEST)):
        raise MalformedFile(f"is damaged: {data.name} has values that no result can have")
    return found


def characters(data: Any) -> str:
    """Return the text of a variable of single characters."""
    if is_numbers(data) or len(shape(data)) != 1 or shape(data)[0] > MOST_TEXTS:
        raise MalformedFile(f"is not a results file: {data.name} is not text")
    found = values(data)
    with _malformed_on_error(data):
        return found.tobytes().decode().rstrip("\0")


def _check_storage(data: Any) -> None:
    """Raise MalformedFile unless the file itself has the values, with HDF5's own filters, in plausibly many bytes."""
    import h5py

    with _malformed_on_error(data):
        how = data.id.get_create_plist()
        layout, elsewhere = how.get_layout(), how.get_external_count()
        filters = {how.get_filter(number)[0] for number in range(how.get_nfilters())}
        stored = data.id.get_storage_size()
        size = math.prod(data.shape or ()) * data.dtype.itemsize
        whole = Path(data.file.filename).stat().st_size
    if elsewhere or layout == h5py.h5d.VIRTUAL:
        raise MalformedFile(f"keeps the values of {data.name} in other files, which are not read")
    if filters - _FILTERS:
        raise MalformedFile(f"packs {data.name} in a way that results never use")
    dense = _LARGEST_COMPRESSION if 1 in filters else 1
    if stored > whole + _SLACK or size > dense * stored + (_SLACK if dense > 1 else 0):
        raise MalformedFile(f"is damaged: {data.name} states {size} bytes and has {stored}")
