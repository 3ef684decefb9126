"""Print what a point costs: by accuracy, by effect, by speed, and the start-up of the commands.

Run: python benchmarks/point.py [SCENE.yaml]. Times are medians on one core of this computer, compiled and warm unless
stated otherwise; compare ratios, and numbers of evaluations, which do not depend on the computer.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from screwsim.codegen.modules import for_speed
from screwsim.cycle.guess import compile_start
from screwsim.cycle.problem import problem_of
from screwsim.scene import Scene, load, with_values
from screwsim.simulate import simulate, simulate_many
from screwsim.solve.accurately import solve
from screwsim.study.accuracy.coolprop_back_end import machinery_with_coolprop

ROOT = Path(__file__).resolve().parent.parent
CONFIGS = ROOT / "configs"
KEPT = "effects.separator.cooler.discharge_temperature"
POINT = CONFIGS / "paper" / "point.yaml"
REAL = ROOT / "tests" / "plain" / "r134a.yaml"
RPM = 2.0 * np.pi / 60.0
FIGURES = ("isothermal_efficiency", "gas_mass_flow", "shaft_power", "discharge_temperature")


def timed(scene: Scene, runs: int = 15):
    """Return the result and the median of its wall time [ms]."""
    simulate(scene, trace=False)
    results = [simulate(scene, trace=False) for _ in range(runs)]
    return results[-1], 1e3 * statistics.median(result.numerics.wall_time for result in results)


def with_accuracy(scene: Scene, accuracy: float) -> Scene:
    """Return the scene with another requested accuracy."""
    return replace(scene, numerics=replace(scene.numerics, accuracy=accuracy))


def accuracy_table(scene: Scene) -> None:
    """Print time and true error over the requested accuracy; the reference has 1e-8 with closing: coupled."""
    print("\nWhat accuracy costs (error: largest of efficiency, mass flow, shaft power, discharge temperature)")
    print(
        f"{'speed':>10} {'accuracy':>9} {'ms':>8} {'RHS evaluations':>16} {'turns':>6} {'closing':>10} "
        f"{'error':>8} {'estimate':>8} {'+ ms':>6}"
    )
    for rpm in (3000, 1000):
        base = with_values(scene, {"operation.speed": rpm * RPM})
        tight = replace(base.numerics, accuracy=1e-8, closing="coupled")
        reference = simulate(replace(base, numerics=tight), trace=False).performance
        for accuracy in (3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6):
            result, ms = timed(with_accuracy(base, accuracy), 15 if accuracy > 5e-5 else 3)
            error = max(abs(result.performance[name] / reference[name] - 1.0) for name in FIGURES)
            estimate = max(result.error[name] for name in FIGURES)
            n = result.numerics
            print(
                f"{rpm:>6} rpm {accuracy:>9.0e} {ms:>8.2f} {n.rhs_evaluations:>16} {n.turns:>6.3g} "
                f"{n.closing:>10} {error:>8.1e} {estimate:>8.1e} {1e3 * n.estimating_time:>6.2f}"
            )


def speed_table(scene: Scene) -> None:
    """Print the cost of slow and fast machines at the scene's accuracy, with the balances."""
    print("\nHard speeds (default accuracy)")
    print(f"{'speed':>10} {'status':>10} {'ms':>9} {'RHS evaluations':>16} {'closing':>10} {'mass':>8} {'energy':>8}")
    for rpm in (10, 50, 250, 500, 1000, 3000, 5000, 10000, 30000):
        result, ms = timed(with_values(scene, {"operation.speed": rpm * RPM}), 3)
        n, b = result.numerics, result.balance
        print(
            f"{rpm:>6} rpm {result.status:>10} {ms:>9.2f} {n.rhs_evaluations:>16} {n.closing:>10} "
            f"{b.mass:>8.1e} {b.energy:>8.1e}"
        )


def gases_table() -> None:
    """Compare the real gas with the ideal one and with CoolProp in the right-hand side (tests/plain/r134a.yaml)."""
    print("\nWhat the gas costs (tests/plain/r134a.yaml; no error estimate)")
    scene = load(str(REAL), ["numerics.error=none"])
    print(f"{'gas':>20} {'ms':>8} {'RHS evaluations':>16} {'eta_s':>9} {'ratio':>7}")
    ideal, ms_ideal = timed(replace(scene, gas=replace(scene.gas, model="ideal")))
    real, ms_real = timed(scene)
    for name, result, ms in (("ideal", ideal, ms_ideal), ("real, compiled", real, ms_real)):
        eta = result.performance.isentropic_efficiency
        print(f"{name:>20} {ms:>8.2f} {result.numerics.rhs_evaluations:>16} {eta:>9.6f} {ms / ms_ideal:>7.2f}")
    problem, slow = problem_of(scene), machinery_with_coolprop(scene)
    slow.warm_up(lambda: compile_start(problem, slow))
    runs = [solve(problem, slow) for _ in range(5)]
    ms = 1e3 * statistics.median(run.cost.closing for run in runs)
    evaluations = slow.evaluations_of(runs[-1].cost.counts)
    eta = runs[-1].evaluation.figures.isentropic_efficiency
    print(f"{'real, CoolProp':>20} {ms:>8.2f} {evaluations:>16} {eta:>9.6f} {ms / ms_ideal:>7.2f}")


