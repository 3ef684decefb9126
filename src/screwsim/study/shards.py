"""Finished parts of a sweep on disk: `OUT.h5.parts/` holds one file per chunk of cases until all are there.

Each part is written beside and renamed, so that after a crash at any moment those that are there are whole.
"""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.faults import UsageError
from screwsim.results.atomic import cannot_write, make_folder, replacing
from screwsim.results.table import FIGURES, TEXTS, Table, join, rows_of, same_angles, trace_names

_NAME = re.compile(r"cases_(\d{9})_(\d{9})\.npz")
_TRACE, _LEDGER = "trace_", "ledger_"
_UNREADABLE = (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile)


class Parts:
    """The folder of parts of one sweep, held by one process at a time."""

    def __init__(self, output: Path, identity: Mapping[str, Any]) -> None:
        self.output = output
        self.folder = output.with_name(output.name + ".parts")
        self.identity = dict(identity)  # what must agree for parts to belong together
        self._lock: Any = None

    @property
    def _manifest(self) -> Path:
        return self.folder / "sweep.json"

    def stored_identity(self) -> dict[str, Any] | None:
        """Return whose parts are there; None without any."""
        with suppress(OSError, ValueError):
            return json.loads(self._manifest.read_text())
        return None

    def open(self, restart: bool) -> None:
        """Make the folder and hold it; raise UsageError when another process does.

        Old parts go on a restart, and when the manifest that says whose they are is missing.
        """
        make_folder(self.folder)
        self._hold()
        if restart:
            self._manifest.unlink(missing_ok=True)
        if self.stored_identity() is None:
            self._clear()
            with replacing(self._manifest) as temporary:
                temporary.write_text(json.dumps(self.identity, indent=1))

    def _hold(self) -> None:
        try:
            self._lock = (self.folder / "lock").open("w")
        except OSError as error:
            raise UsageError(cannot_write(self.folder, error)) from error
        try:
            import fcntl

            # a record lock: it ends with the process, however it ends, and forked workers do not inherit it
            fcntl.lockf(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            self._lock.close()
            raise UsageError(
                f"{self.output}: another sweep is writing it (wait for it, or choose another -o)"
            ) from None
        except (ImportError, OSError):
            pass  # no locks on this system or disk: two sweeps at once only do the same work twice

    def close(self) -> None:
        """Let go of the folder; parts stay."""
        if self._lock is not None:
            self._lock.close()

    def discard(self) -> None:
        """Remove the parts. The owner's name goes first: parts without it are never taken for finished ones."""
        with suppress(OSError):
            self._manifest.unlink(missing_ok=True)
            self._clear()
        self.close()
        with suppress(OSError):
            (self.folder / "lock").unlink(missing_ok=True)
            self.folder.rmdir()

    def _clear(self) -> None:
        if not self.folder.is_dir():
            return
        for file in self.folder.iterdir():
            if _NAME.fullmatch(file.name) or file.name.endswith(".tmp"):
                file.unlink(missing_ok=True)

    def write(self, start: int, table: Table) -> None:
        """Store the results of the cases from `start` on."""
        path = self.folder / f"cases_{start:09d}_{start + len(table):09d}.npz"
        arrays = {
            "status": table.status,
            "figures": table.figures,
            "effects": np.array(table.effects, np.str_),
            "states": np.array(table.states, np.str_),
            "angle": table.angle,
            **{name: table.texts[name] for name in TEXTS},
            **{_TRACE + name: trace for name, trace in table.traces.items()},
            **{_LEDGER + name: values for name, values in table.ledger.items()},
        }
        with replacing(path) as temporary, temporary.open("wb") as stream:
            np.savez(stream, allow_pickle=False, **arrays)

    def finished(self) -> list[range]:
        """Return the cases that whole parts hold, ascending and disjoint; parts that cannot be read are removed."""
        found: list[range] = []
        for path, cases in self._files():
            if found and cases.start < found[-1].stop:
                continue
            if _whole(path, len(cases)):
                found.append(cases)
            else:
                path.unlink(missing_ok=True)
        return found

    def _files(self) -> Iterator[tuple[Path, range]]:
        """Yield the parts by first case, the longest first."""
        names = (_NAME.fullmatch(file.name) for file in self.folder.iterdir())
        spans = [range(int(name[1]), int(name[2])) for name in names if name]
        for cases in sorted(spans, key=lambda cases: (cases.start, -cases.stop)):
            yield self._path(cases), cases

    def _path(self, cases: range) -> Path:
        return self.folder / f"cases_{cases.start:09d}_{cases.stop:09d}.npz"

    def merged(self, total: int) -> Table:
        """Return all cases as one table; its traces are read from the parts, one at a time, when asked for."""
        spans, stop = [], 0
        for _, cases in self._files():
            if cases.start == stop:
                spans.append(cases)
                stop = cases.stop
        if stop != total:
            raise RuntimeError(f"{self.folder}: cases from {stop} on are missing")
        tables = [read_part(self._path(cases), traces=False) for cases in spans]
        paths = [self._path(cases) for cases in spans]
        return join(tables, _StoredTraces(paths, max(table.angle.size for table in tables)))


class _StoredTraces(Mapping[str, np.ndarray]):
    """Traces of consecutive parts by name, (cases, points); each is read when asked for and not kept."""

    def __init__(self, paths: list[Path], points: int) -> None:
        self._paths = paths
        self._points = points
        found = (name.removeprefix(_TRACE) for path in paths for name in _names(path) if name.startswith(_TRACE))
        self._names = trace_names(found) if points else ()

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._names:
            raise KeyError(name)
        return np.concatenate([rows_of(read_part(path, traces=name), name, self._points) for path in self._paths])

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _names(path: Path) -> list[str]:
    with np.load(path, allow_pickle=False) as stored:
        return list(stored.files)


def read_part(path: Path, traces: bool | str = True) -> Table:
    """Return the table of a part with all traces, none, or the one that is named."""
    with np.load(path, allow_pickle=False) as stored:
        names = [name for name in stored.files if name.startswith(_TRACE)] if traces else []
        kept = [name for name in names if traces is True or name == _TRACE + str(traces)]
        return Table(
            status=stored["status"],
            figures=stored["figures"],
            texts={name: stored[name] for name in TEXTS},
            effects=tuple(map(str, stored["effects"])),
            states=tuple(map(str, stored["states"])),
            angle=stored["angle"],
            traces={name.removeprefix(_TRACE): stored[name] for name in kept},
            ledger={
                name.removeprefix(_LEDGER): stored[name]
                for name in stored.files
                if name.startswith(_LEDGER) and not isinstance(traces, str)
            },
        )


def _whole(path: Path, cases: int) -> bool:
    """Tell whether a part can be read to its end (its checksums included) and holds that many cases."""
    try:
        with zipfile.ZipFile(path) as archive:
            if archive.testzip() is not None:
                return False
        table = read_part(path, traces=False)
    except _UNREADABLE:
        return False
    return len(table) == cases and table.figures.shape == (cases, len(FIGURES))


class AngleGuard:
    """Refuse, at the first part that differs, traces over another angle grid than that of the sweep."""

    def __init__(self) -> None:
        self._angle = np.empty(0)

    def check(self, angle: np.ndarray) -> None:
        """Raise UsageError when the grid differs from the first one seen: chambers live longer in some cases."""
        if not angle.size:
            return
        first = self._angle if self._angle.size else angle
        try:
            same_angles(first, angle)
        except ValueError:
            lives = f"{first[-1]:g} and {angle[-1]:g} deg"
            what = f"chambers live {lives} in these cases, and their traces share no angles"
            raise UsageError(f"output.keep: {what} (write output.keep: performance)") from None
        self._angle = first
