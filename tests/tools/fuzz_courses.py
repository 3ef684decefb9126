"""Solve random courses: scenes far apart, each begun from the cycles before, against each alone and finer.

Run: fuzz_courses.py [KIND …] [--seeds 8] [--count 30] [--outcome FILE]. A sweep hands on stored trajectories, tangents
and contraction rates; in a course of random scenes these belong to other machines than the next one. Each scene that is
ok is solved again from a cold start, at a fortieth of the wanted accuracy. Prints a line per course, with each scene
whose error exceeds the wanted accuracy without a warning, and its error when solved alone from a cold start.
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.figures.errors import relative_errors, worst
from screwsim.outputs import Figures, Result
from screwsim.scene import Scene, load, with_values
from screwsim.simulate import simulate, simulate_many

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
from records import by_records  # noqa: E402
from true_error import warns  # noqa: E402

FINER = 40.0  # the wanted accuracy over that of the trusted solution
RPM, BAR = math.pi / 30.0, 1e5
SPEED, RATIO = "operation.speed", "oil_supply.ratio"
CONDENSING, EVAPORATING = "operation.condensing_temperature", "operation.evaporating_temperature"
PRESSURE = "operation.discharge.pressure"
PLENUMS = "discharge_volume: 3 l, suction_volume: 8 l, discharge_area: 15 cm^2, suction_area: 40 cm^2"
VALVE = "discharge_valve: {area: 12 cm^2, pressure: 0.1 bar}"


@dataclass(frozen=True)
class Kind:
    """A shipped scene, its changes, and the ranges of drawn numbers: in logarithms, or evenly."""

    file: str
    drawn: dict[str, tuple[float, float]]
    changes: tuple[str, ...] = ()
    evenly: dict[str, tuple[float, float]] = field(default_factory=dict)


def _celsius(low: float, high: float) -> tuple[float, float]:
    return 273.15 + low, 273.15 + high


def _speed(low: float, high: float) -> dict[str, tuple[float, float]]:
    return {SPEED: (low * RPM, high * RPM)}


GAPS = {f"effects.{name}_leakage.gap": (1e-5, 2e-4) for name in ("tip", "interlobe")}
BETWEEN = {CONDENSING: _celsius(30.0, 55.0)}
BOTH = {CONDENSING: _celsius(30.0, 60.0), EVAPORATING: _celsius(-15.0, 10.0)}
COLD = {CONDENSING: _celsius(25.0, 45.0), EVAPORATING: _celsius(-30.0, 5.0)}
CARRIED = ("oil.transport=carried", "oil_supply.temperature=320 K")
SOLUBLE = (
    "oil.transport=carried",
    "oil_supply={ratio: 1, temperature: 325 K}",
    "effects.oil_injection={opens: 365 deg, closes: 455 deg}",
    "effects.refrigerant_solubility={separator_temperature: 70 degC}",
)
KINDS = {
    "paper": Kind("paper/point", _speed(400, 15000) | {RATIO: (0.01, 30.0), PRESSURE: (4 * BAR, 18 * BAR)}),
    "carried": Kind("paper/point", _speed(300, 8000) | {RATIO: (0.01, 30.0), PRESSURE: (4 * BAR, 18 * BAR)}, CARRIED),
    "leaks": Kind("paper/point", _speed(400, 6000) | {RATIO: (0.02, 20.0)} | GAPS),
    "solubility": Kind("paper/point", _speed(500, 5000) | {RATIO: (0.1, 8.0)}, SOLUBLE),
    "plenums": Kind("paper/point", _speed(500, 6000) | {RATIO: (0.05, 20.0)}, (f"effects.plenums={{{PLENUMS}}}",)),
    "valve": Kind("paper/point", _speed(500, 5000) | {RATIO: (0.1, 8.0)}, (f"effects.plenums={{{PLENUMS}, {VALVE}}}",)),
    "drive": Kind("drive/point", {PRESSURE: (6 * BAR, 14 * BAR), RATIO: (0.2, 8.0)}),
    "real gas": Kind("r134a/point", _speed(600, 6000), evenly=BOTH),
    "separator": Kind("r134a/separator", _speed(1000, 5000), evenly=BETWEEN),
    "blend": Kind("r454b/point", _speed(800, 5000)),
    "ammonia": Kind(
        "ammonia/flooded", {}, evenly={CONDENSING: _celsius(25.0, 45.0), EVAPORATING: _celsius(-30.0, 5.0)}
    ),
    "slide valve": Kind("control/slide_valve", _speed(500, 5000), evenly={"effects.slide_valve.position": (0.0, 0.6)}),
    "displaced": Kind("control/displaced", _speed(800, 5000), evenly=BETWEEN),
    "bypass": Kind("control/bypass_displaced", _speed(800, 5000)),
    "two stages": Kind("two_stage/low", _speed(800, 5000) | {RATIO: (0.05, 5.0)}),
    "rotors": Kind("rotors/b", _speed(1000, 5000), evenly=BETWEEN),
    "air": Kind("air/fixed_speed_7", _speed(1000, 6000) | {PRESSURE: (4 * BAR, 12 * BAR)}),
    "expander": Kind("expander/point", _speed(600, 6000)),
    "piston": Kind("slider_crank/r134a", _speed(500, 3000), evenly=BOTH),
    "CO2": Kind("co2/transcritical", _speed(600, 5000)),
    "everything": Kind("everything", {}, ("effects.drive=off",), BOTH),
}


def course(kind: Kind, seed: int, count: int) -> list[Scene]:
    """Return the scenes of a course, in its order."""
    base = replace(load(ROOT / "configs" / f"{kind.file}.yaml", kind.changes), sweep={})
    random = np.random.default_rng(seed)
    return [with_values(base, _drawn(kind, random)) for _ in range(count)]


def _drawn(kind: Kind, random: np.random.Generator) -> dict[str, float]:
    found = {path: float(np.exp(random.uniform(*np.log(ends)))) for path, ends in kind.drawn.items()}
    return found | {path: float(random.uniform(*ends)) for path, ends in kind.evenly.items()}


def off(found: Result, scene: Scene) -> tuple[str, float] | None:
    """Return the figure of a result with the largest error, and that error; None where nothing finer closes."""
    finer = replace(scene.numerics, accuracy=scene.numerics.accuracy / FINER, error="none")
    true = simulate(replace(scene, numerics=finer), trace=False)
    return worst(relative_errors(found.performance, Figures(true.performance))) if true.status == "ok" else None


def made(kind: Kind, seed: int, count: int) -> dict[str, Any]:
    """Return the outcome of a course: how many scenes were ok, compared and beyond, and the worst."""
    scenes, row = course(kind, seed, count), {"scenes": count, "ok": 0, "compared": 0, "warned": 0, "worst": 0.0}
    beyond: list[dict[str, Any]] = []
    for number, (scene, found) in enumerate(zip(scenes, simulate_many(scenes, trace=False), strict=True)):
        wanted = scene.numerics.accuracy
        true = off(found, scene) if found.status == "ok" else None
        row["ok"] += found.status == "ok"
        if true is None:
            continue
        figure, size = true
        warned = warns(found, wanted)
        row["compared"] += 1
        row["warned"] += warned
        if not warned:
            row["worst"] = max(row["worst"], float(f"{size / wanted:.3g}"))
        if size > wanted and not warned:
            alone = off(simulate(scene, trace=False), scene)
            told = {
                "figure": figure,
                "wanted": wanted,
                "off": size,
                "estimated": found.error.get(figure),
                "alone": alone and alone[1],
            }
            beyond.append({"scene": number, **told})
    return row | {"beyond": beyond}


def main() -> None:
    """Solve the requested courses, print a line for each and store the outcome."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=f"of {', '.join(KINDS)} (default: all)")
    parser.add_argument("--seeds", type=int, default=8, help="courses of each kind")
    parser.add_argument("--count", type=int, default=30, help="scenes of a course")
    parser.add_argument("--outcome", type=Path, help="file of the summary")
    asked = parser.parse_args()
    unknown = sorted(set(asked.kinds) - set(KINDS))
    if unknown:
        parser.error(f"there is no kind {unknown[0]!r} (write some of: {', '.join(KINDS)})")
    found: dict[str, list[dict[str, Any]]] = {}
    for name in asked.kinds or KINDS:
        found[name] = [made(KINDS[name], seed, asked.count) for seed in range(1, asked.seeds + 1)]
        for seed, row in enumerate(found[name], 1):
            print(f"{name} {seed}: {row}", flush=True)
    if asked.outcome:
        command = f"fuzz_courses.py --seeds {asked.seeds} --count {asked.count}"
        asked.outcome.write_text(by_records({"command": command, "kinds": found}, 3) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
