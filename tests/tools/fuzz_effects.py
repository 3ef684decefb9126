"""Solve random scenes that hold all effects between them, and store what became of them. Run: fuzz_effects.py.

The scenes are those of `tests/tools/effects_space.py`: few structures, as each is compiled, many numbers for each. It
checks the same as `fuzz.py` for its own space: that nothing crashes or hangs, that figures are finite and balances
close. It also checks the error estimates: the true error of every third scene that is ok (`--check`) comes from the
function that `accuracy_kept.py` uses, with coupled chambers at a fiftieth of the wanted accuracy and finer, until two
solutions differ by at most a tenth of it; where none do, it is unknown. Writes `fuzz-effects-SEED-SPACE.csv` and skips
scenes that it holds already; `--outcome FILE` sums up all its rows.
"""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
SPACE = Path(__file__).with_name("effects_space.py")
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
import effects_space  # noqa: E402
import search  # noqa: E402
from fuzz import PACKAGES  # noqa: E402
from search import Row, largest  # noqa: E402
from true_error import ANOTHER, true_error, warns  # noqa: E402

from screwsim.outputs import Result  # noqa: E402
from screwsim.scene import Scene  # noqa: E402

COLUMNS = (
    "index",
    "structure",
    "status",
    "closing",
    "needed",
    "rhs_evaluations",
    "mass",
    "energy",
    "accuracy",
    "error",
    "warned",
    "true",
    "true_figure",
    "seconds",
    "message",
)
NO_ANSWER = "no answer"  # of the finer solutions, or they differ


def one(index: int, seed: int) -> tuple[Row, Scene | None, Result | None]:
    """Return the row of one scene, the scene and its result."""
    structure, number = effects_space.structure_of(index)
    row = dict.fromkeys(COLUMNS) | {"index": index, "structure": structure}
    row, scene, result = search.solved(row, lambda: effects_space.scene_of(structure, seed, number))
    return row | {"warned": int(warns(result, scene.numerics.accuracy)) if scene and result else None}, scene, result


def checked(index: int, check: int) -> bool:
    """Return whether the true error of a scene is computed: for every `check`-th scene of each structure."""
    return bool(check) and effects_space.structure_of(index)[1] % check == 0


def work(pipe: Any, indices: list[int], seed: int, check: int) -> None:
    """Solve scenes and send (index, None) at the beginning of each, (index, row) at its end."""
    for index in indices:
        pipe.send((index, None))
        row, scene, result = one(index, seed)
        if checked(index, check) and row["status"] == "ok" and scene and result:
            pipe.send((index, row | {"true": NO_ANSWER}))  # the known part, should the finer solutions not return
            known, row["true_figure"], true = true_error(scene, result)
            row["true"] = true if known in ("ok", ANOTHER) else NO_ANSWER
            if known == ANOTHER:
                row["true_figure"] = f"{ANOTHER}: {row['true_figure']}"
        pipe.send((index, row))
    pipe.close()


def lost(index: int, status: str, message: str) -> Row:
    """Return the row of a scene that ended its process or hung."""
    row = {"index": index, "structure": effects_space.structure_of(index)[0], "status": status, "message": message}
    return dict.fromkeys(COLUMNS) | row


def outcome(rows: list[Row], seed: int, each: int, check: int) -> Row:
    """Return the summary of all rows."""
    closed = [row for row in rows if row["status"] == "ok"]
    compared = [row | {"share": row["true"] / row["accuracy"]} for row in rows if isinstance(row["true"], float)]
    told = [row for row in compared if row["share"] <= 1.0 or row["warned"]]
    unwarned = [row for row in compared if not row["warned"]]
    return {
        **search.made(f"fuzz_effects.py --seed {seed} --each {each} --check {check}", seed, space(), PACKAGES),
        "effects": sorted(effects_space.effects_drawn()),
        **search.statuses(rows, effects_space.STRUCTURES),
        "warned": sum(bool(row["warned"]) for row in closed),
        "worst_balance_over_accuracy": largest(
            [row | {"over": max(row["mass"], row["energy"]) / row["accuracy"]} for row in closed], "over"
        ),
        "worst_rhs_evaluations": largest(rows, "rhs_evaluations"),
        "true": {
            "compared": len(compared),
            "no_answer": sum(row["true"] == NO_ANSWER for row in rows),
            "another_cycle": [row["index"] for row in rows if str(row["true_figure"]).startswith(ANOTHER)],
            "within_or_warned": len(told),
            "beyond_three_times_unwarned": [row["index"] for row in unwarned if row["share"] > 3.0],
            "beyond_accuracy_unwarned": [row["index"] for row in unwarned if row["share"] > 1.0],
            "worst_unwarned_over_accuracy": largest(unwarned, "share"),
            "true_over_estimate": _quantiles([row["true"] / row["error"] for row in unwarned if row["error"]]),
        },
        "not_ok": search.not_ok(rows),
    }


def _quantiles(values: list[float]) -> dict[str, float]:
    ordered = sorted(values)
    at = {"median": 0.5, "of 95 %": 0.95, "most": 1.0}
    return {name: float(f"{ordered[round(share * (len(ordered) - 1))]:.3g}") for name, share in at.items() if ordered}


def space() -> str:
    """Return the digest of the scene space, which tells tables of different spaces apart."""
    return search.digest(SPACE)


def _turn(index: int, jobs: int) -> tuple[int, int, int]:
    """Return the order in which scenes are due: every job, which takes one of so many, gets the structures in turn."""
    structure, number = divmod(index, effects_space.EACH)
    return structure // jobs, number, structure % jobs


def asked() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--each", type=int, default=effects_space.EACH, help="scenes of each structure, the first ones")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--check", type=int, default=3, help="every n-th scene of a structure is solved finer; 0: none")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds that a scene may take")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results", help="folder of the table")
    parser.add_argument("--outcome", type=Path, help="file of the summary")
    return parser.parse_args()


def main() -> None:
    """Solve the scenes that the table lacks and sum it up."""
    options = asked()
    options.output.mkdir(parents=True, exist_ok=True)
    table = options.output / f"fuzz-effects-{options.seed}-{space()}.csv"
    there = {row["index"] for row in search.read(table)}
    wanted = [
        i
        for i in range(effects_space.EACH * len(effects_space.STRUCTURES))
        if effects_space.structure_of(i)[1] < options.each
    ]
    todo = sorted((i for i in wanted if i not in there), key=lambda i: _turn(i, options.jobs))
    work_on = partial(work, seed=options.seed, check=options.check)
    found = search.rows_of(todo, options.jobs, options.limit, work_on, lost)
    search.append(table, COLUMNS, found, begun=bool(there), every=effects_space.EACH)
    rows = sorted((row for row in search.read(table) if row["index"] in set(wanted)), key=lambda row: row["index"])
    summary = outcome(rows, options.seed, options.each, options.check)
    search.tell(summary, options.outcome, ("scenes", "status", "true", "not_ok"))


if __name__ == "__main__":
    main()
