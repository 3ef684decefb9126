"""Print what docs/how-to/uncertainty.md shows of configs/paper/uncertain.yaml, and draw its figure.

    python scripts/uncertain.py [FOLDER]      (default: results/uncertain; the figure of the page goes to docs/figures)

Each printed part stands below the command that gives it.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENE, FITTED = "configs/paper/uncertain.yaml", "validation/bitzer/fitted/scene.yaml"
DRAWN = {"efficiency": "uncertainty_efficiency"}


def shown(*arguments: str) -> None:
    """Run a command of screwsim in the checkout and print it above its output."""
    print(f"\n    $ screwsim {' '.join(arguments)}", flush=True)
    subprocess.run([sys.executable, "-m", "screwsim", *arguments], cwd=ROOT, check=True)


def main() -> None:
    """Run the commands of the page; keep the picture."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "results" / "uncertain")
    folder.mkdir(parents=True, exist_ok=True)
    results, figures = folder / "uncertain.h5", folder / "figures"
    shown("run", SCENE)
    shown("sensitivity", SCENE, "--check-sobol", "64")
    shown("sweep", SCENE, "-o", str(results), "--restart")
    shown("plot", str(results), "-o", str(figures))
    shown("run", FITTED, "--set", "uncertainty.model=bitzer")
    for name, kept in DRAWN.items():
        print(shutil.copyfile(figures / f"{name}.png", ROOT / "docs" / "figures" / f"{kept}.png"))


if __name__ == "__main__":
    main()
