"""Search for the scenes on which the program is worst, by evolution instead of by chance.

    python tests/tools/adversary.py [--aim error|status|cost|slopes] [--seed N] [--minutes M]
        [--structure S] [--space effects|fuzz|fluids] [--keep 2] [-o FOLDER]

Scenes are points of the unit cube of a structure of `effects_space.py`, `fuzz_space.py` or `fluid_space.py`, wanted at
the default accuracy. A population of them evolves (differential evolution towards its best) until it stalls, then
another one begins: what the words of a scene choose, as its fluid, stays the same in one. The minutes are shared by the
structures (all of them, unless some are named). Printed are the worst scenes of each structure; with `-o` they are
written as runnable files. What is worst depends on the aim:

- `error`: a figure's true error, over the estimated one or a third of the wanted accuracy if that is more. The true
  one is the distance from coupled chambers at `FINER` of the accuracy; above `DOUBTED` it is found again as
  `true_error.py` does. Above 3 a figure is off by more than the accuracy and by three times what is told: a find.
- `status`: a scene that is ok but not so at an accuracy of `FINEST`, or reaches another cycle there. Below that, the
  evaluations that this takes, in powers of ten.
- `cost`: evaluations of closing, over `DEAR`.
- `slopes`: the largest error of an exact derivative along some numbers beside differences of tight cycles
  (`derivatives.py`), in powers of ten above its `GOOD`, kinks and uncertain references excepted.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws", "derivatives")]
import effects_space  # noqa: E402
import fluid_space  # noqa: E402
import fuzz_space  # noqa: E402
import scenes  # noqa: E402
from judging import Stopped, finite, limited  # noqa: E402
from tight import NotTight  # noqa: E402
from true_error import ANOTHER, reference, true_error  # noqa: E402

import derivatives  # noqa: E402
from screwsim.derivatives.collocated_cycle import NotClosed  # noqa: E402
from screwsim.figures.errors import relative_errors, worst  # noqa: E402
from screwsim.inputs.faults import ImpossibleValue, SceneError, UsageError  # noqa: E402
from screwsim.outputs import Figures, Result  # noqa: E402
from screwsim.scene import Scene, load, scene_text  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

ACCURACY = 3e-4  # wanted: the default
FINER = 0.03  # accuracy of the finer solution over the wanted one
FINEST = 1e-6  # accuracy at which a scene that is ok should be ok too
LEAST_TOLD = 1.0 / 3.0  # of the wanted accuracy: smaller estimates count as this
DOUBTED = 1.5  # score above which a true error is found again
FAR = 10.0  # wanted accuracies: distance of another cycle
CONTRADICTED = 10.0  # score of a scene that is ok at one accuracy alone
DEAR = 500_000  # evaluations that a point should not take
LIMIT = 40.0  # [s] of processor time for one scene
MEMBERS, STALLED = 14, 5  # of a population; generations without a better one after which another begins
STEP, CROSSED = (0.3, 0.9), 0.6  # factor of differences, share of the numbers that are taken from the trial
NUMBERS = 3  # of a scene, by which derivatives are asked
WORDS = ("fluid", "own_k", "by_temperatures", "losses", "which")  # of the spaces: choose text, not numbers
USUAL = ("coupled", "own_accuracy")  # always left at the default
Point = np.ndarray
Aim = Callable[[Scene], "Found"]


class Found(NamedTuple):
    """How bad one scene is, and what about it."""

    score: float
    about: str


class Space(NamedTuple):
    """A structure's cube: its number of dimensions, those that stay in a population, and the scene at a point."""

    size: int
    fixed: tuple[int, ...]
    scene: Callable[[Sequence[float]], Scene]


def _of_effects(structure: str) -> Space:
    chosen, ranges = effects_space.STRUCTURES[structure], effects_space.ranges(structure)

    def scene(shares: Sequence[float]) -> Scene:
        sets = {path: each.at(share) for (path, each), share in zip(ranges.items(), shares, strict=False)}
        ratio, closes = shares[len(ranges) :]
        if chosen.discharge == "operation.discharge.pressure":
            p = sets.get("operation.suction.pressure")
            p_s = float(p.split()[0]) if p else effects_space.base(structure).operation.suction.pressure / 1e5
            sets["operation.discharge.pressure"] = f"{p_s * float(effects_space.RATIO.at(ratio)):.8g} bar"
        elif chosen.discharge == "expander":
            p_d = 20.0 / float(effects_space.Range(1.5, 6.0).at(ratio))
            sets["operation.discharge.pressure"] = f"{p_d:.8g} bar"
        if "machine.discharge_port.opens" in sets:
            opens = float(sets["machine.discharge_port.opens"].split()[0])
            phi_C = opens + (0.1 + 0.8 * closes) * 0.5 * (720.0 - opens)
            sets["machine.discharge_port.phi_C"] = f"{phi_C:.8g} deg"
        drawn = [f"{path}={value}" for path, value in sets.items()]
        return load(str(ROOT / "configs" / chosen.config), [*chosen.sets, *drawn])

    return Space(len(ranges) + 2, (), scene)


