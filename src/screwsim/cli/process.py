"""The process of a command: its streams, Ctrl-C, and no work for memory that lives as long as it does.

What the compiler and CoolProp bring are a million objects that stay. Python would look through them for garbage while
it imports them, and take them apart one by one at the end, which takes longer than many a solution.

A reader that has seen enough (`| head -1`), and a stream that was closed from the start (`2>&-`), are no errors: what
is written to them goes nowhere, and the command ends as it would have.
"""

import atexit
import contextlib
import gc
import io
import os
import signal
import sys
import threading
import time
from typing import Any, NoReturn, TextIO

YOUNG = 200_000  # objects made between two searches for garbage; Python's own number is 700
INTERRUPTED = 130
HELD = 0.5  # [s] within which a second Ctrl-C is the first one: a key held down, or a signal sent twice
STDOUT, STDERR = "standard output", "standard error"

_asked: float | None = None  # when Ctrl-C was pressed first
_ending = False


# ---- streams -------------------------------------------------------------------------------------------------


class _Stream(io.FileIO):
    """A standard stream that nobody has to read; an error of writing to it says that it is this one."""

    def __init__(self, number: int, label: str) -> None:
        super().__init__(number, "wb", closefd=False)
        self._label = label

    def write(self, data: Any) -> int:
        """Write what the system takes; from when on nobody reads, or there is no room, all of it goes nowhere."""
        try:
            return super().write(data) or 0
        except BrokenPipeError:
            self._give_up()
            return super().write(data) or 0
        except OSError as error:  # told once
            self._give_up()
            error.filename = self._label
            raise

    def _give_up(self) -> None:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        os.close(nowhere)


def _stream(old: TextIO | None, number: int, label: str) -> TextIO:
    """Return what stands in for a standard stream that is no terminal; letters that it has not are written out."""
    if isinstance(old, io.TextIOWrapper) and old.errors in ("strict", "surrogateescape"):
        old.reconfigure(errors="backslashreplace")
    if old is not None and old.isatty():
        return old
    if old is not None:
        old.flush()
    shape: dict[str, Any] = {"encoding": "utf-8", "errors": "backslashreplace"}
    if isinstance(old, io.TextIOWrapper):
        shape = {"encoding": old.encoding, "errors": old.errors}
        shape |= {"line_buffering": old.line_buffering, "write_through": old.write_through}
    return io.TextIOWrapper(io.BufferedWriter(_Stream(number, label)), **shape)


# ---- Ctrl-C --------------------------------------------------------------------------------------------------


def interrupted() -> bool:
    """Tell whether Ctrl-C was pressed, whatever became of its exception."""
    return _asked is not None


def _interrupt(number: int, frame: Any) -> None:
    """Raise KeyboardInterrupt once; to insist is to end at once, as a kill does, which no file minds."""
    global _asked
    now = time.monotonic()
    if _asked is None and not _ending:
        _asked = now
        raise KeyboardInterrupt
    if _ending or now - (_asked or now) > HELD:
        _leave()


def _leave() -> NoReturn:
    """End at once; what was registered for the end is done."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with contextlib.suppress(OSError):
        if not _ending:
            os.write(2, b"\ninterrupted\n" if os.isatty(2) else b"interrupted\n")
    with contextlib.suppress(BaseException):
        atexit._run_exitfuncs()
    os._exit(INTERRUPTED)


def _not_shown(what: Any, shown: Any = sys.unraisablehook) -> None:
    """Show what cannot be raised; but not that of an interruption, which is not lost (`interrupted`)."""
    if not interrupted():
        shown(what)


# ---- beginning and end ---------------------------------------------------------------------------------------


def begin() -> None:
    """Search for cyclic garbage seldom, mind no stream that nobody reads, end by Ctrl-C in one line, from now on."""
    gc.set_threshold(YOUNG, *gc.get_threshold()[1:])
    # streams that are closed get a place that takes all: the next file would be taken for them
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # it gets the lowest free number
    sys.stdout, sys.stderr = _stream(sys.stdout, 1, STDOUT), _stream(sys.stderr, 2, STDERR)
    if callable(signal.getsignal(signal.SIGINT)):  # a shell's job in the background ignores it
        signal.signal(signal.SIGINT, _interrupt)
    sys.unraisablehook = _not_shown


def end(code: int) -> NoReturn:
    """End the process with an exit code: what was registered for the end is done, what was written is flushed.

    With other threads about, output that cannot be written, or SCREWSIM_DEBUG=1 (a profiler waits for the end)
    Python ends it.
    """
    global _ending
    _ending = True  # from now on Ctrl-C raises nothing
    if threading.active_count() > 1 or os.environ.get("SCREWSIM_DEBUG") == "1":
        sys.exit(code)
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except (OSError, ValueError, AttributeError):
        sys.exit(code)
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
