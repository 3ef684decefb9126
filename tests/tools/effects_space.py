"""A second space of random scenes: few structures that hold all effects between them, many numbers for each.

A structure is a shipped scene, what is set in it, and the groups of numbers that are drawn. Beside a structure's own
group are drawn what every machine has (`SCREW`, `CRANK`), and the numbers of those effects that the scene names.
`tests/tools/fuzz_effects.py` solves them; `fuzz_space.py` is the first space, whose few effects have the widest ranges.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from screwsim.scene import Scene, load

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "tests" / "hard"
PAPER, REAL, EXPANDER = "paper/point.yaml", "../tests/plain/r134a.yaml", "expander/point.yaml"
CARRIED = "oil.transport=carried"
OFF = {name: f"effects.{name}=off" for name in ("oil_heat", "oil_pump", "hydromechanical")}
DRY = ("oil=null", "oil_supply=null", *OFF.values())
BORE = (CARRIED, OFF["oil_pump"], "oil_supply={kind: displacement, ratio: null, orifice_diameter: 6 mm}")
WINDOW = "effects.oil_injection={opens: 365 deg, closes: 455 deg}"
WALLS = "effects.wall_heat={rotor_area: 400 cm^2, housing_area: 150 cm^2, characteristic_length: 58 mm}"
PLENUMS = "effects.plenums={discharge_volume: 3 l, suction_volume: 8 l, discharge_area: 15 cm^2, suction_area: 40 cm^2}"
MOTOR = "effects.motor={rated_power: 15 kW, efficiency: 0.921}"
DRIVE = (
    "effects.drive={motor_inertia: 0.8 kg m^2, rotor_inertia: 0.12 kg m^2, coupling: {linear: "
    "{spring: 20000 N m/rad, largest_twist: 12 deg}, damping: 6 N m s/rad}, motor: {law: line, "
    "slope: 30 N m s/rad, torque_limit: 2000 N m}}"
)
MAINS = (
    "effects.drive.speed=no_load",
    "effects.drive.motor={law: induction, breakdown_torque: 2000 N m, breakdown_slip: 0.2, slope: null, "
    "torque_limit: null}",
)
FRICTION = "model: nozzle_friction, passage: 2 mm, flow_coefficient: 1"
FILM = "{model: oil_film, passage: 2 mm, filled_from: 0.2}"
READINGS = (
    MOTOR,
    "effects.gas_torque={male_share: 0.9}",
    "effects.bearings={load: gas, radial_area: 60 cm^2, axial_area: 30 cm^2, friction_coefficient: 0.0018, "
    "bore: 60 mm}",
    "effects.oil_drag={tip_gap: 0.1 mm, tip_land: 3 mm, end_gap: 0.1 mm, end_solidity: 0.6}",
)
TABLES = (
    f"machine.volume={{law: table, max: 528 cm^3, phi_A: null, file: {TABLES / 'rough_volume.csv'}}}",
    f"machine.suction_port={{law: table, area: null, phi_B: null, file: {TABLES / 'rough_suction.csv'}}}",
    "machine.discharge_port={law: table, area: null, opens: null, phi_C: null, "
    f"file: {TABLES / 'rough_discharge.csv'}}}",
)


@dataclass(frozen=True)
class Range:
    """What a path may be: from low to high, evenly or in logarithms, with its unit."""

    low: float
    high: float
    unit: str = ""
    logarithmic: bool = True

    def at(self, share: float) -> str:
        """Return the value at a share of the range, as a scene states it."""
        if self.logarithmic:
            value = self.low * (self.high / self.low) ** share
        else:
            value = self.low + (self.high - self.low) * share
        return f"{value:.8g} {self.unit}".strip()


Ranges = dict[str, Range]
DEG, K = "deg", "K"
LINES: Ranges = {
    "operation.suction.pressure": Range(0.8, 4.0, "bar"),
    "operation.suction.temperature": Range(270.0, 320.0, K, False),
}
RATIO = Range(1.2, 15.0)  # of pressures
ACCURACY = Range(3e-5, 1e-3)  # wanted by a scene that wants another than the default one
EACH = 40  # scenes of a structure, one after the other: what a process has compiled it keeps for few
OWN_ACCURACY, COUPLED = 0.2, 0.1  # share of the scenes that want it, that are closed by coupled chambers
CONDITIONS: Ranges = {
    "operation.evaporating_temperature": Range(255.0, 285.0, K, False),
    "operation.condensing_temperature": Range(300.0, 335.0, K, False),
    "operation.superheat": Range(3.0, 30.0, K, False),
}
SPEED: Ranges = {"operation.speed": Range(150.0, 10000.0, "rpm")}
PORTS: Ranges = {
    "machine.suction_port.area": Range(5.0, 400.0, "cm^2"),
    "machine.discharge_port.area": Range(3.0, 250.0, "cm^2"),
    "machine.discharge_port.opens": Range(500.0, 680.0, DEG, False),
}
DEAD: Ranges = {"machine.volume.min": Range(0.01, 10.0, "cm^3")}
BORED: Ranges = {"oil_supply.orifice_diameter": Range(0.8, 12.0, "mm")}
PUMPED: Ranges = {"oil_supply.ratio": Range(0.01, 15.0)}
WARM: Ranges = {"oil_supply.temperature": Range(275.0, 330.0, K, False)}
CRANK: Ranges = {"operation.speed": Range(60.0, 6000.0, "rpm")}
AIR: Ranges = {
    "operation.suction.pressure": Range(0.7, 2.0, "bar"),
    "operation.suction.temperature": Range(270.0, 310.0, K, False),
}
OF_EFFECT: dict[str, Ranges] = {
    "tip_leakage": {"gap": Range(3.0, 200.0, "um")},
    "interlobe_leakage": {"gap": Range(3.0, 200.0, "um")},
    "end_face_leakage": {"gap": Range(3.0, 200.0, "um")},
    "blow_hole": {"area": Range(1.0, 40.0, "mm^2")},
    "oil_heat": {"droplet_radius": Range(5.0, 500.0, "um")},
    "droplets": {"diameter": Range(10.0, 500.0, "um"), "slip": Range(0.005, 0.2)},
    "wall_heat": {"nusselt_factor": Range(0.01, 0.3), "rotor_cooling": Range(1.0, 500.0, "W")},
    "thermal_clearances": {"rotor_expansion": Range(5.0, 15.0, "um/(m K)")},
    "slide_valve": {"position": Range(0.0, 1.0, "", False), "closes": Range(450.0, 640.0, DEG, False)},
    "suction_throttle": {"pressure_ratio": Range(0.5, 0.99, "", False)},
    "economizer": {"area": Range(0.1, 3.0, "cm^2"), "closes": Range(440.0, 520.0, DEG, False)},
    "liquid_injection": {"area": Range(0.1, 4.0, "mm^2")},
    "shaft_leakage": {"area": Range(0.3, 100.0, "mm^2")},
    "oil_injection": {"opens": Range(340.0, 400.0, DEG, False), "closes": Range(430.0, 560.0, DEG, False)},
    "mechanical": {"fraction": Range(0.0, 0.15, "", False)},
    "oil_pump": {"efficiency": Range(0.3, 0.9, "", False)},
    "hydromechanical": {"acceleration_factor": Range(0.0, 2.0, "", False)},
    "bearings": {"friction_coefficient": Range(5e-4, 5e-3)},
    "oil_drag": {"tip_gap": Range(0.05, 0.3, "mm")},
    "gas_torque": {"male_share": Range(0.5, 1.0, "", False)},
    "separator": {"friction_share": Range(0.0, 1.0, "", False)},
    "air_package": {"rated_flow": Range(0.5, 50.0, "m^3/min")},
    "motor": {"rated_power": Range(5.0, 200.0, "kW"), "constant_share": Range(0.0, 1.0, "", False)},
    "drive": {"rotor_inertia": Range(0.05, 2.0, "kg m^2"), "motor_inertia": Range(0.1, 5.0, "kg m^2")},
    "plenums": {
        "discharge_volume": Range(0.2, 60.0, "l"),
        "suction_volume": Range(0.2, 60.0, "l"),
        "discharge_area": Range(1.0, 100.0, "cm^2"),
        "suction_area": Range(3.0, 200.0, "cm^2"),
    },
    "refrigerant_solubility": {"separator_temperature": Range(335.0, 365.0, K, False)},
    "reed_valves": {
        "suction_stiffness": Range(2000.0, 60000.0, "N/m"),
        "discharge_stiffness": Range(2000.0, 60000.0, "N/m"),
        "suction_mass": Range(5.0, 500.0, "g"),
        "discharge_mass": Range(5.0, 500.0, "g"),
        "seat_restitution": Range(0.0, 0.7, "", False),
        "stop_restitution": Range(0.0, 0.7, "", False),
    },
    "check_valves": {"suction_area": Range(2.0, 20.0, "mm^2"), "discharge_area": Range(2.0, 20.0, "mm^2")},
    "ring_leakage": {"gap": Range(0.3, 20.0, "um")},
    "cylinder_heat": {"wall_temperature": Range(300.0, 420.0, K, False), "factor": Range(0.1, 10.0)},
    "own_effects.spike": {
        "area": Range(5.0, 200.0, "mm^2"),
        "at": Range(380.0, 620.0, DEG, False),
        "width": Range(0.3, 20.0, DEG),
        "stated": Range(0.0, 1.0, "", False),
    },
}


@dataclass(frozen=True)
class Structure:
    """A shipped scene, what is set in it, and what of it is drawn beside the numbers of its effects."""

    config: str
    sets: tuple[str, ...] = ()
    ranges: tuple[Ranges, ...] = ()
    left: tuple[str, ...] = ()  # paths of the ranges that do not go with this structure
    discharge: str = "operation.discharge.pressure"  # drawn as a ratio of pressures; empty: by temperatures


SCREW = (SPEED, LINES, PORTS, DEAD)
OILED = (*SCREW, PUMPED, WARM)
SOLVING = (
    SPEED,
    PORTS,
    DEAD,
    {"oil_supply.ratio": Range(0.1, 3.0), "operation.suction.pressure": Range(1.0, 2.0, "bar")},
)
KEPT = "effects.separator.cooler.discharge_temperature"
STRUCTURES: dict[str, Structure] = {
    "plenums": Structure(PAPER, (PLENUMS, *READINGS), (*OILED, {"effects.plenums.discharge_loss": Range(0.1, 10.0)})),
    "plenums, valves": Structure(
        PAPER,
        (PLENUMS, "effects.plenums.discharge_valve={area: 12 cm^2, pressure: 0.1 bar}", MOTOR),
        (*OILED, {"effects.plenums.discharge_valve.area": Range(5.0, 40.0, "cm^2")}),
    ),
    "plenums, carried": Structure(PAPER, (CARRIED, PLENUMS, "effects.plenums.suction_valve={area: 40 cm^2}"), OILED),
    "displaced through a port": Structure(PAPER, (*BORE, WINDOW, *READINGS), (*SCREW, BORED, WARM)),
    "displaced through a port, oil takes room": Structure(
        PAPER, (*BORE, WINDOW, "effects.oil_volume={}", PLENUMS), (*SCREW, BORED, WARM)
    ),
    "displaced": Structure(PAPER, (*BORE, "effects.suction_throttle={pressure_ratio: 0.9}"), (*SCREW, BORED, WARM)),
    "walls": Structure(
        PAPER, (CARRIED, WALLS, "effects.thermal_clearances={axis_distance: 125 mm}", "gas.fluid=Air"), OILED
    ),
    "tables": Structure(PAPER, (*TABLES, MOTOR), (SPEED, LINES, DEAD, PUMPED, WARM)),
    "economizer and liquid": Structure(
        REAL,
        (
            "gas.two_phase=equilibrium",
            "effects.economizer={temperature: 18 degC, opens: 385 deg, closes: 485 deg, area: 0.5 cm^2}",
            "effects.liquid_injection={opens: 500 deg, closes: 600 deg, area: 0.5 mm^2}",
            MOTOR,
        ),
        (SPEED, CONDITIONS, PORTS, DEAD, {"oil_supply.ratio": Range(0.1, 4.0)}),
        ("operation.evaporating_temperature",),
        "",
    ),
    "solubility": Structure(
        PAPER,
        (
            CARRIED,
            WINDOW,
            "oil_supply={ratio: 1, temperature: 325 K}",
            "effects.refrigerant_solubility={separator_temperature: 70 degC}",
        ),
        (
            SPEED,
            PORTS,
            DEAD,
            {"oil_supply.ratio": Range(0.1, 3.0), "operation.suction.pressure": Range(1.0, 2.0, "bar")},
        ),
    ),
    "solubility over time": Structure(
        PAPER,
        (
            CARRIED,
            WINDOW,
            "oil_supply={ratio: 1, temperature: 325 K}",
            "effects.refrigerant_solubility={separator_temperature: 70 degC, flash_time: 5 ms, absorption_time: 50 ms}",
        ),
        (
            SPEED,
            PORTS,
            DEAD,
            {"oil_supply.ratio": Range(0.1, 3.0), "operation.suction.pressure": Range(1.0, 2.0, "bar")},
        ),
    ),
    "part load": Structure(
        PAPER,
        (
            *DRY,
            "gas.fluid=Nitrogen",
            "effects.slide_valve={slot_area: 30 cm^2, closes: 600 deg, position: 0.3, radial_area: 5 cm^2, "
            "radial_opens: 600 deg, radial_opens_moved: 640 deg}",
            "effects.bypass={source: chamber, area: 2 cm^2, opens: 400 deg, passage: 90 deg}",
            "effects.suction_throttle={pressure_ratio: 0.8}",
            MOTOR,
        ),
        (*SCREW, {"effects.bypass.area": Range(0.1, 10.0, "cm^2")}),
    ),
    "what flows back": Structure(
        PAPER,
        (
            CARRIED,
            "effects.slide_valve={slot_area: 30 cm^2, closes: 600 deg, position: 0.3}",
            "effects.shaft_leakage={area: 5 mm^2}",
            "effects.suction_line={}",
            MOTOR,
        ),
        OILED,
    ),
    "what flows back, gas dissolved": Structure(
        PAPER,
        (
            CARRIED,
            WINDOW,
            "effects.oil_volume={}",
            "oil_supply={ratio: 1, temperature: 325 K}",
            "effects.refrigerant_solubility={separator_temperature: 70 degC, flash_time: 5 ms, absorption_time: 50 ms}",
            "effects.shaft_leakage={area: 5 mm^2}",
            "effects.suction_line={}",
        ),
        SOLVING,
    ),
    "bypass": Structure(
        PAPER,
        (OFF["oil_heat"], CARRIED, "effects.droplets={diameter: 60 um, slip: 0.02}", "effects.bypass={share: 0.2}"),
        (*OILED, {"effects.bypass.share": Range(0.01, 0.5)}),
    ),
    "gaps with friction": Structure(
        PAPER,
        (
            CARRIED,
            "effects.tip_leakage={model: oil_sealed, mixture_viscosity: cicchitti, passage: 2 mm}",
            f"effects.interlobe_leakage={{friction_fit: flank, {FRICTION}}}",
            f"effects.end_face_leakage={{friction_fit: radial, {FRICTION}}}",
        ),
        OILED,
    ),
    "gaps full of oil": Structure(
        PAPER,
        (CARRIED, *(f"effects.{name}={FILM}" for name in ("tip_leakage", "interlobe_leakage", "end_face_leakage"))),
        OILED,
    ),
    "drive": Structure(
        PAPER, (DRIVE, *READINGS), (*OILED, {"effects.drive.coupling.linear.spring": Range(3e3, 1e5, "N m/rad")})
    ),
    "drive on the mains": Structure(PAPER, (DRIVE, *MAINS, MOTOR), (*OILED,)),
    "rotor profile": Structure(
        "rotors/a.yaml",
        ("effects.gas_torque={}",),
        (SPEED, {"machine.built_in_volume_ratio": Range(1.8, 5.0)}),
        ("male_share",),
        "",
    ),
    "expander": Structure(EXPANDER, (), (SPEED, PORTS, DEAD), (), "expander"),
    "reeds": Structure("slider_crank/air.yaml", (MOTOR,), (CRANK, AIR)),
    "check valves": Structure(
        "slider_crank/flexible_rod.yaml", ("effects.ring_leakage={gap: 1 um}", "gas.fluid=Air"), (CRANK,)
    ),
    "own effect": Structure(
        PAPER, ("effects={own_effects.spike: {area: 30 mm^2, at: 500 deg, width: 5 deg}}", MOTOR), OILED
    ),
    "own effect, carried": Structure(
        PAPER, (CARRIED, "effects={own_effects.spike: {area: 30 mm^2, at: 500 deg, width: 5 deg}}"), OILED
    ),
    "oil circuit": Structure(
        PAPER,
        (CARRIED, "oil_supply.temperature=null", "effects.separator={cooler: {discharge_temperature: 340 K}}"),
        (*SCREW, {"oil_supply.ratio": Range(0.5, 15.0)}, {KEPT: Range(320.0, 400.0, K, False)}),
    ),
    "oil circuit, solubility": Structure(
        PAPER,
        (
            CARRIED,
            WINDOW,
            "oil_supply.temperature=null",
            "effects.refrigerant_solubility={}",
            "effects.separator={cooler: {discharge_temperature: 345 K}}",
        ),
        (*SOLVING, {KEPT: Range(335.0, 365.0, K, False)}),
        ("separator_temperature",),
    ),
    "air package": Structure(
        PAPER,
        (
            CARRIED,
            "gas.fluid=Air",
            "oil_supply.temperature=null",
            "effects.separator={cooler: {discharge_temperature: 350 K}}",
            "effects.motor={rated_power: 1 MW}",
            "effects.air_package={rated_flow: 3 m^3/min, inlet_filter: {pressure_loss: 30 mbar}, separator_element: "
            "{pressure_loss: 0.2 bar}, minimum_pressure_valve: {pressure_loss: 0.1 bar, pressure: 5 bar}, "
            "aftercooler: {pressure_loss: 0.1 bar, approach: 10 K}, fan: {power: 1 kW}}",
        ),
        (
            *SCREW,
            {"oil_supply.ratio": Range(0.5, 15.0)},
            {KEPT: Range(320.0, 400.0, K, False), "operation.speed": Range(1000.0, 10000.0, "rpm")},
        ),
        ("motor.rated_power",),
    ),
}


@cache
def base(structure: str) -> Scene:
    """Return the scene of a structure without what is drawn."""
    return load(str(ROOT / "configs" / STRUCTURES[structure].config), STRUCTURES[structure].sets)


def ranges(structure: str) -> Ranges:
    """Return all that is drawn of a structure, by path."""
    chosen = STRUCTURES[structure]
    found: Ranges = {}
    for group in chosen.ranges:
        found |= group
    for name in base(structure).effects:
        own = {f"effects.{name}.{key}": each for key, each in OF_EFFECT.get(name, {}).items()}
        found = own | found
    return {path: each for path, each in found.items() if not path.endswith(chosen.left or ("\0",))}


def drawn(structure: str, seed: int, index: int) -> list[str]:
    """Return what one scene of a seed sets beside its structure, as `--set` takes it."""
    random = np.random.default_rng((seed, list(STRUCTURES).index(structure), index))
    chosen = STRUCTURES[structure]
    sets = {path: each.at(random.random()) for path, each in ranges(structure).items()}
    scene = base(structure)
    if chosen.discharge == "operation.discharge.pressure":
        p = sets.get("operation.suction.pressure")
        p_s = float(p.split()[0]) if p else scene.operation.suction.pressure / 1e5
        sets["operation.discharge.pressure"] = f"{p_s * float(RATIO.at(random.random())):.8g} bar"
    elif chosen.discharge == "expander":
        sets["operation.discharge.pressure"] = f"{20.0 / float(Range(1.5, 6.0).at(random.random())):.8g} bar"
    if "machine.discharge_port.opens" in sets:
        opens = float(sets["machine.discharge_port.opens"].split()[0])
        sets["machine.discharge_port.phi_C"] = (
            f"{opens + (0.1 + 0.8 * random.random()) * 0.5 * (720.0 - opens):.8g} deg"
        )
    if random.random() < OWN_ACCURACY:
        sets["numerics.accuracy"] = f"{float(ACCURACY.at(random.random())):.4g}"
    if random.random() < COUPLED:
        sets["numerics.closing"] = "coupled"
    return [f"{path}={value}" for path, value in sets.items()]


def scene_of(structure: str, seed: int, index: int) -> Scene:
    """Return one scene; raise SceneError where it makes no sense."""
    chosen = STRUCTURES[structure]
    return load(str(ROOT / "configs" / chosen.config), [*chosen.sets, *drawn(structure, seed, index)])


def structure_of(index: int) -> tuple[str, int]:
    """Return the structure of a scene, and its number among those of that structure."""
    return list(STRUCTURES)[index // EACH], index % EACH


def effects_drawn() -> set[str]:
    """Return the effects that the structures have between them."""
    return {name for structure in STRUCTURES for name in base(structure).effects}