def _of_changes(space: Any, structure: str) -> Space:
    names = list(fuzz_space.RANGES) + ([] if space is fuzz_space else list(space.RANGES))
    usual = [names.index(name) for name in USUAL]

    def scene(shares: Sequence[float]) -> Scene:
        shares = [0.0 if i in usual else float(share) for i, share in enumerate(shares)]
        return scenes.make(space.changes(structure, shares))

    return Space(len(names), tuple(i for i, name in enumerate(names) if name in WORDS), scene)


def spaces() -> dict[str, dict[str, Callable[[], Space]]]:
    """Return for each space its structures."""
    return {
        "effects": {name: lambda name=name: _of_effects(name) for name in effects_space.STRUCTURES},
        "fuzz": {name: lambda name=name: _of_changes(fuzz_space, name) for name in fuzz_space.STRUCTURES},
        "fluids": {name: lambda name=name: _of_changes(fluid_space, name) for name in fluid_space.STRUCTURES},
    }


def wanting(scene: Scene, **numerics: Any) -> Scene:
    """Return a scene with other numerics."""
    return replace(scene, numerics=replace(scene.numerics, **numerics))


def compared(result: Result, better: Figures) -> Found:
    """Return the figure whose error exceeds the estimated one, or a third of the accuracy, by the largest factor."""
    least, found = LEAST_TOLD * ACCURACY, Found(0.0, "")
    for name, error in relative_errors(result.performance, better).items():
        told = result.error.get(name)
        if error is None or told is None:
            continue
        score = error / max(told, least)
        if score > found.score:
            found = Found(score, f"{name} off by {error:.3g}, told {told:.3g}")
    return found


def _fails(result: Result) -> Found | None:
    """Return what is about a result without figures to compare; None for one that has them."""
    if result.status != "ok":
        return Found(0.0, result.status)
    return None if finite(result) else Found(CONTRADICTED, "not finite")


def by_error(scene: Scene) -> Found:
    """Return how far the figures of a scene are off, over what is told."""
    result = simulate(scene, trace=False)
    if fails := _fails(result):
        return fails
    better = simulate(wanting(scene, accuracy=FINER * ACCURACY, closing="coupled", error="none"), trace=False)
    if better.status != "ok":
        return Found(0.0, f"finer {better.status}")
    found = compared(result, better.performance)
    if found.score < DOUBTED:
        return found
    kept: list[Figures] = []

    def asked(scene: Scene, radau: float | None) -> tuple[str, Figures]:
        status, figures = reference(scene, radau)
        kept.append(figures)
        return status, figures

    known, name, true = true_error(scene, result, asked=asked)
    if known == ANOTHER:
        return Found(0.0, f"{ANOTHER}: {name} {true:.3g}")
    if known != "ok":
        return Found(min(found.score, DOUBTED), f"{found.about} (finer solutions: {known})")
    return compared(result, kept[-1])


def by_status(scene: Scene) -> Found:
    """Return whether a scene is ok at the default accuracy alone, else what a far finer one takes."""
    result = simulate(scene, trace=False)
    if fails := _fails(result):
        return fails
    finest = simulate(wanting(scene, accuracy=FINEST, error="none"), trace=False)
    taken = int(finest.numerics.rhs_evaluations or 0)
    if finest.status != "ok":
        return Found(CONTRADICTED, f"{finest.status} at {FINEST:g}, {taken} evaluations: {finest.message[:100]}")
    name, apart = worst(relative_errors(result.performance, finest.performance))
    if apart > FAR * ACCURACY and apart > FAR * (result.error.get(name) or math.inf):
        return Found(CONTRADICTED, f"another cycle at {FINEST:g}: {name} {apart:.3g}")
    return Found(math.log10(max(taken, 1)), f"{taken} evaluations at {FINEST:g}")


def by_cost(scene: Scene) -> Found:
    """Return the evaluations of a scene over those that it should not take."""
    started = time.process_time()
    result = simulate(scene, trace=False)
    taken = int(result.numerics.rhs_evaluations or 0)
    return Found(taken / DEAR, f"{result.status}, {taken} evaluations, {time.process_time() - started:.1f} s")


def by_slopes(scene: Scene) -> Found:
    """Return how wrong the worst exact derivative is, along some numbers that the scene's text chooses."""
    there = list(derivatives.moving(scene))
    random = np.random.default_rng(len(there))
    paths = random.choice(there, min(NUMBERS, len(there)), replace=False).tolist()
    try:
        rows = list(derivatives.rows(scene, paths))
        derivatives.judged(scene, rows, quick=True)
    except (NotClosed, NotTight, ImpossibleValue, UsageError) as why:
        return Found(0.0, f"{type(why).__name__}: {why}")
    missed = [row for row in rows if row["reason"] == "open"]
    if not missed:
        return Found(0.0, "")
    row = max(missed, key=lambda each: each["error"])
    about = f"{row['figure']} by {row['path']}: {row['exact']:.6g}, differences {row['differences']:.6g}"
    return Found(math.log10(row["error"] / derivatives.GOOD), f"{about} within {row['own']:.1g}")


