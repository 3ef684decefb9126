"""Print the numbers of slider-crank machines that docs/reference/slider-crank.md states.

Run: .venv/bin/python docs/tools/slider_crank_numbers.py
"""

from __future__ import annotations

from pathlib import Path

import screwsim
from screwsim.cycle.guess import install_first_guess, lease_for
from screwsim.cycle.problem import problem_of
from screwsim.figures.errors import relative_errors, worst
from screwsim.outputs import Result
from screwsim.scene import Scene, with_values

ROOT = Path(__file__).resolve().parents[2]
SCENES = ("r134a", "air")
FIGURES = ("volumetric_efficiency", "gas_mass_flow", "cooling_capacity", "indicated_power", "shaft_power")
FIGURES += ("isentropic_efficiency", "ideal_isothermal_efficiency", "cop", "discharge_temperature")
FIGURES += ("suction_valve_power", "discharge_valve_power", "wall_heat")
AREAS = {"suction": 2e-4, "discharge": 1.5e-4}
RESTITUTIONS = (0.0, 0.1, 0.3, 0.6, 0.9, 0.99)
ACCURACIES = (1e-2, 1e-3, 1e-4, 1e-5)
FINE = 1e-7  # accuracy of the figures that others are measured by
EXTREMES = [(name, factor) for name in ("stiffness", "mass", "stop") for factor in (0.01, 0.1, 10.0, 100.0)]
CORRELATIONS = ("annand", "destoop", "adair")
REEDS = "effects.reed_valves"
IDEAL = """\
machine: {kind: slider_crank, bore: 50 mm, crank_radius: 20 mm, rod_length: 90 mm, offset: 3 mm, clearance: 3 cm^3}
gas: {fluid: Air, isentropic_exponent: 1.4}
operation: {speed: 1500 rpm, suction: {pressure: 1 bar, temperature: 300 K}, discharge: {pressure: 4 bar}}
effects:
  check_valves: {suction_area: 2 cm^2, discharge_area: 1.5 cm^2}
numerics: {accuracy: 3e-5}
"""
RESTLESS = """\
machine: {kind: slider_crank, bore: 50 mm, crank_radius: 20 mm, rod_length: 90 mm, offset: 3 mm, clearance: 0.435 cm^3}
gas: {fluid: Air, isentropic_exponent: 1.4}
operation: {speed: 2070 rpm, suction: {pressure: 1 bar, temperature: 300 K}, discharge: {pressure: 5.18 bar}}
effects:
  reed_valves:
    suction_port_area: 0.911 cm^2
    suction_perimeter: 42 mm
    suction_stop: 1.64 mm
    suction_mass: 11.8 g
    suction_stiffness: 337 N/m
    discharge_port_area: 12.1 cm^2
    discharge_perimeter: 164 mm
    discharge_stop: 2.34 mm
    discharge_mass: 8.67 g
    discharge_stiffness: 72.3 N/m
    seat_restitution: 0.25
    stop_restitution: 0.274
"""
TURNS = 300  # of the restless machine's own course


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
    for name in FIGURES:
        factor = 1e3 if name == "gas_mass_flow" else 1.0
        values = [result.performance.get(name) for result in found]
        print(f"{name:<30}" + "".join(f"{'' if x is None else format(factor * x, '.5g'):>12}" for x in values))
    for scene, result, name in zip(scenes, found, SCENES, strict=True):
        n, c = result.numerics, scene.machine.clearance_ratio
        print(f"{name}: c = {c:.4f}, {n.turns:g} turns, {n.steps} steps, {n.rhs_evaluations} evaluations")
        print_accuracy(scene)
        print_reeds(scene)
        print_heat(scene)


def print_accuracy(scene: Scene) -> None:
    """Print true errors over the accuracy asked for."""
    fine = solved(with_values(scene, {"numerics.accuracy": FINE})).performance
    for accuracy in ACCURACIES:
        result = solved(with_values(scene, {"numerics.accuracy": accuracy}))
        name, error = worst(relative_errors(result.performance, fine))
        estimate = worst(result.error)[1]
        asked = f"  accuracy {accuracy:g}: true error {error:.1e} ({name}), estimate {estimate:.1e}"
        print(f"{asked}, {result.numerics.rhs_evaluations} evaluations")


def with_restitution(scene: Scene, restitution: float) -> Scene:
    """Return the scene with this restitution of seats and stops."""
    return with_values(scene, dict.fromkeys([f"{REEDS}.{end}_restitution" for end in ("seat", "stop")], restitution))


def with_reeds(scene: Scene, name: str, factor: float) -> Scene:
    """Return the scene with so many times a number of both reeds."""
    parameters = scene.effects["reed_valves"].parameters
    fields = [f"{side}_{name}" for side in ("suction", "discharge")]
    return with_values(scene, {f"{REEDS}.{field}": factor * getattr(parameters, field) for field in fields})


def print_reeds(scene: Scene) -> None:
    """Print what becomes of other reeds: status, volumetric efficiency, evaluations."""
    others = {f"restitution {e:g}": with_restitution(scene, e) for e in RESTITUTIONS}
    others |= {f"{name} x {factor:g}": with_reeds(scene, name, factor) for name, factor in EXTREMES}
    for label, other in others.items():
        result = screwsim.simulate(other, trace=False)
        found, numerics = result.performance, result.numerics
        share = "" if found.get("volumetric_efficiency") is None else f"lambda {found.volumetric_efficiency:.4f}, "
        print(f"  {label}: {result.status}, {share}{numerics.turns:g} turns, {numerics.rhs_evaluations} evaluations")
        for text in (result.message, *result.warnings):
            print(f"    {text}" if text else "", end="\n" if text else "")


def print_heat(scene: Scene) -> None:
    """Print what the correlations of the walls' heat make of it."""
    for correlation in CORRELATIONS:
        found = solved(with_values(scene, {"effects.cylinder_heat.correlation": correlation})).performance
        names = ("wall_heat", "volumetric_efficiency", "discharge_temperature")
        print(f"  {correlation}: " + ", ".join(f"{name} {found[name]:.5g}" for name in names))


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


def print_restless() -> None:
    """Print the cycles found of heavy reeds on soft springs, and the machine's own course from turn to turn."""
    scene = screwsim.loads(RESTLESS)
    print("heavy reeds on soft springs")
    for accuracy in (1e-2, 1e-3, 1e-4, 1e-5):
        found = solved(with_values(scene, {"numerics.accuracy": accuracy})).performance
        print(f"  accuracy {accuracy:g}: lambda {found.volumetric_efficiency:.5f}, work {found.work_per_cycle:.4f} J")
    problem = problem_of(scene)
    machinery = lease_for(problem)
    y, works = install_first_guess(problem, machinery), []
    for _ in range(TURNS):
        works.append(machinery.turn(y, 1e-4)[2][0])
        machinery.lives.swap()
    late = works[TURNS // 2 :]
    print(f"  turns {TURNS // 2} to {TURNS} of its course: work {min(late):.3f} to {max(late):.3f} J")


if __name__ == "__main__":
    print_machines()
    print_ideal()
    print_restless()
