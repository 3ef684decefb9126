"""Solve random scenes and their twins at a speed that differs by 1e-12 of itself, and ask how far the two are apart.

Run: twins.py SEED [--first N]. Closings whose end depends on rounding show this without a finer solution: their twins
differ by more than both error estimates. The scenes are those of `effects_space.py`. Prints a line for each scene whose
twin has another status, or figures that differ by more than the wanted accuracy and both errors, without a warning.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
import effects_space  # noqa: E402
from judging import Stopped, limited  # noqa: E402
from true_error import warns  # noqa: E402

from screwsim.figures.errors import relative_errors  # noqa: E402
from screwsim.inputs.faults import SceneError  # noqa: E402
from screwsim.scene import Scene  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

APART = 1e-12  # of the speed
SECONDS = 60.0  # for a scene, and for its twin


def apart(scene: Scene) -> str:
    """Return in words how a scene and its twin differ, an empty text where they agree."""
    accuracy, operation = scene.numerics.accuracy, scene.operation
    twin = replace(scene, operation=replace(operation, speed=operation.speed * (1.0 + APART)))
    with limited(SECONDS):
        one = simulate(scene, trace=False)
    with limited(SECONDS):
        other = simulate(twin, trace=False)
    if one.status != other.status:
        return f"{one.status}, and {other.status}"
    if one.status != "ok" or warns(one, accuracy) or warns(other, accuracy):
        return ""
    told = {name: max(accuracy, (one.error.get(name) or 0.0) + (other.error.get(name) or 0.0)) for name in one.error}
    off = relative_errors(one.performance, other.performance)
    far = {
        name: size / told[name] for name, size in off.items() if size is not None and size > told.get(name, accuracy)
    }
    return ", ".join(f"{name} by {size:.2g} of what is allowed" for name, size in far.items())


def main() -> None:
    """Draw scenes of a seed and print those whose twins are apart."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seed", type=int)
    parser.add_argument("--first", type=int, default=100, help="so many scenes (100)")
    asked = parser.parse_args()
    for index in range(asked.first):
        structure, number = effects_space.structure_of(index)
        try:
            found = apart(effects_space.scene_of(structure, asked.seed, number))
        except (SceneError, Stopped):
            continue
        if found:
            print(f"{index} ({structure}): {found}", flush=True)


if __name__ == "__main__":
    main()
