"""Print what rotor profiles decide: the machines of configs/rotors, wrap, length, built-in ratio, clearance, speed.

Run: .venv/bin/python scripts/profiles.py [-o DIR]; -o draws the figures profiles and profile_studies there. Machines
are compared at the displacement per male revolution of (b): all lengths of a machine are scaled together, while
clearances stay. Published values are the mean of Bitzer's compact screws (validation/bitzer).
"""

import argparse
import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from screwsim.machine.geometry import Geometry
from screwsim.machine.profile_law import laid_curves
from screwsim.outputs import Result
from screwsim.report.style import COLOURS, DASHES, DOUBLE, SMALL, panels, plain_ticks, subplots, write_all
from screwsim.scene import Scene, load
from screwsim.scene.grid import with_values
from screwsim.simulate import simulate
from screwsim.study.validation import read_table

ROOT = Path(__file__).resolve().parent.parent
PUBLISHED = ROOT / "validation" / "bitzer" / "conditions.csv"
NAMES = {"a": "symmetric 4/6", "b": "asymmetric 4/6", "c": "asymmetric 5/6"}
GAPS = ("tip_leakage", "interlobe_leakage", "end_face_leakage")
LOSSES = (*GAPS[:2], "blow_hole", GAPS[2], "suction_port", "discharge_port", "oil_heat")
ROUNDED = ("male_tip", "female_tip", "flank", "root")
MM, DEG = 1e-3, math.pi / 180.0
SHADES = ("#3b2a8c", "#c2561a", "#9dc9e6", "#e8e8e8")
AXES = {
    "wrap angle": "wrap angle (°)",
    "L/D": "length over diameter",
    "female tip radius mm": "female tip radius (mm)",
    "clearance um, all gaps": "all clearances (µm)",
    "tip speed m/s": "tip speed (m/s)",
}


def matched(scene: Scene, wanted: float) -> Scene:
    """Return the scene with all lengths of the rotors scaled to a displacement [m³]."""
    factor = (wanted / displacement(scene)) ** (1.0 / 3.0)
    machine, profile = scene.machine, scene.machine.profile
    lengths = {f"machine.{name}": getattr(machine, name) for name in ("rotor_diameter", "rotor_length")}
    names = ("centre_distance", "female_diameter", *(f"{part}_radius" for part in ROUNDED))
    lengths |= {f"machine.profile.{name}": getattr(profile, name) for name in names}
    return with_values(scene, {path: factor * value for path, value in lengths.items() if value is not None})


def displacement(scene: Scene) -> float:
    """Return the displacement per male revolution [m³]."""
    geometry = Geometry(scene.machine)
    return geometry.swept_volume * geometry.lobes


def figures(scene: Scene) -> str:
    """Return λ and η_s of a scene, and its status where it is not ok."""
    result = simulate(scene, trace=False)
    found = result.performance
    text = f"{found.volumetric_efficiency:8.4f} {found.isentropic_efficiency:8.4f}"
    return text if result.status == "ok" else f"{text} {result.status}"


def compare(scenes: dict[str, Scene]) -> dict[str, Result]:
    """Print the profiles at one displacement, with the exergy destroyed by their effects; return their results."""
    results = {}
    print("Profiles at one displacement and one set of clearances, R134a 2/45 degC")
    head = "".join(f"{name.replace('_leakage', '').replace('_', ' '):>16}" for name in LOSSES)
    print(f"{'':<44} destroyed, % of shaft power")
    print(f"{'':<16}{'D mm':>6}{'lambda':>8}{'eta_s':>8}{'kW':>7}{head}")
    for name, scene in scenes.items():
        result = results[name] = simulate(scene)
        found = result.performance
        parts = "".join(f"{_share(result, loss):16.2f}" for loss in LOSSES)
        print(
            f"{NAMES[name]:<16}{scene.machine.rotor_diameter / MM:6.1f}{found.volumetric_efficiency:8.4f}"
            f"{found.isentropic_efficiency:8.4f}{found.shaft_power / 1e3:7.2f}{parts}   {result.status}"
        )
    return results


def _share(result: Result, name: str) -> float:
    return 100.0 * result.ledger[f"exergy_destroyed_{name}"] / result.ledger["shaft_power"]


def variations(b: Scene) -> Iterator[tuple[str, list[tuple[str, Scene]]]]:
    """Yield (varied quantity, [(value, scene)]) for profile (b) at one displacement."""
    wanted, slender = displacement(b), b.machine.rotor_length / b.machine.rotor_diameter
    for name, values, path, unit in (
        ("wrap angle", (240, 260, 280, 300, 320, 340), "machine.profile.wrap_angle", DEG),
        ("L/D", (0.9, 1.1, 1.3, 1.5, 1.65, 1.8), "machine.rotor_length", b.machine.rotor_length / slender),
        ("built-in volume ratio", (2.2, 2.6, 3.0, 3.4, 3.8, 4.5), "machine.built_in_volume_ratio", 1.0),
        ("female tip radius mm", (4.0, 4.8, 6.4, 8.0, 9.6), "machine.profile.female_tip_radius", MM),
    ):
        yield name, [(f"{v:g}", matched(with_values(b, {path: v * unit}), wanted)) for v in values]
    gaps = [(f"{v:g}", {f"effects.{name}.gap": v * 1e-6 for name in GAPS}) for v in (10, 20, 30, 40, 60, 80)]
    yield "clearance um, all gaps", [(text, with_values(b, values)) for text, values in gaps]
    radius = 0.5 * b.machine.rotor_diameter
    speeds = [(f"{u:g}", {"operation.speed": u / radius}) for u in (10, 15, 20, 25, 35, 50)]
    yield "tip speed m/s", [(text, with_values(b, values)) for text, values in speeds]


