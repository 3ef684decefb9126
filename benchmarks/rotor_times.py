"""Print the cost of rotors: processor time from a profile to all tables of a scene's machine, checks included.

Run: python benchmarks/rotor_times.py. Minimum and median of several runs without any cached result; then a machine with
the same profile and another built-in ratio, for which the rotors are cached.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from screwsim.machine import profile_law
from screwsim.machine.rotors import rotors
from screwsim.scene import load

CONFIGS = Path(__file__).resolve().parent.parent / "configs" / "rotors"
RUNS = 25


def forget() -> None:
    """Clear the caches of rotors and their curves."""
    for kept in (profile_law._laid, rotors._rotors, rotors._checked_chain):
        kept.cache_clear()


def milliseconds(before: Callable[[], object], work: Callable[[], object]) -> list[float]:
    """Return the processor time of each run [ms], without that of `before`."""
    found = []
    for _ in range(RUNS):
        before()
        started = time.process_time()
        work()
        found.append(1e3 * (time.process_time() - started))
    return found


def main() -> None:
    """Print one line per machine."""
    print(f"{'':<6}{'from nothing':>24}{'another ratio':>24}   ms: least, median of {RUNS}")
    for name in "abc":
        machine = load(CONFIGS / f"{name}.yaml").machine
        other = replace(machine, built_in_volume_ratio=2.6)
        whole = milliseconds(forget, lambda m=machine: profile_law.laid_curves(m))
        again = milliseconds(
            lambda m=machine: (profile_law._laid.cache_clear(), profile_law.laid_curves(m)),
            lambda m=other: profile_law.laid_curves(m),
        )
        shown = "".join(f"{min(ms):14.1f}{statistics.median(ms):10.1f}" for ms in (whole, again))
        print(f"({name})   {shown}")


if __name__ == "__main__":
    main()
