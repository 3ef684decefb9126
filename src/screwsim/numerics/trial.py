"""Trial of a call in a child process: if it kills that process, this one survives and reports it."""

import ctypes
import importlib
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import NoReturn, TypeVar, cast

from screwsim.numerics import sources

T = TypeVar("T")
_DONE = b"."
PR_SET_PDEATHSIG = 1  # of Linux's prctl
DEFINED = ("EFFECT", "MACHINE", "INTEGRATOR", "GAS")  # variables that a user's own module may define


def import_own_module(name: str) -> ModuleType:
    """Return a user's own module, imported and recorded; raise ImportError where importing it ends the process."""
    how = "" if name in sys.modules else how_it_died(lambda: importlib.import_module(name))
    if how:
        raise ImportError(f"a process that imported it died {how}")
    try:
        module = importlib.import_module(name)
    except SystemExit as error:  # would end this program silently, too
        raise ImportError(f"it ends the program, by SystemExit: {error}") from error
    sources.record_module(name, next((vars(module)[each] for each in DEFINED if each in vars(module)), None))
    return module


def registry_entry(registry: Mapping[str, T], name: str, defined: str, *kinds: type) -> T:
    """Return the entry of a registry, or for a dotted name the variable `defined` of a user's own module.

    Raise KeyError where there is none, ImportError where a dotted one cannot be imported or defines none.
    """
    if "." not in name:
        return registry[name]
    found = getattr(import_own_module(name), defined, None)
    if not isinstance(found, kinds):
        raise ImportError(f"module {name} defines no {defined}")
    return cast("T", found)


def how_it_died(call: Callable[[], object]) -> str:
    """Return how a child process died during a call; '' where the call ended, normally or by an exception.

    Also '' where no child can be tried: beside other threads, whose locks a fork would copy, or without fork.
    """
    if sys.platform != "linux" or threading.active_count() > 1:
        return ""
    reads, writes = os.pipe()
    with warnings.catch_warnings():
        # Python 3.12 warns when it forks beside any thread; numerical libraries keep idle ones that survive it
        warnings.filterwarnings("ignore", ".*fork", DeprecationWarning)
        child = os.fork()
    if child == 0:
        _be_child(call, writes)
    os.close(writes)
    try:
        done = os.read(reads, 1) == _DONE
        _, status = os.waitpid(child, 0)
    except BaseException:  # Ctrl-C: the child must not go on
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        raise
    finally:
        os.close(reads)
    code = os.waitstatus_to_exitcode(status)
    if done:
        return ""
    return f"by signal {-code} ({signal.Signals(-code).name})" if code < 0 else f"with exit code {code}"


def _be_child(call: Callable[[], object], writes: int) -> NoReturn:
    """Call, report the end to the parent, and exit; an exception occurs again in the parent, which reports it."""
    try:
        _end_with_parent()
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # printed text is printed again by the parent
        call()
    except BaseException:  # noqa: BLE001 - as said
        pass
    finally:
        os.write(writes, _DONE)
        os._exit(0)


def _end_with_parent() -> None:
    """Have this process killed when its parent ends in any way, since the call that it tries may never end."""
    parent = os.getppid()
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if parent == 1 or os.getppid() != parent:  # it ended before
        os._exit(0)
