"""Finished parts of a sweep on disk: `OUT.h5.parts/` holds one file per chunk of cases until the sweep is complete.

Each part is written under a temporary name and renamed, so that after a crash at any moment all existing parts are
whole. When there are many, neighbours are joined to larger ones.
"""

import json
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.inputs.textfiles import Unreadable, read_text
from screwsim.results.atomic import check_target_kind, link_target, make_folder, refused, replacing
from screwsim.results.table import Table, join
from screwsim.study.sweep.part_files import is_whole, read_part, write_part

MOST_SMALL_PARTS = 128  # small parts written until neighbours are joined
LARGE_PART = 16_000_000  # [byte] size from which a part is no longer joined
BYTES_IN_MEMORY = 16_000_000  # [byte] of parts that are also kept in memory, and not read again
_NAME = re.compile(r"cases_(\d{9})_(\d{9})\.npz")


class StoredTables:
    """Consecutive parts, read one at a time except those kept in memory."""

    def __init__(self, paths: list[Path], cases: int, at_hand: Mapping[Path, Table]) -> None:
        self.cases = cases
        self._paths = paths
        self._at_hand = at_hand

    def heads(self) -> Iterator[Table]:
        """Yield the parts; those read from disk come without their cases."""
        return (self._at_hand.get(path) or read_part(path, cases=False) for path in self._paths)

    def tables(self, traces: bool) -> Iterator[Table]:
        """Yield the parts; those read from disk come with or without traces."""
        return (self._at_hand.get(path) or read_part(path, traces) for path in self._paths)


class Parts:
    """Folder with the parts of one sweep, held by one process at a time."""

    def __init__(self, output: Path, identity: Mapping[str, Any], study: str = "sweep") -> None:
        self.output = output
        self.study = study  # kind of study whose cases these are, in words
        there = link_target(output)  # on the disk of the file, and the same for all links to it
        self.folder = there.with_name(there.name + ".parts")
        self.identity = dict(identity)  # must agree for parts to belong together
        self._lock: Any = None
        self._small = 0
        self._at_hand: dict[Path, Table] = {}
        self._room = BYTES_IN_MEMORY

    @property
    def _manifest(self) -> Path:
        return self.folder / "sweep.json"

    def stored_identity(self) -> dict[str, Any] | None:
        """Return the identity stored with the parts; None without any."""
        with suppress(Unreadable, ValueError, RecursionError):
            found = json.loads(read_text(self._manifest))
            return found if isinstance(found, dict) else None
        return None

    def open(self, restart: bool) -> None:
        """Create the folder and lock it; raise UsageError when another process holds it.

        Old parts are removed on a restart, and where the manifest that holds their identity is missing.
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
        check_target_kind(self.folder / "lock")
        with refused(self.folder):
            self._lock = (self.folder / "lock").open("w")
        try:
            import fcntl

            # a record lock ends with its process, however that ends, and is not inherited by forked workers
            fcntl.lockf(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            self._lock.close()
            what = f"another {self.study} is writing it"
            raise UsageError(f"{self.output}: {what} (wait until it ends, or choose another -o)") from None
        except (ImportError, OSError):
            pass  # no locks on this system or disk: two sweeps at once merely do the same work twice

    def close(self) -> None:
        """Release the folder; its parts stay, and a folder without parts is removed."""
        if self._lock is None or self._lock.closed:
            return
        left = self.folder.is_dir() and any(self._files())
        self._lock.close()
        with suppress(OSError):
            if not left:
                self._manifest.unlink(missing_ok=True)
                (self.folder / "lock").unlink(missing_ok=True)
                self.folder.rmdir()

    def discard(self) -> None:
        """Remove the parts. The manifest goes first: parts without it are never taken for finished ones."""
        with suppress(OSError):
            self._manifest.unlink(missing_ok=True)
            self._clear()
        self.close()

    def _clear(self) -> None:
        if not self.folder.is_dir():
            return
        for file in self.folder.iterdir():
            if _NAME.fullmatch(file.name) or file.name.endswith(".tmp"):
                file.unlink(missing_ok=True)

    def write(self, start: int, table: Table) -> None:
        """Store the results of the cases from `start` on."""
        path = self._path(range(start, start + len(table)))
        try:
            write_part(path, table)
        except UsageError:
            if self.folder.is_dir():
                raise
            raise self._taken("is gone") from None
        self._room -= table.size
        if self._room >= 0:
            self._at_hand[path] = table
        self._small += 1
        if self._small >= MOST_SMALL_PARTS:
            self._join_neighbours()
            self._small = 0

    def _taken(self, what: str) -> UsageError:
        """Return the error for parts that this process has written and no longer finds."""
        who = f"it was moved, or another {self.study} of the same file removed it, on a disk without file locks"
        return UsageError(f"{self.folder}: {what}: {who} (run this again; it continues from what is stored)")

    def _join_neighbours(self) -> None:
        """Join small consecutive parts; a crash leaves both forms, and the larger part is used."""
        group: list[range] = []
        room = LARGE_PART
        for path, cases in [*self._files(), (self.folder, range(0))]:
            size = path.stat().st_size if cases else LARGE_PART
            if group and (cases.start != group[-1].stop or size > room):
                self._join(group)
                group, room = [], LARGE_PART
            if size < LARGE_PART:
                group.append(cases)
                room -= size

    def _join(self, group: list[range]) -> None:
        if len(group) < 2:
            return
        table = join([read_part(self._path(cases)) for cases in group])
        write_part(self._path(range(group[0].start, group[-1].stop)), table)
        for cases in group:
            self._path(cases).unlink(missing_ok=True)

    def finished(self, fits: Callable[[range], bool] = lambda cases: True) -> list[range]:
        """Return the cases that whole parts hold, ascending and disjoint; other parts, and unfit ones, are removed."""
        found: list[range] = []
        for path, cases in list(self._files()):
            inside = bool(found) and cases.start < found[-1].stop
            if not inside and fits(cases) and is_whole(path, len(cases)):
                found.append(cases)
            else:
                path.unlink(missing_ok=True)
        return found

    def _files(self) -> Iterator[tuple[Path, range]]:
        """Yield the parts by first case, the longest first; none where the folder is gone."""
        there = self.folder.iterdir() if self.folder.is_dir() else ()
        names = (_NAME.fullmatch(file.name) for file in there)
        spans = [range(int(name[1]), int(name[2])) for name in names if name]
        for cases in sorted(spans, key=lambda cases: (cases.start, -cases.stop)):
            yield self._path(cases), cases

    def _path(self, cases: range) -> Path:
        return self.folder / f"cases_{cases.start:09d}_{cases.stop:09d}.npz"

    def table(self, wanted: range) -> Table | None:
        """Return a range of cases, collected from all parts that hold some of them; None where a case is missing."""
        found, stop = [], wanted.start
        for path, cases in self._files():
            if cases.start <= stop < cases.stop and stop < wanted.stop:
                table = self._at_hand.get(path) or read_part(path)
                found.append(table.rows(slice(stop - cases.start, wanted.stop - cases.start)))
                stop = min(cases.stop, wanted.stop)
        return join(found) if found and stop == wanted.stop else None

    def all(self, total: int) -> StoredTables:
        """Return all cases, read from the parts one after the other."""
        paths, stop = [], 0
        for path, cases in self._files():
            if cases.start == stop:
                paths.append(path)
                stop = cases.stop
        if stop != total:
            raise self._taken(f"cases from {stop} onwards are gone")
        return StoredTables(paths, total, self._at_hand)
