"""Modules: texts of kernels whose functions are compiled when they are first called, and kept.

A module's name is the hash of all its text and of what compiles it, so that an edit anywhere makes another one and a
stale one cannot be run. What is compiled of it, one file for each function and kinds of arguments, is kept in the cache
folder; a text that is not asked to compile anything is not even read.

A function is written soon at first. Once that has run for a while, in this process and those before, it is written
again for speed, with the same bits: who waits for a first result need not wait for what only many results pay for.
"""

from __future__ import annotations

import hashlib
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from screwsim.codegen.calls import KINDS, Context, Variant, known, take
from screwsim.codegen.kinds import LANED, Kind
from screwsim.numerics import compiling, store
from screwsim.numerics.garbage import no_search

_loaded: dict[str, Module] = {}
_alone = threading.RLock()  # two threads would make two modules of one text
_libraries: dict[int, tuple[Module, Any]] = {}  # of the modules that were compiled last: a text read takes megabytes
_writing = threading.RLock()
MOST_LIBRARIES = 3
PATIENCE = 5e-6  # [s a byte] that code which was written soon runs before it is written for speed: what that takes
SHARES = 16  # of that time: what a process has run of it is told others in so many steps
_FULL = 4096  # [byte] of the file of these
_measuring: list[object] = []  # who measures times: each step on it is one of the interpreter's own


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


@contextmanager
def for_speed() -> Iterator[None]:
    """Write code for speed at once, in all threads: where times are measured."""
    own = object()
    _measuring.append(own)
    try:
        yield
    finally:
        _measuring.remove(own)


def load(text: str, of: str, fast: bool = False) -> Module:
    """Return the module of a text; `of` begins its name. What is compiled of it is kept in the cache folder.

    A `fast` one is written for speed at once: one text for all models, which is compiled but once.
    """
    name = module_name(text, of)
    with _alone:
        if name not in _loaded:
            store.keep_text(f"{name}.py", text)  # to be read by people; nothing is taken from there
            _loaded[name] = Module(name, text, fast=fast)
        return _loaded[name]


