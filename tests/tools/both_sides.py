"""Do exact derivatives agree whichever way the numbers are shifted that they are derived from?

    python tests/tools/both_sides.py [SCENE …] [--new COUNT] [--seed 1] [--paths 14]

Derivatives start from the scene composed with a number shifted by `solving.STEP`. Shifted the other way it must give
the same slopes, unless the machine has a kink there. A table that gets another row, or a port that another branch
describes, gives slopes that are wrong on one side: no estimate shows it. Without scenes all of configs/ are taken;
with `--new` so many random machines of `screwsim new` (`tests/tools/fuzz_new.py`). Prints each pair that is `APART`,
with the figure itself: near a sum of zero, as the heat of insulated walls, there are only digits of rounding.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(Path(__file__).parent)]
import fuzz_new  # noqa: E402

import derivatives  # noqa: E402
from screwsim.derivatives import solving  # noqa: E402
from screwsim.inputs.faults import ImpossibleValue, SceneError, UsageError  # noqa: E402
from screwsim.scene import Scene, load, loads  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402
from screwsim.study.uncertainty.slopes import numeric_paths  # noqa: E402

APART = 1e-2  # relative difference of the slopes to both sides that is told
LEAST = 1e-2  # percent per percent: what counts for less is compared with that


def of_files(files: list[Path]) -> Iterator[tuple[str, Scene]]:
    """Yield names and scenes of files; those that are no scene by themselves are left out."""
    for file in files:
        try:
            yield str(file), load(file)
        except SceneError:
            continue


def new(count: int, random: np.random.Generator) -> Iterator[tuple[str, Scene]]:
    """Yield requests and scenes of random machines that `screwsim new` writes."""
    for _ in range(count):
        kind, stated = fuzz_new.drawn(random)
        try:
            yield f"{kind} {stated}", loads(fuzz_new.written(kind, stated))
        except UsageError:
            continue


def apart(scene: Scene, values: dict[str, float]) -> tuple[int, list[str]]:
    """Return the number of compared slopes, and a line for each whose two sides are `APART`."""
    step, sides = solving.STEP, []
    try:
        for solving.STEP in (step, -step):
            sides.append(solving.scene_derivatives(scene, values))
    finally:
        solving.STEP = step
    if any(each.why for each in sides):
        return 0, []
    up, down = (each.derivatives for each in sides)
    known, count, lines = simulate(scene, trace=False).performance, 0, []
    for path in up.keys() & down.keys():
        for figure in up[path].keys() & down[path].keys() & known.keys():
            here, pair = known[figure], (up[path][figure], down[path][figure])
            largest = max(*map(abs, pair), LEAST * abs((here or 0.0) / values[path]))
            count += 1
            if abs(pair[0] - pair[1]) > APART * largest:
                lines.append(
                    f"{path}: {figure} {pair[0]:.4g} and {pair[1]:.4g} (number {values[path]:.4g}, {here:.4g})"
                )
    return count, sorted(lines)


def main() -> None:
    """Compare the slopes of the scenes that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=Path)
    parser.add_argument("--new", type=int, default=0, metavar="COUNT")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--paths", type=int, default=14, help="numbers of a scene, at random")
    asked = parser.parse_args()
    random, total, told = np.random.default_rng(asked.seed), 0, 0
    scenes = (
        new(asked.new, random)
        if asked.new
        else of_files(asked.scenes or [ROOT / each for each in derivatives.configs()])
    )
    for name, scene in scenes:
        values = {path: value for path, value in numeric_paths(scene)[0].items() if value}
        some = random.permutation(list(values))[: asked.paths]
        try:
            count, lines = apart(scene, {path: values[path] for path in map(str, some)})
        except ImpossibleValue as error:
            print(f"{name}: {error}")
            continue
        total, told = total + count, told + len(lines)
        for line in lines:
            print(f"{name}: {line}", flush=True)
    print(f"{told} of {total} slopes differ by more than {APART:g} of themselves")


if __name__ == "__main__":
    main()
