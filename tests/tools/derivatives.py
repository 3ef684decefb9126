"""Are derivatives exact? Random scenes: exact derivatives beside differences of tightly closed cycles.

    python tests/tools/derivatives.py [SCENES] [PATHS] [SEED] [-LOG10(ACCURACY)] > outcome.csv

Scenes are drawn around some bases (their numbers up to a tenth off), a few numbers of each are taken, and each figure's
derivative is held against central differences of cycles closed at 1e-8 a step with the same regularisation: those over
`STEP` and over twice that, extrapolated to none (Richardson). What extrapolation changes is the reference's own error,
`own`: pairs whose reference is not good to `GOOD` are told apart, as they are no evidence. A row a pair; what was found
is summed up on stderr. Errors count over the slope, or over `LEAST` percent per percent where it is less.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.cycle.guess import leased
from screwsim.cycle.problem import Problem, Series, problem_of
from screwsim.derivatives.around import derivatives
from screwsim.derivatives.closed import NotClosed, collocated
from screwsim.derivatives.figures import figures_of
from screwsim.inputs.faults import Impossible, UsageError
from screwsim.scene import Scene, cross_check, load, with_values
from screwsim.solve.accurately import solve
from screwsim.study.local import numeric_paths

sys.path.insert(0, str(Path(__file__).parents[1] / "derivatives"))
from tight import closed_tightly

ROOT = Path(__file__).parents[2]
BASES = (
    ("configs/paper/point.yaml", ("numerics.closing=histories",)),
    ("configs/paper/point.yaml", ("numerics.closing=coupled",)),
    ("tests/plain/r134a.yaml", ()),
    ("configs/r454b/point.yaml", ()),
    ("configs/r134a/point.yaml", ("oil_supply.temperature=327 K",)),  # else its circuit would be closed each time
)
OFF = 0.1  # of a number, in a random scene
STEP = 5e-5  # of a number, in differences; of an angle a tenth: a percent of it is several degrees
GOOD = 1e-5  # own error of a reference that is evidence
LEAST = 1e-2  # percent per percent
RTOL, TOLERANCE = 1e-8, 1e-10  # of a step and of a change, of reference cycles
FIXED = ("machine.rotor", "effects.blow_hole.opens", "effects.blow_hole.closes")  # angles that belong to the machine
LIMITS = (1e-5, 1e-4, 1e-3, 1e-2)
ANGLES = ("opens", "phi_A", "phi_B", "phi_C", "closes")


def drawn(scene: Scene, random: np.random.Generator) -> Scene:
    """Return a scene with other numbers: angles by a degree, temperatures by two kelvin, others by a tenth."""
    values, _ = numeric_paths(scene)
    for _ in range(100):
        changes = {}
        for path, value in values.items():
            by = float(random.uniform(-1.0, 1.0))
            if path.startswith(FIXED) or not value:
                continue
            if path.endswith(ANGLES):
                changes[path] = value + by * np.radians(1.0)
            elif "temperature" in path:
                changes[path] = value + 2.0 * by
            else:
                changes[path] = value * (1.0 + OFF * by)
        found = with_values(scene, changes)
        if not cross_check(found):
            return found
    raise ValueError("no scene that makes sense was drawn")


def rows(scene: Scene, paths: list[str]) -> Iterator[dict[str, Any]]:
    """Yield a row for each figure and path of a scene."""
    values, _ = numeric_paths(scene)
    problem = problem_of(scene)
    machinery, series = leased(problem), Series()
    accurate = solve(problem, machinery)
    if accurate.cycle.status != "ok":
        return
    cycle = collocated(problem, machinery, accurate.evaluation.life)
    widths = accurate.wanted.widths
    slopes, _ = derivatives(cycle, {path: values[path] for path in paths})
    other = leased(problem)
    base = closed_tightly(problem, other, None, RTOL, TOLERANCE)
    for path in slopes:
        step = 0.1 * STEP if path.endswith(ANGLES) else STEP
        shifts = [values[path] * (1.0 + by * step) for by in (1.0, -1.0, 2.0, -2.0)]
        sides = [_tight(problem, series, other, base, path, value) for value in shifts]
        at = figures_of(base)
        for name, slope in slopes[path].items():
            if not at.get(name) or any(name not in each for each in sides):
                continue
            near = (sides[0][name] - sides[1][name]) / (2.0 * step * at[name])
            far = (sides[2][name] - sides[3][name]) / (4.0 * step * at[name])
            ours, theirs = slope * values[path] / at[name], (4.0 * near - far) / 3.0
            size = max(abs(theirs), LEAST)
            error, own = abs(ours - theirs) / size, abs(theirs - near) / size
            found = {"path": path, "figure": name, "exact": ours, "differences": theirs, "error": error, "own": own}
            yield found | {"w": widths[0]}


def _tight(problem: Problem, series: Series, machinery: Any, base: Any, path: str, value: float) -> dict[str, float]:
    other = problem_of(with_values(problem.scene, {path: value}), series)
    return figures_of(closed_tightly(other, machinery, base.life, RTOL, TOLERANCE))


def main(scenes: int = 10, count: int = 6, seed: int = 1, digits: int = 0) -> None:
    """Write the rows of random scenes as CSV, and a summary on stderr."""
    random, errors, others, every = np.random.default_rng(seed), [], [], 0
    writer = None
    for number in range(scenes):
        file, changes = BASES[number % len(BASES)]
        finer = [f"numerics.accuracy=1e-{digits}"] if digits else []
        scene = drawn(load(ROOT / file, [*changes, *finer]), random)
        values, _ = numeric_paths(scene)
        felt = [path for path, value in values.items() if value]
        try:
            found = list(rows(scene, list(random.choice(felt, count, replace=False))))
        except (NotClosed, Impossible, UsageError, AssertionError) as error:
            print(f"{number} {file}: {type(error).__name__}: {error}", file=sys.stderr)
            continue
        for row in found:
            row = {"scene": number, "base": file, **row}
            if writer is None:
                writer = csv.DictWriter(sys.stdout, list(row))
                writer.writeheader()
            writer.writerow(row)
            if row["own"] <= GOOD:
                errors.append(row["error"])
                if not row["path"].endswith(ANGLES):
                    others.append(row["error"])
            every += 1
        worst = max((row["error"] for row in found), default=0.0)
        print(f"{number} {file}: {len(found)} pairs, largest error {worst:.1e}", file=sys.stderr)
    print(f"{every - len(errors)} of {every} pairs have a reference that is no evidence", file=sys.stderr)
    for those, what in ((errors, "pairs"), (others, "pairs without angles")):
        shares = ", ".join(f"{np.mean(np.array(those) < limit):.1%} below {limit:g}" for limit in LIMITS)
        print(f"{len(those)} {what}: median {np.median(those):.1e}, {shares}", file=sys.stderr)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
