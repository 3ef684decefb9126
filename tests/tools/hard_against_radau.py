"""Solve every hard case that is ok again by coupled chambers under scipy's Radau, and store how far the two differ.

Run: hard_against_radau.py [--limit 600] [CASE ...]. `tests/hard` does it for some; this script for the others, each
try within `--limit` seconds of processor time. Radau begins from the cold guess as the case itself does; where that
does not close, from the case's own closed cycle, which it has to keep or to leave for its own; then from that cycle
closed more tightly. Where none of these ends the chambers are followed for one life from there, and must come back
within the accuracy; then BDF is asked, and LSODA with coarser steps. `tests/hard/against_radau.json` holds a row a
case: the larger relative difference of work and trapped mass, the accuracy that was asked for, from where which
method closed with what tolerance of a step over that accuracy, and what the last pitch (or the life) still changed.
It goes on where it holds cases already; cases that are named are done again.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
from case import Case  # noqa: E402
from hard_page import COLD, OF_STEPS, RADAU, to_compare  # noqa: E402
from judging import Stopped, limited  # noqa: E402
from scenes import make  # noqa: E402

from screwsim.errors import relative_errors  # noqa: E402
from screwsim.estimate import close_accurately  # noqa: E402
from screwsim.model import close as closing  # noqa: E402
from screwsim.model.residues import LEAST_WORK  # noqa: E402
from screwsim.numerics.store import write_atomically  # noqa: E402
from screwsim.outputs import Figures, Result  # noqa: E402
from screwsim.scene import Scene  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402
from screwsim.solution import Solution  # noqa: E402

GUESS, OWN, TIGHTENED, FOLLOWED = COLD, "own cycle", "own cycle, tightened", "own cycle, followed for a life"
FINER = 1e-2  # accuracy of scipy's cycle over the case's
LOOSER = 1e-2  # tolerance of a step over that accuracy, where no finer one gets through
TRIES = (
    ("scipy-radau", GUESS, OF_STEPS),
    ("scipy-radau", OWN, OF_STEPS),
    ("scipy-radau", TIGHTENED, OF_STEPS),
    ("scipy-radau", FOLLOWED, OF_STEPS),
    ("scipy-bdf", TIGHTENED, OF_STEPS),
    ("scipy-lsoda", FOLLOWED, LOOSER),
)
BALANCED = 0.1  # bound on its balances over that accuracy: they are as good as its steps, not kept to rounding
STAGES = 3  # in which the own cycle is closed more tightly


def read() -> dict[str, Any]:
    """Return what is stored."""
    return json.loads(RADAU.read_text(encoding="utf-8")) if RADAU.exists() else {}


def from_guess(case: Case, scene: Scene, method: str, of_steps: float) -> tuple[str, Figures, float | None]:
    """Return status and figures of the case closed afresh, finer, by one of scipy's methods."""
    accuracy = scene.numerics.accuracy
    tight = {"accuracy": FINER * accuracy, "rtol": of_steps * accuracy, "integrator": method, "closing": "coupled"}
    changes = {path: value for path, value in case.changes.items() if not path.startswith("numerics")}
    result = simulate(make({**changes, "numerics": tight}), trace=False)
    return result.status, result.performance, None


def from_own_cycle(scene: Scene, method: str, start: str, of_steps: float) -> tuple[str, Figures, float | None]:
    """Return status, figures and last change under one of scipy's methods from where the case itself closed."""
    solution, accuracy = Solution(scene), scene.numerics.accuracy
    machinery = solution.machinery
    machinery.warm_up(solution.rehearse)
    closed = close_accurately(solution).closed
    P, widths, wanted = machinery.composition.P, machinery.composition.widths, solution.wanted
    loose = P[widths].copy()
    y = closing.chambers_at_pitches(machinery) if closed.how == "histories" else closed.y
    for stage in range(1, STAGES + 1) if start == TIGHTENED else ():
        share = FINER ** (stage / STAGES)
        P[widths] = share * loose
        solution.wanted = replace(wanted, rtol=share * wanted.rtol, tolerance=share * wanted.tolerance)
        closed = closing.by_coupling(solution, y.copy())
        if closed.status != "ok":
            return f"{closed.status} before", Figures(), None
        y = closed.y
    P[widths] = FINER * loose
    solution.wanted = replace(
        wanted, rtol=of_steps * accuracy, tolerance=0.2 * FINER * accuracy, bound=BALANCED * accuracy
    )
    machinery.integrator = method
    closed = followed(solution, y.copy()) if start == FOLLOWED else closing.by_coupling(solution, y.copy())
    return closed.status, solution.figures(closed.q)[0], closed.change


def followed(solution: Solution, y: np.ndarray) -> closing.Closed:
    """Return what one life makes of all chambers, without closing: ok where they come back within the accuracy."""
    machinery, rtol, began, q = solution.machinery, solution.wanted.rtol, y.copy(), np.zeros(0)
    for _ in range(machinery.composition.chambers):
        status, angle, _, q = machinery.pitch(y, rtol, 1e-3)
        if status != 0:
            return closing.Closed("failed", q, y, 1, "coupled", rtol, angle)
        y = machinery.shift(y)
    machinery.install_coupled()
    change = float(np.max(np.abs(y / began - 1.0)))
    came_back = change <= solution.scene.numerics.accuracy
    return closing.Closed("ok" if came_back else "not_closed", q, y, 1, "coupled", rtol, change=change)


def attempts(case: Case, limit: float) -> Iterator[dict[str, Any]]:
    """Yield the row that each try gives, up to the first that closes."""
    scene = make(case.changes)
    accuracy = scene.numerics.accuracy
    found = simulate(scene, trace=False)
    for method, start, of_steps in TRIES:
        row = {"accuracy": accuracy, "method": method, "start": start, "of_steps": of_steps}
        try:
            with limited(limit):
                if start == GUESS:
                    status, better, change = from_guess(case, scene, method, of_steps)
                else:
                    status, better, change = from_own_cycle(scene, method, start, of_steps)
        except Stopped:
            yield row | {"no_answer": f"not within {limit:g} s of processor time"}
            continue
        finally:
            Solution(scene).machinery.integrator = "rodas4"
        if status != "ok":
            yield row | {"no_answer": status}
            continue
        last = {} if change is None else {"last_change": change}
        yield row | {"difference": difference(found, better, Solution(scene).pv, start)} | last
        return


def difference(found: Result, better: Figures, pv: float, start: str) -> float:
    """Return the larger relative difference of work and trapped mass.

    Work below the least one is rounding. A chamber that is only followed gives back what it takes up, and its work is
    none: it is over m p/ρ.
    """
    least = (1.0 if start == FOLLOWED else LEAST_WORK) * better.trapped_mass * pv
    errors = relative_errors(found.performance, better, least_work=least)
    return max(errors.work_per_cycle, errors.trapped_mass)


def main() -> None:
    """Compare what is not stored yet, and what is named."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--limit", type=float, default=600.0, help="seconds of processor time that a try may take")
    parser.add_argument("names", nargs="*", metavar="CASE", help="cases to be done again")
    asked = parser.parse_args()
    for case in to_compare():
        if case.name in read() and case.name not in asked.names:
            continue
        row = {}
        for row in attempts(case, asked.limit):
            print(case.name, row, flush=True)
        rows = read() | {case.name: row}
        write_atomically(RADAU, (json.dumps(rows, indent=1, ensure_ascii=False, sort_keys=True) + "\n").encode())


if __name__ == "__main__":
    main()
