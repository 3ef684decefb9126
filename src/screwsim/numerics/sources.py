"""Digests of the code at work: of this package's sources, and of the user's own modules.

The version of a checkout does not identify its code; the texts do. Those of the user's own are recorded when they are
imported, since files may be edited while a process goes on with what it has imported.
"""

import ast
import hashlib
import importlib.util
import math
import site
import sys
import sysconfig
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from importlib.machinery import ModuleSpec
from pathlib import Path
from typing import Any, NamedTuple

import screwsim

_SHOWS = ("cli", "printing", "report")  # folders of the package that change no result
_LETTERS = 16  # length of a digest, enough to distinguish texts
_TICK = 0.01  # [s] possible lag of a file system's clock


class Recorded(NamedTuple):
    """The object that a user's module defines, and {file: digest} of it and of the user's modules that it imports."""

    made: Any
    digests: Mapping[str, str]


recorded: dict[str, Recorded] = {}  # the user's modules, as they were when they were imported


@cache
def package_digest() -> str:
    """Return the digest of all sources of this package that can change a result."""
    root = Path(__file__).parents[1]
    files = (file for file in root.rglob("*.py") if file.relative_to(root).parts[0] not in _SHOWS)
    return _of_files(root, files)


@cache
def folders_digest(*names: str) -> str | None:
    """Return the digest of the sources in some folders of this package, as imported by this process.

    None where that is unknown, because one was written after the import of the package began.
    """
    root = Path(__file__).parents[1]
    files = [file for name in names for file in (root / name).rglob("*.py")]
    found = _of_files(root, files)
    stats = [file.stat() for file in files]  # after they were read
    last = max((time for each in stats for time in (each.st_mtime, each.st_ctime)), default=math.inf)
    return found if last < screwsim.BEGAN - _TICK else None


def _of_files(root: Path, files: Iterable[Path]) -> str:
    found = hashlib.sha256()
    for file in sorted(files):
        found.update(f"{file.relative_to(root).as_posix()}\0{digest(file.read_bytes())}\0".encode())
    return found.hexdigest()[:_LETTERS]


def digest(content: bytes) -> str:
    """Return the digest of a file's content, whatever its line ends."""
    return hashlib.sha256(content.replace(b"\r\n", b"\n")).hexdigest()[:_LETTERS]


def record_module(name: str, made: Any) -> None:
    """Record the texts of a user's module just imported; `made` is the object that a new import replaces."""
    if name not in recorded or recorded[name].made is not made:
        top = name.partition(".")[0]
        found: dict[str, str] = {}
        if top != "screwsim":  # covered by `package_digest`
            _add(name, top, found)
        recorded[name] = Recorded(made, found)


def _add(name: str, top: str, found: dict[str, str]) -> None:
    """Add a module, the packages around it and the modules that it imports, as far as they are the user's own."""
    spec = _spec(name)
    if spec is None or not _is_own(spec, top):
        return
    path = Path(str(spec.origin))
    inside = name.replace(".", "/")
    label = f"{inside}/{path.name}" if spec.submodule_search_locations is not None else f"{inside}{path.suffix}"
    if label in found:
        return
    content = path.read_bytes()
    found[label] = digest(content)
    package = name if spec.submodule_search_locations is not None else name.rpartition(".")[0]
    parts = name.split(".")
    for other in (*(".".join(parts[:size]) for size in range(1, len(parts))), *_imported(content, package)):
        _add(other, top, found)


def _imported(content: bytes, package: str) -> Iterator[str]:
    """Yield the names of all modules that a text may import; none where it is not Python."""
    try:
        tree = ast.parse(importlib.util.decode_source(content))
    except (SyntaxError, ValueError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            with suppress(ImportError):  # beyond its top-level package
                base = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
                yield base
                yield from (f"{base}.{alias.name}" for alias in node.names)


def _spec(name: str) -> ModuleSpec | None:
    """Return where a module comes from, without importing anything that is not the user's own."""
    loaded = sys.modules.get(name)
    if loaded is not None:
        return loaded.__spec__
    parent = name.rpartition(".")[0]
    if parent and (parent not in sys.modules or not hasattr(sys.modules[parent], "__path__")):
        return None
    with suppress(ImportError, ValueError, AttributeError):
        return importlib.util.find_spec(name)
    return None


def _is_own(spec: ModuleSpec, top: str) -> bool:
    """Tell whether a module is the user's: of the effect's own package, or neither Python's nor an installed one."""
    if spec.origin is None or not Path(spec.origin).is_file():
        return False
    name = spec.name.partition(".")[0]
    return name == top or not (name == "screwsim" or any(map(Path(spec.origin).is_relative_to, _installed())))


@cache
def _installed() -> tuple[Path, ...]:
    """Return the folders of Python and of the packages that are installed for it."""
    paths = sysconfig.get_paths()
    found = [paths[name] for name in ("stdlib", "platstdlib", "purelib", "platlib")]
    return tuple(Path(path) for path in (*found, *site.getsitepackages(), site.getusersitepackages()))
