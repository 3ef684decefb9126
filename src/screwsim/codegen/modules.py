"""Modules: texts of kernels whose functions are compiled when first called, and cached.

A module's name is the hash of its whole text and of the compiler, so that any edit gives another module and stale code
cannot run. Compiled code is kept in the cache folder, one file for each function and kinds of arguments; a text from
which nothing is compiled is not even parsed.

A function is first compiled quickly. Once that code has run for a while, in this process and earlier ones, it is
compiled again for speed, with the same bits: a first result need not wait for compilation that pays off only over many
results.
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
from screwsim.numerics.kept_text import flat_module
from screwsim.numerics.kernel import Kernel

_loaded: dict[str, Module] = {}
_alone = threading.RLock()  # keeps two threads from making two modules of one text
_libraries: dict[int, tuple[Module, Any]] = {}  # of the last modules compiled: a parsed text takes megabytes
_writing = threading.RLock()
MOST_LIBRARIES = 3
PATIENCE = 5e-6  # [s/byte] run time of quick code before it is compiled for speed: about the time that this takes
SHARES = 16  # number of parts of that time in which a process reports its run time to other processes
_FULL = 4096  # [byte] largest file of these reports
_measuring: list[object] = []  # one object for each measurement of times; list operations are atomic


@cache
def _compiler() -> str:
    """Return a hash of what determines machine code beside the text: this package, LLVM, the processor."""
    from screwsim.codegen.machine import processor  # here because it is slow to import

    sources = (path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py")))
    return hashlib.sha256(b"\n".join([*sources, processor().encode()])).hexdigest()


def module_name(text: str, of: str) -> str:
    """Return the module's name: a hash of its text, of the compiler and of the processor."""
    digest = hashlib.sha256("\n".join([text, _compiler()]).encode()).hexdigest()
    return f"screwsim_{of}_{digest[:24]}"


@contextmanager
def for_speed() -> Iterator[None]:
    """Compile for speed at once, in all threads: for measurements of times."""
    own = object()
    _measuring.append(own)
    try:
        yield
    finally:
        _measuring.remove(own)


def load(text: str, of: str, fast: bool = False) -> Module:
    """Return the module of a text; `of` begins its name. Its compiled code is kept in the cache folder.

    A `fast` one is compiled for speed at once: for a text common to all models, which is compiled only once.
    """
    name = module_name(text, of)
    with _alone:
        if name not in _loaded:
            store.keep_text(f"{name}.py", text)  # for people to read; never read back
            _loaded[name] = Module(name, text, fast=fast)
        return _loaded[name]


@cache
def of_kernels(name: str, *kernels: Kernel) -> Module:
    """Return the module of kernels that are the same for all models."""
    return load(flat_module(kernels), name, fast=True)


