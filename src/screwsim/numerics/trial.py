"""Try a call in a child process first: what kills a process kills that one, and is told."""

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
DEFINED = ("EFFECT", "MACHINE", "INTEGRATOR", "GAS")  # what a module of the user's own may define


def own_module(name: str) -> ModuleType:
    """Return a module of the user's own, imported and noted; raise ImportError where that ends the process."""
    how = "" if name in sys.modules else how_it_died(lambda: importlib.import_module(name))
    if how:
        raise ImportError(f"a process that imported it died {how}")
    try:
        module = importlib.import_module(name)
    except SystemExit as error:  # would end this program, too, and say nothing
        raise ImportError(f"it ends the program, by SystemExit: {error}") from error
    sources.note(name, next((vars(module)[each] for each in DEFINED if each in vars(module)), None))
    return module


def found_in(registry: Mapping[str, T], name: str, defined: str, *kinds: type) -> T:
    """Return what a registry has under a name, or a module of the user's own, by its dotted name, as `defined`.

    Raise KeyError where there is none, ImportError where a dotted one is not there.
    """
    if "." not in name:
        return registry[name]
    found = getattr(own_module(name), defined, None)
    if not isinstance(found, kinds):
        raise ImportError(f"module {name} defines no {defined}")
    return cast("T", found)


def how_it_died(call: Callable[[], object]) -> str:
    """Return how a child process died over a call; '' where it came to its end, however that was.

    '' as well where no child can be tried: beside other threads, whose locks a fork would copy, or without a fork.
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
    """Call, say that it came to its end, and end; an exception comes again in the parent, which tells it."""
    try:
        _end_with_parent()
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what is printed comes again, too
        call()
    except BaseException:  # noqa: BLE001 - as said
        pass
    finally:
        os.write(writes, _DONE)
        os._exit(0)


def _end_with_parent() -> None:
    """Have this process killed when its parent ends, however that is: what it tries may never end by itself."""
    parent = os.getppid()
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if parent == 1 or os.getppid() != parent:  # it ended before
        os._exit(0)