COURSES = (
    ("oil ratio 0.5 to 8, 3000 rpm", POINT, "oil_supply.ratio", np.linspace(0.5, 8.0, 43), 3000),
    ("oil ratio 0.5 to 8, 1000 rpm", POINT, "oil_supply.ratio", np.linspace(0.5, 8.0, 43), 1000),
    (
        "condensing at 40 to 50 degC, real",
        REAL,
        "operation.condensing_temperature",
        273.15 + np.linspace(40, 50, 32),
        3000,
    ),
    (
        "the same, oil temperature found",
        CONFIGS / "r134a" / "point.yaml",
        "operation.condensing_temperature",
        273.15 + np.linspace(40, 50, 11),
        2950,
    ),
    (
        "package, 1475 to 2950 rpm",
        CONFIGS / "air" / "fixed_speed_7.yaml",
        "operation.speed",
        RPM * np.linspace(2950, 1475, 11),
        2950,
    ),
    (
        "package, thermostat at 70 to 86 degC",
        CONFIGS / "air" / "fixed_speed_7.yaml",
        KEPT,
        273.15 + np.arange(70, 87, 2),
        2950,
    ),
    (
        "R134a, thermostat at 62 to 70 degC",
        CONFIGS / "r134a" / "separator.yaml",
        KEPT,
        273.15 + np.arange(62, 71),
        2950,
    ),
)


def points(scenes: list[Scene], in_a_row: bool) -> tuple[float, float]:
    """Return the mean number of evaluations and the median time [ms] of a point, with all overhead included."""
    results, times = [], []
    for _ in range(3):
        started = time.perf_counter()
        alone = (simulate(scene, trace=False) for scene in scenes)
        results = list(simulate_many(scenes, trace=False) if in_a_row else alone)
        times.append(1e3 * (time.perf_counter() - started) / len(scenes))
    return statistics.mean(result.numerics.rhs_evaluations for result in results), statistics.median(times)


def course_table() -> None:
    """Print the cost of points in a row, each started from those before, beside the same points alone."""
    print("\nPoints in a row (block of a sweep) beside points alone; ms with all that is not the solution, one core")
    print(f"{'sweep':>34} {'errors':>9} {'alone: evaluations':>18} {'ms':>6} {'in a row: evaluations':>21} {'ms':>6}")
    for name, path, axis, values, rpm in COURSES:
        for error in ("estimate", "none"):
            base = with_values(load(str(path), [f"numerics.error={error}"]), {"operation.speed": rpm * RPM})
            scenes = [with_values(base, {axis: float(value)}) for value in values]
            simulate(scenes[0], trace=False)
            alone, in_a_row = points(scenes, in_a_row=False), points(scenes, in_a_row=True)
            print(f"{name:>34} {error:>9} {alone[0]:>18.0f} {alone[1]:>6.2f} {in_a_row[0]:>21.0f} {in_a_row[1]:>6.2f}")


def effects_table(scene: Scene) -> None:
    """Print each effect's cost, in time and evaluations, and its change of the efficiency, by leaving it out."""
    print("\nWhat each effect costs and changes (left out, one at a time)")
    full, ms_full = timed(scene)
    eta = full.performance.isothermal_efficiency
    print(f"{'all':>28} {ms_full:>8.2f} ms {full.numerics.rhs_evaluations:>7} evaluations  eta {eta:.4f}")
    for name in scene.effects:
        if name in ("suction_port", "discharge_port"):
            continue
        rest = {key: value for key, value in scene.effects.items() if key != name}
        result, ms = timed(replace(scene, effects=rest))
        change = 100.0 * ((result.performance.isothermal_efficiency or np.nan) - eta)
        count = result.numerics.rhs_evaluations
        print(f"{'without ' + name:>28} {ms:>8.2f} ms {count:>7} evaluations  {change:+.2f} points")


def command_times(scene_path: Path) -> None:
    """Print the start-up times of the commands, warm, and the first compilation, with a separate cache folder."""
    print("\nCommands (whole processes; median of 5 warm runs)")
    screwsim = [sys.executable, "-m", "screwsim"]
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"SCREWSIM_CACHE": folder}
        run = [*screwsim, "run", str(scene_path), "--json"]
        for label, command, count in (
            ("run, cold cache", run, 1),
            ("run, warm", run, 5),
            ("--help", [*screwsim, "--help"], 5),
        ):
            times = []
            for _ in range(count):
                started = time.perf_counter()
                subprocess.run(command, env=environment, check=True, capture_output=True)
                times.append(time.perf_counter() - started)
            print(f"{label:>20} {statistics.median(times):>7.2f} s")


@for_speed()
def main() -> None:
    """Print all tables for one scene."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else POINT
    scene = load(str(path))
    accuracy_table(scene)
    speed_table(scene)
    gases_table()
    course_table()
    effects_table(scene)
    command_times(path)


if __name__ == "__main__":
    main()
