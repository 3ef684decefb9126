"""Cylinders for the tests of laws: ideal gas, check valves or reeds; one compiled model each."""

from math import pi

from screwsim.scene import Scene, loads, with_values

K = 1.4
P_S = 1e5
CHECK = """\
machine: {kind: slider_crank, bore: 50 mm, crank_radius: 20 mm, rod_length: 90 mm, offset: 3 mm, clearance: 3 cm^3}
gas: {fluid: Air, isentropic_exponent: 1.4}
operation: {speed: 1500 rpm, suction: {pressure: 1 bar, temperature: 300 K}, discharge: {pressure: 4 bar}}
effects:
  check_valves: {suction_area: 2 cm^2, discharge_area: 1.5 cm^2}
"""
REEDS = (
    CHECK.partition("effects:")[0]
    + """\
effects:
  reed_valves:
    suction_port_area: 2 cm^2
    suction_perimeter: 60 mm
    suction_stop: 2 mm
    suction_mass: 2 g
    suction_stiffness: 800 N/m
    discharge_port_area: 1.5 cm^2
    discharge_perimeter: 50 mm
    discharge_stop: 1.5 mm
    discharge_mass: 1.5 g
    discharge_stiffness: 1500 N/m
"""
)
SHUT = CHECK.partition("effects:")[0]
RPM = pi / 30.0
AREAS = {"check_valves": ("area",), "reed_valves": ("port_area", "perimeter", "mass", "stiffness")}


def cylinder(text: str = CHECK, **values) -> Scene:
    """Return the scene, changed at dotted paths written with two underscores [SI]."""
    return with_values(loads(text), {name.replace("__", "."): value for name, value in values.items()})


def with_areas(scene: Scene, factor: float) -> Scene:
    """Return the scene with so many times the valves, side by side."""
    (name, active), *_ = scene.effects.items()
    fields = [f"{side}_{field}" for side in ("suction", "discharge") for field in AREAS[name]]
    return with_values(
        scene, {f"effects.{name}.{field}": factor * getattr(active.parameters, field) for field in fields}
    )
