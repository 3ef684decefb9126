"""Solve every hard case that is ok again by coupled chambers under scipy's Radau, and store how far the two differ.

Run: hard_against_radau.py [--limit 600] [CASE ...]. `tests/hard` does this for some cases, this script for the others,
each try within `--limit` seconds of processor time. Radau starts from the cold guess as the case itself does; where
that does not close, from the case's own closed cycle, which it either keeps or leaves for its own; then from that cycle
closed more tightly, then with damping. Where none of these succeeds, the chambers are followed for one life from there,
and must return within the accuracy; then BDF is tried, and LSODA with coarser steps. `tests/hard/against_radau.json`
holds a row per case: the larger relative difference of work and trapped mass, the wanted accuracy, the method and start
that closed, its step tolerance over that accuracy, and the change in the last pitch (or life). Stored cases are
skipped; named ones are done again.
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
from records import by_records  # noqa: E402
from scenes import make  # noqa: E402

from screwsim.cycle.balances import LEAST_WORK  # noqa: E402
from screwsim.cycle.close import DAMPED_DEPTH, DAMPING, NEAR_DAMPED  # noqa: E402
from screwsim.cycle.guess import lease_for  # noqa: E402
from screwsim.cycle.mixing import FULL_RULE, MixingRule  # noqa: E402
from screwsim.cycle.problem import ClosingTask, Problem, problem_of  # noqa: E402
from screwsim.cycle.search import search_and_close  # noqa: E402
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together  # noqa: E402
from screwsim.cycle.solution import ClosingCriteria, CycleSolution  # noqa: E402
from screwsim.cycle.ways import way_of  # noqa: E402
from screwsim.evaluate.evaluation import evaluate  # noqa: E402
from screwsim.figures.errors import relative_errors  # noqa: E402
from screwsim.model.all_chambers import install_pitch, moved_on  # noqa: E402
from screwsim.model.run import Machinery  # noqa: E402
from screwsim.numerics.integrators import check_of  # noqa: E402
from screwsim.numerics.store import write_atomically  # noqa: E402
from screwsim.outputs import Figures, Result  # noqa: E402
from screwsim.scene import Scene  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402
from screwsim.solve.accurately import solve  # noqa: E402

GUESS, OWN, TIGHTENED, FOLLOWED = COLD, "own cycle", "own cycle, tightened", "own cycle, followed for a life"
DAMPED, SOUGHT = "own cycle, damped", "own cycle, sought"
FINER = 1e-2  # accuracy of scipy's cycle over the case's
LOOSER = 1e-2  # tolerance of a step over that accuracy, where no finer one succeeds
TRIES = (
    ("scipy-radau", GUESS, OF_STEPS),
    ("scipy-radau", OWN, OF_STEPS),
    ("scipy-radau", TIGHTENED, OF_STEPS),
    ("scipy-radau", DAMPED, OF_STEPS),
    ("scipy-radau", SOUGHT, OF_STEPS),
    ("scipy-radau", FOLLOWED, OF_STEPS),
    ("scipy-bdf", TIGHTENED, OF_STEPS),
    ("scipy-lsoda", FOLLOWED, LOOSER),
)
BALANCED = 0.1  # bound on the balances over that accuracy: they are as good as the steps, not kept to rounding
NOISE = 10.0  # tolerance of a cycle closed by pitches: each pitch multiplies the noise of the steps
STAGES = 3  # stages in which the own cycle is closed more tightly


def read() -> dict[str, Any]:
    """Return the stored rows."""
    return json.loads(RADAU.read_text(encoding="utf-8")) if RADAU.exists() else {}


def from_guess(case: Case, scene: Scene, method: str, of_steps: float) -> tuple[str, Figures, float | None]:
    """Return status and figures of the case closed from the start, more finely, by one of scipy's methods."""
    accuracy = scene.numerics.accuracy
    tight = {"accuracy": FINER * accuracy, "rtol": of_steps * accuracy, "integrator": method, "closing": "coupled"}
    changes = {path: value for path, value in case.changes.items() if not path.startswith("numerics")}
    result = simulate(make({**changes, "numerics": tight}), trace=False)
    return result.status, result.performance, None


