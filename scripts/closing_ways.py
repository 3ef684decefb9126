"""Print what closing costs by either way and by `auto`, over random scenes: how dear histories may get.

Run: .venv/bin/python scripts/closing_ways.py [SCENES] [SEED]. Scenes are those of scripts/fuzz.py. Evaluations of the
right-hand side of one chamber, those of the estimates included; `model.close.DEAR` is what histories may take before
they give way. Told are the scenes that close by coupled chambers and whatever the limit.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests" / "hard"), str(ROOT / "tests" / "laws")]
import fuzz_space  # noqa: E402
from scenes import make  # noqa: E402

from screwsim.faults import SceneError  # noqa: E402
from screwsim.model import close  # noqa: E402
from screwsim.scene import Scene, with_values  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

LIMITS = (0, 30_000, 60_000, close.DEAR, 240_000, 10_000_000)  # evaluations that histories may take


def scenes(count: int, seed: int) -> list[Scene]:
    """Return so many random scenes that choose their way themselves."""
    found: list[Scene] = []
    index = 0
    while len(found) < count:
        structure, shares = fuzz_space.drawn(seed, index)
        index += 1
        try:
            scene = make(fuzz_space.changes(structure, shares))
        except SceneError:
            continue
        if scene.numerics.closing == "auto":
            found.append(scene)
    return found


def evaluations(scene: Scene) -> tuple[float, str]:
    """Return what a scene costs, infinite where it does not close, and the way that closed it."""
    result = simulate(scene, trace=False)
    cost = result.numerics.rhs_evaluations if result.status == "ok" else np.inf
    return cost, str(result.numerics.get("closing"))


def within(scene: Scene, limit: int) -> tuple[float, str]:
    """Return that where histories may take so many evaluations."""
    close.DEAR = limit
    return evaluations(scene)


def main() -> None:
    """Solve every scene by coupled chambers, and by `auto` with each limit."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    rows = []
    for scene in scenes(count, seed):
        coupled, _ = evaluations(with_values(scene, {"numerics.closing": "coupled"}))
        autos = [within(scene, limit) for limit in LIMITS]
        if np.isfinite([coupled, *(cost for cost, _ in autos)]).all():
            rows.append((coupled, autos))
    by_coupled = np.array([coupled for coupled, _ in rows])
    best = np.minimum(by_coupled, [min(cost for cost, _ in autos) for _, autos in rows])
    told = f"coupled chambers take {np.median(by_coupled):.0f} evaluations in the median"
    print(f"{len(rows)} of {count} scenes close whatever the limit; {told}")
    print("\n| histories may take | given way | mean over the cheapest | all scenes |\n|---|---|---|---|")
    for place, limit in enumerate(LIMITS):
        costs = np.array([autos[place][0] for _, autos in rows])
        given = sum(autos[place][1] == "coupled" for _, autos in rows)
        mean = np.exp(np.mean(np.log(costs / best)))
        print(f"| {limit} | {given} | {mean:.2f} | {costs.sum() / 1e6:.1f} million |", flush=True)


if __name__ == "__main__":
    main()
