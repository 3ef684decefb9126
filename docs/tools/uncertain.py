"""Print what docs/how-to/uncertainty.md shows of configs/paper/uncertain.yaml, and draw its figure.

    python docs/tools/uncertain.py [FOLDER]      (default: results/uncertain; the page's figure goes to docs/figures)

Each printed part stands below the command that gives it.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

from screwsim.scene import load
from screwsim.study.sweep import run_sweep

ROOT = Path(__file__).resolve().parents[2]
SCENE, FITTED = "configs/paper/uncertain.yaml", "validation/bitzer/fitted/scene.yaml"
DRAWN = {"efficiency": "uncertainty_efficiency"}


def shown(*arguments: str) -> None:
    """Run a command of screwsim in the checkout and print it above its output."""
    print(f"\n    $ screwsim {' '.join(arguments)}", flush=True)
    subprocess.run([sys.executable, "-m", "screwsim", *arguments], cwd=ROOT, check=True)


def cost(folder: Path) -> float:
    """Return the processor time of the sweep over that without tolerances, compiled before; the least of three each."""
    scene = load(ROOT / SCENE)
    plain = replace(scene, uncertain={}, correlated=())
    times: dict[bool, list[float]] = {True: [], False: []}
    for _ in range(3):
        for tolerant in (False, True):
            began = time.process_time()
            run_sweep(scene if tolerant else plain, folder / f"cost_{tolerant}.h5", jobs=1, restart=True)
            times[tolerant].append(time.process_time() - began)
    return min(times[True]) / min(times[False])


def main() -> None:
    """Run the commands of the page; keep the picture; say what the uncertainty of a sweep costs."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "results" / "uncertain")
    folder.mkdir(parents=True, exist_ok=True)
    results, figures = folder / "uncertain.h5", folder / "figures"
    shown("run", SCENE)
    shown("sensitivity", SCENE, "--check-sobol", "64")
    shown("sweep", SCENE, "-o", str(results), "--restart")
    shown("plot", str(results), "-o", str(figures))
    shown("run", FITTED, "--set", "uncertainty.model=bitzer")
    print(f"\nprocessor time of the sweep with tolerances over that without: {cost(folder):.0f}")
    for name, kept in DRAWN.items():
        print(shutil.copyfile(figures / f"{name}.png", ROOT / "docs" / "figures" / f"{kept}.png"))


if __name__ == "__main__":
    main()
