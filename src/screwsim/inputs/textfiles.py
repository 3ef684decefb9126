"""Reads files that a user names as a whole: regular files only, and none above a size limit.

A pipe or a device may never end, and opening one may block for ever, so the type of the file is checked first.
"""

import os
import stat
from collections.abc import Callable
from functools import lru_cache, wraps
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

PACKAGE, CONFIGS = Path(__file__).resolve().parents[1], "configs"

MOST_YAML = 4_000_000  # [byte] largest scene, fit or file of stages: some tens of thousands of lines
MOST_TABLE = 16_000_000  # [byte] largest table
_MEGA = 1_000_000
HDF5 = b"\x89HDF"  # first bytes of a file of results
_KEPT = 32  # files of one kind that are remembered

More = ParamSpec("More")
Found = TypeVar("Found")


class Unreadable(Exception):
    """Say why a file cannot be read, in words that follow its name, and where in it.

    `hdf5`: it is a file of results.
    """

    def __init__(self, reason: str, line: int = 1, column: int = 1, hdf5: bool = False) -> None:
        super().__init__(reason)
        self.line, self.column, self.hdf5 = line, column, hdf5


def shipped_root() -> Path:
    """Return the folder of the shipped scenes and validation sources: inside the package, or its checkout."""
    inside = PACKAGE / "shipped"
    return PACKAGE.parents[1] if PACKAGE.parent.name == "src" and not inside.is_dir() else inside


def shipped_name(name: str | os.PathLike[str]) -> str:
    """Return a file's name; where no such file exists and it begins with configs/, the path of the shipped file."""
    text = os.fspath(name)
    if not text.startswith(f"{CONFIGS}/") or os.path.lexists(text):
        return text
    found = shipped_root() / text
    return str(found) if found.is_file() and ".." not in found.parts else text


def stamp(path: str | os.PathLike[str]) -> tuple[int, ...]:
    """Return numbers that change with a file, without reading it; () where it cannot be inspected."""
    try:
        found = os.stat(path)
    except (OSError, ValueError):
        return ()
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


def once_per_file(read: Callable[Concatenate[str, More], Found]) -> Callable[Concatenate[str, More], Found]:
    """Let a function of a file, and of more that can be hashed, read it again only when its `stamp` has changed.

    Many callers share what it returns, which must not be changed; what it raises is not remembered.
    """

    @lru_cache(maxsize=_KEPT)
    def remembered(path: str, _stamp: tuple[int, ...], *more: More.args, **named: More.kwargs) -> Found:
        return read(path, *more, **named)

    @wraps(read)
    def reader(path: str, *more: More.args, **named: More.kwargs) -> Found:
        return remembered(path, stamp(path), *more, **named)

    return reader


def read_bytes(path: str | os.PathLike[str], most: int) -> bytes:
    """Return the content of a regular file of at most `most` bytes; raise Unreadable."""
    try:
        _check_regular(os.stat(path))
        # non-blocking: the file may have been replaced by a pipe since
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with os.fdopen(handle, "rb") as stream:
            _check_regular(os.fstat(stream.fileno()))
            found = stream.read(most + 1)  # the file's stated size may change, or be zero
    except OSError as error:
        raise Unreadable(error.strerror or str(error)) from None
    except ValueError:
        raise Unreadable("its name has a null character") from None
    if len(found) > most:
        raise Unreadable(f"it is larger than {most // _MEGA} MB")
    return found


def read_text(path: str | os.PathLike[str], most: int = MOST_TABLE) -> str:
    """Return the text of a regular file in UTF-8, with or without a byte-order mark, line ends as \\n.

    Raise Unreadable.
    """
    content = read_bytes(path, most)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8", "replace")
        line, column = before.count("\n") + 1, len(before.rpartition("\n")[2]) + 1
        raise Unreadable("it is not UTF-8 text", line, column, content.startswith(HDF5)) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def irregular_kind(path: str | os.PathLike[str]) -> str:
    """Return in words what is at a path if that is not a regular file; empty if it is one, or nothing is there."""
    try:
        _check_regular(os.stat(path))
    except Unreadable as reason:
        return str(reason).removeprefix("it is ")
    except (OSError, ValueError):
        return ""
    return ""


def _check_regular(found: os.stat_result) -> None:
    if stat.S_ISDIR(found.st_mode):
        raise Unreadable("it is a folder")
    if not stat.S_ISREG(found.st_mode):
        raise Unreadable("it is a pipe or a device, not a file")
