"""Solve random scenes of the whole scene space and store what became of them. Run: fuzz.py [--count 20000] [--jobs 2].

Writes `fuzz-SEED-SPACE.csv`, one row per scene, and skips scenes that it holds already; `--outcome FILE` sums up all
its rows: counts per status and structure, the worst balances, errors and counts of evaluations, the scenes that are
neither ok, refused nor failed. The scene space is that of `fuzz_space.py`. A share of the scenes that are ok is solved
again by coupled chambers under scipy's Radau. Each worker is a process: if it dies, or takes longer than `--limit` for
a scene, only that scene is lost.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
import fluid_space  # noqa: E402
import fuzz_space  # noqa: E402
import scenes  # noqa: E402
import search  # noqa: E402
from search import Row, largest  # noqa: E402

from screwsim.figures.errors import relative_errors, worst  # noqa: E402
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
SPACES: dict[str, Any] = {"fuzz_space": fuzz_space, "fluid_space": fluid_space}
FILES = {"fuzz_space": ("fuzz_space.py",), "fluid_space": ("fluid_space.py", "fuzz_space.py")}
FIRST = "fuzz_space"
NO_ANSWER = "no answer"  # of Radau
UNEXPLAINED = "check port areas"  # in the message of an integration that stopped for an unknown reason
PACKAGES = ("numpy", "scipy", "llvmlite", "coolprop")
PER_GAS = ("oil_ratio", "oil_flow_ratio")  # oil figures relative to the gas, undetermined with next to no oil


def against_radau(scene: Scene, result: Result) -> tuple[str, float | str]:
    """Return the figure that differs most from coupled chambers under a tight Radau, and by how much."""
    accuracy = scene.numerics.accuracy
    tight = {"accuracy": 0.01 * accuracy, "rtol": 1e-3 * accuracy, "integrator": "scipy-radau", "closing": "coupled"}
    radau = simulate(replace(scene, numerics=replace(scene.numerics, **tight)), trace=False)
    if radau.status != "ok":
        return "", NO_ANSWER
    errors = relative_errors(result.performance, radau.performance)
    if (radau.balance.get("oil_mass") or 0.0) > accuracy:  # next to no oil, for which Radau's cycle has not converged
        errors = Figures({name: size for name, size in errors.items() if name not in PER_GAS})
    return worst(errors)


def one(index: int, seed: int, drawn_from: str = FIRST) -> tuple[Row, Scene | None, Result | None]:
    """Return the row of one scene, the scene and its result."""
    of = SPACES[drawn_from]
    structure, shares = of.drawn(seed, index)
    row = dict.fromkeys(COLUMNS) | {"index": index, "structure": structure}
    return search.solved(row, lambda: scenes.make(of.changes(structure, shares)))


def work(pipe: Any, indices: list[int], seed: int, check: int, drawn_from: str) -> None:
    """Solve scenes and send (index, None) at the beginning of each, (index, row) at its end."""
    for index in indices:
        pipe.send((index, None))
        row, scene, result = one(index, seed, drawn_from)
        if check and index % check == 0 and row["status"] == "ok" and scene and result:
            pipe.send((index, row | {"radau": NO_ANSWER}))  # the known part, should Radau not return
            row["radau_figure"], row["radau"] = against_radau(scene, result)
        pipe.send((index, row))
    pipe.close()


def lost(index: int, status: str, message: str, seed: int, drawn_from: str) -> Row:
    """Return the row of a scene that ended its process or hung."""
    row = {"index": index, "structure": SPACES[drawn_from].drawn(seed, index)[0], "status": status, "message": message}
    return dict.fromkeys(COLUMNS) | row


def rows_of(
    indices: list[int], jobs: int, seed: int, check: int, limit: float, drawn_from: str = FIRST
) -> Iterator[Row]:
    """Yield the rows of scenes as they come; one that takes longer than `limit` [s] has the status `hung`."""
    begun = partial(work, seed=seed, check=check, drawn_from=drawn_from)
    yield from search.rows_of(indices, jobs, limit, begun, partial(lost, seed=seed, drawn_from=drawn_from))


def outcome(rows: list[Row], seed: int, check: int, drawn_from: str = FIRST) -> Row:
    """Return the summary of all rows."""
    closed = [row for row in rows if row["status"] == "ok"]
    compared = [row for row in rows if isinstance(row["radau"], (int, float))]
    shares = [row | {"share": row["radau"] / row["accuracy"]} for row in compared]
    unwarned = [row for row in shares if row["error"] <= row["accuracy"]]
    of = "" if drawn_from == FIRST else f"--space {drawn_from} "
    command = f"{of}--seed {seed} --count {len(rows)} --check {check}"
    balances = [row | {"over": max(row["mass"], row["energy"]) / row["accuracy"]} for row in closed]
    return {
        **search.made(f"fuzz.py {command}", seed, space(drawn_from), PACKAGES),
        **search.statuses(rows, SPACES[drawn_from].STRUCTURES),
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
        "not_ok": search.not_ok(rows),
        "unexplained": [row["index"] for row in rows if row["status"] == "failed" and UNEXPLAINED in row["message"]],
    }


def space(drawn_from: str = FIRST) -> str:
    """Return the digest of the scene space, which tells tables of different spaces apart."""
    return search.digest(*(HERE / name for name in FILES[drawn_from]))


def asked() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20_000, help="scenes")
    parser.add_argument("--space", default=FIRST, choices=sorted(SPACES), help="what scenes are drawn from")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--check", type=int, default=150, help="every n-th scene is checked against Radau; 0: none")
    parser.add_argument("--limit", type=float, default=900.0, help="seconds that a scene may take")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results", help="folder of the table")
    parser.add_argument("--outcome", type=Path, help="file of the summary")
    return parser.parse_args()


def main() -> None:
    """Solve the scenes that the table lacks and sum it up."""
    options = asked()
    options.output.mkdir(parents=True, exist_ok=True)
    table = options.output / f"fuzz-{options.seed}-{space(options.space)}.csv"
    there = {row["index"] for row in search.read(table)}
    todo = [index for index in range(options.count) if index not in there]
    found = rows_of(todo, options.jobs, options.seed, options.check, options.limit, options.space)
    search.append(table, COLUMNS, found, begun=bool(there), every=100)
    rows = sorted((row for row in search.read(table) if row["index"] < options.count), key=lambda row: row["index"])
    summary = outcome(rows, options.seed, options.check, options.space)
    search.tell(summary, options.outcome, ("scenes", "status", "structure", "radau"))


if __name__ == "__main__":
    main()
