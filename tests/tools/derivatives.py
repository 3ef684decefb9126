"""Are derivatives exact? Random scenes of all effects: exact derivatives beside differences of tightly closed cycles.

    python tests/tools/derivatives.py [SCENES] [PATHS] [SEED] [--first N] [--accuracy A] [--of PATH] [--step S]
        [-o PAIRS] [--misses MISSES]
    python tests/tools/derivatives.py --again PAIRS … [-o …] [--misses …]

Scenes are drawn around shipped ones and the structures of `effects_space`, from number `OF_CONFIGS` on around all of
configs/. Their numbers differ by up to a tenth; they are closed by waveform relaxation (`histories`) and by coupled
chambers in turn. A few numbers of each scene are chosen, and each figure's derivative is compared with differences of
cycles closed with the step tolerance `RTOL` and the same regularisation; the surroundings of the machine are solved
again for each. Central differences over one, two and four times `STEP` (of one chamber `STEP_OF_ONE`) are extrapolated
twice (Richardson); the difference of both results is the uncertainty of the reference (`own`). Errors are relative to
the slope, or to `LEAST` percent per percent where it is smaller. A pair with an error above `GOOD` is listed with its
reason: `kink` where the differences to both sides disagree, `reference` where that is no better itself, `slices` where
finer slices reduce the error, else `unexplained`. With `--quick` the last two are not tried: `open`. `--again` computes
the exact derivatives again for the references in a file. A longer `--step` shows which misses are due to rounding of
the reference, as it reduces that.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws", "derivatives")]
import effects_space  # noqa: E402
from tight import NotTight, Tight  # noqa: E402

from screwsim.cycle.guess import lease_for  # noqa: E402
from screwsim.cycle.problem import Series, problem_of  # noqa: E402
from screwsim.derivatives.collocated_cycle import NotClosed  # noqa: E402
from screwsim.derivatives.collocation import FINE, Fineness, collocated  # noqa: E402
from screwsim.derivatives.solving import derivatives, figures_of, with_settled_surroundings  # noqa: E402
from screwsim.inputs.faults import ImpossibleValue, SceneError, UsageError  # noqa: E402
from screwsim.model import leases  # noqa: E402
from screwsim.scene import Scene, cross_check, load, with_values  # noqa: E402
from screwsim.solve.circuit import solve_with_surroundings, steady_state  # noqa: E402
from screwsim.study.uncertainty.slopes import numeric_paths  # noqa: E402

SHIPPED = {
    "paper": "configs/paper/point.yaml",
    "r134a": "tests/plain/r134a.yaml",
    "blend": "configs/r454b/point.yaml",
    "r134a's machine": "configs/r134a/point.yaml",
}
NAMES = (*SHIPPED, *effects_space.STRUCTURES)
OF_CONFIGS = 1000  # first number of the scenes around all shipped ones
NO_SCENES = (".fit.yaml", ".stages.yaml")
CLOSINGS = "histories", "coupled"
OFF = 0.1  # of a number, in a random scene
STEP = 3e-4  # of a number, step of differences; for an angle a tenth of it: a percent of an angle is several degrees
STEP_OF_ONE = 1e-3  # the same of a machine of one chamber: its cycles are less alike, as last bounces come and go
MANY = np.array((1.0, 2.0, 4.0))
GOOD = 1e-5
KINK = 30.0  # times the uncertainty of the reference by which both sides differ at a kink ...
BENT = 1e-3  # ... and times the slope
LEAST = 1e-2  # percent per percent
RTOL, TOLERANCE = 3e-9, 1e-10  # of a step and of a change, for reference cycles
FINER = FINE._replace(error=0.03 * FINE.error, ring=0.2 * FINE.ring, wider=0.6)  # shows errors that are due to slices
FIXED = ("machine.rotor", "effects.blow_hole.opens", "effects.blow_hole.closes")  # angles that belong to the machine
LIMITS = (1e-5, 1e-4, 1e-3, 1e-2)
ANGLES = ("opens", "phi_A", "phi_B", "phi_C", "closes", "opens_moved")
COLUMNS = ("scene", "base", "closing", "path", "figure", "value", "exact", "differences", "error", "own", "jump")
COLUMNS = (*COLUMNS, "left", "right", "reason")
Row = dict[str, Any]
_SIDE = np.linalg.inv(np.vander(np.append(0.0, MANY), increasing=True))[1]  # weights of a one-sided difference


def scene_of(number: int, seed: int, accuracy: float | None = None) -> tuple[str, str, Scene]:
    """Return the name of the scene that others are drawn around, its closing, and the drawn scene."""
    names = NAMES if number < OF_CONFIGS else configs()
    random, name = np.random.default_rng((seed, number)), names[number % len(names)]
    closing = CLOSINGS[(number + number // len(names)) % 2]
    changes = [f"numerics.closing={closing}", *([f"numerics.accuracy={accuracy}"] if accuracy else [])]
    if number >= OF_CONFIGS:
        base = replace(load(ROOT / name, changes), sweep={})
    elif name in SHIPPED:
        base = load(ROOT / SHIPPED[name], changes)
    else:
        structure = effects_space.STRUCTURES[name]
        base = load(ROOT / "configs" / structure.config, [*structure.sets, *changes])
    return name, closing, drawn(base, random)


@cache
def configs() -> tuple[str, ...]:
    """Return the shipped scenes, by their paths in the repository."""
    every = sorted((ROOT / "configs").rglob("*.yaml"))
    return tuple(str(each.relative_to(ROOT)) for each in every if not each.name.endswith(NO_SCENES))


def drawn(scene: Scene, random: np.random.Generator) -> Scene:
    """Return a scene with other numbers: angles changed by up to a degree, temperatures by 2 K, others by a tenth."""
    for _ in range(100):
        changes = {}
        for path, value in moving(scene).items():
            by = float(random.uniform(-1.0, 1.0))
            if path.startswith(FIXED):
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
    raise UsageError("no scene that makes sense was drawn")


def moving(scene: Scene) -> dict[str, float]:
    """Return the numbers [SI] of a scene that may be changed: those of another kind of part may not even be stated."""
    values, _ = numeric_paths(scene)
    return {path: value for path, value in values.items() if value and not cross_check(shifted(scene, path, STEP))}


def shifted(scene: Scene, path: str, by: float) -> Scene:
    """Return a scene with a number shifted by a share of itself."""
    return with_values(scene, {path: numeric_paths(scene)[0][path] * (1.0 + by)})


class Exact:
    """Exact derivatives of a scene, as `sensitivities` computes them."""

    def __init__(self, scene: Scene) -> None:
        """Solve the scene; raise UsageError with the reason where `sensitivities` would use differences of cycles."""
        self.scene, self.series, self.values = scene, Series(), numeric_paths(scene)[0]
        self.problem, search = steady_state(problem_of(scene, self.series), self.series)
        self.machinery = lease_for(self.problem)
        accurate = solve_with_surroundings(self.problem, self.machinery, None, search)
        if accurate.cycle.status != "ok":
            raise UsageError("the cycle does not close")
        of, self.widths = accurate.evaluation, accurate.criteria.widths
        self.problem, self.life = of.problem, of.life

    def slopes(self, paths: Sequence[str], fineness: Fineness = FINE) -> dict[str, dict[str, float]]:
        """Return derivatives [SI] by path and figure times the number at the path."""
        cycle = collocated(self.problem, self.machinery, self.life, fineness)
        cycle = with_settled_surroundings(cycle, self.life, None, fineness)
        found, _ = derivatives(cycle, {path: self.values[path] for path in paths})
        return {path: {name: each * self.values[path] for name, each in of.items()} for path, of in found.items()}


def rows(scene: Scene, paths: Sequence[str], of_numbers: float | None = None) -> Iterator[Row]:
    """Yield a row for each figure and path of a scene, with differences over a step of numbers (None: as usual)."""
    exact = Exact(scene)
    usual = STEP_OF_ONE if exact.problem.composition.chambers == 1 else STEP
    of_numbers = usual if of_numbers is None else of_numbers
    slopes = exact.slopes(paths)
    other = lease_for(exact.problem)
    tight = Tight(exact.problem, other, exact.widths, RTOL, TOLERANCE)
    at = figures_of(tight.base)
    for path in slopes:
        step = 0.1 * of_numbers if path.endswith(ANGLES) else of_numbers
        signs = (1.0, -1.0)
        sides = [
            [figures_of(tight.of(shifted(scene, path, sign * step * many))) for many in MANY.tolist()] for sign in signs
        ]
        for name, slope in slopes[path].items():
            if not at.get(name) or any(name not in each for side in sides for each in side):
                continue
            above, below = (np.array([each[name] for each in side]) / at[name] for side in sides)
            near, middle, far = ((above - below) / (2.0 * step * MANY)).tolist()
            theirs = (4.0 * middle - far) / 3.0
            size = max(abs(theirs), LEAST)
            right, left = (
                float(sign * _SIDE @ np.append(1.0, each)) / step
                for sign, each in zip(signs, (above, below), strict=True)
            )
            own = abs((4.0 * near - middle) / 3.0 - theirs) / size
            found = {"path": path, "figure": name, "value": at[name], "exact": slope / at[name], "own": own}
            yield found | {"differences": theirs, "jump": abs(right - left) / size, "left": left, "right": right}
    leases.give_back(other)


def judged(scene: Scene, found: list[Row], exact: Exact | None = None, quick: bool = False) -> None:
    """Add the error, and for a miss its reason, to each row."""
    for row in found:
        row["error"] = _error(row, row["exact"])
        row["reason"] = ""
    missed = [row for row in found if not row["error"] < GOOD]
    if not missed:
        return
    fine = None
    for row in missed:
        if row["jump"] > max(BENT, KINK * row["own"]):
            row["reason"] = "kink"
        elif row["own"] > 0.3 * row["error"]:
            row["reason"] = "reference"
        elif quick:
            row["reason"] = "open"
        else:
            if fine is None:
                exact = exact or Exact(scene)
                try:
                    fine = exact.slopes(sorted({each["path"] for each in missed}), FINER)
                except NotClosed:
                    fine = {}
            value = fine.get(row["path"], {}).get(row["figure"])
            error = np.inf if value is None else _error(row, value / row["value"])
            row["reason"] = "slices" if error < max(GOOD, 0.3 * row["error"]) else "unexplained"


def _error(row: Row, exact: float) -> float:
    return abs(exact - row["differences"]) / max(abs(row["differences"]), LEAST)


def again(scene: Scene, found: list[Row]) -> Exact:
    """Compute the exact derivatives of a scene's rows again."""
    exact = Exact(scene)
    slopes = exact.slopes(list(dict.fromkeys(row["path"] for row in found)))
    for row in found:
        row["exact"] = slopes[row["path"]][row["figure"]] / row["value"]
    return exact


