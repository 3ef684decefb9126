"""Atomic files, complete or absent: written under a temporary name, forced to disk, then renamed."""

import atexit
import csv
import os
import stat
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.inputs.textfiles import irregular_kind

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"  # first bytes of an HDF5 file
FOREIGN_FILE = "{}: already exists, and is not a file of this kind (choose another -o, or remove it)"


def _sync(path: Path) -> None:
    """Force a file, or the entries of a folder, to disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _sync_folder(folder: Path) -> None:
    if os.name == "posix":  # elsewhere a folder cannot be opened
        _sync(folder)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path in the same folder; move the file there to `path` if the block succeeds.

    A symbolic link stays, and its target is replaced. On any failure the temporary file is removed and the old file
    stays. Raise UsageError, in one line, when the system refuses.
    """
    check_target_kind(path)
    path = link_target(path)
    temporary = temporary_name(path)
    try:
        with refused(path):
            yield temporary
            put_file(temporary, path)
    finally:
        remove(temporary)


def write_text(path: Path, text: str) -> str:
    """Write a text atomically and return its path; raise UsageError as `replacing` does."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return str(path)


def write_csv(path: Path, names: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Write a header line of names and the rows below it as CSV, atomically; return its path."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(names)
        writer.writerows(rows)
    return str(path)


def link_target(path: Path) -> Path:
    """Return the final target of a symbolic link, whether it exists or not; for anything else the path itself."""
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def temporary_name(path: Path, folder: Path | None = None) -> Path:
    """Return the temporary name of a file being written: in `folder`, on the same disk (default: that of `path`)."""
    return (folder or path.parent) / f".{path.name}.{os.getpid()}.tmp"


def put_file(temporary: Path, path: Path) -> None:
    """Move a complete file to `path` and force it to disk; raise OSError when the system refuses."""
    _sync(temporary)
    os.replace(temporary, path)
    _sync_folder(path.parent)


Stamp = tuple[int, ...] | None


def stamp_of(path: Path) -> Stamp:
    """Return a value that changes when `path` is replaced or rewritten; None where there is no file."""
    try:
        found = os.lstat(path)
    except OSError:
        return None
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns


def put_new_file(temporary: Path, path: Path, before: Stamp) -> None:
    """Move a complete file to `path`; raise FileExistsError, and keep the file there, if it is not that of `before`."""
    _sync(temporary)
    if before is None:
        _put_new(temporary, path)
    elif stamp_of(path) in (None, before):
        os.replace(temporary, path)
    else:
        raise FileExistsError(path)
    _sync_folder(path.parent)


def _put_new(temporary: Path, path: Path) -> None:
    try:
        os.link(temporary, path)  # never replaces another file
    except FileExistsError:
        raise
    except OSError:  # a disk without hard links
        if stamp_of(path) is not None:
            raise FileExistsError(path) from None
        os.replace(temporary, path)
    else:
        os.unlink(temporary)


@contextmanager
def refused(path: Path) -> Iterator[None]:
    """Raise UsageError, in one line, when the system refuses to write to `path`."""
    try:
        yield
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error).splitlines()[0]
        remedy = "make room or change permissions there, or choose another place with -o"
        raise UsageError(f"{path}: cannot be written: {reason} ({remedy})") from error


def make_folder(folder: Path) -> None:
    """Make a folder and those above it; raise UsageError, in one line, when the system refuses.

    Those that are still empty when the process ends, as after Ctrl-C, are removed again.
    """
    with refused(folder):
        whole = Path(os.path.abspath(folder))
        file = next((each for each in (whole, *whole.parents) if each.is_file()), None)
        if file is not None:
            what = f"{file} is a file, not a folder"
            raise UsageError(f"{folder}: cannot be written: {what} (choose another place with -o)")
        missing = [each for each in (whole, *whole.parents) if not os.path.lexists(each)]
        folder.mkdir(parents=True, exist_ok=True)
        if missing:
            atexit.register(_remove_empty, missing, os.getpid())


def check_writable(path: Path) -> None:
    """Raise UsageError, in one line, where the system refuses to write a file there: before the work, not after it.

    The folders above it are made, and an empty file beside it, which is removed at once.
    """
    path = link_target(path)
    make_folder(path.parent)
    with refused(path):
        _try_file(temporary_name(path))


def check_writable_folder(folder: Path) -> None:
    """Raise UsageError, in one line, where the system refuses to make a folder, or to write files into it."""
    make_folder(folder)
    with refused(folder):
        _try_file(temporary_name(folder / "trial"))


def _try_file(trial: Path) -> None:
    try:
        trial.touch()
    finally:
        remove(trial)


def _remove_empty(folders: Sequence[Path], process: int) -> None:
    """Remove those of the folders that are empty, innermost first; a process forked from that one leaves them."""
    if os.getpid() == process:
        with suppress(OSError):  # not empty, already removed, or no longer ours
            for folder in folders:
                folder.rmdir()


def remove(path: Path) -> None:
    """Remove a file if it exists and the system allows it."""
    with suppress(OSError):  # the folder itself is gone or not writable: that error is already being raised
        path.unlink(missing_ok=True)


def check_target_kind(path: Path) -> None:
    """Raise UsageError where `path` is a folder, a pipe or a device, which would be replaced or block."""
    what = irregular_kind(path)
    if what:
        raise UsageError(f"{path}: is {what} (choose another -o)")


def has_content(path: Path) -> bool:
    """Tell whether `path` exists and is not an empty file, such as programs create in advance."""
    try:
        found = path.stat()
    except OSError:
        return False
    return found.st_size > 0 or not stat.S_ISREG(found.st_mode)


def protect_others(path: Path, *begins: bytes) -> None:
    """Raise UsageError where a non-empty file at `path` begins with none of `begins`, and so is of another kind."""
    check_target_kind(path)
    try:
        with path.open("rb") as stream:
            found = stream.read(max(map(len, begins)))
    except OSError:  # missing, or not readable: if it cannot be replaced either, that is reported then
        return
    if found and not any(found.lower().startswith(each.lower()) for each in begins):
        raise UsageError(FOREIGN_FILE.format(path))
