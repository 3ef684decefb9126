"""Print what rotor profiles decide: the machines of configs/rotors, wrap, length, built-in ratio, clearance, speed.

Run: .venv/bin/python scripts/profiles.py. Machines are compared at the displacement of (b) a male revolution: all
lengths of a machine are scaled together, the clearances stay. Published: the mean of Bitzer's compact screws
(validation/bitzer). Last the paper's laws, fitted to the curves of (b), beside them.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
from scipy.optimize import least_squares

from screwsim.machine.geometry import Geometry
from screwsim.machine.paper_law import discharge_area, suction_area, volume
from screwsim.machine.profile_law import lay
from screwsim.machine.profile_tables import Table
from screwsim.machine.settings import LIFE, TURN, DischargePort, SuctionPort, VolumeLaw
from screwsim.outputs import Result
from screwsim.scene import Scene, load
from screwsim.scene.grid import with_values
from screwsim.simulate import simulate

ROOT = Path(__file__).resolve().parent.parent
PUBLISHED = ROOT / "validation" / "bitzer" / "conditions.csv"
NAMES = {"a": "symmetric 4/6", "b": "asymmetric 4/6", "c": "asymmetric 5/6"}
GAPS = ("tip_leakage", "interlobe_leakage", "end_face_leakage")
LOSSES = (*GAPS[:2], "blow_hole", GAPS[2], "suction_port", "discharge_port", "oil_heat")
MM, DEG = 1e-3, math.pi / 180.0


def scaled(scene: Scene, factor: float) -> Scene:
    """Return the scene with all lengths of the rotors multiplied."""
    machine, profile = scene.machine, scene.machine.profile
    lengths = {f"machine.{name}": getattr(machine, name) for name in ("rotor_diameter", "rotor_length")}
    names = (
        "centre_distance",
        "female_diameter",
        "male_tip_radius",
        "female_tip_radius",
        "flank_radius",
        "root_radius",
    )
    lengths |= {f"machine.profile.{name}": getattr(profile, name) for name in names}
    return with_values(scene, {path: factor * value for path, value in lengths.items() if value is not None})


def displacement(scene: Scene) -> float:
    """Return the displacement of a male revolution [m³]."""
    geometry = Geometry(scene.machine)
    return geometry.swept_volume * geometry.lobes


def matched(scene: Scene, wanted: float) -> Scene:
    """Return the scene scaled to a displacement [m³]."""
    return scaled(scene, (wanted / displacement(scene)) ** (1.0 / 3.0))


def figures(scene: Scene) -> str:
    """Return λ and η_s of a scene, and its status where it is not ok."""
    result = simulate(scene, trace=False)
    found = result.performance
    text = f"{found.volumetric_efficiency:8.4f} {found.isentropic_efficiency:8.4f}"
    return text if result.status == "ok" else f"{text} {result.status}"


def compare(scenes: dict[str, Scene]) -> None:
    """Print the profiles at one displacement, with what their effects destroy."""
    print("Profiles at one displacement and one set of clearances, R134a 2/45 degC")
    head = "".join(f"{name.replace('_leakage', '').replace('_', ' '):>16}" for name in LOSSES)
    print(f"{'':<44} destroyed, % of shaft power")
    print(f"{'':<16}{'D mm':>6}{'lambda':>8}{'eta_s':>8}{'kW':>7}{head}")
    for name, scene in scenes.items():
        result = simulate(scene)
        found = result.performance
        parts = "".join(f"{_share(result, loss):16.2f}" for loss in LOSSES)
        print(
            f"{NAMES[name]:<16}{scene.machine.rotor_diameter / MM:6.1f}{found.volumetric_efficiency:8.4f}"
            f"{found.isentropic_efficiency:8.4f}{found.shaft_power / 1e3:7.2f}{parts}   {result.status}"
        )


def _share(result: Result, name: str) -> float:
    return 100.0 * result.ledger[f"exergy_destroyed_{name}"] / result.ledger["shaft_power"]


def variations(b: Scene) -> Iterator[tuple[str, list[tuple[str, Scene]]]]:
    """Yield (what is varied, [(value, scene)]) of profile (b) at one displacement."""
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


def fitted(b: Scene, by_ratio: bool) -> Scene:
    """Return (b) with the paper's laws fitted to its curves, suction closing at 360°, and the built-in gaps' sizes.

    by_ratio: the port opens where the law has the built-in ratio, and not at the angle at which the rotors' opens.
    """
    laid = lay(b.machine)
    shift = laid.injection - TURN
    phi, V = _paper_axis(laid.volume, shift)
    phi_A = _fit(lambda x: [volume(p, laid.swept, 0.0, x[0]) for p in phi], V, [60 * DEG], [(1 * DEG, TURN)])[0]
    phi, S = _paper_axis(laid.suction, shift)
    area, phi_B = _fit(
        lambda x: [suction_area(p, x[0], x[1]) for p in phi], S, [S.max(), 90 * DEG], [(0.0, 1.0), (1 * DEG, TURN / 2)]
    )
    suction = SuctionPort(law="paper", area=area, phi_B=phi_B)
    opens = laid.opens - shift
    if by_ratio:
        opens = _where(
            lambda p: volume(p, laid.swept, 0.0, phi_A), laid.swept / float(b.machine.built_in_volume_ratio or 1.0)
        )
    part_of_life = (laid.discharge.angle - laid.opens) / (laid.ends - laid.opens)
    phi, S = opens + part_of_life * (LIFE - opens), laid.discharge.value
    half = 0.5 * (LIFE - opens)
    area, part = _fit(
        lambda x: [discharge_area(p, x[0], opens, opens + x[1] * half) for p in phi],
        S,
        [S.max(), 0.5],
        [(0.0, 1.0), (0.01, 1.0)],
    )
    discharge = DischargePort(law="paper", area=area, opens=opens, phi_C=opens + part * half)
    lines = [one.table.value.max() for one in laid.interfaces["interlobe_leakage"]]
    faces = {one.offset: one.table.value.max() for one in laid.interfaces["end_face_leakage"]}
    near, far = faces[1], sum(length for offset, length in faces.items() if offset > 1)
    angles = " ".join(
        f"{name} {angle / DEG:.1f}" for name, angle in (("phi_A", phi_A), ("phi_B", phi_B), ("opens", opens))
    )
    areas = f"{(suction.area or 0.0) * 1e4:.1f} and {area * 1e4:.1f} cm^2"
    print(f"paper's laws: {angles} phi_C {(discharge.phi_C or 0.0) / DEG:.1f} deg; areas {areas}")
    return with_values(
        b,
        {
            "machine.profile": None,
            "machine.built_in_volume_ratio": None,
            "machine.volume": VolumeLaw(law="paper", max=laid.swept, phi_A=phi_A),
            "machine.suction_port": suction,
            "machine.discharge_port": discharge,
            "effects.interlobe_leakage.length": float(max(lines)),
            "effects.blow_hole.area": float(laid.interfaces["blow_hole"][0].table.value.max()),
            "effects.end_face_leakage.length": float(near + far),
            "effects.end_face_leakage.suction_share": float(far / (near + far)),
        },
    )


def _where(law, wanted: float) -> float:
    """Return the angle after 360° [rad] at which a falling volume is the wanted one."""
    low, high = TURN, LIFE
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if law(middle) > wanted else (low, middle)
    return 0.5 * (low + high)


def _deviation(paper: Scene, b: Scene) -> float:
    """Return the largest deviation of a paper's volume from the rotors', over the swept volume."""
    laid, law = lay(b.machine), paper.machine.volume
    phi, V = _paper_axis(laid.volume, laid.injection - TURN)
    own = np.array([volume(p, laid.swept, 0.0, float(law.phi_A or 0.0)) for p in phi])
    return float(np.max(np.abs(own - V)) / laid.swept)


def _paper_axis(table: Table, shift: float) -> tuple[np.ndarray, np.ndarray]:
    return table.angle - shift, table.value


def _fit(law, curve: np.ndarray, start: list[float], bounds: list[tuple[float, float]]) -> list[float]:
    """Return the parameters of a law closest to a curve, in the mean of squares over its largest value."""
    found = least_squares(lambda x: (np.array(law(x)) - curve) / curve.max(), start, bounds=np.transpose(bounds))
    return [float(value) for value in found.x]


def without(scene: Scene, *names: str) -> Scene:
    """Return the scene without some effects."""
    return replace(scene, effects={name: active for name, active in scene.effects.items() if name not in names})


def paths(b: Scene) -> None:
    """Print what each leakage path of (b) takes, by its effect and the pitches between its chambers."""
    laid, whole = lay(b.machine), simulate(b, trace=False).performance
    print("\nWhat a path takes of profile (b), path by path: lambda, eta_s")
    for effect, interfaces in laid.interfaces.items():
        for one in interfaces:
            closed = replace(one, table=replace(one.table, value=1e-9 * one.table.value))  # the same model compiled
            others = tuple(closed if other is one else other for other in interfaces)
            changed = replace(laid, interfaces={**laid.interfaces, effect: others})
            with patch("screwsim.machine.geometry.lay", return_value=changed):
                found = simulate(b, trace=False).performance
            gained = [found[name] - whole[name] for name in ("volumetric_efficiency", "isentropic_efficiency")]
            print(f"{effect:<18}{one.offset:>3}{gained[0]:9.4f}{gained[1]:9.4f}")


def published(scenes: dict[str, Scene]) -> None:
    """Print λ and η_s of all profiles beside Bitzer's mean."""
    with PUBLISHED.open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    print("\nBeside the mean of Bitzer's compact screws (motor apart): lambda, eta_s")
    print(f"{'To/Tc degC':<12}{'pi':>6}{'published':>18}" + "".join(f"{NAMES[name]:>20}" for name in scenes))
    for row in rows:
        T = {
            f"operation.{side}_temperature": float(row[f"{side}_degC"]) + 273.15
            for side in ("evaporating", "condensing")
        }
        line = f"{row['evaporating_degC'] + '/' + row['condensing_degC']:<12}{float(row['pressure_ratio']):6.3f}"
        line += f"{float(row['volumetric_efficiency']):10.3f}{float(row['isentropic_efficiency']):8.3f}"
        print(line + "".join(f"   {figures(with_values(scene, T))}" for scene in scenes.values()))


def main() -> None:
    """Print all tables."""
    scenes = {name: load(ROOT / "configs" / "rotors" / f"{name}.yaml") for name in NAMES}
    b = scenes["b"]
    alike = {name: matched(scene, displacement(b)) for name, scene in scenes.items()}
    compare(alike)
    print("\nProfile (b), one displacement: lambda, eta_s")
    for name, cases in variations(b):
        print(name)
        for value, scene in cases:
            print(f"{value:>8} {figures(scene)}")
    paths(with_values(b, {"numerics.accuracy": 1e-4}))
    print()
    laws = {"profile (b)": b, "fitted curves": fitted(b, False), "opens at the ratio": fitted(b, True)}
    leaks = (*GAPS, "blow_hole")
    for name, scene in laws.items():
        off = "" if scene is b else f"   volume off by {_deviation(scene, b):.3f} V_max"
        print(f"{name:<20} all {figures(scene)}   ports only {figures(without(scene, *leaks))}{off}")
    published(alike)


if __name__ == "__main__":
    main()
