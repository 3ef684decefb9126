"""The process of a command: its streams, Ctrl-C or SIGTERM, and little effort for memory that lives until the end.

The compiler and CoolProp create a million objects that stay. Python would search them for garbage while importing, and
destroy them one by one at the end, which takes longer than many a solution.

A reader that stops early (`| head -1`), or a stream closed from the start (`2>&-`), is no error: output to it is
discarded, and the command ends as it would otherwise.
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

GARBAGE_THRESHOLD = 200_000  # objects created between two searches for garbage; Python's default is 700
INTERRUPTED = 130
DOUBLE_PRESS = 0.5  # [s] within which a second Ctrl-C counts as the first: a key held down, or a signal sent twice
MOMENT = 0.02  # [s] after which a lost interruption is raised again
STOPS = signal.SIGINT, signal.SIGTERM  # batch systems and containers end a program by the second
STDOUT, STDERR = "standard output", "standard error"

_interrupt_time: float | None = None  # when Ctrl-C was first pressed
_is_ending = False


# ---- streams -------------------------------------------------------------------------------------------------


class _Stream(io.FileIO):
    """A standard stream that need not be read; an error of writing to it names this stream."""

    def __init__(self, number: int, label: str) -> None:
        super().__init__(number, "wb", closefd=False)
        self._label = label

    def write(self, data: Any) -> int:
        """Write what the system accepts; once nobody reads, or there is no room, all output is discarded."""
        try:
            return super().write(data) or 0
        except BrokenPipeError:
            self._give_up()
            return super().write(data) or 0
        except OSError as error:  # reported once
            self._give_up()
            error.filename = self._label
            raise

    def _give_up(self) -> None:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        os.close(nowhere)


def _stream(old: TextIO | None, number: int, label: str) -> TextIO:
    """Return the replacement for a standard stream that is not a terminal; characters it lacks are escaped."""
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
    """Tell whether Ctrl-C was pressed or SIGTERM came, even if its exception was lost."""
    return _interrupt_time is not None


def _interrupt(number: int, frame: Any) -> None:
    """Raise KeyboardInterrupt once; when pressed again, end at once like a kill, which leaves all files intact."""
    global _interrupt_time
    now = time.monotonic()
    if _interrupt_time is None and not _is_ending:
        _interrupt_time = now
        raise KeyboardInterrupt
    if _is_ending or now - (_interrupt_time or now) > DOUBLE_PRESS:
        _exit_at_once()


def _exit_at_once() -> NoReturn:
    """End at once, after running the exit functions."""
    for each in STOPS:
        signal.signal(each, signal.SIG_IGN)
    with contextlib.suppress(OSError):
        if not _is_ending:
            os.write(2, b"\ninterrupted\n" if os.isatty(2) else b"interrupted\n")
    with contextlib.suppress(BaseException):
        atexit._run_exitfuncs()
    os._exit(INTERRUPTED)


def _show_unraisable(what: Any, shown: Any = sys.unraisablehook) -> None:
    """Show an exception that cannot be raised, except for an interruption, which is raised again a moment later."""
    if not interrupted():
        shown(what)
    elif what.exc_type is KeyboardInterrupt and not _is_ending and hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, _raise_again)
        signal.setitimer(signal.ITIMER_REAL, MOMENT)


def _raise_again(number: int, frame: Any) -> None:
    """Raise the KeyboardInterrupt that was lost where nothing can be raised, as while a module is imported."""
    if not _is_ending:
        raise KeyboardInterrupt


def settle() -> None:
    """Raise no lost interruption any more: the command has ended, and what it prints now is printed once."""
    if interrupted() and hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, 0.0)


# ---- beginning and end ---------------------------------------------------------------------------------------


def begin() -> None:
    """Set up the process: rare garbage searches, streams that need no reader, and Ctrl-C that ends in one line."""
    gc.set_threshold(GARBAGE_THRESHOLD, *gc.get_threshold()[1:])
    # closed streams are opened to a null device, as the next file opened would take their numbers
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # opens the lowest free number
    sys.stdout, sys.stderr = _stream(sys.stdout, 1, STDOUT), _stream(sys.stderr, 2, STDERR)
    for each in STOPS:
        if signal.getsignal(each) != signal.SIG_IGN:  # as a background job of a shell does
            signal.signal(each, _interrupt)
    sys.unraisablehook = _show_unraisable


def end(code: int) -> NoReturn:
    """End the process with an exit code, after running the exit functions and flushing the output.

    Python itself ends it if there are other threads or output that cannot be written, or with SCREWSIM_DEBUG=1 (a
    profiler waits for the end).
    """
    global _is_ending
    _is_ending = True  # from now on Ctrl-C raises nothing
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