def paths(b: Scene) -> None:
    """Print the effect of each leakage path of (b), by its kind and the pitches between its chambers."""
    laid, whole = laid_curves(b.machine), simulate(b, trace=False).performance
    print("\nWhat a path takes of profile (b), path by path: lambda, eta_s")
    number = 0
    for gap, interfaces in laid.interfaces.items():
        for one in interfaces:
            closed = replace(one, table=one.table.times(1e-9))  # so that the same model is used as compiled
            others = tuple(closed if other is one else other for other in interfaces)
            changed = replace(laid, interfaces={**laid.interfaces, gap: others})
            number += 1  # another machine, whose geometry is not cached yet
            other = with_values(b, {"machine.rotor_length": b.machine.rotor_length * (1.0 + 1e-13 * number)})
            with patch("screwsim.machine.profile_law.laid_curves", return_value=changed):
                found = simulate(other, trace=False).performance
            gained = [found[name] - whole[name] for name in ("volumetric_efficiency", "isentropic_efficiency")]
            print(f"{gap:<18}{one.offset:>3}{gained[0]:9.4f}{gained[1]:9.4f}")


def published(scenes: dict[str, Scene]) -> None:
    """Print λ and η_s of all profiles beside Bitzer's mean."""
    print("\nBeside the mean of Bitzer's compact screws (motor apart): lambda, eta_s")
    print(f"{'To/Tc degC':<12}{'pi':>6}{'published':>18}" + "".join(f"{NAMES[name]:>20}" for name in scenes))
    for row in read_table(PUBLISHED):
        sides = ("evaporating", "condensing")
        T = {f"operation.{side}_temperature": float(row[f"{side}_degC"]) + 273.15 for side in sides}
        line = f"{row['evaporating_degC'] + '/' + row['condensing_degC']:<12}{float(row['pressure_ratio']):6.3f}"
        line += f"{float(row['volumetric_efficiency']):10.3f}{float(row['isentropic_efficiency']):8.3f}"
        print(line + "".join(f"   {figures(with_values(scene, T))}" for scene in scenes.values()))


def _profiles_figure(results: dict[str, Result]) -> Any:
    figure, (left, right) = subplots(DOUBLE, 66.0, 1, 2, width_ratios=(1.0, 1.9))
    places = np.arange(len(results))
    for j, text in enumerate(("volumetric", "isentropic")):
        heights = [100.0 * result.performance[f"{text}_efficiency"] for result in results.values()]
        bars = left.bar(places + 0.4 * (j - 0.5), heights, 0.38, color=SHADES[2 * j], edgecolor="black", label=text)
        left.bar_label(bars, [f"{height:.1f}" for height in heights], fontsize=SMALL)
    left.set_xticks(places, [f"({name})" for name in results])
    left.set(ylim=(70.0, 106.0), yticks=range(70, 101, 5), ylabel="efficiency (%)")
    left.legend(loc="upper left")
    base = np.zeros(len(results))
    for j, loss in enumerate(LOSSES):
        shares = np.array([_share(result, loss) for result in results.values()])
        name = loss.replace("_leakage", "").replace("_", " ")
        look = {"color": SHADES[j % 4], "hatch": ("", "////")[j // 4], "edgecolor": "black"}
        right.barh(places, shares, 0.6, base, label=name, **look)
        base += shares
    right.set_yticks(places, [f"({name}) {NAMES[name]}" for name in results])
    right.set(xlim=(0.0, 1.04 * base.max()), ylim=(len(results) - 0.5, -2.0))
    right.set_xlabel("exergy destroyed (% of the shaft power)")
    right.legend(loc="upper center", ncols=3)
    return figure


def _studies_figure(studies: dict[str, list[tuple[float, float, float]]]) -> Any:
    figure, places = panels(6, 0.0, 52.0, columns=3, sharey=True)
    for axes, (name, rows) in zip(places, studies.items(), strict=True):
        value, filling, efficiency = np.array(rows).T
        axes.plot(value, 100.0 * filling, color=COLOURS[1], linestyle=DASHES[1], marker="s", label="volumetric")
        axes.plot(value, 100.0 * efficiency, color=COLOURS[0], marker="o", label="isentropic")
        axes.set(xlabel=AXES.get(name, name), ylim=(70.0, 100.0))
        plain_ticks(axes.xaxis, most=5)
        plain_ticks(axes.yaxis, most=6)
    for row in (places[0], places[3]):
        row.set_ylabel("efficiency (%)")
    places[0].legend(loc="lower left")
    return figure


def main() -> None:
    """Print all tables, and draw them into the folder of -o."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("-o", type=Path, metavar="DIR", help="where the figures go")
    folder = parser.parse_args().o
    scenes = {name: load(ROOT / "configs" / "rotors" / f"{name}.yaml") for name in NAMES}
    b = scenes["b"]
    alike = {name: matched(scene, displacement(b)) for name, scene in scenes.items()}
    results = compare(alike)
    print("\nProfile (b), one displacement: lambda, eta_s")
    studies: dict[str, list[tuple[float, float, float]]] = {}
    for name, cases in variations(b):
        print(name)
        for value, scene in cases:
            text = figures(scene)
            print(f"{value:>8} {text}")
            filling, efficiency = (float(x) for x in text.split()[:2])
            studies.setdefault(name, []).append((float(value), filling, efficiency))
    if folder is not None:
        plans = {"profiles": partial(_profiles_figure, results), "profile_studies": partial(_studies_figure, studies)}
        write_all(plans, folder)
    paths(with_values(b, {"numerics.accuracy": 1e-4}))
    published(alike)


if __name__ == "__main__":
    main()
