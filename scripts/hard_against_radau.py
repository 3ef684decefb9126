"""Solve every hard case that is ok again by coupled chambers under scipy's Radau, and store how far the two differ.

Run: hard_against_radau.py [--limit 60]. `tests/hard` does it for some; this script for the others, each
within `--limit` seconds of processor time. `tests/hard/against_radau.json` holds a row a case: the larger relative
difference of work and trapped mass, and the accuracy that was asked for; or why Radau gave no answer. It goes on where
it holds cases already.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests" / "hard"), str(ROOT / "tests" / "laws")]
from case import Case  # noqa: E402
from hard_page import RADAU, to_compare  # noqa: E402
from judging import Stopped, limited  # noqa: E402
from scenes import make  # noqa: E402

from screwsim.errors import relative_errors  # noqa: E402
from screwsim.numerics.store import write_atomically  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

TIGHT = {"integrator": "scipy-radau", "closing": "coupled"}
FINER, OF_STEPS = 1e-2, 1e-3  # accuracy and tolerance of a step of Radau, over the case's accuracy


def read() -> dict[str, Any]:
    """Return what is stored."""
    return json.loads(RADAU.read_text(encoding="utf-8")) if RADAU.exists() else {}


def compared(case: Case, limit: float) -> dict[str, Any]:
    """Return the row of a case."""
    scene = make(case.changes)
    accuracy = scene.numerics.accuracy
    found = simulate(scene, trace=False)
    tight = {"accuracy": FINER * accuracy, "rtol": OF_STEPS * accuracy, **TIGHT}
    changes = {path: value for path, value in case.changes.items() if not path.startswith("numerics")}
    try:
        with limited(limit):
            radau = simulate(make({**changes, "numerics": tight}), trace=False)
    except Stopped:
        return {"accuracy": accuracy, "no_answer": f"not within {limit:g} s of processor time"}
    if radau.status != "ok":
        return {"accuracy": accuracy, "no_answer": radau.status}
    errors = relative_errors(found.performance, radau.performance)
    return {"accuracy": accuracy, "difference": max(errors.work_per_cycle, errors.trapped_mass)}


def main() -> None:
    """Compare what is not stored yet."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--limit", type=float, default=60.0, help="seconds of processor time that Radau may take")
    asked = parser.parse_args()
    for case in to_compare():
        if case.name in read():
            continue
        row = compared(case, asked.limit)
        print(case.name, row, flush=True)
        rows = read() | {case.name: row}
        write_atomically(RADAU, (json.dumps(rows, indent=1, ensure_ascii=False, sort_keys=True) + "\n").encode())


if __name__ == "__main__":
    main()
