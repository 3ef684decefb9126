"""Print what PDSim's own examples take beside the same machines here: medians of paired runs.

Run: python benchmarks/beside_pdsim.py --python PYTHON --examples FOLDER [--pairs 5]. PDSim (github.com/ibell/pdsim) is
built from its repository: what the package index has of it lacks its compiled modules. In an environment of its own,

    git clone --recursive https://github.com/ibell/pdsim
    pip install cython numpy scipy matplotlib h5py CoolProp ./pdsim

whose interpreter is PYTHON; FOLDER is `pdsim/examples`. Its examples are run as they are. Each tells the time that
its solution took, and its figures: flow, power on the gas (p dV), and by how much what leaves differs from what enters.
Ours is the time of one point, alone, compiled, without the estimate of errors, at the accuracy of the scene. The
machines are those of the examples, by their numbers, as near as the two programs are: theirs have tubes, a shell or a
lump at a temperature that is found, ours none; their reeds are pushed by the flow's drag. A scroll is no machine of
ours, and its example is timed alone.
"""

from __future__ import annotations

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from screwsim.codegen.modules import for_speed
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate

NUMBER = r"([0-9.eE+-]+)"
TOOK = re.compile(rf"time taken\W*{NUMBER}")
FLOW = re.compile(rf"Mass flow rate is\s*{NUMBER}\s*g/s")
POWER = re.compile(rf"P-v,Qamb\s*\S+\s+{NUMBER}")  # [kW]
UNCLOSED = re.compile(rf"mdot \[%\]\s*{NUMBER}")
NEEDS = "PDSim.flow.flow", "PDSim.core.core"  # compiled modules imported by an example
PATIENCE = 1800.0  # [s] for one example
# simple_example.py: V = 0.5 cm³ + 4 cm³ (1 − cos θ), a bore of 20 mm on a long rod; ports that pass one direction only
ONE_CHAMBER = """
machine: {kind: slider_crank, bore: 20 mm, crank_radius: 12.7324 mm, rod_length: 0.5 m, clearance: 0.5 cm^3}
gas: {fluid: Air, model: real}
operation:
  speed: 377 rad/s
  suction: {pressure: 101325 Pa, temperature: 298.15 K}
  discharge: {pressure: 405300 Pa}
effects:
  check_valves: {suction_area: 27.34 mm^2, discharge_area: 27.34 mm^2}
numerics: {error: none}
"""
# recip_compressor.py: R410A of 289.15 K and 33.1 kg/m³, to 2.5 times its pressure
RECIPROCATING = """
machine: {kind: slider_crank, bore: 20 mm, crank_radius: 10 mm, rod_length: 40 mm, clearance: 0.9425 cm^3}
gas: {fluid: R410A, model: real}
operation:
  speed: 377 rad/s
  suction: {pressure: 930.2 kPa, temperature: 289.15 K}
  discharge: {pressure: 2325.5 kPa}
effects:
  reed_valves:
    {suction_port_area: 27.34 mm^2, suction_perimeter: 18.54 mm, suction_stop: 1.8 mm, suction_mass: 51.5 mg,
    suction_stiffness: 310 N/m, discharge_port_area: 27.34 mm^2, discharge_perimeter: 18.54 mm, discharge_stop: 1.8 mm,
    discharge_mass: 51.5 mg, discharge_stiffness: 310 N/m}
  ring_leakage: {gap: 10 um}
numerics: {error: none}
"""
EXAMPLES: Mapping[str, str | None] = {
    "simple_example.py": ONE_CHAMBER,
    "recip_compressor.py": RECIPROCATING,
    "scroll_compressor.py": None,
}


def missing(python: str, needs: tuple[str, ...] = NEEDS) -> str:
    """Return why an interpreter cannot run PDSim, in one line; empty if it can."""
    try:
        found = subprocess.run([python, "-c", f"import {', '.join(needs)}"], capture_output=True, text=True)
    except OSError as error:
        return f"--python {python}: {error.strerror} (give the interpreter of PDSim's environment)"
    why = (found.stderr.strip().splitlines() or [""])[-1]
    remedy = "build PDSim from its repository; --help says how"
    return "" if found.returncode == 0 else f"--python {python}: has no PDSim that runs: {why} ({remedy})"


