"""Time a combination of effects that was never solved before, from the command to its first result (docs).

Run: python benchmarks/first_result.py [SCENE ...] (default: the paper's point, the R134a machine and all effects). Each
`screwsim run` is a separate process with a cache that has only the scene's fluid: the one-time cost of a fluid is in
the first column, for the first scene including Python's bytecode of the package if that is missing. Then each effect of
the first scene is left out in turn: `without` gives median and largest of these runs, `--knock-out` all of them in one
command. Wall times [s]; `processor` is the command's processor time, which a busy machine lengthens less.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from screwsim.scene import load

CONFIGS = Path(__file__).resolve().parent.parent / "configs"
SCENES = ("paper/point.yaml", "r134a/point.yaml", "everything.yaml")


def run(cache: Path, *words: str) -> tuple[float, float]:
    """Return the wall and processor time [s] of a command with a cache."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-m", "screwsim", "run", *words, "--json"]
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}  # as installed
    subprocess.run(command, env={**kept, "SCREWSIM_CACHE": str(cache)}, capture_output=True, check=True)
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def forget_models(cache: Path) -> None:
    """Remove everything from a cache except fluid data."""
    for path in cache.iterdir():
        if path.name.startswith("screwsim_model_"):
            path.unlink()


def main() -> None:
    """Print the table."""
    names = sys.argv[1:] or [str(CONFIGS / name) for name in SCENES]
    print(f"{'scene':36} {'nothing kept':>16} {'new combination':>16} {'kept':>16}   wall (processor) [s]")
    with tempfile.TemporaryDirectory() as folder:
        for k, name in enumerate(names):
            cache = Path(folder) / str(k)
            cache.mkdir(mode=0o700)
            times = [run(cache, name)]
            forget_models(cache)
            times += [run(cache, name), run(cache, name)]
            shown = " ".join(f"{f'{wall:.2f} ({cpu:.2f})':>16}" for wall, cpu in times)
            print(f"{'/'.join(Path(name).parts[-2:]):36} {shown}", flush=True)
        first, effects = names[0], list(load(names[0]).effects)
        cache = Path(folder) / "0"
        alone = [run(cache, first, "--without", effect)[0] for effect in effects]
        middle, largest = statistics.median(alone), max(alone)
        print(f"without one of {len(effects)} effects: median {middle:.2f}, largest {largest:.2f} s")
        forget_models(cache)
        print(f"--knock-out of {len(effects)} effects: {run(cache, first, '--knock-out')[0]:.1f} s", flush=True)


if __name__ == "__main__":
    main()
