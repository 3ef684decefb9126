"""Draw scenes at random and tell whether the wanted accuracy is kept. Run: accuracy_kept.py [SCENES] [SEED] [-v].

The scenes lie around configs/paper and configs/r134a; every tenth is judged by scipy's Radau. See docs/accuracy.md.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from screwsim.scene import Scene, load
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


def sample(scenes: int, seed: int, verbose: bool = False) -> list[Kept]:
    """Return the outcome of as many scenes, taken from the structures in turn."""
    random, found = np.random.default_rng(seed), []
    kinds = list(structures().items())
    for index in range(scenes):
        name, base = kinds[index % len(kinds)]
        one = kept(*drawn(base, random), radau=index % RADAU_EVERY == RADAU_EVERY - 1)
        found.append(one)
        if verbose:
            print(index, name, one, flush=True)
    return found


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:] if text.isdigit()]
    count, seed = (*numbers, *(60, 1)[len(numbers) :])
    print(account(sample(count, seed, "-v" in sys.argv)))
