"""Solve random scenes that hold all effects between them, and store what became of them. Run: fuzz_effects.py.

The scenes are those of `tests/tools/effects_space.py`: few structures, as each is compiled, many numbers for each. It
asks what `fuzz.py` asks of its own space: that nothing crashes or hangs, that figures are finite and balances close.
And it asks whether estimates hold: the true error of every third scene that is ok (`--check`) is asked of the function
that `accuracy_kept.py` asks, by coupled chambers at a fiftieth of the wanted accuracy and finer, until two solutions
differ by at most a tenth of it; where none do, nothing is known. Writes `fuzz-effects-SEED-SPACE.csv` and goes on where
it holds scenes already; `--outcome FILE` sums up all its rows.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.metadata
import json
import platform
import sys
import time
import traceback
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
SPACE = Path(__file__).with_name("effects_space.py")
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
import effects_space  # noqa: E402
import fuzz  # noqa: E402
from judging import finite  # noqa: E402

from screwsim.estimate import worst  # noqa: E402
from screwsim.faults import SceneError  # noqa: E402
from screwsim.outputs import Result  # noqa: E402
from screwsim.scene import Scene  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402
from screwsim.study.accuracy.kept import true_error, warns  # noqa: E402

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


def one(index: int, seed: int) -> tuple[dict[str, Any], Scene | None, Result | None]:
    """Return the row of one scene, and what it was; what crashes has the status `crashed`."""
    structure, number = effects_space.structure_of(index)
    row = dict.fromkeys(COLUMNS) | {"index": index, "structure": structure}
    scene = result = None
    started = time.monotonic()
    try:
        scene = effects_space.scene_of(structure, seed, number)
        row["accuracy"] = scene.numerics.accuracy
        result = simulate(scene)
        row |= {"status": result.status, "message": result.message, "closing": result.numerics.get("closing")}
        row["needed"] = "; ".join(text.removeprefix(fuzz.TRY) for text in result.warnings if text.startswith(fuzz.TRY))
        row["rhs_evaluations"] = result.numerics.rhs_evaluations
        row |= {name: result.balance.get(name) for name in ("mass", "energy")}
        row["error"] = worst(result.error)[1]
        row["warned"] = int(warns(result))
        if not finite(result):
            row["status"] = "not finite"
    except SceneError as fault:
        row |= {"status": "refused", "message": str(fault)}
    except Exception:  # noqa: BLE001  what is looked for
        row |= {"status": "crashed", "message": traceback.format_exc(limit=-2)}
    return row | {"seconds": round(time.monotonic() - started, 3)}, scene, result


def checked(index: int, check: int) -> bool:
    """Tell whether the true error of a scene is asked for: of each structure every so many scenes."""
    return bool(check) and effects_space.structure_of(index)[1] % check == 0


def work(pipe: Any, indices: list[int], seed: int, check: int) -> None:
    """Solve scenes and send (index, row) of each, the row None when it is begun."""
    for index in indices:
        pipe.send((index, None))
        row, scene, result = one(index, seed)
        if checked(index, check) and row["status"] == "ok" and scene and result:
            pipe.send((index, row | {"true": NO_ANSWER}))  # what is known, should the finer ones not come back
            known, row["true_figure"], true = true_error(scene, result)
            row["true"] = true if known == "ok" else NO_ANSWER
        pipe.send((index, row))
    pipe.close()


def structure_of(seed: int, index: int) -> str:
    """Return the structure of a scene."""
    return effects_space.structure_of(index)[0]


def outcome(rows: list[dict[str, Any]], seed: int, each: int, check: int) -> dict[str, Any]:
    """Return the summary of all rows."""
    by_structure: dict[str, Counter[str]] = defaultdict(Counter)
    for row in rows:
        by_structure[row["structure"]][row["status"]] += 1
    closed = [row for row in rows if row["status"] == "ok"]
    compared = [row | {"share": row["true"] / row["accuracy"]} for row in rows if isinstance(row["true"], float)]
    told = [row for row in compared if row["share"] <= 1.0 or row["warned"]]
    unwarned = [row for row in compared if not row["warned"]]
    return {
        "command": f"tests/tools/fuzz_effects.py --seed {seed} --each {each} --check {check}",
        "seed": seed,
        "space": space(),
        "versions": {name: importlib.metadata.version(name) for name in ("screwsim", *fuzz.PACKAGES)}
        | {"python": platform.python_version()},
        "effects": sorted(effects_space.effects_drawn()),
        "scenes": len(rows),
        "status": dict(Counter(row["status"] for row in rows)),
        "structure": {name: dict(by_structure[name]) for name in effects_space.STRUCTURES if name in by_structure},
        "warned": sum(bool(row["warned"]) for row in closed),
        "worst_balance_over_accuracy": fuzz.largest(
            [row | {"over": max(row["mass"], row["energy"]) / row["accuracy"]} for row in closed], "over"
        ),
        "worst_rhs_evaluations": fuzz.largest(rows, "rhs_evaluations"),
        "true": {
            "compared": len(compared),
            "no_answer": sum(row["true"] == NO_ANSWER for row in rows),
            "within_or_warned": len(told),
            "beyond_three_times_unwarned": [row["index"] for row in unwarned if row["share"] > 3.0],
            "beyond_accuracy_unwarned": [row["index"] for row in unwarned if row["share"] > 1.0],
            "worst_unwarned_over_accuracy": fuzz.largest(unwarned, "share"),
            "true_over_estimate": _quantiles([row["true"] / row["error"] for row in unwarned if row["error"]]),
        },
        "not_ok": {
            status: [row["index"] for row in rows if row["status"] == status]
            for status in sorted({row["status"] for row in rows} - {"ok", "refused", "failed"})
        },
    }


def _quantiles(values: list[float]) -> dict[str, float]:
    ordered = sorted(values)
    at = {"median": 0.5, "of 95 %": 0.95, "most": 1.0}
    return {name: float(f"{ordered[round(share * (len(ordered) - 1))]:.3g}") for name, share in at.items() if ordered}


def space() -> str:
    """Return the digest of the scene space, which tells tables of different spaces apart."""
    return hashlib.sha256(SPACE.read_bytes()).hexdigest()[:12]


def _turn(index: int, jobs: int) -> tuple[int, int, int]:
    """Return when a scene is due: so that every job, which takes each of so many, has the structures by turns."""
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
    there = {row["index"] for row in fuzz.read(table)}
    wanted = [
        i
        for i in range(effects_space.EACH * len(effects_space.STRUCTURES))
        if effects_space.structure_of(i)[1] < options.each
    ]
    todo = sorted((i for i in wanted if i not in there), key=lambda i: _turn(i, options.jobs))
    search = sys.modules[__name__]
    found = fuzz.rows_of(todo, options.jobs, options.seed, options.check, options.limit, search)
    fuzz.append(table, COLUMNS, found, begun=bool(there), every=effects_space.EACH)
    rows = sorted((row for row in fuzz.read(table) if row["index"] in set(wanted)), key=lambda row: row["index"])
    summary = outcome(rows, options.seed, options.each, options.check)
    if options.outcome:
        options.outcome.write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({name: summary[name] for name in ("scenes", "status", "true", "not_ok")}, indent=1))


if __name__ == "__main__":
    main()
