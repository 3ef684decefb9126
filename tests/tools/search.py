"""Parts common to searches: worker processes that an item may end or block, the table of rows, the summary."""

from __future__ import annotations

import csv
import hashlib
import importlib.metadata
import json
import multiprocessing
import multiprocessing.connection
import platform
import sys
import time
import traceback
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from judging import finite

from screwsim.figures.errors import worst
from screwsim.inputs.faults import SceneError
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.simulate import simulate

Row = dict[str, Any]
Work = Callable[[Any, list[int]], None]  # sends (item, None) when an item is begun, then (item, row)
Lost = Callable[[int, str, str], Row]  # row of an item without a result, from its status and message
TRY = "the cycle closed only with "


class Worker:
    """One process that works on its items in turn, and is restarted behind an item that ends it."""

    def __init__(self, items: list[int], work: Work, lost: Lost) -> None:
        self.items, self.work, self.lost_row = items, work, lost
        self.row: Row | None = None
        self._start()

    def _start(self) -> None:
        self.at, self.began = None, time.monotonic()
        self.pipe, far = multiprocessing.Pipe(duplex=False)
        context = multiprocessing.get_context("fork")
        self.process = context.Process(target=self.work, args=(far, self.items), daemon=True)
        self.process.start()
        far.close()

    def receive(self) -> Row | None:
        """Return the row of a finished item, if there is one; or the row of the item at which the process ended."""
        try:
            item, row = self.pipe.recv()
        except EOFError:
            self.process.join()
            return self.lost("crashed", f"the process ended with {self.process.exitcode}")
        if item != self.at:
            done, self.row = self.row, None
            self.at, self.began = item, time.monotonic()
            return done
        self.row = row
        return None

    def lost(self, status: str, message: str) -> Row:
        """Return the row of the current item, which has no end, and continue with the next in a new process."""
        self.process.kill()
        self.process.join()
        if self.at is None:
            raise RuntimeError(f"a worker did not start: {message}")
        done, self.row = self.row or self.lost_row(self.at, status, message), None
        self.items = self.items[self.items.index(self.at) + 1 :]
        if self.items:
            self._start()
        return done


def rows_of(items: list[int], jobs: int, limit: float, work: Work, lost: Lost) -> Iterator[Row]:
    """Yield the rows of items as they come; one that takes longer than `limit` [s] has the status `hung`."""
    workers = [Worker(items[i::jobs], work, lost) for i in range(min(jobs, len(items)))]
    while workers:
        pipes = {worker.pipe: worker for worker in workers}
        ready = [pipes[pipe] for pipe in multiprocessing.connection.wait(list(pipes), timeout=1.0)]
        for worker in workers:
            row = None
            if worker in ready:
                row = worker.receive()
            elif time.monotonic() - worker.began > limit:
                row = worker.lost("hung", f"no end within {limit:g} s")
            if row is not None:
                yield row
        workers = [worker for worker in workers if worker.items]


def solved(row: Row, make: Callable[[], Scene]) -> tuple[Row, Scene | None, Result | None]:
    """Return the row of one scene, the scene and its result; a crash gives the status `crashed`."""
    scene = result = None
    started = time.monotonic()
    try:
        scene = make()
        row["accuracy"] = scene.numerics.accuracy
        result = simulate(scene)
        row |= {"status": result.status, "message": result.message, "closing": result.numerics.get("closing")}
        row["needed"] = "; ".join(text.removeprefix(TRY) for text in result.warnings if text.startswith(TRY))
        row["rhs_evaluations"] = result.numerics.rhs_evaluations
        row |= {name: result.balance.get(name) for name in ("mass", "energy", "entropy") if name in row}
        row["error"] = worst(result.error)[1]
        if not finite(result):
            row["status"] = "not finite"
    except SceneError as fault:
        row |= {"status": "refused", "message": str(fault)}
    except Exception:  # noqa: BLE001 - these are searched for
        row |= {"status": "crashed", "message": traceback.format_exc(limit=-2)}
    return row | {"seconds": round(time.monotonic() - started, 3)}, scene, result


def digest(*files: Path) -> str:
    """Return the digest of the files that items are drawn from, which tells tables of different spaces apart."""
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:12]


def read(path: Path) -> list[Row]:
    """Return the rows of a table, with numbers converted."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [{name: number(text) for name, text in row.items()} for row in csv.DictReader(file)]


def number(text: str) -> Any:
    """Return a text as a number where it is one, None for an empty text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text or None


def append(table: Path, columns: Sequence[str], rows: Iterable[Row], begun: bool, every: int) -> None:
    """Append rows to a table as they come, with a header unless begun; report on stderr after every `every` rows."""
    with table.open("a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        if not begun:
            writer.writeheader()
        seen, started = Counter(), time.monotonic()
        for row in rows:
            writer.writerow(row)
            file.flush()
            seen[row["status"]] += 1
            if seen.total() % every == 0:
                print(f"{seen.total()} scenes, {time.monotonic() - started:.0f} s: {dict(seen)}", file=sys.stderr)


def largest(rows: Iterable[Row], key: str) -> Row:
    """Return value and index of the row with the largest number of a column."""
    row = max((row for row in rows if isinstance(row[key], (int, float))), key=lambda row: row[key], default=None)
    return {"value": row[key], "index": row["index"]} if row else {}


def made(command: str, seed: int, space: str, packages: Sequence[str]) -> Row:
    """Return the provenance of a summary: its command, space, and versions."""
    versions = {name: importlib.metadata.version(name) for name in ("screwsim", *packages)}
    versions["python"] = platform.python_version()
    return {"command": f"tests/tools/{command}", "seed": seed, "space": space, "versions": versions}


def statuses(rows: list[Row], structures: Iterable[str]) -> Row:
    """Return how many scenes ended in which status, in all and by structure."""
    by_structure: dict[str, Counter[str]] = defaultdict(Counter)
    for row in rows:
        by_structure[row["structure"]][row["status"]] += 1
    return {
        "scenes": len(rows),
        "status": dict(Counter(row["status"] for row in rows)),
        "structure": {name: dict(by_structure[name]) for name in structures if name in by_structure},
    }


def not_ok(rows: list[Row]) -> dict[str, list[int]]:
    """Return the scenes of each status that needs a look."""
    found = sorted({row["status"] for row in rows} - {"ok", "refused", "failed"})
    return {status: [row["index"] for row in rows if row["status"] == status] for status in found}


def tell(summary: Row, file: Path | None, names: Sequence[str]) -> None:
    """Write a summary to a file if one is given, and print parts of it."""
    if file:
        file.write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({name: summary[name] for name in names}, indent=1))
