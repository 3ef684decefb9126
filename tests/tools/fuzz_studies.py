"""Ask for random sweeps and fits of shipped machines, and judge each answer by a second way.

Run: fuzz_studies.py [sweeps|fits] [--seed 1] [--count 40] [--posterior]. A sweep varies random numbers, choices and
fluids as a grid, joined or sampled. It is computed with two workers, in lanes, or stopped and resumed, and must give
the same (in lanes within the errors told); single cases must be those of `simulate`, and what is read back the same in
every form. A fit gets points of a machine with known parameters, with noise: its residuals must be those of `simulate`
with the values found, its chi squared no larger than that of the truth. Prints a line for each answer that is odd, and
at the end how many were asked, and how often the truth lay within the intervals of 90 %, stated and by the posterior.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import re
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

import screwsim
from screwsim.figures.errors import relative_errors
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Figures
from screwsim.results import Results, open_results
from screwsim.results.read import stored_scene
from screwsim.scene import Scene, cross_check, grid, load, loads, value_at, with_values
from screwsim.scene.fields import Leaf, leaves_of, varies
from screwsim.scene.units import format_quantity
from screwsim.simulate import simulate
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.residuals import Objective
from screwsim.study.calibration.solve import Calibration
from screwsim.study.sweep.run import default_simulate_many

ROOT = Path(__file__).resolve().parents[2]
SCREWS = "paper/point paper/uncertain r134a/point r134a/separator control/point ammonia/flooded r454b/point everything"
OTHERS = "air/fixed_speed_7 air/moist expander/point slider_crank/air slider_crank/r134a co2/transcritical drive/point"
MACHINES = (*SCREWS.split(), *OTHERS.split(), "calibration/slide")
FLUIDS = "R134a", "R1234yf", "R454B", "R404A", "Ammonia", "R290", "Air", "R1234ze(E)"
LEFT_OUT = ("numerics.", "output.")
MOST_CASES = 60
WILD = 0.2  # share of axes whose values lie far from the scene's
NEAR, FAR = 0.25, 3.0  # of the logarithm of a number: how far its values lie
KELVIN = 12.0  # the same of a temperature
UNTOLD = 0.05  # of the accuracy: differences that no error estimate has to tell
NOISE, NOISE_KELVIN = 0.005, 0.5  # standard deviation: of a figure, of a temperature [K]
WITHIN_90, SURELY = 1.645, 3.3  # standard errors

Random = np.random.Generator


class Bench(NamedTuple):
    """A machine to fit: its scene, the range of its discharge pressure [bar], and its unknowns below `effects`."""

    scene: str
    pressures: tuple[float, float]
    unknown: str


GAPS = "tip_leakage.gap interlobe_leakage.gap blow_hole.area oil_heat.droplet_radius mechanical.fraction"
VALVES = "ring_leakage.gap reed_valves.discharge_port_area cylinder_heat.wall_temperature mechanical.fraction"
BENCHES = (
    Bench("configs/paper/point.yaml", (7.0, 13.0), GAPS),
    Bench("configs/slider_crank/air.yaml", (2.8, 4.5), VALVES),
)
PRESSURE = "operation.discharge.pressure"
UNITS = {"gas_mass_flow": ("kg/h", 1.0 / 3600.0), "shaft_power": ("kW", 1e3), "discharge_temperature": ("degC", 1.0)}


# ---- sweeps -----------------------------------------------------------------------------------------------------


def written(leaf: Leaf, value: float) -> Any:
    """Return a number [SI] as it stands in a scene."""
    number = float(f"{value:.9g}")
    return number if leaf.dimension is None else format_quantity(leaf.dimension, number)


def axis(random: Random, path: str, leaf: Leaf, value: float, count: int = 0) -> list[Any]:
    """Return values of an axis around that of the scene."""
    wild = random.random() < WILD
    count = count or int(random.choice([1, 2, 2, 3, 4]))
    if "temperature" in path:
        off = KELVIN * (4.0 if wild else 1.0)
        return [written(leaf, value + random.uniform(-off, off)) for _ in range(count)]
    off = FAR if wild else NEAR
    return [written(leaf, value * math.exp(random.uniform(-off, off))) for _ in range(count)]


def drawn_sweep(random: Random, scene: Scene) -> dict[str, Any]:
    """Return a random `sweep:` of a scene."""
    leaves = {p: leaf for p, leaf in leaves_of(scene).items() if varies(p, leaf) and not p.startswith(LEFT_OUT)}
    values = {path: value_at(scene, path) for path in leaves}
    numbers = [path for path, value in values.items() if isinstance(value, float) and value]
    picked = [numbers[i] for i in random.permutation(len(numbers))[:3]]
    kind = str(random.choice(["grid", "zip", "sample"]))
    asked: dict[str, Any] = {}
    if kind == "grid":
        asked = {path: axis(random, path, leaves[path], values[path]) for path in picked[: random.integers(1, 4)]}
    elif kind == "zip":
        count = int(random.choice([1, 2, 4]))
        asked["zip"] = [{path: axis(random, path, leaves[path], values[path], count) for path in picked[:2]}]
        asked[picked[2]] = axis(random, picked[2], leaves[picked[2]], values[picked[2]])
    else:
        over = {path: axis(random, path, leaves[path], values[path], 3) for path in picked[:2]}
        asked["sample"] = {"kind": "sobol", "count": 8, "seed": int(random.integers(100)), "over": over}
    choices = [path for path, leaf in leaves.items() if leaf.kind == "choice" and values[path] is not None]
    if choices and random.random() < 0.3:
        path = str(random.choice(choices))
        asked[path] = list(leaves[path].limits["options"])
    if random.random() < 0.2:
        asked["gas.fluid"] = [str(each) for each in random.choice(FLUIDS, 2, replace=False)]
    if random.random() < 0.1:
        asked["numerics.accuracy"] = [1e-3, 1e-4]
    return asked


def differing(a: Path, b: Path) -> Iterator[str]:
    """Yield the datasets of two files that are not the same, bit by bit, except for times."""
    found: list[dict[str, Any]] = []
    for path in (a, b):
        with h5py.File(path) as file:
            every: dict[str, Any] = {}
            file.visititems(
                lambda name, it, to=every: to.update({name: it[()]} if isinstance(it, h5py.Dataset) else {})
            )
            found.append(every)
    for name in sorted(found[0].keys() ^ found[1].keys()):
        yield f"{name} is in one file alone"
    for name in sorted(found[0].keys() & found[1].keys()):
        one, other = found[0][name], found[1][name]
        if not name.endswith("_time") and not np.array_equal(one, other, equal_nan=one.dtype.kind == "f"):
            yield f"{name} differs"


class Stopping:
    """A simulator of consecutive scenes that is interrupted after some of them."""

    def __init__(self, scene: Scene, after: int) -> None:
        self.many, self.left = default_simulate_many(scene), after

    def __call__(self, scenes: Any) -> Iterator[Any]:
        for result in self.many(scenes):
            self.left -= 1
            if self.left < 0:
                raise KeyboardInterrupt
            yield result


def odd_in_case(scene: Scene, results: Results, number: int) -> Iterator[str]:
    """Yield what of a case differs from the same scene simulated alone."""
    at, case = np.unravel_index(number, results.shape), grid.case(scene, number)
    status = str(results.status[at])
    try:
        faults = cross_check(case)
    except UsageError:
        faults = (None,)
    if faults:
        if status != "failed":
            yield f"is {status}, though its values do not fit"
        return
    alone = simulate(case, trace=False)
    if alone.status != status:
        yield f"is {status}, alone {alone.status}: {alone.message}"
    if status != "ok" or alone.status != "ok":
        return
    if abs(alone.performance.get("volumetric_efficiency") or 0.0) < case.numerics.accuracy:
        return  # what is divided by a flow of noise is noise, or missing
    ours = {n: float(results.performance[n][at]) for n in alone.performance if n in results.performance}
    known = Figures({name: value if math.isfinite(value) else None for name, value in ours.items()})
    for name, value in alone.performance.items():
        axes = {path.replace(".", "_") for path in results.varied}
        if (value is None) != (known.get(name) is None) and name not in axes:
            yield f"{name} is {known.get(name)}, alone {value}"
    for name, off in relative_errors(known, alone.performance).items():
        told = (alone.error.get(name) or 0.0) + float(np.nan_to_num(results.error[name][at]))
        if off is not None and off > max(2.0 * told, UNTOLD * case.numerics.accuracy):
            yield f"{name} is {known[name]}, alone {alone.performance[name]}; error told {told:.1e}"
    kinds = [sorted(re.sub(r"\d[\d.]*(e[+-]?\d+)?", "#", each) for each in of) for of in _warnings(results, at, alone)]
    if kinds[0] != kinds[1]:
        yield f"other warnings: {kinds}"


def _warnings(results: Results, at: Any, alone: Any) -> tuple[list[str], list[str]]:
    return str(results.warnings[at]).splitlines(), list(alone.warnings)


def odd_in_sweep(random: Random, scene: Scene, folder: Path, counts: Counter[str]) -> Iterator[str]:
    """Yield what is odd about a sweep: computed in two ways, read back, and case by case."""
    first, second = folder / "first.h5", folder / "second.h5"
    done = screwsim.run_sweep(scene, first, jobs=1, progress=False)
    counts.update(cases=done.cases, ok=done.ok, failed=done.failed, not_closed=done.not_closed)
    results, way = open_results(first), str(random.choice(["jobs", "resume", "batch"]))
    if way == "resume":
        try:
            many = Stopping(scene, int(random.integers(done.cases)))
            screwsim.run_sweep(scene, second, jobs=1, progress=False, simulate_many=many)
        except KeyboardInterrupt:
            counts["interrupted"] += 1
    screwsim.run_sweep(scene, second, jobs=2, batch=way == "batch", progress=False)
    found = screwsim.compare(first, second)
    if done.ok and not (found.equal and found.scene == {}):
        yield f"{way}: not the same within errors: {[each.figure for each in found.figures if each.beyond]}"
    if way != "batch":
        yield from (f"{way}: {each}" for each in differing(first, second))
    if loads(stored_scene(results)).text != scene.text:
        yield "the stored scene is another"
    frame = results.to_pandas()
    for name in results.figures:
        if not np.array_equal(frame[name].to_numpy(float), results.performance[name].ravel(), equal_nan=True):
            yield f"{name} is another in pandas"
    for number in random.permutation(done.cases)[:4]:
        yield from (f"case {number}: {each}" for each in odd_in_case(scene, results, int(number)))


def judge_sweep(random: Random, folder: Path, counts: Counter[str]) -> Iterator[str]:
    """Yield what is odd about a random sweep, its request first."""
    machine = str(random.choice(MACHINES))
    scene = load(ROOT / "configs" / f"{machine}.yaml")
    asked = drawn_sweep(random, scene)
    try:
        swept = scene.with_({"sweep": asked})
    except (SceneError, UsageError):
        counts["refused"] += 1
        return
    if grid.case_count(swept) <= MOST_CASES:
        counts["asked"] += 1
        for odd in odd_in_sweep(random, swept, folder, counts):
            yield f"{machine} {json.dumps(asked)}: {odd}"


# ---- fits -------------------------------------------------------------------------------------------------------


def write_fit(random: Random, folder: Path) -> tuple[Path, dict[str, float]]:
    """Write a fit to noisy points of a machine with known parameters; return its path and the truth [SI]."""
    bench = BENCHES[int(random.integers(len(BENCHES)))]
    scene = load(ROOT / bench.scene, ["numerics.accuracy=1e-5"])
    truth, spec, leaves = {}, {}, leaves_of(scene)
    for name in map(str, random.choice(bench.unknown.split(), int(random.integers(1, 4)), replace=False)):
        path = f"effects.{name}"
        value = float(value_at(scene, path))
        low, high = (value - 40.0, value + 60.0) if "temperature" in path else (0.4 * value, 2.2 * value)
        truth[path] = low + (high - low) * random.uniform(0.25, 0.75)
        spec[path] = {"from": written(leaves[path], low), "to": written(leaves[path], high)}
    machine, speed, rows = with_values(scene, truth), value_at(scene, "operation.speed") * 30.0 / math.pi, []
    for number in range(int(random.choice([5, 7, 9]))):
        at = float(f"{speed * random.uniform(0.5, 1.3):.6g}"), float(f"{random.uniform(*bench.pressures):.5g}")
        place = {"operation.speed": at[0] * math.pi / 30.0, PRESSURE: at[1] * 1e5}
        figures = simulate(with_values(machine, place), trace=False).performance
        row = {"name": f"p{number}", "operation.speed [rpm]": at[0], f"{PRESSURE} [bar]": at[1]}
        for name, (unit, size) in UNITS.items():
            warm = unit == "degC"
            deviation = NOISE_KELVIN if warm else NOISE * figures[name]
            measured = figures[name] + deviation * random.standard_normal() - (273.15 if warm else 0.0)
            row[f"{name} [{unit}]"] = f"{measured / size:.9g}"
            row[f"{name}_uncertainty [{'K' if warm else unit}] (k=2)"] = f"{2.0 * deviation / size:.9g}"
        rows.append(row)
    with (folder / "points.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    starts, slopes = int(random.integers(1, 4)), str(random.choice(["differences", "exact"]))
    fit = {"scene": str(ROOT / bench.scene), "data": "points.csv", "parameters": spec, "starts": starts}
    path = folder / "x.fit.yaml"
    path.write_text(json.dumps(fit | {"slopes": slopes}), encoding="utf-8")
    return path, truth


def odd_in_fit(found: Calibration, truth: dict[str, float]) -> Iterator[str]:
    """Yield what is odd about a fit: its residuals, its chi squared, and values surely beyond their standard errors."""
    chi_squared = 0.0
    for each in found.compared:
        alone = simulate(with_values(found.scene, each.point.values), trace=False).performance[each.figure]
        if each.ours is None or abs(each.ours - alone) > 0.05 * each.measured.uncertainty:
            yield f"{each.point.name}, {each.figure}: fitted {each.ours}, simulated {alone}"
        chi_squared += (each.residual or 0.0) ** 2
    if found.chi_squared is None or abs(chi_squared - found.chi_squared) > 1e-6 * (1.0 + chi_squared):
        yield f"chi squared {found.chi_squared}, of the residuals {chi_squared}"
    places = np.array([each.place(truth[each.path]) for each in found.fit.parameters])
    of_truth = Objective(found.fit).outcome(places).chi_squared
    if found.chi_squared is not None and of_truth < found.chi_squared - 0.01:
        yield f"chi squared {found.chi_squared:.4g}, of the truth {of_truth:.4g}"


def judge_fit(random: Random, folder: Path, counts: Counter[str], sampled: bool) -> Iterator[str]:
    """Yield what is odd about a random fit, its request first."""
    path, truth = write_fit(random, folder)
    found = calibrate(read_fit(path), jobs=1)
    what = f"{path.read_text(encoding='utf-8')}"
    counts["asked"] += 1
    if found.status != "ok" or found.certainty is None:
        yield f"{what}: {found.status}: {found.message}"
        return
    yield from (f"{what}: {odd}" for odd in odd_in_fit(found, truth))
    for (name, true), error in zip(truth.items(), found.certainty.errors, strict=True):
        if error is None:
            counts["at a bound"] += 1
            continue
        off = abs(found.values[name] - true) / (error * found.scale)
        counts.update({"values": 1, "within the 90 %": int(off < WITHIN_90)})
        if off > SURELY and not any(found.certainty.border):
            yield f"{what}: {name} is {found.values[name]:.5g} ± {error:.2g}, in truth {true:.5g}"
    if sampled:
        for each, true in zip(screwsim.posterior(found, jobs=1).parameters, truth.values(), strict=True):
            counts.update({"sampled": 1, "within the posterior's 90 %": int(each.low <= true <= each.high)})


def main() -> None:
    """Print what is odd about random studies, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("study", nargs="?", default="sweeps", choices=("sweeps", "fits"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--posterior", action="store_true")
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    for number in range(given.count):
        random = np.random.default_rng([given.seed, number])
        with tempfile.TemporaryDirectory() as folder:
            if given.study == "sweeps":
                odd = judge_sweep(random, Path(folder), counts)
            else:
                odd = judge_fit(random, Path(folder), counts, given.posterior)
            for line in odd:
                counts["odd"] += 1
                print(f"{number} {line}", flush=True)
    print(", ".join(f"{count} {what}" for what, count in counts.items()))


if __name__ == "__main__":
    main()
