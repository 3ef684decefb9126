"""Draw scenes at random and tell whether the wanted accuracy is kept. Run: accuracy_kept.py [SCENES] [SEED] [-v].

The scenes lie around configs/paper and configs/r134a; every tenth is judged by scipy's Radau. See docs/accuracy.md.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from screwsim.scene import Scene, load, with_values
from screwsim.simulate import simulate
from screwsim.study.accuracy.kept import Kept, account, drawn, kept

ROOT = Path(__file__).resolve().parent.parent
PAPER, REAL = str(ROOT / "configs" / "paper" / "point.yaml"), str(ROOT / "configs" / "r134a" / "point.yaml")
DRY = ("oil_heat", "oil_pump", "hydromechanical", "end_face_leakage", "interlobe_leakage")
RADAU_EVERY = 10


def structures() -> dict[str, Scene]:
    """Return the scenes around which others are drawn."""
    return {
        "paper": load(PAPER),
        "carried": load(PAPER, ["oil.transport=carried"]),
        "dry": load(PAPER, without=DRY),
        "real": load(REAL),
    }


def sample(scenes: int, seed: int, radau_every: int = RADAU_EVERY, verbose: bool = False) -> list[Kept]:
    """Return the outcome of as many scenes, taken from the structures in turn."""
    random, found = np.random.default_rng(seed), []
    kinds = list(structures().items())
    for index in range(scenes):
        name, base = kinds[index % len(kinds)]
        one = kept(*drawn(base, random), radau=index % radau_every == radau_every - 1)
        found.append(one)
        if verbose:
            print(index, name, one, flush=True)
    return found


def work(accuracies: Sequence[float], scenes: int, seed: int) -> np.ndarray:
    """Return evaluations of the right-hand side, a row a scene, a column an accuracy."""
    random, rows = np.random.default_rng(seed), []
    kinds = list(structures().values())
    for index in range(scenes):
        scene, _ = drawn(kinds[index % len(kinds)], random)
        results = [simulate(with_values(scene, {"numerics.accuracy": each}), trace=False) for each in accuracies]
        rows.append([int(result.numerics.rhs_evaluations) for result in results])
    return np.array(rows)


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:] if text.isdigit()]
    count, seed = (*numbers, *(60, 1)[len(numbers) :])
    print(account(sample(count, seed, verbose="-v" in sys.argv)))
