"""Print the numbers of slider-crank machines that docs/slider-crank.md states.

Run: .venv/bin/python scripts/cylinder.py
"""

from __future__ import annotations

from pathlib import Path

import screwsim
from screwsim.outputs import Result
from screwsim.scene import Scene, with_values

ROOT = Path(__file__).resolve().parent.parent
SCENES = ("r134a", "air")
FIGURES = {
    "volumetric_efficiency": 1.0,
    "gas_mass_flow": 1e3,
    "cooling_capacity": 1.0,
    "indicated_power": 1.0,
    "shaft_power": 1.0,
    "isentropic_efficiency": 1.0,
    "ideal_isothermal_efficiency": 1.0,
    "cop": 1.0,
    "discharge_temperature": 1.0,
    "suction_valve_power": 1.0,
    "discharge_valve_power": 1.0,
    "wall_heat": 1.0,
}
AREAS = {"suction": 2e-4, "discharge": 1.5e-4}
SOFTNESS = (4e-3, 1e-3, 2.5e-4)
IDEAL = """\
machine: {kind: slider_crank, bore: 50 mm, crank_radius: 20 mm, rod_length: 90 mm, offset: 3 mm, clearance: 3 cm^3}
gas: {fluid: Air, isentropic_exponent: 1.4}
operation: {speed: 1500 rpm, suction: {pressure: 1 bar, temperature: 300 K}, discharge: {pressure: 4 bar}}
effects:
  check_valves: {suction_area: 2 cm^2, discharge_area: 1.5 cm^2}
numerics: {accuracy: 3e-5}
"""


def solved(scene: Scene) -> Result:
    """Return the result of a scene that must close."""
    found = screwsim.simulate(scene)
    if found.status != "ok":
        raise SystemExit(f"{scene.title}: {found.status}: {found.message}")
    return found


def print_machines() -> None:
    """Print the figures of the shipped scenes."""
    scenes = [screwsim.load(ROOT / "configs" / "slider_crank" / f"{name}.yaml") for name in SCENES]
    found = [solved(scene) for scene in scenes]
    print(f"{'':<30}{SCENES[0]:>12}{SCENES[1]:>12}")
    for name, factor in FIGURES.items():
        values = [result.performance.get(name) for result in found]
        print(f"{name:<30}" + "".join(f"{'' if x is None else format(factor * x, '.5g'):>12}" for x in values))
    for scene, result, name in zip(scenes, found, SCENES, strict=True):
        steps, turns = result.numerics.steps, result.numerics.turns
        print(f"{name}: c = {scene.machine.clearance_ratio:.4f}, {turns:g} turns, {steps} steps")
        for softness in SOFTNESS:
            other = solved(with_values(scene, {"effects.reed_valves.softness": softness})).performance
            values = ", ".join(f"{each} {other[each]:.6g}" for each in ("volumetric_efficiency", "shaft_power"))
            print(f"  softness {softness:g}: {values}")


def print_ideal() -> None:
    """Print what wider check valves leave of the ideal cycle."""
    scene = screwsim.loads(IDEAL)
    c, ratio, k = scene.machine.clearance_ratio, 4.0, 1.4
    expected = 1.0 + c - c * ratio ** (1.0 / k)
    print(f"ideal cycle: lambda {expected:.6f}")
    for factor in (0.01, 1.0, 10.0, 100.0):
        areas = {f"effects.check_valves.{side}_area": factor * area for side, area in AREAS.items()}
        found = solved(with_values(scene, areas)).performance
        values = f"lambda {found.volumetric_efficiency:.6f}, eta_s {found.isentropic_efficiency:.6f}"
        print(f"  area x {factor:<6g} {values}")


if __name__ == "__main__":
    print_machines()
    print_ideal()