def read(files: Sequence[str]) -> dict[int, list[Row]]:
    """Return the rows of files by the number of their scene."""
    found: dict[int, list[Row]] = {}
    for file in files:
        with open(file, encoding="utf-8", newline="") as stream:
            for line in csv.DictReader(stream):
                words = {"scene", "base", "closing", "path", "figure", "reason"}
                row: Row = {name: each if name in words else float(each) for name, each in line.items()}
                found.setdefault(int(row["scene"]), []).append(row)
    return found


def told(pairs: Sequence[Row]) -> None:
    """Print a summary to stderr."""
    misses = [row for row in pairs if row["reason"]]
    sure = [row for row in pairs if row["own"] <= GOOD]
    print(f"{len(pairs)} pairs of {len({row['scene'] for row in pairs})} scenes", file=sys.stderr)
    rows = {
        "pairs": pairs,
        "whose reference is good": sure,
        **{f"... closed by {closing}": [row for row in sure if row["closing"] == closing] for closing in CLOSINGS},
        "... of a slope that is not zero": [row for row in sure if row["differences"]],
        f"... of a slope above {LEAST:g}": [row for row in sure if abs(row["differences"]) > LEAST],
        "... and without angles": [row for row in sure if not row["path"].endswith(ANGLES)],
    }
    for what, those in rows.items():
        if those:
            errors = np.array([row["error"] for row in those])
            shares = ", ".join(f"{np.mean(errors < limit):.2%} below {limit:g}" for limit in LIMITS)
            print(f"{len(those)} {what}: median {np.median(errors):.1e}, {shares}", file=sys.stderr)
    print(f"misses: {dict(Counter(row['reason'] for row in misses))}", file=sys.stderr)