class Solved(NamedTuple):
    """Time and figures of one solution; None for a figure that is not reported."""

    seconds: float
    flow: float | None = None  # [g/s]
    power: float | None = None  # [W], of the pistons on the gas
    unclosed: float | None = None  # outflow over inflow, less 1

    def told(self) -> str:
        """Return the figures in words."""
        parts = (self.flow, "{:.4g} g/s"), (self.power, "{:.4g} W"), (self.unclosed, "mass unclosed by {:.1e}")
        return ", ".join(text.format(value) for value, text in parts if value is not None)


def theirs(python: str, example: Path) -> list[Solved]:
    """Return the reported solutions of an example; raise RuntimeError if it reports no time."""
    with tempfile.TemporaryDirectory() as folder:  # it writes files into its working folder
        environment = os.environ | {"MPLBACKEND": "Agg"}
        command = [python, str(example.resolve())]
        run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=PATIENCE)
    solutions, start = [], 0
    for took in TOOK.finditer(run.stdout):  # figures are reported before the time
        found = (pattern.findall(run.stdout, start, took.start()) for pattern in (FLOW, POWER, UNCLOSED))
        flow, power, unclosed = (float(each[-1]) if each else None for each in found)
        scaled = None if power is None else 1e3 * power, None if unclosed is None else abs(unclosed) / 100.0
        solutions.append(Solved(float(took[1]), flow, *scaled))
        start = took.end()
    if not solutions:
        last = (run.stderr.strip().splitlines() or ["it tells no time"])[-1]
        raise RuntimeError(f"{example.name}: {last}")
    return solutions


def ours(scene: Scene) -> Solved:
    """Return time and figures of one point; raise RuntimeError if it does not close."""
    result: Any = simulate(scene, trace=False)
    if result.status != "ok":
        raise RuntimeError(result.told)
    figures = result.performance
    made = 1e3 * figures.gas_mass_flow, figures.indicated_power, abs(result.balance.mass)
    return Solved(result.numerics.wall_time, *made)


def pairs(python: str, example: Path, text: str | None, count: int) -> str:
    """Return in words the times and figures of paired runs: an example's fastest solution beside a point here."""
    scene = None if text is None else loads(text)
    if scene is not None:
        ours(scene)
        ours(scene)
    found = [(min(theirs(python, example)), None if scene is None else ours(scene)) for _ in range(count)]
    peer = statistics.median(one.seconds for one, _ in found)
    last, own = found[-1]
    there = f"{example.name}: PDSim {peer:.3g} s" + (f" ({last.told()})" if last.told() else "")
    if own is None:
        return f"{there}; no machine of ours"
    here = statistics.median(other.seconds for _, other in found if other is not None)
    ratio = statistics.median(one.seconds / other.seconds for one, other in found if other is not None)
    return f"{there}, here {1e3 * here:.3g} ms ({own.told()}): {ratio:.3g} times (median of {count} pairs)"


@for_speed()
def main() -> int:
    """Run the examples that are present."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--examples", type=Path, default=Path("pdsim/examples"))
    parser.add_argument("--pairs", type=int, default=5)
    given = parser.parse_args()
    why = missing(given.python)
    if not why and not any((given.examples / name).is_file() for name in EXAMPLES):
        why = f"--examples {given.examples}: none of {', '.join(EXAMPLES)} is there (give PDSim's folder of examples)"
    if why:
        print(why, file=sys.stderr)
        return 1
    for name, text in EXAMPLES.items():
        if (given.examples / name).is_file():
            try:
                print(pairs(given.python, given.examples / name, text, given.pairs), flush=True)
            except (RuntimeError, subprocess.TimeoutExpired) as error:
                print(f"{name}: {error}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