class Module(ModuleType):
    """Functions of a text by name; `outside` are addresses of functions of this process that the text calls."""

    def __init__(
        self, name: str, text: str, outside: Mapping[str, int] | None = None, checks: bool = False, fast: bool = False
    ) -> None:
        super().__init__(name)
        self.text, self._outside, self._checks, self.fast = text, dict(outside or {}), checks, fast
        self.made: list[str] = []  # functions compiled in this process, not found in the cache

    def __getattr__(self, name: str) -> Function:
        if name.startswith("__") or f"\ndef {name}(" not in f"\n{self.text}":
            raise AttributeError(f"{self.__name__} has no function {name!r}")
        return self.__dict__.setdefault(name, Function(self, name))

    def compiled(self, name: str, kinds: tuple[Kind, ...], fast: bool = False) -> tuple[Variant, int]:
        """Return a function for kinds of arguments, from the cache or compiled now, and its size [byte].

        0 if it is fast.
        """
        from screwsim.codegen import machine

        returned, code, symbol, fast = self._code(name, kinds, fast)
        return Variant(machine.loaded(code, symbol), kinds, returned), 0 if fast else len(code)

    def of_lanes(self, name: str, kinds: tuple[Kind, ...]) -> Any:
        """Return the entry of a function for points side by side (`codegen.lanes`), compiled for speed."""
        from screwsim.codegen import machine

        _, code, symbol, _ = self._code(name, kinds, True)
        return machine.loaded(code, symbol)

    def of_device(self, name: str, kinds: tuple[Kind, ...], numbers: Mapping[int, int]) -> bytes:
        """Return the PTX of a GPU kernel, one thread per point (`codegen.device_library`), cached like machine code."""
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
        """Return the name of the file that records how long a quickly compiled function has run.

        '' where there is none.
        """
        return "" if self._outside or self._checks else f"{self._symbol(name, kinds)}.ran"

    def _symbol(self, name: str, kinds: tuple[Kind, ...]) -> str:
        of = hashlib.sha256(" ".join(map(str, kinds)).encode()).hexdigest()[:8]
        return f"{self.__name__}.{name}.{of}"

    def _code(self, name: str, kinds: tuple[Kind, ...], fast: bool) -> tuple[str, bytes, str, bool]:
        """Return a function's returned kind, machine code, symbol of its entry, and whether that is fast."""
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
        from screwsim.codegen import lanes, library, program

        if any(kind.name in LANED for kind in kinds):
            return lanes.LaneLibrary(program.read(self.text)).entry(name, kinds, symbol)
        with _writing:
            found = _libraries.pop(id(self), None)
            if found is None or found[0] is not self:
                found = self, library.Library(program.read(self.text), self._outside, self._checks)
            entry = found[1].entry(name, kinds, symbol)  # interrupted, as by Ctrl-C, the library is written anew
            if len(_libraries) >= MOST_LIBRARIES:
                _libraries.pop(next(iter(_libraries)))
            _libraries[id(self)] = found  # now the most recent
            return entry


class Function:
    """A function of a module, compiled for the kinds of arguments with which it is called."""

    def __init__(self, module: Module, name: str) -> None:
        self._module, self._name = module, name
        self._variants: dict[tuple[int, ...], _Calls] = {}
        self._alone = threading.Lock()

    def __call__(self, *arguments: Any) -> Any:
        kinds: list[int] = []
        words: list[float] = []
        for each in arguments:  # the most common kinds as in `take`, without a call
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
        """Return the function of its first `numbers` arguments, all floats.

        The words of the others are determined once.
        """
        kinds, words = [0] * numbers, list[float]()
        for each in rest:
            take(each, kinds, words)
        key, variants = tuple(kinds), self._variants

        def call(*first: float, held: Any = rest) -> Any:  # `held` keeps alive the arrays whose addresses are used
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
        """Compile for speed what was compiled quickly."""
        with self._alone:
            if isinstance(self._variants[key], _Tried):
                with compiling.again():
                    self._variants[key] = self._compiled(key, True)[0]

    def _run_file(self, key: tuple[int, ...]) -> str:
        return self._module.run_file(self._name, tuple(KINDS[kind] for kind in key))

    def _compiled(self, key: tuple[int, ...], fast: bool) -> tuple[Variant, int]:
        return self._module.compiled(self._name, tuple(KINDS[kind] for kind in key), fast)


class _Tried:
    """A quickly compiled variant, its size [byte], and the processor time for which it has run.

    `file` records how long earlier processes ran it, one line for each part of the time; '': no record is kept.
    """

    def __init__(self, variant: Variant, function: Function, key: tuple[int, ...], size: int, file: str) -> None:
        self._variant, self._function, self._key, self._size, self._file = variant, function, key, size, file
        before = sum(store.checked_line(line) is not None for line in store.read_lines(file, _FULL)) if file else 0
        self._share = PATIENCE * size / SHARES
        self._ran = before * self._share if before else 0.0  # a share may be infinite
        self._untold = self._ran + self._share

    def __call__(self, words: Sequence[float]) -> Any:
        started = time.thread_time()
        found = self._variant(words)
        self._ran += time.thread_time() - started
        if _measuring or self._ran > self._untold:
            self._consider()
        return found

    def _consider(self) -> None:
        """Compile it for speed where it has run long enough.

        Otherwise record for other processes how long it has run.
        """
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
