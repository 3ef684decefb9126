"""Machine code of compiled functions between processes: one sound file for each function and types of arguments.

It stands in for numba's own cache, which keeps files beside a module's source or in a folder of its choice, unpickles
what it finds there, and ends a program where they are damaged or cannot be written.
"""

from __future__ import annotations

import hashlib
import pickle
from types import ModuleType
from typing import Any

from numba.core.compiler import CompileResult
from numba.core.dispatcher import Dispatcher
from numba.core.serialize import dumps

from screwsim.numerics import compiling, store
from screwsim.numerics.folder import cache_folder


class KeptCode:
    """The kept code of one function, as numba's dispatcher asks for it (numba.core.caching._Cache)."""

    def __init__(self, of: str) -> None:
        self._of = of

    @property
    def cache_path(self) -> str:
        """Where it lies: for numba's statistics."""
        return str(cache_folder() or "")

    def _name(self, types: Any, codegen: Any) -> str:
        """Return the name for types of arguments, on this processor."""
        key = hashlib.sha256(repr((str(types), codegen.magic_tuple())).encode()).hexdigest()
        return f"{self._of}.{key[:16]}.code"

    def load_overload(self, types: Any, target: Any) -> Any:
        """Return the function compiled for types of arguments; None where it must be compiled."""
        target.refresh()
        kept = store.read(self._name(types, target.codegen()))
        if kept is not None:
            known, code = pickle.loads(kept)
            if known == types:
                return CompileResult._rebuild(target, *code)
        compiling.begins()
        return None

    def save_overload(self, types: Any, compiled: Any) -> None:
        """Keep a function compiled for types of arguments; one that holds addresses of this process is not kept."""
        if not compiled.lifted and not compiled.library.has_dynamic_globals and cache_folder() is not None:
            store.keep(self._name(types, compiled.codegen), dumps((types, compiled._reduce())))

    def enable(self) -> None:
        """Nothing: it is always in use."""

    def disable(self) -> None:
        """Nothing, as above."""

    def flush(self) -> None:
        """Nothing: a module's name is the hash of its text, so what is kept is never stale."""


def keep_code_of(module: ModuleType) -> None:
    """Let all compiled functions of a module be kept."""
    for name, function in vars(module).items():
        if isinstance(function, Dispatcher):
            function._cache = KeptCode(f"{module.__name__}.{name}")  # type: ignore[attr-defined]
