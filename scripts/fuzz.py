"""Solve many random scenes and store what became of them: .venv/bin/python scripts/fuzz.py [--count 20000] [--seed 1].

Writes `results/fuzz.json` (seed, counts per status, worst closure, worst count of evaluations, scenes that did not
close) and `results/fuzz.csv` (one row a scene). The scene space is that of `tests/hard/fuzz_space.py`. A share of the
scenes that are ok is solved again by coupled chambers under scipy's Radau and must agree.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import time
import traceback
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests" / "hard"), str(ROOT / "tests" / "laws")]
import fuzz_space  # noqa: E402
import scenes  # noqa: E402

from screwsim.errors import relative_errors  # noqa: E402
from screwsim.estimate import worst  # noqa: E402
from screwsim.outputs import Result  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

COLUMNS = ("index", "structure", "status", "closing", "rhs_evaluations", "mass", "energy", "error", "radau", "message")


def finite(result: Result) -> bool:
    """Tell whether every number of a result is finite and every pressure, temperature and mass positive."""
    tables = (result.performance, result.balance, result.error, result.ledger, result.numerics)
    numbers = [value for table in tables for value in table.values() if isinstance(value, float)]
    traces = [trace for name, trace in result.cycle.items() if name != "oil_temperature"]
    positive = [result.cycle[name] for name in ("pressure", "gas_temperature", "gas_mass") if name in result.cycle]
    return bool(
        np.all(np.isfinite(numbers))
        and all(np.all(np.isfinite(trace)) for trace in traces)
        and all(np.all(trace > 0.0) for trace in positive)
    )


def against_radau(scene: Any, result: Result) -> float:
    """Return the largest relative difference of a figure from coupled chambers under a tight Radau."""
    numerics = replace(scene.numerics, accuracy=1e-6, rtol=1e-8, closing="coupled", integrator="scipy-radau")
    radau = simulate(replace(scene, numerics=numerics), trace=False)
    return worst(relative_errors(result.performance, radau.performance))[1] if radau.status == "ok" else float("nan")


def one(index: int, seed: int, check: bool) -> dict[str, Any]:
    """Return the row of one scene; what crashes has the status `crashed`."""
    random = np.random.default_rng((seed, index))
    structure = list(fuzz_space.STRUCTURES)[random.integers(len(fuzz_space.STRUCTURES))]
    row = dict.fromkeys(COLUMNS) | {"index": index, "structure": structure}
    try:
        scene = scenes.make(fuzz_space.changes(structure, random.random(len(fuzz_space.RANGES))))
        result = simulate(scene)
        row |= {"status": result.status, "message": result.message, "closing": result.numerics.closing}
        row["rhs_evaluations"] = result.numerics.rhs_evaluations
        row |= {name: result.balance.get(name) for name in ("mass", "energy")}
        row["error"] = worst(result.error)[1]
        if not finite(result):
            row["status"] = "not finite"
        elif check and result.status == "ok":
            row["radau"] = against_radau(scene, result)
    except Exception:  # noqa: BLE001  what is looked for
        row |= {"status": "crashed", "message": traceback.format_exc(limit=-2)}
    return row


def main() -> None:
    """Solve the scenes and store what became of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20_000, help="scenes")
    parser.add_argument("--first", type=int, default=0, help="index of the first scene")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--check", type=int, default=200, help="every n-th scene is checked against Radau; 0: none")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results")
    asked = parser.parse_args()
    asked.output.mkdir(parents=True, exist_ok=True)
    rows, started = [], time.monotonic()
    with (asked.output / "fuzz.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        for index in range(asked.first, asked.first + asked.count):
            rows.append(one(index, asked.seed, asked.check > 0 and index % asked.check == 0))
            table.writerow(rows[-1])
            file.flush()
            if len(rows) % 100 == 0:
                shown = dict(Counter(row["status"] for row in rows))
                print(f"{len(rows)} scenes, {time.monotonic() - started:.0f} s: {shown}", file=sys.stderr)
    closed = [row for row in rows if row["status"] == "ok"]
    compared = [row for row in rows if row["radau"] is not None]
    summary = {
        "seed": asked.seed,
        "first": asked.first,
        "scenes": len(rows),
        "seconds": round(time.monotonic() - started, 1),
        "status": dict(Counter(row["status"] for row in rows)),
        "worst_mass": max(closed, key=lambda row: row["mass"], default=None),
        "worst_energy": max(closed, key=lambda row: row["energy"], default=None),
        "worst_rhs_evaluations": max(rows, key=lambda row: row["rhs_evaluations"] or 0, default=None),
        "checked_against_radau": len(compared),
        "worst_against_radau": max(compared, key=lambda row: row["radau"], default=None),
        "not_ok": [row for row in rows if row["status"] != "ok"],
    }
    (asked.output / "fuzz.json").write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({name: summary[name] for name in ("scenes", "seconds", "status")}))


if __name__ == "__main__":
    main()
