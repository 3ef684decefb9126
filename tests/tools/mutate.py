"""Read mutated files and store what became of them. Run: mutate.py [--count 2400] [--seed 1] [--jobs 2].

Results files, scenes, fits, tables and parts of sweeps (tests/tools/mutate_space.py) are changed at random and read as
the commands read them, each in a worker process with limited memory and time. Required: an answer in one line, no
internal error, no crash, no hang, no warning of a library, nothing executed, and nothing disclosed that the file does
not hold. `--rows FILE` keeps a line per mutant, and mutants that it holds already are skipped; `--outcome FILE` stores
the counts of all of them; `--only N` reads one mutant and prints how that ended.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
SPACE = ("mutate_space.py", "mutate_hdf5.py", "mutate_text.py")
sys.path.insert(0, str(HERE))
import mutate_space  # noqa: E402
import search  # noqa: E402

MEMORY = 1_500_000_000  # [byte] that a worker may use in addition to its initial memory
PACKAGES = ("numpy", "h5py", "ruamel.yaml", "matplotlib")


def _size() -> int:
    """Return the size of this process's address space [byte]."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()


def work(pipe: Any, numbers: list[int], folder: Path, seed: int) -> None:
    """Read mutants and send (number, None) at the beginning of each, (number, row) at its end."""
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


def lost(number: int, status: str, what: str) -> dict[str, Any]:
    """Return the row of a mutant that ended its process or hung."""
    kind = mutate_space.KINDS[number % len(mutate_space.KINDS)]
    return row_of(number, kind, f"{kind} ?", (), (what,)) | {"peak_MB": 0}


def rows_of(numbers: list[int], jobs: int, seed: int, limit: float) -> Iterator[dict[str, Any]]:
    """Yield the rows of mutants as they come; one that takes longer than `limit` [s] has hung."""
    with tempfile.TemporaryDirectory(prefix="screwsim-mutate-") as name:
        folder = Path(name)
        mutate_space.furnish(folder / "files")
        mutate_space.make_light()
        yield from search.rows_of(numbers, jobs, limit, partial(work, folder=folder, seed=seed), lost)


def digest() -> str:
    """Return the digest of the files that make and read the mutants."""
    return search.digest(*(HERE / name for name in SPACE))


def outcome(rows: list[dict[str, Any]], seed: int) -> dict[str, Any]:
    """Return the summary of all rows."""
    kinds = Counter(row["kind"] for row in rows)
    answers = Counter(f"{row['kind']}: {answer}" for row in rows for answer in row["answers"])
    made = Counter(row["how"].rpartition(" ")[2] for row in rows)
    return {
        **search.made(f"mutate.py --seed {seed} --count {len(rows)}", seed, digest(), PACKAGES),
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
    """Return the rows of a file; none where it does not exist."""
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
    search.tell(summary, options.outcome, ("files", "kinds", "answers"))
    print(f"{len(summary['wrong'])} wrong; peak {max(row['peak_MB'] for row in rows)} MB", file=sys.stderr)
    return 1 if summary["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
