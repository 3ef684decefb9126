"""Read mutated files and store what became of them. Run: mutate.py [--count 2400] [--seed 1] [--jobs 2].

Results files, scenes, fits, tables and parts of sweeps (tests/tools/mutate_space.py) are changed at random and read as
the commands read them, each in a worker process with bounded memory and a limit of time. Required: an answer in one
line, no internal error, no end of the process, no hang, no warning of a library, nothing executed and nothing told that
the file does not hold. `--rows FILE` keeps a line a mutant, and a run goes on where it holds some already; `--outcome
FILE` stores the counts of all of them; `--only N` reads one mutant and prints how that ended.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.metadata
import json
import multiprocessing
import multiprocessing.connection
import os
import platform
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent
SPACE = ("mutate_space.py", "mutate_hdf5.py", "mutate_text.py")
sys.path.insert(0, str(HERE))
import mutate_space  # noqa: E402

MEMORY = 1_500_000_000  # [byte] that a worker may take beside what it has when it begins
PACKAGES = ("numpy", "h5py", "ruamel.yaml", "matplotlib")


def _size() -> int:
    """Return the memory that this process addresses [byte]."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()


def work(pipe: Any, folder: Path, numbers: list[int], seed: int) -> None:
    """Read mutants and send (number, None) when one is begun, (number, row) when it is done."""
    place = folder / f"work-{os.getpid()}"
    place.mkdir()
    os.chdir(place)
    limit = _size() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for number in numbers:
        pipe.send((number, None))
        answer = mutate_space.read(folder / "files", place, seed, number)
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        pipe.send((number, row_of(number, answer.kind, answer.how, answer.answers, answer.wrong) | {"peak_MB": peak}))
    pipe.close()


def row_of(number: int, kind: str, how: str, answers: Iterable[str], wrong: Iterable[str]) -> dict[str, Any]:
    """Return the row of a mutant."""
    return {"number": number, "kind": kind, "how": how, "answers": list(answers), "wrong": list(wrong)}


class Worker:
    """One process that reads its mutants in turn, and is begun again where one of them ends it."""

    def __init__(self, folder: Path, numbers: list[int], seed: int) -> None:
        self.folder, self.left, self.seed = folder, numbers, seed
        self._start()

    def _start(self) -> None:
        self.pipe, far = multiprocessing.Pipe(duplex=False)
        self.began = time.monotonic()
        self.at: int | None = None
        arguments = (far, self.folder, self.left, self.seed)
        self.process = multiprocessing.get_context("fork").Process(target=work, args=arguments, daemon=True)
        self.process.start()
        far.close()

    def receive(self) -> dict[str, Any] | None:
        """Return the row of a mutant that is done, or that ended the process."""
        try:
            number, row = self.pipe.recv()
        except EOFError:
            self.process.join()
            return self.lost(f"the process ended with {self.process.exitcode}")
        self.at, self.began = number, time.monotonic()
        if row is not None:
            self.left = self.left[1:]
        return row

    def lost(self, what: str) -> dict[str, Any]:
        """Return the row of the mutant at hand, which has no answer, and go on with the next in a new process."""
        self.process.kill()
        self.process.join()
        if self.at is None:
            raise RuntimeError(f"a worker did not start: {what}")
        number, self.left = self.left[0], self.left[1:]
        kind = mutate_space.KINDS[number % len(mutate_space.KINDS)]
        if self.left:
            self._start()
        return row_of(number, kind, f"{kind} ?", (), (what,)) | {"peak_MB": 0}


def rows_of(numbers: list[int], jobs: int, seed: int, limit: float) -> Iterator[dict[str, Any]]:
    """Yield the rows of mutants as they come; one that takes longer than `limit` [s] has hung."""
    with tempfile.TemporaryDirectory(prefix="screwsim-mutate-") as name:
        folder = Path(name)
        mutate_space.furnish(folder / "files")
        mutate_space.make_light()
        workers = [Worker(folder, numbers[i::jobs], seed) for i in range(min(jobs, len(numbers)))]
        while workers:
            pipes = {worker.pipe: worker for worker in workers}
            ready = [pipes[pipe] for pipe in multiprocessing.connection.wait(list(pipes), timeout=1.0)]
            for worker in workers:
                row = None
                if worker in ready:
                    row = worker.receive()
                elif time.monotonic() - worker.began > limit:
                    row = worker.lost(f"no end within {limit:g} s")
                if row is not None:
                    yield row
            workers = [worker for worker in workers if worker.left]


def digest() -> str:
    """Return the digest of what makes and reads the mutants."""
    return hashlib.sha256(b"".join((HERE / name).read_bytes() for name in SPACE)).hexdigest()[:12]


def outcome(rows: list[dict[str, Any]], seed: int) -> dict[str, Any]:
    """Return the summary of all rows."""
    kinds = Counter(row["kind"] for row in rows)
    answers = Counter(f"{row['kind']}: {answer}" for row in rows for answer in row["answers"])
    made = Counter(row["how"].rpartition(" ")[2] for row in rows)
    return {
        "command": f"tests/tools/mutate.py --seed {seed} --count {len(rows)}",
        "seed": seed,
        "space": digest(),
        "versions": {name: importlib.metadata.version(name) for name in ("screwsim", *PACKAGES)}
        | {"python": platform.python_version()},
        "files": len(rows),
        "kinds": dict(sorted(kinds.items())),
        "changes": dict(sorted(made.items())),
        "answers": dict(sorted(answers.items())),
        "memory_limit_MB": MEMORY // 1_000_000,
        "wrong": {row["number"]: row["wrong"] for row in rows if row["wrong"]},
    }


def asked() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=2400, help="files")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds that the reading of a file may take")
    parser.add_argument("--only", type=int, help="number of the one file to read")
    parser.add_argument("--rows", type=Path, help="file of the rows (default: none is kept)")
    parser.add_argument("--outcome", type=Path, help="file of the summary")
    return parser.parse_args()


def kept(path: Path | None) -> list[dict[str, Any]]:
    """Return the rows of a file; none where there is none."""
    if path is None or not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def main() -> int:
    """Read the mutants and sum up; return 1 where anything is wrong."""
    options = asked()
    numbers = list(range(options.first, options.count)) if options.only is None else [options.only]
    rows, started = kept(options.rows), time.monotonic()
    numbers = sorted(set(numbers).difference(row["number"] for row in rows))
    for row in rows_of(numbers, options.jobs, options.seed, options.limit):
        rows.append(row)
        if options.rows is not None:
            with options.rows.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
        if row["wrong"] or options.only is not None:
            print(json.dumps(row, indent=1))
        if len(rows) % 100 == 0:
            bad = sum(bool(each["wrong"]) for each in rows)
            print(f"{len(rows)} files, {time.monotonic() - started:.0f} s, {bad} wrong", file=sys.stderr)
    summary = outcome(sorted(rows, key=lambda row: row["number"]), options.seed)
    if options.outcome:
        options.outcome.write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({name: summary[name] for name in ("files", "kinds", "answers")}, indent=1))
    print(f"{len(summary['wrong'])} wrong; peak {max(row['peak_MB'] for row in rows)} MB", file=sys.stderr)
    return 1 if summary["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
