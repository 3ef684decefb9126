"""Do 100 000 evaluations of a profile problem finish in one run, how fast, and in how much memory?

    benchmarks/profile_optimize.py -o FILE.h5 [--evaluations 100000] [--jobs N]

`screwsim optimize` of configs/r134a/compact.yaml for the highest COP and the most cooling, over five parameters of its
rack profile and the built-in volume ratio: each evaluation has rotors, ports and gaps of its own. With `-o` what is
done is kept, and the same command goes on where an interrupted run stopped. It prints a line every 2000 evaluations
with the rate of this run, and the memory of this process and its workers together since the line before (Linux:
resident, looked at each second; pages that they share count for each).
"""

from __future__ import annotations

import argparse
import resource
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import screwsim
from screwsim.inputs.faults import UsageError
from screwsim.study.optimize import Optimum, question, run_question, spans_of
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import cores

SCENE = Path(__file__).resolve().parent.parent / "configs" / "r134a" / "compact.yaml"
PROFILES = (
    "machine.profile.flank_radius=33 mm..37 mm",
    "machine.profile.pressure_angle=32 deg..38 deg",
    "machine.profile.root_radius=4 mm..5.6 mm",
    "machine.profile.female_tip_radius=4 mm..5.6 mm",
    "machine.profile.wrap_angle=280 deg..310 deg",
    "machine.built_in_volume_ratio=2.2..4",
)
AIMS = ("cop", "cooling_capacity")
EVERY = 2000  # evaluations per line
SAMPLED = 1.0  # [s] between two samples of the memory
MIB = 1024.0  # kB


def resident() -> tuple[float, ...]:
    """Return the resident memory of this process and of each descendant [MiB]; empty without /proc."""
    found, numbers = [], ["self"]
    while numbers:
        process = Path("/proc") / numbers.pop()
        try:
            lines = (process / "status").read_text().splitlines()
            numbers += [child for task in (process / "task").iterdir() for child in _words(task / "children")]
        except OSError:  # it has just ended, or this is not Linux
            continue
        found += [float(line.split()[1]) / MIB for line in lines if line.startswith("VmRSS:")]
    return tuple(found)


def _words(file: Path) -> list[str]:
    return file.read_text().split()


class Lines(Progress):
    """Progress that prints a line every `EVERY` evaluations."""

    def __init__(self) -> None:
        self.done = self.new = self.failed = 0
        self.together = self.largest = self.own = 0.0  # MiB, since the last line
        self.peak: tuple[float, float, float] = (0.0, 0.0, 0.0)
        self.began = self.looked = time.monotonic()
        self.fresh = False  # whether evaluations are computed rather than read from the file

    def tick(self) -> None:
        """Sample the memory."""
        if not self.fresh:
            self.fresh, self.began = True, time.monotonic()
        if time.monotonic() - self.looked < SAMPLED:
            return
        self.looked, sizes = time.monotonic(), resident()
        if sizes:
            self.together = max(self.together, sum(sizes))
            self.largest, self.own = max(self.largest, *sizes[1:], 0.0), max(self.own, sizes[0])

    def advance(self, cases: int, failed: int) -> None:
        """Count evaluations, and print a line when due."""
        before = self.done // EVERY
        self.done, self.failed = self.done + cases, self.failed + failed
        self.new += cases if self.fresh else 0
        if self.done // EVERY > before and self.fresh:
            self.line()

    def line(self) -> None:
        """Print the state of the run."""
        seconds = time.monotonic() - self.began
        memory = f"{self.together:.0f} MiB together, {self.own:.0f} here, {self.largest:.0f} in the largest worker"
        print(f"{self.done:7d} {self.failed} failed {self.new / seconds:6.2f} a second {memory}", flush=True)
        one, two, three = self.peak
        self.peak = max(one, self.together), max(two, self.own), max(three, self.largest)
        self.together = self.largest = self.own = 0.0


def told(found: Optimum, lines: Lines, jobs: int) -> None:
    """Print the outcome."""
    lines.line()
    usage = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = time.monotonic() - lines.began
    print(f"{len(found.places)} evaluations, {found.reused} of them from an earlier run, {found.failed} failed")
    if lines.new:
        each = 1e3 * sum(one.ru_utime + one.ru_stime for one in usage) / lines.new
        print(f"{lines.new / seconds:.2f} a second on {jobs} workers, {each:.0f} ms of processor time each")
    print("memory at most {:.0f} MiB together, {:.0f} here, {:.0f} in the largest worker".format(*lines.peak))
    print(f"front of {len(found.front)}; its ends and its middle:")
    rows = [int(found.front[i]) for i in sorted({0, len(found.front) // 2, len(found.front) - 1}) if len(found.front)]
    for row in rows:
        aims = ", ".join(f"{name} {value:.6g}" for name, value in zip(AIMS, found.aims[row], strict=True))
        print(f"  {aims}: " + ", ".join(f"{path} {value:.5g}" for path, value in found.values_at(row).items()))
    for reason, times in list(found.reasons.items())[:5]:
        print(f"  {times} failed: {reason}")


def main() -> None:
    """Measure, and print the results."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--evaluations", type=int, default=100_000)
    parser.add_argument("--jobs", type=int, default=cores())
    parser.add_argument("-o", "--output", type=Path, help="HDF5 file; a run that was interrupted goes on")
    given = parser.parse_args()
    scene = screwsim.load(SCENE)
    asked = question(scene, spans_of(scene, PROFILES), AIMS, evaluations=given.evaluations)
    lines = Lines()
    with TemporaryDirectory() as folder:
        try:
            found = run_question(asked, given.output or Path(folder) / "out.h5", jobs=given.jobs, progress=lines)
        except UsageError as error:
            raise SystemExit(f"profile_optimize: {error}") from None
    told(found, lines, given.jobs)


if __name__ == "__main__":
    main()