class Module(ModuleType):
    """Functions of a text, by name; `outside` are addresses of functions of this process that the text calls."""

    def __init__(
        self, name: str, text: str, outside: Mapping[str, int] | None = None, checks: bool = False, fast: bool = False
    ) -> None:
        super().__init__(name)
        self.text, self._outside, self._checks, self.fast = text, dict(outside or {}), checks, fast
        self.made: list[str] = []  # functions that were compiled in this process, not found in the cache

    def __getattr__(self, name: str) -> Function:
        if name.startswith("__") or f"\ndef {name}(" not in f"\n{self.text}":
            raise AttributeError(f"{self.__name__} has no function {name!r}")
        return self.__dict__.setdefault(name, Function(self, name))

    def compiled(self, name: str, kinds: tuple[Kind, ...], fast: bool = False) -> tuple[Variant, int]:
        """Return a function for kinds of arguments, as it was kept or compiled now, and its bytes; none if fast."""
        from screwsim.codegen import machine

        returned, code, symbol, fast = self._code(name, kinds, fast)
        return Variant(machine.loaded(code, symbol), kinds, returned), 0 if fast else len(code)

    def of_lanes(self, name: str, kinds: tuple[Kind, ...]) -> Any:
        """Return the entry of a function of points side by side (`codegen.lane_library`), written for speed."""
        from screwsim.codegen import machine

        _, code, symbol, _ = self._code(name, kinds, True)
        return machine.loaded(code, symbol)

    def of_device(self, name: str, kinds: tuple[Kind, ...], numbers: Mapping[int, int]) -> bytes:
        """Return the PTX of a kernel, a thread a point (`codegen.device_library`); kept as machine code is."""
        from screwsim.codegen import device_library, machine, program

        symbol = f"{self._symbol(name, kinds)}.{'.'.join(f'{k}_{number}' for k, number in numbers.items())}.ptx"
        kept = store.read(symbol)
        if kept is None:
            compiling.begins()
            text = device_library.DeviceLibrary(program.read(self.text), numbers).of_threads(name, kinds)
            kept = machine.for_device(text).encode()
            store.keep(symbol, kept)
        return kept

    def run_file(self, name: str, kinds: tuple[Kind, ...]) -> str:
        """Return the name of the file that tells how long a function which was written soon has run; '': none does."""
        return "" if self._outside or self._checks else f"{self._symbol(name, kinds)}.ran"

    def _symbol(self, name: str, kinds: tuple[Kind, ...]) -> str:
        of = hashlib.sha256(" ".join(map(str, kinds)).encode()).hexdigest()[:8]
        return f"{self.__name__}.{name}.{of}"

    def _code(self, name: str, kinds: tuple[Kind, ...], fast: bool) -> tuple[str, bytes, str, bool]:
        """Return what a function returns, its machine code, the symbol of its entry, and whether it is fast."""
        from screwsim.codegen import machine

        symbol, kept = self._symbol(name, kinds), None
        lasting = not (self._outside or self._checks)
        if lasting:
            kept = store.read(f"{symbol}.fast")
            soon = None if kept or fast else store.read(f"{symbol}.code")
            kept, fast = kept or soon, kept is not None or fast
        if kept is None:
            compiling.begins()
            with no_search():
                returned, text = self._written(name, kinds, symbol)
            kept = b"\n".join([str(returned).encode(), machine.compiled(text, fast)])
            self.made.append(name)
            if lasting:
                store.keep(f"{symbol}.{'fast' if fast else 'code'}", kept)
        returned, _, code = kept.partition(b"\n")
        return returned.decode(), code, symbol, fast

    def _written(self, name: str, kinds: tuple[Kind, ...], symbol: str) -> tuple[Kind, str]:
        from screwsim.codegen import lane_library, library, program

        if any(kind.name in LANED for kind in kinds):
            return lane_library.LaneLibrary(program.read(self.text)).entry(name, kinds, symbol)
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
        self._variants: dict[tuple[int, ...], _Calls] = {}
        self._alone = threading.Lock()

    def __call__(self, *arguments: Any) -> Any:
        kinds: list[int] = []
        words: list[float] = []
        for each in arguments:  # the commonest as `take` does, without a call
            what = type(each)
            if what is float:
                kinds.append(0)
                words.append(each)
            elif what is Context:
                kinds.append(each.number)
                words += each.words
            elif (array := known.get(id(each))) is not None and array[0]() is each:
                kinds.append(array[1])
                words += array[2]
            else:
                take(each, kinds, words)
        key = tuple(kinds)
        variant = self._variants.get(key)
        return (variant or self._made(key))(words)

    def bound(self, numbers: int, *rest: Any) -> Callable[..., Any]:
        """Return the function of so many first numbers alone, all float: where the rest stands is looked at once."""
        kinds, words = [0] * numbers, list[float]()
        for each in rest:
            take(each, kinds, words)
        key, variants = tuple(kinds), self._variants

        def call(*first: float, held: Any = rest) -> Any:  # arrays live as long as what knows where they stand
            variant = variants.get(key)
            return (variant or self._made(key))((*first, *words))

        return call

    def _made(self, key: tuple[int, ...]) -> _Calls:
        with self._alone:
            if key not in self._variants:
                variant, size = self._compiled(key, self._module.fast or bool(_measuring))
                self._variants[key] = _Tried(variant, self, key, size, self._run_file(key)) if size else variant
            return self._variants[key]

    def hasten(self, key: tuple[int, ...]) -> None:
        """Write for speed what was written soon."""
        with self._alone:
            if isinstance(self._variants[key], _Tried):
                with compiling.again():
                    self._variants[key] = self._compiled(key, True)[0]

    def _run_file(self, key: tuple[int, ...]) -> str:
        return self._module.run_file(self._name, tuple(KINDS[kind] for kind in key))

    def _compiled(self, key: tuple[int, ...], fast: bool) -> tuple[Variant, int]:
        return self._module.compiled(self._name, tuple(KINDS[kind] for kind in key), fast)


class _Tried:
    """A variant that was written soon, of so many bytes, and how long it has run.

    `file` tells what processes before ran of it, a line a share of its time; '': it is not kept.
    """

    def __init__(self, variant: Variant, function: Function, key: tuple[int, ...], size: int, file: str) -> None:
        self._variant, self._function, self._key, self._size, self._file = variant, function, key, size, file
        before = sum(store.sound(line) is not None for line in store.read_lines(file, _FULL)) if file else 0
        self._share = PATIENCE * size / SHARES
        self._ran = before * self._share if before else 0.0  # a share may be endless
        self._untold = self._ran + self._share

    def __call__(self, words: Sequence[float]) -> Any:
        started = time.perf_counter()
        found = self._variant(words)
        self._ran += time.perf_counter() - started
        if _measuring or self._ran > self._untold:
            self._consider()
        return found

    def _consider(self) -> None:
        """Write it for speed where it has run for long enough, or tell others how long it has."""
        if _measuring or self._ran > PATIENCE * self._size:
            self._function.hasten(self._key)
            if self._file:
                store.drop(self._file)
            return
        while self._untold < self._ran:
            self._untold += self._share
            if self._file:
                store.append_line(self._file, "", _FULL)


_Calls = Variant | _Tried
