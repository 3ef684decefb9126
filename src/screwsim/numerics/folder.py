"""The user's own cache folder, which belongs to nobody else and in which nobody else may write.

Loading compiled code means running it. So cached files are only taken from a folder that belongs to the user; where
there is none, a private one takes its place, which is removed when the process that made it ends.
"""

import atexit
import contextlib
import os
import shutil
import stat
import sys
import tempfile
import threading
from pathlib import Path

CHOSEN = "SCREWSIM_CACHE"
PRIVATE = "SCREWSIM_PRIVATE_CACHE"  # the private folder, for the processes that this one starts
NOWHERE = "-"  # value of it where not even a private folder could be made
OTHERS = 0o022  # mode bits: writable by group or world
SHARED = "others may write there"
REMEDY = f"name a folder of your own with {CHOSEN}"

_lock = threading.Lock()
_told: set[str] = set()


def tell(text: str) -> None:
    """Print a line on stderr, if that is possible."""
    with contextlib.suppress(OSError, ValueError):
        if sys.stderr is not None:
            print(f"screwsim: {text}", file=sys.stderr, flush=True)


def cache_folder() -> Path | None:
    """Return the user's cache folder (SCREWSIM_CACHE, else XDG_CACHE_HOME/screwsim), made if missing.

    A folder that cannot be made, or is not the user's alone, is reported in one line; a private temporary one, shared
    with the processes that this one starts and removed at its end, takes its place. None: not even that can be made.
    """
    chosen = os.environ.get(CHOSEN)
    folder = Path(chosen) if chosen else _usual()
    if folder is None:
        return _private(f"no home folder is known, so compiled code is not kept (set HOME, or {REMEDY})")
    flaw = _made(folder) or _flaw(folder)
    if flaw:
        remedy = f"remove it, or {REMEDY}" if flaw == SHARED else REMEDY
        return _private(f"{folder}: {flaw}, so compiled code is not kept ({remedy})")
    if not chosen:
        _close(folder)
    return folder


def _usual() -> Path | None:
    """Return the default path of the folder; None where no home folder is known."""
    caches = os.environ.get("XDG_CACHE_HOME", "")
    if os.path.isabs(caches):  # that convention ignores relative paths
        return Path(caches) / "screwsim"
    try:
        return Path.home() / ".cache" / "screwsim"
    except RuntimeError:
        return None


def _made(folder: Path) -> str:
    """Make a folder for the user alone if it is missing; return why it cannot be made."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except FileExistsError:
        return "is not a folder"
    except (OSError, ValueError) as error:
        return f"cannot be made: {_reason(error)}"
    return ""


def _flaw(folder: Path) -> str:
    """Return why a folder must not be used; empty where it is the user's own."""
    try:
        link, found = folder.lstat(), folder.stat()
    except OSError as error:
        return f"cannot be read: {_reason(error)}"
    if not (is_own(link) and is_own(found)):
        return "belongs to another user"
    if os.name == "posix" and found.st_mode & OTHERS:
        return SHARED
    return "" if os.access(folder, os.W_OK | os.X_OK) else "cannot be written"


def is_own(found: os.stat_result) -> bool:
    """Tell whether a file is this user's; always true where there are no user ids (not POSIX)."""
    user = getattr(os, "geteuid", None)
    return user is None or found.st_uid == user()


def _close(folder: Path) -> None:
    """Make the default folder unreadable for others, which it may not be if it is old."""
    with contextlib.suppress(OSError):
        if os.name == "posix" and stat.S_IMODE(folder.stat().st_mode) != 0o700:
            folder.chmod(0o700)


def _private(why: str) -> Path | None:
    """Return the private temporary folder of this process and its children; print why, when it is made."""
    with _lock:
        known = os.environ.get(PRIVATE, "")
        if known == NOWHERE:
            return None
        if known and not _flaw(Path(known)):
            return Path(known)
        tell(why)
        try:
            made = Path(tempfile.mkdtemp(prefix="screwsim-"))
        except OSError:
            os.environ[PRIVATE] = NOWHERE
            return None
        atexit.register(_discard, made, os.getpid())
        os.environ[PRIVATE] = str(made)
        return made


def _discard(folder: Path, owner: int) -> None:
    if os.getpid() == owner:  # not in a process forked from it
        shutil.rmtree(folder, ignore_errors=True)


def worker_state() -> tuple[str, set[str]]:
    """Return what a worker process needs, however it is started: the private folder, and messages printed so far."""
    cache_folder()
    return os.environ.get(PRIVATE, ""), _told


def adopt_worker_state(known: tuple[str, set[str]]) -> None:
    """Share the private folder of the parent process, and print none of its messages again."""
    folder, told = known
    if folder:
        os.environ[PRIVATE] = folder
    _told.update(told)


def report_unwritable(folder: Path, error: OSError) -> None:
    """Print once that the cache cannot be written, so that compiled code only serves this command."""
    if str(folder) not in _told:
        _told.add(str(folder))
        remedy = f"make room or rights there, or {REMEDY}"
        tell(f"{folder}: cannot be written: {_reason(error)}; what is compiled now is not kept ({remedy})")


def _reason(error: Exception) -> str:
    number = getattr(error, "errno", None)
    return os.strerror(number) if number else " ".join(str(error).split())
