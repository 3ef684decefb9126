"""Compiling a composition: said on stderr the first time, because it takes seconds; silent when done before."""

from __future__ import annotations

import gc
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

from screwsim.numerics import modules
from screwsim.numerics.store import cache_folder, write_atomically

COMPILED = {  # what each driver is, and about how many seconds its compilation takes
    "one": ("this combination of effects", "ten"),
    "all": ("coupled chambers of this combination", "ten"),
    "ledger": ("the ledger of this combination", "three"),
}

alone = threading.RLock()  # held while compiling: another thread that needs the same finds it ready


def module_name(text: str) -> str:
    """Return the name of a composition's module."""
    return modules.module_name(text, "model")


def load(text: str) -> ModuleType:
    """Return the module of a composition's text."""
    return modules.load(text, "model")


def warm(module: ModuleType) -> set[str]:
    """Return the drivers of a module that this process has compiled or loaded, to be added to."""
    return module.__dict__.setdefault("drivers_ready", set())


@contextmanager
def announced(text: str, driver: str) -> Iterator[None]:
    """Say on stderr that a first compilation takes its time, and note when it is done; silent when done before."""
    ready = cache_folder() / f"{module_name(text)}.{driver}.ready"
    if ready.exists():
        yield
        return
    what, long = COMPILED[driver]
    print(f"screwsim: compiling {what}, once (about {long} seconds) ...", file=sys.stderr, flush=True)
    started = time.perf_counter()
    with _not_collecting():
        yield
    write_atomically(ready, b"")
    print(f"screwsim: compiled in {time.perf_counter() - started:.1f} s", file=sys.stderr, flush=True)


@contextmanager
def _not_collecting() -> Iterator[None]:
    """Put off the search for cyclic garbage: the compiler's many objects live on, searched over and over."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()
