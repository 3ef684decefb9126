"""Flat modules: written once under a name that is the hash of all their text, compiled on first use, kept.

The compiler's cache does not see edits in other files; here there are none, because everything that a module
runs stands in its own text, and the text names the file.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import importlib.util
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

from screwsim.numerics.store import cache_folder, write_atomically

COMPILED = {  # what each driver is, and about how many seconds its compilation takes
    "one": ("this combination of effects", "ten"),
    "all": ("coupled chambers of this combination", "ten"),
    "ledger": ("the ledger of this combination", "three"),
}
_loaded: dict[str, ModuleType] = {}


def module_name(text: str) -> str:
    """Return the module's name: a hash of its text, the compiler's and Python's versions, and the processor."""
    versions = [importlib.metadata.version(name) for name in ("numba", "llvmlite", "numpy")]
    key = "\n".join([text, *versions, platform.python_version(), platform.machine()])
    return f"screwsim_model_{hashlib.sha256(key.encode()).hexdigest()[:24]}"


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
    yield
    write_atomically(ready, b"")
    print(f"screwsim: compiled in {time.perf_counter() - started:.1f} s", file=sys.stderr, flush=True)


def load(text: str) -> ModuleType:
    """Return the module of a composition's text, written to the cache folder if it is not there."""
    name = module_name(text)
    if name in _loaded:
        return _loaded[name]
    path = cache_folder() / f"{name}.py"
    if not path.exists() or path.read_text() != text:
        write_atomically(path, text.encode())
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    _loaded[name] = module
    return module
