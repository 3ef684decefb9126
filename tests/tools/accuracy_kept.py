"""Draw random scenes and report whether the wanted accuracy is kept. Run: accuracy_kept.py [SCENES] [SEED] [-v].

The scenes are those of `tests/tools/effects_space.py`, which together have all effects; with the word `paper` they lie
around configs/paper and tests/plain/r134a.yaml, and each has a random accuracy. Every tenth is judged by scipy's Radau.
See docs/explanation/accuracy.md.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
import effects_space  # noqa: E402
from true_error import RADAU, Kept, Reference, account, drawn, kept, reference  # noqa: E402

from screwsim.inputs.faults import SceneError  # noqa: E402
from screwsim.scene import Scene, load, with_values  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

PAPER, REAL = str(ROOT / "configs" / "paper" / "point.yaml"), str(ROOT / "tests" / "plain" / "r134a.yaml")
DRY = ("oil_heat", "oil_pump", "hydromechanical", "end_face_leakage", "interlobe_leakage")
RADAU_EVERY = 10
BEYOND = 10**6  # stride of indices: where a scene makes no sense, another one of its structure is drawn

Drawn = tuple[str, Scene, dict[str, Any]]  # structure, scene, and the values drawn


def structures() -> dict[str, Scene]:
    """Return the scenes around which others are drawn."""
    return {
        "paper": load(PAPER),
        "carried": load(PAPER, ["oil.transport=carried"]),
        "dry": load(PAPER, without=DRY),
        "real": load(REAL),
    }


def around_the_paper(scenes: int, seed: int) -> Iterator[Drawn]:
    """Yield so many scenes, taken from the structures in turn."""
    random, kinds = np.random.default_rng(seed), list(structures().items())
    for index in range(scenes):
        name, base = kinds[index % len(kinds)]
        yield name, *drawn(base, random)


def of_all_effects(scenes: int, seed: int, names: Sequence[str] = tuple(effects_space.STRUCTURES)) -> Iterator[Drawn]:
    """Yield so many scenes of all effects, taken from the structures of their space in turn."""
    for index in range(scenes):
        number, kind = divmod(index, len(names))
        yield _that_makes_sense(names[kind], seed, number)


def _that_makes_sense(name: str, seed: int, first: int) -> Drawn:
    for number in itertools.count(first, BEYOND):
        try:
            scene = effects_space.scene_of(name, seed, number)
        except SceneError:
            continue
        return name, scene, dict(text.split("=", 1) for text in effects_space.drawn(name, seed, number))
    raise AssertionError("numbers do not end")


def sample(
    scenes: Iterator[Drawn],
    radau_every: int = RADAU_EVERY,
    verbose: bool = False,
    radau: float = RADAU,
    asked: Reference = reference,
) -> list[Kept]:
    """Return the outcomes of scenes, some judged by scipy's Radau with a given step tolerance."""
    found = []
    for index, (name, scene, changes) in enumerate(scenes):
        one = kept(scene, changes, radau if index % radau_every == radau_every - 1 else None, asked)
        found.append(one)
        if verbose:
            print(index, name, one, flush=True)
    return found


def work(accuracies: Sequence[float], scenes: int, seed: int) -> np.ndarray:
    """Return evaluations of the right-hand side: a row per scene around the paper's, a column per accuracy."""
    rows = []
    for _, scene, _ in around_the_paper(scenes, seed):
        results = [simulate(with_values(scene, {"numerics.accuracy": each}), trace=False) for each in accuracies]
        rows.append([int(result.numerics.rhs_evaluations) for result in results])
    return np.array(rows)


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:] if text.isdigit()]
    count, seed = (*numbers, *(60, 1)[len(numbers) :])
    drawing = around_the_paper if "paper" in sys.argv[1:] else of_all_effects
    print(account(sample(drawing(count, seed), verbose="-v" in sys.argv)))
