"""Modules: texts of kernels whose functions are compiled when they are first called, and kept.

A module's name is the hash of all its text and of what compiles it, so that an edit anywhere makes another one and a
stale one cannot be run. What is compiled of it, one file for each function and kinds of arguments, is kept in the cache
folder; a text that is not asked to compile anything is not even read.
"""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from screwsim.codegen.calls import KINDS, Variant, known, take
from screwsim.codegen.kinds import Kind
from screwsim.numerics import compiling, store

_loaded: dict[str, Module] = {}
_alone = threading.RLock()  # two threads would make two modules of one text
_libraries: dict[int, tuple[Module, Any]] = {}  # of the modules that were compiled last: a text read takes megabytes
_writing = threading.RLock()
MOST_LIBRARIES = 3


@cache
def _compiler() -> str:
    """Return what decides on machine code beside the text: this package, LLVM, the processor."""
    from screwsim.codegen.machine import processor  # here, since it takes long to import

    sources = (path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py")))
    return hashlib.sha256(b"\n".join([*sources, processor().encode()])).hexdigest()


def module_name(text: str, of: str) -> str:
    """Return the module's name: a hash of its text, of what compiles it, and the processor."""
    digest = hashlib.sha256("\n".join([text, _compiler()]).encode()).hexdigest()
    return f"screwsim_{of}_{digest[:24]}"


def load(text: str, of: str, seldom: tuple[str, ...] = ()) -> Module:
    """Return the module of a text; `of` begins its name. What is compiled of it is kept in the cache folder.

    What names of functions begin with that run some times a solution is `seldom`.
    """
    name = module_name(text, of)
    with _alone:
        if name not in _loaded:
            store.keep_text(f"{name}.py", text)  # to be read by people; nothing is taken from there
            _loaded[name] = Module(name, text)
            _loaded[name].seldom = seldom
        return _loaded[name]


class Module(ModuleType):
    """Functions of a text, by name; `outside` are addresses of functions of this process that the text calls."""

    def __init__(self, name: str, text: str, outside: Mapping[str, int] | None = None, checks: bool = False) -> None:
        super().__init__(name)
        self.text, self._outside, self._checks = text, dict(outside or {}), checks
        self.seldom: tuple[str, ...] = ()
        self.made: list[str] = []  # functions that were compiled in this process, not found in the cache

    def __getattr__(self, name: str) -> Function:
        if name.startswith("__") or f"\ndef {name}(" not in f"\n{self.text}":
            raise AttributeError(f"{self.__name__} has no function {name!r}")
        return self.__dict__.setdefault(name, Function(self, name))

    def compiled(self, name: str, kinds: tuple[Kind, ...]) -> Variant:
        """Return a function for kinds of arguments: as it was kept, or compiled now."""
        from screwsim.codegen import machine

        of = hashlib.sha256(" ".join(map(str, kinds)).encode()).hexdigest()[:8]
        symbol, kept = f"{self.__name__}.{name}.{of}", None
        lasting = not (self._outside or self._checks)
        if lasting:
            kept = store.read(f"{symbol}.code")
        if kept is None:
            compiling.begins()
            returned, text = self._written(name, kinds, symbol)
            kept = b"\n".join([str(returned).encode(), machine.compiled(text, name.startswith(self.seldom))])
            self.made.append(name)
            if lasting:
                store.keep(f"{symbol}.code", kept)
        returned, _, code = kept.partition(b"\n")
        return Variant(machine.loaded(code, symbol), kinds, returned.decode())

    def _written(self, name: str, kinds: tuple[Kind, ...], symbol: str) -> tuple[Kind, str]:
        from screwsim.codegen import library, program

        with _writing:
            found = _libraries.pop(id(self), None)
            if found is None or found[0] is not self:
                found = self, library.Library(program.read(self.text), self._outside, self._checks)
            if len(_libraries) >= MOST_LIBRARIES:
                _libraries.pop(next(iter(_libraries)))
            _libraries[id(self)] = found  # the last one
            return found[1].entry(name, kinds, symbol)


class Function:
    """A function of a module, compiled for the kinds of arguments that it is called with."""

    def __init__(self, module: Module, name: str) -> None:
        self._module, self._name = module, name
        self._variants: dict[tuple[int, ...], Variant] = {}
        self._alone = threading.Lock()

    def __call__(self, *arguments: Any) -> Any:
        kinds: list[int] = []
        words: list[float] = []
        for each in arguments:
            array = known.get(id(each))
            if array is not None and array[0]() is each:  # as `take` does, without a call
                kinds.append(array[1])
                words += array[2]
            else:
                take(each, kinds, words)
        key = tuple(kinds)
        variant = self._variants.get(key)
        return (variant or self._made(key))(words)

    def _made(self, key: tuple[int, ...]) -> Variant:
        with self._alone:
            if key not in self._variants:
                self._variants[key] = self._module.compiled(self._name, tuple(KINDS[kind] for kind in key))
            return self._variants[key]