def written(file: str, found: Sequence[Row]) -> None:
    """Write rows to a file."""
    with open(file, "w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        for row in found:
            writer.writerow({name: f"{each:.9g}" if isinstance(each, float) else each for name, each in row.items()})


def arguments() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", type=int, nargs="?", default=len(NAMES))
    parser.add_argument("paths", type=int, nargs="?", default=4, help="numbers of each scene")
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("--first", type=int, default=0, help="the first scene, of a run in parts")
    parser.add_argument("--accuracy", type=float, help="of all scenes (default: their own)")
    parser.add_argument("--of", metavar="PATH", help="this number of each scene, in place of some by chance")
    usual = f"of a number, in differences (default {STEP:g}; of one chamber {STEP_OF_ONE:g})"
    parser.add_argument("--step", type=float, help=usual)
    parser.add_argument("--again", nargs="+", metavar="PAIRS", default=[], help="beside the references of these files")
    parser.add_argument("--quick", action="store_true", help="try no finer slices: the reason of other misses is open")
    parser.add_argument("-o", metavar="PAIRS", help="file of all pairs")
    parser.add_argument("--misses", metavar="MISSES", help="file of those that miss, with their reasons")
    return parser.parse_args()


def of_scene(asked: argparse.Namespace, number: int, old: list[Row]) -> list[Row]:
    """Return the judged rows of one scene; none, with the reason on stderr, where it has no exact derivatives."""
    name, closing, scene = scene_of(number, asked.seed, asked.accuracy)
    random, exact = np.random.default_rng((asked.seed, number, 1)), None
    try:
        if old:
            found, exact = old, again(scene, old)
        else:
            there = list(moving(scene))
            some = [asked.of] if asked.of else random.choice(there, min(asked.paths, len(there)), replace=False)
            found = list(rows(scene, list(some), asked.step))
        judged(scene, found, exact, asked.quick)
    except (NotClosed, NotTight, ImpossibleValue, SceneError, UsageError) as error:
        print(f"{number} {name}: {type(error).__name__}: {error}", file=sys.stderr)
        return []
    worst = max((row["error"] for row in found), default=0.0)
    missed = sum(bool(row["reason"]) for row in found)
    print(f"{number} {name}, {closing}: {len(found)} pairs, {missed} missed, worst {worst:.1e}", file=sys.stderr)
    return [{"scene": number, "base": name, "closing": closing, **row} for row in found]


def main() -> None:
    """Write the rows of random scenes, and a summary to stderr."""
    asked = arguments()
    old, pairs = read(asked.again), []
    for number in sorted(old) or range(asked.first, asked.first + asked.scenes):
        pairs += of_scene(asked, number, old.get(number, []))
        if asked.o:
            written(asked.o, pairs)
    told(pairs)
    if asked.misses:
        written(asked.misses, [row for row in pairs if row["reason"]])


if __name__ == "__main__":
    main()
