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
import threading
from types import ModuleType

from screwsim.numerics.store import cache_folder, write_atomically

_loaded: dict[str, ModuleType] = {}
_alone = threading.Lock()  # two modules of one text would be compiled twice


def module_name(text: str, of: str) -> str:
    """Return the module's name: a hash of its text, the compiler's and Python's versions, and the processor."""
    versions = [importlib.metadata.version(name) for name in ("numba", "llvmlite", "numpy")]
    key = "\n".join([text, *versions, platform.python_version(), platform.machine()])
    return f"screwsim_{of}_{hashlib.sha256(key.encode()).hexdigest()[:24]}"


def load(text: str, of: str) -> ModuleType:
    """Return the module of a text, written to the cache folder if it is not there; `of` begins its name."""
    name = module_name(text, of)
    with _alone:
        if name not in _loaded:
            _loaded[name] = _load(name, text)
        return _loaded[name]


def _load(name: str, text: str) -> ModuleType:
    path = cache_folder() / f"{name}.py"
    if not path.exists() or path.read_text() != text:
        write_atomically(path, text.encode())
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
