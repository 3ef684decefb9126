"""Solve random scenes of the whole scene space and store what became of them. Run: fuzz.py [--count 20000] [--jobs 2].

Writes `fuzz-SEED-SPACE.csv`, one row a scene, and goes on where it holds scenes already; `--outcome FILE` sums up all
its rows: counts per status and structure, the worst balances, errors and counts of evaluations, the scenes that are
neither ok, refused nor failed. The scene space is that of `fuzz_space.py`. A share of the scenes that are ok
is solved again by coupled chambers under scipy's Radau. Each worker is a process: one that dies, or takes longer with a
scene than `--limit`, costs that scene only.
"""

from __future__ import annotations

import argparse
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
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
SPACE = Path(__file__).with_name("fuzz_space.py")
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
import fuzz_space  # noqa: E402
import scenes  # noqa: E402
from judging import finite  # noqa: E402

from screwsim.errors import relative_errors  # noqa: E402
from screwsim.estimate import worst  # noqa: E402
from screwsim.faults import SceneError  # noqa: E402
from screwsim.outputs import Figures, Result  # noqa: E402
from screwsim.scene import Scene  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

COLUMNS = (
    "index",
    "structure",
    "status",
    "closing",
    "needed",
    "rhs_evaluations",
    "mass",
    "energy",
    "entropy",
    "accuracy",
    "error",
    "radau",
    "radau_figure",
    "seconds",
    "message",
)
TRY = "the cycle closed only with "
NO_ANSWER = "no answer"  # of Radau
PACKAGES = ("numpy", "scipy", "numba", "coolprop")
PER_GAS = ("oil_ratio", "oil_flow_ratio")  # oil figures over the gas, which next to no oil leaves open


def against_radau(scene: Scene, result: Result) -> tuple[str, float | str]:
    """Return the figure that differs most from coupled chambers under a tight Radau, and by how much."""
    accuracy = scene.numerics.accuracy
    tight = {"accuracy": 0.01 * accuracy, "rtol": 1e-3 * accuracy, "integrator": "scipy-radau", "closing": "coupled"}
    radau = simulate(replace(scene, numerics=replace(scene.numerics, **tight)), trace=False)
    if radau.status != "ok":
        return "", NO_ANSWER
    errors = relative_errors(result.performance, radau.performance)
    if (radau.balance.get("oil_mass") or 0.0) > accuracy:  # next to no oil, which Radau's cycle has not settled
        errors = Figures({name: size for name, size in errors.items() if name not in PER_GAS})
    return worst(errors)


def one(index: int, seed: int) -> tuple[dict[str, Any], Scene | None, Result | None]:
    """Return the row of one scene, and what it was; what crashes has the status `crashed`."""
    structure, shares = fuzz_space.drawn(seed, index)
    row = dict.fromkeys(COLUMNS) | {"index": index, "structure": structure}
    scene = result = None
    started = time.monotonic()
    try:
        scene = scenes.make(fuzz_space.changes(structure, shares))
        row["accuracy"] = scene.numerics.accuracy
        result = simulate(scene)
        row |= {"status": result.status, "message": result.message, "closing": result.numerics.get("closing")}
        row["needed"] = "; ".join(text.removeprefix(TRY) for text in result.warnings if text.startswith(TRY))
        row["rhs_evaluations"] = result.numerics.rhs_evaluations
        row |= {name: result.balance.get(name) for name in ("mass", "energy", "entropy")}
        row["error"] = worst(result.error)[1]
        if not finite(result):
            row["status"] = "not finite"
    except SceneError as fault:
        row |= {"status": "refused", "message": str(fault)}
    except Exception:  # noqa: BLE001  what is looked for
        row |= {"status": "crashed", "message": traceback.format_exc(limit=-2)}
    return row | {"seconds": round(time.monotonic() - started, 3)}, scene, result


