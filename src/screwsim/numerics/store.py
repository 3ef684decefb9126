"""The cache folder's files: each is either intact and written by this user, or treated as absent and made again.

Every file begins with the digest of its name and content, and every line of a file of lines with its own: remains of a
full disk, a crash or a disk error are ignored, and made again.
"""

import contextlib
import hashlib
import os
import stat
import tempfile
from pathlib import Path

from screwsim.numerics.folder import cache_folder, is_own, report_unwritable

DIGEST = 32  # [byte]
OF_A_LINE = 16  # [characters] length of a line's digest


def read(name: str) -> bytes | None:
    """Return the content stored under a name; None where there is nothing intact that this user wrote."""
    held = _bytes_of(name)
    if held is None:
        return None
    if held[:DIGEST] == _digest(name, held[DIGEST:]):
        return held[DIGEST:]
    drop(name)
    return None


def keep(name: str, content: bytes) -> None:
    """Store a content under a name, for this process and others; a failure is reported once, and nothing is stored."""
    _write(name, _digest(name, content) + content)


def keep_text(name: str, text: str) -> None:
    """Store a text as it is, for people to read."""
    content = text.encode()
    if _bytes_of(name) != content:
        _write(name, content)


def drop(name: str) -> None:
    """Remove the content stored under a name."""
    folder = cache_folder()
    if folder is not None:
        with contextlib.suppress(OSError):
            (folder / name).unlink(missing_ok=True)


def _bytes_of(name: str) -> bytes | None:
    """Return all bytes of a regular file in the cache folder that this user wrote; None where there is none."""
    folder = cache_folder()
    if folder is None:
        return None
    try:
        with open(folder / name, "rb", opener=_unlinked) as stream:
            found = os.fstat(stream.fileno())
            return stream.read() if is_own(found) and stat.S_ISREG(found.st_mode) else None
    except OSError:
        return None


def _unlinked(path: str, flags: int) -> int:
    """Open a file without following a symbolic link and without waiting."""
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))


def _digest(name: str, content: bytes) -> bytes:
    return hashlib.sha256(name.encode() + b"\n" + content).digest()


def _write(name: str, content: bytes) -> None:
    folder = cache_folder()
    if folder is None:
        return
    try:
        write_atomically(folder / name, content, durably=False)
    except OSError as error:
        report_unwritable(folder, error)


# ---- files of many lines -------------------------------------------------------------------------------------


def read_lines(name: str, full: int) -> list[str]:
    """Return the lines of a file unchecked, oldest first; a file of `full` bytes or more is removed, to be begun anew.

    Checking each line takes longer than reading them all: `checked_line` does it where a line is used.
    """
    held = _bytes_of(name)
    if held is None:
        return []
    if len(held) >= full:
        drop(name)
    return held.decode(errors="replace").splitlines()


def checked_line(line: str) -> str | None:
    """Return the text that was appended as a line; None for a line that is torn or damaged."""
    digest, _, text = line.partition(" ")
    return text if digest == _digest_of_line(text) else None


def append_line(name: str, line: str, full: int) -> None:
    """Append a whole line to a file of less than `full` bytes; a failure is ignored."""
    folder = cache_folder()
    if folder is None:
        return
    # the leading line break ends a line that another process left torn
    content = f"\n{_digest_of_line(line)} {line}\n".encode()
    with contextlib.suppress(OSError):
        flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0)
        handle = os.open(folder / name, flags, 0o600)
        try:
            if os.fstat(handle).st_size < full:
                os.write(handle, content)
        finally:
            os.close(handle)


def _digest_of_line(line: str) -> str:
    return hashlib.sha256(line.encode(errors="replace")).hexdigest()[:OF_A_LINE]


# ----------------------------------------------------------------------------------------------------------------


def write_atomically(path: Path, content: bytes, durably: bool = True) -> None:
    """Write a file as a whole or not at all: temporary file beside it, flushed to disk (`durably`), then renamed."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            if durably:
                os.fsync(stream.fileno())
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