AIMS: dict[str, Aim] = {"error": by_error, "status": by_status, "cost": by_cost, "slopes": by_slopes}


def judged(space: Space, aim: Aim, point: Point) -> Found:
    """Return how bad the scene at a point is; one that is refused is not bad, one that crashes is."""
    try:
        scene = wanting(space.scene(point.tolist()), accuracy=ACCURACY, closing="auto")
        with limited(LIMIT):
            return aim(scene)
    except SceneError as fault:
        return Found(0.0, f"refused: {fault}")
    except Stopped:
        return Found(DOUBTED, f"not within {LIMIT:g} s")
    except Exception as fault:  # noqa: BLE001 - these are searched for
        return Found(CONTRADICTED, f"crashed: {type(fault).__name__}: {fault}")


def evolve(space: Space, aim: Aim, random: np.random.Generator, until: float) -> Iterator[tuple[Point, Found]]:
    """Yield points and how bad they are, of populations one after the other, until a time [s]."""
    while time.monotonic() < until:
        words = random.random(space.size)
        members = random.random((MEMBERS, space.size))
        members[:, space.fixed] = words[list(space.fixed)]
        found = []
        for each in members:
            found.append(judged(space, aim, each))
            yield each, found[-1]
            if time.monotonic() > until:
                return
        scores, stalled = np.array([each.score for each in found]), 0
        while stalled < STALLED:
            before = scores.max()
            for i in range(MEMBERS):
                trial = _trial(members, scores, i, random)
                one = judged(space, aim, trial)
                yield trial, one
                if one.score >= scores[i]:
                    members[i], scores[i] = trial, one.score
                if time.monotonic() > until:
                    return
            stalled = stalled + 1 if scores.max() <= 1.01 * before else 0


def _trial(members: np.ndarray, scores: np.ndarray, i: int, random: np.random.Generator) -> Point:
    """Return a member moved towards the best one and along the difference of two others, within the cube."""
    one, other = random.choice(len(members), 2, replace=False)
    factor = random.uniform(*STEP)
    best = members[np.argmax(scores)]
    moved = members[i] + factor * (best - members[i]) + factor * (members[one] - members[other])
    moved += random.normal(0.0, 1e-3, moved.shape)
    moved = np.abs(moved)
    moved = 1.0 - np.abs(1.0 - moved)
    taken = random.random(moved.shape) < CROSSED
    return np.clip(np.where(taken, moved, members[i]), 0.0, 1.0)


def searched(
    kind: str, structure: str, aim: str, seed: int, minutes: float, keep: int
) -> tuple[int, list[tuple[Found, Point]]]:
    """Return how many scenes of a structure were judged, and the worst of them, the worst first."""
    space = spaces()[kind][structure]()
    random = np.random.default_rng((seed, sorted(AIMS).index(aim), *structure.encode()))
    worst_ones: list[tuple[Found, Point]] = []
    count = 0
    for point, found in evolve(space, AIMS[aim], random, time.monotonic() + 60.0 * minutes):
        count += 1
        worst_ones = sorted([*worst_ones, (found, point.copy())], key=lambda each: -each[0].score)[: 4 * keep]
    return count, worst_ones


def apart(found: list[tuple[Found, Point]], keep: int) -> list[tuple[Found, Point]]:
    """Return so many of the worst, each with other words about it than those before."""
    chosen: dict[str, tuple[Found, Point]] = {}
    for each in found:
        chosen.setdefault(each[0].about.split(" off by")[0], each)
    return list(chosen.values())[:keep]


def written(folder: Path, name: str, scene: Scene, found: Found) -> None:
    """Write a scene to a file that runs, with what is bad about it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.yaml").write_text(f"# {found.score:.3g}: {found.about}\n{scene_text(scene)}", encoding="utf-8")


def asked() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--aim", choices=sorted(AIMS), default="error")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=10.0, help="in all")
    parser.add_argument("--space", choices=sorted(spaces()), default="effects")
    parser.add_argument("--structure", action="append", help="of that space, more than once for several (default: all)")
    parser.add_argument("--keep", type=int, default=2, help="scenes of each structure that are shown")
    parser.add_argument("-o", "--output", type=Path, help="folder for them")
    return parser.parse_args()


def main() -> None:
    """Search the structures in turn and print the worst scenes of each."""
    options = asked()
    names = options.structure or list(spaces()[options.space])
    for structure in names:
        minutes = options.minutes / len(names)
        count, found = searched(options.space, structure, options.aim, options.seed, minutes, options.keep)
        print(f"{structure}: {count} scenes", flush=True)
        for number, (each, point) in enumerate(apart(found, options.keep), 1):
            print(f"  {each.score:.3g}  {each.about}", flush=True)
            if options.output:
                scene = wanting(spaces()[options.space][structure]().scene(point.tolist()), accuracy=ACCURACY)
                file = f"{options.aim}-{structure.replace(', ', '-').replace(' ', '-')}-{options.seed}-{number}"
                written(options.output, file, scene, each)


if __name__ == "__main__":
    main()
