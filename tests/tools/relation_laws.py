"""Laws that tie a random scene to the same machine stated otherwise, or to one that gains or loses something.

Each law yields pairs of results. `relations.py` asks them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from relating import Case, Lost, NotAsked, Pair, law, read, scaled, tree_of, twin

from screwsim.effects import catalogue
from screwsim.figures import Performance
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.scene import value_at, with_values
from screwsim.scene.fields import leaves_of
from screwsim.scene.units import _TABLE

SOME = 2  # neutral effects of a scene
GAP = {"gap": "30 um", "flow_coefficient": 0}
WINDOW = {"opens": "400 deg", "closes": "500 deg", "area": "1e-6 mm^2"}
NEUTRAL: dict[str, dict[str, Any]] = {  # effects at the value at which they do nothing
    "tip_leakage": GAP,
    "interlobe_leakage": {**GAP, "length": "150 mm"},
    "end_face_leakage": {**GAP, "length": "80 mm"},
    "blow_hole": {"area": "6 mm^2", "flow_coefficient": 0},
    "bypass": {"share": 0},
    "bypass of a chamber": {"source": "chamber", "area": "0 cm^2", "opens": "400 deg", "passage": "90 deg"},
    "slide_valve": {"slot_area": "60 cm^2", "closes": "640 deg", "position": 0},
    "shaft_leakage": {"area": "0 mm^2"},
    "suction_throttle": {"pressure_ratio": 1},
    "oil_heat": {"droplet_radius": "50 um", "heat_transfer_coefficient": "0 W/(m^2 K)"},
    "wall_heat": {
        "rotor_area": "400 cm^2",
        "housing_area": "150 cm^2",
        "characteristic_length": "58 mm",
        "nusselt_factor": 0,
    },
    "plenums": {
        "discharge_volume": "1e6 m^3",
        "suction_volume": "1e6 m^3",
        "discharge_area": "15 cm^2",
        "suction_area": "40 cm^2",
    },
    "oil_pump": {"efficiency": 1, "pressure_loss": "0 bar"},
    "hydromechanical": {"acceleration_factor": 0},
    "mechanical": {"fraction": 0},
    "oil_drag": {"tip_gap": "0.1 mm", "tip_land": "3 mm", "end_gap": "0.1 mm", "end_solidity": 0.6, "film_share": 0},
    "bearings": {
        "load": "gas",
        "radial_area": "60 cm^2",
        "axial_area": "30 cm^2",
        "friction_coefficient": 0,
        "bore": "60 mm",
    },
    "motor": {"rated_power": "1 MW", "efficiency": 1},
    "gas_torque": {"male_share": 0},
    "economizer": {**WINDOW, "temperature": "285 K"},
    "liquid_injection": WINDOW,
    "separator": {},
    "ring_leakage": GAP,
    "cylinder_heat": {"wall_temperature": "350 K", "factor": 1e-9},
    "air_package": {"rated_flow": "1e6 m^3/min", "inlet_filter": {"pressure_loss": "30 mbar"}},
    "drive": {
        "motor_inertia": "1e6 kg m^2",
        "rotor_inertia": "1e6 kg m^2",
        "coupling": {"linear": {"spring": "20000 N m/rad", "largest_twist": "1e3 deg"}, "damping": "6 N m s/rad"},
        "motor": {"law": "line", "slope": "30 N m s/rad", "torque_limit": "1e5 N m"},
    },
}
OF_SEPARATOR = "heating_capacity", "heating_cop", "electrical_heating_cop"  # with one, after gas and oil have mixed
LET_OUT = 1e-3  # of the flow: what a wider leak may let out of the last of a chamber, which would expand to suction
SPLIT = {
    "tip_leakage": "tip",
    "interlobe_leakage": "interlobe",
    "end_face_leakage": "end_face",
    "blow_hole": "blow_hole",
}
LEAKS = {
    f"effects.{name}.gap": 1.3 for name in ("tip_leakage", "interlobe_leakage", "end_face_leakage", "ring_leakage")
}
LEAKS |= {f"effects.{name}.area": 1.3 for name in ("blow_hole", "shaft_leakage", "bypass")} | {
    "effects.bypass.share": 1.3
}
LOSSES = {"mechanical": "mechanical_power", "hydromechanical": "hydromechanical_power", "oil_drag": "oil_drag_power"}
LOSSES |= {"bearings": "bearing_power", "oil_pump": "oil_pump_power"}
LOOPS = "separator", "drive", "air_package"  # through which losses act on the cycle
SAME_LOBES = "isentropic_efficiency", "work_per_cycle", "discharge_temperature", "peak_pressure", "trapped_mass"


@law
def neutral(case: Case) -> Iterator[Pair]:
    """An effect at the value at which it does nothing changes nothing that is read without it."""
    here = case.result
    names = [name for name in NEUTRAL if name.split()[0] not in case.scene.effects]
    count = 0
    for name in case.random.permutation(names):
        effect = str(name).split()[0]
        try:
            scene = case.changed({f"effects.{effect}": NEUTRAL[str(name)]})
        except (SceneError, UsageError):
            continue
        try:
            yield Pair(f"with {name} of no size", here, twin(scene), slack=1e-6, without=OF_SEPARATOR)
        except Lost as why:
            raise Lost(f"with {name} of no size {why}") from None
        count += 1
        if count == SOME:
            return


@law
def split_gap(case: Case) -> Iterator[Pair]:
    """A gap is two gaps of half its area beside each other."""
    here = case.result
    there = [name for name in SPLIT if name in case.scene.effects]
    for name in case.random.permutation(there)[:1]:
        parameters = case.scene.effects[str(name)].parameters
        warm = "thermal_clearances" in case.scene.effects  # which widens shipped gaps alone
        if warm or parameters.model not in (None, "nozzle") or case.value("machine.volume.law") == "profile":
            raise NotAsked("a gap of another law")
        half = 0.5 * parameters.flow_coefficient
        own = f"effects.own_effects.second_{SPLIT[str(name)]}"
        tree = tree_of(case.scene)
        tree["effects"][str(name)]["flow_coefficient"] = half
        tree["effects"][own.removeprefix("effects.")] = dict(tree["effects"][str(name)])
        yield Pair(f"two halves of {name}", here, twin(read(tree, case.scene)))


@law
def written_otherwise(case: Case) -> Iterator[Pair]:
    """Effects and keys in another order, numbers in other units: the same machine."""
    here, tree = case.result, tree_of(case.scene)
    tree["effects"] = {str(name): tree["effects"][str(name)] for name in case.random.permutation(list(tree["effects"]))}
    yield Pair("effects in another order", here, twin(read(tree, case.scene)))
    values = {}
    for path, leaf in leaves_of(case.scene).items():
        units = _TABLE.get(leaf.dimension.si, {}) if leaf.dimension else {}
        value = value_at(case.scene, path) if units else None
        if isinstance(value, float) and not path.startswith("machine.displacement"):
            unit = str(case.random.choice(list(units)))
            times, over = units[unit]
            values[path] = f"{value / times * over!r} {unit}"
    yield Pair("in other units", here, twin(case.changed(values)))


@law
def dry_in_two_phases(case: Case) -> Iterator[Pair]:
    """Gas that stays dry does not notice that its condensing is looked for."""
    here = case.result
    if case.scene.gas.model != "real" or case.scene.gas.two_phase != "refuse":
        raise NotAsked("no real gas of one phase")
    there = twin(case.changed({"gas.two_phase": "equilibrium"}))
    if (there.performance.get("discharge_quality") or 0.0) < 1.0:
        raise NotAsked("wet")
    yield Pair("followed in two phases", here, there)


@law
def hardly_any_oil(case: Case) -> Iterator[Pair]:
    """Next to no oil is no oil."""
    case.believe()
    scene = case.scene
    if scene.oil_supply is None or case.value("oil_supply.ratio") is None or "separator" in scene.effects:
        raise NotAsked("no ratio of oil")
    without = [name for name in scene.effects if _needs_oil(name)]
    drags = [name for name in without if name in LOSSES]
    none = case.changed({"oil": None, "oil_supply": None}, without)
    try:
        one = twin(none)
    except Lost as why:
        raise NotAsked(str(why)) from None
    yield Pair("1e-10 of oil", one, twin(case.changed({"oil_supply.ratio": 1e-10}, drags)), slack=1e-6)


def _needs_oil(name: str) -> bool:
    effect = catalogue().get(name)
    return effect is not None and effect.needs_oil


@law
def lobes(case: Case) -> Iterator[Pair]:
    """Chambers that nothing connects work alike, however many there are."""
    case.believe()
    scene = case.scene
    if scene.machine.kind != "twin_screw" or case.value("machine.volume.law") != "paper":
        raise NotAsked("no screw by laws")
    keep = {"suction_port", "discharge_port", "mechanical", "gas_torque"}
    without = [name for name in scene.effects if name not in keep]
    values: dict[str, Any] = {"oil": None, "oil_supply": None} if scene.oil is not None else {}
    try:
        one = twin(case.changed(values, without))
    except Lost as why:
        raise NotAsked(str(why)) from None
    count = int(case.random.choice([3, 5, 6]))
    other = twin(case.changed(values | {"machine.male_lobes": count, "machine.female_lobes": count + 2}, without))
    own = value_at(scene, "machine.male_lobes")
    extensive = "gas_mass_flow", "indicated_power", "shaft_power", "displacement_flow", "mechanical_power"
    factors = dict.fromkeys(extensive, own / count)
    only = {*SAME_LOBES, *extensive, "volumetric_efficiency"}
    yield Pair(f"{count} lobes, not {own}", one, scaled(other, factors), only)


@law
def wider_leak(case: Case) -> Iterator[Pair]:
    """A wider leak does not increase the delivered flow, but for what it lets out of a chamber that is closing."""
    here = case.result
    there = {path: by for path, by in LEAKS.items() if isinstance(case.value(path), float) and case.value(path)}
    if (
        not there
        or case.scene.machine.mode == "expander"
        or {"refrigerant_solubility", "drive"} & case.scene.effects.keys()
    ):
        raise NotAsked("no leak that is a number, oil whose gas it may dissolve, or a speed that follows")
    path = str(case.random.choice(list(there)))
    wide = twin(with_values(case.scene, {path: there[path] * case.value(path)}))
    one, other = (each.performance.get("gas_mass_flow") for each in (here, wide))
    if one is None or other is None:
        raise NotAsked("no flow")
    may = sum(each.error.get("gas_mass_flow") or 0.0 for each in (here, wide)) + 0.05 * 3e-4
    filling = abs(one) / max(abs(here.performance.volumetric_efficiency or 0.0), 1e-12)
    gain = max(other - one, 0.0) / max(abs(one), 0.1 * filling)
    yield Pair(f"wider {path}: flow {other} of {one}", here, wide, broken=max(0.0, gain - LET_OUT) / may)


@law
def losses_add(case: Case) -> Iterator[Pair]:
    """A loss that does not act on the cycle is what the shaft takes more."""
    here = case.result
    if any(name in case.scene.effects for name in LOOPS) or case.value("effects.motor.cooling") == "suction_gas":
        raise NotAsked("losses act on the cycle")
    if case.value("effects.mechanical.of") not in (None, "indicated_power"):
        raise NotAsked("a loss of losses")
    for name, figure in LOSSES.items():
        if name in case.scene.effects and here.performance.get(figure) is not None:
            without = twin(case.changed({}, [name]))
            left = here.performance.shaft_power - here.performance[figure]
            values = dict(without.performance) | {"shaft_power": left}
            only = ("shaft_power", "gas_mass_flow", "discharge_temperature", "indicated_power")
            expected = replace(here, performance=Performance(dict(here.performance) | values, here.performance.about))
            yield Pair(f"without {name}", expected, without, only)