def work(pipe: Any, indices: list[int], seed: int, check: int) -> None:
    """Solve scenes and send (index, row) of each, the row None when it is begun."""
    for index in indices:
        pipe.send((index, None))
        row, scene, result = one(index, seed)
        if check and index % check == 0 and row["status"] == "ok" and scene and result:
            pipe.send((index, row | {"radau": NO_ANSWER}))  # what is known, should Radau not come back
            row["radau_figure"], row["radau"] = against_radau(scene, result)
        pipe.send((index, row))
    pipe.close()


class Worker:
    """One process that solves its scenes in turn, by the `work` of a search, which names their structure, too."""

    def __init__(self, indices: list[int], seed: int, check: int, search: Any) -> None:
        self.indices, self.seed, self.check, self.search = indices, seed, check, search
        self.row: dict[str, Any] | None = None
        self._start(indices)

    def _start(self, indices: list[int]) -> None:
        self.at, self.began = None, time.monotonic()
        self.pipe, far = multiprocessing.Pipe(duplex=False)
        self.process = multiprocessing.Process(
            target=self.search.work, args=(far, indices, self.seed, self.check), daemon=True
        )
        self.process.start()
        far.close()

    def receive(self) -> dict[str, Any] | None:
        """Return the row of a finished scene, if one was; the row of the scene at which the process died."""
        try:
            index, row = self.pipe.recv()
        except EOFError:
            return self.lost("crashed", "the process died")
        if index != self.at:
            done, self.row = self.row, None
            self.at, self.began = index, time.monotonic()
            return done
        self.row = row
        return None

    def lost(self, status: str, message: str) -> dict[str, Any] | None:
        """Return the row of the scene at hand, which has no end, and go on with the next in a new process."""
        self.process.kill()
        self.process.join()
        done, self.row = self.row, None
        if self.at is None:
            raise RuntimeError("a worker did not start")
        left = self.indices[self.indices.index(self.at) + 1 :]
        if done is None:
            structure = self.search.structure_of(self.seed, self.at)
            done = dict.fromkeys(self.search.COLUMNS) | {"index": self.at, "structure": structure}
            done |= {"status": status, "message": message}
        self.indices = left
        if left:
            self._start(left)
        return done


def structure_of(seed: int, index: int) -> str:
    """Return the structure of a scene."""
    return fuzz_space.drawn(seed, index)[0]


def rows_of(
    indices: list[int], jobs: int, seed: int, check: int, limit: float, search: Any = None
) -> Iterator[dict[str, Any]]:
    """Yield the rows of scenes as they come; one that takes longer than `limit` [s] has the status `hung`.

    `search` is the module whose scenes they are; this one where none is given.
    """
    search = search or sys.modules[__name__]
    workers = [Worker(indices[i::jobs], seed, check, search) for i in range(min(jobs, len(indices)))]
    while workers:
        pipes = {worker.pipe: worker for worker in workers}
        ready = [pipes[pipe] for pipe in multiprocessing.connection.wait(list(pipes), timeout=1.0)]
        for worker in workers:
            if worker in ready:
                row = worker.receive()
            elif time.monotonic() - worker.began > limit:
                row = worker.lost("hung", f"no end within {limit:g} s")
            else:
                continue
            if row is not None:
                yield row
        workers = [worker for worker in workers if worker.indices]


