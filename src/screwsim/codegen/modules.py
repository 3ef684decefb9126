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

from screwsim.codegen.calls import KINDS, Variant, take
from screwsim.codegen.kinds import Kind
from screwsim.numerics import compiling, store

_loaded: dict[str, Module] = {}
_alone = threading.RLock()  # two threads would compile the same


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


def load(text: str, of: str) -> Module:
    """Return the module of a text; `of` begins its name. What is compiled of it is kept in the cache folder."""
    name = module_name(text, of)
    with _alone:
        if name not in _loaded:
            store.keep_text(f"{name}.py", text)  # to be read by people; nothing is taken from there
            _loaded[name] = Module(name, text)
        return _loaded[name]


class Module(ModuleType):
    """Functions of a text, by name; `outside` are addresses of functions of this process that the text calls."""

    def __init__(self, name: str, text: str, outside: Mapping[str, int] | None = None, checks: bool = False) -> None:
        super().__init__(name)
        self._text, self._outside, self._checks = text, dict(outside or {}), checks
        self.made: list[str] = []  # functions that were compiled in this process, not found in the cache
        self._program: Any = None

    def __getattr__(self, name: str) -> Function:
        if name.startswith("__") or f"\ndef {name}(" not in f"\n{self._text}":
            raise AttributeError(f"{self.__name__} has no function {name!r}")
        found = Function(self, name)
        self.__dict__[name] = found
        return found

    def compiled(self, name: str, kinds: tuple[Kind, ...]) -> Variant:
        """Return a function for kinds of arguments: as it was kept, or compiled now."""
        from screwsim.codegen import machine

        of = hashlib.sha256(" ".join(map(str, kinds)).encode()).hexdigest()[:8]
        symbol, file = f"{self.__name__}.{name}.{of}", f"{self.__name__}.{name}.{of}.code"
        kept = None if self._outside or self._checks else store.read(file)
        if kept is None:
            compiling.begins()
            kept = self._compile(name, kinds, symbol)
            self.made.append(name)
            if not (self._outside or self._checks):
                store.keep(file, kept)
        returned, _, code = kept.partition(b"\n")
        return Variant(machine.loaded(code, symbol), kinds, returned.decode())

    def _compile(self, name: str, kinds: tuple[Kind, ...], symbol: str) -> bytes:
        from screwsim.codegen import machine, program, unit

        if self._program is None:
            self._program = program.read(self._text)
        together = unit.Unit(self._program, self._outside, self._checks)
        returned = together.entry(name, kinds, symbol)
        return str(returned).encode() + b"\n" + machine.compiled(together.text())


class Function:
    """A function of a module, compiled for the kinds of arguments that it is called with."""

    def __init__(self, module: Module, name: str) -> None:
        self._module, self._name = module, name
        self.variants: dict[tuple[int, ...], Variant] = {}

    def __call__(self, *arguments: Any) -> Any:
        kinds: list[int] = []
        words: list[float] = []
        for each in arguments:
            take(each, kinds, words)
        key = tuple(kinds)
        variant = self.variants.get(key)
        if variant is None:
            with _alone:
                variant = self.variants.get(key) or self._module.compiled(self._name, tuple(KINDS[k] for k in key))
                self.variants[key] = variant
        return variant(words)
