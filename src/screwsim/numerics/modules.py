"""Flat modules: written once under a name that is the hash of all their text, compiled on first use, kept.

The compiler's cache does not see edits in other files; here there are none, because everything that a module
runs stands in its own text, and the text names the file.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import linecache
import marshal
import platform
import sys
import threading
from functools import cache
from types import CodeType, ModuleType

from screwsim.numerics import store

_loaded: dict[str, ModuleType] = {}
_alone = threading.Lock()  # two modules of one text would be compiled twice


@cache
def _versions() -> tuple[str, ...]:
    """Return the versions of what compiles and runs a module, and the processor."""
    numba = (importlib.metadata.version(name) for name in ("numba", "llvmlite", "numpy"))
    return (*numba, platform.python_version(), platform.machine())


def module_name(text: str, of: str) -> str:
    """Return the module's name: a hash of its text, the compiler's and Python's versions, and the processor."""
    key = "\n".join([text, *_versions()])
    return f"screwsim_{of}_{hashlib.sha256(key.encode()).hexdigest()[:24]}"


def load(text: str, of: str) -> ModuleType:
    """Return the module of a text; `of` begins its name. What is compiled of it is kept in the cache folder."""
    name = module_name(text, of)
    with _alone:
        if name not in _loaded:
            _loaded[name] = _load(name, text)
        return _loaded[name]


def _load(name: str, text: str) -> ModuleType:
    module = ModuleType(name)
    sys.modules[name] = module
    exec(_code(name, text), vars(module))
    # only now, since a module of this package that imports the compiler takes long to import
    from screwsim.numerics.kept_code import keep_code_of

    keep_code_of(module)
    return module


def _code(name: str, text: str) -> CodeType:
    """Return what Python runs of a text, kept as well: to make it takes a tenth of a second.

    The text lies beside it to be read; nothing is taken from there.
    """
    file = f"<{name}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)  # for tracebacks
    store.keep_text(f"{name}.py", text)
    kept = store.read(f"{name}.parsed")
    if kept is not None:
        return marshal.loads(kept)
    code = compile(text, file, "exec")
    store.keep(f"{name}.parsed", marshal.dumps(code))
    return code