def from_own_cycle(scene: Scene, method: str, start: str, of_steps: float) -> tuple[str, Figures, float | None]:
    """Return status, figures and last change under one of scipy's methods, starting from the case's closed cycle."""
    problem, accuracy = problem_of(scene), scene.numerics.accuracy
    machinery = lease_for(problem)
    own = solve(problem, machinery)
    cycle, wanted = own.cycle, own.criteria
    machinery.put(cycle.trajectory)
    y = cycle.y if way_of(cycle).whole else chambers_at_pitches(machinery)

    def tightened(share: float, **others: Any) -> ClosingCriteria:
        return replace(wanted, widths=tuple(share * width for width in wanted.widths), **others)

    for stage in range(1, STAGES + 1) if start == TIGHTENED else ():
        share = FINER ** (stage / STAGES)
        finer = tightened(share, rtol=share * wanted.rtol, tolerance=share * wanted.tolerance)
        cycle = close_together(ClosingTask(problem, machinery, finer), y.copy())
        if cycle.status != "ok":
            return f"{cycle.status} before", Figures(), None
        y = cycle.y
    kept = {"tolerance": 0.2 * FINER * accuracy, "bound": BALANCED * accuracy, "check": check_of(method)}
    finest = tightened(FINER, rtol=of_steps * accuracy, **kept)
    if start == FOLLOWED:
        cycle = followed(problem, machinery, finest, y.copy())
    elif start == SOUGHT:
        found = search_and_close(
            ClosingTask(problem, machinery, replace(finest, tolerance=NOISE * finest.tolerance)), y.copy()
        )
        if found is None:
            return "not_closed", Figures(), None
        cycle = found
    else:
        rule = MixingRule(DAMPED_DEPTH, DAMPING, NEAR_DAMPED) if start == DAMPED else FULL_RULE
        cycle = close_together(ClosingTask(problem, machinery, finest), y.copy(), rule)
    return cycle.status, evaluate(problem, cycle).figures, cycle.change


def followed(problem: Problem, machinery: Machinery, wanted: ClosingCriteria, y: np.ndarray) -> CycleSolution:
    """Return all chambers after one life, without closing: ok where they return within the accuracy."""
    began, q, c = y.copy(), np.zeros(0), machinery.composition
    c.P[c.widths] = wanted.widths
    for _ in range(c.chambers):
        status, angle, q = machinery.pitch(y, wanted.rtol, check=wanted.check)
        if status != 0:
            return CycleSolution("failed", machinery.trajectory.copy(), q, y, 1, "coupled", wanted.rtol, angle)
        y = moved_on(machinery, y)
    install_pitch(machinery)
    change = float(np.max(np.abs(y / began - 1.0)))
    status = "ok" if change <= problem.scene.numerics.accuracy else "not_closed"
    life = machinery.trajectory.copy()
    return CycleSolution(status, life, q, y, 1, "coupled", wanted.rtol, change=change)


def attempts(case: Case, limit: float) -> Iterator[dict[str, Any]]:
    """Yield the row of each try, up to the first that closes."""
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
        if status != "ok":
            yield row | {"no_answer": status}
            continue
        last = {} if change is None else {"last_change": change}
        yield row | {"difference": difference(found, better, problem_of(scene).pv, start)} | last
        return


def difference(found: Result, better: Figures, pv: float, start: str) -> float:
    """Return the larger relative difference of work and trapped mass.

    Work below `least` is rounding. A chamber that is only followed gives back the work that it takes up, so its work is
    zero: the difference is then relative to m p/ρ.
    """
    least = (1.0 if start == FOLLOWED else LEAST_WORK) * better.trapped_mass * pv
    errors = relative_errors(found.performance, better, least_work=least)
    return max(errors.work_per_cycle, errors.trapped_mass)


def main() -> None:
    """Compare the cases that are not stored yet, and those named."""
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
        rows = dict(sorted({**read(), case.name: row}.items()))
        write_atomically(RADAU, (by_records(rows, 1) + "\n").encode())


if __name__ == "__main__":
    main()
