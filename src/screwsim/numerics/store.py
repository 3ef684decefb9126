"""Files that survive a crash, and the folder for what can be made again."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def cache_folder() -> Path:
    """Return the user's cache folder of screwsim (SCREWSIM_CACHE, else XDG_CACHE_HOME/screwsim), made if missing.

    Falls back to a folder under the system's temporary one when that cannot be written.
    """
    chosen = os.environ.get("SCREWSIM_CACHE")
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    for folder in (Path(chosen) if chosen else home / "screwsim", Path(tempfile.gettempdir()) / "screwsim"):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    raise OSError("no writable cache folder; set SCREWSIM_CACHE to one")


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file as a whole or not at all: temporary file beside it, flushed to disk, then renamed."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