def read(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a table, numbers as numbers."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [{name: number(text) for name, text in row.items()} for row in csv.DictReader(file)]


def number(text: str) -> Any:
    """Return a number where the text is one, None where there is none."""
    try:
        return int(text)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        return text or None


def largest(rows: Iterable[dict[str, Any]], key: str) -> dict[str, Any]:
    """Return value and index of the row with the largest number of a column."""
    row = max((row for row in rows if isinstance(row[key], (int, float))), key=lambda row: row[key], default=None)
    return {"value": row[key], "index": row["index"]} if row else {}


def outcome(rows: list[dict[str, Any]], seed: int, check: int) -> dict[str, Any]:
    """Return the summary of all rows."""
    by_structure: dict[str, Counter[str]] = defaultdict(Counter)
    for row in rows:
        by_structure[row["structure"]][row["status"]] += 1
    closed = [row for row in rows if row["status"] == "ok"]
    compared = [row for row in rows if isinstance(row["radau"], (int, float))]
    shares = [row | {"share": row["radau"] / row["accuracy"]} for row in compared]
    unwarned = [row for row in shares if row["error"] <= row["accuracy"]]
    balances = [row | {"over": max(row["mass"], row["energy"]) / row["accuracy"]} for row in closed]
    return {
        "command": f"tests/tools/fuzz.py --seed {seed} --count {len(rows)} --check {check}",
        "seed": seed,
        "space": space(),
        "versions": {name: importlib.metadata.version(name) for name in ("screwsim", *PACKAGES)}
        | {"python": platform.python_version()},
        "scenes": len(rows),
        "status": dict(Counter(row["status"] for row in rows)),
        "structure": {name: dict(by_structure[name]) for name in fuzz_space.STRUCTURES if name in by_structure},
        "further_tries": dict(Counter(row["needed"] for row in rows if row["needed"])),
        "ok_above_accuracy": sum(row["error"] > row["accuracy"] for row in closed if row["error"] is not None),
        "worst_mass": largest(closed, "mass"),
        "worst_energy": largest(closed, "energy"),
        "worst_balance_over_accuracy": largest(balances, "over"),
        "worst_rhs_evaluations": largest(rows, "rhs_evaluations"),
        "worst_rhs_evaluations_of_ok": largest(closed, "rhs_evaluations"),
        "radau": {
            "compared": len(compared),
            "no_answer": sum(row["radau"] == NO_ANSWER for row in rows),
            "within_accuracy": sum(row["share"] <= 1.0 for row in shares),
            "within_three_times": sum(row["share"] <= 3.0 for row in shares),
            "beyond_accuracy_unwarned": sum(row["share"] > 1.0 for row in unwarned),
            "beyond_three_times_unwarned": [row["index"] for row in unwarned if row["share"] > 3.0],
            "worst_unwarned_over_accuracy": largest(unwarned, "share"),
            "worst_over_accuracy": largest(shares, "share"),
        },
        "not_ok": {
            status: [row["index"] for row in rows if row["status"] == status]
            for status in sorted({row["status"] for row in rows} - {"ok", "refused", "failed"})
        },
    }


def space() -> str:
    """Return the digest of the scene space, which tells tables of different spaces apart."""
    return hashlib.sha256(SPACE.read_bytes()).hexdigest()[:12]


def asked() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20_000, help="scenes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--check", type=int, default=150, help="every n-th scene is checked against Radau; 0: none")
    parser.add_argument("--limit", type=float, default=900.0, help="seconds that a scene may take")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results", help="folder of the table")
    parser.add_argument("--outcome", type=Path, help="file of the summary")
    return parser.parse_args()


def append(table: Path, columns: Sequence[str], rows: Iterable[dict[str, Any]], begun: bool, every: int) -> None:
    """Append rows to a table, begun or not, as they come; tell on stderr what came after each so many."""
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


def main() -> None:
    """Solve the scenes that the table lacks and sum it up."""
    options = asked()
    options.output.mkdir(parents=True, exist_ok=True)
    table = options.output / f"fuzz-{options.seed}-{space()}.csv"
    there = {row["index"] for row in read(table)}
    todo = [index for index in range(options.count) if index not in there]
    found = rows_of(todo, options.jobs, options.seed, options.check, options.limit)
    append(table, COLUMNS, found, begun=bool(there), every=100)
    rows = sorted((row for row in read(table) if row["index"] < options.count), key=lambda row: row["index"])
    summary = outcome(rows, options.seed, options.check)
    if options.outcome:
        options.outcome.write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({name: summary[name] for name in ("scenes", "status", "structure", "radau")}, indent=1))


if __name__ == "__main__":
    main()
